"""Date and place: apparent places against astropy, catalogue stars, horizon and vehicle."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit import night_sky
from tests.kit.command import DECKS, Ran, vopd
from tests.tolerances import assert_close, within

pytest.importorskip("skyfield")
from vopd.stellar.sky import PlacesOfStars, SkyRequest, apparent_places, read_stars, star_number

ORION = DECKS / "stars" / "orion.csv"
PLACE = (night_sky.LATITUDE, night_sky.LONGITUDE, night_sky.HEIGHT_M)
MOMENT = datetime.fromisoformat(night_sky.DATE).replace(tzinfo=UTC)
DATE = night_sky.DATE + "Z"
AT = ("--date", DATE, "--place", ",".join(map(str, PLACE)))


def arcsec(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Angles between unit vectors."""
    return np.degrees(2.0 * np.arcsin(np.linalg.norm(one - other, axis=1) / 2.0)) * 3600.0


def everywhere() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(3)
    return rng.uniform(0.0, 360.0, 200), np.degrees(np.arcsin(rng.uniform(-1.0, 1.0, 200)))


def test_apparent_places_are_those_of_astropy() -> None:
    """Aberration and light deflection; without them stars would be 20 seconds of arc away."""
    ra, dec = everywhere()
    expected = night_sky.seen(ra, dec)
    sky = SkyRequest(MOMENT, PLACE, pressure_mbar=0.0)
    found = apparent_places(PlacesOfStars(ra, dec), sky)
    assert arcsec(found.directions, expected.directions).max() < within("sky direction")
    moved = arcsec(found.directions, night_sky.east_north_up(np.radians(dec), np.radians(90 - ra)))
    assert 15.0 < np.median(moved) < 21.0
    local = found.frame.local
    assert local is not None
    level = night_sky.east_north_up(expected.altitude, expected.azimuth)
    assert arcsec(found.directions @ local.T, level).max() < within("sky horizon")


def test_refraction_raises_stars() -> None:
    """Against bisection of the formula, for stars above the horizon."""
    ra, dec = everywhere()
    expected = night_sky.seen(ra, dec)
    sky = SkyRequest(MOMENT, PLACE, night_sky.PRESSURE, night_sky.TEMPERATURE)
    found = apparent_places(PlacesOfStars(ra, dec), sky)
    up = expected.altitude > np.radians(3.0)
    assert found.altitude_deg is not None and up.sum() > 50
    raised = np.degrees(night_sky.raised(expected.altitude[up]))
    off = np.abs(found.altitude_deg[up] - raised) * 3600.0
    assert off.max() < within("sky horizon")


def test_catalogue_stars_are_moved_to_the_date() -> None:
    """Barnard's star moves by 10 seconds of arc a year; and parallax is in the catalogue too."""
    numbers = [87937, 32349, 71683, 24436]
    stars = read_stars(None, numbers)
    rows = np.array([stars[number] for number in numbers])
    ra, dec, pm_ra, pm_dec, parallax, _ = rows.T
    expected = night_sky.seen(ra, dec, pm_ra=pm_ra, pm_dec=pm_dec, parallax=parallax)
    places = PlacesOfStars(ra, dec, 1991.25, pm_ra, pm_dec, parallax)
    found = apparent_places(places, SkyRequest(MOMENT, PLACE, pressure_mbar=0.0))
    assert arcsec(found.directions, expected.directions).max() < within("sky moved star")


def test_names_and_numbers_of_stars() -> None:
    assert star_number("Sirius") == star_number("HIP 32349") == star_number("32349") == 32349
    assert star_number("sirius") == 32349 and star_number("no such star") is None
    sirius = read_stars(None, [32349])[32349]
    assert_close("catalogue position", sirius[:2], [101.28854, -16.71314])  # printed edition
    assert_close("catalogue parallax", sirius.parallax_mas, 379.21)  # van Leeuwen (2007)


MAIN = (
    "H|       32349| |06 45 09.25|-16 42 47.3|-1.44| |H|101.28854105|-16.71314306| |"
    " 379.21| -546.01|-1223.08|  1.47|\n"
)


def test_both_editions_of_the_catalogue_are_read(tmp_path: Any) -> None:
    file = tmp_path / "hip_main.dat"
    file.write_text(MAIN)
    star = read_stars(str(file), [32349])[32349]
    assert star.magnitude == -1.44 and star.ra_mas_per_year == -546.01
    assert_close("catalogue position", star[:2], read_stars(None, [32349])[32349][:2])


def solve(*arguments: Any, text: str | None = None) -> Ran:
    given = ["-"] if text is not None else []
    return vopd("stars", "solve", *given, "--focal", "76", *map(str, arguments), stdin=text)


def solved(*arguments: Any, text: str | None = None) -> dict[str, Any]:
    result = solve(*arguments, "--format", "json", text=text)
    assert result.status == 0, result.stderr
    (row,) = json.loads(result.stdout)
    return row  # type: ignore[no-any-return]


