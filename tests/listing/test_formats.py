"""Formats of lines, their fields and numbers: by hand and by fortranformat."""

from __future__ import annotations

from pathlib import Path

import fortranformat
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.kit.jobs import film, with_arrays
from vopd.listing.compare import TOLERANCES, tolerance_rows
from vopd.listing.formats import LINES, Field, Line
from vopd.listing.lines import frames_of_lines, recognise_lines
from vopd.listing.pages import listing_text
from vopd.program.vopd import run

# The table of lines, typed in anew: names, quantities, columns, headings and blank lines


COLUMNS = {  # kind of line: name, quantity, first column and last of every field (appendix G)
    "title": "TITLE: text 2-80",
    "frame ignored": "FRAME: frame number 12-15",
    "landmark ignored": "L-MARK: landmark number 1-5",
    "landmark": "L-MARK: landmark number 1-5, LONGITUDE: landmark longitude 8-17, "
    "LAT-GOCN: geocentric latitude 18-27, RAD ER KM: landmark radius 28-37, "
    "LAT-GODT: geodetic latitude 38-47, ALTITUDE-FT: landmark altitude 48-58, "
    "XLAM: direction cosine 59-68, XMU: direction cosine 69-78, XNU: direction cosine 79-88",
    "vehicle": "X: vehicle position 8-17, Y: vehicle position 18-27, Z: vehicle position 28-37, "
    "XPC: frame centre reading 38-47, YPC: frame centre reading 48-57, CC: focal length 58-67",
    "reading": "L-MARK: landmark number 1-4, XCO FINAL: landmark reading 5-19, "
    "YCO FINAL: landmark reading 20-34",
    "film": "L-MARK: landmark number 2-4, X: film coordinate 5-19, Y: film coordinate 20-34, "
    "R DIST: film radius 35-49, DELTA R: lens distortion 50-64",
    "attitude": "FRAME: frame number 1-5, TIME: time 6-14, SIG1: camera yaw 15-23, "
    "SIG2: camera pitch 24-32, SIG3: camera roll 33-41, XP: frame centre 42-48, "
    "YP: frame centre 49-55, PSI: vehicle yaw 56-66, THETA: vehicle pitch 67-77, "
    "PHI: vehicle roll 78-86, ALPHA: angle of attack 87-94, BETA: angle of sideslip 95-102, "
    "ETA: total angle of attack 103-110",
    "residual": "RX(I): residual 3-18, RY(I): residual 19-34, L-MARK: landmark number 35-44",
    "zero residual": "RX(I): residual 1-21, RY(I): residual 22-42",
    "standard deviation": "STANDARD DEVIATION: standard deviation 41-53",
    "table out of order": "POSITION: table position 49-53",
    "table values": ", ".join(
        f"VALUE {k}: table value {15 * k - 13}-{15 * k + 1}" for k in range(1, 9)
    ),
}
DECIMALS = {  # of the fields in order
    "landmark": "0 5 5 3 5 3 7 7 7", "vehicle": "2 2 2 5 5 5", "reading": "0 8 8",
    "film": "0 5 5 5 5", "attitude": "0 3 3 3 3 3 3 3 3 3 3 3 3", "residual": "8 8 0",
    "zero residual": "8 8", "standard deviation": "5", "table values": "8 8 8 8 8 8 8 8",
}  # fmt: skip
TEXTS = {
    "title": "1",
    "frame ignored": "      FRAME    IGNORED BY USERS DIRECTION",
    "landmark heading": " L-MARK LONGITUDE  LAT-GOCN RAD ER KM  LAT-GODT  ALTITUDE-FT    XLAM"
    "       XMU       XNU",
    "landmark ignored": "       IGNORED BY USERS DIRECTION",
    "vehicle heading": "0VEHICLE        X         Y         Z     XPC       YPC      CC",
    "reading heading": "0 L-MARK  XCO FINAL     YCO FINAL",
    "film heading": "0L-MARK        X              Y           R DIST         DELTA R",
    "attitude heading": "0 FRAME   TIME     SIG1     SIG2     SIG3     XP     YP        PSI"
    "      THETA      PHI   ALPHA    BETA     ETA",
    "residual heading": "0 RESIDUALS  RX(I)           RY(I)        L-MARK",
    "end of job": " END OF JOB",
    "standard deviation": "0        STANDARD DEVIATION OF RESIDUALS",
    "end of case": " END OF CASE",
    "table out of order": "1TABLE BELOW OUT OF ORDER FOR FTLUP AT POSITION",
    "table location": " TABLE IS STORED IN LOCATION 000000",
}
BLANK_LINES = {
    "frame ignored": 3, "landmark heading": 1, "zero residual": 2, "end of job": 3, "end of case": 2
}  # fmt: skip
UNDER = {
    "landmark": "landmark heading", "vehicle": "vehicle heading", "reading": "reading heading",
    "film": "film heading", "attitude": "attitude heading", "residual": "residual heading",
    "table values": "table location",
}  # fmt: skip
ABOUT = {
    "frame ignored": "frame number", "landmark ignored": "landmark number",
    "landmark": "landmark number", "reading": "landmark number", "film": "landmark number",
    "attitude": "frame number", "residual": "landmark number",
}  # fmt: skip


