"""Where to start a solve without a first estimate: from two landmarks of each frame (Rae 1987)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.camera_axes import camera_angles_deg
from vopd.geometry.lens import radial_factor
from vopd.results import Results
from vopd.stellar.methods.closed_form import closed_form
from vopd.stellar.star_field import StarField


def closed_form_start(results: Results) -> Floats:
    """Camera yaw, pitch, roll, (F, 3) degrees, of every frame from its widest pair of landmarks.

    The landmarks' direction cosines and film coordinates are used, not the angles.
    A frame without two landmarks keeps group 8's first estimate.

    Args:
        results: a job whose landmarks and film coordinates are known
    """
    used = results.used
    away = results.point_mm - results.centre_mm[:, None]
    free = away * radial_factor(results.radius_mm, results.distortion_mm)[..., None]
    # VOPD's image is the one before the lens, x y +c; Rae's lies behind it, x y -f.
    # Half a turn about x takes one into the other.
    image = np.where(used[..., None], free * [1.0, -1.0], 0.0)
    directions = np.where(used[..., None], results.direction, [0.0, 0.0, 1.0])
    field = StarField.of(directions, image, results.focal_length_mm, used)
    matrix = closed_form(field) * np.array([[1.0], [-1.0], [-1.0]])
    angles = camera_angles_deg(matrix)
    unknown = np.isnan(angles).any(axis=1, keepdims=True)
    return np.where(unknown, results.job.camera.initial_deg, angles)
