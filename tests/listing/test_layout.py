"""The table of lines against fortranformat, which reads the same FORMATs, and the sample page."""

from __future__ import annotations

from pathlib import Path

import fortranformat
import pytest

from vopd.listing.compare import TOLERANCES, tolerance_rows
from vopd.listing.formats import LINES, Field, Line
from vopd.listing.lines import frames_of_lines, recognise_lines

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
