"""Unit vectors of images, stars and ground points, and coordinates from them.

Camera axes: x and y are those of the photograph (a positive, held in front of
the lens), z points backward, so that the camera looks along -z and the third
component R of every image is negative. Object axes: for stars U points to
right ascension 0, declination 0, and W to the celestial pole; for ground points
they are the axes of the points' coordinates.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.vectors import unit


def image_directions(image_mm: Floats, focal_length_mm: Floats | float) -> Floats:
    """Unit vectors P, Q, R of images, in camera axes.

    Args:
        image_mm: x, y from the principal point, (..., 2), mm
        focal_length_mm: principal distance, positive, broadcast against (...), mm

    Returns:
        Unit vectors, (..., 3).

    Source: Rae (1987), eq. 3.2.
    """
    x, y = image_mm[..., 0], image_mm[..., 1]
    minus_f = np.broadcast_to(-np.asarray(focal_length_mm, dtype=float), x.shape)
    return unit(np.stack([x, y, minus_f], axis=-1))


def image_points_mm(camera_vectors: Floats, focal_length_mm: Floats | float) -> Floats:
    """Image coordinates of directions given in camera axes.

    Args:
        camera_vectors: vectors in camera axes, any length, (..., 3)
        focal_length_mm: principal distance, positive, broadcast against (...), mm

    Returns:
        x, y, (..., 2), mm; not finite at right angles to the optical axis. A
        vector behind the camera (z >= 0) gets the image of its opposite, as in
        program STARS: test the sign of z.

    Source: Rae (1987), eqs. 2.1 and 2.2.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = -np.asarray(focal_length_mm, dtype=float) / camera_vectors[..., 2]
        points: Floats = camera_vectors[..., :2] * scale[..., None]
    return points


def star_directions(ra_deg: Floats, dec_deg: Floats) -> Floats:
    """Unit vectors U, V, W of stars, in celestial axes.

    Args:
        ra_deg: right ascension, (...), degrees
        dec_deg: declination, (...), degrees, -90 to 90

    Returns:
        Unit vectors, (..., 3).

    Source: Rae (1987), eq. 2.5.
    """
    alpha, delta = np.radians(ra_deg), np.radians(dec_deg)
    return np.stack(
        [np.cos(alpha) * np.cos(delta), np.sin(alpha) * np.cos(delta), np.sin(delta)], axis=-1
    )


def right_ascension_declination_deg(directions: Floats) -> tuple[Floats, Floats]:
    """Right ascension and declination of directions in celestial axes.

    Args:
        directions: vectors of any length, (..., 3)

    Returns:
        Right ascension, (...), degrees, -180 to 180 as program RADEC2 prints it,
        and declination, (...), degrees, -90 to 90.
    """
    u, v, w = (directions[..., k] for k in range(3))
    return np.degrees(np.arctan2(v, u)), np.degrees(np.arctan2(w, np.hypot(u, v)))


def ground_directions(points_m: Floats, camera_m: Floats) -> Floats:
    """Unit vectors U, V, W from the camera to ground points.

    Args:
        points_m: positions of the points, (..., n, 3), metres, rectangular axes
        camera_m: position of the camera in the same axes, (..., 3), metres

    Returns:
        Unit vectors, (..., n, 3); NaN for a point at the camera.

    Source: Rae (1987), eq. 5.1.
    """
    return unit(points_m - np.asarray(camera_m, dtype=float)[..., None, :])
