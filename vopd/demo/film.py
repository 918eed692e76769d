"""The film read: three readings of four corners and of every landmark, to a thousandth."""

from __future__ import annotations

import numpy as np

from vopd.demo.plan import FILM, Plan
from vopd.job import Floats, Ints, Readings

CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def readings(plan: Plan, frame: Ints, landmark: Ints, image_in: Floats, roll: int) -> Readings:
    """What the film reader punches of images (F, L, 2); `roll` counts the times it is read."""
    random = plan.random(FILM + roll)
    count, per_frame = landmark.shape
    fiducial = np.tile((CORNERS * plan.frame_in)[:, None], (count, 1, 3, 1))
    fiducial = fiducial.reshape(count, 4, 3, 2)
    point = np.repeat(image_in[:, :, None], 3, axis=2)
    return Readings(
        frame=frame,
        fiducial_in=_thousandths(fiducial, plan, random),
        landmark=landmark,
        present=np.ones((count, per_frame), bool),
        landmark_in=_thousandths(point, plan, random),
    )


def _thousandths(where: Floats, plan: Plan, random: np.random.Generator) -> Floats:
    noisy = where + plan.noise_in * random.standard_normal(where.shape)
    return np.asarray(np.round(noisy * 1000.0) / 1000.0 + 0.0)  # no minus zero
