"""Rearrange arrays of the 1974 solve into the axes of an estimate.

The solve has x and y first, then landmark, then frame; an estimate has the frame
first, then 2L coordinates: x of every landmark, then y of every landmark.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats


def flat(pairs: Floats) -> Floats:
    """Rearrange image coordinates to (F, 2L).

    Args:
        pairs: x and y as the solve has them, (2, L, F)
    """
    return np.moveaxis(pairs, -1, 0).reshape(pairs.shape[-1], -1)


def columns(partials: Floats) -> Floats:
    """Rearrange partial derivatives to (F, 2L, 3).

    Args:
        partials: by three angles, as the solve has them, (2, 3, L, F)
    """
    return np.moveaxis(partials, (3, 0, 2, 1), (0, 1, 2, 3)).reshape(partials.shape[3], -1, 3)
