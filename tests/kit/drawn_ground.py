"""Ground that is known between its pixels, and a camera that looks down on it from the equator."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.lenses import Lens, LensKind

EARTH_M = 6378137.0
SIZE = (201, 161)
LENS = Lens(LensKind.BROWN, SIZE, np.full(2, 1000.0), np.array([100.0, 80.0]), np.zeros(12))
NADIR = np.diag([1.0, -1.0, -1.0])  # right is east, the top of the picture north


def drawn(u: Floats, v: Floats) -> Floats:
    """A picture without edges."""
    waves = np.sin(0.31 * u + 0.11 * v) + np.sin(0.17 * v - 0.07 * u) + np.cos(0.4 * v + 0.3 * u)
    return np.asarray(120.0 + 25.0 * waves)
