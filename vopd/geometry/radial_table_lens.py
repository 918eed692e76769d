"""Lens distortion as a table of measured radii and the radii of a perfect lens.

Between the rows the two are interpolated linearly, so neither direction needs
iteration. Beyond the last row the lens is not known.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.fisheye_lens import radial_partials


def distort(table: Floats, x: Floats, y: Floats) -> tuple[tuple[Floats, Floats], Floats]:
    """Distort ideal points, and give the derivatives of the result with respect to the ideal point.

    Args:
        table: measured and ideal radius, (n, 2), both growing from 0
        x: ideal, in the plane at unit distance, (...)
        y: ideal, (...)

    Returns:
        The distorted x and y, (...) each, and the derivatives (..., 2, 2): rows are distorted
        x and y, columns ideal x and y.
    """
    measured, ideal = table.T
    r = np.hypot(x, y)
    interval = np.clip(np.searchsorted(ideal, r, side="right") - 1, 0, len(ideal) - 2)
    slope = (np.diff(measured) / np.diff(ideal))[interval]
    radius = measured[interval] + slope * (r - ideal[interval])
    factor = np.where(r > 0.0, radius / np.where(r > 0.0, r, 1.0), slope)
    return (x * factor, y * factor), radial_partials(x, y, factor, slope)


def undistort(table: Floats, xd: Floats, yd: Floats) -> tuple[Floats, Floats]:
    """Remove the distortion of points.

    Args:
        table: measured and ideal radius, (n, 2), both growing from 0
        xd: distorted, in the plane at unit distance, (...)
        yd: distorted, (...)

    Returns:
        The ideal x and y, (...) each; NaN where the point is beyond the last row.
    """
    measured, ideal = table.T
    rd = np.hypot(xd, yd)
    radius = np.interp(rd, measured, ideal, right=np.nan)
    first = ideal[1] / measured[1]
    factor = np.where(rd > 0.0, radius / np.where(rd > 0.0, rd, 1.0), first)
    return xd * factor, yd * factor


def field_radius(table: Floats) -> float:
    """The largest ideal radius of the table.

    Args:
        table: measured and ideal radius, (n, 2), both growing from 0
    """
    return float(table[-1, 1])
