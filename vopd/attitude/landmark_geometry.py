"""How well the landmarks hold the camera about each of its axes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.attitude.solution import Solution

AXES = ("image x axis", "image y axis", "optical axis")


class Geometry(NamedTuple):
    """F frames: condition number, weakest axis, and landmarks' side of the camera.

    `condition` is the ratio of the largest to the smallest singular value of the
    film coordinates' partials by small turns about the camera's own three axes,
    which has no trouble with yaw and roll where the camera looks straight down.
    `weak_axis` is the place in `AXES` of what is nearest to the weakest turn.
    `ahead` (F, L) is the cosine between the optical axis and each landmark.
    """

    condition: Floats
    weak_axis: Ints
    ahead: Floats


@np.errstate(all="ignore")
def geometry(solved: Solution) -> Geometry:
    """The geometry of every frame; NaN, and axis 0, where there is no solution."""
    turns = solved.partials @ turns_to_angles(solved.radians)
    known = np.asarray(np.isfinite(turns).all(axis=(1, 2)))
    rows = np.where(known[:, None, None], turns, 0.0)
    room = np.zeros((len(rows), 1, 3))  # one landmark has two rows, and three sizes are asked for
    _, sizes, axes = np.linalg.svd(np.concatenate([rows, room], axis=1), full_matrices=False)
    condition = np.where(known, sizes[:, 0] / sizes[:, 2], np.nan)
    axis = (image_axes(solved.radians)[:, 2, None] * solved.results.direction).sum(axis=2)
    return Geometry(condition, np.abs(axes[:, 2]).argmax(axis=1), axis)


def image_axes(radians: Floats) -> Floats:
    """Rows of M (F, 3, 3): the image axes in object space, east, north, up (Appendix A)."""
    (s1, s2, s3), (c1, c2, c3) = np.sin(radians).T, np.cos(radians).T
    x = np.stack([-c1 * c3 - s1 * s2 * s3, s1 * c3 - c1 * s2 * s3, c2 * s3], axis=-1)
    y = np.stack([c1 * s3 - s1 * s2 * c3, -s1 * s3 - c1 * s2 * c3, c2 * c3], axis=-1)
    z = np.stack([s1 * c2, c1 * c2, s2], axis=-1)
    return np.stack([x, y, z], axis=-2)


def turns_to_angles(radians: Floats) -> Floats:
    """Rates of yaw, pitch, roll by turns about the image axes X, Y, Z: (F, 3, 3).

    Yaw turns about down, pitch about the level axis and roll about the optical
    axis; at a pitch of 90 degrees there is no answer, and the numbers grow.
    """
    (_, s2, s3), (_, c2, c3) = np.sin(radians).T, np.cos(radians).T
    nothing, one = np.zeros_like(s2), np.ones_like(s2)
    yaw = np.stack([-c2 * s3, -c2 * c3, -s2], axis=-1)
    pitch = np.stack([-c3, s3, nothing], axis=-1)
    roll = np.stack([nothing, nothing, one], axis=-1)
    rates = np.stack([yaw, pitch, roll], axis=-1)
    known = np.isfinite(rates).all(axis=(1, 2), keepdims=True)
    return np.asarray(np.where(known, np.linalg.pinv(np.where(known, rates, 0.0)), np.nan))
