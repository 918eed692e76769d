"""Coordinates with too few decimals for the standard deviations that are stated."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.flight_project import TOML, write_project
from vopd.arrays import Floats
from vopd.flight.project.read import read_flight
from vopd.flight.project.stated import doubts_of_rounding

STATED = np.full((6, 3), 0.02)


def places(longitude: int = 9, latitude: int = 9, height: int = 3) -> Floats:
    """Six places near latitude 60, where a degree of longitude is half of one of latitude."""
    k = np.arange(6.0)
    columns = (16.123456789 + k * 7.7e-4, 60.001234567 + k * 3.3e-4, 123.4567 + 11.1 * k)
    decimals = longitude, latitude, height
    return np.stack([np.round(one, d) for one, d in zip(columns, decimals, strict=True)], axis=1)


def test_steps_of_degrees_and_heights() -> None:
    """.00001 degree is 1.1 m of latitude and .56 of longitude; a step has .29 of it as sigma."""
    assert not doubts_of_rounding("track", "t.csv", places(), True, None, STATED)
    assert_approved(doubts_of_rounding("track", "t.csv", places(5, 5), True, None, STATED))
    assert_approved(doubts_of_rounding("track", "t.csv", places(height=0), True, None, STATED))
    degrees = places(5, 5, 0)
    assert_approved(doubts_of_rounding("track", "t.csv", degrees, False, "EPSG:4326", STATED))


@pytest.mark.parametrize(("sigma_m", "told"), [(0.14, True), (0.15, False), (0.0, False)])
def test_twice_what_is_stated_is_told_and_exact_numbers_never(sigma_m: float, told: bool) -> None:
    """Whole metres have a standard deviation of .289 m."""
    stated = np.full((6, 3), sigma_m)
    found = doubts_of_rounding("landmarks", "m.csv", places(height=0), True, None, stated)
    assert bool(found) == told


def test_metres_and_feet_of_a_grid() -> None:
    """Whole US survey feet are .3048006 m, and heights in whole feet were read as metres."""
    whole = np.round(places() * [1e4, 1e5, 1.0])
    assert_approved(doubts_of_rounding("landmarks", "m.csv", whole, False, "EPSG:32633", STATED))
    assert_approved(doubts_of_rounding("landmarks", "m.csv", whole, False, "EPSG:2229", STATED))
    tenths = places(height=1) * [1e4, 1e5, 1.0]  # of a foot: 9 mm
    crs, stated = "+proj=utm +zone=33 +datum=WGS84 +vunits=us-ft", STATED / 2.0
    assert not doubts_of_rounding("landmarks", "m.csv", tenths, False, crs, stated)
    feet = places()
    feet[:, 2] = np.round(feet[:, 2]) * 0.3048
    assert_approved(doubts_of_rounding("track", "t.csv", feet, True, None, STATED))


def test_four_different_heights_in_whole_metres_may_be_so() -> None:
    few = places()
    few[:, 2] = [310.0, 311.0, 312.0, 313.0, 311.0, 312.0]
    assert not doubts_of_rounding("landmarks", "m.csv", few, True, None, STATED)
    few[5, 2] = 314.0
    assert doubts_of_rounding("landmarks", "m.csv", few, True, None, STATED)


@pytest.mark.parametrize("section", ["landmarks", "track"])
def test_a_flight_is_warned(tmp_path: Path, section: str) -> None:
    path = write_project(tmp_path, TOML)
    text = path.read_text()
    before, name, rest = text.partition(f"[{section}]")
    rest = rest.replace('sigma_m = "exact"', "sigma_m = 0.02", 1)
    path.write_text(before + name + rest)
    table = path.parent / f"{section}.csv"
    head, *rows = table.read_text().splitlines()
    if section == "track":  # four positions, which may be so by themselves
        rows += [f"{5 + k}.0,{47.65 + k * 1e-4:.12f},16.4759,545.5" for k in range(2)]
    k = head.split(",").index("lat_deg")
    cells = [row.split(",") for row in rows]
    for row in cells:
        row[k] = f"{float(row[k]):.5f}"
    assert not read_flight(str(path)).findings
    table.write_text("\n".join([head, *(",".join(row) for row in cells)]) + "\n")
    assert_approved([one.message for one in read_flight(str(path)).findings])
