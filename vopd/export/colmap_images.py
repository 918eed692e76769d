"""COLMAP's images.txt: the rotation from a site's axes to the camera, and a translation.

The site's axes are east, north, up at the first frame's position, in metres.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vopd.attitude.history import History
from vopd.export.file_request import FileRequest, printable
from vopd.export.photogrammetry import camera_poses, pose_in_site, some, source_text
from vopd.findings import Report
from vopd.geometry.rotations import from_axes

HEAD = """\
# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME
# POINTS2D[] as (X, Y, POINT3D_ID): none, so that every second line is empty
# {source}
# Q: Hamilton, scalar first, from site axes to camera axes (right, down, forward)
# T: metres; the camera is at -R' T. Site axes: east, north, up on WGS 84 at
# latitude {latitude:.9f}, longitude {longitude:.9f}, height {height:.4f} m above the ellipsoid
# Number of images: {count}
"""


def render(histories: Sequence[History], request: FileRequest, report: Report) -> bytes:
    """Make the file, two lines for each frame that has an attitude.

    Args:
        histories: the jobs
        request: is not used
        report: is given warnings about frames that are left out
    """
    found = some([camera_poses(h, report) for h in histories])
    origin = found[0].position_m[0]
    longitude, latitude, height = found[0].geodetic[0]
    lines: list[str] = []
    for poses in found:
        rotation, position = pose_in_site(poses, origin)
        quaternion = from_axes(rotation.swapaxes(1, 2))
        translation = -(rotation @ position[..., None])[..., 0]
        for q, t, name in zip(quaternion, translation, poses.name, strict=True):
            numbers = " ".join(f"{x:.12g}" for x in np.concatenate([np.round(q, 12), t]) + 0.0)
            lines += [f"{len(lines) // 2 + 1} {numbers} 1 {printable(name)}", ""]
    head = HEAD.format(
        source=source_text(histories),
        latitude=latitude,
        longitude=longitude,
        height=height,
        count=len(lines) // 2,
    )
    return (head + "\n".join(lines) + "\n").encode()
