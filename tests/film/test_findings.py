"""Warnings about solved frames: their text, their severity, and the frames they name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest

from tests.kit.jobs import BY_LANDMARK, film, reread, with_arrays, without
from vopd.findings import BASIC_DATA, Finding
from vopd.job import Job
from vopd.listing.pages import listing_text
from vopd.pipeline import solve_findings
from vopd.program.vopd import run
from vopd.results import Outcome, Results, SolvedJob


def with_offset(job: Job, roll_deg: float) -> Job:
    """The job with another offset of the vehicle's roll (group 3)."""
    return replace(job, camera=replace(job.camera, offset_deg=np.array([0.0, 0.0, roll_deg])))


def findings_of(results: Results) -> list[Finding]:
    """The warnings about a job, the second of its deck."""
    (found,) = solve_findings([SolvedJob("flight.dat", 2, results)])
    return found


def out_of_range(results: Results) -> list[str]:
    """The warnings of angles out of range, as text."""
    found = findings_of(results)
    return [str(one) for one in found if "beyond a full circle" in one.message]


def test_angles_that_are_printed_as_asterisks_are_warned_of() -> None:
    """60 degrees of camera roll and an offset of 5000 make 5060, and 4700 less one circle."""
    results = run(with_offset(film(3), 5000.0))
    assert results.converged.all()
    (found,) = findings_of(results)
    assert found.severity == "warning" and found.group is None and found.job == 2
    assert str(found) == (
        "flight.dat: job 2: frames 1-3: an angle of camera or vehicle is beyond a full circle, "
        "although the solve converged; the listing may have asterisks"
    )
    assert "*********" in listing_text(run(with_offset(film(3), 5e7)))


def test_angles_within_a_circle_are_not_warned_of() -> None:
    """60 and 299 are 359; 60 and 599 are 659, less one circle 299; 60 and 660.1 leave 360.1."""
    for offset in (0.0, 299.0, 599.0):
        assert out_of_range(run(with_offset(film(2), offset))) == []
    assert len(out_of_range(run(with_offset(film(2), 660.1)))) == 1


def test_only_the_frames_that_are_out_of_range_are_named() -> None:
    results = run(film(4))
    roll = results.vehicle_deg.copy()
    roll[[0, 2], 2] = -361.0, 1e9
    assert out_of_range(replace(results, vehicle_deg=roll)) == [
        "flight.dat: job 2: frames 1, 3: an angle of camera or vehicle is beyond a full circle, "
        "although the solve converged; the listing may have asterisks"
    ]


def test_a_frame_that_did_not_converge_is_named_once() -> None:
    results = run(film(2))
    wild = replace(
        results,
        vehicle_deg=results.vehicle_deg + 1e6,
        correction_rad=results.correction_rad + 1.0,
    )
    (found,) = findings_of(wild)
    assert "not converged" in found.message


@pytest.mark.parametrize("outcome", Outcome)
def test_which_frames_are_said_to_look_away(outcome: Outcome) -> None:
    """Only those with angles of pass 22: of the others no angle is printed."""
    results = run(film(3))
    turned = results.camera_deg.copy()
    turned[1:, 1] = 80.0  # the camera looks up
    ended = results.outcome.copy()
    ended[1] = outcome
    found = findings_of(replace(results, camera_deg=turned, outcome=ended))
    behind = [one.message for one in found if "behind the camera" in one.message]
    solved = outcome in (Outcome.SOLVED, Outcome.EXACT_LATE)
    frames = "frames 2-3" if solved else "frame 3"
    assert behind == [f"{frames}: landmarks lie behind the camera; try --initial closed-form"]


class Doubt(NamedTuple):
    """A job whose results are questioned, one that is just not, and what is said of the first."""

    beyond: Callable[[], Results]
    within: Callable[[], Results]
    group: int | None
    message: str


