"""Output of solutions as text, JSON and CSV."""

from __future__ import annotations

import csv
import io
import json
import re
import sys
from dataclasses import replace
from math import acos, degrees
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from fortranformat import FortranRecordReader

from tests.approved.texts import assert_approved, refused
from tests.kit import rae_listings as listings
from tests.kit.command import DECKS, Ran, vopd
from tests.kit.stars import SAMPLE as SAMPLE_EFFECTS
from tests.kit.stars import SAMPLE as SAMPLE_TEXT
from tests.kit.stars import seen_straight
from tests.tolerances import assert_close, within
from vopd.files import STAR_SOLUTIONS, written_by_vopd
from vopd.findings import Finding, InputError
from vopd.stellar.field import Failure, StarField
from vopd.stellar.files.photograph import SolvedPhotograph
from vopd.stellar.files.read import StarFile
from vopd.stellar.files.table import (
    ReadSolution,
    as_csv,
    as_json,
    columns_of,
    read_solutions,
    solution_table,
    stated_conventions,
)
from vopd.stellar.files.text import _residuals
from vopd.stellar.methods.run import SolvedStars
from vopd.stellar.radec import read_typed
from vopd.stellar.tables_1987 import DIRECTIONS, PERTURBED_MM
from vopd.version import __version__

# What `vopd stars` writes: JSON and CSV to the letter, files, standard input, RADEC2's typing


STARS = DECKS / "stars"
SAMPLE = str(STARS / "table_6_3_cosines.csv")
ANGLES = ("omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg", "swing_deg")
KEYS = ["method", "stars", *ANGLES, "matrix", "orthogonality_defect", "residuals_mm", "iterations",
        "converged", "rms_mm", "reading_sigma_mm", "reading_freedom", "rotation_sigma_arcsec",
        "rotation_covariance_arcsec2", "covariance_factor_95", "boresight_95_arcsec",
        "boresight_95_angle_deg"]  # fmt: skip
SIGMAS = ["images_mm", *(f"sigma_{name}" for name in ANGLES), "epoch"]
PAIR_KEYS = {
    "collinearity": [],
    "two-star": ["interstar_discrepancy_arcsec"],
    "single-rotation": [
        "axis",
        "axis_ra_deg",
        "axis_dec_deg",
        "angle_deg",
        "conditioning",
        "interstar_discrepancy_arcsec",
    ],
}


def stars(*arguments: str, text: str | None = None) -> Ran:
    result = vopd("stars", *arguments, stdin=text)
    assert result.status == 0, result.stderr
    return result


def solutions(*arguments: str) -> list[dict[str, Any]]:
    out = stars("solve", SAMPLE, "--focal", "76", "--format", "json", *arguments).stdout
    return json.loads(out)  # type: ignore[no-any-return]


@pytest.mark.parametrize("method", PAIR_KEYS)
def test_keys_of_a_pair_and_no_others(method: str) -> None:
    (row,) = solutions("--method", method, "--pair", "3,1")
    assert list(row) == [*KEYS, *PAIR_KEYS[method], *SIGMAS, "picture"]
    assert row["stars"] == [3, 1] and row["converged"] is True


def test_keys_of_all_stars_and_of_all_pairs() -> None:
    for row in solutions("--method", "church-weighted"):
        assert (
            list(row) == [*KEYS, *SIGMAS, "picture"]
            and row["stars"] == [1, 2, 3, 4]
            and row["iterations"] == 0
        )
    rows = solutions("--method", "two-star", "--all-pairs")
    assert [row["stars"] for row in rows] == [[1, 2], [1, 3], [1, 4], [2, 3], [2, 4], [3, 4]]
    sizes = {tuple(row["stars"]): abs(row["interstar_discrepancy_arcsec"]) for row in rows}
    for row in rows:
        totals = [sum(v for pair, v in sizes.items() if star in pair) for star in row["stars"]]
        assert_close("rae sum of seconds", row["disagreement_arcsec"], totals)


def test_the_numbers_of_a_solution_by_hand() -> None:
    """Matrix, residuals (observed minus computed) and defect from its own angles."""
    (row,) = solutions("--method", "collinearity")
    m = listings.jnkmat(*(row[name] for name in ANGLES[:3]))
    assert np.abs(np.array(row["matrix"]) - m).max() < within("rae element")
    assert row["orthogonality_defect"] < within("rae defect")
    for k, u in enumerate(DIRECTIONS.tolist()):
        x, y, z = (listings.dot(tuple(line), tuple(u)) for line in m)  # type: ignore[arg-type]
        expected = PERTURBED_MM[k] - np.array([-76.0 * x / z, -76.0 * y / z])
        assert_close("residual", row["residuals_mm"][k], expected)
    (church,) = solutions("--method", "church", "--rotation", "as-solved")
    m = np.array(church["matrix"])
    by_hand = np.abs(m @ m.T - np.eye(3)).max()
    assert_close("rae defect", church["orthogonality_defect"], by_hand)
    assert church["orthogonality_defect"] > 1e-3


