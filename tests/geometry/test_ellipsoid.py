"""The ellipsoids, with their constants typed in from their definitions, and positions on them."""

from __future__ import annotations

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.geometry.earth import earth_centred, geodetic_latitude
from vopd.geometry.ellipsoids import ELLIPSOIDS, WGS84

DEFINED = {  # equatorial radius, m, polar radius, m, reciprocal of the flattening
    "wgs84": (6378137.0, 6356752.314245, 298.257223563),
    "international1924": (6378388.0, 6356911.946128, 297.0),
    "clarke1866": (6378206.4, 6356583.8, 294.978698214),
}
"""Snyder, Map Projections, a Working Manual, table 1; and for WGS 84 NIMA TR8350.2."""


def test_all_are_here() -> None:
    assert ELLIPSOIDS.keys() == DEFINED.keys()
    labels = ["WGS 84", "International 1924", "Clarke 1866"]
    assert [one.label for one in ELLIPSOIDS.values()] == labels
    assert ELLIPSOIDS["wgs84"] == WGS84


@pytest.mark.parametrize("name", DEFINED)
def test_the_radii_and_the_flattening(name: str) -> None:
    equatorial_m, polar_m, reciprocal = DEFINED[name]
    ellipsoid = ELLIPSOIDS[name]
    assert ellipsoid.radius_km * 1000.0 == equatorial_m
    assert_close("reciprocal of a flattening", 1.0 / ellipsoid.flattening, reciprocal)
    pole = earth_centred(ellipsoid, np.array(np.pi / 2.0), np.array(1.0), np.array(0.0))
    assert_close("radius of an ellipsoid", pole[2] * 1000.0, polar_m)


@pytest.mark.parametrize("name", DEFINED)
def test_latitude_and_back(name: str) -> None:
    """Also at the poles and far from the Earth."""
    latitude = np.radians([-90.0, -45.0, 0.0, 30.0, 89.9999, 90.0])
    position = earth_centred(ELLIPSOIDS[name], latitude, latitude + 1.0, 400.0 * (latitude + 2.0))
    assert_close("latitude and back", geodetic_latitude(ELLIPSOIDS[name], position), latitude)
