"""Flights with errors drawn from their priors; geodesy and camera by numpy and scipy alone."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from vopd.arrays import Floats, Ints
from vopd.flight.equations import Priors
from vopd.flight.flight import (
    CameraPath,
    Flight,
    FlightOptions,
    LandmarkSet,
    Picks,
    Refraction,
    TrackFixes,
)
from vopd.geometry.lenses import Lens, LensKind

RADIUS, E2 = 6378137.0, (2.0 - 1.0 / 298.257223563) / 298.257223563
FOCAL, SIZE, CENTRE = 3000.0, (4000, 3000), np.array([1999.5, 1499.5])
NED_FROM_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
LENS = ("focal", "centre_u", "centre_v", "k1", "k2")


def geodetic(position: Floats) -> tuple[Floats, Floats, Floats]:
    """Latitude, longitude (radians) and height of Earth-centred positions (..., 3)."""
    x, y, z = np.moveaxis(position, -1, 0)
    across = np.hypot(x, y)
    latitude = np.arctan2(z, across * (1.0 - E2))
    for _ in range(10):
        normal = RADIUS / np.sqrt(1.0 - E2 * np.sin(latitude) ** 2)
        latitude = np.arctan2(z + E2 * normal * np.sin(latitude), across)
    flat = np.sqrt(1.0 - E2 * np.sin(latitude) ** 2)
    height = across * np.cos(latitude) + z * np.sin(latitude) - RADIUS * flat
    return latitude, np.arctan2(y, x), height


def axes(position: Floats) -> Floats:
    """East, north, up as rows (..., 3, 3)."""
    latitude, longitude, _ = geodetic(position)
    (sl, so), (cl, co) = np.sin([latitude, longitude]), np.cos([latitude, longitude])
    rows = [[-so, co, 0.0 * so], [-sl * co, -sl * so, cl], [cl * co, cl * so, sl]]
    return np.stack([np.stack(row, -1) for row in rows], -2)


ORIGIN = np.array([4317000.0, 607000.0, 4642000.0])  # 47 north, 8 east, 1384 m high


class LensTruth(NamedTuple):
    """A camera of Brown's model with two coefficients."""

    focal: float = FOCAL
    centre_u: float = float(CENTRE[0])
    centre_v: float = float(CENTRE[1])
    k1: float = 0.0
    k2: float = 0.0

    def image(self, ray: Floats) -> Floats:
        """Project rays in camera axes (..., 3)."""
        x, y = ray[..., 0] / ray[..., 2], ray[..., 1] / ray[..., 2]
        r2 = x * x + y * y
        scale = self.focal * (1.0 + self.k1 * r2 + self.k2 * r2 * r2)
        return np.stack([scale * x + self.centre_u, scale * y + self.centre_v], -1)


class Scene(NamedTuple):
    """A camera's true places and rotations, landmarks, and which of them each pick is of."""

    camera_m: Floats  # (F, 3) Earth-centred
    rotation: Floats  # (F, 3, 3) from local axes to camera axes
    landmark_m: Floats  # (N, 3) Earth-centred
    frame: Ints  # (P,)
    landmark: Ints  # (P,)


def drone(
    rng: np.random.Generator, frames: int, landmarks: int, *, seen: float = 1.0,
    spacing_m: float = 2.0, height_m: float = 100.0, tilt_deg: float = 30.0,
) -> Scene:  # fmt: skip
    """A drone that flies straight on and looks `tilt_deg` ahead of the nadir.

    `seen` is the part of the landmarks that is picked in each frame.
    """
    heading = rng.uniform(0.0, 360.0)
    along = np.array([np.sin(np.radians(heading)), np.cos(np.radians(heading)), 0.0])
    camera = (np.arange(frames) - frames / 2)[:, None] * spacing_m * along + [0.0, 0.0, height_m]
    angles = np.stack(  # yaw, pitch, roll
        [
            heading + rng.normal(0.0, 5.0, frames),
            tilt_deg - 90.0 + rng.normal(0.0, 4.0, frames),
            rng.normal(0.0, 4.0, frames),
        ],
        -1,
    )
    level = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # looks north
    turned = Rotation.from_euler("ZXY", angles * [-1.0, 1.0, 1.0], degrees=True).as_matrix()
    rotation = level @ turned.swapaxes(1, 2)
    middle = frames // 2
    spread = rng.uniform(-0.3, 0.3, (landmarks, 2)) * np.array(SIZE) / FOCAL
    ray = np.column_stack([spread, np.ones(landmarks)]) @ rotation[middle]
    fall = (camera[middle, 2] - rng.uniform(-5.0, 5.0, landmarks)) / -ray[:, 2]
    ground = camera[middle] + ray * fall[:, None]
    picked = rng.random((frames, landmarks)) < seen
    own = axes(ORIGIN)
    return Scene(ORIGIN + camera @ own, rotation, ORIGIN + ground @ own, *np.nonzero(picked))