def test_interstar_discrepancy_is_celestial_minus_photo() -> None:
    rays = np.column_stack([PERTURBED_MM, np.full(4, -76.0)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    for row in solutions("--method", "single-rotation", "--all-pairs"):
        one, other = (star - 1 for star in row["stars"])
        sky = [listings.unit(tuple(DIRECTIONS[k])) for k in (one, other)]  # type: ignore[arg-type]
        off = degrees(acos(listings.dot(*sky)) - acos(float(rays[one] @ rays[other]))) * 3600
        assert_close("rae arc cosine", row["interstar_discrepancy_arcsec"], off)


@pytest.mark.parametrize("method", ["collinearity", "single-rotation"])
def test_csv_has_what_json_has(method: str) -> None:
    options = ("--method", method, "--pair", "1,2")
    (row,) = solutions(*options)
    page = stars("solve", SAMPLE, "--focal", "76", "--format", "csv", *options).stdout
    (cells,) = csv.DictReader(io.StringIO(page))
    for name in (*ANGLES, "orthogonality_defect"):
        assert float(cells[name]) == row[name]
    matrix = [[float(cells[f"m{i}{j}"]) for j in (1, 2, 3)] for i in (1, 2, 3)]
    assert matrix == row["matrix"] and cells["stars"] == "1 2" and cells["converged"] == "true"
    flat = np.ravel(row["residuals_mm"]).tolist()
    assert [float(v) for v in cells["residuals_mm"].split()] == flat
    assert cells["angle_deg"] == str(row.get("angle_deg", ""))
    assert_close("rae root mean square", float(cells["rms_mm"]), np.sqrt(np.mean(np.square(flat))))


def test_options_of_collinearity_change_what_they_should() -> None:
    start = ("--initial", "140,-10,45")
    listed = solutions(*start, "--weights", "listed", "--corrections", "4")[0]
    images = [tuple(xy) for xy in PERTURBED_MM.tolist()]
    sky = [tuple(u) for u in DIRECTIONS.tolist()]
    theirs = listings.stars_corrections((140.0, -10.0, 45.0), sky, images, 76.0, 4, True)
    assert_close("rae angle", [listed[name] for name in ANGLES[:3]], theirs)
    assert len(listed["weights"]) == 4 and len(listed["weights"][0]) == 2
    loose = solutions("--weights", "robust", "--reading-sigma", "1")[0]
    assert_close("rae angle", loose["kappa_deg"], solutions()[0]["kappa_deg"])
    assert set(np.ravel(loose["weights"])) == {1.0}


def test_radec_by_options_file_and_typing(tmp_path: Path) -> None:
    attitude = ("--focal", "76", "--attitude", "156.1413452,-18.7472372,46.0052148")
    images = ("24,24", "-15,15", "-24,-24", "20,-10")
    options = [part for image in images for part in ("--image", image)]
    typed = str(STARS / "radec2_typed.txt")
    for form in ("text", "json", "csv"):
        by_file = stars("radec", str(STARS / "table_6_1.csv"), *attitude, "--format", form).stdout
        assert stars("radec", *attitude, *options, "--format", form).stdout == by_file
        assert stars("radec", typed, "--typed", "--format", form).stdout == by_file
        out = tmp_path / form
        stars("radec", "-", "--typed", "--format", form, "-o", str(out),
              text=Path(typed).read_text())  # fmt: skip
        assert out.read_bytes() == by_file.encode() and "\r" not in by_file
        assert b"\r" not in vopd("stars", "radec", typed, "--typed", "--format", form).output
    rows = json.loads(stars("radec", *attitude, *options, "--format", "json").stdout)
    assert_close("rae cosine of nine digits", [[row[k] for k in "uvw"] for row in rows], DIRECTIONS)
    assert all(row["r"] < 0 for row in rows)


@pytest.mark.parametrize(
    "field", ["76.", " 7 6.", "76.5", "76000000", "7.6D1", "7.6E+1", "7.6+1", ".076D3", "76E0"]
)
def test_f15_6_reads_as_fortran_does(field: str) -> None:
    """fortranformat is the authority."""
    expected = FortranRecordReader("(F15.6)").read(field.ljust(15))[0]
    warnings: list[Finding] = []
    focal, _, _ = read_typed(f"{field}\n0.\n0.\n0.\n1.\n1.\n9999.9\n", "", warnings.append)
    assert_close("unit element", focal / expected, 1.0)
    assert ("." not in field) == any("has no point" in str(w) for w in warnings)


# The text of a single solution: what is said of a matrix that is not orthogonal


def solve(*options: str) -> str:
    done = vopd("stars", "solve", SAMPLE_TEXT, "--focal", "76", *options)
    assert done.status == 0
    return done.stdout


@pytest.mark.parametrize("method", ["church", "church-weighted", "church-weighted-r"])
def test_a_matrix_as_solved_is_said_not_to_be_orthogonal(method: str) -> None:
    """By how much: the largest element of M M' - 1, of the matrix in the JSON output."""
    options = ("--method", method, "--rotation", "as-solved")
    (row,) = json.loads(solve(*options, "--format", "json"))
    m = np.array(row["matrix"])
    defect = np.abs(m @ m.T - np.eye(3)).max()
    assert 1e-9 < defect < 1.0
    (line,) = [one for one in solve(*options).splitlines() if one.startswith("matrix (")]
    assert_approved(line, parts=[f"{defect:.1e}"])


# Tables of star attitudes: every column with unit and meaning, and every cell of a full row


# name | unit | meaning | cell of the row below; a star marks columns of text
TABLE = """
*method | single
*stars | 1 3
omega_deg | 11.0
phi_deg | 12.0
kappa_deg | 13.0
alpha_deg | 14.0
delta_deg | 15.0
swing_deg | 16.0
m11 | 1.25
m12 | 1.5
m13 | 1.75
m21 | 2.25
m22 | 2.5
m23 | 2.75
m31 | 3.25
m32 | 3.5
m33 | 3.75
orthogonality_defect | 0.0625
rms_px | 0.75
*residuals_px | 0.125 -0.25 0.5 -1.0
iterations | 7
*converged | true
reading_sigma_px | 0.375
reading_freedom | 9
sigma_x_arcsec | 21.0
sigma_y_arcsec | 22.0
sigma_z_arcsec | 23.0
covariance_xx_arcsec2 | 31.0
covariance_xy_arcsec2 | 32.0
covariance_xz_arcsec2 | 33.0
covariance_yy_arcsec2 | 34.0
covariance_yz_arcsec2 | 35.0
covariance_zz_arcsec2 | 36.0
covariance_factor_95 | 37.5
sigma_omega_deg | 0.1
sigma_phi_deg | 0.2
sigma_kappa_deg | 0.3
sigma_alpha_deg | 0.4
sigma_delta_deg | 0.5
sigma_swing_deg | 0.6
boresight_95_major_arcsec | 42.0
boresight_95_minor_arcsec | 41.0
boresight_95_angle_deg | 43.0
weighted_rms_px | 0.875
axis_x | 0.6
axis_y | 0.0
axis_z | -0.8
axis_ra_deg | 51.0
axis_dec_deg | 52.0
angle_deg | 53.0
conditioning | 0.25
interstar_discrepancy_arcsec | -4.5
*disagreement_arcsec | 61.0 62.0
*weights | 1.0 0.5 0.25 0.75
*images_px | 3.0 4.0 5.0 6.0
focal_px | 71.0
centre_x_px | 72.0
centre_y_px | 73.0
k1 | 74.0
sigma_focal_px | 0.71
sigma_centre_x_px | 0.72
sigma_centre_y_px | 0.73
sigma_k1 | 0.74
ra_deg | 81.0
ra_hours | 82.0
dec_deg | 83.0
ra_of_date_deg | 84.0
ra_of_date_hours | 85.0
dec_of_date_deg | 86.0
azimuth_deg | 87.0
elevation_deg | 88.0
camera_roll_deg | 89.0
vehicle_yaw_deg | 91.0
vehicle_pitch_deg | 92.0
vehicle_roll_deg | 93.0
sigma_ra_of_date_deg | 0.84
sigma_dec_of_date_deg | 0.86
sigma_azimuth_deg | 0.87
sigma_elevation_deg | 0.88
sigma_camera_roll_deg | 0.89
sigma_vehicle_yaw_deg | 0.91
sigma_vehicle_pitch_deg | 0.92
sigma_vehicle_roll_deg | 0.93
*epoch | of date
*camera_m | 1001.0 1002.0 1003.0
*camera_sigma_m | 0.01 0.02 0.03
*doubtful | it is odd; so is that
"""
ROWS = [[part.strip() for part in line.split("|")] for line in TABLE.strip().splitlines()]
CELLS = {name.lstrip("*"): cell for name, cell in ROWS}
CAMERA = ("focal", "centre_x", "centre_y", "k1")

FULL = SolvedStars(
    "single", (1, 3), Failure.NONE, [11.0, 12.0, 13.0, 14.0, 15.0, 16.0],
    [[1.25, 1.5, 1.75], [2.25, 2.5, 2.75], [3.25, 3.5, 3.75]],
    0.0625, [[0.125, -0.25], [0.5, -1.0]], 7, True, 0.75, 0.375, 9,
    [21.0, 22.0, 23.0], [[31.0, 32.0, 33.0], [32.0, 34.0, 35.0], [33.0, 35.0, 36.0]],
    37.5, [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], [42.0, 41.0], 43.0, 0.875, [0.6, 0.0, -0.8],
    51.0, 52.0, 53.0, 0.25, -4.5, [[1.0, 0.5], [0.25, 0.75]], [61.0, 62.0],
    [1001.0, 1002.0, 1003.0], [0.01, 0.02, 0.03],
    {name: float(CELLS[name]) for name in (
        "ra_deg", "ra_hours", "dec_deg", "ra_of_date_deg", "ra_of_date_hours", "dec_of_date_deg",
        "azimuth_deg", "elevation_deg", "camera_roll_deg",
        "vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg", "sigma_ra_of_date_deg",
        "sigma_dec_of_date_deg", "sigma_azimuth_deg", "sigma_elevation_deg",
        "sigma_camera_roll_deg", "sigma_vehicle_yaw_deg", "sigma_vehicle_pitch_deg",
        "sigma_vehicle_roll_deg",
    )},
    dict(zip(CAMERA, (71.0, 72.0, 73.0, 74.0), strict=True)),
    dict(zip(CAMERA, (0.71, 0.72, 0.73, 0.74), strict=True)),
    [[3.0, 4.0], [5.0, 6.0]],
)  # fmt: skip
BARE = SolvedStars(
    "svd", (2,), Failure.NONE, [0.0] * 6, np.eye(3).tolist(), 0.0, [[0.5, 0.25]], 0, False, 0.5
)


def photograph(one: SolvedStars, unit: str = "px", label: str = "", **more: Any) -> Any:
    image = np.zeros((3, 2))
    names = ("Rigel", "", "Saiph") if label != "nameless" else ("", "", "")
    file = StarFile(f"{label}.csv", (2, 3, 4), names, image, unit, "name", image)
    stars = StarField.of(np.tile([0.0, 0.0, -1.0], (3, 1)), image, 76.0)
    whole = SolvedPhotograph(label, file, stars, np.arange(3), (one,), (), 0)
    return replace(whole, **more)


def test_every_column_with_its_unit_and_meaning() -> None:
    columns = columns_of([photograph(FULL)])
    found = [("*" * one.text + one.name, one.unit, one.meaning) for one in columns]
    assert_approved(found)


def test_every_cell_of_a_full_row() -> None:
    """In CSV, and as arrays: numbers of numbers, and text of lists and words."""
    odd = (("a", Finding("it is odd")), ("b", Finding("so is that")))
    full = photograph(FULL, epoch="of date", findings=odd, status=3)
    assert stated_conventions([full])["doubtful"] == ".csv: it is odd; so is that"
    assert "doubtful" not in stated_conventions([replace(full, status=0)])
    (row,) = csv.DictReader(io.StringIO(as_csv([full])))
    assert dict(row) == CELLS
    values, _ = solution_table([full])
    for name, cell in ROWS:
        (value,) = values[name.lstrip("*")].tolist()
        assert value == (cell if name.startswith("*") else float(cell)), name


def test_the_text_of_both_formats() -> None:
    """Lines end with a line feed alone; a number that is none is no JSON."""
    text = as_csv([photograph(FULL), photograph(BARE)])
    assert "\r" not in text and text.count("\n") == 3 and text.endswith("\n")
    with pytest.raises(ValueError, match="not JSON compliant"):
        as_json([photograph(replace(BARE, rms=float("nan")))])


def test_a_photograph_named_like_a_formula() -> None:
    """In CSV it was one, for a spreadsheet; arrays have the name as it is."""
    named = [photograph(BARE, label="=1+1")]
    (row,) = csv.DictReader(io.StringIO(as_csv(named)))
    assert row["image"] == "'=1+1" and row["residuals_px"] == "0.5 0.25"
    assert solution_table(named)[0]["image"].tolist() == ["=1+1"]


def test_what_is_not_known_is_empty() -> None:
    known = {
        "method": "svd", "stars": "2", "orthogonality_defect": "0.0", "rms_px": "0.5",
        "residuals_px": "0.5 0.25", "iterations": "0", "converged": "false",
        **{f"m{i}{j}": "1.0" if i == j else "0.0" for i in (1, 2, 3) for j in (1, 2, 3)},
        **{f"{name}_deg": "0.0" for name in ("omega", "phi", "kappa", "alpha", "delta", "swing")},
    }  # fmt: skip
    (row,) = csv.DictReader(io.StringIO(as_csv([photograph(BARE)])))
    assert dict(row) == {name: known.get(name, "") for name in CELLS}
    values, _ = solution_table([photograph(BARE)])
    for name, _ in ROWS:
        (value,) = values[name.lstrip("*")].tolist()
        text = known.get(name.lstrip("*"), "")
        assert value == text if name.startswith("*") else (np.isnan(value) or str(float(text)))


def test_both_units_and_several_photographs() -> None:
    """Columns of one quantity stand together, mm and px in the order of the photographs."""
    some = [photograph(BARE, "mm", "b"), photograph(BARE, "px", "a"), photograph(BARE, "mm", "b")]
    columns = columns_of(some)
    assert (columns[0].name, columns[0].meaning, columns[0].text) == (
        "image",
        "the photograph",
        True,
    )
    names = [one.name for one in columns]
    at = names.index("rms_mm")
    assert names[at : at + 4] == ["rms_mm", "rms_px", "residuals_mm", "residuals_px"]
    assert {one.name: one.unit for one in columns}["sigma_focal_mm"] == "mm"
    assert len(names) == len(set(names)) == len(ROWS) + 11 + 1  # eleven have the images' unit
    two = replace(some[0], solved=(BARE, BARE))
    assert solution_table([two, some[1]])[0]["method"].tolist() == ["svd"] * 3
    names = [one.name for one in columns_of(some[1:])]
    assert names[names.index("rms_px") + 1] == "rms_mm"
    assert solution_table(some)[0]["image"].tolist() == ["b", "a", "b"]
    assert_approved(stated_conventions(some), parts=[__version__])
    assert columns_of([photograph(BARE, label="x")])[0].name == "image"
    assert columns_of([photograph(BARE)] * 2)[0].name == "method"
    one_label = columns_of([photograph(BARE, label="x"), photograph(BARE)])
    assert one_label[0].name == "image" and columns_of([photograph(BARE)])[0].name == "method"
    assert "rms_mm" in solution_table([])[0]


def test_every_key_of_json() -> None:
    """What is known, lists as lists, one solution a line; names only where a star has one."""
    some = [photograph(FULL, label="a", epoch="of date"), photograph(BARE, "mm", "nameless")]
    text = as_json(some)
    for written in (text, as_csv(some), as_csv([photograph(BARE)])):
        known = written_by_vopd(written)
        assert known is not None and known[0] == STAR_SOLUTIONS
    assert text.splitlines()[0] == "[" and text.endswith("}\n]\n") and text.count("\n") == 4
    full, bare = json.loads(text)
    assert list(full)[:3] == ["image", "method", "stars"]
    assert (full["image"], full["stars"], full["names"]) == ("a", [1, 3], ["Rigel", "Saiph"])
    assert full["matrix"] == FULL.matrix and full["epoch"] == "of date"
    assert full["rotation_covariance_arcsec2"] == FULL.rotation_covariance_arcsec2
    assert (full["converged"], full["focal_px"], full["sigma_k1"]) == (True, 71.0, 0.74)
    assert full["residuals_px"] == [[0.125, -0.25], [0.5, -1.0]]
    single = set(CELLS) & set(full)
    lists = {name.lstrip("*") for name, *_ in ROWS if name.startswith("*")}
    for name in single - lists:
        assert full[name] == float(CELLS[name]), name
    # matrix, axis, sigmas, covariance, ellipse, doubts
    assert len(single) == len(CELLS) - 9 - 3 - 3 - 6 - 2 - 1
    assert set(bare) == {
        "image", "method", "stars", "omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg",
        "swing_deg", "matrix", "orthogonality_defect", "residuals_mm", "iterations", "converged",
        "rms_mm",
    }  # fmt: skip
    (alone,) = json.loads(as_json([photograph(BARE)]))
    assert not {"image", "names", "epoch"} & set(alone)
    (two,) = json.loads(as_json([photograph(replace(FULL, stars=(1, 2)))]))
    assert two["names"] == ["Rigel", ""]


# The table of attitudes as text: columns, widths, labels, marks, and what follows the table


# Solutions read back from JSON: every field, what need not be there, and what is refused


ONE_SOLUTIONS: dict[str, Any] = {
    "image": "night", "method": "svd", "stars": [3, 1], "names": ["Rigel", ""],
    "alpha_deg": 10.5, "delta_deg": -20.5, "swing_deg": 30.5,
    "omega_deg": 1, "phi_deg": 2, "kappa_deg": 3,
    "images_px": [[1.0, 2.0], [3.0, 4.0]], "residuals_px": [[0.1, 0.2], [0.3, 0.4]],
}  # fmt: skip


def read(folder: Path, what: Any) -> list[ReadSolution]:
    file = folder / "solved.json"
    file.write_text(what if isinstance(what, str) else json.dumps(what))
    return read_solutions(str(file))


def without(*names: str) -> dict[str, Any]:
    return {name: value for name, value in ONE_SOLUTIONS.items() if name not in names}


def test_every_field(tmp_path: Path) -> None:
    """A star without a name has its number."""
    (one,) = read(tmp_path, [ONE_SOLUTIONS])
    assert (one.image, one.method, one.labels, one.unit) == ("night", "svd", ("Rigel", "1"), "px")
    assert one.images.tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert one.residuals.tolist() == [[0.1, 0.2], [0.3, 0.4]]
    assert one.pointing == (10.5, -20.5, 30.5)


def test_what_need_not_be_there(tmp_path: Path) -> None:
    mm = {"images_mm": [[1.0, 2.0]], "residuals_mm": [[3.0, 4.0]], "stars": [7]}
    bare = without("image", "names", "images_px", "residuals_px") | mm
    one, other = read(tmp_path, [bare, ONE_SOLUTIONS])
    assert (one.image, one.labels, one.unit, other.unit) == ("", ("7",), "mm", "px")
    assert (one.images.tolist(), one.residuals.tolist()) == ([[1.0, 2.0]], [[3.0, 4.0]])


THREE = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
JSON = "`vopd stars solve`: "
PYTHON_SAYS_WHY = ("a number", "no JSON", "too deep", "a list of numbers", "an angle that is none")
REFUSED = {
    "nothing": [],
    "a number": "7",
    "no JSON": "{",
    "too deep": "[" * 100_000,
    "a list of numbers": [7],
    "no images": [without("images_px")],
    "no residuals": [without("residuals_px")],
    "no angle": [without("swing_deg")],
    "an angle that is none": [ONE_SOLUTIONS | {"delta_deg": None}],
    "one residual": [ONE_SOLUTIONS | {"residuals_px": [[0.1, 0.2]]}],
    "triples": [ONE_SOLUTIONS | {"images_px": [[1, 2, 3]], "residuals_px": [[1, 2, 3]]}],
    "no pairs": [ONE_SOLUTIONS | {"images_px": [1, 2], "residuals_px": [1, 2]}],
    "an image that is none": [ONE_SOLUTIONS | {"images_px": [[1, 2], [None, 4]]}],
    "a residual that is none": [ONE_SOLUTIONS | {"residuals_px": [[1, 2], [None, 4]]}],
    "one name": [ONE_SOLUTIONS | {"names": ["Rigel"]}],
    "three stars": [ONE_SOLUTIONS | {"stars": [1, 2, 3], "names": ["", "", ""]}],
    "three images": [ONE_SOLUTIONS | {"images_px": THREE, "residuals_px": THREE}],
    "one of two": [ONE_SOLUTIONS, without("method")],
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(name: str, tmp_path: Path) -> None:
    what = REFUSED[name]
    why = JSON if name in PYTHON_SAYS_WHY else ""
    with refused(InputError, parts=[tmp_path / "solved.json"], others_after=why):
        read(tmp_path, what)


def test_standard_input_has_a_name(monkeypatch: pytest.MonkeyPatch) -> None:
    for text, why in (("[]", ""), ("7", JSON)):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text.encode())))
        with refused(InputError, others_after=why):
            read_solutions("-")


