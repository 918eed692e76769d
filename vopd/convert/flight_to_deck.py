"""A flight as one job of 1974 cards: the same frames, landmarks, positions and lens."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.cards.write_number import rounded_to_fit
from vopd.convert.card_lens import CardFilm, card_film
from vopd.estimate import Estimate
from vopd.findings import VopdError
from vopd.flight.flight import Flight
from vopd.flight.flight_result import FlightResult
from vopd.flight.frame_slots import FrameSlots
from vopd.flight.solved_flight import SolvedFlight, solve
from vopd.geometry.camera_mount import FORWARD
from vopd.geometry.geodetic import earth_centred_m, geodetic, local_axes
from vopd.job import Camera, Clock, Ignored, Job, Landmarks, Readings, Trajectory, Wind
from vopd.program.constants import ftpkm
from vopd.program.earth import SEA_LEVEL_KFT

FT_PER_M = ftpkm / 1000.0
MOST_LANDMARKS, MOST_FRAMES = 99, 9999  # two and four columns
END = 13


class NumberRow(NamedTuple):
    """What a number on the cards stands for."""

    kind: str  # frame or landmark
    number: int
    name: str


class PunchedFlight(NamedTuple):
    """A flight as a job, what its numbers stand for, and what the cards do not hold."""

    job: Job
    numbers: tuple[NumberRow, ...]
    notes: tuple[str, ...]


@np.errstate(all="ignore")
def flight_job(result: FlightResult) -> PunchedFlight:
    """The job of a flight that has been solved.

    Args:
        result: the flight, whose frames with an attitude are written

    Raises:
        VopdError: where it has more landmarks or frames than the cards have numbers for
    """
    flight, estimate = result.flight, result.estimate
    solved = solve(flight)
    film = card_film(flight, solved)
    slots = FrameSlots.of(flight.picks.frame, len(flight.frame))
    used = estimate.used[slots.frame, slots.slot] | estimate.ignored[slots.frame, slots.slot]
    held: Bools = used & np.isfinite(film.point_in).all(axis=1)
    frames = np.flatnonzero(result.solved)
    seen = np.unique(flight.picks.landmark[held])
    if not len(frames):
        raise VopdError(f"{flight.source}: no frame has an attitude, so none can be punched")
    _within("landmarks", len(seen), MOST_LANDMARKS)
    _within("frames", len(frames), MOST_FRAMES)
    number, landmark_rows = _landmark_numbers(flight, seen)
    frame, frame_rows = _frame_numbers(flight, frames)
    time_s, time_note = _times(flight, frames)
    trajectory = _trajectory(solved, estimate, flight, frames, time_s)
    job = Job(
        title=f"1   {flight.name or 'FLIGHT'}".encode("ascii", "replace").decode()[:80].ljust(80),
        camera=_camera(film, flight, estimate, frames),
        trajectory=trajectory,
        wind=_wind(flight, trajectory, frames),
        clock=Clock(frame, time_s),
        landmarks=_landmarks(flight, seen, number),
        ignored=_ignored(flight, number),
        readings=_readings(flight, film, held, frames, frame, number),
        return_group=END,
    )
    notes = [*film.notes, *time_note, *_lost(flight, result, held)]
    return PunchedFlight(job, (*frame_rows, *landmark_rows), tuple(notes))


def _within(what: str, count: int, most: int) -> None:
    if count > most:
        raise VopdError(f"{count} {what}: cards have numbers for {most}; punch a part of them")


def _landmark_numbers(flight: Flight, seen: Ints) -> tuple[Ints, list[NumberRow]]:
    """A number of two columns for each landmark of the flight (N,), 0 where it is not seen."""
    own = flight.landmarks.number
    named = [flight.landmarks.name[k] for k in seen]
    keeps = bool(((own[seen] > 0) & (own[seen] <= MOST_LANDMARKS)).all()) and all(
        name.isdigit() for name in named
    )
    number = np.zeros(len(own), np.int64)
    number[seen] = own[seen] if keeps else np.arange(1, len(seen) + 1)
    rows = [NumberRow("landmark", int(number[k]), flight.landmarks.name[k]) for k in seen]
    return number, [] if keeps else rows


def _frame_numbers(flight: Flight, frames: Ints) -> tuple[Ints, list[NumberRow]]:
    """A number of four columns for each frame that is written; its own where that fits."""
    own = flight.frame[frames]
    if not flight.image_name and own.min(initial=0) >= 0 and own.max(initial=0) <= MOST_FRAMES:
        return own, []
    number = np.arange(1, len(frames) + 1)
    names = flight.image_name or tuple(str(n) for n in flight.frame)
    return number, [
        NumberRow("frame", int(n), names[k]) for n, k in zip(number, frames, strict=True)
    ]


def _times(flight: Flight, frames: Ints) -> tuple[Floats, list[str]]:
    """Times that increase from frame to frame, to what ten columns hold."""
    time_s = np.array([rounded_to_fit(t, 82, 0) for t in flight.time_s[frames]])
    if np.isfinite(time_s).all() and (np.diff(time_s) > 0.0).all():
        return time_s, []
    note = "the frames have no times that increase: on the cards they are a second apart"
    return np.arange(len(frames), dtype=np.float64), [note]


def _roll_offset_deg(flight: Flight) -> float | None:
    """What group 3 adds to the camera's roll; None for a mount that is no turn about the view."""
    turn = flight.mount @ FORWARD.T
    if not turn[0, 0] > 1.0 - 1e-12:
        return None
    return 0.0 - float(np.degrees(np.arctan2(turn[2, 1], turn[1, 1])))


