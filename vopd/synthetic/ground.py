"""Place landmarks on the ground so that every frame has enough of them in view."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import VopdError
from vopd.job import Landmarks
from vopd.program.geocentric import LANDMARK_FOUR_PHI, geocentric
from vopd.synthetic.camera import CameraView, images, landmark_km, seen_ground
from vopd.synthetic.plan import LIMITS, Plan, RandomPart, random_stream

MOST = int(LIMITS["landmarks"][1])  # landmark numbers
STEP = 16  # only every 16th frame is considered first
AT_A_TIME = 600  # frames, where landmarks are placed
FRAMES_COUNTED = 2000  # at a time, where landmarks in view are counted
POINTS = 1500  # to choose landmarks from
FLATTEST = np.sin(np.radians(8.0))  # of the flattest line of sight of a landmark

ZONES = np.array([[0.05, 0.4], [0.6, 0.95]])
"""Two zones of the frame, by x over its width; each has half of a frame's landmarks."""
IN_Y = (0.04, 0.96)
IN_X = (0.03, 0.97)


def place_landmarks(plan: Plan, seen: CameraView) -> Landmarks:
    """Place the landmarks of group 9, to the hundredth of a minute.

    Points in view of some frames are tried; the one that most frames need is
    taken, and so on until no frame lacks a landmark.

    Args:
        plan: the flight
        seen: the camera in all frames

    Returns:
        The landmarks, those that most frames need first.

    Raises:
        VopdError: where 99 landmark numbers are not enough.
    """
    random = random_stream(plan, RandomPart.GROUND)
    chosen = _landmarks(np.zeros((0, 3)))
    lacking = np.arange(0, len(seen.axes), STEP)
    while len(lacking):
        some = seen.only(lacking[:: 1 + len(lacking) // AT_A_TIME])
        pool = _points(plan, some, random)
        before = len(chosen.number)
        chosen = _cover(plan, some, chosen, pool)
        if len(chosen.number) > MOST or len(chosen.number) == before:
            raise VopdError(
                f"{plan.landmarks} landmarks in each of {plan.frames} frames need more than "
                f"{MOST} landmark numbers: ask for fewer landmarks or frames, less swing or "
                "another camera"
            )
        lacking = np.flatnonzero((_needs(plan, seen, chosen) > 0).any(axis=1))
    return chosen


def points_km(marks: Landmarks) -> Floats:
    """Landmarks in Earth-fixed axes, km (N, 3)."""
    longitude = marks.longitude_deg + marks.longitude_min / 60.0
    latitude = marks.latitude_deg + marks.latitude_min / 60.0
    return landmark_km(longitude, latitude, marks.altitude_ft)


def _points(plan: Plan, seen: CameraView, random: np.random.Generator) -> Landmarks:
    """Candidates for landmarks: some random points in each zone of these frames."""
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
    """Geodetic latitudes, of which the program's series gives these geocentric ones."""
    geodetic = latitude_deg
    for _ in range(5):
        geodetic = geodetic + latitude_deg - geocentric(geodetic, LANDMARK_FOUR_PHI)
    return geodetic


def _landmarks(rows: Floats) -> Landmarks:
    """Landmarks from longitude, latitude, deg, and height, ft (N, 3), rounded as on the cards."""
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
    """Select some of the landmarks and number them anew from 1."""
    columns = [getattr(marks, field.name)[which] for field in fields(marks)[1:]]
    return Landmarks(np.arange(1, len(which) + 1, dtype=np.int64), *columns)


def _cover(plan: Plan, seen: CameraView, chosen: Landmarks, pool: Landmarks) -> Landmarks:
    """Add landmarks of `pool` until these frames lack none, or more than `MOST` are needed."""
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


def _needs(plan: Plan, seen: CameraView, marks: Landmarks) -> Ints:
    """How many landmarks each zone of each frame still lacks (F, 2)."""
    have = [
        _zones(plan, seen.only(slice(k, k + FRAMES_COUNTED)), marks).sum(axis=2)
        for k in range(0, len(seen.axes), FRAMES_COUNTED)
    ]
    return np.asarray(-(-plan.landmarks // len(ZONES)) - np.concatenate(have))


def _zones(plan: Plan, seen: CameraView, marks: Landmarks) -> Bools:
    """Which landmarks are in each zone of each frame (F, 2, N)."""
    image, slope = images(plan, seen, points_km(marks))
    image = image / plan.frame_in
    visible = slope > FLATTEST
    return np.stack([visible & in_view(image, (low, high)) for low, high in ZONES], axis=1)


def in_view(image: Floats, in_x: tuple[float, float]) -> Bools:
    """Whether images (..., 2), as fractions of the frame's size, are in view and between two x."""
    x, y = image[..., 0], image[..., 1]
    return np.asarray((x > in_x[0]) & (x < in_x[1]) & (y > IN_Y[0]) & (y < IN_Y[1]))
