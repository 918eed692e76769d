"""Known geometry of a video: where the camera was, the lens, the landmarks and their ground.

All directions and positions are in metres east, north, up at the landmarks' mean (the site), and
fixed to the Earth: rotations are from these axes to camera axes (x right, y down, z forward).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from vopd.arrays import Floats
from vopd.flight.flight import CameraPath, LandmarkSet, Refraction, Shutter
from vopd.flight.project.terrain import Terrain
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.geometry.earth import NED_FROM_ENU, local_axes
from vopd.geometry.lenses import Lens, project, ray_of_pixel
from vopd.geometry.rotations import rotation_matrices, rotation_vectors

FLAT = 0.1  # sine of the angle below which a line of sight grazes the ground
FAR = 1e3  # distances of the landmarks: ground that is farther away does not move
SLOPE = 0.01  # of the distance: along so much of the terrain its slope at a landmark is taken
ROUNDS, SETTLED_M = 12, 0.01  # of rays that are brought on the terrain


@dataclass(frozen=True, eq=False)
class Scene:
    """Where everything is, but for the camera's attitude.

    Args:
        lens: of the camera
        path: of the camera in all F frames of the video
        landmarks: N of them
        refraction: of the lines of sight
        mount: from camera axes to body axes, for the lever arm, (3, 3)
        shutter: a rolling one, or None
        place_sigma_m: standard deviation of the camera's place in each frame by itself, (F,); None:
            it is exact, or the same error in all frames
        terrain: the ground; None: it is level at each landmark
    """

    lens: Lens
    path: CameraPath
    landmarks: LandmarkSet
    refraction: Refraction
    mount: Floats
    shutter: Shutter | None = None
    place_sigma_m: Floats | None = None
    terrain: Terrain | None = None

    @cached_property
    def _origin(self) -> Floats:
        return np.asarray(self.landmarks.position_m.mean(axis=0))

    @cached_property
    def axes(self) -> Floats:
        """East, north, up of the site as rows, Earth-centred, (3, 3)."""
        return np.asarray(local_axes(self._origin[None])[0])

    @cached_property
    def landmark_m(self) -> Floats:
        """Where the landmarks are, (N, 3)."""
        return (self.landmarks.position_m - self._origin) @ self.axes.T

    @cached_property
    def up(self) -> Floats:
        """The vertical at each landmark, (N, 3)."""
        return self.landmarks.axes[:, 2] @ self.axes.T

    @cached_property
    def _antenna_m(self) -> Floats:
        return (self.path.position_m - self._origin) @ self.axes.T

    def camera_m(self, frame: int, rotation: Floats) -> Floats:
        """Place the camera in a frame, (3,): the track's position, and the lever arm."""
        place = np.asarray(self._antenna_m[frame])
        if self.path.lever_arm_m is None:
            return place
        return np.asarray(place + rotation.T @ (self.mount.T @ self.path.lever_arm_m))

    def velocity_m_s(self, frame: int) -> Floats:
        """Look up the camera's velocity in a frame, (3,); zero where it is not known."""
        if self.path.velocity_m_s is None:
            return np.zeros(3)
        (local,) = local_axes(self.path.position_m[frame : frame + 1])
        ned = np.nan_to_num(self.path.velocity_m_s[frame])
        return np.asarray(self.axes @ (local.T @ (NED_FROM_ENU.T @ ned)))

    def raised_m(self, frame: int) -> Floats:
        """Find by how much refraction raises each landmark seen from a frame, (N, 3)."""
        count = len(self.landmark_m)
        if not self.refraction.k:
            return np.zeros((count, 3))
        at = self.path.position_m[frame : frame + 1]
        marks = self.landmarks.position_m
        lines = sight_lines(at, marks, np.zeros(count, int), np.arange(count), self.refraction)
        (local,) = lines.axes
        apparent = at + lines.distance_m[:, None] * (lines.direction @ local)
        return np.asarray((apparent - marks) @ self.axes.T)

    def late_s(self, pixel: Floats) -> Floats:
        """Find when the rows of pixels are read after their frame's time, seconds (...)."""
        assert self.shutter is not None
        part = self.shutter.parts(pixel, self.lens.by_rows("size_px"))
        return part * self.shutter.readout_s

    def pixels(self, view: View, away: Floats) -> tuple[Floats, Floats]:
        """Project apparent places relative to the camera on the image.

        Args:
            view: the frame, the attitude, and how it changes
            away: (..., 3)

        Returns:
            u and v, (..., 2), NaN where there is no image, and their derivatives by small turns
            of the camera about its own axes, (..., 2, 3).
        """
        ray = away @ view.rotation.T
        found = project(self.lens, ray)
        if self.shutter is not None:
            moved = view.rotation @ view.velocity_m_s
            for _ in range(2):
                late = self.late_s(found.pixel)[..., None]
                found = project(self.lens, _turned(ray - moved * late, view.rate_rad_s, late))
        return found.pixel, found.by_turns

    def rays(self, view: View, pixel: Floats) -> tuple[Floats, Floats]:
        """Trace pixels back: unit vectors (..., 3), and where each starts from the camera, m."""
        ray = ray_of_pixel(self.lens, pixel)
        start = np.zeros_like(ray)
        if self.shutter is not None:
            late = self.late_s(pixel)[..., None]
            ray = _turned(ray, -view.rate_rad_s, late)
            start = view.velocity_m_s * late
        return ray @ view.rotation, start

    def ground(self, view: View, pixel: Floats, landmark: int) -> Floats:
        """Intersect the rays of pixels with the ground about a landmark, (..., 3), site axes.

        The ground is the horizontal plane through the landmark, or the terrain; where the line
        of sight grazes it, as to a summit or the top of a mast, the plane across the line.

        Args:
            view: of the frame with the pixels
            pixel: u, v near the landmark's image, (..., 2)
            landmark: its index
        """
        place = self.camera_m(view.frame, view.rotation)
        raised = self.raised_m(view.frame)[landmark]
        away = self.landmark_m[landmark] + raised - place
        slope = self._slope(landmark, float(np.linalg.norm(away)))
        normal = self.up[landmark] if slope is None else slope
        if across := abs(away @ normal) < FLAT * np.linalg.norm(away):
            normal = away / np.linalg.norm(away)
        ray, start = self.rays(view, pixel)
        reach = (away @ normal - start @ normal) / (ray @ normal)
        reach = np.where(reach > 0.0, reach, np.nan)
        start = start + place - raised
        if slope is not None and not across:
            reach = self._on_terrain(start, ray, reach, landmark, slope)
        return np.asarray(start + ray * reach[..., None])

    def _above_m(self, point: Floats, landmark: int) -> Floats:
        """Find how far points (..., 3) are above the terrain that goes through a landmark."""
        assert self.terrain is not None
        every = np.concatenate([point.reshape(-1, 3), self.landmark_m[landmark][None]])
        *above, own = self.terrain.above_m(every @ self.axes + self._origin)
        return np.asarray(np.array(above) - own).reshape(point.shape[:-1])

    def _slope(self, landmark: int, distance_m: float) -> Floats | None:
        """Find the normal of the terrain at a landmark, (3,); None where there is no terrain."""
        if self.terrain is None:
            return None
        step_m = SLOPE * distance_m
        here, axes = self.landmark_m[landmark], self.landmarks.axes[landmark] @ self.axes.T
        west, east, south, north = self._above_m(
            here + step_m * np.array([-axes[0], axes[0], -axes[1], axes[1]]), landmark
        )
        normal = axes[2] + ((east - west) * axes[0] + (north - south) * axes[1]) / (2.0 * step_m)
        return None if np.isnan(normal).any() else np.asarray(normal / np.linalg.norm(normal))

    @np.errstate(all="ignore")
    def _on_terrain(
        self, start: Floats, ray: Floats, reach: Floats, landmark: int, normal: Floats
    ) -> Floats:
        """Lengthen or shorten rays until they end on the terrain, by secants.

        Where it has no height, or a ray passes over it, the plane along its slope remains.
        """
        slope = ray @ normal / (normal @ self.up[landmark])  # of heights above it, along a ray
        first, length = self._above_m(start + ray * reach[..., None], landmark), reach
        above, step = first, -first / slope
        for _ in range(ROUNDS):
            length = length + step
            last, above = above, self._above_m(start + ray * length[..., None], landmark)
            steep = (above - last) / step
            steep = np.where(steep / slope > 0.2, steep, slope)
            step = np.where(np.abs(above) < SETTLED_M, 0.0, -above / steep)
            if not np.nan_to_num(step).any():
                break
        good = (np.abs(above) < 1.0) & (length > 0.0)
        return np.where(good, length, reach)


@dataclass(frozen=True, eq=False)
class View:
    """A frame, the camera's attitude in it, and how fast it turns and moves (rolling shutter)."""

    frame: int
    rotation: Floats  # (3, 3) from site axes to camera axes
    rate_rad_s: Floats  # (3,) about the camera's own axes
    velocity_m_s: Floats  # (3,) site axes


def _turned(ray: Floats, rate: Floats, late: Floats) -> Floats:
    """Turn rays by a rate times a time; the third order, of angles below a degree, is left."""
    once = np.cross(rate, ray) * late
    return np.asarray(ray + once + np.cross(rate, once) * (late / 2.0))


def turn_between(before: Floats, after: Floats) -> Floats:
    """Find the rotation vector about the camera's axes that leads from one attitude to another."""
    return np.asarray(rotation_vectors((after @ before.T)[None])[0])


def turned_by(vector: Floats, rotation: Floats) -> Floats:
    """Turn an attitude about the camera's axes by a rotation vector."""
    return np.asarray(rotation_matrices(np.asarray(vector)[None])[0] @ rotation)
