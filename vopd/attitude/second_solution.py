"""The other solution: the collinearity equations do not tell front from back.

If all landmarks lay in one plane through the camera, the attitude mirrored at
that plane and turned to look the other way would show the same image. Where
they nearly do, there is a second attitude with small residuals, its landmarks
behind the camera, and from a poor first estimate the solve may end there.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.landmark_geometry import image_axes
from vopd.attitude.solution import Solution

ROUNDS = 20


@np.errstate(all="ignore")
def second_rms_mm(solved: Solution) -> Floats:
    """Root mean square of the second solution's residuals, mm (F,); NaN where there is none."""
    results = solved.results
    known = results.solved & (solved.used.sum(axis=1) >= 2)
    directions = np.where(solved.used[..., None] & known[:, None, None], results.direction, 0.0)
    normal = np.linalg.eigh(directions.swapaxes(1, 2) @ directions)[1][:, :, 0]
    mirror = np.eye(3) - 2.0 * normal[:, :, None] * normal[:, None, :]
    axes = -image_axes(solved.radians) @ mirror
    measured = _measured(solved)
    for _ in range(ROUNDS):
        residual, partials = _equations(axes, directions, measured, solved)
        finite = np.isfinite(partials).all(axis=(1, 2), keepdims=True)
        turn = (np.linalg.pinv(np.where(finite, partials, 0.0)) @ residual[..., None])[..., 0]
        axes = _turned(axes, np.where(np.isfinite(turn), turn, 0.0))
    residual, _ = _equations(axes, directions, measured, solved)
    rms = np.sqrt((residual**2).sum(axis=1) / (2.0 * solved.used.sum(axis=1)))
    behind = ((axes[:, 2, None] * directions).sum(axis=2) < 0.0) != _behind(solved, directions)
    other = (behind | ~solved.used).all(axis=1)
    return np.asarray(np.where(known & other & (np.abs(turn).max(axis=1) < 1e-3), rms, np.nan))


def _measured(solved: Solution) -> Floats:
    x, y = (np.where(solved.used.T, part, 0.0) for part in (solved.sight.x, solved.sight.y))
    return np.concatenate([x, y]).T


def _behind(solved: Solution, directions: Floats) -> Bools:
    axis = image_axes(solved.radians)[:, 2, None]
    return np.asarray((axis * directions).sum(axis=2) < 0.0)


def _equations(
    axes: Floats, directions: Floats, measured: Floats, solved: Solution
) -> tuple[Floats, Floats]:
    """Residuals (F, 2L) and partials (F, 2L, 3) by small turns about the image axes."""
    p, q, r = np.moveaxis(directions @ axes.swapaxes(1, 2), -1, 0)
    used, cc = solved.used, solved.sight.cc[:, None]
    x, y = (np.where(used, part / r, 0.0) for part in (p, q))
    one = used.astype(np.float64)
    computed = cc * np.concatenate([x, y], axis=1)
    by_x = np.stack([x * y, -(one + x * x), y], axis=-1)
    by_y = np.stack([one + y * y, -x * y, -x], axis=-1)
    return measured - computed, cc[..., None] * np.concatenate([by_x, by_y], axis=1)


def _turned(axes: Floats, turn: Floats) -> Floats:
    """Axes turned about themselves by small angles, kept orthogonal (Cayley)."""
    skew = np.zeros((*turn.shape, 3))
    for one, (i, j) in enumerate(((1, 2), (2, 0), (0, 1))):
        skew[:, i, j], skew[:, j, i] = turn[:, one] / 2.0, -turn[:, one] / 2.0
    return np.asarray(np.linalg.solve(np.eye(3) - skew, (np.eye(3) + skew) @ axes))
