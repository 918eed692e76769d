"""OpenDroneMap's geo.txt: image, longitude, latitude, height, yaw, pitch, roll of the camera."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vopd.attitude.history import History
from vopd.export.file_request import FileRequest
from vopd.export.photogrammetry import camera_poses, some, source_text, yaw_pitch_roll_deg
from vopd.findings import Finding, Report

HEAD = """\
EPSG:4326
# {source}
# image x y z yaw pitch roll: x longitude, y latitude, degrees, z metres above the ellipsoid
# yaw, pitch, roll: of an aircraft whose camera looks down with the top of the picture forward,
# degrees, yaw from true north: image axes (right, up, backward) in east, north, up are
# Rz(-yaw) Rx(pitch) Ry(roll). Looking straight down they are 0 0 0 with the top to the north.
# Down is {down}.
# A level view has pitch 90, where yaw and roll are one turn: another format is better there.
"""
NEAR_LEVEL_DEG = 85.0


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file, a line for each frame that has an attitude.

    Args:
        histories: the jobs
        request: is not used
        report: is given warnings: frames that are left out, views near the horizon
    """
    lines = []
    level = 0
    for poses in some([camera_poses(h, report) for h in histories]):
        angles = yaw_pitch_roll_deg(poses.local_from_camera)
        level += int((angles[:, 1] > NEAR_LEVEL_DEG).sum())
        for name, where, angle in zip(poses.name, poses.geodetic, angles, strict=True):
            if len(name.split()) != 1:
                message = f"{name}: a name in geo.txt has no blank: the frame is left out"
                report(Finding(message, poses.history.about.source, severity="warning"))
                continue
            position = "{:.9f} {:.9f} {:.4f}".format(*where)
            turns = "{:.6f} {:.6f} {:.6f}".format(*(np.round(angle, 6) + 0.0))
            lines.append(f"{name} {position} {turns}")
    if level:
        message = f"{level} frames look nearly level or upward, where yaw and roll are ill defined"
        report(Finding(message, histories[0].about.source, severity="warning"))
    head = HEAD.format(source=source_text(histories), down=histories[0].about.down)
    return (head + "\n".join(lines) + "\n").encode()
