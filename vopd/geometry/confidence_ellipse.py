"""The ellipse in which a point of the plane lies with a given probability."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats


class ConfidenceEllipse(NamedTuple):
    """Ellipses about estimated points.

    `semi_axes` (..., 2) has the longer one first; `angle_rad` (...) is the direction of
    the longer one, from the second coordinate toward the first, 0 to pi.
    """

    semi_axes: Floats
    angle_rad: Floats


def confidence_ellipse(
    covariance: Floats, freedom: float | None = None, probability: float = 0.95
) -> ConfidenceEllipse:
    """Ellipses that contain the true point with a given probability.

    Args:
        covariance: of the two coordinates, (..., 2, 2)
        freedom: degrees of freedom from which its scale is estimated (F distribution);
            None: the scale is known (chi-square distribution)
        probability: of the ellipse
    """
    finite = np.asarray(np.isfinite(covariance).all(axis=(-2, -1), keepdims=True))
    sizes, axes = np.linalg.eigh(np.where(finite, covariance, 0.0))
    missed = 1.0 - probability
    square = -2.0 * np.log(missed)  # both distributions have closed forms for two coordinates
    if freedom is not None:
        square = freedom * (missed ** (-2.0 / freedom) - 1.0)
    semi_axes = np.sqrt(np.maximum(sizes[..., ::-1], 0.0) * square)
    angle = np.arctan2(axes[..., 0, 1], axes[..., 1, 1]) % np.pi
    known = finite[..., 0, 0]
    return ConfidenceEllipse(
        np.where(known[..., None], semi_axes, np.nan), np.where(known, angle, np.nan)
    )
