"""Write a flight as one job of 1974 cards."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.cards.numbers import rounded_to_fit
from vopd.estimate import Estimate
from vopd.findings import VopdError, count_text, size_text
from vopd.flight.flight import Flight, FrameSlots
from vopd.flight.result import FlightResult
from vopd.flight.solve.equations import parameters_of
from vopd.flight.solve.rotations import SolvedFlight
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes
from vopd.geometry.lenses import Lens, Lenses, distort_radial_table, project, ray_of_pixel
from vopd.geometry.linear import norm
from vopd.geometry.rotations import FORWARD, partials_by_turns
from vopd.job import Camera, Clock, Ignored, Job, Landmarks, Readings, Trajectory, Wind
from vopd.program.constants import factor, ftpkm
from vopd.program.earth import SEA_LEVEL_KFT

END = 13


NumberRow = tuple[str, int, str]
"""A number on the cards: `frame` or `landmark`, the number, and the name that it stands for."""


@np.errstate(all="ignore")
def flight_job(result: FlightResult) -> tuple[Job, list[NumberRow], list[str]]:
    """Punch a solved flight as one job: the same frames, landmarks, positions and lens.

    Args:
        result: the flight, whose frames with an attitude are written

    Returns:
        The job, what its numbers stand for, and a sentence for each thing the cards do not hold.

    Raises:
        VopdError: where it has more landmarks or frames than the cards have numbers for
    """
    flight, estimate = result.flight, result.estimate
    if isinstance(flight.lens, Lenses):
        message = "[camera] of_images: the cards have one lens: write a project for each camera"
        raise VopdError(f"{flight.source}: {message}")
    solved, picks = result.estimates.solved, flight.picks
    places = places_note(solved, estimate)
    if solved.landmark_m is not None:
        flight = replace(flight, landmarks=replace(flight.landmarks, position_m=solved.landmark_m))
    if not picks.stated and picks.clicks is None:  # the residuals tell what is more than this
        least_px = float(np.fmax(picks.repeatability_px, picks.least_sigma_px))
        flight = replace(flight, picks=picks.with_sigma(least_px))
    elif picks.clicks is not None:
        flight = replace(flight, picks=picks.with_clicks_as_own)
    film = card_film(flight, solved)
    slots = FrameSlots.of(flight.picks.frame, len(flight.frame))
    used = estimate.used[slots.frame, slots.slot] | estimate.ignored[slots.frame, slots.slot]
    held: Bools = used & np.isfinite(film.point_in).all(axis=1)
    frames = np.flatnonzero(result.solved)
    frames = frames[np.argsort(flight.time_s[frames], kind="stable")]  # images are by name
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
        landmarks=card_landmarks(flight, seen, number, _nearest_m(solved, flight, held)),
        ignored=card_ignored(flight, number),
        readings=card_readings(flight, film, held, frames, frame, number),
        return_group=END,
    )
    rounded = rounded_note(job, solved, flight, frames, held)
    notes = [*film.notes, *places, *time_note, *rounded, *lost_on_cards(flight, result, held)]
    return job, [*frame_rows, *landmark_rows], notes


def _camera(film: CardFilm, flight: Flight, estimate: Estimate, frames: Ints) -> Camera:
    first = estimate.camera_deg[frames[0]]
    return Camera(
        focal_length_mm=rounded_to_fit(film.focal_length_mm, 82, 0),
        lens_radius_mm=film.radius_mm,
        lens_distortion_um=film.distortion_um,
        multiplier=np.ones(3),
        offset_deg=np.array([0.0, 0.0, _card_roll_deg(flight)]),
        initial_deg=np.round(first, 3),
    )


def roll_offset_deg(flight: Flight) -> float | None:
    """Find the roll that group 3 adds; None for a mount that is no turn about the optical axis."""
    turn = flight.mount @ FORWARD.T
    if not turn[0, 0] > 1.0 - 1e-12:
        return None
    return 0.0 - float(np.degrees(np.arctan2(turn[2, 1], turn[1, 1])))


def _card_roll_deg(flight: Flight) -> float:
    """Round the roll that group 3 adds to what its columns hold."""
    return rounded_to_fit(roll_offset_deg(flight) or 0.0, 78, 7)


NOTED_M = 0.01


def places_note(solved: SolvedFlight, estimate: Estimate) -> list[str]:
    """Say how far places that were solved with the attitudes are from the stated ones."""
    flight, moved_m = solved.flight, [np.zeros((1, 3))]
    if estimate.moved is not None:
        moved_m.append(estimate.moved)
    if solved.landmark_m is not None:
        seen = np.unique(flight.picks.landmark)
        moved_m.append(solved.landmark_m[seen] - flight.landmarks.position_m[seen])
    apart_m = float(np.nanmax(norm(np.vstack(moved_m))))
    if apart_m < NOTED_M:
        return []
    return [
        "landmarks and positions are where the flight's solve has them, up to "
        f"{size_text(apart_m)} m from where they are stated, so that the deck has its angles"
    ]


def lost_on_cards(flight: Flight, result: FlightResult, held: Bools) -> list[str]:
    """List what the cards do not hold, a sentence each."""
    frames, left_out = len(result.solved), int((~result.solved).sum())
    sigma, of_parameters = flight.picks.sigma_px[held], flight.options.parameter_sigma
    of_lens = {*parameters_of(flight.lens)} - {"focal"}
    of = f"of {frames} frames"
    turn_deg, card_deg = roll_offset_deg(flight) or 0.0, _card_roll_deg(flight)
    unused = int((~held).sum())
    lines = {
        count_text(
            left_out,
            f"{of} has no attitude and is left out",
            f"{of} have no attitude and are left out",
        ): left_out > 0,
        count_text(
            unused, "pick takes no part and is left out", "picks take no part and are left out"
        ): unused > 0,
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
            roll_offset_deg(flight) is None
        ),
        f"group 3 holds {card_deg:g} degree of the mount's turn: roll angles of the cards' vehicle "
        f"are off by {size_text(abs(card_deg - turn_deg))} degree": (
            abs(card_deg - turn_deg) > TURNED_DEG
        ),
        "the velocity is not known: alpha, beta and eta of the cards mean nothing": (
            flight.path.velocity_m_s is None
        ),
        "standard deviations of landmarks, positions and time are not on the cards: give "
        "--landmark-sigma, --position-sigma, --time-sigma": _states_sigmas(flight),
        "the standard deviation of the focal length is not on the cards: give --focal-sigma": (
            of_parameters.get("focal", 0.0) > 0.0
        ),
        "the sigmas of a deck have no errors of the rest of the lens": (
            any(of_parameters.get(name, 0.0) > 0.0 for name in of_lens)
        ),
        "the date of time zero is not on the cards: give --epoch": flight.epoch is not None,
        "altitudes are above the ellipsoid: run the deck with --fix all": True,
    }
    return [line for line, holds in lines.items() if holds]


def _states_sigmas(flight: Flight) -> bool:
    path = flight.path
    rows = (flight.landmarks.sigma_m, path.bias_sigma_m)
    own = path.fixes is not None or any(bool(sigma.any()) for sigma in rows)
    return own or flight.options.parameter_sigma.get("clock", 0.0) > 0.0


# The lens as the 1974 table of distortion by radius, and picks as film coordinates
#
# The table has 25 rows between which it is linear. A pick is put where the table takes
# it to the right direction, so that nothing is lost by the table's coarseness; a lens
# that is not radial has a table of zeros.

ROWS = 25
LARGEST_IN = 9.9  # below ten inches the reader's seven columns hold five decimals
STEPS_IN = (0.02, 0.01, 0.005, 0.002, 0.001, 0.0005, 0.0002, 0.0001)
"""What a pixel is on the film reader, inches: the largest that keeps the image below 9.9."""

NOTED_PX = 0.005


class CardFilm(NamedTuple):
    """Picks on the film reader and the lens of group 1."""

    inches_per_px: float
    focal_length_mm: float
    centre_in: Floats  # (2,) the principal point
    point_in: Floats  # (P, 2) NaN where a pick has no image
    radius_mm: Floats  # (25,)
    distortion_um: Floats  # (25,)
    notes: tuple[str, ...]


def not_radial_text(lens: Lens) -> str:
    """Say by what a lens is not radial, and by how much."""
    fx_px, fy_px = lens.focal_px.tolist()
    why = []
    if fx_px != fy_px:
        why.append(f"fx and fy differ by {size_text(100.0 * abs(fy_px / fx_px - 1.0))} %")
    if lens.skew_px:
        why.append(f"its skew is {size_text(lens.skew_px)} px")
    if not lens.model.only_radial(lens.coefficients):
        why.append("it has coefficients beside those of the radius")
    return ", ".join(why)


@np.errstate(all="ignore")
def card_film(flight: Flight, solved: SolvedFlight) -> CardFilm:
    """Convert the picks of a flight to readings of a film.

    x grows to the left and y up, seen from behind the camera. Refraction, which
    the cards do not know, is taken off the picks.
    """
    lens = flight.lens
    inches = next((s for s in STEPS_IN if s * max(lens.size_px) <= LARGEST_IN), STEPS_IN[-1])
    focal = float(lens.focal_px.mean())
    focal_mm = focal * inches * factor
    ideal = _ideal(flight, solved)
    radius, added = np.arange(float(ROWS)), np.zeros(ROWS)
    notes = []
    if lens.is_radial:
        radius, added = rounded_rows(radius_table(lens, ideal), focal_mm)
    else:
        notes.append(
            "the lens is not radial: its distortion is taken off the picks, and group 1 has none "
            f"({not_radial_text(lens)})"
        )
    moved = _moved_px(flight, solved, ideal)
    if moved > NOTED_PX:
        notes.append(
            f"picks are up to {size_text(moved)} px from where the lens shows them, so that the "
            "1974 solve, which weighs them without the lens, has the flight's solution"
        )
    film = ideal
    if np.any(added):
        table = np.stack([radius, radius + added / 1000.0], axis=1) / focal_mm
        film = np.stack(distort_radial_table(table, *ideal.T)[0], axis=1)
    size = np.array(lens.size_px, dtype=np.float64) * inches
    centre = np.round(size / 2.0, 2)
    return CardFilm(
        inches, focal_mm, centre, centre - film * focal * inches, radius, added,
        tuple(notes),
    )  # fmt: skip


def _ideal(flight: Flight, solved: SolvedFlight) -> Floats:
    """Take distortion and refraction off the picks, in the plane at unit distance, (P, 2).

    The 1974 solve makes squares of residuals least on a film without distortion, a
    flight's on the image as it was taken. A pick is put where both have the same
    gradient, and so the same solution: with D the derivative of pixels by x and y, and f
    the focal length, a residual r stands as D' r / f2 beside the landmark's image.
    """
    lens, picks = flight.lens, flight.picks
    rotation = solved.attitudes.rotation[picks.frame]
    seen = project(lens, np.einsum("pij,pj->pi", rotation, solved.lines.direction))
    straight = np.einsum("pij,pj->pi", rotation, _straight(flight, solved))
    x, y = straight[:, 0] / straight[:, 2], straight[:, 1] / straight[:, 2]
    by_turns = partials_by_turns(x, y, np.ones_like(x))
    across = by_turns.swapaxes(1, 2)
    by_plane = seen.by_turns @ across @ np.linalg.inv(_known(by_turns @ across))
    residual = picks.pixel - seen.pixel
    moved = (by_plane.swapaxes(1, 2) @ residual[..., None])[..., 0] / lens.focal_px.mean() ** 2
    return np.asarray(np.stack([x, y], axis=1) + moved)


def _moved_px(flight: Flight, solved: SolvedFlight, ideal: Floats) -> float:
    """Measure the farthest that a pick is from where it is without distortion and refraction."""
    lens, picks = flight.lens, flight.picks
    ray = ray_of_pixel(lens, picks.pixel)
    raised = [
        np.einsum("pij,pj->pi", solved.attitudes.rotation[picks.frame], line)
        for line in (solved.lines.direction, _straight(flight, solved))
    ]
    apparent, straight = (one[:, :2] / one[:, 2:] for one in raised)
    off = ray[:, :2] / ray[:, 2:] - (apparent - straight) - ideal
    off = off[solved.used | ~flight.landmarks.takes_part[picks.landmark]]
    return float(np.nanmax(np.hypot(*off.T), initial=0.0) * lens.focal_px.mean())


def _straight(flight: Flight, solved: SolvedFlight) -> Floats:
    """Point from the camera to the landmark of each pick, east, north, up, unrefracted."""
    picks = flight.picks
    away = flight.landmarks.position_m[picks.landmark] - solved.camera_m[picks.frame]
    return np.asarray(np.einsum("pij,pj->pi", solved.lines.axes[picks.frame], away))


def _known(matrices: Floats) -> Floats:
    """Replace matrices (P, 2, 2) that are NaN by the unit matrix, so that all can be inverted."""
    finite = np.asarray(np.isfinite(matrices).all(axis=(1, 2)))
    return np.where(finite[:, None, None], matrices, np.eye(2))


def radius_table(lens: Lens, ideal: Floats) -> Floats:
    """Tabulate measured and ideal radius at unit distance, from the centre to the last pick."""
    if lens.table is not None and len(lens.table) <= ROWS:
        return lens.coefficients
    farthest = float(np.nanmax(np.hypot(*ideal.T), initial=0.1)) * 1.02
    tangent = np.linspace(0.0, farthest, ROWS)
    ray = np.stack([tangent, np.zeros(ROWS), np.ones(ROWS)], axis=1)
    measured = project(lens, ray).distorted[:, 0]
    held = np.isfinite(measured)
    return np.stack([measured[held], tangent[held]], axis=1)


def rounded_rows(table: Floats, focal_mm: float) -> tuple[Floats, Floats]:
    """Round radius, mm, and distortion, micrometres, to what the columns of 25 cards hold."""
    measured, ideal = table.T * focal_mm
    radius = np.round(measured, 6)
    added = np.round((ideal - measured) * 1000.0, 3)
    more = ROWS - len(radius)  # rows beyond the last, on the same line
    slope = (added[-1] - added[-2]) / (radius[-1] - radius[-2])
    beyond = np.round(np.arange(1, more + 1) * max(radius[-1] / 10.0, 0.1), 3)
    return (
        np.append(radius, np.round(radius[-1] + beyond, 6)),
        np.append(added, np.round(added[-1] + slope * beyond, 3)),
    )


# Trajectory and wind, in feet about an origin

FT_PER_M = ftpkm / 1000.0


def card_trajectory(
    solved: SolvedFlight, flight: Flight, frames: Ints, time_s: Floats
) -> Trajectory:
    """Write a row for each frame, about an origin on the ellipsoid below the first frame."""
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
        position_ft=to_ten_columns(position),
        velocity_ft_s=to_ten_columns(velocity),
        altitude_ft=to_ten_columns(where.height_m * FT_PER_M),
        origin_latitude_deg=latitude,
        origin_longitude_deg=longitude,
        origin_radius_kft=SEA_LEVEL_KFT,
    )


def card_wind(flight: Flight, trajectory: Trajectory, frames: Ints) -> Wind:
    """Tabulate the wind at the altitudes of the frames, upward; none is given as calm."""
    if flight.path.wind_m_s is None:
        return Wind(np.array([0.0]), np.zeros((1, 2)))
    altitude, first = np.unique(trajectory.altitude_ft, return_index=True)
    return Wind(altitude, to_ten_columns(flight.path.wind_m_s[frames][first] * FT_PER_M))


def to_ten_columns(values: Floats) -> Floats:
    """Round numbers to what ten columns hold with sign and point: eight digits at most."""
    digits = np.floor(np.log10(np.maximum(np.abs(values), 1.0))) + 1
    decimals = np.where(values < 0.0, 8, 9) - digits
    return np.array(
        [
            round(v, max(int(d), 0)) + 0.0
            for v, d in zip(values.ravel(), decimals.ravel(), strict=True)
        ]
    ).reshape(values.shape)


# Landmarks, and picks as readings on film


STEPS_DEG = (1.0, 0.01)
"""Of the degrees on a landmark's card: minutes beside hundredths have more decimals."""
TURNED_DEG = 0.0005
"""By so much at most columns turn lines of sight without a word (docs/flight-project.md)."""


