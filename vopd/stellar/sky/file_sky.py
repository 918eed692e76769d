"""Directions of a star file's stars: by catalogue and date where these are asked for."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.findings import Finding, Report
from vopd.stellar.directions import star_directions
from vopd.stellar.files.star_file import StarFile
from vopd.stellar.sky.apparent_places import J2000, PlacesOfStars, SkyFrame, apparent_places
from vopd.stellar.sky.sky_request import SkyRequest
from vopd.stellar.sky.star_catalogue import HIPPARCOS_EPOCH, CatalogueStar, read_stars, star_number

NAMES = "name"
"""The kind of a file whose stars are given by name or catalogue number alone."""

EQUATORIAL = ("ra_deg,dec_deg", "ra_hours,dec_deg", NAMES)
LOWEST_DEG = -1.0
"""Altitude below which a star cannot have been photographed."""


UNDATED = (
    "ICRF axes (J2000), stars as the file has them: no proper motion, aberration or refraction"
)
NAMED_UNDATED = (
    "ICRF axes (J2000), stars of the Hipparcos catalogue at 2000.0: no aberration or refraction"
)
DATED = (
    "ICRF axes (J2000), and where it says of date the true equator and equinox of {moment}; "
    "stars of {source}, seen with {effects}"
)
"""What right ascensions and declinations refer to."""


class FileSky(NamedTuple):
    """Directions of a file's stars, and the sky in which they stand.

    Attributes:
        directions: unit vectors in ICRF axes, (n, 3)
        frame: axes of date and place; None where no date is given
        epoch: what right ascensions and declinations of the results refer to
        magnitude: of stars from the catalogue, (n,); None for others
    """

    directions: Floats
    frame: SkyFrame | None
    epoch: str
    magnitude: Floats | None = None


def sky_directions(file: StarFile, sky: SkyRequest, report: Report) -> FileSky:
    """The directions of stars that are given by coordinates or by name.

    Args:
        file: the file, of a kind in EQUATORIAL
        sky: date, place and catalogue
        report: is given warnings of stars below the horizon

    Raises:
        DeckError: a star is not in the catalogue, or a file cannot be read.
        VopdError: a package or a file that is needed is missing.
    """
    magnitude = None
    if file.kind == NAMES:
        stars, magnitude = _from_catalogue(file, sky)
    else:
        ra_deg, dec_deg = file.positions.T
        stars = PlacesOfStars(ra_deg, dec_deg)
    named = file.kind == NAMES
    if sky.utc is None:
        epoch = NAMED_UNDATED if named else UNDATED
        directions = _moved(stars) if named else star_directions(stars.ra_deg, stars.dec_deg)
        return FileSky(directions, None, epoch, magnitude)
    seen = apparent_places(stars, sky)
    if seen.altitude_deg is not None and (seen.altitude_deg < LOWEST_DEG).any():
        report(_below_horizon(file, seen.altitude_deg))
    effects = "aberration and light deflection"
    if seen.frame.pressure_mbar > 0.0:
        effects = "aberration, light deflection and refraction"
    epoch = DATED.format(
        moment=sky.utc.strftime("%Y-%m-%dT%H:%M:%SZ"),
        source="the Hipparcos catalogue" if named else "the file, without proper motion",
        effects=effects,
    )
    return FileSky(seen.directions, seen.frame, epoch, magnitude)


def _below_horizon(file: StarFile, altitude_deg: Floats) -> Finding:
    """A warning about stars that cannot have been seen."""
    below = np.flatnonzero(altitude_deg < LOWEST_DEG).tolist()
    subject = "the star is" if len(below) == 1 else "these stars are up to"
    text = (
        f"{subject} {-altitude_deg.min():.1f} degrees below the horizon at that time and place: "
        "is the date in UTC, is the longitude positive toward east?"
    )
    return file.finding(text, *below).warned()


def _from_catalogue(file: StarFile, sky: SkyRequest) -> tuple[PlacesOfStars, Floats]:
    """Places and magnitudes of the stars of a file that names them."""
    numbers = []
    for k, name in enumerate(file.names):
        number = star_number(name) if name else None
        if number is None:
            text = f"{name!r} is no star's name or Hipparcos number (Betelgeuse, HIP 27989)"
            raise file.error(text, k)
        numbers.append(number)
    found = read_stars(sky.catalogue, numbers)
    for k, number in enumerate(numbers):
        if number not in found:
            raise file.error(f"the catalogue has no star HIP {number}", k)
    rows = np.array([found[number] for number in numbers])
    columns = dict(zip(CatalogueStar._fields, rows.T, strict=True))
    magnitude = columns.pop("magnitude")
    return PlacesOfStars(year=HIPPARCOS_EPOCH, **columns), magnitude


def _moved(stars: PlacesOfStars) -> Floats:
    """Directions at J2000, by proper motion."""
    years = J2000 - stars.year
    dec = np.radians(stars.dec_deg)
    ra_deg = stars.ra_deg + years * stars.ra_mas_per_year / np.cos(dec) / 3.6e6
    return star_directions(ra_deg, stars.dec_deg + years * stars.dec_mas_per_year / 3.6e6)


def needs_no_date(file: StarFile, sky: SkyRequest) -> Finding | None:
    """An error where a date or place is given for a file that has no right ascensions."""
    if file.kind in EQUATORIAL or (sky.utc is None and sky.place is None):
        return None
    return Finding(
        f"a date and a place are for stars by ra and dec or by name, not {file.kind}", file.deck
    )
