"""Frames whose angles the errata of the original program change by more than one sigma."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.uncertainty import ANGLES
from vopd.estimate import Estimate

TESTED = (3, 4, 5, 0, 1, 2)  # indices in ANGLES: the vehicle's angles, then the camera's
MODEL_ERROR = (
    "correcting all errata of the original program changes an angle of vehicle or camera by more "
    "than its standard deviation, which does not include them; the angle is named",
    "correct the errata: --fix all",
)
"""What the flag means, and what to do."""


@np.errstate(all="ignore")
def model_error(estimate: Estimate, sigma_deg: Floats) -> tuple[Bools, list[str]]:
    """Find the frames whose errata exceed one standard deviation, and the worst angle of each.

    Args:
        estimate: the job
        sigma_deg: standard deviations of the nine angles, (F, 9)

    Returns:
        The frames (F,), and for each frame the name of the angle of vehicle or camera
        whose error is the most standard deviations.
    """
    frames = len(estimate.frame)
    if estimate.slip_effect_deg is None:
        return np.zeros(frames, bool), [""] * frames
    effect, sigma = np.abs(estimate.slip_effect_deg[:, TESTED]), sigma_deg[:, TESTED]
    times = np.where(effect > sigma, effect / sigma, 0.0)
    worst = times.round(6).argmax(axis=1)  # of two alike but for rounding, the first
    return np.asarray((times > 0.0).any(axis=1)), [ANGLES[TESTED[k]] for k in worst]
