"""A job through the whole program: look-ups, wrapping, how frames end (A 105 to A 455)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit import spherical_film
from tests.kit.jobs import RESULT_ARRAYS, case, film, reread, without
from tests.tolerances import assert_close
from vopd.errata import fixes
from vopd.job import Job
from vopd.program import vopd
from vopd.program.positions import UndefinedLandmark
from vopd.program.vopd import radial_factor, run
from vopd.results import Outcome, Results, Stage


def test_time_and_place_of_case_1() -> None:
    """Frame 730 is at 48.073 + 730*(126.774 - 48.073)/2520 s, .8713055... of the way 70 to 71."""
    results = run(case(1))
    time_s = 48.073 + 730 * 78.701 / 2520
    assert_close("time", results.time_s, [time_s])
    part = time_s - 70
    wanted = [-28678.45 - 336.4 * part, -3130.53 - 305.65 * part, 143619.3 - 504.9 * part]
    assert_close("vehicle position", results.vehicle_ft[0], wanted)


@pytest.mark.parametrize(
    ("multiplier", "offset", "vehicle"),
    [
        # case 1's camera stands at 195.270, -38.653, 285.837, as Appendix H prints it
        ((1, 1, 1), (0.0, 0.0, -210.0), (195.270, -38.653, 75.837)),
        ((1, 1, 1), (200.0, -150.0, 100.0), (35.270, 171.347, 25.837)),
        ((1, 1, 1), (-200.0, 230.0, -300.0), (355.270, -168.653, 345.837)),
        ((-1, -1, -1), (0.0, 0.0, 0.0), (164.730, 38.653, 74.163)),
        # one turn and no more: 795.27 - 360, -738.653 + 360, -614.163 + 360
        ((1, 1, 1), (600.0, -700.0, -900.0), (435.270, -378.653, -254.163)),
    ],
)
def test_vehicle_angles_wrap_once(
    multiplier: tuple[int, ...], offset: tuple[float, ...], vehicle: tuple[float, ...]
) -> None:
    """A 296 to A 304: 0 to 360 degrees for yaw and roll, -180 to 180 for pitch."""
    job = case(1)
    camera = replace(
        job.camera, multiplier=np.array(multiplier, float), offset_deg=np.array(offset)
    )
    assert_close("printed angle", run(replace(job, camera=camera)).vehicle_deg[0], vehicle)


def test_a_focal_length_of_zero_keeps_the_start() -> None:
    """No partials, so no correction; residuals are film coordinates corrected for distortion."""
    job = film(2)
    results = run(replace(job, camera=replace(job.camera, focal_length_mm=0.0)))
    assert (results.outcome == Outcome.SOLVED).all()
    assert_close("recovered angle", results.camera_deg, [[140.0, -80.0, 60.0]] * 2)
    assert results.singular.all()
    assert results.converged.all()
    away = results.point_mm - results.centre_mm[:, None]
    longer = 1 - results.distortion_mm / results.radius_mm
    assert_close("film length", results.residual_mm, away * longer[..., None])


def test_residuals_that_vanish() -> None:
    """Frame 2's landmarks are read where its fiducials' mean is, and the focal length is zero."""
    job = film(3)
    points = job.readings.landmark_in.copy()
    points[1] = 5.0
    corners = job.readings.fiducial_in.copy()
    corners[1] = 5.0
    readings = reread(job.readings, landmark_in=points, fiducial_in=corners)
    camera = replace(job.camera, focal_length_mm=0.0, initial_deg=np.array([361.0, 1.0, 2.0]))
    results = run(replace(job, camera=camera, readings=readings))
    assert results.outcome.tolist() == [Outcome.SOLVED, Outcome.EXACT, Outcome.SOLVED]
    assert results.solved.tolist() == [True, False, True]
    assert results.at_centre.tolist() == [[False] * 5, [True] * 5, [False] * 5]
    assert results.last_pass.tolist() == [0, 1, 0]
    assert results.singular.tolist() == [True, False, True]  # frame 2 asked for no matrix
    # yaw wraps to 361 - 359.999999569273, stays below TWOPI, and frame 2 passes it on
    assert_close("wrapped angle", results.start_deg[:, 0], [361.0, 1.000000430727, 1.000000430727])


def test_the_radial_factor_and_the_centre() -> None:
    found = radial_factor(np.array([0.0, 10.0, 20.0]), np.array([0.5, 0.1, -0.4]))
    assert_close("ratio", found, [1.0, 0.99, 1.02])


def test_a_landmark_at_the_centre_has_no_correction() -> None:
    """The other landmarks solve the frame, and DELTA R still shows the table's value at 0."""
    truth = np.array([[140.0, -80.0, 60.0]])
    job = spherical_film.job(truth, truth[0])
    points = job.readings.landmark_in.copy()
    points[0, 0] = spherical_film.CENTRE_IN
    bent = replace(job.camera, lens_distortion_um=job.camera.lens_distortion_um + 8.0)
    results = run(replace(job, camera=bent, readings=reread(job.readings, landmark_in=points)))
    assert results.at_centre[0].tolist() == [True, False, False, False, False]
    assert results.radius_mm[0, 0] == 0
    assert results.distortion_mm[0, 0] == -0.008
    assert np.isfinite(results.camera_deg).all()


