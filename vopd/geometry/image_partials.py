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
    one = np.ones_like(x)
    by_turn = [[-x * y, one + x * x, -y], [-(one + y * y), x * y, x]]
    rows = np.stack([np.stack(row, axis=-1) for row in by_turn], axis=-2)
    return np.asarray(np.asarray(distance)[..., None, None] * rows)
