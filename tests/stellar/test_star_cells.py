"""Cells of a star file: every way to write an angle, and both sides of every limit."""

from __future__ import annotations

import pytest

from tests.tolerances import assert_close
from vopd.stellar.files.read import ColumnError, read_cell, read_columns

ANGLES = [  # 5 h 12 min 3 s are 78.0125 degrees
    ("ra_hours", "5.2008333333333333", 78.0125),
    ("ra_hours", "5 12 3", 78.0125),
    ("ra_hours", "5:12:3", 78.0125),
    ("ra_hours", "5h12m3s", 78.0125),
    ("ra_hours", "-5h12m3s", -78.0125),
    ("ra_hours", "-0 30 0", -7.5),
    ("ra_hours", "24", 360.0),
    ("ra_deg", "78.0125", 78.0125),
    ("ra_deg", "78 0 45", 78.0125),
    ("ra_deg", "5h12m3s", 78.0125),
    ("dec_deg", "-8.25", -8.25),
    ("dec_deg", "-8 15 0", -8.25),
    ("dec_deg", "-8:15:00", -8.25),
    ("dec_deg", "-8d15m0s", -8.25),
    ("dec_deg", "-0 15 0", -0.25),
    ("dec_deg", "90", 90.0),
    ("x_mm", " -1.5e1 ", -15.0),
]


@pytest.mark.parametrize(("name", "text", "value"), ANGLES)
def test_every_way_to_write_a_cell(name: str, text: str, value: float) -> None:
    assert_close("rae angle", read_cell(text, name), value)


HIGH = "(are right ascension and declination exchanged?)"
REFUSED_ANGLE = "(decimal degrees, or degrees minutes seconds)"
BEYOND = [
    ("ra_hours", "5H12M3S", f"not an angle: '5H12M3S' {REFUSED_ANGLE}"),
    ("dec_deg", "5h12m3s", f"not an angle: '5h12m3s' {REFUSED_ANGLE}"),
    ("x_mm", "nan", "not a number: 'nan'"),
    ("ra_hours", "24.01", "24.01 is beyond +-24 hours (degrees go in column ra_deg)"),
    ("ra_hours", "-24.01", "-24.01 is beyond +-24 hours (degrees go in column ra_deg)"),
    ("ra_deg", "360.01", "360.01 is beyond +-360"),
    ("ra_deg", "-360.01", "-360.01 is beyond +-360"),
    ("dec_deg", "90.01", f"90.01 is beyond +-90 {HIGH}"),
    ("dec_deg", "-90.01", f"-90.01 is beyond +-90 {HIGH}"),
    ("rho_xy", "1", "1 is beyond +-0.999999"),
    ("rho_xy", "-1", "-1 is beyond +-0.999999"),
    ("x_mm", "1.1e12", "1.1e12 is beyond +-1e+12"),
    ("sigma_mm", "0", "0 is not a standard deviation: 1e-09 to 1e+06"),
    ("sigma_mm", "-1", "-1 is not a standard deviation: 1e-09 to 1e+06"),
    ("sigma_mm", "0.9e-9", "0.9e-9 is not a standard deviation: 1e-09 to 1e+06"),
    ("sigma_mm", "1.1e6", "1.1e6 is not a standard deviation: 1e-09 to 1e+06"),
    ("x_mm", " ", "the cell is empty"),
]


@pytest.mark.parametrize(("name", "text", "message"), BEYOND)
def test_beyond_a_limit(name: str, text: str, message: str) -> None:
    with pytest.raises(ColumnError) as caught:
        read_cell(text, name)
    assert str(caught.value) == f"{name}: {message}"


WITHIN = {
    "ra_deg": ("360", "-360"), "ra_hours": ("24", "-24"), "dec_deg": ("90", "-90"),
    "rho_xy": ("0.999999", "-0.999999"), "x_mm": ("1e12", "-1e12"), "sigma_mm": ("1e-9", "1e6"),
}  # fmt: skip


@pytest.mark.parametrize("name", WITHIN)
def test_the_limits_themselves(name: str) -> None:
    scale = 15.0 if name == "ra_hours" else 1.0
    for text in WITHIN[name]:
        assert_close("rae angle", read_cell(text, name) / scale, float(text))


def test_a_comma_for_a_decimal_point_is_named() -> None:
    with pytest.raises(ColumnError, match=r"^x_mm: .*\(with a decimal point, not a comma\)$"):
        read_cell("1,5", "x_mm")


COLUMNS = {  # a header: its unit, its kind and what means nothing in it
    "x_mm,y_mm,ra_deg,dec_deg": ("mm", "ra_deg,dec_deg", ()),
    "x_px,y_px,ra_hours,dec_deg,name,mag": ("px", "ra_hours,dec_deg", ()),
    "u,v,w,x_mm,y_mm,image,utc,elongation": ("mm", "u,v,w", ()),
    "x_mm,y_mm,x_m,y_m,z_m,colour,": ("mm", "x_m,y_m,z_m", ("colour",)),
    "name,x_mm,y_mm": ("mm", "name", ()),
}


@pytest.mark.parametrize("header", COLUMNS)
def test_what_a_header_says(header: str) -> None:
    found = read_columns(tuple(header.split(",")), images_only=False)
    assert (found.unit, found.kind, found.ignored) == COLUMNS[header]
    assert found.image == (f"x_{found.unit}", f"y_{found.unit}")


REFUSED = {
    "x_mm,y_mm,x_mm,u,v,w": "the header names a column twice: x_mm",
    "x_mm,y_px,u,v,w": "the header must name x_mm and y_mm, or x_px and y_px, not both",
    "x_px,u,v,w": "the header must name x_px and y_px: y_px missing",
    "u,v,w": "the header must name x_mm and y_mm (or x_px and y_px): x_mm, y_mm missing",
}


@pytest.mark.parametrize("header", REFUSED)
def test_a_header_that_is_refused(header: str) -> None:
    with pytest.raises(ColumnError) as caught:
        read_columns(tuple(header.split(",")), images_only=False)
    assert str(caught.value) == REFUSED[header]