def clock(first: int, last: int) -> Callable[[], Results]:
    """Frames 1 to 4, with a time table from one frame to another; one second a frame."""
    job = film(4)
    table = replace(
        job.clock, frame=np.array([first, last]), time_s=np.array([first - 1.0, last - 1.0])
    )
    return lambda: run(replace(job, clock=table))


def trajectory(rows: slice) -> Callable[[], Results]:
    """The four frames are at the times of the four rows."""
    job = film(4)
    names = ("time_s", "position_ft", "velocity_ft_s", "altitude_ft")
    some = {name: getattr(job.trajectory, name)[rows] for name in names}
    return lambda: run(replace(job, trajectory=replace(job.trajectory, **some)))


def wind(low_ft: float, high_ft: float) -> Callable[[], Results]:
    """The frames are at 120000, 119950, 119900, 119850 ft."""
    job = film(4)
    table = replace(job.wind, altitude_ft=np.array([low_ft, high_ft]))
    return lambda: run(replace(job, wind=table))


def shown(*numbers: int) -> Callable[[], Results]:
    """Frame 2 shows the landmarks of these numbers only, in the places of the first."""
    job = film(4)
    present, landmark = job.readings.present.copy(), job.readings.landmark.copy()
    present[1, len(numbers) :] = False
    landmark[1, : len(numbers)] = numbers
    return lambda: run(
        replace(job, readings=reread(job.readings, present=present, landmark=landmark))
    )


def changed(frame: int = 2, job: Job | None = None, **values: Any) -> Callable[[], Results]:
    """The results with values of one frame replaced, those of its first landmark for (F, L)."""

    def make() -> Results:
        results = run(job or film(4))
        arrays = {name: getattr(results, name).copy() for name in values}
        for name, value in values.items():
            where = (frame - 1, 0) if name in BY_LANDMARK else frame - 1
            arrays[name][where] = value
        return with_arrays(results, **arrays)

    return make


def numbered(*numbers: int) -> Callable[[], Results]:
    """Frame 2 shows two landmarks, which are given these numbers after the solve."""
    two = shown(11, 12)()
    landmark = two.landmark.copy()
    landmark[1, :2] = numbers
    return lambda: with_arrays(two, landmark=landmark)


def looking_down(up: float) -> Callable[[], Results]:
    """The camera of frame 2 looks straight down; its first landmark is almost at the horizon."""
    down = changed(camera_deg=[0.0, -90.0, 0.0])()
    direction = down.direction.copy()
    direction[1] = [0.0, 0.0, -1.0]
    direction[1, 0] = [0.6, 0.8, up]
    return lambda: with_arrays(down, direction=direction)


def lens_from(radius_mm: float) -> Job:
    """A film whose lens table begins at a radius."""
    job = film(4)
    table = np.append(radius_mm, job.camera.lens_radius_mm[job.camera.lens_radius_mm > radius_mm])
    distortion = np.zeros(len(table))
    return replace(
        job, camera=replace(job.camera, lens_radius_mm=table, lens_distortion_um=distortion)
    )


