"""Warnings about solved frames: their text, their severity, and the frames they name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.jobs import BY_LANDMARK, film, reread, turned, with_arrays, without
from vopd.findings import BASIC_DATA, Finding, VopdError
from vopd.job import Job
from vopd.listing.pages import listing_text
from vopd.pipeline import ReadJob, SolveOptions, solve_film, solve_findings
from vopd.program import vopd as program
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
    assert_approved(str(found))
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
    assert_approved(out_of_range(replace(results, vehicle_deg=roll)))


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
    assert_approved(behind)


class Doubt(NamedTuple):
    """A job whose results are questioned, one that is just not, and the group that is named."""

    beyond: Callable[[], Results]
    within: Callable[[], Results]
    group: int | None


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


DOUBTS = {
    "after the time table": Doubt(clock(1, 3), clock(1, 4), 6),
    "before the time table": Doubt(clock(3, 4), clock(1, 4), 6),
    "after the trajectory": Doubt(trajectory(slice(3)), trajectory(slice(4)), 7),
    "before the trajectory": Doubt(trajectory(slice(2, 4)), trajectory(slice(4)), 7),
    "above the wind table": Doubt(wind(0.0, 119999.0), wind(0.0, 120000.0), 4),
    "below the wind table": Doubt(wind(119851.0, 2e5), wind(119850.0, 2e5), 4),
    "one landmark": Doubt(shown(11), shown(11, 12), BASIC_DATA),
    "one landmark twice": Doubt(numbered(12, 12), numbered(11, 12), BASIC_DATA),
    "singular": Doubt(changed(singular=True), changed(singular=False), BASIC_DATA),
    "behind the camera": Doubt(looking_down(1e-3), looking_down(-1e-3), 8),
    "beyond the lens table": Doubt(changed(radius_mm=12.001), changed(radius_mm=12.0), 1),
    "within the lens table": Doubt(
        changed(job=lens_from(0.25), radius_mm=0.249),
        changed(job=lens_from(0.25), radius_mm=0.25), 1,
    ),
    "at the centre": Doubt(changed(at_centre=True), changed(at_centre=False), BASIC_DATA),
    "not converged": Doubt(
        changed(correction_rad=[0.0, 0.0, -1.001e-6]),
        changed(correction_rad=[1e-6, -1e-6, 1e-6]), None,
    ),
    "a correction that is no number": Doubt(
        changed(correction_rad=[0.0, np.nan, 0.0]), changed(correction_rad=0.0), None
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", DOUBTS)
def test_every_warning_on_either_side_of_its_limit(name: str) -> None:
    """Text, severity, group and frames; and nothing else is questioned."""
    doubt = DOUBTS[name]
    found = findings_of(doubt.beyond())
    assert found[0].group == doubt.group
    assert_approved(found)
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


# By how a frame ended


LOOKS_UP = {"camera_deg": [140.0, 80.0, 60.0]}
MARKED: dict[str, tuple[dict[str, Any], int | None]] = {  # what frame 2 has; the group named
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


def marked(frame: int = 2, count: int = 3, **values: Any) -> Results:
    """Results of a film with values of one frame replaced, those of its first landmark for L."""
    results = solved(count)
    arrays = {name: getattr(results, name).copy() for name in values}
    for name, value in values.items():
        arrays[name][(frame - 1, 0) if name in BY_LANDMARK else frame - 1] = value
    return with_arrays(results, **arrays)


def said(*jobs: Results) -> list[list[Finding]]:
    return solve_findings([SolvedJob("a.dat", k, one) for k, one in enumerate(jobs, 1)])


@pytest.mark.parametrize("outcome", Outcome)
@pytest.mark.parametrize("words", MARKED)
def test_by_how_the_frame_ended(words: str, outcome: Outcome) -> None:
    """Nothing of a frame that was dropped, or at which the run stopped."""
    values, group = MARKED[words]
    (found,) = said(marked(outcome=outcome, **values))
    expected = outcome not in (Outcome.DROPPED, Outcome.STOPPED)
    if words.startswith(FROM_PASS_22):
        expected = outcome in (Outcome.SOLVED, Outcome.EXACT_LATE)
    told = [(one.group, one.severity, one.job, one.source) for one in found if words in one.message]
    assert told == ([(group, "warning", 1, "a.dat")] if expected else [])
    assert all(one.message.startswith("frame 2: ") for one in found)


FEW = (
    0,
    1,
    2,
)


@pytest.mark.parametrize("count", FEW)
@pytest.mark.parametrize("ended", [Outcome.SOLVED, Outcome.DROPPED, Outcome.STOPPED])
def test_few_landmarks_are_said_once(count: int, ended: Outcome) -> None:
    results = marked(singular=True, outcome=ended)
    used = results.used.copy()
    used[1] = np.arange(5) < count
    (found,) = said(with_arrays(results, used=used))
    text = [one.message for one in found]
    assert bool(text) == (ended == Outcome.SOLVED)
    assert_approved(text)


@pytest.mark.parametrize("singular", [True, False])
def test_a_landmark_that_is_read_twice_is_said_once(singular: bool) -> None:
    results = marked(singular=singular)
    used, landmark = results.used.copy(), results.landmark.copy()
    used[1] = np.arange(5) < 2
    landmark[1, :2] = 12
    (found,) = said(with_arrays(results, used=used, landmark=landmark))
    assert_approved([one.message for one in found])


@pytest.mark.parametrize("name", ["camera_deg", "vehicle_deg"])
@pytest.mark.parametrize("axis", range(3))
def test_any_angle_beyond_a_full_circle(name: str, axis: int) -> None:
    """360.1 degrees and no less are beyond, either way; of a camera too."""
    for angle, beyond in ((361.0, True), (-361.0, True), (359.0, False), (-359.0, False)):
        results = marked(**{"correction_rad": 0.0})
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
    assert_approved(found.message)
    assert (found.source, found.job, found.group) == ("a.dat", 2, BASIC_DATA)
    assert (found.card, found.columns, found.severity) == (None, None, "warning")


def test_the_first_and_the_last_frame_of_each_job() -> None:
    """Frames of jobs are counted on: each warning goes to the job of its frame."""
    marks = {"at_centre": True}
    jobs = [
        marked(3, **marks),
        marked(1, **marks),
        marked(2, 2, **marks),
        marked(1, 1, **marks),
    ]
    frames = [[one.message.partition(":")[0] for one in found] for found in said(*jobs)]
    assert frames == [["frame 3"], ["frame 1"], ["frame 2"], ["frame 1"]]


def test_each_job_has_its_own_lens_table() -> None:
    """Landmarks at 5 mm; the tables end at 12 mm, at 4 mm, and begin at 6 mm, in any order."""

    def with_table(*radii: float) -> Results:
        results = marked(1, 1, radius_mm=5.0)
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


# Another attitude from the deck's first estimate


BY_PAIR = SolveOptions(initial="closed-form")
COMPARED = SolveOptions(initial="closed-form", compare_initial=True)
BLANK = Finding("blanks read as zeros", "a.dat", card=3, severity="warning")


def moved_start(jobs: Sequence[ReadJob], options: SolveOptions = BY_PAIR) -> list[SolvedJob]:
    found = solve_film(jobs, options)
    assert all(isinstance(one, SolvedJob) for one in found)
    return [one for one in found if isinstance(one, SolvedJob)]


APART = {  # by how much an angle of frame 2 is another: which is said of
    "less than the last digit": [0.0, 0.00099, 0.0],
    "more than the last digit": [0.0, 0.00101, 0.0],
    "in yaw": [-0.00101, 0.0, 0.0],
    "in roll": [0.0, 0.0, -0.00101],
    "less, about a circle": [-359.99901, 0.0, 360.0005],
    "more, about a circle": [0.0, 0.0, 359.99899],
    "not a number": [np.nan, 0.0, 0.0],
}


PAIRS, DECK = 1, 2


def change_solve(monkeypatch: pytest.MonkeyPatch, which: int, change: Any) -> None:
    """What the solve gives is changed: that by pairs, or that from the deck's first estimate."""
    real, calls = program.run_jobs, []

    def run_jobs(*args: Any) -> list[Results | VopdError]:
        calls.append(args)
        ended = real(*args)
        return [change(one) for one in ended] if len(calls) == which else ended

    monkeypatch.setattr(program, "run_jobs", run_jobs)


