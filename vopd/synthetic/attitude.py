"""How the camera swings below the parachute."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.synthetic.flight import FIRST_TIME_S
from vopd.synthetic.plan import Part, Plan, stream

AMPLITUDE = np.array([1.0, 0.6, 0.8])  # of yaw, pitch, roll, over `swing_deg`


class Attitude(NamedTuple):
    """Group 8's first estimate (3,) and the camera's true angles (F, 3), degrees."""

    estimate_deg: Floats
    camera_deg: Floats  # yaw 0..360, pitch, roll 0..360


def attitude(plan: Plan, time_s: Floats) -> Attitude:
    """Yaw, pitch, roll of the camera at `time_s` (F,): each a slow sine and a fast one.

    Together they make it cone. Yaw starts a little west of north and turns east
    through 360 degrees, so the film soon has frames whose yaw lies in 0 to 6.28
    degrees: these hand it on to the next frame as its start, the others do not.
    The estimate is the mean, in whole degrees.
    """
    random = stream(plan, Part.ATTITUDE)
    mean = random.uniform([353.0, -56.0, 275.0], [359.0, -48.0, 290.0])
    slow = 2.0 * np.pi / random.uniform(5.0, 9.0, 3)
    fast = slow * random.uniform(2.2, 2.8, 3)
    share = random.uniform(0.15, 0.3, 3)
    phase = np.array([0.0, 1.5, 3.0]) + random.uniform(-0.2, 0.2, (2, 3))
    flown = (time_s - FIRST_TIME_S)[:, None]
    swing = (1.0 - share) * np.sin(slow * flown + phase[0])
    swing += share * np.sin(fast * flown + phase[1])
    camera = mean + plan.swing_deg * AMPLITUDE * swing
    camera[:, [0, 2]] %= 360.0
    return Attitude(np.round(mean), camera)
