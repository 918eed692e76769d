"""Soundings of the wind: levels, directions, speeds and units of every format, and refusals."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.flight_project import read_text, text_told
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.flight.formats.by_content import read_by_content
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.wind import WIND_FORMATS, from_direction, geometric_m

KNOT = 0.5144444444444445  # 1852 m an hour


def read(text: str) -> Any:
    return read_text(WIND_FORMATS, "w", text)


def told(text: str) -> str:
    return text_told(WIND_FORMATS, "w", text)


def test_wind_blows_from_its_direction() -> None:
    """Toward north and east; a wind from the south-west blows to the north-east."""
    direction = np.array([0.0, 90.0, 180.0, 270.0, 225.0, 360.0])
    toward = from_direction(direction, np.array([1.0, 2.0, 3.0, 4.0, np.sqrt(2.0), 5.0]))
    assert_close("ratio", toward, [[-1, 0], [0, -2], [3, 0], [0, 4], [1, 1], [-5, 0]])


def test_geopotential_metres() -> None:
    """r h / (r - h) with r = 6356766 m: 11000 are 11019.07, 0 is 0, and -100 is -99.998."""
    found = geometric_m(np.array([11_000.0, 0.0, -100.0]))
    assert_close("flight height", found, [11019.07, 0.0, -99.998])


CSV = "h_m,from_deg,{}\n{}\n"


@pytest.mark.parametrize(
    ("column", "unit", "metres"), [("speed_m_s", "m/s", 1.0), ("speed_kt", "knots", KNOT)]
)
def test_levels_of_a_table(column: str, unit: str, metres: float) -> None:
    """In the order of height; of two at one height the first, where they are nearly the same."""
    rows = read(CSV.format(column, "300,90,6\n-5,0,0\n300,100,7\n100,360,2\n50,0,3"))
    assert rows.height_m.tolist() == [-5.0, 50.0, 100.0, 300.0]
    speeds = np.array([[0, 0], [-3, 0], [-2, 0], [0, -6]])
    assert_close("ratio", rows.toward_m_s, metres * speeds)
    assert rows.said == f"w: CSV, {unit}, 4 levels"
    for cells, where in (
        ("9,-1e-9,1", "from_deg"), ("9,360.1,1", "from_deg"), ("9,-90,0", "from_deg"),
        ("9,5,-1e-9", column), ("9,400,-1", column),
    ):  # fmt: skip
        text = CSV.format(column, f"1,0,0\n# x\n{cells}\n9,-5,-5")
        assert_approved(told(text), parts=[where])
    for name in ("h_m", "from_deg", column):
        cells = ",".join("" if one == name else "5" for one in ("h_m", "from_deg", column))
        text = CSV.format(column, f"1,0,0\n{cells}")
        assert_approved(told(text), parts=[name])
    assert_approved(told(CSV.format(column, "1,0,0")))
    assert_approved(told(CSV.format(column, "1,0,0\n1,2,3")))
    assert_approved(told(CSV.format(column, "300,90,6\n5,0,0\n300,180,7")))


def test_columns_of_a_table_of_winds() -> None:
    """Knots stand before metres a second, which may not contradict them."""
    both = read("h_m,from_deg,speed_m_s,speed_kt\n1,0,1.0,2\n2,0,2.04,2\n")
    assert_close("ratio", both.toward_m_s[:, 0], [-2 * KNOT] * 2)
    assert_approved(told("h_m,from_deg,speed_m_s,speed_kt\n1,0,1.0,2\n2,0,2.06,2\n"))
    assert told("h_m,from_deg\n1,2\n").startswith("w: line 1: no column speed_m_s")
    for header in ("h_m,speed_kt", "from_deg,speed_kt"):
        assert told(f"{header}\n1,2\n").startswith("w: the format is not recognised")


# The list of the University of Wyoming


HEAD = "   PRES   HGHT   TEMP   DRCT   {}\n    hPa     m      C    deg   unit\n-----\n"


def line(*cells: Any) -> str:
    return "".join(f"{cell:>7}" for cell in cells) + "\n"


def test_levels_of_a_list() -> None:
    """Blank where nothing was measured; the list ends at the first line of text."""
    body = (
        line(1000, 0, 5, 270, 20) + line(900, "", 5, 90, 9) + line(850, 100, "", "", 9)
        + line(800, 200, 5, 90, "") + line(700, 300, "", 180, 10)
        + "Station information\n\n" + line("K", 400, 5, 0, 5)
    )  # fmt: skip
    for name, unit, metres in (("SKNT", "knots", KNOT), ("SPED", "m/s", 1.0)):
        for before in ("", "72402 Wallops\n<PRE>\n", "x" * 30_000 + "\n"):
            rows = read(before + HEAD.format(name) + body)
            assert_close("flight height", rows.height_m, [0.0, 300.01])
            assert_close("ratio", rows.toward_m_s, metres * np.array([[0, 20], [10, 0]]))
            assert rows.said == f"w: Wyoming text, {unit}, 2 levels"
    assert_approved(told(HEAD.format("SKNT") + "none\n"))
    assert told(HEAD.format("WIND") + body).startswith("w: the format is not recognised")
    first = HEAD.format("SKNT").split("\n")[0] + "\n"
    units = line("hPa", "m", "C", "deg", "knot")
    rows = read(first + units + line(9, 10, 5, 0, 1) + line(8, 20, 5, 0, 1))
    assert_close("flight height", rows.height_m, [10.0, 20.0])


@pytest.mark.parametrize(
    "third",
    [
        line(900, 300, "5,0", 90, 5), " " + line(900, 300, 5, 90, 5),
        line(900, "300 m", 5, 90, 5), "900\t300\t5\t90\t5\n", "Station information\n",
        "Station\n" + HEAD.format("SPED"),
    ],
)  # fmt: skip
def test_a_list_does_not_end_before_its_last_level(third: str) -> None:
    """What stood above a line that cannot be read was left out, and so was a second sounding."""
    body = line(1000, 0, 5, 270, 20) + line(950, 200, 5, 270, 20)
    assert_approved(told(HEAD.format("SPED") + body + third + line(800, 400, 5, 0, 0)))


def test_the_first_and_the_last_level_of_a_list_are_read_or_refused() -> None:
    rows = [line(1000, 0, 5, 270, 20), line(950, 200, 5, 270, 20), line(900, 300, 5, 90, "5 kt")]
    for k in (0, 2):
        assert_approved(told(HEAD.format("SPED") + "".join(rows[k:] + rows[:k])))


LIST = "time,geopotential height_m,wind direction_degree,wind speed_m/s\n"


def test_levels_of_a_csv_list() -> None:
    rows = read(LIST + "x,300,180,10\nx,,90,5\nx,200,,5\nx,250,90,\nx,0,270,20\n")
    assert_close("flight height", rows.height_m, [0.0, 300.01])
    assert_close("ratio", rows.toward_m_s, [[0, 20], [10, 0]])
    assert rows.said == "w: Wyoming CSV, m/s, 2 levels"
    names = ("geopotential height", "wind direction", "wind speed")
    for name, unit in zip(names, ("m", "degree", "m/s"), strict=True):
        text = LIST.replace(f"{name}_{unit}", f"{name}_yard") + "x,300,180,10\n"
        assert told("# y\n" + text) == f"w: line 1: {name} is in yard, {unit} is known"
        part = LIST.replace(f"{name}_{unit}", "other") + "x,1,2,3\n"
        assert told(part).startswith("w: the format is not recognised")
        odd = LIST + "x," + ",".join("y" if one == name else "5" for one in names) + "\n"
        assert_approved(told(odd), parts=[name, unit])
    contrary = "x,50,,5\nx,300,180,10\nx,100,180,9\nx,300,90,10\n"
    assert_approved(told(LIST + contrary))
    longer = LIST.replace("time", "wind speed above_m/s") + "7,300,180,10\n7,0,270,20\n"
    assert_close("ratio", read(longer).toward_m_s, [[0, 20], [10, 0]])


@pytest.mark.parametrize("wind", [(9999, 5), (-90, 5), (361, 5), (90, -1)])
def test_winds_of_a_list_that_are_none(wind: tuple[int, int]) -> None:
    """Numbers that stand for no reading, which a direction takes for one."""
    body = line(1000, 0, 5, 270, 20) + line(900, 300, 5, *wind) + line(800, 400, 5, 0, 0)
    assert_approved(told(HEAD.format("SPED") + body))
    assert_approved(told(LIST + "x,300,180,10\nx,0,{},{}\n".format(*wind)))


def test_a_level_far_below_the_sea_is_none() -> None:
    """-9999 stands for no reading: beta 80 m above the next level was 5 degrees off."""
    assert_approved(told("h_m,from_deg,speed_m_s\n-9999,90,50\n1000,0,5\n"))
    assert_approved(
        told(HEAD.format("SPED") + line(1000, -9999, 5, 270, 20) + line(900, 300, 5, 0, 0))
    )
    low = read("h_m,from_deg,speed_m_s\n-430,90,50\n1000,0,5\n")
    assert low.height_m.tolist() == [-430.0, 1000.0]


@pytest.mark.parametrize("units", ["hPa ft C deg m/s", "hPa m C deg mph", "hPa m C rad m/s"])
def test_units_of_a_list_are_those_that_its_heading_has(units: str) -> None:
    first, _, rule = HEAD.format("SPED").splitlines()
    body = line(1000, 0, 5, 270, 20) + line(900, 300, 5, 90, 5)
    assert_approved(told("\n".join([first, line(*units.split()).rstrip(), rule, body])))
    good = "\n".join([first, line("hPa", "m", "C", "deg", "m/s").rstrip(), rule, body])
    assert len(read(good).height_m) == 2


def test_a_speed_in_another_unit_is_not_called_metres_a_second() -> None:
    for name in ("speed_km_h", "wind_speed_mph", "Speed (km/h)", "kph", "speed"):
        assert_approved(told(f"h_m,from_deg,{name}\n1,0,9\n2,0,9\n"))


def test_a_sounding_of_json_is_none() -> None:
    assert told(json.dumps({"h_m": 1})).startswith("w: the format is not recognised")


@pytest.mark.parametrize(
    "own",
    ["to_deg", "Wind Toward", "wind_direction_to", "direction_to_deg", "dir_to", "blowing to"],
)
def test_where_a_wind_blows_to_is_not_to_be_renamed_as_where_it_comes_from(own: str) -> None:
    text = CSV.format("speed_m_s", "1,90,5").replace("from_deg", own)
    assert_approved(told(text), parts=[own])
    with refused(VopdError, parts=[own]):
        read_by_content(WIND_FORMATS, InputFile("w", Path("w"), text, columns={"from_deg": own}))