# `vopd stars`: the files it reads, what it prints, what it refuses


def stars_command(*arguments: str, text: str | None = None) -> Ran:
    return vopd("stars", *arguments, stdin=text)


def solve_command(*arguments: str, text: str | None = None) -> Ran:
    return stars_command("solve", *(["-"] if text is not None else []), *arguments, text=text)


def test_pairs_and_options() -> None:
    pair = ("--focal", "76", "--format", "json", "--method", "two-star")
    (row,) = json.loads(solve_command(SAMPLE, *pair, "--pair", "2,4").stdout)
    assert row["stars"] == [2, 4]
    assert len(json.loads(solve_command(SAMPLE, *pair, "--all-pairs").stdout)) == 6
    (raw,) = json.loads(
        solve_command(
            SAMPLE,
            *pair,
            "--pair",
            "1,2",
            "--cross-products",
            "raw",
            "--rotation",
            "as-solved",
        ).stdout
    )
    assert_close("rae printed angle", raw["omega_deg"], 156.1936243362)  # the source notes
    start = ("--focal", "76", "--format", "json", "--initial", "140,-10,45")
    (four,) = json.loads(solve_command(SAMPLE, *start, "--corrections", "3").stdout)
    assert f"{156.1413452 - four['omega_deg']:.4f}" == "0.0151" and four["iterations"] == 3
    (robust,) = json.loads(solve_command(SAMPLE, *start[:4], "--weights", "robust").stdout)
    assert robust["omega_deg"] != 156.1262074559 and robust["converged"]


