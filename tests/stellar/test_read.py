"""Star files: header, cells, rows and texts."""

from __future__ import annotations

import csv
import io
import json
import os
import re
import sys
import threading
import time
import warnings
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved, refused
from tests.kit.command import DECKS, Ran, vopd
from tests.kit.stars import HEAD as HEAD_FILES
from tests.kit.stars import photograph, written
from tests.tolerances import assert_close
from vopd.findings import Finding, InputError, VopdError
from vopd.stellar.files.images import (
    ImageAxes,
    MissingOption,
    centred_images,
    in_file_coordinates,
    outside_image,
)
from vopd.stellar.files.photograph import read_photographs
from vopd.stellar.files.plate_solvers import read_corr_fits, read_plate_solutions
from vopd.stellar.files.read import (
    ColumnError,
    PixelFormat,
    StarFile,
    decoded_text,
    read_bytes,
    read_cell,
    read_columns,
    read_images_mm,
    read_rows,
    read_star_csv,
    read_text,
)

# The formats of star files: pixels, other separators, several photographs, plate solvers


ORION = DECKS / "stars" / "orion.csv"
ANGLES = ("omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg", "swing_deg")
PITCH_UM, SIZE = 5.0, (6000, 4000)


def orion() -> list[dict[str, str]]:
    lines = [line for line in ORION.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def solve(*arguments: str | Path, text: str | bytes | None = None) -> Ran:
    given = ["-"] if text is not None else []
    return vopd("stars", "solve", *given, *arguments, "--format", "json", stdin=text)


def solved(*arguments: str | Path, text: str | bytes | None = None) -> list[dict[str, Any]]:
    result = solve(*arguments, text=text)
    assert result.status == 0, result.stderr
    return json.loads(result.stdout)  # type: ignore[no-any-return]


def in_pixels(separator: str = ",", head: str = "x_px,y_px,ra_deg,dec_deg,name") -> str:
    """Orion with y downward from the middle of the first of 6000 by 4000 pixels of 5 um."""
    rows = [head.replace(",", separator)]
    for star in orion():
        x = float(star["x_mm"]) * 1000.0 / PITCH_UM + (SIZE[0] - 1) / 2
        y = -float(star["y_mm"]) * 1000.0 / PITCH_UM + (SIZE[1] - 1) / 2
        rows.append(separator.join([f"{x}", f"{y}", star["ra_deg"], star["dec_deg"], star["name"]]))
    return "\n".join(rows) + "\n"


SCALES = {
    "pitch and size": ("--focal", "76", "--pitch-um", "5", "--size", "6000x4000"),
    "pixels and centre": ("--focal-px", "15200", "--centre", "2999.5,1999.5"),
}


@pytest.mark.parametrize("size", [None, (6000, 4000), (4200, 4700)])
def test_stars_outside_the_image_are_named(size: tuple[int, int] | None) -> None:
    """Of the eight of Orion some have negative coordinates, as their camera's film was larger."""
    text = in_pixels()
    image = [[*map(float, line.split(",")[:2])] for line in text.splitlines()[1:]]
    given = () if size is None else ("--size", f"{size[0]}x{size[1]}")
    done = solve("--focal-px", "15200", "--centre", "2999.5,1999.5", *given, "--y-down", text=text)
    assert done.status == 0
    wide, high = size or (np.inf, np.inf)
    out = [k for k, (x, y) in enumerate(image, 2) if y < -0.5 or x > wide - 0.5 or y > high - 0.5]
    named = [line for line in done.stderr.splitlines() if "outside" in line]
    assert len(named) == (size is not None)
    for line in named:
        assert [
            *map(int, re.findall(r"\d+", line.partition(":")[2].partition(": outside")[0]))
        ] == out


@pytest.mark.parametrize("scale", SCALES)
def test_pixels_give_what_millimetres_give(scale: str) -> None:
    (mm,) = solved(ORION, "--focal", "76")
    (px,) = solved(*SCALES[scale], "--y-down", text=in_pixels())
    assert_close("rae angle", [px[name] for name in ANGLES], [mm[name] for name in ANGLES])
    assert_close("rae angle", px["rms_px"] * PITCH_UM / 1000.0, mm["rms_mm"])
    assert "rms_mm" not in px and np.shape(px["residuals_px"]) == (8, 2)


@pytest.mark.parametrize("separator", [";", "\t"])
def test_semicolons_and_tabs(separator: str) -> None:
    scale = (*SCALES["pitch and size"], "--y-down")
    assert solved(*scale, text=in_pixels(separator)) == solved(*scale, text=in_pixels())


def two_photographs(bad: str = "") -> str:
    """Orion twice, under two names, line by line by turns; a bad cell in the second."""
    lines = ["image,x_mm,y_mm,ra_deg,dec_deg"]
    for k, star in enumerate(orion()):
        cells = [star[name] for name in ("x_mm", "y_mm", "ra_deg", "dec_deg")]
        lines.append(",".join(["first", *cells]))
        lines.append(
            ",".join(["second", *cells[:2], bad if bad and k == 3 else cells[2], cells[3]])
        )
    return "\n".join(lines) + "\n"


def test_several_photographs_in_one_file() -> None:
    (alone,) = solved(ORION, "--focal", "76")
    del alone["names"], alone["picture"]
    rows = solved("--focal", "76", text=two_photographs())
    assert [row.pop("picture")["odd"] for row in rows] == [[], []]
    assert [row.pop("image") for row in rows] == ["first", "second"]
    assert rows == [alone, alone]
    text = vopd("stars", "solve", "-", "--focal", "76", stdin=two_photographs()).stdout
    assert "image   method " in text.splitlines()[0]
    heads = [line.split()[0] for line in text.splitlines()[:4]]
    assert heads == ["image", "deg", "first", "second"]
    page = vopd("stars", "solve", "-", "--focal", "76", "--format", "csv", stdin=two_photographs())
    assert [row["image"] for row in csv.DictReader(io.StringIO(page.stdout))] == ["first", "second"]


def test_corr_fits_of_astrometry_net(tmp_path: Path) -> None:
    """The columns that `write_corr_file` of solver/onefield.c writes; FITS counts from 1."""
    fits = pytest.importorskip("astropy.io.fits")
    scale = (*SCALES["pitch and size"], "--y-down")
    (expected,) = solved(*scale, text=in_pixels())
    stars = [line.split(",") for line in in_pixels().splitlines()[1:]]
    columns = {
        "field_x": [float(star[0]) + 1.0 for star in stars],
        "field_y": [float(star[1]) + 1.0 for star in stars],
        "field_ra": [0.0] * 8,
        "field_dec": [0.0] * 8,
        "index_x": [0.0] * 8,
        "index_y": [0.0] * 8,
        "index_ra": [degrees(star[2], 15.0) for star in stars],
        "index_dec": [degrees(star[3], 1.0) for star in stars],
        "match_weight": [1.0] * 8,
    }
    file = tmp_path / "corr.fits"
    table = [fits.Column(name, "D", array=np.array(data)) for name, data in columns.items()]
    fits.BinTableHDU.from_columns(table).writeto(file)
    (found,) = solved(file, *scale)
    assert_close("rae angle", [found[k] for k in ANGLES], [expected[k] for k in ANGLES])
    for name, row, value in (
        ("index_dec", 2, 90.1),
        ("index_dec", 0, -91.0),
        ("field_x", 5, np.nan),
    ):
        columns[name], right = list(columns[name]), columns[name]
        columns[name][row] = value
        bad = tmp_path / "bad.fits"
        changed = [fits.Column(one, "D", array=np.array(data)) for one, data in columns.items()]
        fits.BinTableHDU.from_columns(changed).writeto(bad, overwrite=True)
        assert_approved(solve(bad, *scale).stderr, parts=[row + 1])
        columns[name] = right
    cut = tmp_path / "cut.fits"
    cut.write_bytes(file.read_bytes()[:100])
    assert_approved(solve(cut, *scale).stderr, others_after="can be read: ")
    wrong = tmp_path / "xylist.fits"
    fits.BinTableHDU.from_columns(table[:2]).writeto(wrong)
    assert "no table with the columns field_x" in solve(wrong, *scale).stderr


def degrees(text: str, unit: float) -> float:
    """`5h55m10.31s` or `-8 12 05.9` by hand."""
    whole, minutes, seconds = text.replace("h", " ").replace("m", " ").replace("s", "").split()
    size = abs(float(whole)) + float(minutes) / 60.0 + float(seconds) / 3600.0
    return unit * (-size if whole.startswith("-") else size)


RA, DEC, ROLL, FOV = 123.0, 34.0, 20.0, 12.0
WIDTH, HEIGHT = 1024, 768


def plate_solution(distortion: float = 0.0) -> dict[str, Any]:
    """What tetra3 returns, by its documented conventions; roll: north counter-clockwise from up."""
    rng = np.random.default_rng(3)
    up, left = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])  # x looks at RA 0, Dec 0
    look = Rotation.from_euler("ZYX", [RA, -DEC, ROLL], degrees=True)
    focal = WIDTH / 2.0 / np.tan(np.radians(FOV / 2.0))
    centroids, stars = [], []
    for y, x in rng.uniform([20.0, 20.0], [HEIGHT - 20.0, WIDTH - 20.0], (12, 2)):
        offset = np.array([y - HEIGHT / 2.0, x - WIDTH / 2.0])
        far = np.hypot(*offset) * 2.0 / WIDTH
        straight = far
        if distortion:  # r_u = r_d (1 - k r_d**2) / (1 - k), radii over half the width
            straight = brentq(
                lambda r, far=far: r * (1.0 - distortion) - far * (1.0 - distortion * far**2), 0, 9
            )
        offset *= straight / far
        ray = np.array([focal, 0.0, 0.0]) - offset[0] * up - offset[1] * left
        u, v, w = look.apply(ray / np.linalg.norm(ray))
        stars.append([np.degrees(np.arctan2(v, u)) % 360.0, np.degrees(np.arcsin(w)), 4.5])
        centroids.append([y, x])
    return {
        "RA": RA, "Dec": DEC, "Roll": ROLL, "FOV": FOV, "distortion": distortion,
        "matched_centroids": centroids, "matched_stars": stars,
        "matched_catID": list(range(100, 112)),
    }  # fmt: skip


