"""Star tables in CSV: every column, photographs, dates, and each error with its line."""

from __future__ import annotations

import time
from datetime import UTC, datetime

import numpy as np
import pytest

from vopd.findings import Finding, InputError
from vopd.stellar.files.read import StarFile, read_images_mm, read_star_csv

HEAD = "X_MM, y_mm ,u,v,w"


def read(text: str, *, images_only: bool = False) -> tuple[list[StarFile], list[Finding]]:
    found: list[Finding] = []
    return read_star_csv(text, "a.csv", images_only=images_only, report=found.append), found


def test_every_column() -> None:
    """Names of columns may have capitals; blanks around names, words and numbers mean nothing."""
    head = f"# a comment\n{HEAD},name,image,utc,mag,elongation,sigma_y_mm,rho_xy,sigma_x_mm\n"
    rows = [
        "1,2,.1,.2,.3, Rigel ,night,2020-01-15T21:00:00+01:00, 0.5 ,1.5,.02,-.25,.01",
        "3,4,.4,.5,.6,,night,,, ,.04,.5,.03",
    ]
    (file,), found = read(head + "\n\n".join(rows) + "\n")
    assert found == []
    assert (file.deck, file.photograph, file.line_word) == ("a.csv", "night", "line")
    assert (file.lines, file.names) == ((3, 5), ("Rigel", ""))
    assert (file.unit, file.kind) == ("mm", "u,v,w")
    assert file.image.tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert file.positions.tolist() == [[0.1, 0.2, 0.3], [0.4, 0.5, 0.6]]
    assert file.sigmas is not None
    assert file.sigmas.tolist() == [[0.01, 0.02, -0.25], [0.03, 0.04, 0.5]]
    np.testing.assert_array_equal(file.magnitude, [0.5, np.nan])  # type: ignore[arg-type]
    np.testing.assert_array_equal(file.elongation, [1.5, np.nan])  # type: ignore[arg-type]
    assert file.utc == datetime(2020, 1, 15, 20, tzinfo=UTC)
    pixels = file.pixels
    assert (pixels.first_centre, pixels.y_down) == (0.0, False)
    assert (pixels.field_of_view_deg, pixels.distortion) == (None, 0.0)


def test_columns_that_need_not_be_there() -> None:
    (file,), _ = read(f"{HEAD}\n1,2,0,0,-1\n")
    assert (file.photograph, file.names, file.sigmas, file.utc) == ("", ("",), None, None)
    assert file.magnitude is None and file.elongation is None


@pytest.mark.parametrize(
    ("columns", "cells", "sigmas"),
    [
        ("sigma", ".5", [0.5, 0.5, 0.0]),
        ("sigma_mm", ".5", [0.5, 0.5, 0.0]),
        ("sigma_x_mm,sigma_y_mm", ".5,.25", [0.5, 0.25, 0.0]),
    ],
)
def test_standard_deviations(columns: str, cells: str, sigmas: list[float]) -> None:
    (file,), _ = read(f"{HEAD},{columns}\n1,2,0,0,-1,{cells}\n")
    assert file.sigmas is not None and file.sigmas.tolist() == [sigmas]


def test_photographs_in_the_order_in_which_they_are_named() -> None:
    text = f"{HEAD},image,name\n1,1,0,0,1,b,p\n2,2,0,0,1,a,q\n3,3,0,0,1, b ,r\n4,4,0,0,1,B,s\n"
    files, found = read(text)
    assert [(one.photograph, one.lines, one.names) for one in files] == [
        ("b", (2, 4), ("p", "r")), ("a", (3,), ("q",)), ("B", (5,), ("s",)),
    ]  # fmt: skip
    assert found == []


def test_an_error_of_one_photograph_of_several() -> None:
    """It costs the others nothing; that of the only one ends the reading."""
    rows = f"{HEAD},image\n1,1,0,0,1,a\n2,x,0,0,1,b\n3,3,0,0,1,c\n"
    files, found = read(rows)
    assert [one.photograph for one in files] == ["a", "c"]
    assert found == [Finding("line 3: y_mm: not a number: 'x'", deck="a.csv")]
    with pytest.raises(InputError, match=r"^a\.csv: line 2: y_mm: not a number: 'x'$"):
        read(f"{HEAD},image\n2,x,0,0,1,b\n")


