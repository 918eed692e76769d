"""Checks of the basic data: readings, fiducials, frame numbers and landmarks of each frame.

Every rule is given a job, the locations of its cards, and the limit of the
spread of readings that was asked for; it yields warnings.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.cards.format import BASIC_DATA
from vopd.check.card_locations import CardLocations, decimal_text
from vopd.check.reading_spread import spread_limit_in
from vopd.copied_readings import copied_readings_text
from vopd.findings import Finding
from vopd.job import Job
from vopd.program.average import averages
from vopd.program.constants import factor
from vopd.program.ignored import kept

RECTANGLE_IN = 0.050  # by which corners' distances from their centre may differ: film shrinks
ROUNDING_IN = 1e-9  # readings are decimals of .001 in, and their differences are not exact


def reading_spread(
    job: Job, locations: CardLocations, spread_in: float | None
) -> Iterator[Finding]:
    """Warn where three readings of one point differ by more than the limit."""
    readings = job.readings
    limit = spread_limit_in(readings) if spread_in is None else spread_in
    starts, layout = first_rows(job), readings.layout
    of_fiducials = (starts[:, None] + 3 * np.arange(4)).ravel()
    of_landmarks = starts[layout.frame] + 12
    of_landmarks += 3 * (np.arange(layout.total) - layout.start[layout.frame])
    for points, rows in (
        (readings.fiducial_in.reshape(-1, 3, 2), of_fiducials),
        (readings.points.landmark_in, of_landmarks),
    ):
        spread: Floats = np.ptp(points, axis=1)
        for k in np.flatnonzero((spread > limit + ROUNDING_IN).any(axis=1)):
            axis = int(spread[k].argmax())
            by = decimal_text(spread[k, axis], 3)
            message = f"three readings of this point differ by {by} in (limit {limit:.3f} in)"
            field = ("XSAVE", "YSAVE")[axis]
            yield locations.warning(BASIC_DATA.number, int(rows[k]), field, message)


def copied_readings(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
    """Warn where the three readings of most points are copies of each other."""
    message = copied_readings_text(job.readings)
    if message:
        yield locations.warning(BASIC_DATA.number, 0, "", message)


def fiducials(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
    """Warn where the four fiducials are not equally far from their centre, as corners should be."""
    corners = job.readings.fiducial_in.mean(axis=2)
    away = np.linalg.norm(corners - corners.mean(axis=1, keepdims=True), axis=2)
    starts = first_rows(job)
    for k in np.flatnonzero(np.ptp(away, axis=1) > RECTANGLE_IN):
        nearest, farthest = decimal_text(away[k].min(), 3), decimal_text(away[k].max(), 3)
        message = (
            f"the fiducials of frame {job.readings.frame[k]} form no rectangle: "
            f"{nearest} to {farthest} in from their centre"
        )
        yield locations.warning(BASIC_DATA.number, int(starts[k]), "", message)


def frame_order(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
    """Warn of frames that occur twice, or that come after a frame with a larger number."""
    frame = job.readings.frame
    starts = first_rows(job)
    seen: set[int] = set()
    for k, number in enumerate(frame.tolist()):
        if number in seen:
            message = f"frame {number} has been read before"
        elif k and number < frame[k - 1]:
            message = f"frame {number} comes after frame {frame[k - 1]}"
        else:
            message = ""
        seen.add(number)
        if message:
            yield locations.warning(BASIC_DATA.number, int(starts[k]), "IFRAM", message)


def too_few_landmarks(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
    """Warn of frames in which fewer than two different landmarks take part."""
    readings = job.readings
    dropped, used = kept(readings, job.ignored)
    starts = first_rows(job)
    layout, landmark = readings.layout, readings.points.landmark
    for k in np.flatnonzero((layout.distinct(landmark, used) < 2) & ~dropped):
        which = landmark[layout.span(k)][used[layout.span(k)]]
        message = (
            f"frame {readings.frame[k]} has only landmark {which[0]}; "
            "an attitude needs two different landmarks"
        )
        yield locations.warning(BASIC_DATA.number, int(starts[k]), "", message)


def lens_reach(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
    """Warn where the lens table does not reach the outermost landmark."""
    centre, point = averages(job.readings)
    used = kept(job.readings, job.ignored).used
    radius = np.linalg.norm((point - centre[job.readings.layout.frame]) * factor, axis=1)
    table = job.camera.lens_radius_mm
    if used.any() and radius[used].max() > table.max():
        message = (
            f"a landmark is {decimal_text(radius[used].max(), 2)} mm from the centre: "
            "the lens table is extrapolated"
        )
        yield locations.warning(1, int(table.argmax()), "XRR", message)


def first_rows(job: Job) -> Ints:
    """Index of the first card of each frame within the basic data (F,)."""
    cards = 12 + 3 * job.readings.layout.count
    return np.asarray(np.cumsum(cards) - cards)
