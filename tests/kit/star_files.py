"""Star files made in tests, and `vopd stars solve` run on them."""

from __future__ import annotations

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