def test_sexagesimal_and_decimal_angles_agree() -> None:
    """-4 25 49.68 is -4.4304666...; 5h12m3s is 78.0125 degrees."""
    head = "x_mm,y_mm,ra_deg,dec_deg\n"
    rest = "-15,15,82 19 23.81,65 40 39.65\n"
    one = solve_command("--focal", "76", text=head + "24,24,-4 25 49.68,73 17 20.53\n" + rest)
    two = solve_command("--focal", "76", text=head + f"24,24,{-(4 + 25 / 60 + 49.68 / 3600):.12f},"
                f"{73 + 17 / 60 + 20.53 / 3600:.12f}\n" + rest)  # fmt: skip
    assert one.stdout == two.stdout and one.status == 0


def test_ground_points() -> None:
    """The made-up photograph: omega 2, phi -3, kappa 40, to some thousandths."""
    ground = ("--focal", "152.4", "--camera", "1000,2000,3000", "--format", "json")
    (row,) = json.loads(solve_command(str(STARS / "ground_points.csv"), *ground).stdout)
    found = [row[name] for name in ("omega_deg", "phi_deg", "kappa_deg")]
    assert_close("rae ground photograph", found, (2.0, -3.0, 40.0))


def test_radec_and_back() -> None:
    """Stars made for table 6.1's images solve to the attitude they were made with."""
    made = stars_command("radec", str(STARS / "table_6_1.csv"), "--focal", "76", "--attitude",
                 "156.1413452,-18.7472372,46.0052148", "--format", "csv")  # fmt: skip
    (row,) = json.loads(solve_command("--focal", "76", "--format", "json", text=made.stdout).stdout)
    found = [row["alpha_deg"], row["swing_deg"]]
    assert_close("rae angle of nine digits", found, [50.0, 10.0])
    typed = stars_command("radec", str(STARS / "radec2_typed.txt"), "--typed")
    kept = STARS.parents[1] / "golden_outputs" / "rae_1987" / "radec2_printout.txt"
    uncontrolled = [line[1:].rstrip() for line in kept.read_text().splitlines()]
    assert [line.rstrip() for line in typed.stdout.splitlines()] == uncontrolled


