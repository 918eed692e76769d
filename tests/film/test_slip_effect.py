"""What correcting the errata changes, against known attitudes, and how that run is made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit import wgs84_film
from tests.kit.jobs import case, film, only, reread, turned
from tests.kit.wgs84_film import PLACES
from tests.tolerances import assert_close, within
from vopd import film as estimates
from vopd.errata import NO_FIXES, Fix, Fixes, fixes
from vopd.film import film_estimate, slip_effects_deg
from vopd.job import Job
from vopd.program.positions import UndefinedLandmark
from vopd.program.vopd import run
from vopd.results import Outcome, Results

BERN = (46.6, 7.4)


def wrapped(degrees: np.ndarray) -> np.ndarray:
    return (degrees + 180.0) % 360.0 - 180.0


@pytest.mark.parametrize("place", PLACES)
def test_it_is_the_truth_on_wgs84_minus_the_run(place: tuple[float, float]) -> None:
    """The angle between the verticals, .08 to .18 degree but for the equator, is not in it."""
    job, truth = wgs84_film.film(*place, decimals=None)
    one = film_estimate(run(job))
    assert one.slip_effect_deg is not None
    expected = wrapped(truth - one.camera_deg)
    off = one.slip_effect_deg[:, :6] - np.tile(expected, 2)  # the vehicle's angles are the camera's
    assert np.abs(off).max() < within("attitude, noise-free arrays")
    lean = np.abs(one.position.latitude_deg - one.position.geocentric_latitude_deg)
    assert np.abs(expected).max() < lean.min()


@pytest.mark.parametrize(
    ("scale", "at_least"),
    [(1.0, 0.01), (1 / 12, 0.06), (1 / 300, 1.5)],
    ids=["36 km", "3 km", "120 m"],
)
def test_near_the_ground_it_grows(scale: float, at_least: float) -> None:
    job, truth = wgs84_film.film(*BERN, decimals=None, scale=scale)
    one = film_estimate(run(job))
    assert one.slip_effect_deg is not None
    expected = wrapped(truth - one.camera_deg)
    off = np.abs(one.slip_effect_deg[:, :3] - expected)
    assert off.max() < within("attitude from 120 m")
    assert np.abs(expected).max() > at_least


def test_the_angles_of_attack_move_with_the_vehicle() -> None:
    """Alpha, beta, eta of the true attitude by scipy, less those of the run."""
    job, truth = wgs84_film.film(*BERN, decimals=None, scale=1 / 300)
    one = film_estimate(run(job))
    body = Rotation.from_euler("ZYX", truth, degrees=True)
    u, v, w = body.inv().apply(job.trajectory.velocity_ft_s).T
    expected = np.degrees([np.arctan2(w, u), np.arctan2(v, u), np.arctan2(np.hypot(v, w), u)]).T
    assert one.slip_effect_deg is not None
    off = wrapped(one.attack_deg + one.slip_effect_deg[:, 6:] - expected)
    assert np.abs(off).max() < within("angle of attack from 120 m")


def test_what_is_left_after_the_fix_earth_is_small() -> None:
    """`eight-digits` changes angles by less than .00001 degree, as its entry says."""
    job, _ = wgs84_film.film(33.08, -106.33, decimals=3)
    others = Fixes(frozenset(Fix) - {Fix.EIGHT_DIGITS})
    effect = film_estimate(run(job, others)).slip_effect_deg
    assert effect is not None and 0.0 < np.abs(effect[:, :6]).max() < within("angle from readings")


def test_a_run_with_all_fixes_has_none() -> None:
    assert film_estimate(run(case(1), fixes("all"))).slip_effect_deg is None
    assert film_estimate(run(case(1), fixes("all", ellipsoid="clarke1866"))).slip_effect_deg is None


def test_the_ellipsoid_is_that_of_the_run() -> None:
    """All other fixes are in force: on another ellipsoid the same small effect is left."""
    job, _ = wgs84_film.film(33.08, -106.33, decimals=3)
    ellipsoid = fixes("all", ellipsoid="international1924").ellipsoid
    others = Fixes(frozenset(Fix) - {Fix.EIGHT_DIGITS}, ellipsoid)
    effect = film_estimate(run(job, others)).slip_effect_deg
    assert effect is not None and np.abs(effect[:, :6]).max() < within("angle from readings")


def test_a_frame_without_an_attitude_has_none_and_the_others_do() -> None:
    job, truth = wgs84_film.film(*BERN, decimals=None)
    present = job.readings.present.copy()
    present[5, 1:] = False  # one landmark is left
    readings = reread(job.readings, present=present)
    one = film_estimate(run(replace(job, readings=readings)))
    assert one.slip_effect_deg is not None
    missing = np.isnan(one.slip_effect_deg).any(axis=1)
    assert missing.tolist() == [k == 5 for k in range(len(truth))]


def test_frames_that_the_fixes_leave_without_an_answer_have_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of five frames one does not converge with the fixes, one vanishes, one is not determined.

    The last is not reached, because a table out of order ends the corrected run.
    """
    results = run(film(5))

    def corrected(jobs: list[Job], *_: object) -> list[Results]:
        (job,) = jobs
        other = run(job, fixes("all"))
        other.correction_rad[0, 1] = 1.1e-6
        other.outcome[1] = Outcome.EXACT
        return [other.take(slice(0, 4))]

    monkeypatch.setattr(estimates, "run_jobs", corrected)
    determined = np.array([True, True, False, True, True])
    (effect,) = estimates.slip_effects_deg([results], [determined])
    assert effect is not None and effect.shape == (5, 9)
    assert np.isfinite(effect).all(axis=1).tolist() == [False, False, False, True, False]
    assert np.isnan(effect[[0, 1, 2, 4]]).all()


