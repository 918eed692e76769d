"""The path and the wind a millisecond before and after each frame, and at other velocities."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.kit.jobs import film
from tests.tolerances import assert_close
from vopd.film import PathLookup, joined_jobs
from vopd.job import Job
from vopd.program.vopd import run

MS = 1e-3
NEITHER_BEFORE_AFTER = [0.0, MS, -MS]


def flown(frames: int, climb: float, wind: float) -> Job:
    """1000 ft a second east, 10 south; each velocity and the wind grow by the second."""
    job = film(frames)
    time = np.array([-50.0, 50.0])
    path = replace(
        job.trajectory,
        time_s=time,
        position_ft=job.trajectory.position_ft[:1] + time[:, None] * [1000.0, -10.0, climb],
        velocity_ft_s=np.array([[-10.0, 1000.0, -climb]]) + time[:, None] * [1.0, 2.0, 3.0],
        altitude_ft=120000.0 + time * climb,
    )
    speeds = np.array([[0.0, 0.0], [wind, -wind]])
    air = replace(job.wind, altitude_ft=np.array([110000.0, 130000.0]), velocity_ft_s=speeds)
    return replace(job, trajectory=path, wind=air)


def looked_up(*jobs: Job) -> tuple[PathLookup, np.ndarray]:
    joined = joined_jobs([run(job) for job in jobs])
    return joined.path, joined.results.time_s


def hold(path: PathLookup, time_s: np.ndarray, frames: slice, climb: float, wind: float) -> None:
    """What is linear in the time, by hand."""
    for f, at in zip(range(frames.start, frames.stop), time_s[frames].tolist(), strict=True):
        assert_close("vehicle position", path.altitude_ft[f], 120000.0 + at * climb)
        for k, after in enumerate(NEITHER_BEFORE_AFTER):
            moved = [1000.0 * after, -10.0 * after, climb * after]
            assert_close("vehicle position", path.travelled_ft[f, k], moved)
            velocity = np.array([-10.0, 1000.0, -climb]) + (at + after) * np.array([1.0, 2.0, 3.0])
            steps = np.concatenate([np.zeros((1, 3)), np.eye(3) * MS, np.eye(3) * -MS])
            assert_close("airspeed", path.velocity_ft_s[f, k], velocity + steps)
            part = (10000.0 + (at + after) * climb) / 20000.0
            assert_close("airspeed", path.wind_ft_s[f, k], [wind * part, -wind * part])


def test_of_jobs_together_each_by_its_tables() -> None:
    path, time_s = looked_up(flown(2, 5.0, 40.0), flown(3, -80.0, 300.0))
    hold(path, time_s, slice(0, 2), 5.0, 40.0)
    hold(path, time_s, slice(2, 5), -80.0, 300.0)


def test_a_job_whose_wind_is_out_of_order_leaves_the_others_theirs() -> None:
    """Its own wind is NaN; so is that of no other."""
    bad = flown(2, 5.0, 40.0)
    bad = replace(bad, wind=replace(bad.wind, altitude_ft=np.array([9.0, 9.0])))
    path, time_s = looked_up(flown(2, 1.0, 40.0), bad, flown(3, -80.0, 300.0))
    hold(path, time_s, slice(0, 2), 1.0, 40.0)
    last = len(time_s) - 3
    assert last > 2 and np.isnan(path.wind_ft_s[2:last]).all()
    assert np.isfinite(path.velocity_ft_s).all()
    hold(path, time_s, slice(last, last + 3), -80.0, 300.0)
