"""Lines of sight from the camera to landmarks, with the Earth's curvature and refraction.

Directions are differences of Earth-centred positions, so that the curvature is exact. Refraction
raises the apparent direction in the vertical plane at the camera. The ray of a pick in camera axes
is that of its lens: `ray_of_pixel` in `vopd.geometry.lenses`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.flight.flight import Refraction
from vopd.geometry.earth import Geodetic, axes_at, geodetic

EARTH_RADIUS_M = 6371e3
SCALE_HEIGHT_M = 8000.0  # the air's density falls by e in so much height


class SightLines(NamedTuple):
    """What each of P picks looks along. Components are east, north, up at the camera."""

    direction: Floats  # (P, 3) unit vectors, raised by refraction
    distance_m: Floats  # (P,)
    raised_rad: Floats  # (P,) by refraction
    camera: Geodetic  # where the camera is in every frame
    axes: Floats  # (F, 3, 3) east, north, up of every frame as rows


@np.errstate(all="ignore")
def sight_lines(
    camera_m: Floats, landmark_m: Floats, frame: Ints, landmark: Ints, refraction: Refraction
) -> SightLines:
    """Trace the lines of sight of all picks.

    Args:
        camera_m: Earth-centred, (F, 3); NaN where it is not known
        landmark_m: Earth-centred, (N, 3)
        frame: index of each pick's frame, (P,)
        landmark: index of each pick's landmark, (P,)
        refraction: how much the lines bend
    """
    camera = geodetic(camera_m)
    axes = axes_at(camera)
    away = landmark_m[landmark] - camera_m[frame]
    distance = np.linalg.norm(away, axis=1)
    straight = np.einsum("pij,pj->pi", axes[frame], away) / distance[:, None]
    seen = np.flatnonzero(np.bincount(landmark, minlength=len(landmark_m)))
    height_m = np.full(len(landmark_m), np.nan)
    height_m[seen] = geodetic(landmark_m[seen]).height_m
    heights = camera.height_m[frame], height_m[landmark]
    raised = refraction_rad(refraction, distance, *heights, straight[:, 2])
    return SightLines(_raise(straight, raised), distance, raised, camera, axes)


def refraction_rad(
    refraction: Refraction,
    distance_m: Floats,
    camera_height_m: Floats,
    landmark_height_m: Floats,
    rise: Floats,
) -> Floats:
    """Estimate how far refraction raises the direction to a landmark, radians (P,).

    A path whose curvature is k cos(e) exp(-z/H) / R, with e its elevation and z the
    height, which grows evenly along it, seems higher at the camera by the integral
    of the curvature times (1 - s/L) over the path.

    Args:
        refraction: the coefficient k at the ground, and whether it decays with height
        distance_m: L, length of the path, (P,)
        camera_height_m: of its lower or upper end at the camera, (P,)
        landmark_height_m: of its other end, (P,)
        rise: sine of the elevation of the straight line, (P,)
    """
    curvature = refraction.k * np.sqrt(np.clip(1.0 - rise**2, 0.0, 1.0)) / EARTH_RADIUS_M
    if not refraction.decays:
        return np.asarray(curvature * distance_m / 2.0)
    growth = (landmark_height_m - camera_height_m) / SCALE_HEIGHT_M
    small = np.abs(growth) < 1e-4
    a = np.where(small, 1.0, growth)
    mean = np.where(small, 0.5 - growth / 6.0, (a + np.expm1(-a)) / a**2)
    return np.asarray(curvature * distance_m * mean * np.exp(-camera_height_m / SCALE_HEIGHT_M))


def _raise(straight: Floats, raised: Floats) -> Floats:
    """Turn unit vectors upward in their vertical planes; straight up and down stay."""
    level = np.hypot(straight[:, 0], straight[:, 1])
    up = np.stack(
        [-straight[:, 0] * straight[:, 2], -straight[:, 1] * straight[:, 2], level**2], axis=1
    )
    up = np.where(level[:, None] > 0.0, up / np.where(level > 0.0, level, 1.0)[:, None], 0.0)
    turned = straight * np.cos(raised)[:, None] + up * np.sin(raised)[:, None]
    return np.asarray(np.where((level > 0.0)[:, None], turned, straight))
