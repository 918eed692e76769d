"""A feature of a deck's film whose coordinates are to be found: its card, and the joint solution.

The joint solution frees a landmark of group 9 and solves the deck, as a flight in memory, by least
squares of all its readings. One frame tells the direction of a landmark, and not how far it is.
"""

from __future__ import annotations

import io
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.cards.deck import CardBlock
from vopd.cards.format import format_items
from vopd.cards.numbers import rounded_to_fit, write_number
from vopd.cards.read import read_jobs
from vopd.convert.deck_to_flight import M_PER_FT, deck_flight, landmark_positions_m
from vopd.errata import Fixes
from vopd.findings import VopdError, size_text
from vopd.flight.adjust.adjustment import Adjustment, adjust
from vopd.flight.coordinates import coordinates_at
from vopd.flight.parameters import Parameter
from vopd.job import Job, Landmarks
from vopd.program.ignored import kept

# The card of a landmark. Coordinates are latitude and longitude, degrees, and altitude, feet.

NAMES = ("latitude", "longitude", "altitude")
UNITS = ("deg", "deg", "ft")
GROUP_9, FORMAT_9, NUMBER_COLUMNS, LAST_COLUMN = 9, 83, 10, 60
POLE_DEG = 90.0
MINUTE_DECIMALS, FOOT_DECIMALS = 5, 1  # .00001 minute is .06 ft; ten columns hold both


def check_feature(job: Job, number: int, name: str) -> None:
    """Check that a landmark stands once in group 9, not at a pole, and is read.

    Raises:
        VopdError: if it is not
    """
    numbers = job.landmarks.number.tolist()
    if number not in numbers:
        known = ", ".join(str(one) for one in dict.fromkeys(numbers))
        raise VopdError(f"{name}: group 9 has no landmark {number}; it has {known}")
    if numbers.count(number) > 1:
        raise VopdError(
            f"{name}: group 9 has landmark {number} {numbers.count(number)} times, and the last "
            "card counts: take the others out, and lower the number of landmarks in group 5"
        )
    if number not in job.readings.points.landmark:
        raise VopdError(
            f"{name}: landmark {number} is read in no frame: read it on the film, or free another"
        )
    if abs(coordinates_of(job, number)[0]) == POLE_DEG:
        raise VopdError(
            f"{name}: group 9 has landmark {number} at a pole, where longitudes meet: look at its "
            "card"
        )


def ignoring(job: Job, number: int, ignored: bool) -> Job:
    """Ignore a landmark in all frames by group 12, or no longer do so."""
    everywhere = job.ignored.everywhere.copy()
    everywhere[everywhere == number] = 0
    if ignored:
        everywhere[np.flatnonzero(everywhere == 0)[:1]] = number
    return replace(job, ignored=replace(job.ignored, everywhere=everywhere))


def frames_that_locate(job: Job, number: int) -> tuple[Bools, Bools]:
    """Find the frames that can locate a landmark: those in which others take part with it.

    Returns:
        The frames with one other landmark or more, and those with two others or more, whose
        attitude is known without it, both (F,).
    """
    layout, own = job.readings.layout, job.readings.points.landmark == number
    _, used = kept(job.readings, ignoring(job, number, False).ignored)
    _, without = kept(job.readings, ignoring(job, number, True).ignored)
    there, others = layout.counted(used & own) > 0, layout.counted(used & ~own)
    given = used & ~own & ~np.isin(job.readings.points.landmark, job.ignored.everywhere)
    known = (others >= 2) & (layout.counted(without & own) == 0)
    return there & (layout.counted(given) >= 1), there & known


def coordinates_of(job: Job, number: int) -> Floats:
    """Look up the coordinates of a landmark, (3,).

    Args:
        job: the job
        number: of the landmark, which stands once in group 9
    """
    marks = job.landmarks
    (k,) = np.flatnonzero(marks.number == number)
    return np.array(
        [
            marks.latitude_deg[k] + marks.latitude_min[k] / 60.0,
            marks.longitude_deg[k] + marks.longitude_min[k] / 60.0,
            marks.altitude_ft[k],
        ]
    )


def with_coordinates(job: Job, number: int, coordinates: Floats) -> Job:
    """Move a landmark, its coordinates rounded to what its card holds.

    The whole degrees of the card stay, unless the minutes would be 60 or more.

    Args:
        job: the job
        number: of the landmark, which stands once in group 9
        coordinates: where to, (3,)
    """
    marks = job.landmarks
    (k,) = np.flatnonzero(marks.number == number)
    columns: dict[str, Any] = {"altitude_ft": marks.altitude_ft.copy()}
    altitude_ft = round(float(coordinates[2]), FOOT_DECIMALS) + 0.0
    columns["altitude_ft"][k] = rounded_to_fit(altitude_ft, FORMAT_9, 5)
    for name, value in zip(NAMES, coordinates[:2].tolist(), strict=False):
        degrees = getattr(marks, f"{name}_deg").copy()
        minutes = getattr(marks, f"{name}_min").copy()
        whole = round(value * 60.0, MINUTE_DECIMALS)
        if abs(whole - 60.0 * degrees[k]) >= 60.0:
            degrees[k] = np.trunc(whole / 60.0)
        minutes[k] = round(whole - 60.0 * degrees[k], MINUTE_DECIMALS) + 0.0
        columns |= {f"{name}_deg": degrees, f"{name}_min": minutes}
    return replace(job, landmarks=replace(marks, **columns))


