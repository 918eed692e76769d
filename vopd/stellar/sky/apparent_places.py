"""Apparent places of stars by skyfield: aberration, light deflection, parallax and refraction.

Directions are unit vectors in the axes of the ICRF (those of J2000 to .02 second of
arc): precession and nutation turn only the axes in which they are written.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.findings import DeckError, Finding, VopdError
from vopd.geometry.vectors import transform
from vopd.stellar.sky.sky_request import SkyRequest

REFRACTION_ROUNDS = 30
J2000 = 2000.0
DAYS_PER_YEAR = 365.25
J2000_DAY = 2451545.0


class PlacesOfStars(NamedTuple):
    """Positions and motions of n stars; arrays (n,).

    ICRS right ascension and declination in degrees at a Julian year, proper motion in
    mas a year (that of right ascension times the cosine of the declination), parallax in mas.
    """

    ra_deg: Floats
    dec_deg: Floats
    year: float = J2000
    ra_mas_per_year: Floats | float = 0.0
    dec_mas_per_year: Floats | float = 0.0
    parallax_mas: Floats | float = 0.0


class SkyFrame(NamedTuple):
    """The axes of a date and a place.

    Attributes:
        of_date: from ICRF axes to those of the true equator and equinox of the date, (3, 3)
        local: from ICRF axes to east, north, up, (3, 3); None without a place
        pressure_mbar: of the air; 0 without refraction
    """

    of_date: Floats
    local: Floats | None
    pressure_mbar: float


class ApparentPlaces(NamedTuple):
    """Directions of n stars as they are seen, in ICRF axes, (n, 3), and the axes of date and place.

    `altitude_deg` (n,) is above the horizon, with refraction; None without a place.
    """

    directions: Floats
    altitude_deg: Floats | None
    frame: SkyFrame


def apparent_places(stars: PlacesOfStars, sky: SkyRequest) -> ApparentPlaces:
    """Where stars are seen at a date.

    Args:
        stars: their catalogue positions
        sky: the date, which is needed; the place, without which the observer is at the
            centre of the Earth; and the air

    Raises:
        DeckError: the ephemeris cannot be read, or does not have that date.
        VopdError: skyfield is not installed, or there is no ephemeris.
    """
    api, timescale = _skyfield()
    assert sky.utc is not None
    moment = timescale.from_datetime(sky.utc)
    with _ephemeris(sky.ephemeris) as planets:
        observer = planets["earth"]
        place = None
        if sky.place is not None:
            latitude, longitude, height = sky.place
            place = api.wgs84.latlon(latitude, longitude, elevation_m=height)
            observer = observer + place
        seen = observer.at(moment).observe(_star(api, stars)).apparent()
        directions = np.asarray(seen.position.au / np.linalg.norm(seen.position.au, axis=0)).T
    of_date = np.asarray(moment.M)
    if place is None or sky.place is None:
        return ApparentPlaces(directions, None, SkyFrame(of_date, None, 0.0))
    north_east_up = np.asarray(place.rotation_at(moment))
    local = north_east_up[[1, 0, 2]]
    pressure = sky.pressure_mbar
    if pressure is None:
        pressure = 1010.0 * float(np.exp(-max(sky.place[2], 0.0) / 9.1e3))
    return refracted(directions, SkyFrame(of_date, local, pressure), sky.temperature_c)


def refracted(directions: Floats, frame: SkyFrame, temperature_c: float) -> ApparentPlaces:
    """Raise directions by refraction (Bennett's formula, as skyfield has it).

    Args:
        directions: in ICRF axes, (n, 3)
        frame: the axes of the place, and the pressure
        temperature_c: of the air
    """
    assert frame.local is not None
    east, north, up = transform(frame.local, directions).T
    true_deg = np.degrees(np.arctan2(up, np.hypot(east, north)))
    seen_deg = true_deg
    if frame.pressure_mbar > 0.0:
        from skyfield.earthlib import refraction

        for _ in range(REFRACTION_ROUNDS):
            bent = refraction(seen_deg, temperature_c, frame.pressure_mbar)
            seen_deg = true_deg + bent
    raised, azimuth = np.radians(seen_deg), np.arctan2(east, north)
    horizontal = np.cos(raised)
    seen = np.column_stack(
        [horizontal * np.sin(azimuth), horizontal * np.cos(azimuth), np.sin(raised)]
    )
    return ApparentPlaces(seen @ frame.local, np.asarray(seen_deg), frame)


def _star(api: Any, stars: PlacesOfStars) -> Any:
    count = np.ones(len(stars.ra_deg))
    return api.Star(
        ra_hours=stars.ra_deg / 15.0,
        dec_degrees=np.asarray(stars.dec_deg),
        ra_mas_per_year=stars.ra_mas_per_year * count,
        dec_mas_per_year=stars.dec_mas_per_year * count,
        parallax_mas=stars.parallax_mas * count,
        epoch=J2000_DAY + (stars.year - J2000) * DAYS_PER_YEAR,
    )


def _skyfield() -> tuple[Any, Any]:
    try:
        from skyfield import api
    except ImportError as error:
        raise VopdError("skyfield is not installed: pip install 'vopd[stars]'") from error
    return api, api.load.timescale(builtin=True)


@contextmanager
def _ephemeris(file: str | None) -> Iterator[Any]:
    """An open ephemeris; errors that skyfield raises in its use become errors of its file."""
    from skyfield.errors import EphemerisRangeError
    from skyfield.jpllib import SpiceKernel

    path = _packaged() if file is None else Path(file)
    try:
        planets = SpiceKernel(str(path))
    except OSError as error:
        text = f"cannot be read: {error.strerror or error}"
        raise DeckError(Finding(text, deck=str(path))) from None
    except Exception:  # of jplephem, which has no class of its own for it
        raise DeckError(Finding("not an ephemeris (.bsp)", deck=str(path))) from None
    try:
        yield planets
    except EphemerisRangeError as error:
        raise DeckError(Finding(f"it does not have the date: {error}", deck=str(path))) from None
    except KeyError as error:
        raise DeckError(Finding(f"it does not have {error}", deck=str(path))) from None
    finally:
        planets.close()


def _packaged() -> Path:
    try:
        import skyfield_data
    except ImportError as error:
        raise VopdError("no ephemeris: --ephemeris FILE, or pip install 'vopd[stars]'") from error
    return Path(skyfield_data.__file__).parent / "data" / "de421.bsp"
