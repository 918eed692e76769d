"""Find the second attitude that fits the same image, with the landmarks behind the camera.

The collinearity equations do not tell front from back. If all landmarks lay in
one plane through the camera, the attitude mirrored at that plane and turned to
look the other way would show the same image. Where they nearly do, there is a
second attitude with small residuals, and from a poor first estimate the solve
may end there.

Most frames need no search. Let R turn the unit vectors d of N landmarks to the front of the
camera, and the second attitude S to its back. The sum of the squared lengths of R d + S d is
at least four times the smallest eigenvalue of the sum of d d', which is at least
4 det / N squared. The residuals of both attitudes together are at least the
focal length times the root of that.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Estimate
from vopd.geometry.camera_axes import ahead, camera_axes
from vopd.geometry.linear import eigenvectors
from vopd.geometry.rotation_fit import Sights, fit_rotations

PASSES = 20
SETTLED = 1e-5  # radians: the residuals are least there, and change by the square of it
ROUNDING = 1e-12  # of the smallest eigenvalue, by the largest


@np.errstate(all="ignore")
def second_solution_rms(estimate: Estimate, at_most: Floats | float = np.inf) -> Floats:
    """Root mean square of the second solutions' residuals, image units (F,); NaN where none is.

    Args:
        estimate: the frames
        at_most: second solutions whose residuals are larger need not be found, (F,) or one
            for all frames
    """
    e = estimate
    known = e.solved & (e.used.sum(axis=1) >= 2)
    first = camera_axes(np.radians(e.camera_deg))
    directions = np.where(e.used[..., None] & known[:, None, None], e.direction, 0.0)
    sights = Sights(directions, e.image, e.used, e.focal_length)
    searched = known & ~(_least_rms(sights, first) > at_most)
    found = np.full(len(known), np.nan)
    found[searched] = _searched(sights.of(searched), first[searched])
    return found


def _least_rms(sights: Sights, first: Floats) -> Floats:
    """What the residuals of second solutions exceed, (F,); 0 where a landmark is behind already."""
    count = sights.used.sum(axis=1)
    product = sights.direction.swapaxes(1, 2) @ sights.direction
    smallest = 4.0 * np.linalg.det(product) / count**2 - ROUNDING * count
    both = sights.focal_length * np.sqrt(2.0 * np.maximum(smallest, 0.0) / count)
    in_front = ((ahead(first, sights.direction) > 0.0) | ~sights.used).all(axis=1)
    return np.where(in_front, both - _rms(sights, first), 0.0)


def _rms(sights: Sights, axes: Floats) -> Floats:
    residual, _ = sights.equations(axes)
    return np.asarray(np.sqrt((residual**2).sum(axis=1) / (2.0 * sights.used.sum(axis=1))))


def _searched(sights: Sights, first: Floats) -> Floats:
    """The residuals of second solutions, from the attitude mirrored at the landmarks' plane."""
    directions = sights.direction
    normal = eigenvectors(directions.swapaxes(1, 2) @ directions)[:, :, 0]
    mirror = np.eye(3) - 2.0 * normal[:, :, None] * normal[:, None, :]
    axes, turn = fit_rotations(sights, -first @ mirror, PASSES, SETTLED)
    other_side = (ahead(axes, directions) < 0.0) != (ahead(first, directions) < 0.0)
    found = (other_side | ~sights.used).all(axis=1) & (np.abs(turn).max(axis=1) < 1e-3)
    return np.where(found, _rms(sights, axes), np.nan)
