"""First estimates from two landmarks of each frame, in place of the deck's (Rae 1987)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.camera_axes import camera_angles_deg
from vopd.program.orient import FilmSight, Sight
from vopd.stellar.methods.closed_form import closed_form
from vopd.stellar.star_field import StarField

AT_A_TIME = 100_000  # landmarks


@np.errstate(all="ignore")
def closed_form_start(seen: FilmSight) -> Floats:
    """Estimate camera yaw, pitch, roll, (F, 3) degrees, from two landmarks far apart.

    In each frame the two that are farthest apart are used. The estimate is NaN for a frame
    without two landmarks, or whose focal length is not positive.

    Args:
        seen: the input of the solve
    """
    angles = np.full((len(seen.cc), 3), np.nan)
    for frames in seen.alike(np.flatnonzero(seen.nj >= 2), AT_A_TIME):
        angles[frames] = _closed_form(seen.of(frames))
    return angles


def _closed_form(seen: Sight) -> Floats:
    """Camera yaw, pitch, roll of some frames (F, 3), degrees; NaN where there is none."""
    possible = seen.cc > 0.0
    used = seen.used.T
    # VOPD's image is the one before the lens, x y +c; Rae's lies behind it, x y -f.
    # Half a turn about x takes one into the other.
    image = np.where(used[..., None], np.stack([seen.x.T, -seen.y.T], axis=-1), 0.0)
    direction = np.stack([part.T for part in seen.dircos], axis=-1)
    directions = np.where(used[..., None], direction, [0.0, 0.0, 1.0])
    field = StarField.of(directions, image, np.where(possible, seen.cc, 1.0), used)
    matrix = closed_form(field) * np.array([[1.0], [-1.0], [-1.0]])
    return np.where(possible[:, None], camera_angles_deg(matrix), np.nan)