@pytest.mark.parametrize("distortion", [0.0, -0.03])
def test_a_plate_solution_of_tetra3(distortion: float) -> None:
    (row,) = solved("--size", "1024,768", text=json.dumps(plate_solution(distortion)))
    found = [row["alpha_deg"], row["delta_deg"], -row["swing_deg"]]
    assert_close("rae angle", found, [RA, DEC, ROLL])
    assert_close("residual", row["residuals_px"], np.zeros((12, 2)))


def test_several_plate_solutions_and_one_without_a_match() -> None:
    good = plate_solution()
    none = {"RA": None, "Dec": None, "Roll": None, "FOV": None, "status": 2}
    for text in (json.dumps([good, none, good]), "\n".join(map(json.dumps, [good, none, good]))):
        result = solve("--size", "1024,768", text=text)
        assert result.status == 1 and "photograph 2: no matched_centroids" in result.stderr
        assert [row["image"] for row in json.loads(result.stdout)] == ["1", "3"]


# Headers of star files: which columns of standard deviations they have, and every refusal


MM, PX = "x_mm,y_mm,u,v,w", "x_px,y_px,u,v,w"

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
    "mag": "",
}


@pytest.mark.parametrize("header", KINDS)
def test_the_kind_of_each_set_of_columns(header: str) -> None:
    """A name beside a position is a word about the star; alone it is where the star is."""
    found = read_columns(tuple(f"x_mm,y_mm,{header}".split(",")), images_only=False)
    assert (found.kind, found.ignored) == (KINDS[header], ())


RENAMED = {  # a header: its columns, and what is said
    "x,y,ra,dec": (
        "x_px,y_px,ra_deg,dec_deg",
        "x, y, ra, dec read as x_px, y_px, ra_deg, dec_deg; "
        "if they are mm, name them x_mm, y_mm; if ra is hours, name it ra_hours",
    ),
    "x,y,name": (
        "x_px,y_px,name",
        "x, y read as x_px, y_px; if they are mm, name them x_mm, y_mm",
    ),
    "x_mm,y_mm,ra_h,dec": ("x_mm,y_mm,ra_hours,dec_deg", "ra_h, dec read as ra_hours, dec_deg"),
    "x_mm,y_mm,ra,dec_deg": (
        "x_mm,y_mm,ra_deg,dec_deg",
        "ra read as ra_deg; if ra is hours, name it ra_hours",
    ),
    "x_mm,y_mm,_raj2000,_dej2000,raj2000,dej2000": (
        "x_mm,y_mm,_raj2000,_dej2000,ra_deg,dec_deg",
        "raj2000, dej2000 read as ra_deg, dec_deg",
    ),
    "ra_icrs,de_icrs,x_mm,y_mm": (
        "ra_deg,dec_deg,x_mm,y_mm",
        "ra_icrs, de_icrs read as ra_deg, dec_deg",
    ),
    "x_mm,y_mm,ra_deg,dec_deg,raj2000,dej2000": (
        "x_mm,y_mm,ra_deg,dec_deg,raj2000,dej2000",
        "",
    ),
    "x_mm,y_mm,u,v,w,ra,dec": ("x_mm,y_mm,u,v,w,ra,dec", ""),
    "x_mm,y_mm,x_m,y_m,z_m,ra,dec": ("x_mm,y_mm,x_m,y_m,z_m,ra,dec", ""),
    "id,xcentroid,ycentroid,mag": ("id,x_px,y_px,mag", "xcentroid, ycentroid read as x_px, y_px"),
    "x_px,y_px,name,x,y,dec": ("x_px,y_px,name,x,y,dec", ""),
    "hip,x_px,y_px": ("name,x_px,y_px", "hip read as name"),
    "x,x_mm,y_mm,hip": ("x,x_mm,y_mm,name", "hip read as name"),
    "x_mm,y_mm,ra,ra_hours,dec_deg": ("x_mm,y_mm,ra,ra_hours,dec_deg", ""),
}


@pytest.mark.parametrize("header", RENAMED)
def test_other_names_of_columns(header: str) -> None:
    found = read_columns(tuple(header.split(",")), images_only=False)
    assert (",".join(found.names), found.read_as) == RENAMED[header]


