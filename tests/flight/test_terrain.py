"""What the heights of a terrain are counted from: as the landmarks' are, unless its CRS says."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import TOML, write_project
from tests.tolerances import assert_close
from vopd.findings import Finding, VopdError
from vopd.flight.project.keys import read_project
from vopd.flight.project.read import flight_of
from vopd.flight.project.terrain import Terrain, read_terrain
from vopd.geometry.earth import earth_centred_m, geodetic

rasterio = pytest.importorskip("rasterio")
GEOID_M = 40.0


def about(
    folder: Path, crs: str, lower_m: float, of_landmarks: str, unit: str = "", unit_m: float = 1.0
) -> tuple[str, list[Finding]]:
    """What is said of a level terrain so far below the mean landmark, by the numbers of files."""
    counted = f'"landmarks.csv"\nterrain = "terrain.tif"\nheight = {of_landmarks}'
    text = TOML.replace('"landmarks.csv"\nheight = "ellipsoid"', counted)
    assert counted in text
    flight = flight_of(read_project(str(write_project(folder, TOML))))
    place = geodetic(flight.landmarks.position_m)
    west, north = place.longitude_deg.mean() - 0.1, place.latitude_deg.mean() + 0.1
    level = np.full((1, 200, 200), float(np.median(place.height_m)) - lower_m, np.float32)
    level /= unit_m
    with rasterio.open(
        folder / "terrain.tif", "w", driver="GTiff", width=200, height=200, count=1,
        dtype="float32", crs=crs, transform=rasterio.Affine(1e-3, 0.0, west, 0.0, -1e-3, north),
    ) as file:  # fmt: skip
        file.write(level)
        file.units = (unit,) if unit else file.units
    project = read_project(str(write_project(folder, text)))
    terrain = read_terrain(project)
    assert terrain is not None
    marks = flight_of(project).landmarks
    lines, findings = terrain.about(marks, np.arange(len(marks.name)))
    return "\n".join(lines), findings


@pytest.mark.parametrize(("lower_m", "told"), [(109.0, 0), (111.0, 1), (-109.0, 0), (-111.0, 1)])
def test_a_terrain_farther_from_the_landmarks_than_any_geoid(
    lower_m: float, told: int, tmp_path: Path
) -> None:
    assert len(about(tmp_path, "EPSG:4326", lower_m, '"ellipsoid"')[1]) == told


@pytest.mark.parametrize(("high_m", "told"), [(14.9, False), (15.1, True), (-15.1, True)])
def test_a_landmark_that_is_not_on_the_ground(
    high_m: float, told: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Terrain, "_above_of", lambda *_: np.array([3.0] * 5 + [3.0 + high_m]))
    said, _ = about(tmp_path, "EPSG:4326", 7.0, '"ellipsoid"')
    assert ("not on the ground" in said) == told


@pytest.mark.parametrize(
    ("crs", "of_landmarks", "below_m"),
    [
        ("EPSG:4326", '"ellipsoid"', 7.0),
        ("EPSG:4979", '"ellipsoid"', 7.0),
        ("EPSG:4326", f"{{ undulation_m = {GEOID_M} }}", 7.0),
        # above the ellipsoid by itself: the landmarks are so much higher
        ("EPSG:4979", f"{{ undulation_m = {GEOID_M} }}", 7.0 + GEOID_M),
    ],
)
def test_heights_of_a_terrain(crs: str, of_landmarks: str, below_m: float, tmp_path: Path) -> None:
    line, findings = about(tmp_path, crs, 7.0, of_landmarks)
    assert f" {below_m:.1f} m below the landmarks " in line and not findings


@pytest.mark.parametrize("unit", ["ft", "foot", "US survey foot", "us-ft", "International foot"])
def test_a_terrain_that_declares_feet(unit: str, tmp_path: Path) -> None:
    line, findings = about(tmp_path, "EPSG:4326", 7.0, '"ellipsoid"', unit, 0.3048)
    assert " 7.0 m below the landmarks " in line and not findings


@pytest.mark.parametrize("west", [179.9, -180.1, 539.9])
def test_longitudes_of_a_terrain_across_180(west: float, tmp_path: Path) -> None:
    """Cells of .01 degree that rise by a metre each to the east, 20 of them about 180 degrees."""
    path = tmp_path / "terrain.tif"
    with rasterio.open(
        path, "w", driver="GTiff", width=20, height=10, count=1, dtype="float64",
        crs="EPSG:4326", transform=rasterio.Affine(0.01, 0.0, west, 0.0, -0.01, 47.0),
    ) as file:  # fmt: skip
        file.write(np.tile(np.arange(20.0), (1, 10, 1)))
    project = read_project(str(write_project(tmp_path, TOML)))
    with rasterio.open(path) as file:
        terrain = Terrain("terrain.tif", file, project.section("landmarks"))
        found = terrain.heights_m(earth_centred_m([46.955] * 3, [179.965, -179.965, 175.0], 0.0))
    assert_close("height of a terrain", found, [6.0, 13.0, np.nan])


@pytest.mark.parametrize(("code", "unit_m"), [("6360", 1200.0 / 3937.0), ("5703", 1.0)])
def test_slopes_of_a_terrain_whose_crs_counts_heights_in_feet(
    code: str, unit_m: float, tmp_path: Path
) -> None:
    """Cells of 10 m that rise by a metre each to the east: 2 m in 20, in both units."""
    path = tmp_path / "terrain.tif"
    cells = (np.tile(np.arange(20.0), (10, 1)) + 300.0) / unit_m
    with rasterio.open(
        path, "w", driver="GTiff", width=20, height=10, count=1, dtype="float64",
        crs=f"EPSG:32633+{code}", transform=rasterio.Affine(10.0, 0.0, 6e5, 0.0, -10.0, 53e5),
    ) as file:  # fmt: skip
        file.write(cells[None])
    project = read_project(str(write_project(tmp_path, TOML)))
    with rasterio.open(path) as file:
        terrain = Terrain("terrain.tif", file, project.section("landmarks"))
        x, y = rasterio.warp.transform(file.crs, "EPSG:4326", [600055.0, 600075.0], [5299955.0] * 2)
        found = terrain.heights_m(earth_centred_m(y, x, [0.0, 0.0]))
    assert_close("height of a terrain", found, [305.0, 307.0])


@pytest.mark.parametrize(("unit", "doubted"), [("", True), ("ft", False), ("m", False)])
def test_heights_of_no_unit_on_a_grid_in_feet(unit: str, doubted: bool, tmp_path: Path) -> None:
    """New York, Long Island, in US survey feet: the landmarks are moved there."""
    path = tmp_path / "terrain.tif"
    with rasterio.open(
        path, "w", driver="GTiff", width=200, height=200, count=1, dtype="float64",
        crs="EPSG:2263", transform=rasterio.Affine(10.0, 0.0, 9.99e5, 0.0, -10.0, 2.01e5),
    ) as file:  # fmt: skip
        file.write(np.full((1, 200, 200), 10.0))
        file.units = (unit,) if unit else file.units
    project = read_project(str(write_project(tmp_path, TOML)))
    marks = flight_of(project).landmarks
    with rasterio.open(path) as file:
        terrain = Terrain("terrain.tif", file, project.section("landmarks"))
        x, y = rasterio.warp.transform(file.crs, "EPSG:4326", [1e6] * 6, [2e5] * 6)
        _, findings = terrain.about(
            replace(marks, position_m=earth_centred_m(y, x, 10.0)), np.arange(6)
        )
    if doubted:
        assert_approved([one.message for one in findings])
    assert bool(findings) == doubted


def test_heights_above_a_geoid_that_is_not_there_are_not_compared(tmp_path: Path) -> None:
    """EGM96 takes a grid of PROJ's; the shape of the ground does not need it."""
    line, findings = about(tmp_path, "EPSG:4326+5773", 7.0, '"ellipsoid"')
    assert line.endswith("heights are not compared, for want of its geoid") and not findings


@pytest.mark.filterwarnings("ignore:Dataset has no geotransform")
def test_a_coordinate_system_alone_is_no_place(tmp_path: Path) -> None:
    text = TOML.replace('"landmarks.csv"', '"landmarks.csv"\nterrain = "terrain.tif"')
    with rasterio.open(
        tmp_path / "terrain.tif", "w", driver="GTiff", width=20, height=20, count=1,
        dtype="float32", crs="EPSG:4326",
    ) as file:  # fmt: skip
        file.write(np.zeros((1, 20, 20), np.float32))
    with refused(VopdError):
        read_terrain(read_project(str(write_project(tmp_path, text))))
