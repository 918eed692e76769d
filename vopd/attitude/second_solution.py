"""Find the second attitude that fits the same image, with the landmarks behind the camera.

The collinearity equations do not tell front from back. If all landmarks lay in
one plane through the camera, the attitude mirrored at that plane and turned to
look the other way would show the same image. Where they nearly do, there is a
second attitude with small residuals, and from a poor first estimate the solve
may end there.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Estimate
from vopd.geometry.camera_axes import ahead, camera_axes
from vopd.geometry.image_partials import partials_by_turns
from vopd.geometry.linear_algebra import eigenvectors, inverse, pseudo_inverse

ROUNDS = 20


@np.errstate(all="ignore")
def second_solution_rms(estimate: Estimate) -> Floats:
    """Root mean square of the second solution's residuals, image units (F,).

    NaN where there is none.

    Args:
        estimate: the job
    """
    known = estimate.solved & (estimate.used.sum(axis=1) >= 2)
    kept = estimate.used[..., None] & known[:, None, None]
    directions = np.where(kept, estimate.direction, 0.0)
    normal = eigenvectors(directions.swapaxes(1, 2) @ directions)[:, :, 0]
    mirror = np.eye(3) - 2.0 * normal[:, :, None] * normal[:, None, :]
    first = camera_axes(np.radians(estimate.camera_deg))
    axes = -first @ mirror
    for _ in range(ROUNDS):
        residual, partials = _equations(axes, directions, estimate)
        turn = (pseudo_inverse(partials) @ residual[..., None])[..., 0]
        axes = _turned(axes, np.where(np.isfinite(turn), turn, 0.0))
    residual, _ = _equations(axes, directions, estimate)
    rms = np.sqrt((residual**2).sum(axis=1) / (2.0 * estimate.used.sum(axis=1)))
    other_side = (ahead(axes, directions) < 0.0) != (ahead(first, directions) < 0.0)
    found = known & (other_side | ~estimate.used).all(axis=1) & (np.abs(turn).max(axis=1) < 1e-3)
    return np.asarray(np.where(found, rms, np.nan))


def _equations(axes: Floats, directions: Floats, estimate: Estimate) -> tuple[Floats, Floats]:
    """Residuals (F, 2L) and partials (F, 2L, 3) by small turns about the camera's axes."""
    used = estimate.used
    p, q, r = np.moveaxis(directions @ axes.swapaxes(1, 2), -1, 0)
    x, y = (np.where(used, part / r, 0.0) for part in (p, q))
    measured = np.where(used[..., None], estimate.image, 0.0)
    residual = measured - estimate.focal_length * np.stack([x, y], axis=-1)
    partials = -partials_by_turns(x, y, estimate.focal_length) * used[..., None, None]
    coordinates = (len(used), -1)
    return (
        np.moveaxis(residual, -1, 1).reshape(coordinates),
        np.moveaxis(partials, -2, 1).reshape(*coordinates, 3),
    )


def _turned(axes: Floats, turn: Floats) -> Floats:
    """Axes turned about themselves by small angles, kept orthogonal (Cayley)."""
    skew = np.zeros((*turn.shape, 3))
    for one, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
        skew[:, i, j], skew[:, j, i] = turn[:, one] / 2.0, -turn[:, one] / 2.0
    return np.asarray(inverse(np.eye(3) - skew) @ (np.eye(3) + skew) @ axes)
