"""A flight as one job of 1974 cards: the same frames, landmarks, positions and lens."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Ints
from vopd.cards.write_number import rounded_to_fit
from vopd.convert.card_landmarks import card_ignored, card_landmarks, card_readings
from vopd.convert.card_lens import CardFilm, card_film
from vopd.convert.card_numbers import NumberRow, frame_numbers, frame_times, landmark_numbers
from vopd.convert.card_trajectory import card_trajectory, card_wind
from vopd.estimate import Estimate
from vopd.findings import VopdError
from vopd.flight.flight import Flight
from vopd.flight.frame_slots import FrameSlots
from vopd.flight.result import FlightResult
from vopd.flight.solved_flight import solve
from vopd.geometry.camera_mount import FORWARD
from vopd.job import Camera, Clock, Job

END = 13


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
    number, landmark_rows = landmark_numbers(flight, seen)
    frame, frame_rows = frame_numbers(flight, frames)
    time_s, time_note = frame_times(flight, frames)
    trajectory = card_trajectory(solved, flight, frames, time_s)
    job = Job(
        title=f"1   {flight.name or 'FLIGHT'}".encode("ascii", "replace").decode()[:80].ljust(80),
        camera=_camera(film, flight, estimate, frames),
        trajectory=trajectory,
        wind=card_wind(flight, trajectory, frames),
        clock=Clock(frame, time_s),
        landmarks=card_landmarks(flight, seen, number),
        ignored=card_ignored(flight, number),
        readings=card_readings(flight, film, held, frames, frame, number),
        return_group=END,
    )
    notes = [*film.notes, *time_note, *_lost(flight, result, held)]
    return PunchedFlight(job, (*frame_rows, *landmark_rows), tuple(notes))


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


def _roll_offset_deg(flight: Flight) -> float | None:
    """What group 3 adds to the camera's roll; None for a mount that is no turn about the view."""
    turn = flight.mount @ FORWARD.T
    if not turn[0, 0] > 1.0 - 1e-12:
        return None
    return 0.0 - float(np.degrees(np.arctan2(turn[2, 1], turn[1, 1])))


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
