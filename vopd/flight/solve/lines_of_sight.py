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
from vopd.geometry.ellipsoids import WGS84

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


# Derivatives by places and by the coefficient of refraction


class Apparent(NamedTuple):
    """Directions of landmarks, east, north, up at the camera, with their derivatives."""

    direction: Floats  # (..., 3) unit vectors, raised by refraction
    by_away: Floats  # (..., 3, 3) by the landmark's place relative to the camera, m
    by_height: Floats  # (..., 3) by a metre up of camera and landmark together
    by_refraction: Floats  # (..., 3) by the coefficient k


@np.errstate(all="ignore")
def apparent(
    away: Floats, camera_height_m: Floats, landmark_height_m: Floats, refraction: Refraction
) -> Apparent:
    """Refract lines of sight, with derivatives.

    A line that rises by e is turned up by rho = q r, r its level length and q the mean
    curvature: the component across the vertical plane is scaled by cos(e + rho) / cos e,
    that within it turns.

    Args:
        away: from camera to landmark, east, north, up, m, (..., 3)
        camera_height_m: above the ellipsoid, (...)
        landmark_height_m: (...)
        refraction: of the flight
    """
    length = np.linalg.norm(away, axis=-1)
    straight = away / length[..., None]
    rise, level = straight[..., 2], np.hypot(straight[..., 0], straight[..., 1])
    some, zero = level > 0.0, np.zeros_like(rise)
    over = 1.0 / np.where(some, level, 1.0)
    along = np.where(some[..., None], straight[..., :2] * over[..., None], [1.0, 0.0])
    upward = np.stack([-rise * along[..., 0], -rise * along[..., 1], level], axis=-1)
    across = np.stack([-along[..., 1], along[..., 0], zero], axis=-1)
    unit = Refraction(1.0, refraction.decays)
    each = refraction_rad(unit, length, camera_height_m, landmark_height_m, rise)
    raised = refraction.k * each
    cosine, sine = np.cos(raised), np.sin(raised)
    direction = straight * cosine[..., None] + upward * sine[..., None]
    turned = upward * cosine[..., None] - straight * sine[..., None]
    wider = cosine - rise * np.where(some, sine * over, 0.0)
    slope = np.where(some, raised * over / length, 0.0)  # rho over r
    by_raised = np.stack([slope * along[..., 0], slope * along[..., 1], zero], axis=-1)
    lower = zero
    if refraction.decays:
        growth = (landmark_height_m - camera_height_m) / SCALE_HEIGHT_M
        by_raised[..., 2] = raised * _mean_slope(growth) / SCALE_HEIGHT_M
        lower = -raised / SCALE_HEIGHT_M
    by_away = (wider[..., None] * across)[..., None] * across[..., None, :]
    by_away = (by_away + turned[..., None] * upward[..., None, :]) / length[..., None, None]
    by_away += turned[..., None] * by_raised[..., None, :]
    return Apparent(direction, by_away, turned * lower[..., None], turned * each[..., None])


def _mean_slope(growth: Floats) -> Floats:
    """Differentiate the logarithm of the mean weight of `refraction_rad` by the growth."""
    small = np.abs(growth) < 1e-3
    a = np.where(small, 1.0, growth)
    mean = (a + np.expm1(-a)) / a**2
    slope = -np.expm1(-a) / a**2 - 2.0 * mean / a
    return np.where(small, (-1.0 / 6.0 + growth / 12.0) / (0.5 - growth / 6.0), slope / mean)


def vertical_by_position(camera: Geodetic) -> Floats:
    """Differentiate the directions of east, north, up by the place: turns a metre, (F, 3, 3)."""
    latitude = np.radians(camera.latitude_deg)
    e2 = WGS84.flattening * (2.0 - WGS84.flattening)
    flat = 1.0 - e2 * np.sin(latitude) ** 2
    radius = WGS84.radius_km * 1e3
    across = radius / np.sqrt(flat) + camera.height_m
    along = radius * (1.0 - e2) / flat**1.5 + camera.height_m
    turn = np.zeros((len(latitude), 3, 3))
    turn[:, 0, 1], turn[:, 1, 0] = -1.0 / along, 1.0 / across
    turn[:, 2, 0] = np.tan(latitude) / across
    return turn
