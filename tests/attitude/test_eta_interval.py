"""The ends of the interval of eta against Rice's distribution, and which deviation counts where."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import rice

from tests.tolerances import assert_close
from vopd.attitude.uncertainty import eta_interval_deg

CHANCE = 0.025
LENGTHS = (0.0, 0.3, 1.02, 2.0, 2.7, 2.73, 3.337, 5.0, 7.9, 7.99, 8.01, 8.5, 12.0, 20.0)
"""Eta in standard deviations: on and between the points of a table, and beyond it."""


def interval(eta: float, sigma: float, covariance: list[list[float]]) -> list[float]:
    (ends,) = eta_interval_deg(np.array([eta]), np.array([sigma]), np.array([covariance]))
    return [float(end) for end in ends]


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("s", [1.0, 0.25])
def test_the_ends_are_the_lengths_that_make_the_measured_one_unlikely(
    length: float, s: float
) -> None:
    """Of the lower end .025 are measured longer, of the upper end .025 shorter."""
    lower, upper = interval(length * s, s, [[s * s, 0.0], [0.0, s * s]])
    if upper > s:  # the least upper end is one standard deviation
        assert_close("chance of an end", rice.cdf(length, upper / s), CHANCE)
    else:
        assert upper == s and rice.cdf(length, 1.0) < CHANCE
    if length < 2.7162:
        assert lower == 0.0
    else:
        assert_close("chance of an end", rice.sf(length, lower / s), CHANCE)


NEAR, HALF = 0.0, np.sqrt(8.0 * np.log(2.0))  # where the larger one counts wholly, and half


@pytest.mark.parametrize(
    ("eta", "sigma", "covariance", "s"),
    [
        (NEAR, 1.0, [[4.0, 0.0], [0.0, 1.0]], 2.0), (NEAR, 1.0, [[1.0, 0.0], [0.0, 4.0]], 2.0),
        (NEAR, 1.0, [[2.5, 1.5], [1.5, 2.5]], 2.0), (NEAR, 1.0, [[2.5, -1.5], [-1.5, 2.5]], 2.0),
        (2.0 * HALF, 1.0, [[4.0, 0.0], [0.0, 1.0]], np.sqrt(2.5)),
        (2.0 * HALF, 3.0, [[4.0, 0.0], [0.0, 1.0]], np.sqrt(6.5)),
        (60.0, 1.0, [[4.0, 0.0], [0.0, 1.0]], 1.0), (60.0, 0.5, [[4.0, 0.0], [0.0, 9.0]], 0.5),
        (2.0, np.inf, [[4.0, 0.0], [0.0, 1.0]], 2.0), (2.0, np.nan, [[4.0, 0.0], [0.0, 1.0]], 2.0),
    ],
)  # fmt: skip
def test_near_zero_the_larger_deviation_of_alpha_and_beta_counts(
    eta: float, sigma: float, covariance: list[list[float]], s: float
) -> None:
    """Far away that of eta; between them their squares are weighted by exp(-(eta/largest)**2/8)."""
    expected = interval(eta, s, [[s * s, 0.0], [0.0, s * s]])
    assert_close("table value", interval(eta, sigma, covariance), expected)


def test_eta_is_an_angle_from_0_to_180() -> None:
    equal = [[1.0, 0.0], [0.0, 1.0]]
    assert interval(179.5, 1.0, equal)[1] == 180.0
    assert interval(177.0, 1.0, equal)[1] < 180.0
    assert interval(1.0, 400.0, [[1.6e5, 0.0], [0.0, 1.6e5]]) == [0.0, 180.0]
    for eta, sigma, of_alpha in ((np.nan, 1.0, 1.0), (3.0, np.nan, np.nan), (3.0, np.inf, np.inf)):
        found = interval(eta, sigma, [[of_alpha, 0.0], [0.0, of_alpha]])
        assert np.isnan(found).all()