def test_one_landmark_has_its_page() -> None:
    """Two equations for three angles: noise, but the frame ends as any other."""
    job = film(1)
    readings = job.readings
    one = reread(
        readings, landmark=readings.landmark[:, :1], present=readings.present[:, :1],
        landmark_in=readings.landmark_in[:, :1] + 0.3,
    )  # fmt: skip
    results = run(replace(job, readings=one))
    assert results.outcome.tolist() == [Outcome.SOLVED]
    assert results.used.tolist() == [[True]]


def test_what_does_not_converge_is_flagged() -> None:
    """A guess that looks at the sky: 22 passes do not bring it home."""
    job = film(2)
    camera = replace(job.camera, initial_deg=np.array([140.0, 10.0, 60.0]))
    results = run(replace(job, camera=camera))
    still = np.abs(results.correction_rad).max(axis=1)
    assert (still > 1e-6).all()
    assert not results.converged.any()
    assert run(job).converged.all()


def test_the_limit_of_convergence() -> None:
    """1E-6 rad passes and the next number does not, in any angle; NaN does not; idle frames do."""
    results = run(without(film(5), 5))
    step = np.full((5, 3), 1e-6)
    step[1, 0], step[2, 2], step[3, 1] = np.nextafter(1e-6, 1), -1.1e-6, np.nan
    flagged = ~replace(results, correction_rad=step).converged
    assert flagged.tolist() == [False, True, True, True, False]


def test_outside_the_tables() -> None:
    """Frames 1 to 3 are at 0, 1, 2 s and 120000, 119950, 119900 ft."""
    job = film(3)
    late = replace(job.clock, frame=np.array([2, 3]), time_s=np.array([1.0, 2.0]))
    assert run(replace(job, clock=late)).outside_clock.tolist() == [True, False, False]
    path = job.trajectory
    short = replace(
        path, time_s=path.time_s[:2], position_ft=path.position_ft[:2],
        velocity_ft_s=path.velocity_ft_s[:2], altitude_ft=path.altitude_ft[:2],
    )  # fmt: skip
    results = run(replace(job, trajectory=short))
    assert results.outside_trajectory.tolist() == [False, False, True]
    assert_close("vehicle position", results.vehicle_ft[2], [800.0, 100.0, 119900.0])
    high = replace(job.wind, altitude_ft=np.array([119950.0, 119990.0]))
    assert run(replace(job, wind=high)).outside_wind.tolist() == [True, False, True]
    nothing = run(job)
    assert not (nothing.outside_clock | nothing.outside_trajectory | nothing.outside_wind).any()


