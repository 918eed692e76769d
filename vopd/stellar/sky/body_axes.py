"""Axes of the vehicle, or of the camera, in celestial and in Earth-fixed components."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.camera_mount import FORWARD
from vopd.geometry.local_axes import east_north_up
from vopd.stellar.sky.sky_pointing import CAMERA_FROM_PHOTOGRAPH

CAMERA_FRAME = "camera: x right, y down, z forward (the view)"
BODY_FRAME = "vehicle body: x forward, y right, z down"


class BodyAxes(NamedTuple):
    """Axes of one photograph as rows, (3, 3) each.

    Attributes:
        celestial: of the body, or of the camera where there is no mount, in ICRF axes
        earth_fixed: of the body (a camera that looks forward where there is no mount)
            in Earth-centred axes; None without a place
    """

    celestial: Floats
    earth_fixed: Floats | None


def axes_of_body(
    matrix: Floats,
    mount: Floats | None,
    local: Floats | None,
    place: tuple[float, float, float] | None,
) -> BodyAxes:
    """The axes of vehicle or camera.

    Args:
        matrix: from ICRF axes to the report's camera axes, (3, 3)
        mount: from camera axes to body axes; None: there is no vehicle
        local: from ICRF axes to east, north, up, (3, 3); None without a place
        place: latitude and longitude in degrees, height in metres
    """
    camera = CAMERA_FROM_PHOTOGRAPH @ matrix
    celestial = camera if mount is None else mount @ camera
    if local is None or place is None:
        return BodyAxes(celestial, None)
    earth = east_north_up(*(np.array(np.radians(angle)) for angle in place[:2]))
    body = (FORWARD if mount is None else mount) @ camera
    return BodyAxes(celestial, np.asarray(body @ local.T @ earth))