def flight_of(
    rng: np.random.Generator, scene: Scene, sigma_px: float, priors: Priors, *,
    velocity_m_s: tuple[float, float, float] = (0.0, 0.0, 0.0), loss: str = "least-squares",
    time_s: Floats | None = None,
) -> Flight:  # fmt: skip
    """A flight whose picks, fixes, places, landmarks, lens and clock are wrong by their sigmas.

    Args:
        rng: the source of what is random
        scene: the truth
        sigma_px: of picks
        priors: the standard deviations; an infinite one draws nothing
        velocity_m_s: east, north, up
        loss: by name
        time_s: of the frames; None: 30 frames a second
    """
    frames, own = len(scene.camera_m), axes(scene.camera_m)
    wrong = {n: rng.normal() * s for n, s in priors.parameter.items() if np.isfinite(s)}
    lens = LensTruth()
    lens = lens._replace(**{n: getattr(lens, n) + wrong[n] for n in LENS if n in wrong})
    away = scene.landmark_m[scene.landmark] - scene.camera_m[scene.frame]
    ray = np.einsum("pij,pjk,pk->pi", scene.rotation[scene.frame], own[scene.frame], away)
    pixel = lens.image(ray) + rng.normal(0.0, sigma_px, (len(ray), 2))
    moved = np.tile([wrong.get(name, 0.0) for name in ("east", "north", "up")], (frames, 1))
    moved += np.array(velocity_m_s) * wrong.get("clock", 0.0)
    if priors.fixes is not None:
        moved += at_frames(priors.fixes, rng.normal(0.0, priors.fixes.sigma_m))
    landmark_m, sigma_m = scene.landmark_m, np.zeros((len(scene.landmark_m), 3))
    if priors.landmark_m is not None:
        sigma_m = priors.landmark_m
        landmark_m = landmark_m - turned_out(axes(landmark_m), rng.normal(0.0, sigma_m))
    return Flight(
        "drawn",
        "drawn.toml",
        Lens(LensKind.BROWN, SIZE, np.full(2, FOCAL), CENTRE, np.zeros(12)),
        np.arange(frames),
        (),
        np.arange(frames) / 30.0 if time_s is None else time_s,
        None,
        Picks(scene.frame, scene.landmark, pixel, np.full(len(pixel), sigma_px)),
        LandmarkSet(tuple(f"P{k}" for k in range(len(landmark_m))), landmark_m, sigma_m),
        CameraPath(
            scene.camera_m - turned_out(own, moved),
            priors.fixes,
            np.array([priors.parameter.get(name, 0.0) for name in ("east", "north", "up")]),
            velocity_m_s=np.tile(np.array(velocity_m_s) @ NED_FROM_ENU, (frames, 1)),
        ),
        np.eye(3),
        Refraction(0.0, False),
        FlightOptions(loss),
    )


def turned_out(own: Floats, vector: Floats) -> Floats:
    """Vectors east, north, up (n, 3) as Earth-centred ones."""
    return np.einsum("nji,nj->ni", own, vector)


def at_frames(fixes: TrackFixes, error: Floats) -> Floats:
    """Errors of fixes (J, 3) at the frames, frame by frame (F, 3)."""
    out = np.zeros((len(fixes.first), 3))
    for frame, (first, weight) in enumerate(zip(fixes.first, fixes.weight, strict=True)):
        for slot, part in enumerate(weight):
            if part:
                out[frame] += part * error[first + slot]
    return out
