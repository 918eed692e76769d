"""What correcting the errata changes, against attitudes that are known on a real Earth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit import wgs84_film
from tests.kit.jobs import case, film, only, reread
from tests.kit.wgs84_film import PLACES
from tests.tolerances import assert_close, within
from vopd import film as estimates
from vopd.errata import Fix, Fixes, fixes
from vopd.film import film_estimate
from vopd.job import Job
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
