"""Direction cosines of images, of stars and of ground points, and back.

Camera frame: x and y are those of the photograph (a positive, held in front),
z points backward, so that the camera looks along -z and P, Q, R have R < 0.
Object frame: for stars U points to right ascension 0, declination 0, W to the
celestial pole; for ground points it is the frame of their coordinates.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.vectors import unit


def image_directions(image_mm: Floats, focal_length_mm: Floats | float) -> Floats:
    """P, Q, R of images (eq. 3.2).

    image_mm (..., 2), focal length (positive, broadcasts against image_mm[..., 0]):
    unit vectors (..., 3) in the camera frame.
    """
    x, y = image_mm[..., 0], image_mm[..., 1]
    minus_f = np.broadcast_to(-np.asarray(focal_length_mm, dtype=float), x.shape)
    return unit(np.stack([x, y, minus_f], axis=-1))


def image_points_mm(camera_vectors: Floats, focal_length_mm: Floats | float) -> Floats:
    """Image coordinates of vectors in the camera frame (eqs. 2.1, 2.2): (..., 3) to (..., 2).

    Not finite at right angles to the optical axis. A vector behind the camera
    (z >= 0) gets the image of its opposite, as in STARS: test z.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = -np.asarray(focal_length_mm, dtype=float) / camera_vectors[..., 2]
        points: Floats = camera_vectors[..., :2] * scale[..., None]
    return points


def star_directions(ra_deg: Floats, dec_deg: Floats) -> Floats:
    """U, V, W of stars (eq. 2.5): right ascension and declination (...), to (..., 3)."""
    alpha, delta = np.radians(ra_deg), np.radians(dec_deg)
    return np.stack(
        [np.cos(alpha) * np.cos(delta), np.sin(alpha) * np.cos(delta), np.sin(delta)], axis=-1
    )


def right_ascension_declination_deg(directions: Floats) -> tuple[Floats, Floats]:
    """Right ascension, -180 to 180 as RADEC2 prints it, and declination: (..., 3) to (...)."""
    u, v, w = (directions[..., k] for k in range(3))
    return np.degrees(np.arctan2(v, u)), np.degrees(np.arctan2(w, np.hypot(u, v)))


def ground_directions(points_m: Floats, camera_m: Floats) -> Floats:
    """U, V, W of ground points seen from the camera (eq. 5.1).

    points_m (..., n, 3) and camera_m (..., 3) in one rectangular frame: unit
    vectors (..., n, 3); NaN for a point at the camera.
    """
    return unit(points_m - np.asarray(camera_m, dtype=float)[..., None, :])
