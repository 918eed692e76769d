"""The attitude to start the solve from: the rotation that carries directions nearest to rays."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.geometry.nearest_rotation import nearest_rotation

UNDETERMINED = 1e-10  # of the sum of weights: the turn about one direction is not held


class FirstAttitude(NamedTuple):
    """A rotation for each of B frames, and whether the directions determine it."""

    rotation: Floats  # (B, 3, 3) from local axes to camera axes
    determined: Bools  # (B,)


def first_attitude(ray: Floats, direction: Floats, weight: Floats) -> FirstAttitude:
    """Wahba's problem by singular values: no estimate is needed.

    With B the sum of weight ray direction', B = U S V', the rotation that makes the
    sum of weight ``|ray - R direction|^2`` least is U diag(1, 1, det U det V) V'. Where
    the second singular value and the signed third cancel, every turn about one
    direction fits alike: all landmarks lie on one line through the camera.

    Args:
        ray: unit vectors in camera axes, (B, n, 3)
        direction: unit vectors in local axes, (B, n, 3)
        weight: of each, 0 for one that takes no part, (B, n)
    """
    known = np.asarray(np.isfinite(np.concatenate([ray, direction], axis=2)).all(axis=2))
    w = np.where(known, weight, 0.0)
    total = w.sum(axis=1)
    w = w / np.where(total > 0.0, total, 1.0)[:, None]
    rays = np.where(known[..., None], ray, 0.0)
    directions = np.where(known[..., None], direction, 0.0)
    nearest = nearest_rotation(np.einsum("bni,bn,bnj->bij", rays, w, directions))
    return FirstAttitude(nearest.rotation, nearest.second > UNDETERMINED)