def test_the_order_of_a_page() -> None:
    assert list(LINES) == [
        "title", "frame ignored", "landmark heading", "landmark ignored", "landmark",
        "vehicle heading", "vehicle", "reading heading", "reading", "film heading", "film",
        "attitude heading", "attitude", "residual heading", "residual", "zero residual",
        "end of job", "standard deviation", "end of case", "table out of order", "table location",
        "table values",
    ]  # fmt: skip


@pytest.mark.parametrize("name", LINES)
def test_a_kind_of_line(name: str) -> None:
    line = LINES[name]
    fields = [f"{f.name}: {f.quantity} {f.first}-{f.last}" for f in line.fields]
    assert ", ".join(fields) == COLUMNS.get(name, "")
    for field in line.fields:
        assert field.width == field.last - field.first + 1
        assert field.columns == slice(field.first - 1, field.last)
    decimals = [str(field.decimals) for field in line.fields]
    assert decimals == DECIMALS.get(name, " ".join("0" * len(decimals))).split()
    assert (line.name, line.text) == (name, TEXTS.get(name, ""))
    assert line.blank_lines == BLANK_LINES.get(name, 0)
    assert line.under == UNDER.get(name, "")
    assert (line.identity.quantity if line.identity else None) == ABOUT.get(name)


def test_the_gaps_between_fields() -> None:
    """Of columns 1 to 5 and 8 to 9; without a gap between fields that touch or before the first."""
    fields = (Field("a", "time", "I", 1, 5), Field("b", "time", "I", 8, 9))
    line = Line("two", "", fields, ())
    assert [(gap.start, gap.stop) for gap in line.gaps] == [(5, 7), (9, None)]
    touching = (Field("a", "time", "I", 2, 5), Field("b", "time", "I", 6, 9))
    line = Line("two", "", touching, ())
    assert [(gap.start, gap.stop) for gap in line.gaps] == [(0, 1), (9, None)]


# Digits of a printed number: those of C's printf, which rounds the exact value of the double


RESULTS = run(film(1))


def printf(value: float, width: int, decimals: int) -> str:
    """The field without a zero before the point, asterisks where it does not fit."""
    text = f"{value:.{decimals}f}"
    text = text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text
    return text.rjust(width) if len(text) <= width else "*" * width


def half_way(decimals: int) -> st.SearchStrategy[float]:
    """Numbers at, or a few last bits off, the middle between two printed ones."""
    middle = st.integers(-(10**8), 10**8).map(lambda n: (n + 0.5) / 10**decimals)
    return st.tuples(middle, st.integers(-3, 3)).map(
        lambda pair: float(pair[0] + pair[1] * np.spacing(pair[0]))
    )


def numbers(decimals: int) -> st.SearchStrategy[float]:
    binary = st.integers(-(2**30), 2**30).map(lambda n: n / 2**12)  # exact ties among them
    return st.one_of(half_way(decimals), binary, st.floats(-1e7, 1e7), st.floats(-1.0, 1.0))


@given(numbers(2), numbers(5), numbers(8))
def test_as_printf(hundredths: float, five: float, eight: float) -> None:
    """F10.2 and F10.5 of group 2, F15.8 of group 3."""
    points = RESULTS.point_in.copy()
    points[0, 0, 0] = eight
    results = with_arrays(
        RESULTS,
        vehicle_ft=np.array([[hundredths, 0.0, 0.0]]),
        centre_in=np.array([[five, 0.0]]),
        point_in=points,
    )
    found = listing_text(results).split("\n")
    assert found[9][7:17] == printf(hundredths, 10, 2)
    assert found[9][37:47] == printf(five, 10, 5)
    assert found[11][4:19] == printf(eight, 15, 8)


# The table of lines


PAGE = (Path(__file__).parent / "case1_page.lst").read_text(encoding="ascii").splitlines()
FIELDS = [field for line in LINES.values() for field in line.fields]


def value(field: Field, place: int) -> float | int | str:
    if field.descriptor == "A":
        return "TITLE".ljust(field.width)
    return 10 + place if field.descriptor == "I" else 1.5 + place