def _camera(film: CardFilm, flight: Flight, estimate: Estimate, frames: Ints) -> Camera:
    first = estimate.camera_deg[frames[0]]
    roll_deg = rounded_to_fit(_roll_offset_deg(flight) or 0.0, 78, 7)
    return Camera(
        focal_length_mm=rounded_to_fit(film.focal_length_mm, 82, 0),
        lens_radius_mm=film.radius_mm,
        lens_distortion_um=film.distortion_um,
        multiplier=np.ones(3),
        offset_deg=np.array([0.0, 0.0, roll_deg]),
        initial_deg=np.round(first, 3),
    )


def _trajectory(
    solved: SolvedFlight, estimate: Estimate, flight: Flight, frames: Ints, time_s: Floats
) -> Trajectory:
    """A row for each frame, about an origin on the ellipsoid below the first frame."""
    where = geodetic(solved.camera_m[frames])
    latitude = rounded_to_fit(float(where.latitude_deg[0]), 82, 1)
    longitude = rounded_to_fit(float(where.longitude_deg[0]), 82, 2)
    origin = earth_centred_m(latitude, longitude, 0.0)
    position = (solved.camera_m[frames] - origin) @ local_axes(origin).T * FT_PER_M
    velocity = np.zeros((len(frames), 3))
    if flight.path.velocity_m_s is not None:
        velocity = flight.path.velocity_m_s[frames] * FT_PER_M
    return Trajectory(
        time_s=time_s,
        position_ft=_fitted(position),
        velocity_ft_s=_fitted(velocity),
        altitude_ft=_fitted(where.height_m * FT_PER_M),
        origin_latitude_deg=latitude,
        origin_longitude_deg=longitude,
        origin_radius_kft=SEA_LEVEL_KFT,
    )


def _fitted(values: Floats) -> Floats:
    """Numbers to what ten columns hold with their sign and point: eight digits at most."""
    digits = np.floor(np.log10(np.maximum(np.abs(values), 1.0))) + 1
    decimals = np.where(values < 0.0, 8, 9) - digits
    return np.array(
        [
            round(v, max(int(d), 0)) + 0.0
            for v, d in zip(values.ravel(), decimals.ravel(), strict=True)
        ]
    ).reshape(values.shape)


def _wind(flight: Flight, trajectory: Trajectory, frames: Ints) -> Wind:
    """The wind at the altitudes of the frames, upward; none is given as calm."""
    if flight.path.wind_m_s is None:
        return Wind(np.array([0.0]), np.zeros((1, 2)))
    altitude, first = np.unique(trajectory.altitude_ft, return_index=True)
    return Wind(altitude, _fitted(flight.path.wind_m_s[frames][first] * FT_PER_M))


