"""The attitude of a synthetic camera, which swings and cones below the parachute."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.synthetic.flight import FIRST_TIME_S
from vopd.synthetic.plan import Plan, RandomPart, random_stream

AMPLITUDE = np.array([1.0, 0.6, 0.8])  # of yaw, pitch, roll, in units of `swing_deg`


class CameraSwing(NamedTuple):
    """The camera's angles over a flight.

    Attributes:
        estimate_deg: first estimate of yaw, pitch, roll for group 8, degrees (3,)
        camera_deg: true yaw 0 to 360, pitch, roll 0 to 360, degrees (F, 3)
    """

    estimate_deg: Floats
    camera_deg: Floats


def camera_swing(plan: Plan, time_s: Floats) -> CameraSwing:
    """Yaw, pitch and roll of the camera over time: a slow and a fast sine about a mean for each.

    Together they make the camera cone. Yaw starts a little west of north and
    turns east through 360 degrees, so the film soon has frames whose yaw is 0 to
    6.28 degrees: the next frame starts from these, and from no others. The first
    estimate is the mean, in whole degrees.

    Args:
        plan: the flight
        time_s: times of the frames, s (F,)
    """
    random = random_stream(plan, RandomPart.ATTITUDE)
    mean = random.uniform([353.0, -56.0, 275.0], [359.0, -48.0, 290.0])
    slow = 2.0 * np.pi / random.uniform(5.0, 9.0, 3)
    fast = slow * random.uniform(2.2, 2.8, 3)
    fast_part = random.uniform(0.15, 0.3, 3)
    phase = np.array([0.0, 1.5, 3.0]) + random.uniform(-0.2, 0.2, (2, 3))
    flown = (time_s - FIRST_TIME_S)[:, None]
    swing = (1.0 - fast_part) * np.sin(slow * flown + phase[0])
    swing += fast_part * np.sin(fast * flown + phase[1])
    camera = mean + plan.swing_deg * AMPLITUDE * swing
    camera[:, [0, 2]] %= 360.0
    return CameraSwing(np.round(mean), camera)
