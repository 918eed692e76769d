"""The camera as vectors and matrices: from a landmark to its image, and back to the ground.

Appendix A of TM X-3050 in other words. The optical axis points at azimuth sigma 1
and elevation sigma 2; image x and y lie across it, turned by sigma 3, with x to
the left and y up when sigma 3 is zero. The vertical is the line to the Earth's centre.
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
class View:
    """Where the camera is and how it stands, frame by frame, about the Earth's centre."""

    position_km: Floats  # (F, 3)
    axes: Floats  # (F, 3, 3): image x, image y and optical axis as rows

    def only(self, frames: np.ndarray | slice) -> View:
        """The same for some of the frames."""
        return View(self.position_km[frames], self.axes[frames])


def view(path: Trajectory, position_ft: Floats, camera_deg: Floats) -> View:
    """The camera at east, north, up (F, 3) feet of the origin, with angles (F, 3) degrees."""
    latitude = geocentric(path.origin_latitude_deg, ORIGIN_FOUR_PHI)
    east, north, up = local_axes(np.array(path.origin_longitude_deg), latitude)
    centre = up * (path.origin_radius_kft * 1000.0 / ftpkm)
    position = centre + (position_ft * vftpkm) @ np.stack([east, north, up])
    longitude = np.degrees(np.arctan2(position[:, 1], position[:, 0]))
    latitude = np.degrees(np.arctan2(position[:, 2], np.hypot(position[:, 0], position[:, 1])))
    local = np.stack(local_axes(longitude, latitude), axis=1)  # (F, 3, 3): east, north, up as rows
    return View(position, camera_axes(camera_deg) @ local)


def local_axes(longitude_deg: Floats, latitude_deg: Floats) -> tuple[Floats, Floats, Floats]:
    """East, north, up (..., 3) about the Earth's centre, by longitude and geocentric latitude."""
    lon, lat = np.radians(longitude_deg), np.radians(latitude_deg)
    zero = np.zeros_like(lon)
    east = np.stack([-np.sin(lon), np.cos(lon), zero], axis=-1)
    up = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1)
    return east, np.cross(up, east), up


def camera_axes(camera_deg: Floats) -> Floats:
    """Image x, image y and optical axis as rows (F, 3, 3), along east, north, up."""
    yaw, pitch, roll = np.radians(camera_deg).T
    zero = np.zeros_like(yaw)
    flat = np.stack([np.sin(yaw), np.cos(yaw), zero], axis=-1)  # where it looks, on the map
    right = np.stack([np.cos(yaw), -np.sin(yaw), zero], axis=-1)
    vertical = np.array([0.0, 0.0, 1.0])
    cos, sin = np.cos(pitch)[:, None], np.sin(pitch)[:, None]
    axis, above = cos * flat + sin * vertical, cos * vertical - sin * flat
    cos, sin = np.cos(roll)[:, None], np.sin(roll)[:, None]
    return np.stack([sin * above - cos * right, cos * above + sin * right, axis], axis=1)


def lens_table(plan: Plan) -> tuple[Floats, Floats]:
    """Group 1: radii in mm, to past the frame's corner, and distortions in micrometres."""
    corner = np.hypot(*plan.frame_in) / 2.0 * factor
    radius = np.linspace(0.0, 1.05 * corner, LENS_ROWS).round(3)
    return radius, (145.0 * (radius / radius[-1]) ** 1.5).round(1)


def images(plan: Plan, seen: View, ground_km: Floats) -> tuple[Floats, Floats]:
    """Images (F, N, 2) in inches on the reader, and the sine of the sight's slope at the ground.

    `ground_km` is (N, 3), the same points in every frame, or (F, N, 3). What is
    behind the camera has no image (NaN). The slope is taken from the landmark's horizontal.
    """
    sight = ground_km - seen.position_km[:, None]
    x, y, depth = np.moveaxis(sight @ seen.axes.swapaxes(1, 2), -1, 0)
    depth = np.where(depth > 0.0, depth, np.nan)
    straight = plan.focal_length_mm * np.stack([x / depth, y / depth], axis=-1)
    size = np.linalg.norm(sight, axis=-1) * np.linalg.norm(ground_km, axis=-1)
    slope = -(sight * ground_km).sum(axis=-1) / size
    return np.array(plan.frame_in) / 2.0 + distorted(plan, straight) / factor, slope


def distorted(plan: Plan, straight_mm: Floats) -> Floats:
    """Where the lens puts an image (..., 2) of a perfect one, mm from the frame's centre.

    The program adds the table's value at the measured radius; here that is undone:
    both are straight lines between the table's rows.
    """
    radius, distortion = lens_table(plan)
    straight = np.hypot(straight_mm[..., 0], straight_mm[..., 1])
    measured = np.interp(straight, radius + distortion / 1000.0, radius)
    return straight_mm * (measured / np.where(straight > 0.0, straight, 1.0))[..., None]


def seen_ground(plan: Plan, seen: View, point_in: Floats, height_ft: Floats) -> Floats:
    """The points (F, N, 3) km that perfect images `point_in` (F, N, 2) show at `height_ft` (F, N).

    NaN where the line of sight misses the Earth.
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
    """Points (N, 3) on the ground, by geodetic latitude, where the program has them."""
    _, _, up = local_axes(longitude_deg, geocentric(latitude_deg, LANDMARK_FOUR_PHI))
    return up * (eradkm + height_ft / ftpkm)[:, None]
