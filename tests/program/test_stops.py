"""Tables out of order: which one stops the run, and where."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.jobs import film, reread, without
from vopd.job import Job
from vopd.program.vopd import run
from vopd.results import Outcome, Stage


def reversed_table(job: Job, *names: str) -> Job:
    """The job with these tables in decreasing order."""
    path, wind, clock, camera = job.trajectory, job.wind, job.clock, job.camera
    new = {
        "clock": {"clock": replace(clock, frame=clock.frame[::-1])},
        "trajectory": {"trajectory": replace(path, time_s=path.time_s[::-1])},
        "lens": {"camera": replace(camera, lens_radius_mm=camera.lens_radius_mm[::-1])},
        "wind": {"wind": replace(wind, altitude_ft=wind.altitude_ft[::-1])},
    }
    for name in names:
        job = replace(job, **new[name])
    return job


@pytest.mark.parametrize(
    ("tables", "dropped", "at", "stage", "vard"),
    [
        # the time and trajectory tables are used before a frame is dropped
        (("clock",), (), 0, Stage.TIME, "clock"),
        (("trajectory",), (1,), 0, Stage.TIME, "trajectory"),
        (("clock", "trajectory", "lens", "wind"), (), 0, Stage.TIME, "clock"),
        # the lens table by the first frame that is not, in its first pass
        (("lens",), (), 0, Stage.LENS, "lens"),
        (("lens", "wind"), (1, 2), 2, Stage.LENS, "lens"),
        # the wind in pass 22
        (("wind",), (1,), 1, Stage.WIND, "wind"),
    ],
)
def test_a_table_out_of_order_stops_the_run(
    tables: tuple[str, ...], dropped: tuple[int, ...], at: int, stage: Stage, vard: str
) -> None:
    job = without(reversed_table(film(4), *tables), *dropped)
    stop = run(job).stop
    assert stop is not None
    assert (stop.frame_index, stop.stage, stop.position) == (at, stage, 2)
    named = {
        "clock": (6, "frame numbers"),
        "trajectory": (7, "times"),
        "lens": (1, "radial distances"),
        "wind": (4, "altitudes"),
    }
    assert (stop.group, stop.table) == named[vard]
    wanted = {
        "clock": (job.clock.frame, job.clock.time_s),
        "trajectory": (job.trajectory.time_s, job.trajectory.position_ft[:, 0]),
        "lens": (job.camera.lens_radius_mm, job.camera.lens_distortion_um),
        "wind": (job.wind.altitude_ft, job.wind.velocity_ft_s[:, 0]),
    }[vard]
    np.testing.assert_array_equal(stop.vari, wanted[0])
    np.testing.assert_array_equal(stop.vard, wanted[1])
    outcome = run(job).outcome.tolist()
    assert outcome == [Outcome.DROPPED] * at + [Outcome.STOPPED]


def test_a_table_that_is_not_used_goes_unnoticed() -> None:
    """Lens and wind, where all frames are dropped; the wind, where all residuals vanish."""
    idle = without(reversed_table(film(2), "lens", "wind"), 1, 2)
    assert run(idle).stop is None
    job = reversed_table(film(2), "wind")
    points = reread(job.readings, landmark_in=np.full_like(job.readings.landmark_in, 5.0),
                     fiducial_in=np.full_like(job.readings.fiducial_in, 5.0))  # fmt: skip
    camera = replace(job.camera, focal_length_mm=0.0)
    exact = run(replace(job, readings=points, camera=camera))
    assert exact.stop is None
    assert exact.outcome.tolist() == [Outcome.EXACT] * 2