def test_an_undefined_landmark() -> None:
    """It is an error where it takes part, and none where it is ignored or its frame is dropped."""
    job = film(2)
    landmark = job.readings.landmark.copy()
    landmark[1, 2] = 66
    job = replace(job, readings=reread(job.readings, landmark=landmark))
    with refused(UndefinedLandmark):
        run(job)
    everywhere = replace(job.ignored, everywhere=np.array([66]))
    assert run(replace(job, ignored=everywhere)).converged.all()
    assert run(without(job, 2)).outcome.tolist() == [Outcome.SOLVED, Outcome.DROPPED]


@pytest.mark.parametrize("numbers", [(77, 66), (66, 77), (66, 66)])
def test_which_undefined_landmark_is_named(numbers: tuple[int, int]) -> None:
    """The least number of all, and the first frame that has it."""
    job = film(3)
    landmark = job.readings.landmark.copy()
    landmark[1, 2], landmark[2, 0] = numbers
    frame = 2 + numbers.index(66)
    with pytest.raises(UndefinedLandmark) as caught:
        run(replace(job, readings=reread(job.readings, landmark=landmark)))
    assert (caught.value.frame, caught.value.landmark) == (frame, 66)
    assert str(caught.value) == f"frame {frame}: landmark 66 is not defined in group 9"


def test_a_landmark_given_twice_counts_as_given_last() -> None:
    job = film(1)
    marks = {name: np.append(value, value[2]) for name, value in vars(job.landmarks).items()}
    marks["latitude_min"][2] += 30.0
    twice = replace(job.landmarks, **marks)
    assert run(replace(job, landmarks=twice)) == replace(
        run(job), job=replace(job, landmarks=twice)
    )


def test_a_frame_is_the_same_in_any_company() -> None:
    """Bit for bit, with other frames and with more places for landmarks beside it."""
    whole = run(film(4))
    for k in range(4):
        job = film(4)
        alone = run(
            replace(
                job,
                readings=reread(
                    job.readings,
                    **{
                        name: getattr(job.readings, name)[k : k + 1]
                        for name in ("frame", "fiducial_in", "landmark", "present", "landmark_in")
                    },
                ),
            )
        )
        for name in ("camera_deg", "residual_mm", "alpha_deg", "direction", "time_s"):
            np.testing.assert_array_equal(getattr(alone, name)[0], getattr(whole, name)[k])


def test_what_is_not_reached_is_not_a_number() -> None:
    """A dropped frame, and landmarks that take no part."""
    job = without(film(2), 1)
    results = run(replace(job, ignored=replace(job.ignored, everywhere=np.array([12]))))
    for name in ("camera_deg", "vehicle_deg", "alpha_deg", "eta_deg", "residual_mm", "direction"):
        values = getattr(results, name)
        assert np.isnan(values[0]).all(), name
    assert np.isnan(results.residual_mm[1, 1]).all()
    assert np.isfinite(results.residual_mm[1, 0]).all()
    assert results.ignored.tolist() == [[False] * 5, [False, True, False, False, False]]


def test_the_job_is_not_changed() -> None:
    job = case(4)
    before = case(4)
    run(job)
    assert job == before


# Outcomes


