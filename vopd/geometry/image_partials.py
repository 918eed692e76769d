"""Derivatives of image coordinates with respect to small rotations of the directions seen."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Floats


def partials_by_turns(x: Floats, y: Floats, distance: ArrayLike) -> Floats:
    """Derivatives of image x and y with respect to small right-handed rotations of the direction.

    The image of a direction p, q, r in camera axes is distance * (p/r, q/r). Turning
    the camera instead of the direction changes the sign.

    Args:
        x: p/r, (...)
        y: q/r, (...)
        distance: principal distance in image units, broadcast to (...); negative
            where the image lies behind the lens

    Returns:
        (..., 2, 3): image x and y, by turns in radians about the camera's x, y, z axes
    """
    rows = np.empty((*np.shape(x), 2, 3))
    rows[..., 0, 0], rows[..., 0, 1], rows[..., 0, 2] = -x * y, 1.0 + x * x, -y
    rows[..., 1, 0], rows[..., 1, 1], rows[..., 1, 2] = -(1.0 + y * y), x * y, x
    return np.asarray(np.asarray(distance)[..., None, None] * rows)