def test_one_landmark_alone_has_no_effect() -> None:
    effect = film_estimate(run(only(case(1), 0))).slip_effect_deg
    assert effect is not None and np.isnan(effect).all()


def test_case_4_to_the_digits_of_the_errata_page() -> None:
    """docs/errata.md, made by another start: +0.056 +0.0044 -0.068 and +0.053 +0.0031 -0.068."""
    effect = film_estimate(run(case(4))).slip_effect_deg
    assert effect is not None
    expected = [[0.056, 0.0044, -0.068], [0.053, 0.0031, -0.068]]
    found = effect[np.isfinite(effect[:, 0]), :3]
    assert_close("errata page", found, expected)


def test_jobs_together_have_the_effects_that_each_has_alone() -> None:
    """One is stopped by a table, one comes less far than with all fixes, and one farther."""
    wind = film(3).wind
    backwards = replace(wind, altitude_ft=wind.altitude_ft[::-1].copy())
    stops = replace(film(3), wind=backwards)
    solved = [run(job) for job in (film(4), stops, film(1), film(2), film(3))]
    farther = replace(solved[4], job=stops)
    jobs = [*solved[:3], solved[3].take(slice(1)), farther, solved[3]]
    known = [one.solved & (one.frame != 2) for one in jobs]
    together = estimates.slip_effects_deg(jobs, known)
    for one, determined, effect in zip(jobs, known, together, strict=True):
        (alone,) = estimates.slip_effects_deg([one], [determined])
        assert effect is not None and effect.shape == (len(one.frame), 9)
        np.testing.assert_array_equal(effect, alone)
        expected = determined & (one is not farther)
        assert (np.isfinite(effect[:, 0]) == expected).all()


# The corrected run


ALL = np.ones(3, bool)
ANGLES = (
    "camera yaw", "camera pitch", "camera roll", "vehicle yaw", "vehicle pitch", "vehicle roll",
    "alpha", "beta", "eta",
)  # fmt: skip


def mounted(offset_deg: Sequence[float]) -> Job:
    """A film of three frames whose camera turns, with the vehicle's angles apart from its own."""
    truth = np.array([[140.0, -70.0, 60.0], [141.0, -69.0, 62.0], [142.0, -71.0, 61.0]])
    job = turned(truth, truth[0])
    camera = replace(
        job.camera, multiplier=np.array([1.0, -0.5, 1.0]), offset_deg=np.array(offset_deg)
    )
    return replace(job, camera=camera)


