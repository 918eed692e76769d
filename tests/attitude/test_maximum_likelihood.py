"""The reading sigma where other errors are far larger than the readings."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.tolerances import assert_close
from vopd.attitude.reading_sigma import CommonErrors, JobFrames, most_likely
from vopd.attitude.residuals import ResidualEquations

LEAST = 0.01  # the least reading sigma that is believed


def frame(seed: int, landmarks: int, common: float) -> JobFrames:
    """A frame; the first landmark's position has three errors that all frames of its job share.

    Args:
        seed: of residuals and derivatives
        landmarks: how many there are
        common: what a position that is wrong by a sigma changes in the image, in residuals
    """
    rng = np.random.default_rng(seed)
    two = 2 * landmarks
    columns = np.zeros((1, two, 3))
    columns[0, [0, landmarks]] = common * rng.normal(size=(2, 3))
    equations = ResidualEquations(
        rng.normal(size=(1, two)),
        1500.0 * rng.normal(size=(1, two, 3)),
        np.ones((1, two)),
        np.zeros((1, two, 0)),
        np.zeros((1, two, 0)),
    )
    return JobFrames(np.zeros(1, np.int64), equations, CommonErrors(columns, np.arange(3)[None], 3))


def sigma_of(one: JobFrames) -> tuple[float, float]:
    """The reading sigma of a job of one frame and its degrees of freedom, as in a solve."""
    with np.errstate(all="ignore"):
        sigma, freedom = most_likely([one], np.ones(1), np.full(1, LEAST))
    return float(sigma[0]), float(freedom[0])


@pytest.mark.parametrize("common", [1e5, 1e9, 1e14])
def test_an_error_without_limit_is_one_more_number_that_is_fitted(common: float) -> None:
    """Then sigma is that of a fit of the three turns without the landmark that is not known."""
    one = frame(3, 8, common)
    others = np.delete(np.arange(16), [0, 8])
    partials, residual = one.equations.partials[0, others], one.equations.residual[0, others]
    left = float(np.linalg.lstsq(partials, residual, rcond=None)[1][0])
    sigma, freedom = sigma_of(one)
    assert_close("sigma by a search", sigma, np.sqrt(left / 11.0))
    assert_close("sigma by a search", freedom * 13.0 / 11.0**2, 1.0)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("common", [1e5, 1e9, 1e14])
def test_errors_that_explain_all_residuals_say_nothing_about_the_readings(
    common: float, seed: int
) -> None:
    """Of four coordinates three go to the turns and the other to the errors: rounding is left.

    A sigma of the least or more would be believed. That of the readings is 6E-5 of a residual of
    one at the limit of what an error may explain, and rounding is not taken for one.
    """
    sigma, _ = sigma_of(frame(seed, 2, common))
    assert sigma < LEAST


def job_of(seed: int) -> ResidualEquations:
    """Two frames of three landmarks, whose shared errors are ten times those of the readings."""
    rng = np.random.default_rng(seed)
    shared = rng.normal(size=(2, 6, 2))
    residual = (shared @ rng.normal(size=(2, 2, 1)))[..., 0] + 0.1 * rng.normal(size=(2, 6))
    partials = rng.normal(size=(2, 6, 3))
    return ResidualEquations(residual, partials, np.ones((2, 6)), shared, np.zeros((2, 6, 0)))


def score(one: ResidualEquations, sigma: float) -> tuple[float, float]:
    """r' W W r and the trace of W by whole matrices."""
    squares = trace = 0.0
    for r, b, shared in zip(one.residual, one.partials, one.shared, strict=True):
        inverse = np.linalg.inv(sigma**2 * np.eye(6) + shared @ shared.T)
        w = inverse - inverse @ b @ np.linalg.inv(b.T @ inverse @ b) @ b.T @ inverse
        squares, trace = squares + float(r @ w @ w @ r), trace + float(np.trace(w))
    return squares, trace


def excess(log_sigma: float, one: ResidualEquations) -> float:
    squares, trace = score(one, float(np.exp(log_sigma)))
    return float(np.log(squares / trace))


@pytest.mark.parametrize("start", [0.03, 0.1, 3.0])
def test_jobs_together_have_the_sigma_of_each_by_a_search(start: float) -> None:
    """Where few steps do not lead to it, a search does; degrees of freedom are those of the part
    of the residuals that the readings have. Of residuals below the least it is half of that.
    """
    jobs = [job_of(seed) for seed in range(8)]
    together = ResidualEquations.concat(jobs)
    none = CommonErrors(np.zeros((16, 6, 0)), np.zeros((16, 0), np.int64), 0)
    part = JobFrames(np.repeat(np.arange(8), 2), together, none)
    with np.errstate(all="ignore"):
        sigma, freedom = most_likely([part], np.full(8, start), np.full(8, LEAST))
    low, high = np.log(LEAST), np.log(100.0)
    for k, one in enumerate(jobs):
        if excess(low, one) <= 0.0:
            assert sigma[k] <= LEAST
            continue
        expected = float(np.exp(brentq(excess, low, high, args=(one,))))
        assert_close("sigma by a search", sigma[k] / expected, 1.0)
        of_readings = expected**2 * score(one, expected)[1]
        assert_close("sigma by a search", freedom[k] * 6.0 / of_readings**2, 1.0)
