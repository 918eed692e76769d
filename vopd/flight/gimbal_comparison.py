"""The gimbal's angles beside the solved ones; they are never used in a solve."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats


def gimbal_sentence(camera_deg: Floats, gimbal_deg: Floats) -> str:
    """How far the solved angles are from those of the gimbal, in a sentence.

    Args:
        camera_deg: solved yaw, pitch, roll, (F, 3)
        gimbal_deg: those of the gimbal, (F, 3); NaN where not known
    """
    off = (camera_deg - gimbal_deg + 180.0) % 360.0 - 180.0
    off = off[np.isfinite(off).all(axis=1)]
    if not len(off):
        return "in the images' tags, and no frame with an attitude has them"
    middle = np.median(off, axis=0)
    parts = ", ".join(
        f"{name} {value:+.2f} ({low:+.2f} to {high:+.2f})"
        for name, value, low, high in zip(
            ("yaw", "pitch", "roll"), middle, off.min(axis=0), off.max(axis=0), strict=True
        )
    )
    count = f"{len(off)} frame{'s'[: len(off) != 1]}"
    return f"not used; solved less gimbal, degrees, median of {count} and range: {parts}"
