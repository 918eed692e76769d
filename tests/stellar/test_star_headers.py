"""Headers of star files: which columns of standard deviations they have, and every refusal."""

from __future__ import annotations

import pytest

from vopd.stellar.files.read import ColumnError, read_columns

SETS = "`ra_deg,dec_deg`, `ra_hours,dec_deg`, `u,v,w`, `x_m,y_m,z_m`"
KIND = f"the header must name one of {SETS}, or name"
MM, PX = "x_mm,y_mm,u,v,w", "x_px,y_px,u,v,w"
BOTH = "sigma_x_mm and sigma_y_mm"

SIGMAS = {  # a header: its columns of standard deviations, in the order in which they are used
    MM: (),
    f"{MM},sigma": ("sigma",),
    f"{MM},sigma_mm": ("sigma_mm",),
    f"{PX},sigma": ("sigma",),
    f"{PX},sigma_px": ("sigma_px",),
    f"sigma_y_mm,sigma_x_mm,{MM}": ("sigma_x_mm", "sigma_y_mm"),
    f"rho_xy,sigma_y_px,{PX},sigma_x_px": ("sigma_x_px", "sigma_y_px", "rho_xy"),
}


@pytest.mark.parametrize("header", SIGMAS)
def test_columns_of_standard_deviations(header: str) -> None:
    """None of them is a column that means nothing."""
    found = read_columns(tuple(header.split(",")), images_only=False)
    assert (found.sigmas, found.ignored) == (SIGMAS[header], ())


KINDS = {
    "ra_deg,dec_deg": "ra_deg,dec_deg",
    "dec_deg,ra_hours": "ra_hours,dec_deg",
    "w,u,v": "u,v,w",
    "z_m,y_m,x_m": "x_m,y_m,z_m",
    "name": "name",
    "name,u,v,w": "u,v,w",
    "name,ra_hours,dec_deg": "ra_hours,dec_deg",
    "name,x_m,y_m,z_m": "x_m,y_m,z_m",
}


@pytest.mark.parametrize("header", KINDS)
def test_the_kind_of_each_set_of_columns(header: str) -> None:
    """A name beside a position is a word about the star; alone it is where the star is."""
    found = read_columns(tuple(f"x_mm,y_mm,{header}".split(",")), images_only=False)
    assert (found.kind, found.ignored) == (KINDS[header], ())


REFUSED = {
    "y_mm,x_mm,u,y_mm,v,w,x_mm": "the header names a column twice: x_mm, y_mm",
    "y_px,u,v,w": "the header must name x_px and y_px: x_px missing",
    "x_mm,u,v,w": "the header must name x_mm and y_mm: y_mm missing",
    "x_px,y_mm": "the header must name x_mm and y_mm, or x_px and y_px, not both",
    "x_mm,y_mm": KIND,
    "x_mm,y_mm,colour": KIND,
    "x_mm,y_mm,ra_deg,ra_hours,dec_deg": KIND,
    "x_mm,y_mm,ra_deg,dec_deg,u,v,w": KIND,
    "x_mm,y_mm,ra_deg,dec_deg,v": KIND,
    "x_mm,y_mm,ra_hours,dec_deg,z_m": KIND,
    "x_mm,y_mm,u,v,w,x_m,y_m,z_m": KIND,
    "x_mm,y_mm,dec_deg,u,v,w": KIND,
    "x_mm,y_mm,dec_deg": "the header lacks ra_deg",
    "x_mm,y_mm,ra_deg": "the header lacks dec_deg",
    "x_mm,y_mm,ra_hours,name": "the header lacks dec_deg",
    "x_mm,y_mm,u": "the header lacks v, w",
    "x_mm,y_mm,y_m": "the header lacks x_m, z_m",
    f"{MM},sigma,sigma_mm": "the header names two standard deviations: sigma, sigma_mm",
    f"{PX},sigma_px,sigma": "the header names two standard deviations: sigma, sigma_px",
    f"{MM},sigma,sigma_x_mm,sigma_y_mm": (
        "the header names two standard deviations: sigma, sigma_x_mm, sigma_y_mm"
    ),
    f"{MM},sigma_mm,sigma_y_mm": ("the header names two standard deviations: sigma_mm, sigma_y_mm"),
    f"{MM},sigma_x_mm": f"the header must name {BOTH}, or neither",
    f"{MM},sigma_y_mm,rho_xy": f"the header must name {BOTH}, or neither",
    f"{MM},rho_xy": f"rho_xy goes with {BOTH}",
    f"{MM},sigma,rho_xy": f"rho_xy goes with {BOTH}",
    f"{MM},sigma_px": "sigma_px: the images are in mm, and so must be their sigmas",
    f"{MM},sigma_x_px,sigma_y_px": "sigma_x_px: the images are in mm, and so must be their sigmas",
    f"{PX},sigma_y_mm": "sigma_y_mm: the images are in px, and so must be their sigmas",
    f"{PX},sigma_mm": "sigma_mm: the images are in px, and so must be their sigmas",
}


@pytest.mark.parametrize("header", REFUSED)
def test_a_header_that_is_refused(header: str) -> None:
    with pytest.raises(ColumnError) as caught:
        read_columns(tuple(header.split(",")), images_only=False)
    assert str(caught.value) == REFUSED[header]


def test_empty_names_are_no_columns() -> None:
    """Spreadsheets write them where a table is wider than its header."""
    found = read_columns(("x_mm", "y_mm", "", "u", "v", "w", "", "hue", "hue 2"), images_only=False)
    assert found.ignored == ("hue", "hue 2")


@pytest.mark.parametrize("rest", ["", ",ra_deg", ",u,x_m", ",sigma,sigma_mm", ",sigma_px,hue"])
def test_images_alone(rest: str) -> None:
    """Nothing is asked of other columns, nor said about them."""
    found = read_columns(tuple(f"x_mm,y_mm{rest}".split(",")), images_only=True)
    assert (found.unit, found.kind, found.sigmas, found.ignored) == ("mm", "", (), ())