def card_landmarks(
    flight: Flight, seen: Ints, number: Ints, nearest_m: Floats | None = None
) -> Landmarks:
    """Write the landmarks that are seen, longitude and latitude in degrees and minutes.

    Degrees are whole, unless minutes then have too few decimals for the nearest landmark.

    Args:
        flight: the flight
        seen: indices of the landmarks that are seen
        number: of each landmark of the flight on the cards (N,)
        nearest_m: how far each is from the camera where that is nearest (N,); far away if None
    """
    position = flight.landmarks.position_m[seen]
    where, near_m = geodetic(position), np.inf if nearest_m is None else nearest_m[seen]
    for step_deg in STEPS_DEG:
        degrees, minutes = [], []
        for angle in (where.longitude_deg, where.latitude_deg):
            # minutes have the sign of the degrees, as on the cards of 1974
            part = np.round(np.trunc(angle / step_deg) * step_deg, 2)
            rest = (angle - part) * 60.0
            degrees.append(part)
            minutes.append(to_ten_columns(rest) if step_deg == 1.0 else np.round(rest, 8) + 0.0)
        marks = Landmarks(
            number[seen], degrees[0], minutes[0], degrees[1], minutes[1],
            to_ten_columns(where.height_m * FT_PER_M),
        )  # fmt: skip
        if (norm(_places_m(marks) - position) <= np.radians(TURNED_DEG / 5.0) * near_m).all():
            break
    return marks