# Options of `vopd stars solve`: what each changes of a solution, and what it leaves


TURNS = {"omega_deg", "phi_deg", "kappa_deg"}
SIGMA_COLUMNS = {"reading_sigma_mm", "sigma_omega_deg", "sigma_phi_deg", "sigma_kappa_deg"}
EXACT = seen_straight(
    (0.0, 0.0), (20.0, 0.0), (0.0, 20.0), (-15.0, 12.0), (-9.0, -18.0), (14.0, -11.0), (5.0, 21.0)
)
OFF_UM = ((0, 2), (3, -4), (-5, 1), (4, 4), (-2, -3), (1, 5), (-3, 0))


def misread() -> str:
    """Every star is off by a few um; the first is near the principal point."""
    head, *rows = EXACT.splitlines()
    lines = []
    for row, (dx, dy) in zip(rows, OFF_UM, strict=True):
        x, y, *cosines = row.split(",")
        lines.append(
            ",".join([f"{float(x) + dx / 1e3:.3f}", f"{float(y) + dy / 1e3:.3f}", *cosines])
        )
    return "\n".join([head, *lines]) + "\n"


MISREAD = misread()
WRONG = EXACT.replace("\n20,0,", "\n20.4,0.3,")


def solved(text: str, *options: str) -> dict[str, Any]:
    ran = vopd(
        *("stars", "solve", "-", "--focal", "76", "--format", "json"),
        *" ".join(options).split(),
        stdin=text,
    )
    (row,) = json.loads(ran.stdout)
    doubtful = any(word in ran.stderr for word in ("implausible", "no convergence"))
    assert ran.status == (3 if doubtful else 0), ran.stderr
    return dict(row)


