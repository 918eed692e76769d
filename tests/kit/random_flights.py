"""Random flights whose truth is known: lenses of all kinds, any latitude, range and attitude."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from vopd.arrays import Floats, Ints
from vopd.flight.flight import Refraction
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.geometry.earth import earth_centred_m, local_axes
from vopd.geometry.lenses import Lens, LensKind, project, ray_of_pixel

SIZE = (1920, 1080)
CENTRE = np.array([962.3, 534.8])


def lenses() -> dict[str, Lens]:
    """A lens of every kind."""
    zero = np.zeros(12)
    brown = np.array([-0.1, 0.02, 1e-3, -2e-3, 3e-3, 0.01, 2e-3, 1e-4, 5e-4, 1e-4, -3e-4, 2e-4])
    focal = np.array([1500.0, 1490.0])
    table = np.array([[0.0, 0.0], [200.0, 0.7], [500.0, 4.0], [900.0, 2.0], [1300.0, -3.0]])
    fisheye = np.array([0.03, 0.01, -0.02, 0.004])
    return {
        "pinhole": Lens(LensKind.BROWN, SIZE, focal, CENTRE, zero),
        "brown": Lens(LensKind.BROWN, SIZE, focal, CENTRE, brown),
        "skew": Lens(LensKind.BROWN, SIZE, focal, CENTRE, brown, skew_px=3.0),
        "fisheye": Lens(LensKind.FISHEYE, SIZE, np.array([760.0, 755.0]), CENTRE, fisheye),
        "table": Lens(
            LensKind.RADIAL_TABLE, SIZE, np.array([1500.0, 1500.0]), CENTRE, np.zeros(0), 0.0, table
        ),
    }


class Sightings(NamedTuple):
    """One frame that a random flight sees: what its solve is given, and the truth."""

    lens: Lens
    camera_m: Floats  # (3,) Earth-centred
    landmark_m: Floats  # (n, 3) Earth-centred
    direction: Floats  # (n, 3) east, north, up, with refraction
    pixel: Floats  # (n, 2)
    rotation: Floats  # (3, 3) from local east, north, up to camera axes


def random_frame(
    rng: np.random.Generator, lens: Lens, landmarks: int, noise_px: float, straight: str = ""
) -> Sightings:
    """A frame at a random position and attitude, its landmarks 20 m to 40 km away.

    Args:
        rng: the source of what is random
        lens: the camera's
        landmarks: how many are seen
        noise_px: standard deviation of u and of v
        straight: "up" or "down" for a camera that looks exactly there
    """
    latitude, longitude = np.degrees(np.arcsin(rng.uniform(-1, 1))), rng.uniform(-180, 180)
    camera = earth_centred_m(latitude, longitude, rng.uniform(0.0, 30e3))
    rotation = np.asarray(Rotation.random(random_state=rng).as_matrix())
    if straight:
        upright = Rotation.from_euler("x", {"up": 0.0, "down": 180.0}[straight], degrees=True)
        about = Rotation.from_euler("z", rng.uniform(0.0, 360.0), degrees=True)
        rotation = np.asarray((about * upright).as_matrix())
    pixel = rng.uniform([50.0, 50.0], [1870.0, 1030.0], (landmarks, 2))
    distance = np.exp(rng.uniform(np.log(20.0), np.log(40e3), landmarks))
    axes = local_axes(camera)
    away = ray_of_pixel(lens, pixel) @ rotation @ axes
    points = camera + away * distance[:, None]
    zeros: Ints = np.zeros(landmarks, np.int64)
    lines = sight_lines(camera[None], points, zeros, np.arange(landmarks), Refraction())
    seen = project(lens, lines.direction @ rotation.T).pixel + rng.normal(
        0.0, noise_px, (landmarks, 2)
    )
    return Sightings(lens, camera, points, lines.direction, seen, rotation)