def _places_m(marks: Landmarks) -> Floats:
    """Find where cards have landmarks, Earth-centred, (n, 3)."""
    return earth_centred_m(
        marks.latitude_deg + marks.latitude_min / 60.0,
        marks.longitude_deg + marks.longitude_min / 60.0,
        marks.altitude_ft / FT_PER_M,
    )


def _nearest_m(solved: SolvedFlight, flight: Flight, held: Bools) -> Floats:
    """Measure how near the camera comes to each landmark that is on the cards, (N,)."""
    nearest = np.full(len(flight.landmarks.position_m), np.inf)
    landmark, frame = flight.picks.landmark[held], flight.picks.frame[held]
    away_m = norm(flight.landmarks.position_m[landmark] - solved.camera_m[frame])
    np.minimum.at(nearest, landmark, np.where(np.isfinite(away_m), away_m, np.inf))
    return nearest


def rounded_note(
    job: Job, solved: SolvedFlight, flight: Flight, frames: Ints, held: Bools
) -> list[str]:
    """Say by how much the cards' columns turn lines of sight, if that is more than is promised.

    Args:
        job: on cards
        solved: the flight's solution
        flight: with the landmarks where they are put
        frames: that are on the cards
        held: picks that are, (P,)
    """
    path = job.trajectory
    origin = earth_centred_m(path.origin_latitude_deg, path.origin_longitude_deg, 0.0)
    camera_m = np.full_like(solved.camera_m, np.nan)
    camera_m[frames] = origin + path.position_ft / FT_PER_M @ local_axes(origin)
    landmark_m = np.full_like(flight.landmarks.position_m, np.nan)
    landmark_m[np.unique(flight.picks.landmark[held])] = _places_m(job.landmarks)
    landmark, frame = flight.picks.landmark[held], flight.picks.frame[held]
    away = flight.landmarks.position_m[landmark] - solved.camera_m[frame]
    off = np.cross(landmark_m[landmark] - camera_m[frame], away)
    turned_deg = np.degrees(norm(off) / norm(away) ** 2)
    if not (turned_deg > TURNED_DEG).any():
        return []
    worst = int(np.nanargmax(turned_deg))
    name, away_m = flight.landmarks.name[landmark[worst]], size_text(float(norm(away[worst])))
    return [
        f"the columns hold places so coarsely that {name}, {away_m} m from the camera, is seen "
        f"{size_text(float(turned_deg[worst]))} degree off: angles may differ by as much"
    ]


