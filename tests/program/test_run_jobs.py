"""Many jobs solved together: each comes out bit for bit as it does alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit.jobs import BY_LANDMARK, RESULT_ARRAYS, case, film, reread, without
from vopd.errata import fixes
from vopd.findings import VopdError
from vopd.job import Job
from vopd.program.ftlup import TableNotANumber
from vopd.program.positions import UndefinedLandmark
from vopd.program.vopd import run, run_jobs
from vopd.results import Outcome, Results


def camera(job: Job, **new: object) -> Job:
    return replace(job, camera=replace(job.camera, **new))


def starting(job: Job, *angles: float) -> Job:
    return camera(job, initial_deg=np.array(angles))


def fewer_landmarks(job: Job, count: int) -> Job:
    """The job with its first landmarks only, in as many places."""
    r = job.readings
    names = "landmark", "present", "landmark_in"
    return replace(job, readings=reread(r, **{name: getattr(r, name)[:, :count] for name in names}))


def undefined(job: Job) -> Job:
    marks = job.landmarks
    return replace(job, landmarks=replace(marks, number=marks.number + 50))


def table_out_of_order(job: Job, room: str, name: str) -> Job:
    table = getattr(job, room)
    return replace(job, **{room: replace(table, **{name: getattr(table, name)[::-1].copy()})})


def everything() -> list[Job]:
    """Jobs that differ in all that a job can have of its own, and in how they end."""
    return [
        film(3),
        starting(film(4), 143.0, -77.0, 63.0),
        undefined(film(2)),
        camera(film(3), focal_length_mm=0.0),
        camera(starting(film(5), 3.0, -1.0, 2.0), focal_length_mm=12.5),
        fewer_landmarks(film(4), 2),
        fewer_landmarks(film(2), 3),
        fewer_landmarks(film(2), 1),
        without(film(6), 1, 4),
        without(film(2), 1, 2),
        table_out_of_order(film(3), "clock", "frame"),
        table_out_of_order(without(film(3), 1), "camera", "lens_radius_mm"),
        table_out_of_order(film(3), "wind", "altitude_ft"),
        starting(film(4), 140.0, 10.0, 60.0),  # does not converge
        *(case(number) for number in (1, 2, 3, 4)),
        film(1),
    ]


@pytest.mark.parametrize("names", [(), ("restart",), ("all",)])
def test_together_as_alone(names: tuple[str, ...]) -> None:
    jobs, chosen = everything(), fixes(*names)
    together = run_jobs(jobs, chosen)
    assert len(together) == len(jobs)
    for index, (job, ours) in enumerate(zip(jobs, together, strict=True)):
        if index == 2:
            assert isinstance(ours, UndefinedLandmark)
            with pytest.raises(UndefinedLandmark) as caught:
                run(job, chosen)
            assert str(ours) == str(caught.value)
        else:
            assert isinstance(ours, Results) and ours == run(job, chosen)
            assert ours.job is job


def test_they_end_in_every_way() -> None:
    """Or the test above would hold little."""
    together = [one for one in run_jobs(everything()) if isinstance(one, Results)]
    stages = {one.stop.stage for one in together if one.stop is not None}
    assert len(stages) == 3
    outcomes = {int(outcome) for one in together for outcome in one.outcome}
    assert {Outcome.SOLVED, Outcome.DROPPED, Outcome.STOPPED} <= outcomes
    assert not all(one.converged.all() for one in together)
    assert len({one.used.shape[1] for one in together}) > 3


def test_a_job_does_not_start_where_the_one_before_ended() -> None:
    """Without a focal length angles stay; they are carried within a job and not to the next."""
    one, two = starting(film(4), 5.0, 2.0, 4.0), starting(film(4), 6.0, 1.5, 5.0)
    first, second = run_jobs([camera(job, focal_length_mm=0.0) for job in (one, two)])
    assert isinstance(first, Results) and isinstance(second, Results)
    assert first.start_deg[0].tolist() == [5.0, 2.0, 4.0]
    assert second.start_deg[0].tolist() == [6.0, 1.5, 5.0]
    assert first.start_deg[1].tolist() == [5.0, 2.0, 4.0]  # carried within the job


def test_starts_of_their_own_beside_starts_that_are_carried() -> None:
    """Each frame of the second job starts where it is told to, and the others as ever."""
    jobs = [film(3), film(4), starting(film(3), 143.0, -77.0, 63.0)]
    told = np.array([140.0, -80.0, 60.0]) + np.arange(12.0).reshape(4, 3)
    together = run_jobs(jobs, start_deg=[None, told, None])
    alone = [run(jobs[0]), run(jobs[1], start_deg=told), run(jobs[2])]
    assert together == alone
    np.testing.assert_array_equal(alone[1].start_deg, told)


@pytest.mark.parametrize("names", [(), ("restart",), ("all",)])
def test_starts_of_their_own_are_kept_where_angles_are_carried(names: tuple[str, ...]) -> None:
    """With the fix `restart` the angles of a frame are those of the one before, if not told."""
    job, chosen = film(4), fixes(*names)
    told = np.array([141.0, -79.0, 61.0]) - np.arange(12.0).reshape(4, 3) / 10.0
    np.testing.assert_array_equal(run(job, chosen, told).start_deg, told)
    started = run(job, chosen).start_deg
    assert started[0].tolist() == [140.0, -80.0, 60.0]
    assert (started[1:] == started[0]).all() == (names == ())


OWN: dict[str, Callable[[Job], Job]] = {  # what each job has as a whole, another in each
    "focal length": lambda job: camera(job, focal_length_mm=10.5),
    "lens": lambda job: camera(job, lens_distortion_um=job.camera.lens_distortion_um + 9.0),
    "multipliers": lambda job: camera(job, multiplier=np.array([-1.0, 0.5, 2.0])),
    "offsets": lambda job: camera(job, offset_deg=np.array([10.0, -20.0, 30.0])),
    "first estimate": lambda job: starting(job, 141.0, -79.0, 61.0),
    "latitude": lambda job: origin(job, origin_latitude_deg=33.09),
    "longitude": lambda job: origin(job, origin_longitude_deg=-106.34),
    "radius": lambda job: origin(job, origin_radius_kft=20926.5),
    "velocity": lambda job: origin(job, velocity_ft_s=job.trajectory.velocity_ft_s + 7.0),
    "altitude": lambda job: origin(job, altitude_ft=job.trajectory.altitude_ft + 1e5),
    "wind": lambda job: replace(job, wind=replace(job.wind, velocity_ft_s=np.full((2, 2), 9.0))),
    "clock": lambda job: replace(job, clock=replace(job.clock, time_s=np.array([0.1, 2.3]))),
    "landmarks": lambda job: replace(
        job, landmarks=replace(job.landmarks, altitude_ft=job.landmarks.altitude_ft + 50.0)
    ),
    "ignored": lambda job: replace(
        job, ignored=replace(job.ignored, everywhere=np.array([12, 0, 0, 0, 0]))
    ),
}


def origin(job: Job, **new: object) -> Job:
    return replace(job, trajectory=replace(job.trajectory, **new))


@pytest.mark.parametrize("names", [(), ("all",)])
def test_what_each_job_has_is_its_own(names: tuple[str, ...]) -> None:
    """Beside a film as it is, which comes first and last, each changes its own results alone."""
    jobs = [film(3), *(make(film(3)) for make in OWN.values()), film(3)]
    first, *others, last = run_jobs(jobs, fixes(*names))
    assert first == last == run(film(3), fixes(*names))
    for name, job, ours in zip(OWN, jobs[1:-1], others, strict=True):
        assert isinstance(ours, Results) and isinstance(first, Results)
        assert ours == run(job, fixes(*names)), name
        same = replace(ours, job=first.job) == first
        assert not same, name


def test_no_jobs() -> None:
    assert run_jobs([]) == []


NAN: list[tuple[str, Callable[[Job], Job]]] = [
    (
        r"frame numbers \(group 6\) holds NaN at position 2",
        lambda job: replace(job, clock=replace(job.clock, time_s=np.array([0.0, np.nan]))),
    ),
    (
        r"times \(group 7\) holds NaN at position 3",
        lambda job: replace(
            job, trajectory=replace(job.trajectory, time_s=np.array([0.0, 1.0, np.nan]))
        ),
    ),
    (
        r"radial distances \(group 1\) holds NaN at position 1",
        lambda job: camera(job, lens_distortion_um=np.array([np.nan, *[0.0] * 24])),
    ),
    (
        r"altitudes \(group 4\) holds NaN at position 1",
        lambda job: replace(job, wind=replace(job.wind, altitude_ft=np.array([np.nan, 2e5]))),
    ),
]


@pytest.mark.parametrize(("message", "bend"), NAN, ids=[message[:8] for message, _ in NAN])
def test_nan_in_a_table_is_an_error_of_its_job_alone(
    message: str, bend: Callable[[Job], Job]
) -> None:
    with refused(TableNotANumber) as caught:
        run(bend(film(3)))
    assert isinstance(caught.value, VopdError)
    good, bad, other = run_jobs([film(3), bend(film(3)), film(2)])
    assert isinstance(bad, TableNotANumber)
    assert (good, other) == (run(film(3)), run(film(2)))


def test_every_array_has_the_shape_that_results_say() -> None:
    """With frames and landmarks of different numbers, stopped runs too."""
    for job in everything():
        if (job.landmarks.number > 50).any():
            continue
        results = run(job)
        frames, landmarks = len(results.frame), job.readings.landmark.shape[1]
        size = {"F": frames, "L": landmarks}
        whole = run(film(1))
        for name in RESULT_ARRAYS:
            array, usual = getattr(results, name), getattr(whole, name)
            axes = ("F", "L") if name in BY_LANDMARK else ("F",)
            assert array.shape == (*(size[axis] for axis in axes), *usual.shape[len(axes) :]), name
            assert array.dtype == usual.dtype, name
