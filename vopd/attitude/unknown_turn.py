"""Name what is not known of frames whose landmarks do not determine the attitude.

One landmark, or several on one line from the camera, determine two of the three angles
of a rotation: all but the turn about that line. The solve then ends at one of the
attitudes that show the landmark where it was read, and every other one follows from
it by a turn about the line.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools
from vopd.estimate import Estimate

PARALLEL = 1e-7  # radians between lines of sight that count as one
POLE = 1e-6  # cosine of a pitch at which yaw and roll turn about the same axis


@np.errstate(all="ignore")
def unknown_turns(estimate: Estimate, undetermined: Bools) -> list[str]:
    """What each undetermined frame leaves open; every other part of its attitude is known.

    Args:
        estimate: the job
        undetermined: the frames concerned, (F,)

    Returns:
        For each frame concerned, such as `turn_about_landmark_65_azimuth_213.33_elevation_-52.38`,
        the direction of the line being that in local axes; `yaw_and_roll_apart` where the
        camera looks straight up or down; or `all_angles`. Empty for the other frames.
    """
    used = estimate.used & np.isfinite(estimate.direction).all(axis=2)
    directions = np.where(used[..., None], estimate.direction, 0.0)
    line = directions.sum(axis=1)
    line /= np.linalg.norm(line, axis=1, keepdims=True)
    aside = np.linalg.norm(np.cross(directions, line[:, None]), axis=2).max(axis=1, initial=0.0)
    straight = np.abs(np.cos(np.radians(estimate.camera_deg[:, 1]))) < POLE
    straight &= used.any(axis=1)
    found = [""] * len(used)
    for k in np.flatnonzero(undetermined):
        if aside[k] < PARALLEL:
            numbers = dict.fromkeys(estimate.landmark[k][used[k]].tolist())
            names = "+".join(estimate.landmark_label(n).replace(";", ",") for n in numbers)
            east, north, up = line[k]
            azimuth = round(float(np.degrees(np.arctan2(east, north))) % 360.0, 2) % 360.0
            elevation = float(np.degrees(np.arcsin(np.clip(up, -1.0, 1.0))))
            where = f"azimuth_{azimuth:.2f}_elevation_{elevation:.2f}"
            found[k] = f"turn_about_landmark_{names}_{where}"
        else:
            found[k] = "yaw_and_roll_apart" if straight[k] else "all_angles"
    return found
