"""A synthetic flight: the jobs of its deck, and the truth they were made from."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vopd.demo.attitude import attitude
from vopd.demo.camera import lens_table, view
from vopd.demo.film import readings
from vopd.demo.flight import clock, position_ft, trajectory, wind
from vopd.demo.ground import choose, place
from vopd.demo.plan import Plan
from vopd.job import Camera, Floats, Ignored, Ints, Job

MULTIPLIER = np.array([1.0, 1.0, 1.0])  # of group 3, and the offsets, as in case 1
OFFSET_DEG = np.array([0.0, 0.0, -210.0])

STOP = 13
AGAIN = (12, 9, 8, 2)
"""Return groups of stacked jobs, in turn: what the next job reads again."""


@dataclass(frozen=True)
class Truth:
    """What a run should find, a row a frame in the order of the deck (F,) and (F, 3)."""

    frame: Ints
    time_s: Floats
    camera_deg: Floats  # yaw 0..360, pitch, roll 0..360
    vehicle_deg: Floats  # the same by group 3
    position_ft: Floats  # east, north, up of the origin


def make(plan: Plan) -> tuple[list[Job], Truth]:
    """The jobs of a deck and its truth; every job is of the same flight.

    Raises `VopdError` where 99 landmark numbers are not enough.
    """
    number = plan.numbers()
    times = clock(plan)
    film = np.arange(1, number.max() + 1, dtype=np.int64)  # each frame once
    time_s = np.interp(film, times.frame, times.time_s)
    path = trajectory(plan, float(times.time_s[-1]))
    where = position_ft(path, time_s)
    estimate, camera_deg = attitude(plan, time_s)
    seen = view(path, where, camera_deg)
    marks = place(plan, seen)
    which, image = choose(plan, seen, marks)

    row = number - 1
    radius, distortion = lens_table(plan)
    first = Job(
        title=f"1   SYNTHETIC FLIGHT {plan.seed}".ljust(80)[:80],
        camera=Camera(
            plan.focal_length_mm, radius, distortion, MULTIPLIER, OFFSET_DEG, estimate,
        ),
        trajectory=path,
        wind=wind(plan),
        clock=times,
        landmarks=marks,
        ignored=Ignored(
            np.zeros(0, np.int64), np.zeros((0, 6), np.int64), np.zeros_like(marks.number)
        ),
        readings=readings(plan, number, marks.number[which[row]], image[row], 0),
        return_group=AGAIN[0] if plan.jobs > 1 else STOP,
    )
    vehicle = camera_deg * MULTIPLIER + OFFSET_DEG
    vehicle[:, [0, 2]] %= 360.0
    truth = Truth(number, time_s[row], camera_deg[row], vehicle[row], where[row])
    return [first], truth
