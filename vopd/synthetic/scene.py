"""Makes a synthetic flight: the jobs of its deck and the true attitude."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.job import Camera, Ignored, Job, Readings
from vopd.synthetic.camera import lens_table, view
from vopd.synthetic.camera_swing import camera_swing
from vopd.synthetic.film import choose_landmarks, read_film
from vopd.synthetic.flight import clock, frame_numbers, position_ft, trajectory, wind
from vopd.synthetic.ground import place_landmarks
from vopd.synthetic.plan import Plan

MULTIPLIER = np.ones(3)  # group 3, as in case 1
OFFSET_DEG = np.array([0.0, 0.0, -210.0])
RETURN_GROUPS = (12, 9, 8, 2)  # in turn: where the next job starts reading
STOP = 13


@dataclass(frozen=True)
class Truth:
    """The true attitude and position of a synthetic flight, a row for each frame of the deck."""

    frame: Ints  # (F,)
    time_s: Floats  # (F,)
    camera_deg: Floats  # (F, 3) yaw 0..360, pitch, roll 0..360
    vehicle_deg: Floats  # (F, 3) the same by group 3
    position_ft: Floats  # (F, 3) east, north, up of the origin


def make(plan: Plan) -> tuple[list[Job], Truth]:
    """Make the jobs of a deck, all of the same flight, and its true attitude.

    The second job ignores landmark 1 (return group 12), the third does not (9),
    the fourth starts from another estimate (8), the fifth from the film read
    anew (2), and so on in turn.

    Args:
        plan: the parameters of the flight

    Returns:
        The jobs, ready for `write_deck`; and the truth.

    Raises:
        VopdError: where 99 landmark numbers are not enough.
    """
    number = frame_numbers(plan)
    times = clock(plan)
    time_s = np.interp(np.arange(1, number.max() + 1), times.frame, times.time_s)
    path = trajectory(plan, float(times.time_s[-1]))
    where = position_ft(path, time_s)
    estimate, camera_deg = camera_swing(plan, time_s)
    seen = view(path, where, camera_deg)
    marks, which, image = choose_landmarks(plan, seen, place_landmarks(plan, seen))

    def film(time: int) -> Readings:
        return read_film(plan, number, marks.number[which[number - 1]], image[number - 1], time)

    camera = Camera(
        plan.focal_length_mm, *lens_table(plan), MULTIPLIER, OFFSET_DEG, initial_deg=estimate
    )
    no_cards = np.zeros(0, np.int64), np.zeros((0, 6), np.int64)
    first = Job(
        title=f"1   SYNTHETIC FLIGHT {plan.seed}".ljust(80),
        camera=camera,
        trajectory=path,
        wind=wind(plan),
        clock=times,
        landmarks=marks,
        ignored=Ignored(*no_cards, everywhere=np.zeros_like(marks.number)),
        readings=film(0),
        return_group=STOP,
    )
    vehicle_deg = camera_deg * MULTIPLIER + OFFSET_DEG  # in range: roll stays above 210 degrees
    truth = Truth(number, *(a[number - 1] for a in (time_s, camera_deg, vehicle_deg, where)))
    return _stacked(first, plan.jobs, film), truth


def _stacked(first: Job, count: int, film: Callable[[int], Readings]) -> list[Job]:
    """The first job and those that follow it by their return groups."""
    jobs = [first]
    for k in range(count - 1):
        group, job = RETURN_GROUPS[k % len(RETURN_GROUPS)], jobs[-1]
        jobs[-1] = replace(job, return_group=group)
        if group == 12:
            everywhere = np.where(job.landmarks.number == 1, 1, 0)
            job = replace(job, ignored=replace(job.ignored, everywhere=everywhere))
        else:
            job = replace(job, ignored=first.ignored)
        if group == 8:
            turned = job.camera.initial_deg + np.array([-3.0, 2.0, 3.0])
            job = replace(job, camera=replace(job.camera, initial_deg=turned))
        if group == 2:
            job = replace(job, camera=first.camera, readings=film(1 + k))
        jobs.append(job)
    return jobs