def _landmarks(flight: Flight, seen: Ints, number: Ints) -> Landmarks:
    where = geodetic(flight.landmarks.position_m[seen])
    degrees, minutes = [], []
    for angle in (where.longitude_deg, where.latitude_deg):
        whole = np.floor(angle)
        degrees.append(whole)
        minutes.append(_fitted((angle - whole) * 60.0))
    return Landmarks(
        number[seen], degrees[0], minutes[0], degrees[1], minutes[1],
        _fitted(where.height_m * FT_PER_M),
    )  # fmt: skip


def _ignored(flight: Flight, number: Ints) -> Ignored:
    """Check landmarks are ignored in all frames; a column for each landmark, 0 where none."""
    used = np.array(flight.landmarks.used or (True,) * len(number), dtype=bool)
    check = number[~used & (number > 0)]
    everywhere = np.zeros((number > 0).sum(), np.int64)
    everywhere[: len(check)] = check
    return Ignored(np.zeros(0, np.int64), np.zeros((0, 6), np.int64), everywhere)


def _readings(
    flight: Flight, film: CardFilm, held: Bools, frames: Ints, frame: Ints, number: Ints
) -> Readings:
    """Three readings of each pick, whose spread is that of the pick's standard deviation."""
    index = np.full(len(flight.frame), -1)
    index[frames] = np.arange(len(frames))
    pick = np.flatnonzero(held & (index[flight.picks.frame] >= 0))
    slots = FrameSlots.of(index[flight.picks.frame[pick]], len(frames))
    apart = np.sqrt(3.0) * flight.picks.sigma_px[pick] * film.inches_per_px
    three = film.point_in[pick, None] + apart[:, None, None] * np.array([-1.0, 0.0, 1.0])[:, None]
    readings = slots.spread(_to_the_reader(three))
    corner = np.floor(film.centre_in * 90.0) / 100.0
    corners = film.centre_in + corner * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    fiducials = np.round(np.repeat(corners[:, None], 3, axis=1), 3)
    present: Bools = slots.spread(np.ones(len(pick), bool))
    return Readings(
        frame=frame,
        fiducial_in=np.tile(fiducials, (len(frames), 1, 1, 1)),
        landmark=slots.spread(number[flight.picks.landmark[pick]]),
        present=present,
        landmark_in=readings,
    )


def _to_the_reader(inches: Floats) -> Floats:
    """Readings to what seven columns hold with sign and point."""
    five, four, three = (np.round(inches, decimals) for decimals in (5, 4, 3))
    fits_five = (five >= 0.0) & (five < 10.0)
    fits_four = (four > -10.0) & (four < 100.0)
    return np.where(fits_five, five, np.where(fits_four, four, three))


def _lost(flight: Flight, result: FlightResult, held: Bools) -> list[str]:
    """What the cards do not hold, a sentence each."""
    frames, left_out = len(result.solved), int((~result.solved).sum())
    sigma = flight.picks.sigma_px[held]
    lines = {
        f"{left_out} of {frames} frames have no attitude and are left out": left_out > 0,
        f"{int((~held).sum())} picks take no part and are left out": not held.all(),
        "refraction is taken off the picks by the flight's own attitude": flight.refraction.k != 0,
        "the lever arm is applied: the cards have the camera's positions": np.any(
            flight.path.lever_arm_m if flight.path.lever_arm_m is not None else 0.0
        ),
        "picks of different standard deviations count alike on the cards": np.ptp(sigma) > 0
        if len(sigma)
        else False,
        f"the loss {flight.options.loss} is not on the cards": flight.options.loss
        != "least-squares",
        "the camera's mount is not on the cards: their vehicle is the camera": (
            _roll_offset_deg(flight) is None
        ),
        "the velocity is not known: alpha, beta and eta of the cards mean nothing": (
            flight.path.velocity_m_s is None
        ),
        "standard deviations of landmarks, positions and time are not on the cards: give "
        "--landmark-sigma, --position-sigma, --time-sigma": _states_sigmas(flight),
        "the date of time zero is not on the cards: give --epoch": flight.epoch is not None,
        "altitudes are above the ellipsoid: run the deck with --fix all": True,
    }
    return [line for line, holds in lines.items() if holds]


def _states_sigmas(flight: Flight) -> bool:
    sigmas = (flight.landmarks.sigma_m, flight.path.sigma_m, flight.path.sigma_time_s)
    return any(bool((np.nan_to_num(sigma) > 0.0).any()) for sigma in sigmas)
