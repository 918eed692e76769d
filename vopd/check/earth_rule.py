"""Check whether the 1974 program's Earth is good enough for a deck's distances and heights.

The program's Earth is a sphere, its landmarks are up to 33 m beside their latitude,
and its vertical is perpendicular to the sphere. So a landmark is seen from the
camera in a slightly wrong direction relative to the local axes, the more so the nearer it is.
Let d be the unit vector to a landmark on that Earth, and d + e the one on the
ellipsoid, each in the local axes of its own Earth. The small rotation w that
brings all d of a frame as near to d + e as it can, by least squares, is

    sum(1 - d d') w = sum(d x e),

and its length is the angle that the 1974 Earth costs the frame's attitude. It depends on
the cards' positions alone, not on the readings.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.cards.format import BASIC_DATA
from vopd.check.card_locations import CardLocations, decimal_text
from vopd.check.film_rules import first_rows
from vopd.errata import NO_FIXES, Fix, Fixes
from vopd.findings import Finding
from vopd.geometry.linear import pseudo_inverse
from vopd.job import Job
from vopd.program.frames import check_landmarks, frames_of
from vopd.program.ftlup import TableNotANumber, TableOutOfOrder
from vopd.program.positions import (
    LandmarkPositions,
    UndefinedLandmark,
    directions,
    earth_fixed,
    group_9,
    origin_of,
    time_and_position,
)

LIMIT_DEG = 0.1
"""Twice what the original's Earth costs in the flights of its report, .01 to .05 degree."""

ELLIPSOID = Fixes(frozenset({Fix.EARTH}))


class EarthCost(NamedTuple):
    """What the 1974 Earth costs each of F frames; NaN where that cannot be computed."""

    angle_deg: Floats  # (F,) of the rotation of the attitude
    shift_m: Floats  # (F,) how far landmarks are displaced against the camera, on average
    distance_km: Floats  # (F,) of the landmarks from the camera, on average


def earth_of_1974(job: Job, locations: CardLocations, _: float | None) -> Iterator[Finding]:
    """Warn where the program's Earth turns the attitude by more than `LIMIT_DEG`."""
    try:
        cost = earth_cost(job)
    except (TableOutOfOrder, TableNotANumber, UndefinedLandmark):
        return  # errors of their own
    angle = np.nan_to_num(cost.angle_deg, posinf=0.0)
    k, count = int(angle.argmax()), int((angle > LIMIT_DEG).sum())
    if not count:
        return
    which = f"frame {job.readings.frame[k]}"
    frames = which if count == 1 else f"{count} frames, most of all in {which}"
    message = (
        f"the spherical Earth of 1974 turns the attitude by {decimal_text(angle[k], 2)} degrees in "
        f"{frames}: it displaces the landmarks by {decimal_text(cost.shift_m[k], 1)} m against the "
        f"camera, {decimal_text(cost.distance_km[k], 2)} km away; run the deck with --fix earth"
    )
    yield locations.warning(BASIC_DATA.number, int(first_rows(job)[k]), "", message)


@np.errstate(all="ignore")
def earth_cost(job: Job) -> EarthCost:
    """Compute what the program's Earth, in the place of WGS 84, costs every frame.

    Args:
        job: its landmarks, origin and trajectory

    Raises:
        VopdError: where a table is out of order, or a landmark is not defined
    """
    film = frames_of([job])
    frame, count = film.of, film.nj
    there_ft = time_and_position(job)[1][frame]
    check_landmarks(film)

    def positions(fixes: Fixes) -> LandmarkPositions:
        return group_9(job.landmarks, fixes).take(film.card)

    on_wgs84 = positions(ELLIPSOID)
    old = directions(origin_of(job), NO_FIXES, there_ft, *positions(NO_FIXES))
    change = directions(origin_of(job), ELLIPSOID, there_ft, *on_wgs84) - old

    def summed(values: Floats) -> Floats:
        """Values of the landmarks (N, ...), added up in each frame."""
        total = np.zeros((len(count), *values.shape[1:]))
        np.add.at(total, frame, values)
        return total

    normal = summed(np.eye(3) - old[:, :, None] * old[:, None, :])
    rotation = (pseudo_inverse(normal) @ summed(np.cross(old, change))[..., None])[..., 0]
    distance = _distance_km(on_wgs84, earth_fixed(origin_of(job), ELLIPSOID, there_ft))
    shift = np.linalg.norm(change, axis=1) * distance * 1000.0
    return EarthCost(
        np.degrees(np.linalg.norm(rotation, axis=1)),
        summed(shift) / count,
        summed(distance) / count,
    )


def _distance_km(marks: LandmarkPositions, camera: Floats) -> Floats:
    """Distances (N,) of landmarks from a camera in Earth-fixed axes (N, 3) km."""
    latitude, longitude = np.radians(marks.latitude_deg), np.radians(marks.longitude_deg)
    east, north = np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude)
    landmark = marks.radius_km[:, None] * np.stack([east, north, np.sin(latitude)], axis=-1)
    return np.asarray(np.linalg.norm(landmark - camera, axis=1))