def card_ignored(flight: Flight, number: Ints) -> Ignored:
    """Ignore check landmarks in all frames; a column for each landmark, 0 where none."""
    used = flight.landmarks.takes_part
    check = number[~used & (number > 0)]
    everywhere = np.zeros((number > 0).sum(), np.int64)
    everywhere[: len(check)] = check
    return Ignored(np.zeros(0, np.int64), np.zeros((0, 6), np.int64), everywhere)


def card_readings(
    flight: Flight, film: CardFilm, held: Bools, frames: Ints, frame: Ints, number: Ints
) -> Readings:
    """Write each pick as three readings, whose spread is the pick's standard deviation."""
    index = np.full(len(flight.frame), -1)
    index[frames] = np.arange(len(frames))
    pick = np.flatnonzero(held & (index[flight.picks.frame] >= 0))
    pick = pick[np.argsort(index[flight.picks.frame[pick]], kind="stable")]
    slots = FrameSlots.of(index[flight.picks.frame[pick]], len(frames))
    apart = np.sqrt(3.0) * flight.picks.sigma_px[pick] * film.inches_per_px
    three = film.point_in[pick, None] + apart[:, None, None] * np.array([-1.0, 0.0, 1.0])[:, None]
    readings = slots.spread(to_the_reader(three))
    corner = np.floor(film.centre_in * 90.0) / 100.0
    corners = film.centre_in + corner * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    fiducials = np.round(np.repeat(corners[:, None], 3, axis=1), 3)
    present: Bools = slots.spread(np.ones(len(pick), bool))
    return Readings.of(
        frame=frame,
        fiducial_in=np.tile(fiducials, (len(frames), 1, 1, 1)),
        landmark=slots.spread(number[flight.picks.landmark[pick]]),
        present=present,
        landmark_in=readings,
    )