EXTRAPOLATED = "values are extrapolated"
NOT_CONVERGED = "not converged: the 22nd correction exceeds 1e-6 rad or is not a number"
BEYOND_LENS = f"frame 2: landmarks lie beyond the lens table; {EXTRAPOLATED}"
NOISE = "the angles are rounding noise"
DOUBTS = {
    "after the time table": Doubt(
        clock(1, 3), clock(1, 4), 6, f"frame 4: outside the time table; {EXTRAPOLATED}"
    ),
    "before the time table": Doubt(
        clock(3, 4), clock(1, 4), 6, f"frames 1-2: outside the time table; {EXTRAPOLATED}"
    ),
    "after the trajectory": Doubt(
        trajectory(slice(3)), trajectory(slice(4)), 7,
        f"frame 4: outside the trajectory table; {EXTRAPOLATED}",
    ),
    "before the trajectory": Doubt(
        trajectory(slice(2, 4)), trajectory(slice(4)), 7,
        f"frames 1-2: outside the trajectory table; {EXTRAPOLATED}",
    ),
    "above the wind table": Doubt(
        wind(0.0, 119999.0), wind(0.0, 120000.0), 4,
        f"frame 1: outside the wind table; {EXTRAPOLATED}",
    ),
    "below the wind table": Doubt(
        wind(119851.0, 2e5), wind(119850.0, 2e5), 4,
        f"frame 4: outside the wind table; {EXTRAPOLATED}",
    ),
    "one landmark": Doubt(
        shown(11), shown(11, 12), BASIC_DATA, f"frame 2: fewer than two landmarks; {NOISE}"
    ),
    "one landmark twice": Doubt(
        numbered(12, 12), numbered(11, 12), BASIC_DATA,
        f"frame 2: one landmark, read twice; {NOISE}",
    ),
    "singular": Doubt(
        changed(singular=True), changed(singular=False), BASIC_DATA,
        "frame 2: the normal matrix is singular; the angles are meaningless",
    ),
    "behind the camera": Doubt(
        looking_down(1e-3), looking_down(-1e-3), 8,
        "frame 2: landmarks lie behind the camera; try --initial closed-form",
    ),
    "beyond the lens table": Doubt(
        changed(radius_mm=12.001), changed(radius_mm=12.0), 1, BEYOND_LENS
    ),
    "within the lens table": Doubt(
        changed(job=lens_from(0.25), radius_mm=0.249),
        changed(job=lens_from(0.25), radius_mm=0.25), 1, BEYOND_LENS,
    ),
    "at the centre": Doubt(
        changed(at_centre=True), changed(at_centre=False), BASIC_DATA,
        "frame 2: a landmark lies at the frame's centre; its distortion is not corrected",
    ),
    "not converged": Doubt(
        changed(correction_rad=[0.0, 0.0, -1.001e-6]),
        changed(correction_rad=[1e-6, -1e-6, 1e-6]), None, f"frame 2: {NOT_CONVERGED}",
    ),
    "a correction that is no number": Doubt(
        changed(correction_rad=[0.0, np.nan, 0.0]), changed(correction_rad=0.0), None,
        f"frame 2: {NOT_CONVERGED}",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", DOUBTS)
def test_every_warning_on_either_side_of_its_limit(name: str) -> None:
    """Text, severity, group and frames; and nothing else is questioned."""
    doubt = DOUBTS[name]
    found = findings_of(doubt.beyond())
    assert found == [
        Finding(doubt.message, "flight.dat", job=2, group=doubt.group, severity="warning")
    ]
    assert findings_of(doubt.within()) == []


@pytest.mark.parametrize(
    "values", [{"radius_mm": 13.0}, {"at_centre": True}, {"singular": True}], ids=str
)
def test_a_dropped_frame_is_not_questioned(values: dict[str, Any]) -> None:
    assert findings_of(changed(job=without(film(4), 2), **values)()) == []


def test_a_landmark_that_does_not_take_part_is_not_questioned() -> None:
    for make in (changed(radius_mm=13.0, used=False), looking_down(1e-3)):
        results = make()
        used = results.used.copy()
        used[1, 0] = False
        assert findings_of(with_arrays(results, used=used)) == []


def test_jobs_together_have_the_warnings_that_each_has_alone() -> None:
    """Jobs of one frame to five, with a warning, with another, and with none."""
    jobs = [
        film(2),
        with_offset(film(3), 5000.0),
        without(film(5), 2),
        with_offset(film(1), 5000.0),
    ]
    solved = [SolvedJob(f"{k}.dat", k, run(job)) for k, job in enumerate(jobs, 1)]
    together = solve_findings(solved)
    assert [[str(one) for one in found][:1] for found in together] == [
        [],
        [str(findings_of(solved[1].results)[0]).replace("flight.dat: job 2", "2.dat: job 2")],
        [],
        [str(findings_of(solved[3].results)[0]).replace("flight.dat: job 2", "4.dat: job 4")],
    ]
    assert [len(found) for found in together] == [0, 1, 0, 1]
    assert solve_findings([]) == []
