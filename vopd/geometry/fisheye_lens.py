"""The equidistant fisheye with four coefficients (Kannala and Brandt, as in OpenCV).

A ray at the angle t off the optical axis has its image at the radius
t (1 + k1 t2 + k2 t4 + k3 t6 + k4 t8), in units of the focal length.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import polynomial

from vopd.arrays import Floats

ROUNDS = 60


def distort(k: Floats, x: Floats, y: Floats) -> tuple[tuple[Floats, Floats], Floats]:
    """Distort ideal points, and give the derivatives of the result with respect to the ideal point.

    Args:
        k: the coefficients, (4,)
        x: ideal, in the plane at unit distance, (...)
        y: ideal, (...)

    Returns:
        The distorted x and y, (...) each, and the derivatives (..., 2, 2): rows are distorted
        x and y, columns ideal x and y.
    """
    r = np.hypot(x, y)
    angle = np.arctan(r)
    radius, slope = _radius(k, angle)
    away = r > 0.0
    factor = np.where(away, radius / np.where(away, r, 1.0), 1.0)
    return (x * factor, y * factor), radial_partials(x, y, factor, slope / (1.0 + r * r))


def radial_partials(x: Floats, y: Floats, factor: Floats, slope: Floats) -> Floats:
    """Derivatives of the point (x, y) times a radial factor, with respect to x and y, (..., 2, 2).

    Args:
        x: ideal, (...)
        y: ideal, (...)
        factor: distorted radius over ideal radius, (...)
        slope: derivative of the distorted radius by the ideal radius, (...)
    """
    r2 = x * x + y * y
    more = np.where(r2 > 0.0, (slope - factor) / np.where(r2 > 0.0, r2, 1.0), 0.0)
    rows = [[factor + more * x * x, more * x * y], [more * x * y, factor + more * y * y]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def undistort(k: Floats, xd: Floats, yd: Floats) -> tuple[Floats, Floats]:
    """Remove the distortion of points by Newton's method on the angle from the axis.

    Args:
        k: the coefficients, (4,)
        xd: distorted, in the plane at unit distance, (...)
        yd: distorted, (...)

    Returns:
        The ideal x and y, (...) each; NaN where the model has no ideal point in its field.
    """
    limit = _angle_limit(k)
    nodes = np.linspace(0.0, min(limit, np.pi / 2), 1025)
    rd = np.hypot(xd, yd)
    angle = np.interp(rd, _radius(k, nodes)[0], nodes)
    for _ in range(ROUNDS):
        radius, slope = _radius(k, angle)
        step = (rd - radius) / slope
        angle = angle + step
        if not (np.abs(step) > 1e-16 * (1.0 + angle)).any():
            break
    good = (np.abs(_radius(k, angle)[0] - rd) <= 1e-12) & (angle <= limit) & (angle < np.pi / 2)
    factor = np.where(rd > 0.0, np.tan(angle) / np.where(rd > 0.0, rd, 1.0), 1.0)
    return np.where(good, xd * factor, np.nan), np.where(good, yd * factor, np.nan)


def field_radius(k: Floats) -> float:
    """The largest ideal radius for which the model can be inverted: the tangent of an angle.

    At that angle from the axis the image's radius stops growing; infinite from 90 degrees on.

    Args:
        k: the coefficients, (4,)
    """
    limit = _angle_limit(k)
    return float(np.tan(limit)) if limit < np.pi / 2 else float("inf")


def _radius(k: Floats, angle: Floats) -> tuple[Floats, Floats]:
    """The image's radius and its derivative by the angle."""
    t2 = angle * angle
    radius = angle * polynomial.polyval(t2, [1.0, *k])
    return np.asarray(radius), np.asarray(polynomial.polyval(t2, _growth(k)))


def _growth(k: Floats) -> Floats:
    return np.array([1.0, 3.0 * k[0], 5.0 * k[1], 7.0 * k[2], 9.0 * k[3]])


def _angle_limit(k: Floats) -> float:
    roots = polynomial.polyroots(polynomial.polytrim(_growth(k)))
    real = roots.real[(np.abs(roots.imag) <= 1e-9 * np.abs(roots)) & (roots.real > 0.0)]
    return float(np.sqrt(real.min())) if len(real) else float("inf")