def changed(one: dict[str, Any], other: dict[str, Any]) -> set[str]:
    return {name for name in one | other if one.get(name) != other.get(name)}


CASES = [  # the file, the options of both, an option, what it changes, what it leaves
    (MISREAD, "--reading-sigma .003", "--reading-sigma .006", SIGMA_COLUMNS, TURNS),
    (MISREAD, "--reading-sigma .001 --weights robust", "--reading-sigma .006",
     SIGMA_COLUMNS | TURNS, ()),
    (
        MISREAD, "--reading-sigma .003 --method church-weighted", "--reading-sigma .3",
        {"reading_sigma_mm"} | TURNS, (),
    ),
    (
        MISREAD, "--reading-sigma .003 --method church-weighted-r", "--reading-sigma .3",
        {"reading_sigma_mm"} | TURNS, (),
    ),
    (MISREAD, "--reading-sigma .002", "--weights robust", TURNS, {"reading_sigma_mm"}),
    (MISREAD, "--reading-sigma .003", "--weights listed", TURNS, {"reading_sigma_mm"}),
    (MISREAD, "", "--corrections 1", {"iterations", "converged"}, ()),
    (MISREAD, "--corrections 1", "--initial two-star", TURNS, {"iterations"}),
    (MISREAD, "--corrections 1", "--initial 1,1,1", TURNS, {"iterations"}),
    (MISREAD, "--method two-star", "--cross-products raw", {"matrix"}, {"stars", "method"}),
    (
        SAMPLE_EFFECTS.read_text(), "--method single-rotation", "--rotation-angle mean",
        {"angle_deg"}, {"stars"},
    ),
    (MISREAD, "--method church", "--rotation as-solved", {"matrix"}, {"stars"}),
    (WRONG, "", "--reject", {"stars"} | TURNS, {"method"}),
    (WRONG, "", "--edit-by-pairs", {"stars"} | TURNS, {"method"}),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "both", "option", "columns", "others"), CASES, ids=[f"{c[2]}, {c[1]}" for c in CASES]
)
def test_an_option_changes_what_it_says(
    text: str, both: str, option: str, columns: set[str], others: set[str]
) -> None:
    others_of_both = re.sub(rf"{option.split()[0]} \S+", "", both)
    found = changed(solved(text, both), solved(text, others_of_both, option))
    assert columns <= found and not found & set(others)


