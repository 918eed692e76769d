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
from vopd.attitude.rotation_fit import Sights, fit_rotations
from vopd.estimate import Estimate
from vopd.geometry.camera_axes import ahead, camera_axes
from vopd.geometry.linear_algebra import eigenvectors

PASSES = 20
SETTLED = 1e-5  # radians: the residuals are least there, and change by the square of it


@np.errstate(all="ignore")
def second_solution_rms(estimate: Estimate) -> Floats:
    """Root mean square of the second solutions' residuals, image units (F,); NaN where none is.

    Args:
        estimate: the frames
    """
    e = estimate
    known = e.solved & (e.used.sum(axis=1) >= 2)
    kept = e.used[..., None] & known[:, None, None]
    directions = np.where(kept, e.direction, 0.0)
    normal = eigenvectors(directions.swapaxes(1, 2) @ directions)[:, :, 0]
    mirror = np.eye(3) - 2.0 * normal[:, :, None] * normal[:, None, :]
    first = camera_axes(np.radians(e.camera_deg))
    sights = Sights(directions, e.image, e.used, e.focal_length)
    axes, turn = fit_rotations(sights, -first @ mirror, PASSES, SETTLED)
    residual, _ = sights.equations(axes)
    rms = np.sqrt((residual**2).sum(axis=1) / (2.0 * e.used.sum(axis=1)))
    other_side = (ahead(axes, directions) < 0.0) != (ahead(first, directions) < 0.0)
    found = known & (other_side | ~e.used).all(axis=1) & (np.abs(turn).max(axis=1) < 1e-3)
    return np.asarray(np.where(found, rms, np.nan))
