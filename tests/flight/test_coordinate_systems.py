"""Coordinates to Earth-centred positions: systems, height datums, their errors and their words."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pyproj
import pytest

from tests.approved.texts import assert_approved, refused
from tests.tolerances import assert_close, within
from vopd.findings import VopdError
from vopd.flight.coordinates import (
    HeightDatum,
    _missing_grids,
    crs_is_geographic,
    crs_name,
    earth_centred_positions,
    east_north_m,
    has_height_axis,
    map_grid,
    outside_area,
)
from vopd.geometry.earth import earth_centred_m, local_axes

ELLIPSOID = HeightDatum("ellipsoid")


def positions(
    *rows: list[float], crs: str | None = None, height: Any = ELLIPSOID, geodetic: bool = False
) -> Any:
    return earth_centred_positions(np.array(rows), geodetic, crs, height, "p: [landmarks]")


def told(*rows: list[float], **more: Any) -> str:
    with pytest.raises(VopdError) as refusal:
        positions(*rows, **more)
    return str(refusal.value)


A, B = [16.0, 47.0, 300.0], [-75.0, -37.0, -5.0]
HERE = earth_centred_m([47.0, -37.0], [16.0, -75.0], [300.0, -5.0])


@pytest.mark.parametrize("geodetic", [True, False])
@pytest.mark.parametrize("crs", [None, "EPSG:4326", "WGS84", "WGS 84", " 'WGS 84' ", "EPSG:4258"])
def test_longitude_stands_before_latitude(crs: str | None, geodetic: bool) -> None:
    """ETRS89, EPSG:4258, is WGS 84 within its accuracy."""
    assert_close("flight position", positions(A, B, crs=crs, geodetic=geodetic), HERE)
    above = positions([16.0, 47.0, 255.0], crs=crs, height=HeightDatum("undulation", 45.0))
    assert_close("flight position", above, HERE[:1])
    same = positions(A, crs=crs, height=HeightDatum("same"))
    assert_close("flight position", same, HERE[:1])
    around = positions(A, [285.0, -37.0, -5.0], crs=crs, geodetic=geodetic)
    assert_close("flight position", around, HERE)


def test_metres_are_no_degrees() -> None:
    assert_approved(told([610850.0, 5277733.0, 540.0]))


def test_a_single_place_near_a_grid_s_origin_is_metres_too() -> None:
    """Where all are so near they are degrees, which are refused."""
    near, far = [100.0, 100.0, 0.0], [500_000.0, 5_200_000.0, 30.0]
    assert np.isfinite(positions(near, far, crs="EPSG:32633")).all()
    assert "are degrees and no metres" in told(near, crs="EPSG:32633")


def test_systems_with_heights_of_their_own() -> None:
    """EPSG:4979 is WGS 84 with a height; EPSG:4937 is ETRS89 with one."""
    for crs in ("EPSG:4979", "EPSG:4937"):
        assert_close("flight position", positions(A, B, crs=crs, height=None), HERE)
        assert_approved(told(A, crs=crs))
    for crs in (None, "EPSG:4326", "EPSG:32633"):
        assert_approved(told([16.0, 80.0, 0.0], crs=crs, height=None))


def test_longitudes_beyond_a_turn() -> None:
    assert_approved(told([16.0, 47.0, 300.0], [-360.5, 47.0, 300.0]))


def test_latitudes_beyond_the_poles() -> None:
    poles = positions([0.0, 90.0, 0.0], [0.0, -90.0, 0.0])
    assert_close("flight position", poles[:, 2], [6356752.314245, -6356752.314245])
    for wrong, named in (([47.0, 90.5, 0.0], "90.5"), ([47.0, -95.0, 0.0], "95")):
        said = told(A, wrong, [1.0, 2.0, 3.0])
        assert_approved(said, parts=[named])


def test_a_projected_system() -> None:
    """Zone 33's middle meridian is 15 degrees east: easting 500000, on the equator northing 0."""
    assert_close(
        "flight position", positions([500_000.0, 0.0, 30.0], crs="EPSG:32633"),
        earth_centred_m([0.0], [15.0], [30.0]),
    )  # fmt: skip
    assert_close(
        "flight position", positions([500_000.0, 10_000_000.0, 30.0], crs="WGS84 UTM 33S"),
        earth_centred_m([0.0], [15.0], [30.0]),
    )  # fmt: skip
    assert_approved(told([1.0, 2.0, 3.0], crs="EPSG:32633", geodetic=True))
    said = told([1.0, 2.0, 3.0], crs="EPSG:0")
    assert_approved(said)
    assert "\n" not in said
    assert len(said) <= 300 + len("p: [landmarks]: crs 'EPSG:0' is not known: ")
    own, _, of_proj = told([1e11, 1e11, 0.0], crs="EPSG:32633").partition(" (PROJ: ")
    assert_approved(own)
    assert of_proj.endswith(")")
    assert_approved(told([1.0, 2.0, 3.0], crs="EPSG:5773"))


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("WGS84 UTM 16N", "EPSG:32616"), ("wgs 84 utm 5s", "EPSG:32705"),
        ("WGS84UTM33N", "EPSG:32633"), ("wgs84 utm 33n", "EPSG:32633"),
        ("'WGS84 UTM 1 N'", "EPSG:32601"), ("WGS84 UTM 60S", "EPSG:32760"),
        ("WGS84 UTM 61N", "WGS84 UTM 61N"), ("WGS84 UTM 0N", "WGS84 UTM 0N"),
        (' "EPSG:31256"  ', "EPSG:31256"), ("WGS84 UTM 16X", "WGS84 UTM 16X"),
        ("+proj=utm +zone=3", "+proj=utm +zone=3"),
    ],
)  # fmt: skip
def test_names_of_systems(text: str, name: str) -> None:
    assert crs_name(text) == name