def test_the_uncertainty_of_weighted_church_has_the_reading_sigma() -> None:
    """Without it the star at the principal point has an infinite weight, and no angle a sigma."""
    one = solved(MISREAD, "--reading-sigma .003 --method church-weighted")
    other = solved(MISREAD, "--reading-sigma .006 --method church-weighted")
    ratio = other["sigma_kappa_deg"] / one["sigma_kappa_deg"]
    assert 1.5 < ratio < 2.5  # twice, but for the weight of the one star


def test_a_star_counts_as_long_as_one_of_its_coordinates_does() -> None:
    """It is marked where both weights are below a half, and only in a robust solution."""
    weights = [[0.4, 0.49], [0.4, 0.51], [1.0, 0.1]]
    one: Any = SimpleNamespace(stars=[1, 2, 3], residuals=np.zeros((3, 2)), weights=weights)
    file: Any = SimpleNamespace(unit="mm", names=["", "", ""])
    assert_approved([_residuals(one, file, robust=robust) for robust in (True, False)])


# Where a turn ends, and a pole


CROSS = "x_mm,y_mm,ra_deg,dec_deg\n" + (
    "-6.64914,0,4.999999,0\n6.64914,0,354.999999,0\n0,6.64914,359.999999,5\n"
    "0,-6.64914,359.999999,-5\n"
)
"""About right ascension -1E-6 and declination 0: 76 mm tan(5 deg) from the principal point."""