@pytest.mark.parametrize(
    ("cell", "name"), [("5:12:3.4", "ra_hours"), ("05 12 3", "ra_hours"), ("78.1", "ra_deg"),
                       ("5h12m3s", "ra_deg"), ("+5 12 3", "ra_hours")],
)  # fmt: skip
def test_a_right_ascension_of_no_unit(cell: str, name: str) -> None:
    """Catalogues write hours, minutes and seconds; `h` says so itself."""
    header = ("ra", "dec", "x_px", "y_px")
    found = read_columns(header, images_only=False, first=[cell, "1", "2", "3"])
    assert found.names[0] == name


def test_a_right_ascension_of_vizier_may_be_hours() -> None:
    header = ("x_px", "raj2000", "y_px", "dej2000")
    found = read_columns(header, images_only=False, first=["1", "05 12 3", "2", "-08 12 6"])
    assert found.names == ("x_px", "ra_hours", "y_px", "dec_deg")


@pytest.mark.parametrize("column", ["ra", "raj2000"])
def test_right_ascensions_of_two_units_in_a_column_are_refused(column: str) -> None:
    """5 hours 12 minutes is 78 degrees; of a column ra_deg it would be 5.2."""
    rows = "1,1,78.2,10\n2,2,{},11\n3,3,79.3,12\n"
    head, stated = (f"x_mm,y_mm,{name},dec\n" for name in (column, "ra_deg"))
    with refused(InputError):
        read(head + rows.format("5:12:3"))
    for header, cell, ra_deg in ((head, "5h12m3s", 78.0125), (stated, "5:12:3", 5 + 12.05 / 60)):
        found = read(header + rows.format(cell))[0][0].positions
        assert_close("rae angle", found[:, 0], [78.2, ra_deg, 79.3])


@pytest.mark.parametrize(("cell", "name"), [("Rigel", "name"), ("HIP 1", "name"), ("1", "star")])
def test_a_column_of_stars_has_names_or_counts_them(cell: str, name: str) -> None:
    header = ("star", "x_px", "y_px")
    found = read_columns(header, images_only=False, first=[cell, "1", "2"])
    assert found.names[0] == name


REFUSED = (
    "y_mm,x_mm,u,y_mm,v,w,x_mm",
    "y_px,u,v,w",
    "x_mm,u,v,w",
    "x_px,y_mm",
    "x_mm,y_mm,ra",
    "x_mm,y_mm,right_ascension",
    "x_mm,y_mm,ra_deg,ra_hours,dec_deg",
    "x_mm,y_mm,ra_deg,dec_deg,u,v,w",
    "x_mm,y_mm,ra_deg,dec_deg,v",
    "x_mm,y_mm,ra_hours,dec_deg,z_m",
    "x_mm,y_mm,u,v,w,x_m,y_m,z_m",
    "x_mm,y_mm,dec_deg,u,v,w",
    "x_mm,y_mm,dec_deg",
    "x_mm,y_mm,ra_deg",
    "x_mm,y_mm,ra_hours,name",
    "x_mm,y_mm,u",
    "x_mm,y_mm,y_m",
    f"{MM},sigma,sigma_mm",
    f"{PX},sigma_px,sigma",
    f"{MM},sigma,sigma_x_mm,sigma_y_mm",
    f"{MM},sigma_mm,sigma_y_mm",
    f"{MM},sigma_x_mm",
    f"{MM},sigma_y_mm,rho_xy",
    f"{MM},rho_xy",
    f"{MM},sigma,rho_xy",
    f"{MM},sigma_px",
    f"{MM},sigma_x_px,sigma_y_px",
    f"{PX},sigma_y_mm",
    f"{PX},sigma_mm",
    "x,y,z,u,v,w",
    "x,y,sigma_mm,name",
    "x_mm,y_mm,ra_rad,dec_rad,name",
    "x_mm,y_mm,x_ft,y_ft,z_ft,name",
)


@pytest.mark.parametrize("header", REFUSED)
def test_a_header_that_is_refused(header: str) -> None:
    with refused(ColumnError):
        read_columns(tuple(header.split(",")), images_only=False)


def test_empty_names_are_no_columns() -> None:
    """Spreadsheets write them where a table is wider than its header."""
    found = read_columns(("x_mm", "y_mm", "", "u", "v", "w", "", "hue", "hue 2"), images_only=False)
    assert found.ignored == ("hue", "hue 2")


@pytest.mark.parametrize("rest", ["", ",ra_deg", ",u,x_m", ",sigma,sigma_mm", ",sigma_px,hue"])
def test_images_alone(rest: str) -> None:
    """Nothing is asked of other columns, nor said about them."""
    found = read_columns(tuple(f"x_mm,y_mm{rest}".split(",")), images_only=True)
    assert (found.unit, found.kind, found.sigmas, found.ignored) == ("mm", "", (), ())


# The lines of a star file as cells: numbers of lines, separators, and what is no line of stars


def rows(text: str) -> list[tuple[int, list[str]]]:
    return list(read_rows(text, "a.csv"))


SEPARATED = {
    "a,b\n1,2\n": [(1, ["a", "b"]), (2, ["1", "2"])],
    "a;b\n1,5;2\n": [(1, ["a", "b"]), (2, ["1,5", "2"])],
    "a\tb\n1\t\n": [(1, ["a", "b"]), (2, ["1", ""])],
    "a,b;c;d\n1;2;3\n": [(1, ["a,b", "c", "d"]), (2, ["1", "2", "3"])],
    "\ufeffa,b\n": [(1, ["a", "b"])],
    "\ufeff# first\r\na,b\r\n": [(2, ["a", "b"])],
    "# a comment, with; separators\n\n  # another\na,b\n , \n;\n1,2": [
        (4, ["a", "b"]), (6, [";"]), (7, ["1", "2"]),
    ],
    "a,b\r1,2\r": [(1, ["a", "b"]), (2, ["1", "2"])],
    'a,b\n"1,5","say ""x"""\n': [(1, ["a", "b"]), (2, ["1,5", 'say "x"'])],
    "\n \t\n# a, comment\na;b\n1;2\n": [(4, ["a", "b"]), (5, ["1", "2"])],
    "a,b;c\n1,2;3\n": [(1, ["a", "b;c"]), (2, ["1", "2;3"])],  # as many: the comma
    "a;b\tc\n1;2\t3\n": [(1, ["a", "b\tc"]), (2, ["1", "2\t3"])],
    "a;b\n1,2,3;4\n": [(1, ["a", "b"]), (2, ["1,2,3", "4"])],
    "a,b\n1\r2,3\r\n": [(1, ["a", "b"]), (2, ["1"]), (3, ["2", "3"])],
    "%a,b\n//1,2\n": [(1, ["%a", "b"]), (2, ["//1", "2"])],
    "": [],
    "\n# only\n": [],
}  # fmt: skip


@pytest.mark.parametrize("text", SEPARATED, ids=repr)
def test_cells_and_numbers_of_lines(text: str) -> None:
    """The separator is that of the header; lines are counted from 1, those left out too."""
    assert rows(text) == SEPARATED[text]


@pytest.mark.parametrize("before", [0, 1, 5])
def test_a_line_that_is_not_csv_is_named(before: int) -> None:
    with pytest.raises(InputError) as caught:
        rows("a,b\n" + "1,2\n" * before + '3,"4\n')
    assert str(caught.value).startswith(f"a.csv: line {before + 2}: not CSV: ")


# Cells of a star file: every way to write an angle, and both sides of every limit


