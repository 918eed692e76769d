"""Where to start a solve without an estimate: the two-landmark closed form of Rae (1987)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.results import Results
from vopd.stellar.methods.closed_form import closed_form
from vopd.stellar.star_field import StarField


def closed_form_start(results: Results) -> Floats:
    """Camera yaw, pitch, roll (F, 3) degrees of every frame from its widest pair of landmarks.

    The landmarks' direction cosines and film coordinates of `results` are used,
    not its angles. A frame without two landmarks keeps group 8's estimate.
    """
    used = results.used
    away = results.point_mm - results.centre_mm[:, None]
    with np.errstate(invalid="ignore", divide="ignore"):
        distr = np.where(
            results.radius_mm == 0, 1.0, 1.0 - results.distortion_mm / results.radius_mm
        )
    free = away * distr[..., None]
    # VOPD's image is the one before the lens, x y +c; Rae's lies behind it, x y -f.
    # Half a turn about x takes one into the other.
    image = np.where(used[..., None], free * [1.0, -1.0], 0.0)
    directions = np.where(used[..., None], results.direction, [0.0, 0.0, 1.0])
    field = StarField.of(directions, image, results.focal_length_mm, used)
    matrix = closed_form(field) * np.array([[1.0], [-1.0], [-1.0]])
    angles = euler_deg(matrix)
    unknown = np.isnan(angles).any(axis=1, keepdims=True)
    return np.where(unknown, results.job.camera.initial_deg, angles)


def euler_deg(matrix: Floats) -> Floats:
    """Yaw 0..360, pitch -90..90, roll 0..360 (..., 3) of camera matrices (Appendix A).

    Where the camera looks straight up or down only yaw and roll together are
    defined: roll is 0 there.
    """
    pitch = np.arcsin(np.clip(matrix[..., 2, 2], -1.0, 1.0))
    level = np.hypot(matrix[..., 2, 0], matrix[..., 2, 1]) > 1e-12
    yaw = np.where(
        level,
        np.arctan2(matrix[..., 2, 0], matrix[..., 2, 1]),
        np.arctan2(matrix[..., 0, 1], -matrix[..., 0, 0]),
    )
    roll = np.where(level, np.arctan2(matrix[..., 0, 2], matrix[..., 1, 2]), 0.0)
    angles = np.stack([yaw % (2 * np.pi), pitch, roll % (2 * np.pi)], axis=-1)
    return np.asarray(np.degrees(angles))
