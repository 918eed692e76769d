"""The ellipsoids that stand for the Earth: sizes and shapes, read without numpy."""

from __future__ import annotations

from typing import NamedTuple


class Ellipsoid(NamedTuple):
    """The size and shape of an ellipsoid: equatorial radius in km, and flattening."""

    label: str
    radius_km: float
    flattening: float


ELLIPSOIDS = {
    "wgs84": Ellipsoid("WGS 84", 6378.137, 1 / 298.257223563),
    "international1924": Ellipsoid("International 1924", 6378.388, 1 / 297.0),
    "clarke1866": Ellipsoid("Clarke 1866", 6378.2064, 1 - 6356.5838 / 6378.2064),
}
"""The ellipsoids that a run can be given, by the names that the command line takes."""

WGS84 = ELLIPSOIDS["wgs84"]
