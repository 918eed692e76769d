"""A 95 % interval of eta, the total angle of attack, which cannot be below zero."""

from __future__ import annotations

from functools import cache

import numpy as np
from scipy.special import chndtrinc

from vopd.arrays import Floats

HALF_WIDTH = 1.959963984540054  # of a 95 % interval, standard deviations
FAR = 8.0  # standard deviations from zero beyond which a formula serves
ONE_SIDED = 2.7162  # standard deviations: below, no length is too small for the measured one
STEP = 0.05  # of the table up to there; interpolated, its error is below 1e-3


@np.errstate(all="ignore")
def eta_interval_deg(eta_deg: Floats, sigma_deg: Floats, alpha_beta_deg2: Floats) -> Floats:
    """Lower and upper end of the 95 % interval of eta, (F, 2) degrees.

    Near zero eta is the length of a vector of two components, alpha and beta. If both have
    the standard deviation s, the square of a measured length over s squared has the
    noncentral chi-square distribution with two degrees of freedom. The ends are the lengths
    for which a measured one this large, or this small, has the probability .025. The
    lower end is 0 where eta is within 2.7 s of zero. Where the standard
    deviations of alpha and beta differ the larger one is taken near zero, which makes the interval
    too wide rather than too narrow.

    Args:
        eta_deg: eta, 0 to 180, (F,)
        sigma_deg: standard deviation of eta away from zero, (F,)
        alpha_beta_deg2: covariance of alpha and beta, (F, 2, 2)
    """
    half_trace = np.trace(alpha_beta_deg2, axis1=1, axis2=2) / 2.0
    xx, xy = alpha_beta_deg2[:, 0, 0], alpha_beta_deg2[:, 0, 1]
    largest = np.sqrt(half_trace + np.hypot(xx - half_trace, xy))
    near = np.exp(-((eta_deg / largest) ** 2) / 8.0)
    along = np.where(np.isfinite(sigma_deg), sigma_deg, largest)
    s = np.sqrt(along**2 + near * (largest**2 - along**2))
    length = eta_deg / s
    lower, upper = (
        np.where(
            length < FAR,
            np.interp(length, *_ends(chance)),
            length - 0.5 / length + side * HALF_WIDTH,
        )
        for chance, side in ((0.975, -1.0), (0.025, 1.0))
    )
    lower, upper = s * np.where(length < ONE_SIDED, 0.0, lower), s * np.maximum(upper, 1.0)
    ends = np.stack([lower, np.minimum(upper, 180.0)], axis=1)
    return np.where(np.isfinite(s)[:, None], ends, np.nan)


@cache
def _ends(chance: float) -> tuple[Floats, Floats]:
    """Measured lengths, and the true ones for which a smaller measured one has this probability."""
    length = np.arange(0.0, FAR + STEP, STEP)
    return length, np.nan_to_num(np.sqrt(chndtrinc(length**2, 2.0, chance)))
