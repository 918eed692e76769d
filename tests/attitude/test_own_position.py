"""Where a deck's own coordinates put the vehicle on WGS 84, against geometry written apart."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit import estimates, wgs84_film
from tests.kit.command import CASE_1, vopd
from tests.kit.jobs import case
from tests.kit.wgs84_film import FOOT_M, ecef, enu, geodetic
from tests.tolerances import within
from vopd.attitude.conventions import farthest_from_own_text
from vopd.attitude.history import history
from vopd.errata import fixes
from vopd.film import joined_jobs, position
from vopd.program.vopd import run
from vopd.results import Results

EPOCH = "1974-08-27T17:30:00Z"
CASE_1_IS = "the vehicle is up to 133 m south and 9 m east of where the deck's own coordinates put"


def east_north_m(results: Results, origin_m: float = 0.0) -> np.ndarray:
    """From each position to the deck's own on WGS 84, both at the height of the latter."""
    path, here = results.job.trajectory, position(joined_jobs([results]))
    lon, lat = np.radians([path.origin_longitude_deg, path.origin_latitude_deg])
    origin = ecef(path.origin_latitude_deg, path.origin_longitude_deg, origin_m)
    found = []
    for k, feet in enumerate(results.vehicle_ft):
        own = origin + feet * FOOT_M @ enu(lon, lat)
        there = geodetic(own)
        height_m = float(
            own @ enu(*there)[2] - ecef(*np.degrees(there[::-1]), 0.0) @ enu(*there)[2]
        )
        seen = ecef(here.latitude_deg[k], here.longitude_deg[k], height_m)
        found.append((enu(*there) @ (own - seen))[:2])
    return np.array(found)


@pytest.mark.parametrize("names", [(), ("earth",)], ids=["faithful", "earth"])
def test_the_distance_to_the_deck_s_own_coordinates(names: tuple[str, ...]) -> None:
    """Case 1: 133 m with the Earth of 1974, and nothing with the ellipsoid."""
    results = run(case(1), fixes(*names))
    expected = east_north_m(results)
    found = position(joined_jobs([results])).to_own_m
    assert found is not None
    assert np.abs(found - expected).max() < within("flight height")
    if names:
        assert np.abs(expected).max() < within("flight height")
    else:
        assert expected[0, 1] > 133.0 and expected[0, 0] < -8.0


def test_in_the_south_and_the_east() -> None:
    job, _ = wgs84_film.film(-33.9, 18.4, decimals=None)
    results = run(job)
    found = position(joined_jobs([results])).to_own_m
    assert found is not None
    expected = east_north_m(results, 1200.0 * FOOT_M)
    assert np.abs(found - expected).max() < within("flight height")
    assert (expected[:, 1] < -100.0).all()  # its position is too far north


def text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8").replace("&amp;#x27;", "'").replace("&#x27;", "'")


@pytest.mark.parametrize("suffix", ["csv", "jsonl", "kml", "czml"])
def test_files_say_it_in_metres(suffix: str, tmp_path: Path) -> None:
    plain, fixed = tmp_path / f"plain.{suffix}", tmp_path / f"fixed.{suffix}"
    said = vopd("attitude", CASE_1, "-o", plain, "--epoch", EPOCH).stderr
    assert CASE_1_IS in text_of(plain) and "--fix earth puts it there" in text_of(plain)
    assert (CASE_1_IS in said) == (
        suffix in ("kml", "czml")
    )  # where a viewer shows it on the Earth
    said = vopd("attitude", CASE_1, "-o", fixed, "--epoch", EPOCH, "--fix", "earth").stderr
    assert "own coordinates" not in text_of(fixed) and "own coordinates" not in said


def test_the_farthest_frame_of_all_jobs_counts() -> None:
    def text(*east_north: tuple[float, float]) -> str:
        one = estimates.estimate(np.zeros((len(east_north), 3)))
        here = replace(one.position, to_own_m=np.array(east_north))
        return farthest_from_own_text([history(estimates.estimate(one.camera_deg, position=here))])

    assert_approved(text((0.0, 0.2), (-30.0, 40.0)))
    assert_approved(text((12.0, 0.4), (np.nan, np.nan)))
    assert text((0.9, 0.0)) == text((np.nan, np.nan)) == ""


def test_a_flight_has_no_such_words() -> None:
    assert farthest_from_own_text([history(estimates.estimate(np.zeros((2, 3))))]) == ""


def test_a_spreadsheet_takes_no_part_of_it_for_a_formula() -> None:
    done = vopd("attitude", CASE_1)
    (line,) = [one for one in done.stdout.splitlines() if one.startswith("# position")]
    for cell in (part for row in csv.reader([line], delimiter=";") for part in row):
        assert cell.strip()[0] not in "=+-@'"


def test_json_has_the_sentence_too() -> None:
    done = vopd("attitude", CASE_1, "--format", "jsonl")
    stated = json.loads(done.stdout.splitlines()[0])["conventions"]
    assert CASE_1_IS in stated["position"]