def test_what_a_system_has() -> None:
    names = ["EPSG:4326", "EPSG:4979", "WGS84", "WGS 84", "EPSG:4258", "EPSG:4937", "EPSG:32633",
             "EPSG:25833+5773", "EPSG:4978"]  # fmt: skip
    assert [has_height_axis(name, "") for name in names] == [
        False, True, False, False, False, True, False, True, True,
    ]  # fmt: skip
    assert [crs_is_geographic(name, "") for name in names] == [
        True, True, True, True, True, True, False, False, False,
    ]  # fmt: skip


@pytest.mark.parametrize(
    "datum",
    [
        ELLIPSOID, HeightDatum("egm96"),
        HeightDatum("egm2008"),
        HeightDatum("navd88"),
        HeightDatum("same"),
        HeightDatum("undulation", -37.9),
        HeightDatum("undulation", 45.0),
    ],
)  # fmt: skip
def test_heights_in_words(datum: HeightDatum) -> None:
    assert_approved(datum.said)


def test_where_positions_are_on_a_grid() -> None:
    """Frames without a position have no grid; the convergence is sin(latitude) d(longitude)."""
    position = earth_centred_m([47.0, 0.0, 47.0], [16.0, 15.0, 14.0], [300.0, 0.0, 0.0])
    position[1] = np.nan
    assert map_grid("EPSG:4326", position) is None and map_grid("EPSG:4258", position) is None
    assert map_grid("EPSG:4979", position) is None and map_grid("EPSG:4978", position) is None
    grid = map_grid("EPSG:32633", position)
    assert grid is not None and grid.crs == "EPSG:32633"
    east, north = pyproj.Transformer.from_crs("EPSG:4326", "EPSG:32633").transform(47.0, 16.0)
    assert_close("flight position", grid.easting[[0, 2]], [east, 1e6 - east])
    assert_close("flight position", grid.northing[[0, 2]], [north, north])
    lean = np.degrees(np.arctan(np.tan(np.radians(1.0)) * np.sin(np.radians(47.0))))
    assert_close("convergence of a sphere", grid.convergence_deg[[0, 2]], [lean, -lean])
    for column in (grid.easting, grid.northing, grid.convergence_deg):
        assert np.isnan(column[1]) and column.shape == (3,)


