"""The film read: three readings of four corners and of every landmark, to a thousandth."""

from __future__ import annotations

import numpy as np

from vopd.demo.plan import Part, Plan, stream
from vopd.job import Floats, Ints, Readings

CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])  # over the frame's size


def readings(plan: Plan, frame: Ints, landmark: Ints, image_in: Floats, time: int) -> Readings:
    """What the reader punches of images (F, L, 2) in inches, the `time`th time that it is used."""
    random = stream(plan, Part.FILM, time)

    def read(point: Floats) -> Floats:
        three = np.repeat(point[:, :, None], 3, axis=2)
        noisy = three + plan.noise_in * random.standard_normal(three.shape)
        return np.asarray(np.round(noisy * 1000.0) / 1000.0 + 0.0)  # no minus zero

    corners = np.broadcast_to(CORNERS * plan.frame_in, (len(frame), 4, 2))
    return Readings(
        frame=frame,
        fiducial_in=read(corners),
        landmark=landmark,
        present=np.ones(landmark.shape, bool),
        landmark_in=read(image_in),
    )