def to_the_reader(inches: Floats) -> Floats:
    """Round readings to what seven columns hold with sign and point."""
    five, four, three = (np.round(inches, decimals) for decimals in (5, 4, 3))
    fits_five = (five >= 0.0) & (five < 10.0)
    fits_four = (four > -10.0) & (four < 100.0)
    return np.where(fits_five, five, np.where(fits_four, four, three))


# Numbers of landmarks and frames, of two and four columns

MOST_LANDMARKS, MOST_FRAMES = 99, 9999  # two and four columns


def _within(what: str, count: int, most: int) -> None:
    if count > most:
        raise VopdError(f"{count} {what}: cards have numbers for {most}; punch a part of them")


def landmark_numbers(flight: Flight, seen: Ints) -> tuple[Ints, list[NumberRow]]:
    """Number the landmarks of the flight in two columns (N,), 0 for one that is not seen.

    Returns:
        The numbers, and what they stand for where they are not the flight's own.

    Raises:
        VopdError: where there are more landmarks than numbers
    """
    _within("landmarks", len(seen), MOST_LANDMARKS)
    own = flight.landmarks.number
    keeps = all(
        0 < own[k] <= MOST_LANDMARKS and _is_its_name(int(own[k]), flight.landmarks.name[k])
        for k in seen
    )
    number = np.zeros(len(own), np.int64)
    number[seen] = own[seen] if keeps else np.arange(1, len(seen) + 1)
    rows = [("landmark", int(number[k]), flight.landmarks.name[k]) for k in seen]
    return number, [] if keeps else rows


