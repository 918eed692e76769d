"""Photographs of stars made without the package, and the text of their star files."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

HEAD = "x_mm,y_mm,ra_deg,dec_deg"
Star = tuple[float, float, float, float]
"""x, y, right ascension and declination."""


def photograph(count: int = 10, sigma_mm: float = 0.005, focal_mm: float = 76.0) -> list[Star]:
    """Stars near right ascension 65, declination 20, read with errors of this size."""
    rng = np.random.default_rng(5)
    images = rng.uniform(-15.0, 15.0, (count, 2))
    rays = np.column_stack([images, np.full(count, -focal_mm)])
    look = Rotation.from_euler("zyx", [65.0, -20.0, 30.0], degrees=True)
    ahead = np.column_stack([-rays[:, 2], -rays[:, 0], rays[:, 1]])  # x ahead, y left, z up
    u, v, w = look.apply(ahead).T
    ra, dec = np.degrees(np.arctan2(v, u)), np.degrees(np.arctan2(w, np.hypot(u, v)))
    noisy = images + rng.normal(0.0, sigma_mm, images.shape)
    return [tuple(map(float, star)) for star in np.column_stack([noisy, ra, dec])]  # type: ignore[misc]


def written(stars: list[Star], header: str = HEAD) -> str:
    lines = (",".join(f"{value:.7f}" for value in star) for star in stars)
    return "\n".join([header, *lines]) + "\n"
