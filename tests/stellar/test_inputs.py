"""The formats of star files: pixels, other separators, several photographs, plate solvers."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from tests.kit.command import DECKS, Ran, vopd
from tests.tolerances import assert_close

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
    "pitch and size": ("--focal", "76", "--pitch-um", "5", "--size", "6000,4000"),
    "pixels and centre": ("--focal-px", "15200", "--centre", "2999.5,1999.5"),
}


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


def test_pixels_downward_are_named_as_such() -> None:
    result = solve(*SCALES["pitch and size"], text=in_pixels())
    assert result.status == 3 and "y seems to point down: --y-down" in result.stderr
    assert "px" in result.stderr and "mm" not in result.stderr


def test_a_wrong_scale_of_pixels_is_named() -> None:
    scale = ("--focal-px", "12000", "--size", "6000,4000", "--y-down")
    result = solve(*scale, text=in_pixels())
    assert result.status == 3 and "the principal distance seems to be" in result.stderr
    assert 15190.0 < float(result.stderr.split("--focal-px ")[1].split(";")[0]) < 15210.0


def test_columns_that_mean_nothing_are_noted() -> None:
    lines = in_pixels().splitlines()
    text = "\n".join([lines[0] + ",flux,snr", *(line + ",1.5,9" for line in lines[1:])]) + "\n"
    scale = (*SCALES["pitch and size"], "--y-down")
    result = solve(*scale, text=text)
    assert result.status == 0 and "columns that are ignored: flux, snr" in result.stderr
    assert json.loads(result.stdout) == solved(*scale, text=in_pixels())


MISSING = {
    "no scale": (("--size", "6000,4000"), "--focal-px"),
    "no pitch": (("--focal", "76", "--size", "6000,4000"), "--pitch-um"),
    "no centre": (("--focal-px", "15200"), "--centre X,Y or --size W,H"),
    "two scales": (("--focal-px", "15200", "--focal", "76"), "exclude each other"),
    "pitch alone": (("--pitch-um", "5"), "--pitch-um goes with --focal"),
}


@pytest.mark.parametrize("name", MISSING)
def test_what_pixels_need_is_wrong_usage(name: str) -> None:
    options, said = MISSING[name]
    result = solve(*options, text=in_pixels())
    assert result.status == 2 and said in result.stderr


def test_options_for_pixels_are_refused_with_millimetres() -> None:
    result = solve(ORION, "--focal", "76", "--size", "6000,4000")
    assert result.status == 1 and "are for pixels; the file has mm" in result.stderr


def test_both_units_and_a_decimal_comma_are_refused() -> None:
    both = solve("--focal", "76", text="x_mm;y_px;ra_deg;dec_deg\n1;2;3;4\n")
    assert both.status == 1 and "not both" in both.stderr
    comma = solve("--focal", "76", text="x_mm;y_mm;ra_deg;dec_deg\n1,5;2;3;4\n1;3;4;5\n")
    assert comma.status == 1 and "line 2: x_mm: not a number: '1,5' (with a dec" in comma.stderr


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
    del alone["names"]
    rows = solved("--focal", "76", text=two_photographs())
    assert [row.pop("image") for row in rows] == ["first", "second"]
    assert rows == [alone, alone]
    text = vopd("stars", "solve", "-", "--focal", "76", stdin=two_photographs()).stdout
    assert "image  method " in text.splitlines()[0]
    heads = [line.split()[0] for line in text.splitlines()[:3]]
    assert heads == ["image", "first", "second"]
    page = vopd("stars", "solve", "-", "--focal", "76", "--format", "csv", stdin=two_photographs())
    assert [row["image"] for row in csv.DictReader(io.StringIO(page.stdout))] == ["first", "second"]


def test_a_bad_photograph_costs_the_others_nothing() -> None:
    result = solve("--focal", "76", text=two_photographs("north"))
    assert result.status == 1 and "line 9: ra_deg: not an angle: 'north'" in result.stderr
    assert [row["image"] for row in json.loads(result.stdout)] == ["first"]


def test_several_files(tmp_path: Path) -> None:
    other = tmp_path / "other.csv"
    other.write_text(ORION.read_text())
    missing = tmp_path / "missing.csv"
    rows = solved(ORION, other, "--focal", "76")
    assert [row["image"] for row in rows] == [str(ORION), str(other)]
    result = solve(ORION, missing, "--focal", "76")
    assert result.status == 1 and f"{missing}: cannot be read" in result.stderr
    assert len(json.loads(result.stdout)) == 1


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
        message = f"row {row + 1}: a coordinate is not a number in range"
        assert message in solve(bad, *scale).stderr
        columns[name] = right
    cut = tmp_path / "cut.fits"
    cut.write_bytes(file.read_bytes()[:100])
    assert "not a FITS file that can be read" in solve(cut, *scale).stderr
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


BROKEN = {
    "not json": "{",
    "not numbers": json.dumps(plate_solution() | {"FOV": "wide"}),
    "one too few": json.dumps(plate_solution() | {"matched_stars": [[1, 2, 3]]}),
    "ragged": json.dumps(plate_solution() | {"matched_stars": [[1, 2, 3], [1]]}),
    "declination": json.dumps(plate_solution() | {"matched_stars": [[1, 200, 3]] * 12}),
    "nothing": "[]",
    "number": "[1]",
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_plate_solutions_are_refused(name: str) -> None:
    result = solve("--size", "1024,768", text=BROKEN[name])
    assert result.status == 1 and result.stderr.startswith("standard input: ")


def test_a_plate_solution_needs_the_size() -> None:
    result = solve(text=json.dumps(plate_solution()))
    assert result.status == 2 and "--size W,H is needed" in result.stderr