def deck_with_landmark(content: bytes, name: str, job: Job, number: int) -> bytes:
    """Write a deck with the coordinates of one landmark in group 9 changed, and nothing else.

    Args:
        content: the deck of one job
        name: of the deck, for messages
        job: the job with the landmark moved
        number: of the landmark

    Raises:
        VopdError: if the deck cannot be written so
    """
    marks = job.landmarks
    (k,) = np.flatnonzero(marks.number == number)
    blocks: list[CardBlock] = []
    (before,) = read_jobs(io.BytesIO(content), name, lambda _: None, on_cards=blocks.append)
    (cards,) = (block for block in blocks if block.where.group == GROUP_9)
    at = cards.first + int(k)
    image = cards.image(int(k))[:NUMBER_COLUMNS]
    columns = ("longitude_deg", "longitude_min", "latitude_deg", "latitude_min", "altitude_ft")
    for item, column in zip(format_items(FORMAT_9)[1:], columns, strict=True):
        text = write_number(float(getattr(marks, column)[k]), item)
        assert text is not None  # with_coordinates rounds to what the columns hold
        image += text
    lines = content.split(b"\n")
    line = lines[at - 1]
    rest = line.rstrip(b"\r")[LAST_COLUMN:]
    lines[at - 1] = image.encode("ascii") + rest + b"\r" * line.endswith(b"\r")
    written = b"\n".join(lines)
    (after,) = read_jobs(io.BytesIO(written), name, lambda _: None)
    if after != replace(before, landmarks=marks):
        raise VopdError(f"{name}: card {at} of landmark {number} cannot be written; punch it anew")
    return written


# The Earth of a run: coordinates of the cards, and Earth-fixed positions

STEP = np.array([1e-4, 1e-4, 10.0])  # of differences: the map is smooth


def place_m(coordinates: Floats, fixes: Fixes) -> Floats:
    """Place coordinates (n, 3) in Earth-fixed axes, metres."""
    latitude, longitude, altitude = coordinates.T
    zero = np.zeros_like(latitude)
    number = np.zeros(len(latitude), np.int64)
    marks = Landmarks(number, longitude, zero, latitude, zero, altitude)
    return landmark_positions_m(marks, fixes)


def by_position(coordinates: Floats, fixes: Fixes) -> Floats:
    """Differentiate coordinates by the Earth-fixed position, degrees and feet a metre, (3, 3).

    Args:
        coordinates: where, (3,)
        fixes: those of the run, which choose its Earth
    """
    sides = np.concatenate([coordinates + np.diag(STEP), coordinates - np.diag(STEP)])
    place = place_m(sides, fixes)
    return np.asarray(np.linalg.inv((place[:3] - place[3:]).T / (2.0 * STEP)))


# The joint solution

FREE_PART = 0.7  # of a stated standard deviation: a direction that keeps more is not held
UNKNOWN_FT = 1e6  # stands for no standard deviation: farther than a camera sees
AS_BADLY = 0.99  # of the largest variance: a direction that is known no better
ALONG = 0.9  # cosine between the line of sight and the direction that is known worst
FARTHEST = 0.5  # of the distance: a standard deviation along the line of sight that says nothing


@dataclass(frozen=True, eq=False)
class LocatedFeature:
    """A landmark of a deck, located by all its frames together."""

    number: int  # of the landmark
    frames: int  # how many tell of it
    job: Job  # the deck's, with the landmark where it was found, rounded as its card is
    # the solved deck; its parameters are latitude and longitude, degrees, and altitude, feet
    adjustment: Adjustment
    sigma_ft: Floats  # standard deviations along the axes of its ellipsoid, the largest first, (3,)
    rounded_ft: float  # how far the card is from the solution
    notes: tuple[str, ...]  # how well its frames hold it, a sentence each


