"""How far three readings of one point may differ before `vopd check` warns.

The limit comes from the noise of the deck's own readings. A deck of n points
has 2n triples of readings (x and y). If all readings have the same normal noise
of standard deviation s, the difference of two has the deviation s sqrt(2), and
a triple has three differences. So, by Bonferroni's inequality, no triple of the
deck exceeds

    limit = s sqrt(2) z(1 - p / (6 * 2n)),    z: quantile of the normal distribution,

but with probability p. The noise s is estimated from the median of the triples'
variances, which a few bad triples do not move: a triple's variance is
exponentially distributed about s squared, so its median is s squared ln 2. A
short film has too few triples for that, so the usual care of a film reader
counts as much as `USUAL_WEIGHT` triples.
"""

from __future__ import annotations

from statistics import NormalDist

import numpy as np

from vopd.arrays import Floats
from vopd.job import Readings

USUAL_NOISE_IN = 0.003
"""Standard deviation of one reading by a careful film reader, inches."""
USUAL_WEIGHT = 50
NEVER_BELOW_IN = 0.010
"""Readings of one point that differ by this much or less are not questioned."""
CHANCE = 0.001
"""Probability that a deck without a bad reading draws a finding."""


def noise_in(readings: Readings) -> float:
    """The standard deviation of one reading, inches, from the triples of all points."""
    variance = _triples(readings).var(axis=1, ddof=1)
    from_deck = float(np.median(variance)) / np.log(2.0) if len(variance) else 0.0
    total = USUAL_WEIGHT * USUAL_NOISE_IN**2 + len(variance) * from_deck
    return float(np.sqrt(total / (USUAL_WEIGHT + len(variance))))


def spread_limit_in(readings: Readings) -> float:
    """How far three readings of one point of this film may differ, inches."""
    tails = 6 * max(len(_triples(readings)), 1)
    quantile = -NormalDist().inv_cdf(CHANCE / tails)
    return max(NEVER_BELOW_IN, float(np.sqrt(2.0)) * quantile * noise_in(readings))


def _triples(readings: Readings) -> Floats:
    """The three readings of every coordinate of every point (2n, 3)."""
    fiducials = readings.fiducial_in.swapaxes(2, 3).reshape(-1, 3)
    landmarks = readings.points.landmark_in.swapaxes(1, 2).reshape(-1, 3)
    return np.concatenate([fiducials, landmarks])
