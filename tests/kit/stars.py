"""Star files and photographs of stars."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from tests.kit.command import DECKS, Ran, vopd

STARS = DECKS / "stars"
SAMPLE = STARS / "table_6_3_cosines.csv"

COSINES = "x_mm,y_mm,u,v,w\n"
SKY = "# a comment counts as a line\nx_mm,y_mm,ra_deg,dec_deg\n"
GROUND = "x_mm,y_mm,x_m,y_m,z_m\n"
"""Headers of star files: stars by direction cosines, by angles, and ground points."""


def seen_straight(*images: tuple[float, float]) -> str:
    """A star file whose images are exact for the attitude omega, phi, kappa 0 and 76 mm."""
    lines = []
    for x, y in images:
        length = (x * x + y * y + 76.0**2) ** 0.5
        lines.append(",".join(f"{v:.17g}" for v in (x, y, x / length, y / length, -76.0 / length)))
    return COSINES + "\n".join(lines) + "\n"


def solve_text(text: str, *arguments: str) -> Ran:
    """Run `vopd stars solve - --focal 76` with a star file on standard input."""
    return vopd("stars", "solve", "-", "--focal", "76", *arguments, stdin=text)


# Photographs


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
