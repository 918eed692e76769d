"""Columns and ranges of the files for viewers and photogrammetry, of estimates made by hand."""

from __future__ import annotations

import csv
import re
from datetime import UTC, datetime

import numpy as np
import pytest

from tests.kit.estimates import estimate
from tests.tolerances import assert_close
from vopd.attitude.history import history
from vopd.estimate import MapGrid
from vopd.export import FORMATS, FileRequest
from vopd.findings import Finding


def text_of(form: str, **changes: object) -> str:
    angles = [[0.5, -60.0, 20.0], [359.5, -30.0, 0.0], [180.0, 45.0, 200.0]]
    one = history(estimate(angles, **changes))
    return FORMATS[form].render([one], FileRequest()).decode()


GRID = MapGrid(
    "EPSG:32632",
    np.array([380100.5, 380177.25, 380253.0]),
    np.array([5201000.0, 5201001.5, 5201003.0]),
    np.array([1.5, -1.25, 200.0]),
)


def test_columns_of_angles_against_the_grid() -> None:
    """Grid azimuth 0.5 - 1.5 is 359; 359.5 + 1.25 is 0.75; 180 - 200 is 340."""
    lines = text_of("opk", grid=GRID).splitlines()
    assert "# x, y: easting and northing, EPSG:32632; h_m: metres above the ellipsoid" in lines[5]
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    assert [row["image"] for row in rows] == [f"DJI_{k:04}.JPG" for k in range(3)]
    for name, expected in {
        "x": GRID.easting, "y": GRID.northing, "h_m": [1200.0] * 3,
        "azimuth_true_deg": [0.5, 359.5, 180.0], "azimuth_grid_deg": [359.0, 0.75, 340.0],
        "convergence_deg": GRID.convergence_deg, "latitude_deg": [46.95] * 3,
        "longitude_deg": [7.44, 7.441, 7.442],
    }.items():  # fmt: skip
        assert_close("ratio", [float(row[name]) for row in rows], expected)


def test_columns_of_angles_without_a_grid() -> None:
    lines = text_of("opk").splitlines()
    assert "# x, y: longitude and latitude, degrees; h_m: metres above the ellipsoid" in lines[5]
    rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    for row in rows:
        assert (row["x"], row["y"]) == (row["longitude_deg"], row["latitude_deg"])
        assert row["azimuth_true_deg"] == row["azimuth_grid_deg"]
        assert row["convergence_deg"] == "0.000000"


@pytest.mark.parametrize(
    ("vehicle", "shown"),
    [
        ((0.0, 0.0, 0.0), "0.000000 0.000000 0.000000"),
        ((350.0, 30.0, 170.0), "350.000000 -30.000000 -170.000000"),
        ((10.0, -30.0, 190.0), "10.000000 30.000000 170.000000"),
        ((10.0, -95.0, 350.0), "10.000000 95.000000 10.000000"),
        ((10.0, 0.0, 180.0), "10.000000 0.000000 -180.000000"),
    ],
)
def test_kml_turns_are_heading_tilt_and_roll_of_a_half_circle(
    vehicle: tuple[float, float, float], shown: str
) -> None:
    """Tilt and roll turn the other way than pitch and roll, from -180 to 180 degrees."""
    one = history(estimate([[10.0, -60.0, 20.0]], vehicle_deg=np.array([vehicle])))
    request = FileRequest(epoch=datetime(2026, 5, 1, tzinfo=UTC))
    text = FORMATS["kml"].render([one], request).decode()
    assert re.findall("<gx:angles>(.*?)</gx:angles>", text) == [shown]


@pytest.mark.parametrize("blank", [" ", "\t", "\u00a0", "\n"])
def test_a_name_that_geo_txt_would_take_for_two_is_left_out(blank: str) -> None:
    names = ("a.jpg", f"b{blank}c.jpg", "d.jpg")
    angles = [[0.5, -60.0, 20.0], [359.5, -30.0, 0.0], [180.0, 45.0, 200.0]]
    said: list[Finding] = []
    one = history(estimate(angles, frame_names=names))
    text = FORMATS["odm"].render([one], FileRequest(), said.append).decode()
    rows = [line.split()[0] for line in text.splitlines()[1:] if not line.startswith("#")]
    assert rows == ["a.jpg", "d.jpg"]
    message = f"{names[1]}: a name in geo.txt has no blank: the frame is left out"
    assert said[0] == Finding(message, "hand.toml", severity="warning")