def locate_feature(
    job: Job, number: int, fixes: Fixes, name: str = "", sigma_ft: float | None = None
) -> LocatedFeature:
    """Locate a landmark of a deck by least squares of all readings, its coordinates free.

    All else that the cards state is exact.

    Args:
        job: the deck's only job
        number: of the landmark
        fixes: those of the run, which choose its Earth
        name: of the deck, for messages
        sigma_ft: prior standard deviation of the landmark, east, north and up; None: none

    Raises:
        VopdError: if the landmark is not on the cards once, or its frames do not locate it
    """
    check_feature(job, number, name)
    telling = int(frames_that_locate(job, number)[0].sum())
    if telling == 0:
        raise VopdError(
            f"{name}: no frame has landmark {number} and another one that takes part: read known "
            "landmarks in its frames, or ignore fewer of them in groups 11 and 12"
        )
    if telling == 1 and sigma_ft is None:
        raise VopdError(
            f"{name}: landmark {number} is read in one frame, along whose line of sight it is "
            "free: read it in frames from other places, or state how well its coordinates are "
            "known by --landmark-sigma"
        )
    flight = deck_flight(ignoring(job, number, False), fixes, name)
    (at,) = (k for k, one in enumerate(flight.landmarks.name) if one == str(number))
    sigma_m = flight.landmarks.sigma_m.copy()
    sigma_m[at] = (UNKNOWN_FT if sigma_ft is None else sigma_ft) * M_PER_FT
    flight = replace(flight, landmarks=replace(flight.landmarks, sigma_m=sigma_m))
    solved = adjust(flight, [f"landmark:{number}"])
    if not solved.parameters:
        raise VopdError(
            f"{name}: landmark {number} lies behind the camera in all frames, as the others have "
            "them: look at its card in group 9"
        )
    doubts = solved.result.findings  # lines of sight are spoken of in feet, by the notes
    doubts = tuple(one for one in doubts if not one.message.startswith(f"free landmark:{number}:"))
    axes, stated = flight.landmarks.axes[at], flight.landmarks.position_m[at]
    moved_m = np.array([one.after - one.before for one in solved.parameters])
    before = coordinates_of(job, number)
    wanted_m = (stated + axes.T @ moved_m)[None]
    (after,) = coordinates_at(wanted_m, before[None], lambda at: place_m(at, fixes), STEP.tolist())
    by_enu = by_position(after, fixes) @ axes.T
    covariance = by_enu @ solved.covariance @ by_enu.T
    size, way = np.linalg.eigh(solved.covariance)
    along_ft = np.sqrt(np.maximum(size[::-1], 0.0)) / M_PER_FT
    camera = flight.path.position_m[flight.picks.frame[flight.picks.landmark == at]].mean(axis=0)
    sight = axes @ (stated - camera)
    reach_ft = float(np.linalg.norm(sight)) / M_PER_FT
    worst = way[:, size > AS_BADLY * size[2]]  # of two alike any direction of their plane is one
    sighted = bool(np.linalg.norm(worst.T @ sight) > ALONG * np.linalg.norm(sight))
    if sigma_ft is None and not along_ft[0] < FARTHEST * reach_ft:
        raise VopdError(
            f"{along_one_line(name, number, telling)}, or state how well its coordinates are known "
            "by --landmark-sigma"
        )
    prior = np.full(3, np.inf)
    if sigma_ft is not None:
        prior = sigma_ft * M_PER_FT * np.linalg.norm(by_enu, axis=1)
    held = sigma_ft is None or bool(along_ft[0] < FREE_PART * sigma_ft)
    sigma = np.sqrt(np.diag(covariance))
    moved = with_coordinates(job, number, after)
    rounded = place_m(coordinates_of(moved, number)[None], fixes)[0]
    rounded_ft = float(np.linalg.norm(rounded - stated - axes.T @ moved_m)) / M_PER_FT
    parameters = [
        Parameter(
            f"landmark:{number} {part}", UNITS[k], float(before[k]), float(after[k]),
            float(prior[k]), float(sigma[k]), held,
        )
        for k, part in enumerate(NAMES)
    ]  # fmt: skip
    return LocatedFeature(
        number=number,
        frames=telling,
        job=moved,
        adjustment=Adjustment(
            replace(solved.result, findings=doubts), tuple(parameters), covariance
        ),
        sigma_ft=along_ft,
        rounded_ft=rounded_ft,
        notes=tuple(_notes(number, along_ft, sighted, held, rounded_ft)),
    )


def along_one_line(name: str, number: int, frames: int) -> str:
    """Say that a landmark is free on the line along which its frames see it."""
    return (
        f"{name}: the {frames} frames of landmark {number} see it along one line, on which it is "
        "free: read it in frames from other places"
    )


def _notes(
    number: int, along_ft: Floats, sighted: bool, held: bool, rounded_ft: float
) -> list[str]:
    """Say how well the landmark is known across and along, and what rounding costs."""
    where = "along its line of sight" if sighted else "along the longest axis"
    across = float(along_ft[1])
    notes = [
        f"landmark {number} is known to {size_text(along_ft[0], 3)} ft {where} and to "
        f"{size_text(across, 3)} ft across"
    ]
    if not held:
        notes.append(
            f"{where} its frames do not hold it, and what is stated stays: read it in frames from "
            "other places"
        )
    notes.append(
        f"group 9 has it to .00001 minute and .1 ft, {size_text(rounded_ft)} ft from the solution: "
        f"{size_text(rounded_ft / along_ft[2])} of its smallest standard deviation"
    )
    return notes
