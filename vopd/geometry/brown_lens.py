"""Brown's lens distortion with a rational radial part, tangential and thin prism terms.

The twelve coefficients stand in OpenCV's order: k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4.
Coordinates are those of the plane at unit distance.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import polynomial

from vopd.arrays import Floats

ROUNDS = 60
SMALL = 1e-15


def distort(k: Floats, x: Floats, y: Floats) -> tuple[tuple[Floats, Floats], Floats]:
    """Distort ideal points, and give the derivatives of the result with respect to the ideal point.

    Args:
        k: the coefficients, (12,)
        x: ideal, in the plane at unit distance, (...)
        y: ideal, (...)

    Returns:
        The distorted x and y, (...) each, and the derivatives (..., 2, 2): rows are distorted
        x and y, columns ideal x and y.
    """
    k1, k2, p1, p2, k3, k4, k5, k6, s1, s2, s3, s4 = (float(value) for value in k)
    r2 = x * x + y * y
    n = ((k3 * r2 + k2) * r2 + k1) * r2 + 1.0
    d = ((k6 * r2 + k5) * r2 + k4) * r2 + 1.0
    factor = n / d
    n_slope = (3.0 * k3 * r2 + 2.0 * k2) * r2 + k1
    d_slope = (3.0 * k6 * r2 + 2.0 * k5) * r2 + k4
    slope = (n_slope - factor * d_slope) / d  # of the factor by r2
    prism_x, prism_y = s1 + 2.0 * s2 * r2, s3 + 2.0 * s4 * r2
    xd = x * factor + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) + s1 * r2 + s2 * r2 * r2
    yd = y * factor + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y + s3 * r2 + s4 * r2 * r2
    mixed = 2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y
    xx = factor + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x + 2.0 * x * prism_x
    yy = factor + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x + 2.0 * y * prism_y
    by = np.empty((*np.shape(xx), 2, 2))
    by[..., 0, 0], by[..., 0, 1] = xx, mixed + 2.0 * y * prism_x
    by[..., 1, 0], by[..., 1, 1] = mixed + 2.0 * x * prism_y, yy
    return (xd, yd), by


def undistort(k: Floats, xd: Floats, yd: Floats) -> tuple[Floats, Floats]:
    """Remove the distortion of points by Newton's method.

    It starts from the point that the radial part alone would give.

    Args:
        k: the coefficients, (12,)
        xd: distorted, in the plane at unit distance, (...)
        yd: distorted, (...)

    Returns:
        The ideal x and y, (...) each; NaN where the model has no ideal point in its field.
    """
    limit = field_radius(k)
    angle = np.linspace(0.0, min(np.arctan(limit), 1.55), 1025)
    over, under = _radial(k)
    r = np.tan(angle)
    grown = r * polynomial.polyval(r * r, over) / polynomial.polyval(r * r, under)
    moved = np.maximum.accumulate(grown)  # a field may end at a pole, where the sign is anything
    rd = np.hypot(xd, yd)
    start = np.tan(np.interp(rd, moved, angle))
    scale = np.where(rd > 0.0, start / np.where(rd > 0.0, rd, 1.0), 1.0)
    x, y = xd * scale, yd * scale
    for _ in range(ROUNDS):
        (xn, yn), by = distort(k, x, y)
        determinant = by[..., 0, 0] * by[..., 1, 1] - by[..., 0, 1] * by[..., 1, 0]
        ex, ey = xd - xn, yd - yn
        dx = (by[..., 1, 1] * ex - by[..., 0, 1] * ey) / determinant
        dy = (by[..., 0, 0] * ey - by[..., 1, 0] * ex) / determinant
        x, y = x + dx, y + dy
        size = np.abs(dx) + np.abs(dy)
        if not (size > SMALL * (1.0 + np.abs(x) + np.abs(y))).any():
            break
    (xn, yn), _ = distort(k, x, y)
    near = np.hypot(xn - xd, yn - yd) <= 1e-12 * (1.0 + rd)
    good = near & (np.hypot(x, y) <= limit) & (determinant > 0.0)
    return np.where(good, x, np.nan), np.where(good, y, np.nan)


def field_radius(k: Floats) -> float:
    """The largest ideal radius for which the model can be inverted.

    There the radial part stops growing; infinite if it never does.

    Args:
        k: the coefficients, (12,)
    """
    over, under = _radial(k)
    grown = polynomial.polyadd(over, 2.0 * polynomial.polymulx(polynomial.polyder(over)))
    shrunk = 2.0 * polynomial.polymulx(polynomial.polyder(under))
    growth = polynomial.polysub(polynomial.polymul(grown, under), polynomial.polymul(over, shrunk))
    roots = [polynomial.polyroots(polynomial.polytrim(p)) for p in (growth, under)]
    squares = np.concatenate(roots)
    real = squares.real[(np.abs(squares.imag) <= 1e-9 * np.abs(squares)) & (squares.real > 0.0)]
    return float(np.sqrt(real.min())) if len(real) else float("inf")


def _radial(k: Floats) -> tuple[Floats, Floats]:
    """Numerator and denominator of the radial factor as polynomials in r squared."""
    over = np.array([1.0, k[0], k[1], k[4]])
    under = np.array([1.0, k[5], k[6], k[7]])
    return over, under
