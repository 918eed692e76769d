"""Losses: how much a pick counts whose distance from its landmark's image is large."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats

HUBER = 1.345  # standard deviations from where on the loss grows evenly
CAUCHY = 2.385  # standard deviations; both have 95 % of least squares' efficiency


class Loss(NamedTuple):
    """A loss of z, the squared distance over the squared standard deviation of a pick."""

    value: Callable[[Floats], Floats]
    weight: Callable[[Floats], Floats]  # its derivative
    curvature: Callable[[Floats], Floats]  # its second derivative


def _huber(z: Floats) -> Floats:
    return np.where(z <= HUBER**2, z, 2.0 * HUBER * np.sqrt(z) - HUBER**2)


def _huber_weight(z: Floats) -> Floats:
    return HUBER / np.sqrt(np.maximum(z, HUBER**2))


def _huber_curvature(z: Floats) -> Floats:
    return np.where(z <= HUBER**2, 0.0, -0.5 * HUBER / np.maximum(z, HUBER**2) ** 1.5)


def _cauchy(z: Floats) -> Floats:
    return CAUCHY**2 * np.log1p(z / CAUCHY**2)


def _cauchy_weight(z: Floats) -> Floats:
    return 1.0 / (1.0 + z / CAUCHY**2)


def _cauchy_curvature(z: Floats) -> Floats:
    return -((CAUCHY + z / CAUCHY) ** -2.0)


LOSSES = {
    "least-squares": Loss(np.asarray, np.ones_like, np.zeros_like),
    "huber": Loss(_huber, _huber_weight, _huber_curvature),
    "cauchy": Loss(_cauchy, _cauchy_weight, _cauchy_curvature),
}
"""By the names that a project file takes."""
