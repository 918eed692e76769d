"""The sky by independent code: apparent places by astropy (ERFA), refraction and lens by hand."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

LATITUDE, LONGITUDE, HEIGHT_M = 48.0, 11.0, 500.0
DATE = "2020-01-15T21:00:00"
PRESSURE, TEMPERATURE = 960.0, -5.0


class Seen(NamedTuple):
    """Stars at DATE: apparent directions in ICRF axes, and true altitude and azimuth, radians."""

    directions: np.ndarray
    altitude: np.ndarray
    azimuth: np.ndarray


def seen(ra_deg: np.ndarray, dec_deg: np.ndarray, **motion: np.ndarray) -> Seen:
    """Apparent places of stars at J2000 with proper motion (mas a year) and parallax (mas)."""
    units = pytest.importorskip("astropy.units")
    coordinates: Any = pytest.importorskip("astropy.coordinates")
    time: Any = pytest.importorskip("astropy.time")
    iers: Any = pytest.importorskip("astropy.utils.iers")
    with iers.conf.set_temp("auto_download", False), iers.conf.set_temp("auto_max_age", None):
        moment = time.Time(DATE, scale="utc")
        place = coordinates.EarthLocation.from_geodetic(
            LONGITUDE * units.deg, LATITUDE * units.deg, HEIGHT_M * units.m
        )
        stars = coordinates.SkyCoord(ra_deg * units.deg, dec_deg * units.deg, frame="icrs")
        if motion:
            mas = units.mas
            stars = coordinates.SkyCoord(
                ra_deg * units.deg,
                dec_deg * units.deg,
                pm_ra_cosdec=motion["pm_ra"] * mas / units.yr,
                pm_dec=motion["pm_dec"] * mas / units.yr,
                distance=coordinates.Distance(parallax=motion["parallax"] * mas),
                obstime=time.Time(1991.25, format="jyear"),
                frame="icrs",
            ).apply_space_motion(moment)
        position, velocity = place.get_gcrs_posvel(moment)
        gcrs = stars.transform_to(
            coordinates.GCRS(obstime=moment, obsgeoloc=position, obsgeovel=velocity)
        )
        directions = gcrs.cartesian.xyz.value.T
        level = stars.transform_to(coordinates.AltAz(obstime=moment, location=place))
    directions = directions / np.linalg.norm(directions, axis=1)[:, None]
    return Seen(directions, level.alt.rad, level.az.rad)


def refraction_deg(apparent_deg: float) -> float:
    """Bennett's formula with the factor for pressure and temperature (Almanac, B)."""
    angle = np.radians(apparent_deg + 7.31 / (apparent_deg + 4.4))
    return float(0.016667 / np.tan(angle) * 0.28 * PRESSURE / (TEMPERATURE + 273.0))


def raised(altitude: np.ndarray) -> np.ndarray:
    """Apparent altitudes, radians, of true ones, by bisection."""
    found = []
    for true_deg in np.degrees(altitude):
        low, high = true_deg, true_deg + 1.0
        for _ in range(60):
            middle = (low + high) / 2.0
            low, high = (
                (middle, high) if middle - refraction_deg(middle) < true_deg else (low, middle)
            )
        found.append(np.radians((low + high) / 2.0))
    return np.array(found)


def east_north_up(altitude: np.ndarray, azimuth: np.ndarray) -> np.ndarray:
    """Unit vectors of horizontal coordinates."""
    flat = np.cos(altitude)
    return np.column_stack([flat * np.sin(azimuth), flat * np.cos(azimuth), np.sin(altitude)])
