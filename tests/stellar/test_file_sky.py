"""Directions and dates of star files."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import ccsds_ndm
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.command import DECKS, Ran, vopd
from tests.tolerances import assert_close, within
from vopd.findings import Finding, InputError
from vopd.stellar.field import star_directions
from vopd.stellar.files.read import StarFile, file_directions, lines_text
from vopd.stellar.sky import (
    FileSky,
    SkyRequest,
    sky_directions,
)

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


NAMES = ("HIP 123456", "7", "hip8")
ICRF = "ICRF axes (J2000)"


def solve(file: StarFile, sky: SkyRequest) -> tuple[FileSky, list[Finding]]:
    found: list[Finding] = []
    return sky_directions(file, sky, found.append), found


@pytest.mark.parametrize("kind", ["ra_deg,dec_deg", "ra_hours,dec_deg"])
def test_stars_by_coordinates(kind: str) -> None:
    sky, found = solve(star_file(kind), SkyRequest())
    assert_close("rae element", sky.directions, star_directions(SKY[:, 0], SKY[:, 1]))
    said = "stars as the file has them: no proper motion, aberration or refraction"
    assert (sky.epoch, sky.frame, sky.magnitude, found) == (f"{ICRF}, {said}", None, None, [])


def test_stars_by_name(tmp_path: Path) -> None:
    """8.75 years of motion: 35 seconds of arc of a great circle eastward, 70 southward."""
    sky, _ = solve(star_file("name", NAMES), SkyRequest(catalogue=catalogue(tmp_path)))
    east = 35.0 / 3600.0 / np.cos(np.radians(60.0))
    ra, dec = np.array([40.0, 10.0 + east, 20.0]), np.array([50.0, 60.0, -30.0 - 70.0 / 3600.0])
    assert_close("rae element", sky.directions, star_directions(ra, dec))
    assert sky.magnitude is not None and sky.magnitude.tolist() == [6.25, 7.25, 8.25]
    said = "stars of the Hipparcos catalogue at 2000.0: no aberration or refraction"
    assert (sky.epoch, sky.frame) == (f"{ICRF}, {said}", None)


REFUSED = {
    ("7", "Vulcan", "x"): "line 13: 'Vulcan' is no star's name or Hipparcos number "
    "(Betelgeuse, HIP 27989)",
    ("", "7", "8"): "line 12: '' is no star's name or Hipparcos number (Betelgeuse, HIP 27989)",
    ("7", "HIP 8", "99"): "line 14: the catalogue has no star HIP 99",
    ("99", "7", "98"): "line 12: the catalogue has no star HIP 99",
}


@pytest.mark.parametrize("names", REFUSED)
def test_stars_that_are_not_known(names: tuple[str, ...], tmp_path: Path) -> None:
    pytest.importorskip("skyfield")
    with pytest.raises(InputError) as caught:
        solve(star_file("name", names), SkyRequest(catalogue=catalogue(tmp_path)))
    assert str(caught.value) == f"a.csv: {REFUSED[names]}"


ASK = "below the horizon at that time and place: "
ASK += "is the date in UTC, is the longitude positive toward east?"


# Directions of a star file by each kind of position, and how findings name its lines


def star_file_directions(kind: str, positions: list[list[float]], **more: str) -> StarFile:
    count = len(positions)
    lines = tuple(range(11, 11 + count))
    return StarFile(
        "a.csv", lines, ("",) * count, np.zeros((count, 2)), "mm", kind, np.array(positions), **more
    )  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", ["ra_deg,dec_deg", "ra_hours,dec_deg"])
def test_right_ascension_and_declination(kind: str) -> None:
    """Both are in degrees, as they were read."""
    file = star_file_directions(kind, [[0.0, 0.0], [90.0, 0.0], [0.0, 90.0], [180.0, -30.0]])
    expected = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-(0.75**0.5), 0, -0.5]]
    assert_close("rae element", file_directions(file), expected)


def test_ground_points() -> None:
    file = star_file_directions("x_m,y_m,z_m", [[10.0, 20.0, 30.0], [13.0, 24.0, 30.0]])
    camera = np.array([10.0, 20.0, 40.0])
    long = (9.0 + 16.0 + 100.0) ** 0.5
    expected = [[0.0, 0.0, -1.0], [3.0 / long, 4.0 / long, -10.0 / long]]
    assert_close("rae element", file_directions(file, camera), expected)
    with pytest.raises(InputError) as caught:
        file_directions(file)
    assert str(caught.value) == "a.csv: ground points need the camera's position"
    with pytest.raises(InputError) as caught:
        file_directions(file, np.array([13.0, 24.0, 30.0]))
    assert str(caught.value) == "a.csv: line 12: the point is at the camera"


def test_direction_cosines() -> None:
    """Those of length 1 to a millionth are as they are given; others are said, and divided."""
    near = [[0.6, 0.8, 0.99e-3], [0.6, 0.8, 1.4e-3], [0.0, 0.0, 1.0 - 0.99e-6]]
    far = [[0.0, 0.0, 1.0 + 1.01e-6], [0.0, 0.0, 1.0 - 1.01e-6], [0.0, -3.0, 4.0]]
    said: list[Finding] = []
    found = file_directions(star_file_directions("u,v,w", near + far), report=said.append)
    assert found[:3].tolist() == near
    assert_close("rae element", found[3:], [[0, 0, 1], [0, 0, 1], [0, -0.6, 0.8]])
    taken = "and are taken as a direction"
    assert [str(one) for one in said] == [
        f"a.csv: line 14: u, v, w have length 1 {taken}",
        f"a.csv: line 15: u, v, w have length 0.999999 {taken}",
        f"a.csv: line 16: u, v, w have length 5 {taken}",
    ]
    assert {one.severity for one in said} == {"warning"}


def test_direction_cosines_that_are_none() -> None:
    with pytest.raises(InputError) as caught:
        file_directions(star_file_directions("u,v,w", [[0, 0, 1.0], [0, 0, 1e-160], [0, 0, 0]]))
    assert str(caught.value) == "a.csv: line 12: u, v, w have no direction"
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

ORION = DECKS / "stars" / "orion.csv"
PLACE = ("--place", "48,11,500")
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
    result = solve_files("-o", file, *PLACE, text=two_photographs())
    assert result.status == 0, result.stderr
    message = ccsds_ndm.Aem.from_file(str(file))
    message.validate(strict=True)
    (segment,) = message.segments
    assert list(segment.data.attitude_states_epochs) == [FIRST + ".000000", SECOND]
    lines = file.read_text().splitlines()
    assert "REF_FRAME_A = ICRF" in lines and "REF_FRAME_B = SENSOR_1" in lines
    data = lines[lines.index("DATA_START") + 1 : lines.index("DATA_STOP")]
    rows = {row["image"]: row for row in table(*PLACE)}
    for line, name in zip(data, ("early", "late"), strict=True):
        found = Rotation.from_quat([float(part) for part in line.split()[1:]])
        photograph = np.array(rows[name]["matrix"])  # x right, y up, z backward as rows
        camera = np.column_stack([photograph[0], -photograph[1], -photograph[2]])
        assert apart(found, Rotation.from_matrix(camera)) < within("quaternion of ten digits")


def test_an_aem_of_a_vehicle() -> None:
    mounted = solve_files(
        "--format", "aem", *PLACE, "--mount", "down", text=two_photographs()
    ).stdout
    assert "REF_FRAME_B = SC_BODY_1" in mounted


def test_czml_has_the_vehicle_on_the_earth() -> None:
    """Forward, right, down from yaw, pitch, roll and the place, by hand."""
    options = (*PLACE, "--mount", "10,20,30")
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
