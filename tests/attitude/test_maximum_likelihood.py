"""The reading sigma where other errors are far larger than the readings."""

from __future__ import annotations

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.attitude.common_errors import CommonErrors
from vopd.attitude.maximum_likelihood import JobFrames, most_likely
from vopd.attitude.residual_covariance import ResidualEquations

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
    left = float(np.linalg.lstsq(partials, residual)[1][0])
    sigma, freedom = sigma_of(one)
    assert_close("sigma by a search", sigma, np.sqrt(left / 11.0))
    assert_close("sigma by a search", freedom * 13.0 / 11.0**2, 1.0)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("common", [1e5, 1e9, 1e14])
def test_errors_that_explain_all_residuals_say_nothing_about_the_readings(
    common: float, seed: int
) -> None:
    """Of four coordinates three go to the turns and the other to the errors: rounding is left."""
    sigma, _ = sigma_of(frame(seed, 2, common))
    assert round(sigma, 9) <= LEAST
