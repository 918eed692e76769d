"""Positions and attitudes of a camera from the images of three points (Grunert's solution)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.nearest_rotation import nearest_rotation

NOTHING = 1e-14
"""What is left of the terms of a quartic, relative to their sum, up to which it counts as 0."""


def three_point_resection(points: Floats, rays: Floats) -> list[tuple[Floats, Floats]]:
    """All positions and attitudes from which three points are seen along three rays.

    Args:
        points: coordinates of the points, (3, 3)
        rays: unit vectors to them in camera axes, (3, 3)

    Returns:
        Up to four pairs of orientation matrix (3, 3) and position (3,).

    Source: R. M. Haralick, C. Lee, K. Ottenberg and M. Noelle, Review and analysis of
    solutions of the three point perspective pose estimation problem, Int. J. Computer
    Vision 13 (1994), Grunert's solution.
    """
    a2, b2, c2 = (((points[i] - points[j]) ** 2).sum() for i, j in ((1, 2), (0, 2), (0, 1)))
    if not min(a2, b2, c2) > 0.0:
        return []
    alpha, beta, gamma = (float(rays[i] @ rays[j]) for i, j in ((1, 2), (0, 2), (0, 1)))
    seen = []
    for v in _ratios(a2 / b2, c2 / b2, alpha, beta, gamma):
        difference = (a2 - c2) / b2
        below = 2.0 * (gamma - v * alpha)
        above = (difference - 1.0) * v**2 - 2.0 * difference * beta * v + 1.0 + difference
        square = 1.0 + v**2 - 2.0 * v * beta
        if below == 0.0 or not square > 0.0 or not above / below > 0.0:
            continue
        first = np.sqrt(b2 / square)
        seen.append(rays * (first * np.array([1.0, above / below, v]))[:, None])
    return _placed(points, np.array(seen)) if seen else []


def _ratios(a: float, c: float, alpha: float, beta: float, gamma: float) -> list[float]:
    """Ratios of the third distance to the first: positive real roots of Grunert's quartic.

    Args:
        a: square of side 2 3 over that of side 1 3
        c: square of side 1 2 over that of side 1 3
        alpha: cosine of the angle between rays 2 and 3
        beta: between 1 and 3
        gamma: between 1 and 2
    """
    d, s = a - c, a + c
    quartic = [
        (d - 1.0) ** 2 - 4.0 * c * alpha**2,
        4.0 * (d * (1.0 - d) * beta - (1.0 - s) * alpha * gamma + 2.0 * c * alpha**2 * beta),
        2.0
        * (
            d**2 - 1.0 + 2.0 * d**2 * beta**2 + 2.0 * (1.0 - c) * alpha**2
            - 4.0 * s * alpha * beta * gamma + 2.0 * (1.0 - a) * gamma**2
        ),
        4.0 * (-d * (1.0 + d) * beta + 2.0 * a * gamma**2 * beta - (1.0 - s) * alpha * gamma),
        (1.0 + d) ** 2 - 4.0 * a * gamma**2,
    ]  # fmt: skip
    if not np.isfinite(quartic).all() or not np.any(quartic):
        return []
    roots = np.roots(quartic)
    # rounding parts a double root into two complex ones, of which the real part is as good a root
    left = np.abs(np.polyval(quartic, roots.real))
    terms = np.polyval(np.abs(quartic), np.abs(roots.real))
    real = (roots.imag == 0.0) | (left <= NOTHING * terms)
    return [float(root) for root in roots.real[real] if root > 0.0]


def _placed(points: Floats, seen: Floats) -> list[tuple[Floats, Floats]]:
    """Attitudes and positions that bring points (3, 3) to where the camera has them (n, 3, 3)."""
    middle, centre = points.mean(axis=0), seen.mean(axis=1, keepdims=True)
    matrices = nearest_rotation((seen - centre).swapaxes(1, 2) @ (points - middle)).rotation
    return [(one, middle - one.T @ place[0]) for one, place in zip(matrices, centre, strict=True)]