DATES = {  # cells of a column utc: the date
    ("2020-01-15T21:00:00Z",): datetime(2020, 1, 15, 21, tzinfo=UTC),
    ("", "2020-01-15 21:00:00.5", ""): datetime(2020, 1, 15, 21, 0, 0, 500000, tzinfo=UTC),
    ("2020-01-15T21:00:00-05:00", "2020-01-16T02:00:00"): datetime(2020, 1, 16, 2, tzinfo=UTC),
    ("", ""): None,
}


@pytest.mark.parametrize("cells", DATES)
def test_dates(cells: tuple[str, ...]) -> None:
    """Without an offset they are UTC; lines that agree, or have none, are one date."""
    (file,), _ = read(f"{HEAD},utc\n" + "".join(f"1,2,0,0,1,{cell}\n" for cell in cells))
    assert file.utc == DATES[cells]
    assert file.utc is None or file.utc.utcoffset() == UTC.utcoffset(None)


@pytest.mark.skipif(not hasattr(time, "tzset"), reason="no time zone by environment")
def test_a_date_without_an_offset_is_not_that_of_the_machine(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    try:
        monkeypatch.setenv("TZ", "EST5")
        time.tzset()
        (file,), _ = read(f"{HEAD},utc\n1,2,0,0,1,2020-01-15T21:00:00\n")
        assert file.utc == datetime(2020, 1, 15, 21, tzinfo=UTC)
    finally:
        monkeypatch.undo()
        time.tzset()


TWO, MISSING = "utc: one photograph has two dates", "image: the cell is empty: which photograph"
ERRORS = {
    "": "the file has no header: x_mm,y_mm,ra_deg,dec_deg",
    f"# one\n\n{HEAD}\n": "line 3: no star follows the header",
    f"\n{HEAD},u\n": "line 2: the header names a column twice: u",
    f"{HEAD}\n1,2,0,0,1\n\n1,2,0,0\n": "line 4: 4 values, where the header names 5 columns",
    f"{HEAD}\n1,2,0,0,1,\n": "line 2: 6 values, where the header names 5 columns",
    f"{HEAD},image\n1,2,0,0,1,a\n1,2,0,0,1, \n": f"line 3: {MISSING} is the star in?",
    f"{HEAD},utc\n1,2,0,0,1,2020-01-15\n1,2,0,0,1,2020-01-16\n": f"line 3: {TWO}",
    f"{HEAD},utc\n1,2,0,0,1,15.1.2020\n": (
        "line 2: utc: '15.1.2020' is not an ISO 8601 date and time"
    ),
    f"{HEAD},utc\n1,2,0,0,1,0001-01-01T00:00:00+23:00\n": (
        "line 2: utc: '0001-01-01T00:00:00+23:00' is not an ISO 8601 date and time"
    ),
    f"{HEAD},mag\n1,2,0,0,1,\n1,2,0,0,1,bright\n": "line 3: mag: not a number: 'bright'",
}


@pytest.mark.parametrize("text", ERRORS, ids=repr)
def test_errors(text: str) -> None:
    with pytest.raises(InputError) as caught:
        read(text)
    assert str(caught.value) == f"a.csv: {ERRORS[text]}"


def test_columns_that_mean_nothing_are_named() -> None:
    _, found = read(f"\n{HEAD},hue,,size\n1,2,0,0,1,5,,6\n")
    said = "line 2: columns that are ignored: hue, size"
    assert found == [Finding(said, deck="a.csv", severity="warning")]


def test_images_alone() -> None:
    """All lines are one photograph, whatever its columns say; nothing else is read."""
    text = "x_mm,y_mm,image,sigma,hue\n1,2,a,x,7\n3,4,,y,8\n"
    (file,), found = read(text, images_only=True)
    assert (file.photograph, file.kind, file.sigmas, found) == ("", "", None, [])
    assert read_images_mm(text, "a.csv").tolist() == [[1.0, 2.0], [3.0, 4.0]]
    with pytest.raises(InputError, match=r"^a\.csv: the images must be in mm: x_mm,y_mm$"):
        read_images_mm("x_px,y_px\n1,2\n", "a.csv")


def test_images_are_as_many_as_a_photograph_may_have() -> None:
    head, row = "# one\nx_mm,y_mm\n", "1,2\n"
    assert len(read_images_mm(head + 5000 * row)) == 5000
    with pytest.raises(InputError) as caught:
        read_images_mm(head + 5003 * row, "a.csv")
    assert str(caught.value) == "a.csv: line 5003: more than 5000 stars in one photograph"
    whole = read("x_mm,y_mm,image,u,v,w\n" + 2501 * "1,2,a,0,0,1\n" + 2500 * "1,2,b,0,0,1\n")[0]
    assert [len(one.lines) for one in whole] == [2501, 2500]
