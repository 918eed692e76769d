"""Landmarks on the ground, so placed that every frame has as many in view as asked."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import VopdError
from vopd.job import Landmarks
from vopd.program.geocentric import LANDMARK_FOUR_PHI, geocentric
from vopd.synthetic.camera import View, images, landmark_km, seen_ground
from vopd.synthetic.plan import LIMITS, Part, Plan, stream

MOST = int(LIMITS["landmarks"][1])  # landmark numbers
STEP = 16  # every so many frames are looked at first
AT_A_TIME = 600  # frames, where landmarks are placed
CHUNK = 2000  # frames, where they are counted
POINTS = 1500  # to choose landmarks from
FLATTEST = np.sin(np.radians(8.0))  # slope of the lowest line of sight

ZONES = np.array([[0.05, 0.4], [0.6, 0.95]])
"""Parts of the frame by x, over its width: in each, half of a frame's landmarks."""
IN_Y = (0.04, 0.96)
IN_X = (0.03, 0.97)


def place(plan: Plan, seen: View) -> Landmarks:
    """Landmarks for group 9, to the hundredth of a minute, those that help most frames first.

    Points that lie in some frames' zones are tried; the one that most frames
    need is taken, and again, until no frame lacks a landmark. Raises
    `VopdError` where 99 are not enough.
    """
    random = stream(plan, Part.GROUND)
    chosen = _landmarks(np.zeros((0, 3)))
    lacking = np.arange(0, len(seen.axes), STEP)
    while len(lacking):
        some = seen.only(lacking[:: 1 + len(lacking) // AT_A_TIME])
        pool = _points(plan, some, random)
        before = len(chosen.number)
        chosen = _cover(plan, some, chosen, pool)
        if len(chosen.number) > MOST or len(chosen.number) == before:
            raise VopdError(
                f"{plan.landmarks} landmarks in each of {plan.frames} frames cannot be had from "
                f"{MOST} numbers: ask for fewer landmarks or frames, less swing or another camera"
            )
        lacking = np.flatnonzero((_needs(plan, seen, chosen) > 0).any(axis=1))
    return chosen


def points_km(marks: Landmarks) -> Floats:
    """Where the landmarks are, (N, 3) about the Earth's centre."""
    longitude = marks.longitude_deg + marks.longitude_min / 60.0
    latitude = marks.latitude_deg + marks.latitude_min / 60.0
    return landmark_km(longitude, latitude, marks.altitude_ft)


def _points(plan: Plan, seen: View, random: np.random.Generator) -> Landmarks:
    """Landmarks that might be: some in each zone of these frames."""
    count = -(-POINTS // (len(ZONES) * len(seen.axes)))
    shape = len(seen.axes), len(ZONES) * count
    low, high = np.repeat(ZONES, count, axis=0).T
    x = random.uniform(low, high, shape)
    y = random.uniform(*IN_Y, shape)
    height = np.round(random.uniform(3500.0, 6500.0, shape))
    point = seen_ground(plan, seen, np.stack([x, y], axis=-1) * plan.frame_in, height)
    latitude = np.degrees(np.arctan2(point[..., 2], np.hypot(point[..., 0], point[..., 1])))
    longitude = np.degrees(np.arctan2(point[..., 1], point[..., 0]))
    hit = np.isfinite(latitude)
    return _landmarks(np.column_stack([longitude[hit], _geodetic(latitude[hit]), height[hit]]))


def _geodetic(latitude_deg: Floats) -> Floats:
    """Geodetic latitudes whose series gives these geocentric ones."""
    geodetic = latitude_deg
    for _ in range(5):
        geodetic = geodetic + latitude_deg - geocentric(geodetic, LANDMARK_FOUR_PHI)
    return geodetic


def _landmarks(rows: Floats) -> Landmarks:
    """Longitude, latitude, height (N, 3) as landmarks, degrees and minutes to the hundredth."""
    whole = np.trunc(rows[:, :2])
    minutes = np.round((rows[:, :2] - whole) * 60.0, 2)
    return Landmarks(
        number=np.arange(1, len(rows) + 1, dtype=np.int64),
        longitude_deg=whole[:, 0],
        longitude_min=minutes[:, 0],
        latitude_deg=whole[:, 1],
        latitude_min=minutes[:, 1],
        altitude_ft=rows[:, 2],
    )


def only(marks: Landmarks, which: Ints) -> Landmarks:
    """Some of the landmarks, numbered anew from 1."""
    columns = [getattr(marks, field.name)[which] for field in fields(marks)[1:]]
    return Landmarks(np.arange(1, len(which) + 1, dtype=np.int64), *columns)


def _cover(plan: Plan, seen: View, chosen: Landmarks, pool: Landmarks) -> Landmarks:
    """Add landmarks of `pool` until these frames lack none, or one too many is needed."""
    need = _needs(plan, seen, chosen)
    helps = _zones(plan, seen, pool)
    added: list[int] = []
    while len(chosen.number) + len(added) <= MOST:
        gain = np.tensordot((need > 0).astype(np.float32), helps.astype(np.float32), 2)
        gain[added] = 0.0
        best = int(gain.argmax())
        if not gain[best]:
            break
        need = need - helps[..., best]
        added.append(best)
    columns = [
        np.concatenate([getattr(chosen, field.name), getattr(pool, field.name)[added]])
        for field in fields(chosen)[1:]
    ]
    return Landmarks(np.arange(1, len(columns[0]) + 1, dtype=np.int64), *columns)


def _needs(plan: Plan, seen: View, marks: Landmarks) -> Ints:
    """How many landmarks each zone of each frame still lacks (F, 2)."""
    have = [
        _zones(plan, seen.only(slice(k, k + CHUNK)), marks).sum(axis=2)
        for k in range(0, len(seen.axes), CHUNK)
    ]
    return np.asarray(-(-plan.landmarks // len(ZONES)) - np.concatenate(have))


def _zones(plan: Plan, seen: View, marks: Landmarks) -> Bools:
    """Which landmarks each zone of each frame holds (F, 2, N)."""
    image, slope = images(plan, seen, points_km(marks))
    image = image / plan.frame_in
    visible = slope > FLATTEST
    return np.stack([visible & in_view(image, (low, high)) for low, high in ZONES], axis=1)


def in_view(image: Floats, in_x: tuple[float, float]) -> Bools:
    """Whether images (..., 2), in parts of the frame, are in view and between two x."""
    x, y = image[..., 0], image[..., 1]
    return np.asarray((x > in_x[0]) & (x < in_x[1]) & (y > IN_Y[0]) & (y < IN_Y[1]))