def _is_its_name(number: int, name: str) -> bool:
    """Compare a landmark's name with its number."""
    return name.isascii() and name.isdigit() and int(name) == number


def frame_numbers(flight: Flight, frames: Ints) -> tuple[Ints, list[NumberRow]]:
    """Number the frames that are written in four columns; by their own where that fits.

    Returns:
        The numbers, and what they stand for where they are not the flight's own.

    Raises:
        VopdError: where there are more frames than numbers
    """
    _within("frames", len(frames), MOST_FRAMES)
    own = flight.frame[frames]
    if not flight.image_name and own.min(initial=0) >= 0 and own.max(initial=0) <= MOST_FRAMES:
        return own, []
    number = np.arange(1, len(frames) + 1)
    names = flight.image_name or tuple(str(n) for n in flight.frame)
    return number, [("frame", int(n), names[k]) for n, k in zip(number, frames, strict=True)]


def frame_times(flight: Flight, frames: Ints) -> tuple[Floats, list[str]]:
    """Time the frames, increasing from frame to frame, to what ten columns hold."""
    own_s = flight.time_s[frames]
    first_s = float(np.floor(own_s[0]))
    counted = f"times on the cards are counted from {first_s:.0f} s: ten columns do not hold them"
    for zero_s, notes in ((0.0, []), (first_s, [counted])):
        time_s = np.array([rounded_to_fit(t, 82, 0) for t in own_s - zero_s])
        if np.isfinite(time_s).all() and (np.diff(time_s) > 0.0).all():
            return time_s, notes
    note = "the frames have no times that increase: on the cards they are a second apart"
    return np.arange(len(frames), dtype=np.float64), [note]
