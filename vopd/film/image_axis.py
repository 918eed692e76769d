"""The 1974 solve keeps x and y, landmark, frame; an estimate keeps frame, then 2L coordinates."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats


def flat(pairs: Floats) -> Floats:
    """Image coordinates (2, L, F) as the solve has them to (F, 2L)."""
    return np.moveaxis(pairs, -1, 0).reshape(pairs.shape[-1], -1)


def columns(partials: Floats) -> Floats:
    """Partials (2, 3, L, F) as the solve has them to (F, 2L, 3)."""
    return np.moveaxis(partials, (3, 0, 2, 1), (0, 1, 2, 3)).reshape(partials.shape[3], -1, 3)