def test_a_grid_counts_from_its_own_datum() -> None:
    """Of Swiss coordinates the origin is defined on Bessel's ellipsoid, and where that lies."""
    longitude, latitude = np.radians([7 + 26 / 60 + 22.5 / 3600, 46 + 57 / 60 + 8.66 / 3600])
    radius_m, flattening, height_m = 6377397.155, 1 / 299.1528128, 550.0
    e2 = flattening * (2.0 - flattening)
    across_m = radius_m / np.sqrt(1.0 - e2 * np.sin(latitude) ** 2)
    level_m = (across_m + height_m) * np.cos(latitude)
    up_m = (across_m * (1.0 - e2) + height_m) * np.sin(latitude)
    centre_m = np.array([674.374, 15.056, 405.346])
    own_m = np.array([level_m * np.cos(longitude), level_m * np.sin(longitude), up_m])
    position = own_m + centre_m
    grid = map_grid("EPSG:21781", position[None])
    assert grid is not None
    assert_close("flight position", [grid.easting[0], grid.northing[0]], [600_000.0, 200_000.0])


@pytest.mark.parametrize(
    ("crs", "latitude", "longitude", "expected_deg", "turn"),
    [
        # Lambert II counts longitudes from Paris, 2.33722917 degrees east, and its cone's sine is
        # that of 52 grads; at the origin of Lo19 and of a grid in feet north is north
        ("EPSG:27572", 46.8, 5.33722917, np.sin(np.radians(46.8)) * 3.0, [[1, 0], [0, 1]]),
        ("EPSG:2048", -33.0, 19.0, 0.0, [[-1, 0], [0, -1]]),
        ("EPSG:5513", 49.5, 24.8333333, 0.0, [[0, -1], [-1, 0]]),
        ("EPSG:2229", 34.0, -118.0, 0.0, [[1200 / 3937, 0], [0, 1200 / 3937]]),
        ("EPSG:3031", -75.0, 40.0, -40.0, [[1, 0], [0, 1]]),
    ],
)
def test_the_north_of_a_grid(
    crs: str, latitude: float, longitude: float, expected_deg: float, turn: list[list[float]]
) -> None:
    """Whatever its meridian, its unit and the way in which its axes count; 50 m are 50 m on it."""
    here = earth_centred_m([latitude], [longitude], [0.0])
    grid = map_grid(crs, here)
    assert grid is not None
    assert_close("convergence of a datum", grid.convergence_deg, [expected_deg])
    x_y = np.array([grid.easting[0], grid.northing[0]])
    level_m, convergence_deg = east_north_m(crs, here)
    assert_close("flight position", level_m, [x_y @ np.array(turn)])
    way = np.radians(convergence_deg[0])
    north = np.array([np.sin(way), np.cos(way), 0.0]) @ local_axes(here)[0]  # of the grid
    moved_m = east_north_m(crs, here + 50.0 * north)[0] - level_m
    assert_close("scale of a grid", moved_m, [[0.0, 50.0]])