def nine(results: Results) -> np.ndarray:
    attack = [results.alpha_deg, results.beta_deg, results.eta_deg]
    return np.column_stack([results.camera_deg, results.vehicle_deg, *attack])


def test_each_angle_is_corrected_minus_run() -> None:
    results = run(mounted([10.0, -20.0, 30.0]), fixes("restart"))
    corrected = run(results.job, fixes("all"), results.camera_deg)
    (effect,) = slip_effects_deg([results], [ALL])
    assert effect is not None
    expected = nine(corrected) - nine(results)
    assert not expected.round().any() and (expected != 0.0).all()
    for column, name in enumerate(ANGLES):
        apart = np.abs(effect[:, column] - expected[:, column])
        assert (apart < within("wrapped angle")).all(), name


@pytest.mark.parametrize("side", [1e-9, -1e-9])
def test_an_angle_that_passes_a_full_circle_changes_little(side: float) -> None:
    """The vehicle's yaw, pitch and roll of frame 1 are at the ends of their circles."""
    before = run(mounted([0.0, 0.0, 0.0])).vehicle_deg[0]
    ends = np.array([0.0, 180.0, 360.0]) + side - before
    results = run(mounted(ends))
    (effect,) = slip_effects_deg([results], [ALL])
    corrected = run(results.job, fixes("all"), results.camera_deg)
    assert effect is not None and not effect.round().any()
    apart = np.abs(nine(corrected) - nine(results)).round()
    assert (apart == 360.0).any()


Calls = list[tuple[Sequence[Job], Fixes, Sequence[np.ndarray]]]


@pytest.fixture
def calls(monkeypatch: pytest.MonkeyPatch) -> Calls:
    """The arguments of every run that is made."""
    made: Calls = []
    real = estimates.run_jobs

    def run_jobs(jobs: Any, chosen: Any, starts: Any) -> Any:
        made.append((jobs, chosen, starts))
        return real(jobs, chosen, starts)

    monkeypatch.setattr(estimates, "run_jobs", run_jobs)
    return made


@pytest.mark.parametrize("ellipsoid", ["wgs84", "clarke1866"])
def test_all_errata_and_the_ellipsoid_of_the_run(ellipsoid: str, calls: Calls) -> None:
    chosen = fixes("earth", ellipsoid=ellipsoid)
    slip_effects_deg([run(film(3), chosen)], [ALL])
    ((_, used, _),) = calls
    assert used.chosen == frozenset(Fix) and used.ellipsoid == chosen.ellipsoid


def test_where_each_frame_starts(calls: Calls) -> None:
    """From its solution; from group 8 if it is not determined, or the run did not come to it."""
    results = run(film(4)).take(slice(3))
    slip_effects_deg([results, results], [np.array([True, False, True]), ALL])
    ((jobs, _, (first, second)),) = calls
    assert [job is results.job for job in jobs] == [True, True]
    group_8 = [140.0, -80.0, 60.0]
    solved = results.camera_deg.tolist()
    assert first.tolist() == [solved[0], group_8, solved[2], group_8]
    assert second.tolist() == [*solved, group_8]


def test_nothing_is_run_again_where_nothing_is_left_to_correct(calls: Calls) -> None:
    assert slip_effects_deg([], []) == []
    both = [run(film(3), fixes("all")), run(film(3), fixes("all"))]
    assert slip_effects_deg(both, [ALL, ALL]) == [None, None] and calls == []
    all_but_one = Fixes(frozenset(Fix) - {Fix.SIN_6PHI})
    assert slip_effects_deg([run(film(3), all_but_one)], [ALL])[0] is not None


def test_an_error_of_the_corrected_run_is_raised_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    error = UndefinedLandmark(2, 66)
    monkeypatch.setattr(estimates, "run_jobs", lambda *_: [error])
    with pytest.raises(UndefinedLandmark) as caught:
        slip_effects_deg([run(film(3), NO_FIXES)], [ALL])
    assert caught.value is error