def test_outcomes_by_the_last_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 22 passes; the corrections go on to the last one, and a dropped frame is just that."""
    real = vopd.orient_frames
    last_pass = np.array([0, 1, 2, 21, 22, 0, 22])

    def orient_frames(*args: Any) -> Any:
        done, start = real(*args)
        return done._replace(last_pass=last_pass), start

    monkeypatch.setattr(vopd, "orient_frames", orient_frames)
    results = vopd.run(without(film(7), 6, 7))
    assert results.outcome.tolist() == [
        Outcome.SOLVED, Outcome.EXACT, Outcome.EXACT, Outcome.EXACT, Outcome.EXACT_LATE,
        Outcome.DROPPED, Outcome.DROPPED,
    ]  # fmt: skip
    assert results.last_pass.tolist() == [0, 1, 2, 21, 22, 0, 22]
    assert (
        not results.ignored.any() and results.used.any(axis=1).tolist() == [True] * 5 + [False] * 2
    )


# What is reached
#
# In the order of the program: time and position, landmarks and film (A 121 to A 254), lens and
# solve (A 274 to A 443), angles of attack (C 1 to C 40). What is not reached is NaN.


WHERE = ["time_s", "vehicle_ft"]
MARKS = [
    "longitude_deg", "latitude_deg", "geocentric_latitude_deg", "altitude_ft", "radius_km",
    "radius_kft", "direction",
]  # fmt: skip
READ = ["centre_in", "point_in", "centre_mm", "point_mm"]
LENS = ["radius_mm", "distortion_mm"]
SOLVE = ["start_deg", "camera_deg", "vehicle_deg", "residual_mm", "correction_rad"]
ATTACK = ["alpha_deg", "beta_deg", "eta_deg", "airspeed_ft_s", "residual_deviation_mm"]
EVERYTHING = WHERE + MARKS + READ + LENS + SOLVE + ATTACK


def backward(part: str) -> Job:
    """Three frames, with one table in decreasing order."""
    name = {"clock": "frame", "camera": "lens_radius_mm", "wind": "altitude_ft"}.get(part, "time_s")
    job = film(3)
    table = getattr(job, part)
    return replace(job, **{part: replace(table, **{name: getattr(table, name)[::-1].copy()})})


STOPS = {  # the table: the stage, and what is known of the frame at which the run stops
    "clock": (Stage.TIME, []),
    "trajectory": (Stage.TIME, []),
    "camera": (Stage.LENS, WHERE + MARKS + READ),
    "wind": (Stage.WIND, WHERE + MARKS + READ + LENS + SOLVE),
}


def known(results: Results, frame: int) -> list[str]:
    """The arrays of numbers that hold no NaN in a frame."""
    return [name for name in EVERYTHING if not np.isnan(getattr(results, name)[frame]).any()]


def test_these_are_all_arrays_of_numbers() -> None:
    results = run(film(1))
    floats = [name for name in RESULT_ARRAYS if getattr(results, name).dtype == np.float64]
    assert sorted(EVERYTHING) == sorted(floats)


@pytest.mark.parametrize("part", STOPS)
@pytest.mark.parametrize("dropped", [0, 2])
def test_what_a_stopped_run_has(part: str, dropped: int) -> None:
    """Time and trajectory are looked up of dropped frames too; the others of the first solved."""
    stage, reached = STOPS[part]
    job = without(backward(part), *range(1, dropped + 1))
    results = run(job)
    at = 0 if stage == Stage.TIME else dropped
    assert results.stop is not None and results.stop.stage is stage
    assert results.frame.tolist() == list(range(1, at + 2))
    assert known(results, at) == ([] if at < dropped else reached)
    assert (results.outcome[:-1] == Outcome.DROPPED).all()
    assert results.outcome[-1] == Outcome.STOPPED
    for name in EVERYTHING:
        if name not in reached:
            assert np.isnan(getattr(results, name)[at]).all(), name
    if reached:
        whole = run(without(film(3), *range(1, dropped + 1)))
        for name in reached:
            np.testing.assert_array_equal(getattr(results, name)[at], getattr(whole, name)[at])


def test_what_frames_have_that_are_dropped() -> None:
    """Time, position and readings; and the start and correction of the solve, not its angles."""
    alone, among = run(without(film(2), 1, 2)), run(without(film(2), 1))
    assert known(alone, 0) == known(alone, 1) == WHERE + READ
    assert known(among, 0) == [*WHERE, *READ, "start_deg", "correction_rad"]
    assert known(among, 1) == EVERYTHING
    assert alone.outcome.tolist() == [Outcome.DROPPED] * 2 and alone.stop is None
    for results in (alone, among):
        assert not results.used[0].any() and not results.ignored[0].any()
        assert not results.singular[0] and not results.at_centre[0].any()


@pytest.mark.parametrize("names", [(), ("standard-deviation",), ("restart",), ("all",)])
@pytest.mark.parametrize("marks", [2, 3, 5])
def test_the_standard_deviation_of_a_frame(names: tuple[str, ...], marks: int) -> None:
    """The root of the sum of squares over 2N, or over 2N - 3 by its fix alone."""
    job = film(2)
    errors = np.random.default_rng(2).normal(0.0, 0.02, (2, 5, 1, 2))
    readings = reread(job.readings, landmark_in=job.readings.landmark_in + errors)
    everywhere = np.zeros(5, np.int64)
    everywhere[: 5 - marks] = np.arange(11, 16 - marks)
    ignored = replace(job.ignored, everywhere=everywhere)
    results = run(replace(job, readings=readings, ignored=ignored), fixes(*names))
    squares = np.nansum(results.residual_mm**2, axis=(1, 2))
    assert np.isfinite(results.residual_mm).sum(axis=(1, 2)).tolist() == [2 * marks] * 2
    fitted = 3 if names in (("standard-deviation",), ("all",)) else 0
    expected = np.sqrt(squares / (2 * marks - fitted))
    assert_close("residual", results.residual_deviation_mm, expected)


def test_when_all_residuals_vanished(monkeypatch: pytest.MonkeyPatch) -> None:
    """In pass 22 a frame is as good as solved; before it has no angles on tape 10."""
    real = vopd.orient_frames

    def orient_frames(*args: Any) -> Any:
        done, start = real(*args)
        done.last_pass[:] = [0, 1, 21, 22]
        return done, start

    monkeypatch.setattr(vopd, "orient_frames", orient_frames)
    results = run(film(4))
    names = [Outcome(one).name for one in results.outcome]
    assert names == ["SOLVED", "EXACT", "EXACT", "EXACT_LATE"]
    assert results.solved.tolist() == [True, False, False, True]
    assert results.last_pass.tolist() == [0, 1, 21, 22]
    wind = replace(film(4).wind, altitude_ft=film(4).wind.altitude_ft[::-1].copy())
    stopped = run(without(replace(film(4), wind=wind), 1))
    assert stopped.frame.tolist() == [1, 2, 3, 4]
    names = [Outcome(one).name for one in stopped.outcome]
    assert names == ["DROPPED", "EXACT", "EXACT", "STOPPED"]


@pytest.mark.parametrize("names", [(), ("all",)])
def test_a_film_without_any_landmark(names: tuple[str, ...]) -> None:
    """There is no residual, so all are zero in pass 1; jobs beside it are as they are alone."""
    job = film(2)
    present = np.zeros_like(job.readings.present)
    empty = replace(job, readings=reread(job.readings, present=present))
    first, found, last = vopd.run_jobs([film(1), empty, film(2)], fixes(*names))
    assert isinstance(found, Results) and found.outcome.tolist() == [Outcome.EXACT] * 2
    assert found.used.shape == (2, 0)
    assert [first, last] == [run(film(1), fixes(*names)), run(film(2), fixes(*names))]


def test_an_ignored_landmark_at_the_centre_is_not_marked() -> None:
    """All landmarks of a film are read at its centre; the first takes no part."""
    job = film(1)
    points = job.readings.fiducial_in.mean(axis=(1, 2))[:, None, None] + np.zeros((1, 5, 3, 2))
    everywhere = np.array([11, 0, 0, 0, 0])
    readings = reread(job.readings, landmark_in=points.round(6))
    corners = np.repeat(job.readings.fiducial_in.mean(axis=(1, 2))[:, None, None].round(6), 4, 1)
    readings = reread(readings, fiducial_in=np.repeat(corners, 3, 2))
    ignored = replace(job.ignored, everywhere=everywhere)
    results = run(replace(job, readings=readings, ignored=ignored))
    assert results.at_centre.tolist() == [[False, True, True, True, True]]
    assert np.isnan(results.radius_mm[0, 0]) and (results.radius_mm[0, 1:] == 0.0).all()