def rows(text: str, *options: str) -> dict[str, list[str]]:
    """The first lines of text: a name of two words or one, and its cells."""
    ran = vopd("stars", "solve", "-", *options, "--reading-sigma", ".01", stdin=text)
    assert ran.status == 0, ran.stderr
    lines = [line.split() for line in ran.stdout.splitlines()[1:6]]
    return {line[0]: line[1 + (line[0] in ("right", "position")) :] for line in lines}


def test_a_right_ascension_that_rounds_to_a_whole_turn_is_0() -> None:
    found = rows(CROSS, "--focal", "76")
    assert float(found["right"][0]) == 0.0 and found["right"][-1].startswith("0h00m00")
    assert float(found["declination"][0]) == 0.0 and found["declination"][-1].startswith("0°00'00")


def test_about_a_pole_a_right_ascension_may_be_all_around() -> None:
    """Stars 5 degrees from the middle of a 76 mm photograph, which is .00001 from the pole."""
    pole = "x_mm,y_mm,ra_deg,dec_deg\n" + (
        "-6.64914,0,90,85\n6.64914,0,270,85\n0,6.64914,180,85.00001\n0,-6.64914,0,84.99999\n"
    )
    found = rows(pole, "--focal", "76")
    assert float(found["right"][2]) == float(found["position"][2]) == 180.0
    assert float(found["declination"][0]) > 89.9


def test_the_field_of_an_image_is_that_beside_its_principal_point() -> None:
    """Columns -.5 to 999.5 about 99.5, and rows -.5 to 399.5 about 299.5, at 1000 px."""
    text = "x_px,y_px,ra_deg,dec_deg\n" + "".join(
        f"{99.5 - x},{299.5 - y},{ra},{dec}\n"
        for x, y, ra, dec in (
            (-87.48866, 0, 355, 0), (0, 87.48866, 0, 5), (0, -87.48866, 0, -5),
            (87.48866, 0, 5, 0),
        )
    )  # fmt: skip
    found = rows(text, "--focal-px=1000", "--centre=99.5,299.5", "--size=1000,400")
    wide = degrees(np.arctan(0.1) + np.arctan(0.9))
    high = degrees(np.arctan(0.3) + np.arctan(0.1))
    assert abs(float(found["field"][0]) - wide) < within("four figures of a field")
    assert abs(float(found["field"][2]) - high) < within("four figures of a field")
