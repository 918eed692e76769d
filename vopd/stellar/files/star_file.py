"""What a star file holds: the stars, or ground points, of one photograph and their images."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.findings import DeckError, Finding, Report, strict
from vopd.geometry.vectors import norm
from vopd.stellar.directions import ground_directions, star_directions

MOST_STARS = 5000
"""How many stars or ground points a photograph may have."""

NOT_QUITE_UNIT = 1e-6
"""Error of length up to which direction cosines count as rounded and are taken as given."""


@dataclass(frozen=True)
class PixelFormat:
    """What a file format says about its pixels.

    Attributes:
        first_centre: coordinate of the centre of the first pixel: 0, 1 in FITS, .5 in others
        y_down: whether the format counts y downward, so that nobody need say so
        field_of_view_deg: horizontal field of view that the file states; None: none
        distortion: that of tetra3 at half the width, as a fraction, 0 for none
    """

    first_centre: float = 0.0
    y_down: bool = False
    field_of_view_deg: float | None = None
    distortion: float = 0.0


@dataclass(frozen=True)
class StarFile:
    """One photograph's n stars or ground points.

    Attributes:
        deck: the file's name in messages
        lines: the stars' lines in the file, counted from 1
        names: their names; empty texts where there are none
        image: x, y of their images as the file has them, (n, 2)
        unit: of the images, "mm" or "px"
        kind: a key of `star_columns.KINDS`; "name" where stars are given by name alone, and
            "" for a file of images alone
        positions: right ascension and declination, (n, 2), degrees; direction
            cosines, (n, 3); or coordinates, (n, 3), metres
        photograph: its name, where the file has several; otherwise empty
        sigmas: standard deviations of x and y and their correlation, (n, 3); None: not stated
        magnitude: of the stars, (n,), NaN where unknown; None: no column
        elongation: length over width of the images, (n,), NaN where unknown; None: no column
        utc: when the photograph was taken; None: not stated
        pixels: what the format says about pixels
        line_word: what a line is called in messages
    """

    deck: str
    lines: tuple[int, ...]
    names: tuple[str, ...]
    image: Floats
    unit: str
    kind: str
    positions: Floats
    photograph: str = ""
    sigmas: Floats | None = None
    magnitude: Floats | None = None
    elongation: Floats | None = None
    utc: datetime | None = None
    pixels: PixelFormat = PixelFormat()
    line_word: str = "line"

    def error(self, message: str, *stars: int) -> DeckError:
        """Make an error about some stars (counted from 0) that names their lines."""
        return DeckError(self.finding(message, *stars))

    def finding(self, message: str, *stars: int) -> Finding:
        """Make a finding about some stars (counted from 0) that names their lines.

        A finding about none of them names the photograph, where the file has several.
        """
        where = lines_text([self.lines[k] for k in stars], self.line_word)
        if not where and self.photograph:
            where = f"photograph {self.photograph}"
        return Finding(f"{where}: {message}" if where else message, deck=self.deck)


def file_directions(
    stars: StarFile, camera_m: Floats | None = None, report: Report = strict
) -> Floats:
    """Unit vectors U, V, W of a file's stars or ground points.

    Direction cosines of length 1 to a millionth are taken as given, as the
    listings take them; others are divided by their length, with a warning.

    Args:
        stars: the file
        camera_m: the camera's position, (3,), metres; needed for ground points
        report: takes the warnings

    Returns:
        Unit vectors, (n, 3).

    Raises:
        DeckError: a vector has no length, or a point is at the camera.
    """
    if stars.kind in ("ra_deg,dec_deg", "ra_hours,dec_deg"):
        return star_directions(stars.positions[:, 0], stars.positions[:, 1])
    if stars.kind == "x_m,y_m,z_m":
        if camera_m is None:
            raise DeckError(Finding("ground points need the camera's position", deck=stars.deck))
        directions = ground_directions(stars.positions, camera_m)
        _refuse(stars, ~np.isfinite(directions).all(axis=-1), "the point is at the camera")
        return directions
    length = norm(stars.positions)
    _refuse(stars, length < np.finfo(float).tiny ** 0.5, "u, v, w have no direction")
    rounded = np.abs(length - 1.0) <= NOT_QUITE_UNIT
    for k in np.flatnonzero(~rounded):
        message = f"u, v, w have length {length[k]:.6g} and are taken as a direction"
        report(stars.finding(message, int(k)).warned())
    return stars.positions / np.where(rounded, 1.0, length)[:, None]


def lines_text(lines: list[int], word: str = "line") -> str:
    """Lines in words: `line 3`, `lines 3 and 4`, `lines 3 to 9`."""
    if len(lines) < 2:
        return "".join(f"{word} {n}" for n in lines)
    plural = f"{word}es" if word.endswith("ch") else f"{word}s"
    if len(lines) > 4 and lines == list(range(lines[0], lines[-1] + 1)):
        return f"{plural} {lines[0]} to {lines[-1]}"
    return f"{plural} {', '.join(map(str, lines[:-1]))} and {lines[-1]}"


def _refuse(stars: StarFile, bad: Bools | np.bool_, message: str) -> None:
    """Raise an error about the first star for which something is wrong."""
    if bad.any():
        raise stars.error(message, int(np.argmax(bad)))