@pytest.mark.parametrize(
    ("datum", "vertical"), [("egm96", "5773"), ("egm2008", "3855"), ("navd88", "5703")]
)
def test_a_geoid_goes_through_its_vertical_system(
    datum: str, vertical: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And what is done about a grid that is not there is said; nothing less exact is taken."""
    asked: list[Any] = []

    class Lifted:
        """A transformer that adds 40 m, or has no grid."""

        grid = True

        def transform(self, *lists: list[float], errcheck: bool) -> Any:
            asked.append((lists, errcheck))
            if not self.grid:
                raise pyproj.exceptions.ProjError("no\n Grid a.tif is not available")
            return lists[0], lists[1], [h + 40.0 for h in lists[2]]

    def from_crs(source: Any, target: str, **options: Any) -> Lifted:
        asked.append((source, target, options))
        return Lifted()

    monkeypatch.setattr(pyproj.Transformer, "from_crs", from_crs)
    found = positions([16.0, 47.0, 260.0], height=HeightDatum(datum))
    assert_close("flight position", found, HERE[:1])
    (source, target, options), (lists, errcheck) = asked
    assert source == pyproj.CRS.from_user_input(f"EPSG:4326+{vertical}") and errcheck
    assert (target, lists) == ("EPSG:4979", ([16.0], [47.0], [260.0]))
    assert options == {"always_xy": True, "allow_ballpark": False, "only_best": True}
    asked.clear()
    for crs, height in ((f"EPSG:25833+{vertical}", None), ("EPSG:25833", ELLIPSOID)):
        with pytest.raises(VopdError):  # easting and northing are no longitude and latitude
            positions([16.0, 97.0, 2e2], crs=crs, height=height, geodetic=True)
        positions([16.0, 47.0, 260.0], crs=crs, height=height)
    targets = [one[1] for one in asked if len(one) == 3]
    assert targets == ["EPSG:4979", "EPSG:4326"]
    monkeypatch.setattr(Lifted, "grid", False)
    assert_approved(told([16.0, 47.0, 260.0], height=HeightDatum(datum)), parts=[datum, vertical])
    compound = told([5e5, 5e6, 2e2], crs=f"EPSG:25833+{vertical}", height=None)
    assert_approved(compound, parts=[vertical])
    for crs in ("EPSG:25833", "+proj=utm +zone=33 +ellps=GRS80"):
        assert_approved(told([5e5, 5e6, 2e2], crs=crs))


def test_the_grid_of_a_place_is_named_also_where_proj_names_none() -> None:
    vertical = pyproj.CRS("EPSG:4326+5703")
    america, europe = np.array([[-75.5, 36.5, 10.0]]), np.array([[16.0, 47.0, 10.0]])
    found = _missing_grids("No operation matches", vertical, "EPSG:4979", america)
    assert found and found[0].startswith("us_noaa_")
    assert _missing_grids("No operation matches", vertical, "EPSG:4979", europe) == []
    nowhere = np.array([[1e9, 1e9, 10.0]])
    grid = pyproj.CRS("EPSG:32618+5703")
    assert _missing_grids("No operation matches", grid, "EPSG:4979", nowhere) == []


def test_an_area_of_use_has_a_margin() -> None:
    """UTM zone 33 is used from 12 to 18 degrees east, and a site may lie across its edge."""
    for longitude, latitude, inside in ((18.2, 47, True), (18.3, 47, False), (11.8, 84.2, True),
                                        (15, -0.3, False), (-168, 47, False)):  # fmt: skip
        text = outside_area("EPSG:32633", earth_centred_m([latitude], [longitude], [0.0]))
        assert (text is None) == inside, longitude
    assert outside_area(None, earth_centred_m([89.0], [10.0], [0.0])) is None


def test_without_pyproj_it_is_said_how_to_install_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also for a system that was looked up before."""
    position = earth_centred_m([47.0], [16.0], [300.0])
    positions([500_000.0, 0.0, 30.0], crs="EPSG:32633")
    monkeypatch.setitem(sys.modules, "pyproj", None)
    assert_approved(told([1.0, 2.0, 3.0], crs="EPSG:32633"))
    for action, said in (
        (lambda: crs_is_geographic("EPSG:2056", "w"), "w: the CRS EPSG:2056"),
        (lambda: has_height_axis("EPSG:2056", "w"), "w: the CRS EPSG:2056"),
        (lambda: map_grid("EPSG:2056", position), "crs: the CRS EPSG:2056"),
    ):
        with refused(VopdError, parts=[said]):
            action()
    assert_close("flight position", positions(A, B), HERE)


def test_axes_of_one_s_own_are_a_transverse_mercator_of_their_origin() -> None:
    """300 m east, 400 m north, 20 m up: 500 m away the plane is 500^2 / 2R = .02 m too high."""
    origin = earth_centred_m(32.8, -106.5, 1200.0)
    east_north_up = np.array([300.0, 400.0, 20.0])
    crs = "+proj=tmerc +lat_0=32.8 +lon_0=-106.5 +datum=WGS84"
    found = positions([300.0, 400.0, 1220.0 + 500.0**2 / 2.0 / 6.37e6], crs=crs)
    expected = origin + east_north_up @ local_axes(origin)
    away_m = np.linalg.norm(found[0] - expected)
    # 1,200 m above the ellipsoid a metre of the grid is 1 + 1,200 / 6.37E6 m long
    assert abs(away_m - 500.0 * 1200.0 / 6.37e6) < within("flight height")