@pytest.mark.parametrize("line", LINES.values(), ids=list(LINES))
def test_columns_are_those_that_fortran_writes(line: Line) -> None:
    values = [value(field, place) for place, field in enumerate(line.fields)]
    text = fortranformat.FortranRecordWriter(line.format).write(values)
    assert text.startswith("\n" * line.blank_lines)
    text = text.removeprefix("\n" * line.blank_lines).removesuffix("\n")
    assert "\n" not in text and text.strip()
    for field, number in zip(line.fields, values, strict=True):
        letter = field.descriptor
        form = f"{letter}{field.width}" + f".{field.decimals}" * (letter in "FEG")
        scale = "1P" if letter == "E" else ""  # one digit before the point
        alone = fortranformat.FortranRecordWriter(f"({scale}{form})").write([number])
        assert text[field.columns] == alone
        text = text[: field.first - 1] + " " * field.width + text[field.last :]
    assert text.rstrip() == line.text  # what is not a field is the line's own text
    gaps = [text[gap] for gap in line.gaps]
    assert " ".join(gaps).split() == line.text.split()


def test_the_sample_page_is_recognised() -> None:
    kinds = [
        kind.name if kind else "" for kind in recognise_lines([line.rstrip() for line in PAGE])
    ]
    assert kinds == [
        "title", "",
        "landmark heading", *["landmark"] * 3,
        "vehicle heading", "vehicle",
        "reading heading", *["reading"] * 3,
        "film heading", *["film"] * 3,
        "attitude heading", "attitude",
        "residual heading", *["residual"] * 3,
        "standard deviation",
    ]  # fmt: skip


def test_rows_stand_under_their_own_heading() -> None:
    for line in LINES.values():
        if line.under:
            assert LINES[line.under].literals and not LINES[line.under].fields
            assert not line.text


def test_frames_of_a_page_that_holds_several() -> None:
    second = [line.replace("  730 ", "  731 ") for line in PAGE]
    lines = [*PAGE, "", "", "", "      FRAME 777IGNORED BY USERS DIRECTION", *second[2:]]
    lines = [line.rstrip() for line in lines]
    found = frames_of_lines(lines, recognise_lines(lines))
    assert found == [*["730"] * 26, "777", *["731"] * 21]


def test_every_quantity_has_one_tolerance() -> None:
    assert {field.quantity for field in FIELDS} == set(TOLERANCES)
    for quantity in TOLERANCES:
        places = {f.decimals for f in FIELDS if f.quantity == quantity and f.descriptor in "IF"}
        assert len(places) == (0 if quantity in ("text", "table value") else 1)


UNITS = {  # TM X-3050, appendix G, but for the film measures, which are millimetres
    "deg": "landmark longitude, geocentric latitude, geodetic latitude, camera yaw, camera pitch, "
    "camera roll, vehicle yaw, vehicle pitch, vehicle roll, angle of attack, angle of sideslip, "
    "total angle of attack",
    "1000 ft": "landmark radius",
    "ft": "landmark altitude, vehicle position",
    "in": "frame centre reading, landmark reading",
    "mm": "focal length, film coordinate, film radius, lens distortion, frame centre, residual, "
    "standard deviation",
    "s": "time",
    "": "text, landmark number, frame number, direction cosine, table position, table value",
}
EQUAL = ["text", "landmark number", "frame number", "table position"]
CIRCLES = [
    *("camera yaw", "camera pitch", "camera roll", "vehicle yaw", "vehicle pitch", "vehicle roll"),
    *("angle of attack", "angle of sideslip"),
]


def test_the_unit_and_the_circle_of_every_quantity() -> None:
    rows = {name: rest for name, *rest in tolerance_rows() if name != "quantity"}
    expected = {name: unit for unit, names in UNITS.items() for name in names.split(", ")}
    assert {name: unit for name, (unit, *_) in rows.items()} == expected
    assert [name for name, row in rows.items() if row[1] == "equal"] == EQUAL
    assert [name for name, row in rows.items() if row[2]] == CIRCLES
    assert {row[2] for row in rows.values()} == {"", "360"}
    for name, one in TOLERANCES.items():
        assert (one.digits, one.period) == (
            0 if name in EQUAL else 1,
            360 if name in CIRCLES else None,
        )


def test_the_printed_table_of_tolerances() -> None:
    rows = {row[0]: row[1:] for row in tolerance_rows()}
    assert rows["quantity"] == ("unit", "at 1 unit", "modulo", "reason")
    assert len(rows) == 1 + len(TOLERANCES)
    assert rows["camera yaw"][:3] == ("deg", "0.001", "360")  # F9.3
    assert rows["residual"][:3] == ("mm", "0.00000001", "")  # F16.8
    assert rows["landmark number"][:3] == ("", "equal", "")
    assert rows["table value"][:3] == ("", "1 digit", "")  # G15.8 has no fixed places
    assert all(reason for *_, reason in rows.values())