ANGLES_CELLS = [  # 5 h 12 min 3 s are 78.0125 degrees
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


@pytest.mark.parametrize(("name", "text", "value"), ANGLES_CELLS)
def test_every_way_to_write_a_cell(name: str, text: str, value: float) -> None:
    assert_close("rae angle", read_cell(text, name), value)


BEYOND = [
    ("ra_hours", "5H12M3S"),
    ("dec_deg", "5h12m3s"),
    ("x_mm", "nan"),
    ("ra_hours", "24.01"),
    ("ra_hours", "-24.01"),
    ("ra_deg", "360.01"),
    ("ra_deg", "-360.01"),
    ("dec_deg", "90.01"),
    ("dec_deg", "-90.01"),
    ("rho_xy", "1"),
    ("rho_xy", "-1"),
    ("x_mm", "1.1e12"),
    ("sigma_mm", "0"),
    ("sigma_mm", "-1"),
    ("sigma_mm", "0.9e-9"),
    ("sigma_mm", "1.1e6"),
    ("x_mm", " "),
]


@pytest.mark.parametrize(("name", "text"), BEYOND)
def test_beyond_a_limit(name: str, text: str) -> None:
    with refused(ColumnError):
        read_cell(text, name)


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
    with refused(ColumnError):
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


REFUSED_CELLS = (
    "x_mm,y_mm,x_mm,u,v,w",
    "x_mm,y_px,u,v,w",
    "x_px,u,v,w",
    "u,v,w",
)


@pytest.mark.parametrize("header", REFUSED_CELLS)
def test_a_header_that_is_refused_cells(header: str) -> None:
    with refused(ColumnError):
        read_columns(tuple(header.split(",")), images_only=False)


# Star tables in CSV: every column, photographs, dates, and each error with its line


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
    assert (file.source, file.photograph, file.line_word) == ("a.csv", "night", "line")
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


def test_columns_by_other_names_are_a_warning() -> None:
    (file,), (found,) = read("# stars\nx,y,ra,dec\n1,2,3,4\n")
    assert (file.unit, file.kind) == ("px", "ra_deg,dec_deg") and found.severity == "warning"
    assert_approved(found)


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
    assert found == [Finding("line 3: y_mm: not a number: 'x'", source="a.csv")]
    with refused(InputError):
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


ERRORS = (
    "",
    f"# one\n\n{HEAD}\n",
    f"\n{HEAD},u\n",
    f"{HEAD}\n1,2,0,0,1\n\n1,2,0,0\n",
    f"{HEAD}\n1,2,0,0,1,\n",
    f"{HEAD},image\n1,2,0,0,1,a\n1,2,0,0,1, \n",
    f"{HEAD},utc\n1,2,0,0,1,2020-01-15T21Z\n1,2,0,0,1,2020-01-16T21Z\n",
    f"{HEAD},utc\n1,2,0,0,1,2020-01-15\n",
    f"{HEAD},utc\n1,2,0,0,1,15.1.2020\n",
    f"{HEAD},utc\n1,2,0,0,1,0001-01-01T00:00:00+23:00\n",
    f"{HEAD},mag\n1,2,0,0,1,\n1,2,0,0,1,bright\n",
)


@pytest.mark.parametrize("text", ERRORS, ids=repr)
def test_errors(text: str) -> None:
    with refused(InputError):
        read(text)


def test_columns_that_mean_nothing_are_named() -> None:
    _, found = read(f"\n{HEAD},hue,,size\n1,2,0,0,1,5,,6\n")
    assert_approved(found)


def test_images_alone_tables() -> None:
    """All lines are one photograph, whatever its columns say; nothing else is read."""
    text = "x_mm,y_mm,image,sigma,hue\n1,2,a,x,7\n3,4,,y,8\n"
    (file,), found = read(text, images_only=True)
    assert (file.photograph, file.kind, file.sigmas, found) == ("", "", None, [])
    assert read_images_mm(text, "a.csv").tolist() == [[1.0, 2.0], [3.0, 4.0]]
    with refused(InputError):
        read_images_mm("x_px,y_px\n1,2\n", "a.csv")


def test_images_are_as_many_as_a_photograph_may_have() -> None:
    head, row = "# one\nx_mm,y_mm\n", "1,2\n"
    assert len(read_images_mm(head + 5000 * row)) == 5000
    with refused(InputError):
        read_images_mm(head + 5003 * row, "a.csv")
    whole = read("x_mm,y_mm,image,u,v,w\n" + 2501 * "1,2,a,0,0,1\n" + 2500 * "1,2,b,0,0,1\n")[0]
    assert [len(one.lines) for one in whole] == [2501, 2500]


# Bytes of an input file: which text they are, what is said of others, and which reader is used


REFUSED_TEXTS = (
    b"\x89PNG\r\n\x1a\n",
    b"\xff\xd8\xff\xe0",
    b"II*\x00more",
    b"\x1f\x8b\x08",
    b"PK\x03\x04",
    b"%PDF-1.7",
    b"\xff\xfea\x00",
    b"a\nb\nc \xe9\xea",
    b"\x80",
    b"a\n\nb\x00c\n\x00",
    b"\x00a",
    b"",
    b" \n\t\r\n",
    b"\xef\xbb\xbf\n",
)


@pytest.mark.parametrize("data", REFUSED_TEXTS, ids=repr)
def test_what_is_no_text(data: bytes) -> None:
    with refused(InputError):
        decoded_text(data, "a.csv")


def test_text_has_no_mark_of_its_encoding() -> None:
    assert decoded_text(b"\xef\xbb\xbfx,\xc3\xa9\r\n", "a.csv") == "x,é\r\n"


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    missing = str(tmp_path / "none.csv")
    for name, reason in ((missing, "No such file or directory"), (str(tmp_path), "Is a directory")):
        with pytest.raises(InputError) as caught:
            read_bytes(name)
        assert str(caught.value) == f"{name}: cannot be read: {reason}"
    with refused(InputError):
        read_bytes("")
    with refused(InputError):
        read_bytes("a\0b")


class Stream(NamedTuple):
    """Standard input of these bytes."""

    buffer: io.BytesIO


def test_standard_input_has_a_name(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for data in (b"a,b\n", b""):
        monkeypatch.setattr(sys, "stdin", Stream(io.BytesIO(data)))
        if data:
            assert read_text("-") == ("a,b\n", "standard input")
            continue
        with refused(InputError):
            read_text("-")
    file = tmp_path / "a.csv"
    file.write_bytes(b"a\n")
    assert read_bytes(str(file)) == (b"a\n", str(file))


TABLE = "x_mm,y_mm,u,v,w,hue\n1,2,0,0,-1,3\n"
SOLVED = json.dumps({"matched_centroids": [[2.0, 1.0]], "matched_stars": [[80.0, -5.0, 2.5]]})
FORMATS = {  # a text: the unit of its photographs, and how many there are
    TABLE: ("mm", 1),
    SOLVED: ("px", 1),
    f"\n  {SOLVED}": ("px", 1),
    f"[{SOLVED},{SOLVED}]": ("px", 2),
    f" \r\n[{SOLVED}]": ("px", 1),
    f"{SOLVED}\n{SOLVED}\n{SOLVED}\n": ("px", 3),
}


@pytest.mark.parametrize("text", FORMATS, ids=repr)
def test_the_format_is_known_by_the_content(text: str, tmp_path: Path) -> None:
    """The name says nothing; messages have the file's name."""
    file, found = tmp_path / "of_any_name", list[Finding]()
    file.write_text(text)
    photographs = read_photographs(str(file), found.append)
    assert ({one.unit for one in photographs}, len(photographs)) == (
        {FORMATS[text][0]},
        FORMATS[text][1],
    )
    for one in photographs:
        assert (one.source, one.image.tolist()) == (str(file), [[1.0, 2.0]])
    said = [(one.source, one.message, one.severity) for one in found]
    assert bool(said) == (text == TABLE)
    assert_approved(said)


def test_only_the_beginning_makes_it_fits(tmp_path: Path) -> None:
    file = tmp_path / "a.csv"
    file.write_text("# SIMPLE  =\nx_mm,y_mm,u,v,w\n1,2,0,0,-1\n")
    assert len(read_photographs(str(file), list[Finding]().append)) == 1


@pytest.mark.parametrize("text", ["SIMPLE  =    no", "{", "x_mm\n"])
def test_errors_name_the_file(text: str, tmp_path: Path) -> None:
    file = tmp_path / "broken"
    file.write_text(text)
    with pytest.raises(InputError) as caught:
        read_photographs(str(file), list[Finding]().append)
    assert caught.value.finding.source == str(file)
    assert ("not a FITS file that can be read" in str(caught.value)) == text.startswith("SIMPLE")


@pytest.mark.parametrize("data", [b"SIMPLE  =    no", b"{", b"x_mm\n"])
def test_errors_name_standard_input(data: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", Stream(io.BytesIO(data)))
    with pytest.raises(InputError) as caught:
        read_photographs("-", list[Finding]().append)
    assert caught.value.finding.source == "standard input"


# Star files as spreadsheets, cameras and people hand them over, and what the messages say


GOOD = written(photograph())


def solve_files(text: str | bytes, *arguments: str) -> Ran:
    return vopd("stars", "solve", "-", "--focal", "76", *arguments, stdin=text)


def rows_files(text: str = GOOD) -> list[str]:
    return text.splitlines()


AS_GOOD = {
    "old line ends": "\r".join(rows_files()) + "\r",
    "unnamed columns at the end": "\n".join(line + ",," for line in rows_files()),
    "semicolons, BOM, CRLF, empty rows": "\ufeff"
    + "\r\n".join([*(line.replace(",", ";") for line in rows_files()), ";;;", " ; ; ; "]),
    "tabs and capitals": GOOD.replace(HEAD_FILES, HEAD_FILES.upper()).replace(",", "\t"),
}


@pytest.mark.parametrize("name", AS_GOOD)
def test_these_files_are_as_good_as_any(name: str) -> None:
    result = solve_files(AS_GOOD[name])
    assert result.status == 0 and result.stderr == "" and result.stdout == solve_files(GOOD).stdout


def changed(line: int, cell: int, value: str) -> str:
    """The good file with another value in a line (from 1) and cell (from 0)."""
    lines = [row.split(",") for row in rows_files()]
    lines[line - 1][cell] = value
    return "\n".join(map(",".join, lines))


SAID = {
    "empty cell": changed(5, 1, " "),
    "not a number": changed(3, 0, "nan"),
    "decimal comma": GOOD.replace(",", ";").replace(".", ","),
    "degrees as hours": GOOD.replace("ra_deg", "ra_hours"),
    "sigma of another unit": "\n".join(
        [HEAD_FILES + ",sigma_px", *(f"{row},1" for row in rows_files()[1:])]
    ),
    "star of no photograph": "\n".join(
        [
            "image," + HEAD_FILES,
            *(f"a,{row}" for row in rows_files()[1:6]),
            f",{rows_files()[6]}",
        ]
    ),
    "photograph": b"\xff\xd8\xff\xe0\x00\x10JFIF",
    "workbook": b"PK\x03\x04\x14\x00",
    "packed": b"\x1f\x8b\x08\x00",
    "UTF-16": GOOD.encode("utf-16"),
    "Latin-1": (HEAD_FILES + ",name\n1,2,3,4,Bételgeuse\n").encode("latin-1"),
}


@pytest.mark.parametrize("name", SAID)
def test_what_is_wrong_and_what_to_do_is_said(name: str) -> None:
    text = SAID[name]
    result = solve_files(text)
    assert result.status == 1 and result.stdout == ""
    assert_approved(result.stderr)


def test_a_solution_that_did_not_converge_states_no_accuracy() -> None:
    """From an optical axis far from the true one the corrections go on; sigmas would be noise."""
    good = json.loads(solve_files(GOOD, "--format", "json").stdout)[0]
    result = solve_files(GOOD, "--format", "json", "--initial", "0,0,0")
    assert result.status == 3 and "no convergence in 50 corrections" in result.stderr
    (wrong,) = json.loads(result.stdout)
    stated = {"rotation_sigma_arcsec", "boresight_95_arcsec", "sigma_omega_deg"}
    assert not wrong["converged"] and stated <= set(good) and not stated & set(wrong)


# Plate solutions as JSON: every key, limit and sentence


ONE: dict[str, Any] = {
    "matched_centroids": [[10.0, 20.0], [30.0, 40.0]],
    "matched_stars": [[80.0, -90.0, 2.5], [181.0, 90.0, 3.5]],
}


def plate(*solutions: Any) -> tuple[list[StarFile], list[Finding]]:
    found: list[Finding] = []
    text = json.dumps(solutions[0] if len(solutions) == 1 else solutions)
    return read_plate_solutions(text, "a.json", found.append), found


def test_every_key_of_a_plate_solution() -> None:
    """Everything else in the dictionary means nothing."""
    more = {"FOV": 11.5, "distortion": -0.02, "matched_catID": [5, [1, 22, 3]], "fov": 3, "k1": 4}
    (file,), found = plate(ONE | more)
    assert (file.names, file.line_word, file.photograph) == (("5", "1-22-3"), "match", "")
    assert (file.pixels.field_of_view_deg, file.pixels.distortion) == (11.5, -0.02)
    assert (file.pixels.first_centre, file.pixels.y_down) == (0.5, True)
    assert found == [] and file.source == "a.json"
    assert str(file.finding("x", 0, 1)) == "a.json: matches 1 and 2: x"


BARE: dict[str, dict[str, Any]] = {
    "nothing": {},
    "null": {"FOV": None, "distortion": None, "matched_catID": None},
    "too few names": {"matched_catID": [5]},
    "no list of names": {"matched_catID": "ab"},
}


@pytest.mark.parametrize("name", BARE)
def test_what_need_not_be_there(name: str) -> None:
    (file,), _ = plate(ONE | BARE[name] | {"matched_stars": [[80.0, -90.0], [181.0, 90.0]]})
    assert (file.names, file.magnitude) == (("", ""), None)
    assert (file.pixels.field_of_view_deg, file.pixels.distortion) == (None, 0.0)


def test_a_magnitude_need_not_be_known() -> None:
    (file,), _ = plate(ONE | {"matched_stars": [[80.0, 1.0, None], [181.0, 2.0, 3.5]]})
    assert file.magnitude is not None
    np.testing.assert_array_equal(file.magnitude, [np.nan, 3.5])


REFUSED_PLATES = {
    "no dictionary": 7,
    "no centroids": {"matched_stars": [[1, 2, 3]]},
    "no stars": {"matched_centroids": [[1, 2]]},
    "no match": ONE | {"matched_centroids": [], "matched_stars": []},
    "no match of one": ONE | {"matched_stars": None},
    "FOV is a word": ONE | {"FOV": "wide"},
    "FOV is a list": ONE | {"FOV": [1.0]},
    "true": ONE | {"matched_centroids": [[True, 1.0], [2.0, 3.0]]},
    "text": ONE | {"matched_stars": [["80", -90.0, 2.5], [181.0, 90.0, 3.5]]},
    "ragged": ONE | {"matched_stars": [[1, 2, 3], [1]]},
    "distortion is a list": ONE | {"distortion": [1.0]},
    "triples of pixels": ONE | {"matched_centroids": [[1, 2, 3], [4, 5, 6]]},
    "no pairs": ONE | {"matched_centroids": [1.0, 2.0]},
    "no list": ONE | {"matched_centroids": 1},
    "FOV is true": ONE | {"FOV": True},
    "distortion is a text": ONE | {"distortion": "0.1"},
    "as many": ONE | {"matched_stars": [[1, 2, 3]]},
    "more": ONE | {"matched_stars": [[1, 2, 3]] * 3},
    "numbers": ONE | {"matched_stars": [1.0, 2.0]},
    "four": ONE | {"matched_stars": [[1, 2, 3, 4]] * 2},
    "one": ONE | {"matched_stars": [[1], [2]]},
    "pixel": ONE | {"matched_centroids": [[1, 2], [3, np.nan]]},
    "right ascension": ONE | {"matched_stars": [[np.inf, 2, 3], [1, 2, 3]]},
    "declination": ONE | {"matched_stars": [[1, np.nan, 3], [1, 2, 3]]},
    "too far north": ONE | {"matched_stars": [[1, 2, 3], [1, 90.01, 3]]},
    "too far south": ONE | {"matched_stars": [[1, 2, 3], [1, -90.01, 3]]},
    "a pixel that overflows": ONE | {"matched_centroids": [[1, 2], [3, -1e300]]},
    "more than a turn": ONE | {"matched_stars": [[1, 2, 3], [-360.1, 2, 3]]},
    "FOV below": ONE | {"FOV": -5},
    "FOV of nothing": ONE | {"FOV": 1e-300},
    "FOV zero": ONE | {"FOV": 0},
    "FOV above": ONE | {"FOV": 180},
    "barrel": ONE | {"distortion": -1},
    "cushion": ONE | {"distortion": 1},
}


@pytest.mark.parametrize("name", REFUSED_PLATES)
def test_plate_solutions_that_are_refused(name: str) -> None:
    """Of several the others are read, and the number of the wrong one is said."""
    wrong = REFUSED_PLATES[name]
    with refused(InputError):
        plate(wrong)
    files, found = plate(ONE, ONE, wrong)
    assert [one.photograph for one in files] == ["1", "2"]
    assert_approved(found)


DEEP = "[" * 100_000


def test_what_is_no_json() -> None:
    texts = {
        "": "not JSON: ",
        DEEP: "not JSON: ",
        f'{json.dumps(ONE)}\n\n{{"a":{DEEP}': "line 3: not ",
    }
    for text, message in texts.items():
        with pytest.raises(InputError) as caught:
            read_plate_solutions(text, "a.json", list[Finding]().append)
        assert str(caught.value).startswith(f"a.json: {message}")
    with refused(InputError):
        read_plate_solutions(f'{json.dumps(ONE)}\n{{"a": }}\n', "a.json", list[Finding]().append)
    with refused(InputError):
        read_plate_solutions("[]", "a.json", list[Finding]().append)


# Plate solutions as JSON: one, an array of them, or one a line, and which line is wrong


ONE_LINES = {
    "matched_centroids": [[10.0, 20.0], [30.0, 40.0]],
    "matched_stars": [[80.0, -5.0, 2.5], [81.0, 6.0, 3.5]],
}


def read_plates(text: str) -> tuple[list[StarFile], list[Finding]]:
    found: list[Finding] = []
    return read_plate_solutions(text, "solved.json", found.append), found


SHAPES = {  # a text: the names of its photographs
    "one": (json.dumps(ONE_LINES), [""]),
    "one, on several lines": (json.dumps(ONE_LINES, indent=2), [""]),
    "an array of one": (json.dumps([ONE_LINES]), [""]),
    "an array of two": (json.dumps([ONE_LINES, ONE_LINES]), ["1", "2"]),
    "two lines": (f"{json.dumps(ONE_LINES)}\n{json.dumps(ONE_LINES)}\n", ["1", "2"]),
    "three lines, one blank": (
        f"{json.dumps(ONE_LINES)}\n\n{json.dumps(ONE_LINES)}\n  {json.dumps(ONE_LINES)}",
        ["1", "2", "3"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape(name: str) -> None:
    text, photographs = SHAPES[name]
    files, found = read_plates(text)
    assert [one.photograph for one in files] == photographs and found == []
    for one in files:
        assert one.image.tolist() == [[20.0, 10.0], [40.0, 30.0]]  # centroids are y, x
        assert one.positions.tolist() == [[80.0, -5.0], [81.0, 6.0]]
        assert one.magnitude is not None and one.magnitude.tolist() == [2.5, 3.5]
        assert (one.unit, one.kind, one.lines) == ("px", "ra_deg,dec_deg", (1, 2))
        assert one.pixels.first_centre == 0.5 and one.pixels.y_down


WRONG = (
    "{",
    "[1, 2",
    f"{json.dumps(ONE_LINES)}\n{{",
    f"{json.dumps(ONE_LINES)}\n\n{json.dumps(ONE_LINES)}\n{{,",
    f"\n\n{json.dumps(ONE_LINES)}\n{{,",
    f"{json.dumps(ONE_LINES)}\n7",
    "[]",
)


@pytest.mark.parametrize("text", WRONG, ids=repr)
def test_what_is_not_json(text: str) -> None:
    with refused(InputError, others_after="" if text == "[]" else "not JSON: "):
        read_plates(text)


BAD = {
    "FOV": {"FOV": 0.0},
    "FOV too wide": {"FOV": 180.0},
    "distortion": {"distortion": -1.0},
    "declination": {"matched_stars": [[1.0, 90.5], [2.0, 0.0]]},
    "number": {"FOV": "wide"},
}


@pytest.mark.parametrize("name", BAD)
def test_one_of_several_that_is_wrong_costs_the_others_nothing(name: str) -> None:
    changes = BAD[name]
    files, (found,) = read_plates(json.dumps([ONE_LINES, ONE_LINES | changes, ONE_LINES]))
    assert [one.photograph for one in files] == ["1", "3"]
    assert_approved(str(found))
    with refused(InputError):
        read_plates(json.dumps(ONE_LINES | changes))
    near = {"FOV": 179.0, "distortion": 0.99, "matched_stars": [[1.0, 90.0], [2.0, -90.0]]}
    assert len(read_plates(json.dumps(ONE_LINES | near))[0]) == 1


# Matched stars of `corr.fits`: every column, limit and sentence


ROWS = {
    "field_x": [10.5, 20.5], "field_y": [30.0, 40.0], "index_ra": [80.0, 81.0],
    "index_dec": [-90.0, 90.0], "field_ra": [1.0, 2.0], "field_dec": [3.0, 4.0],
    "index_x": [5.0, 6.0], "index_y": [7.0, 8.0],
}  # fmt: skip


def form_of(data: np.ndarray) -> str:
    """The FITS code of a column: words, pairs of numbers, or numbers."""
    return "4A" if data.dtype.kind == "U" else "2D" if data.ndim > 1 else "D"


def corr(*tables: dict[str, Any]) -> StarFile:
    """Read a FITS file with these tables."""
    fits = pytest.importorskip("astropy.io.fits")
    units = [fits.PrimaryHDU()]
    for table in tables:
        columns = [
            fits.Column(name, form_of(np.array(data)), array=np.array(data))
            for name, data in table.items()
        ]
        units.append(fits.BinTableHDU.from_columns(columns))
    page = io.BytesIO()
    fits.HDUList(units).writeto(page)
    return read_corr_fits(page.getvalue(), "corr.fits")


def test_every_column_of_corr_fits() -> None:
    """The first table that has them is read; names may be in capitals."""
    upper = {name.upper(): data for name, data in ROWS.items()}
    other = ROWS | {"field_x": [0.0, 0.0]}
    file = corr({"field_x": [9.0]}, upper, other)
    assert (file.source, file.lines, file.names) == ("corr.fits", (1, 2), ("", ""))
    assert (file.unit, file.kind, file.line_word) == ("px", "ra_deg,dec_deg", "row")
    assert file.image.tolist() == [[10.5, 30.0], [20.5, 40.0]]
    assert file.positions.tolist() == [[80.0, -90.0], [81.0, 90.0]]
    assert (file.pixels.first_centre, file.pixels.y_down) == (1.0, False)
    assert (file.pixels.field_of_view_deg, file.pixels.distortion) == (None, 0.0)
    assert file.magnitude is None and file.photograph == ""


MAGNITUDES: dict[str, tuple[dict[str, Any], list[float] | None]] = {
    "mag": ({"mag": [1.0, 2.0]}, [1.0, 2.0]),
    "of a catalogue": ({"phot_g_mean_mag": [1.0, 2.0], "b_mag": [3.0, 4.0]}, [1.0, 2.0]),
    "another word": ({"xmag": [1.0, 2.0]}, None),
    "words": ({"mag": ["a", "b"]}, None),
    "pairs": ({"mag": [[1.0, 2.0], [3.0, 4.0]]}, None),
}


@pytest.mark.parametrize("name", MAGNITUDES)
def test_magnitudes(name: str) -> None:
    columns, expected = MAGNITUDES[name]
    found = corr(ROWS | columns).magnitude
    assert (None if found is None else found.tolist()) == expected


def test_whole_numbers_are_numbers() -> None:
    fits = pytest.importorskip("astropy.io.fits")
    columns = [fits.Column(name, "J", array=np.array([1, 2])) for name in ROWS]
    page = io.BytesIO()
    fits.BinTableHDU.from_columns(columns).writeto(page)
    assert read_corr_fits(page.getvalue(), "a").image.tolist() == [[1.0, 1.0], [2.0, 2.0]]


def test_whole_numbers_that_stand_for_none() -> None:
    """TNULL is of numbers as they are stored, before TSCAL and TZERO."""
    fits = pytest.importorskip("astropy.io.fits")
    columns = [fits.Column(name, "J", array=np.array([1, 2])) for name in ROWS]
    plain = fits.Column("mag", "I", array=np.array([5, -99]), null=-99)
    moved = fits.Column("mag", "I", array=np.array([32773, 32669]), null=-99, bzero=32768)
    for magnitude in (plain, moved):
        page = io.BytesIO()
        fits.BinTableHDU.from_columns([*columns, magnitude]).writeto(page)
        found = read_corr_fits(page.getvalue(), "a").magnitude
        assert found is not None and np.isnan(found).tolist() == [False, True]


WRONG_TABLES = {
    "x": {"field_x": [np.nan, 1.0]},
    "y": {"field_y": [1.0, np.inf]},
    "ra": {"index_ra": [1.0, np.nan]},
    "an x that overflows": {"field_x": [1.0, 1e300]},
    "more than a turn": {"index_ra": [1e30, 1.0]},
    "north": {"index_dec": [1.0, 90.01]},
    "south": {"index_dec": [-90.01, np.nan]},
    "words": {"index_ra": ["a", "b"]},
    "none": {name: np.zeros(0) for name in ROWS},
}


@pytest.mark.parametrize("name", WRONG_TABLES)
def test_tables_that_are_refused(name: str) -> None:
    changes = WRONG_TABLES[name]
    with refused(InputError):
        corr(ROWS | changes)


def test_what_is_no_fits_file_is_an_error_without_warnings(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whatever astropy raises, and without what it says about headers."""
    fits = pytest.importorskip("astropy.io.fits")

    def opened(*_: Any, **__: Any) -> None:
        warnings.warn("a header bends the standard", UserWarning, stacklevel=1)
        raise RuntimeError("too short")

    with refused(InputError):
        read_corr_fits(b"SIMPLE  =" + b"x" * 3000, "a")
    monkeypatch.setattr(fits, "open", opened)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with refused(InputError):
            read_corr_fits(b"SIMPLE  =", "a")


def test_a_package_that_lacks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "astropy.io.fits", None)
    with refused(VopdError):
        read_corr_fits(b"SIMPLE  =", "a")


# Cameras of star files: principal point, scale and distortion by each option, and what lacks


IMAGE = np.array([[1010.0, 520.0], [900.0, 700.0]])


def star_file(unit: str = "px", **pixels: Any) -> StarFile:
    pixel_format = PixelFormat(**pixels)
    return StarFile(
        "a.csv", (2, 3), ("", ""), IMAGE, unit, "name", IMAGE, pixels=pixel_format
    )  # fmt: skip


SIZE_AXES, MIDDLE = (2001.0, 1001.0), {"size_px": (2001.0, 1001.0), "focal_px": 500.0}
CENTRED: list[tuple[StarFile, dict[str, Any], list[float], float]] = [
    # a file, the options, the first image from the principal point, the principal distance
    (star_file("mm"), {"focal_mm": 76.0}, [1010.0, 520.0], 76.0),
    (star_file("mm"), {"focal_mm": 76.0, "y_down": True}, [1010.0, -520.0], 76.0),
    (star_file(), MIDDLE, [10.0, 20.0], 500.0),
    (star_file(y_down=True), MIDDLE, [10.0, -20.0], 500.0),
    (star_file(y_down=True), MIDDLE | {"y_down": True}, [10.0, -20.0], 500.0),
    (star_file(), MIDDLE | {"y_down": True}, [10.0, -20.0], 500.0),
    (star_file(first_centre=0.5), MIDDLE, [9.5, 19.5], 500.0),
    (star_file(first_centre=1.0), MIDDLE, [9.0, 19.0], 500.0),
    (star_file(), MIDDLE | {"centre_px": (1000.5, 510.0)}, [9.5, 10.0], 500.0),
    (star_file(first_centre=1.0), {"centre_px": (1000.0, 500.0), "focal_px": 5.0},
     [10.0, 20.0], 5.0),
    (star_file(), {"size_px": SIZE_AXES, "focal_mm": 6.0, "pitch_um": 4.0}, [10.0, 20.0], 1500.0),
    (star_file(), MIDDLE | {"focal_mm": 6.0}, [10.0, 20.0], 500.0),
    (star_file(), MIDDLE | {"focal_mm": 6.0, "pitch_um": 4.0}, [10.0, 20.0], 500.0),
    (star_file(field_of_view_deg=90.0), {"size_px": SIZE_AXES}, [10.0, 20.0], 1000.5),
    (star_file(field_of_view_deg=60.0), {"size_px": SIZE_AXES}, [10.0, 20.0], 1000.5 * 3.0**0.5),
    (star_file(field_of_view_deg=60.0), MIDDLE, [10.0, 20.0], 500.0),
    (star_file(field_of_view_deg=60.0), {"size_px": SIZE_AXES, "focal_mm": 6.0, "pitch_um": 4.0},
     [10.0, 20.0], 1500.0),
]  # fmt: skip


@pytest.mark.parametrize(("file", "options", "first", "focal"), CENTRED)
def test_images_from_the_principal_point(
    file: StarFile, options: dict[str, Any], first: list[float], focal: float
) -> None:
    axes = ImageAxes(**options)
    points, distance = centred_images(file, axes)
    assert_close("flight pixel", points[0], first)
    assert_close("flight pixel", distance, focal)
    assert_close("flight pixel", in_file_coordinates(points[1], file, axes), IMAGE[1])


@pytest.mark.parametrize("unit", ["mm", "px"])
@pytest.mark.parametrize("down", [False, True])
def test_distortion_that_is_stated(unit: str, down: bool) -> None:
    """An image lies 1 + k1 r**2 times as far out, r the tangent of the true angle."""
    axes = ImageAxes(focal_mm=2000.0, y_down=down, k1=-0.1)
    if unit == "px":
        axes = ImageAxes(focal_px=2000.0, centre_px=(0.0, 0.0), y_down=down, k1=-0.1)
    true, _ = centred_images(star_file(unit), axes)
    r = np.hypot(*true.T) / 2000.0
    sign = np.array([1.0, -1.0 if down else 1.0])
    assert_close("flight pixel", true * (1.0 - 0.1 * r**2)[:, None] * sign, IMAGE)


@pytest.mark.parametrize(("focal", "line"), [(500.0, 2), (600.0, 3)])
def test_images_where_the_distortion_does_not_hold(focal: float, line: int) -> None:
    """With k1 -.2 nothing is seen beyond 2/3 sqrt(5/3) = .861 principal distances."""
    limit = 2.0 / 3.0 * (5.0 / 3.0) ** 0.5 * focal
    image = np.array([[limit * 1.01, 0.0], [limit * 1.01, 0.0]])
    image[: line - 2] *= 0.98
    file = StarFile("a.csv", (2, 3), ("", ""), image, "mm", "name", image)
    with refused(InputError, parts=[line]):
        centred_images(file, ImageAxes(focal_mm=focal, k1=-0.2))


@pytest.mark.parametrize("k1", [1e9, 1e308])
def test_a_distortion_that_no_lens_has(k1: float) -> None:
    """All images were near the axis, and the advice was that very k1."""
    with refused(InputError):
        centred_images(star_file("mm"), ImageAxes(focal_mm=2000.0, k1=k1))


@pytest.mark.parametrize(("k1", "taken"), [(0.99, True), (1.01, False)])
def test_a_distortion_that_puts_an_image_twice_as_far_out(k1: float, taken: bool) -> None:
    """At 45 degrees from the axis images lie 1 + k1 as far out."""
    image = np.array([[500.0 * (1.0 + k1), 0.0]] * 2)
    file, axes = StarFile("a.csv", (2, 3), ("", ""), image, "mm", "name", image), ImageAxes(500.0)
    if taken:
        found, _ = centred_images(file, replace(axes, k1=k1))
        assert_close("flight pixel", found, [[500.0, 0.0]] * 2)
        return
    with refused(InputError):
        centred_images(file, replace(axes, k1=k1))


@pytest.mark.parametrize(("x", "y", "out"), [
    (-0.5, -0.5, False), (99.5, 49.5, False), (-0.51, 3.0, True), (99.51, 3.0, True),
    (3.0, -0.51, True), (3.0, 49.51, True),
])  # fmt: skip
def test_the_edges_of_an_image_are_half_a_pixel_beyond_its_pixels(
    x: float, y: float, out: bool
) -> None:
    image = np.array([[x, y], [50.0, 20.0]])
    file = StarFile("a.csv", (2, 3), ("", ""), image, "px", "name", image)
    assert len(outside_image(file, ImageAxes(size_px=(100.0, 50.0)))) == out


@pytest.mark.parametrize("k", [0.1, -0.05])
def test_distortion_of_a_plate_solution(k: float) -> None:
    """Radii over half the width: r (1 - k r**2) / (1 - k)."""
    file = star_file(distortion=k, y_down=True)
    points, _ = centred_images(file, ImageAxes(**MIDDLE))
    half = 1000.5
    for point, (x, y) in zip(points, ((10.0, 20.0), (-100.0, 200.0)), strict=True):
        r = (x * x + y * y) ** 0.5 / half
        scale = (1.0 - k * r * r) / (1.0 - k)
        assert_close("flight pixel", point, [x * scale, -y * scale])


MIDDLE_POINT = {"centre_px": (1.0, 1.0)}
LACKS = [
    (star_file("mm"), {}),
    (star_file(), {"focal_px": 5.0}),
    (star_file(), MIDDLE_POINT),
    (star_file(), {"focal_mm": 5.0} | MIDDLE_POINT),
    (star_file(field_of_view_deg=9.0), MIDDLE_POINT),
    (star_file(distortion=0.1), {"focal_px": 5.0} | MIDDLE_POINT),
]  # fmt: skip


@pytest.mark.parametrize(("file", "options"), LACKS)
def test_options_that_lack(file: StarFile, options: dict[str, Any]) -> None:
    with refused(MissingOption):
        centred_images(file, ImageAxes(**options))


@pytest.mark.parametrize("name", ["focal_px", "pitch_um", "centre_px", "size_px"])
def test_options_for_pixels(name: str) -> None:
    value = (5.0, 6.0) if name in ("centre_px", "size_px") else 5.0
    with refused(InputError):
        centred_images(star_file("mm"), ImageAxes(focal_mm=76.0, **{name: value}))  # type: ignore[arg-type]


ADVICE = [
    ("px", None, "1234.57 px: --focal-px 1234.57"),
    ("px", 5.0, "6.173 mm: --focal 6.173"),
    ("mm", None, "1235 mm: --focal 1235"),
    ("mm", 5.0, "1235 mm: --focal 1235"),
]


@pytest.mark.parametrize(("unit", "pitch", "said"), ADVICE)
def test_a_principal_distance_in_words(unit: str, pitch: float | None, said: str) -> None:
    assert ImageAxes(pitch_um=pitch).focal_advice(1234.56789, unit) == said


@pytest.mark.skipif(os.name == "nt", reason="Windows has no such pipes")
def test_a_named_pipe_is_read_as_a_file(tmp_path: Path) -> None:
    """As of `vopd stars solve <(command)`."""
    pipe, file = tmp_path / "pipe", DECKS / "stars" / "orion.csv"
    os.mkfifo(pipe)
    threading.Thread(target=pipe.write_bytes, args=[file.read_bytes()], daemon=True).start()
    done, own = (vopd("stars", "solve", one, "--focal", "76") for one in (pipe, file))
    assert done.status == 0
    assert done.stdout == own.stdout.replace(str(file), str(pipe))