@pytest.mark.parametrize("name", APART)
def test_a_frame_that_ends_elsewhere_from_the_deck_s_estimate(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    by = APART[name]

    def change(one: Results) -> Results:
        other = one.camera_deg.copy()
        other[1] += by
        return replace(one, camera_deg=other)

    change_solve(monkeypatch, DECK, change)
    (one,) = moved_start([ReadJob("a.dat", 5, film(3), (BLANK,))], COMPARED)
    assert_approved(one.findings)


@pytest.mark.parametrize("which", [DECK, PAIRS])
def test_only_frames_that_are_solved_both_times_are_compared(
    which: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The residuals of frame 1 vanish before pass 22: no angles of it are printed."""

    def change(one: Results) -> Results:
        ended = one.outcome.copy()
        ended[0] = Outcome.EXACT
        return replace(one, camera_deg=one.camera_deg + np.array([0.0, 1.0, 0.0]), outcome=ended)

    change_solve(monkeypatch, which, change)
    (one,) = moved_start([ReadJob("a.dat", 5, film(2))], COMPARED)
    assert [found.message.partition(":")[0] for found in one.findings] == ["frame 2"]


def test_without_the_comparison_nothing_is_compared() -> None:
    lost = turned(np.array([[140.0, -80.0, 60.0]]), np.array([320.0, 80.0, 240.0]))
    (one,), (other,) = (
        moved_start([ReadJob("a.dat", 1, lost)]),
        moved_start([ReadJob("a.dat", 1, lost)], COMPARED),
    )
    assert one.findings == () and len(other.findings) == 1
    assert (one.results.camera_deg == other.results.camera_deg).all()
