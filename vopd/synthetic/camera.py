"""The synthetic camera: compute images of landmarks, and the ground that images show.

The camera model of TM X-3050, Appendix A, without its formulas. The optical
axis points at azimuth sigma 1 and elevation sigma 2; image x and y lie across
it, turned by sigma 3, with x to the left and y up when sigma 3 is zero. The
vertical is the line to the Earth's centre.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vopd.arrays import Floats
from vopd.job import Trajectory
from vopd.program.constants import eradkm, factor, ftpkm, vftpkm
from vopd.program.geocentric import LANDMARK_FOUR_PHI, ORIGIN_FOUR_PHI, geocentric
from vopd.synthetic.plan import Plan

LENS_ROWS = 25


@dataclass(frozen=True)
class CameraView:
    """Position and axes of the camera in each frame, in Earth-fixed axes."""

    position_km: Floats  # (F, 3)
    axes: Floats  # (F, 3, 3): image x, image y and optical axis as rows

    def only(self, frames: np.ndarray | slice) -> CameraView:
        """The view of some of the frames only."""
        return CameraView(self.position_km[frames], self.axes[frames])


def view(path: Trajectory, position_ft: Floats, camera_deg: Floats) -> CameraView:
    """The camera in Earth-fixed axes.

    Args:
        path: the trajectory, for its origin
        position_ft: east, north, up of the origin, ft (F, 3)
        camera_deg: yaw, pitch, roll of the camera, degrees (F, 3)
    """
    latitude = geocentric(path.origin_latitude_deg, ORIGIN_FOUR_PHI)
    east, north, up = local_axes(np.array(path.origin_longitude_deg), latitude)
    centre = up * (path.origin_radius_kft * 1000.0 / ftpkm)
    position = centre + (position_ft * vftpkm) @ np.stack([east, north, up])
    longitude = np.degrees(np.arctan2(position[:, 1], position[:, 0]))
    latitude = np.degrees(np.arctan2(position[:, 2], np.hypot(position[:, 0], position[:, 1])))
    local = np.stack(local_axes(longitude, latitude), axis=1)  # (F, 3, 3): east, north, up as rows
    return CameraView(position, camera_axes(camera_deg) @ local)


def local_axes(longitude_deg: Floats, latitude_deg: Floats) -> tuple[Floats, Floats, Floats]:
    """Unit vectors east, north, up (..., 3) at longitudes and geocentric latitudes in degrees."""
    lon, lat = np.radians(longitude_deg), np.radians(latitude_deg)
    zero = np.zeros_like(lon)
    east = np.stack([-np.sin(lon), np.cos(lon), zero], axis=-1)
    up = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1)
    return east, np.cross(up, east), up


def camera_axes(camera_deg: Floats) -> Floats:
    """Image x, image y and optical axis as rows (F, 3, 3), by their east, north, up components."""
    yaw, pitch, roll = np.radians(camera_deg).T
    zero = np.zeros_like(yaw)
    flat = np.stack([np.sin(yaw), np.cos(yaw), zero], axis=-1)  # direction of sight on the map
    right = np.stack([np.cos(yaw), -np.sin(yaw), zero], axis=-1)
    vertical = np.array([0.0, 0.0, 1.0])
    cos, sin = np.cos(pitch)[:, None], np.sin(pitch)[:, None]
    axis, above = cos * flat + sin * vertical, cos * vertical - sin * flat
    cos, sin = np.cos(roll)[:, None], np.sin(roll)[:, None]
    return np.stack([sin * above - cos * right, cos * above + sin * right, axis], axis=1)


def lens_table(plan: Plan) -> tuple[Floats, Floats]:
    """The lens table of group 1: radii in mm, to beyond the corner, and distortions in µm."""
    corner = np.hypot(*plan.frame_in) / 2.0 * factor
    radius = np.linspace(0.0, 1.05 * corner, LENS_ROWS).round(3)
    return radius, (145.0 * (radius / radius[-1]) ** 1.5).round(1)


def images(plan: Plan, seen: CameraView, ground_km: Floats) -> tuple[Floats, Floats]:
    """Images of points on the ground, and how steeply the camera looks at them.

    Args:
        plan: the flight
        seen: the camera in F frames
        ground_km: points (N, 3), the same in every frame, or (F, N, 3), Earth-fixed, km

    Returns:
        The images on the film reader, in (F, N, 2), NaN for points behind the camera; and the
        sine of the angle between the line of sight and the point's horizontal (F, N).
    """
    sight = ground_km - seen.position_km[:, None]
    x, y, depth = np.moveaxis(sight @ seen.axes.swapaxes(1, 2), -1, 0)
    depth = np.where(depth > 0.0, depth, np.nan)
    straight = plan.focal_length_mm * np.stack([x / depth, y / depth], axis=-1)
    size = np.linalg.norm(sight, axis=-1) * np.linalg.norm(ground_km, axis=-1)
    slope = -(sight * ground_km).sum(axis=-1) / size
    return np.array(plan.frame_in) / 2.0 + distorted(plan, straight) / factor, slope


def distorted(plan: Plan, straight_mm: Floats) -> Floats:
    """Images with the distortion of the lens, mm from the frame's centre (..., 2).

    The program corrects with the table's value at the measured radius; this is
    the inverse, exact because both are linear between the table's rows.
    """
    radius, distortion = lens_table(plan)
    straight = np.hypot(straight_mm[..., 0], straight_mm[..., 1])
    measured = np.interp(straight, radius + distortion / 1000.0, radius)
    return straight_mm * (measured / np.where(straight > 0.0, straight, 1.0))[..., None]


def seen_ground(plan: Plan, seen: CameraView, point_in: Floats, height_ft: Floats) -> Floats:
    """The points on the ground that undistorted images show.

    Args:
        plan: the flight
        seen: the camera in F frames
        point_in: images on the film reader, in (F, N, 2)
        height_ft: heights of the points above the sphere, ft (F, N)

    Returns:
        The points in Earth-fixed axes, km (F, N, 3); NaN where the line of sight misses the Earth.
    """
    film = (point_in - np.array(plan.frame_in) / 2.0) * factor / plan.focal_length_mm
    sight = np.concatenate([film, np.ones_like(film[..., :1])], axis=-1) @ seen.axes
    sight /= np.linalg.norm(sight, axis=-1, keepdims=True)
    camera = seen.position_km[:, None]
    along = (sight * camera).sum(axis=-1)
    radius = eradkm + height_ft / ftpkm
    with np.errstate(invalid="ignore"):
        reach = np.sqrt(along**2 - (camera**2).sum(axis=-1) + radius**2)
    return np.asarray(camera + (-along - reach)[..., None] * sight)


def landmark_km(longitude_deg: Floats, latitude_deg: Floats, height_ft: Floats) -> Floats:
    """Landmarks in Earth-fixed axes, km (N, 3), as the program computes them."""
    _, _, up = local_axes(longitude_deg, geocentric(latitude_deg, LANDMARK_FOUR_PHI))
    return up * (eradkm + height_ft / ftpkm)[:, None]
