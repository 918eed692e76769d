"""How a camera is mounted in a vehicle: rotations from camera axes to body axes.

Camera axes: x right, y down, z forward. Body axes: x forward, y right, z down.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Floats

FORWARD = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""The camera looks forward, its picture upright."""

DOWN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""The camera looks down, the top of its picture forward."""


def mount_by_angles(yaw_pitch_roll_deg: ArrayLike) -> Floats:
    """The mount of a camera turned from FORWARD by yaw, pitch and roll, (3, 3).

    Args:
        yaw_pitch_roll_deg: about down, the new right and the new forward axis, (3,), degrees
    """
    y, p, r = np.radians(yaw_pitch_roll_deg)
    yaw = np.array([[np.cos(y), -np.sin(y), 0.0], [np.sin(y), np.cos(y), 0.0], [0.0, 0.0, 1.0]])
    pitch = np.array([[np.cos(p), 0.0, np.sin(p)], [0.0, 1.0, 0.0], [-np.sin(p), 0.0, np.cos(p)]])
    roll = np.array([[1.0, 0.0, 0.0], [0.0, np.cos(r), -np.sin(r)], [0.0, np.sin(r), np.cos(r)]])
    return np.asarray(yaw @ pitch @ roll @ FORWARD)
