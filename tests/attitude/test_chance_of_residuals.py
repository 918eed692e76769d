"""The chance of a frame's residuals, by chi-square and by F, and which frames are tested."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2, f

from tests.kit.estimates import POINTS, estimate
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.attitude import residuals as residual_test
from vopd.attitude.residuals import SIGNIFICANCE, Pool, chance_of, equations_of, finite
from vopd.attitude.sigmas import ErrorComponent
from vopd.estimate import Estimate

ANGLES = np.tile([140.0, -60.0, 20.0], (3, 1))
FREEDOM = 5  # of four landmarks
NONE = np.nan


def job() -> Estimate:
    return estimate(ANGLES, noise=0.5, relative_sigma=np.tile([1.0, 1.5, 1.0, 2.0], (3, 1)))


def squares(e: Estimate, sigma: float) -> Floats:
    """The weighted sums of squares that least squares leave, in squares of sigma."""
    w = 1.0 / np.tile([1.0, 1.5, 1.0, 2.0], 2)
    found = []
    for b, r in zip(e.partials, e.residual, strict=True):
        fit, *_ = np.linalg.lstsq(b * w[:, None], r * w, rcond=None)
        found.append(((r * w - (b * w[:, None]) @ fit) ** 2).sum() / sigma**2)
    return np.array(found)


ALL = np.arange(3)


def chance(e: Estimate, pool: Pool, *components: ErrorComponent) -> Floats:
    return chance_of(equations_of(e, list(components), ALL), pool)


def test_significance() -> None:
    assert SIGNIFICANCE == 0.001


def test_a_known_sigma_is_tested_by_chi_square() -> None:
    e = job()
    for sigma in (0.4, 0.7):
        found = chance(e, Pool(sigma, np.inf, None))
        assert_close("dense algebra", found, chi2.sf(squares(e, sigma), FREEDOM))
    each = np.array([0.4, 0.5, 0.7])
    found = chance(e, Pool(each, np.full(3, np.inf), None))
    expected = [chi2.sf(squares(e, each[k])[k], FREEDOM) for k in range(3)]
    assert_close("dense algebra", found, expected)


def test_an_estimate_from_other_frames_is_tested_by_f() -> None:
    e = job()
    found = chance(e, Pool(0.4, 12.0, None))
    assert_close("dense algebra", found, f.sf(squares(e, 0.4) / FREEDOM, FREEDOM, 12.0))
    none = chance(e, Pool(0.4, 12.0, np.zeros(3, bool)))
    assert_close("dense algebra", none, found)


def test_a_frame_is_tested_against_the_others_that_made_the_estimate() -> None:
    """Their variance is what the frame leaves of the whole: of 15 degrees 10."""
    e = job()
    s = squares(e, 0.5)
    found = chance(e, Pool(0.5, 15.0, np.array([True, False, True])))
    against = f.sf((s / FREEDOM) / ((15.0 - s) / 10.0), FREEDOM, 10.0)
    others = f.sf(s / FREEDOM, FREEDOM, 15.0)
    assert_close("dense algebra", found, np.where([True, False, True], against, others))


def test_where_nothing_is_left_of_the_others() -> None:
    """All of the variance is the frame's: no chance. All of the degrees are: not known."""
    e = job()
    s = squares(e, 0.2)
    more = Pool(0.2, float(s[0]) - 1e-6, np.array([True, False, False]))
    assert more.freedom > FREEDOM + 0.5  # or the case is another one
    assert chance(e, more)[0] == 0.0
    for freedom, known in ((5.4, False), (5.6, True)):
        found = chance(e, Pool(5.0, freedom, np.array([True, True, False])))
        assert np.isfinite(found).tolist() == [known, known, True]


def test_frames_of_a_known_and_of_an_estimated_sigma_together() -> None:
    e = job()
    sigma, freedom = np.array([0.4, 0.5, 0.6]), np.array([np.inf, 12.0, np.inf])
    found = chance(e, Pool(sigma, freedom, np.zeros(3, bool)))
    expected = [chi2.sf(squares(e, 0.4)[0], FREEDOM), 0.0, chi2.sf(squares(e, 0.6)[2], FREEDOM)]
    expected[1] = f.sf(squares(e, 0.5)[1] / FREEDOM, FREEDOM, 12.0)
    assert_close("dense algebra", found, expected)


def test_other_errors_are_known_whatever_the_readings() -> None:
    """Where other errors are nearly all of the variance an estimate is as good as a known one."""
    e = job()
    rng = np.random.default_rng(2)
    shift = ErrorComponent("position", 300.0 * rng.normal(size=(3, 8, 8)), *np.zeros((2, 3, 1, 1)))
    known, estimated = (chance(e, Pool(0.01, free, None), shift) for free in (np.inf, 6.0))
    assert_close("chance by readings of nothing", estimated, known)


def test_equations_of_some_frames() -> None:
    """Errors that landmarks share stand side by side, and those of each landmark's own."""
    e = job()
    used = np.array([[True, True, False, True]] * 3)
    e = replace(e, used=used)
    rng = np.random.default_rng(1)
    one, two, own, other = (rng.normal(size=(3, 8, k)) for k in (2, 1, 3, 3))
    one[2, 0, 0] = NONE
    none = np.zeros((2, 3, 1, 1))
    components = [
        ErrorComponent("centre", one, *none), ErrorComponent("landmark", own, *none, True),
        ErrorComponent("focal", two, *none), ErrorComponent("landmark", other, *none, True),
    ]  # fmt: skip
    found = equations_of(e, components, np.array([2, 0]))
    here = np.tile(used[0], 2)
    expected = np.concatenate([np.nan_to_num(one), two], axis=2)[[2, 0]] * here[:, None]
    assert np.array_equal(found.shared, expected)
    assert np.array_equal(found.own, np.concatenate([own, other], axis=2)[[2, 0]] * here[:, None])
    assert np.array_equal(found.variance[0], np.array([1.0, 2.25, 0.0, 4.0] * 2))
    assert np.array_equal(found.residual, e.residual[[2, 0]] * here)
    assert np.array_equal(found.partials, e.partials[[2, 0]] * here[:, None])
    assert found.freedom.tolist() == [3.0, 3.0]
    columns = np.array([[[1.0, NONE], [2.0, 3.0], [np.inf, 4.0]]])
    assert finite(columns, np.array([[True, False, True]])).tolist() == [
        [[1.0, 0.0], [0.0, 0.0], [0.0, 4.0]]
    ]


@pytest.mark.parametrize(
    ("name", "index"), [("gain", (1, 2, 3)), ("residual", (1, 4)), ("partials", (1, 2, 0)),
                        ("camera_deg", (1, 2))],
)  # fmt: skip
def test_frames_of_which_something_is_not_known_are_not_tested(name: str, index: Any) -> None:
    e = job()
    assert residual_test.testable(e).all()
    values = getattr(e, name).copy()
    values[index] = NONE
    assert residual_test.testable(replace(e, **{name: values})).tolist() == [True, False, True]


def test_two_landmarks_of_a_solved_frame_are_tested() -> None:
    solved = np.array([True, False, True])
    assert residual_test.testable(replace(job(), solved=solved)).tolist() == solved.tolist()
    for numbers, tested in (((7, 8), True), ((7, 7), False), ((7,), False)):
        one = estimate(ANGLES[:1], POINTS[: len(numbers)], landmark=np.array([numbers]))
        assert residual_test.testable(one).tolist() == [tested]