def test_the_command_gives_azimuth_elevation_and_the_vehicle() -> None:
    """The matrix times the apparent axes by astropy; a camera that looks forward is the vehicle."""
    row = solved(ORION, *AT, "--mount", "forward")
    axis = -np.array(row["matrix"])[2]
    ra, dec = np.degrees(np.arctan2(axis[1], axis[0])), np.degrees(np.arcsin(axis[2]))
    assert_close("rae angle", [row["ra_deg"], row["dec_deg"]], [ra, dec])
    assert_close("rae angle", row["ra_hours"] * 15.0, ra)
    assert_close("rae angle", row["vehicle_yaw_deg"], row["azimuth_deg"])
    assert_close("rae angle", row["vehicle_pitch_deg"], row["elevation_deg"])
    # precession in right ascension at the equator: 46.1 seconds of arc a year for 20.04 years
    assert abs(row["ra_of_date_deg"] - ra - 46.1 * 20.04 / 3600.0) < within("sky precession")
    down = solved(ORION, *AT, "--mount", "down")
    turned = solved(ORION, *AT, "--mount", "0,-90,0")
    assert_close("rae angle", down["vehicle_pitch_deg"], turned["vehicle_pitch_deg"])


def test_a_vehicle_with_a_mount_by_hand() -> None:
    """A camera level toward north, its top up: mounted by yaw 90 the vehicle heads west."""
    row = solved(ORION, *AT, "--mount", "forward")
    yawed = solved(ORION, *AT, "--mount", "90,0,0")
    body = [
        Rotation.from_euler("ZYX", [one[f"vehicle_{name}_deg"] for name in
                            ("yaw", "pitch", "roll")], degrees=True).as_matrix()
        for one in (row, yawed)
    ]  # fmt: skip
    # the camera's forward, right, down in the body: forward is the body's right
    assert_close("rae element", body[1][:, 1], body[0][:, 0])
    assert_close("rae element", body[1][:, 0], -body[0][:, 1])


def test_the_epoch_is_always_stated() -> None:
    text = solve(ORION).stdout
    assert "right ascension and declination: ICRF axes (J2000), stars as the file has them" in text
    dated = solve(ORION, *AT).stdout
    assert "equinox of 2020-01-15T21:00:00Z" in dated and "and refraction" in dated
    airless = solved(ORION, *AT, "--pressure", "0")["epoch"]
    assert "refraction" not in airless and "aberration" in airless
    cosines = solve(DECKS / "stars" / "table_6_3_cosines.csv").stdout
    assert "the axes of u, v, w" in cosines


def test_stars_below_the_horizon_are_named() -> None:
    result = solve(ORION, "--date", "2020-07-15T21:00:00Z", "--place", "48,11,500")
    assert result.status == 0 and "below the horizon" in result.stderr


def test_stars_by_name() -> None:
    """The eight stars of Orion by name: nearly as by their coordinates, which are for 2000."""
    lines = [line.split(",") for line in ORION.read_text().splitlines() if line[0] != "#"]
    text = "\n".join(",".join([line[0], line[1], line[4]]) for line in lines)
    text = text.replace("Meissa", "HIP 26207")
    row = solved(text=text)
    other = solved(ORION)
    assert abs(row["ra_deg"] - other["ra_deg"]) * 3600.0 < within("rounded catalogue")
    assert "Hipparcos catalogue" in row["epoch"]
    unknown = solve(text="x_mm,y_mm,name\n1,2,Sirius\n3,4,Vulcan\n")
    assert unknown.status == 1 and "line 3: 'Vulcan' is no star's name" in unknown.stderr
    missing = solve(text="x_mm,y_mm,name\n1,2,Sirius\n3,4,HIP 999999\n")
    assert missing.status == 1 and "the catalogue has no star HIP 999999" in missing.stderr


def test_files_that_are_named_are_used(tmp_path: Any) -> None:
    wrong = tmp_path / "wrong"
    wrong.write_text("nothing")
    for option in ("--ephemeris", "--catalogue"):
        for file in (wrong, tmp_path / "missing"):
            text = "x_mm,y_mm,name\n1,2,Sirius\n3,4,Rigel\n"
            result = solve(option, file, "--date", DATE, text=text)
            assert result.status == 1 and str(file) in result.stderr, result.stderr
    early = solve(ORION, "--date", "1700-01-01")
    assert early.status == 1 and "does not have the date" in early.stderr


USAGE = {
    "place": (("--place", "48,11,500"), "--place needs --date"),
    "mount": (("--date", DATE, "--mount", "down"), "--mount needs --place"),
    "date": (("--date", "yesterday"), "is not an ISO 8601"),
    "latitude": (("--date", DATE, "--place", "98,11,0"), "latitude -90 to 90"),
    "pressure": ((*AT, "--pressure", "-5"), "0 to 2000"),
}


@pytest.mark.parametrize("name", USAGE)
def test_wrong_usage(name: str) -> None:
    options, said = USAGE[name]
    result = solve(ORION, *options)
    assert result.status == 2 and said in result.stderr, result.stderr


def test_date_and_place_are_for_stars() -> None:
    ground = DECKS / "stars" / "ground_points.csv"
    result = solve(ground, "--camera", "1000,2000,3000", "--date", DATE)
    assert result.status == 1 and "are for stars" in result.stderr
