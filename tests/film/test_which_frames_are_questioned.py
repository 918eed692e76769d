"""How a frame ended, and how many landmarks it has, decides what is said of it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from tests.kit.jobs import BY_LANDMARK, film, reread, with_arrays
from vopd.findings import BASIC_DATA, Finding
from vopd.pipeline import solve_findings
from vopd.program.vopd import run
from vopd.results import Outcome, Results, SolvedJob

LOOKS_UP = {"camera_deg": [140.0, 80.0, 60.0]}
DOUBTS: dict[str, tuple[dict[str, Any], int | None]] = {  # what frame 2 has; the group named
    "outside the time table": ({"outside_clock": True}, 6),
    "outside the trajectory table": ({"outside_trajectory": True}, 7),
    "outside the wind table": ({"outside_wind": True}, 4),
    "the normal matrix is singular": ({"singular": True}, BASIC_DATA),
    "behind the camera": (LOOKS_UP, 8),
    "beyond the lens table": ({"radius_mm": 13.0}, 1),
    "at the frame's centre": ({"at_centre": True}, BASIC_DATA),
    "not converged": ({"correction_rad": [0.0, 2e-6, 0.0]}, None),
    "beyond a full circle": ({"vehicle_deg": [0.0, 0.0, 400.0]}, None),
}
FROM_PASS_22 = ("outside the wind", "behind the", "not converged", "beyond a full circle")
"""Said only of frames with angles of pass 22; the others come before the solve, or are of it."""


@cache
def solved(count: int) -> Results:
    return run(film(count))


def changed(frame: int = 2, count: int = 3, **values: Any) -> Results:
    """Results of a film with values of one frame replaced, those of its first landmark for L."""
    results = solved(count)
    arrays = {name: getattr(results, name).copy() for name in values}
    for name, value in values.items():
        arrays[name][(frame - 1, 0) if name in BY_LANDMARK else frame - 1] = value
    return with_arrays(results, **arrays)


def said(*jobs: Results) -> list[list[Finding]]:
    return solve_findings([SolvedJob("a.dat", k, one) for k, one in enumerate(jobs, 1)])


@pytest.mark.parametrize("outcome", Outcome)
@pytest.mark.parametrize("words", DOUBTS)
def test_by_how_the_frame_ended(words: str, outcome: Outcome) -> None:
    """Nothing of a frame that was dropped, or at which the run stopped."""
    values, group = DOUBTS[words]
    (found,) = said(changed(outcome=outcome, **values))
    expected = outcome not in (Outcome.DROPPED, Outcome.STOPPED)
    if words.startswith(FROM_PASS_22):
        expected = outcome in (Outcome.SOLVED, Outcome.EXACT_LATE)
    told = [(one.group, one.severity, one.job, one.deck) for one in found if words in one.message]
    assert told == ([(group, "warning", 1, "a.dat")] if expected else [])
    assert all(one.message.startswith("frame 2: ") for one in found)


NOISE = "the angles are rounding noise"
FEW = {  # landmarks that take part in frame 2: what is said, whatever the matrix is
    0: f"frame 2: fewer than two landmarks; {NOISE}",
    1: f"frame 2: fewer than two landmarks; {NOISE}",
    2: "frame 2: the normal matrix is singular; the angles are meaningless",
}


@pytest.mark.parametrize("count", FEW)
@pytest.mark.parametrize("ended", [Outcome.SOLVED, Outcome.DROPPED, Outcome.STOPPED])
def test_few_landmarks_are_said_once(count: int, ended: Outcome) -> None:
    results = changed(singular=True, outcome=ended)
    used = results.used.copy()
    used[1] = np.arange(5) < count
    (found,) = said(with_arrays(results, used=used))
    assert [one.message for one in found] == ([FEW[count]] if ended == Outcome.SOLVED else [])


@pytest.mark.parametrize("singular", [True, False])
def test_a_landmark_that_is_read_twice_is_said_once(singular: bool) -> None:
    results = changed(singular=singular)
    used, landmark = results.used.copy(), results.landmark.copy()
    used[1] = np.arange(5) < 2
    landmark[1, :2] = 12
    (found,) = said(with_arrays(results, used=used, landmark=landmark))
    assert [one.message for one in found] == [f"frame 2: one landmark, read twice; {NOISE}"]


@pytest.mark.parametrize("name", ["camera_deg", "vehicle_deg"])
@pytest.mark.parametrize("axis", range(3))
def test_any_angle_beyond_a_full_circle(name: str, axis: int) -> None:
    """360.1 degrees and no less are beyond, either way; of a camera too."""
    for angle, beyond in ((361.0, True), (-361.0, True), (359.0, False), (-359.0, False)):
        results = changed(**{"correction_rad": 0.0})
        angles = getattr(results, name).copy()
        angles[1, axis] = angle
        (found,) = said(replace(results, **{name: angles}))
        assert bool([one for one in found if "beyond a full circle" in one.message]) == beyond


def test_readings_that_are_copies_are_said_of_their_job() -> None:
    job = film(2)
    fiducial, landmark = job.readings.fiducial_in.copy(), job.readings.landmark_in.copy()
    fiducial[:], landmark[:] = fiducial[:, :, :1], landmark[:, :, :1]
    copies = replace(job, readings=reread(job.readings, fiducial_in=fiducial, landmark_in=landmark))
    first, second, third = said(solved(2), run(copies), solved(2))
    assert first == third == []
    (found,) = second
    assert found.message.startswith("all three readings are the same in 18 of 18 points")
    assert (found.deck, found.job, found.group) == ("a.dat", 2, BASIC_DATA)
    assert (found.card, found.columns, found.severity) == (None, None, "warning")


def test_the_first_and_the_last_frame_of_each_job() -> None:
    """Frames of jobs are counted on: each warning goes to the job of its frame."""
    marks = {"at_centre": True}
    jobs = [
        changed(3, **marks),
        changed(1, **marks),
        changed(2, 2, **marks),
        changed(1, 1, **marks),
    ]
    frames = [[one.message.partition(":")[0] for one in found] for found in said(*jobs)]
    assert frames == [["frame 3"], ["frame 1"], ["frame 2"], ["frame 1"]]


def test_each_job_has_its_own_lens_table() -> None:
    """Landmarks at 5 mm; the tables end at 12 mm, at 4 mm, and begin at 6 mm, in any order."""

    def with_table(*radii: float) -> Results:
        results = changed(1, 1, radius_mm=5.0)
        camera = replace(results.job.camera, lens_radius_mm=np.array(radii))
        values = np.where(np.arange(5) == 0, 5.0, np.nan)[None]
        only = np.arange(5)[None] == 0
        job = replace(results.job, camera=camera)
        marks = {"radius_mm": values, "used": only | (results.used & ~only)}
        return with_arrays(replace(results, job=job), **marks)

    tables = ((0.0, 12.0), (0.0, 4.0), (6.0, 12.0), (12.0, 0.0), (5.0, 12.0), (0.0, 5.0))
    beyond = [
        any("beyond the lens table" in one.message for one in found)
        for found in said(*(with_table(*radii) for radii in tables))
    ]
    assert beyond == [False, True, True, False, False, False]
