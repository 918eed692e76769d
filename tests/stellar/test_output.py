"""Output of solutions as text, JSON and CSV."""

from __future__ import annotations

import csv
import io
import json
from math import acos, degrees
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fortranformat import FortranRecordReader

from tests.kit import rae_listings as listings
from tests.kit.command import Ran, vopd
from tests.kit.stars import SAMPLE as SAMPLE_TEXT
from tests.tolerances import assert_close, within
from vopd.findings import Finding
from vopd.stellar.radec import read_typed
from vopd.stellar.tables_1987 import DIRECTIONS, PERTURBED_MM

# What `vopd stars` writes: JSON and CSV to the letter, files, standard input, RADEC2's typing


DECKS = Path(__file__).parents[2] / "decks" / "stars"
SAMPLE = str(DECKS / "table_6_3_cosines.csv")
ANGLES = ("omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg", "swing_deg")
KEYS = ["method", "stars", *ANGLES, "matrix", "orthogonality_defect", "residuals_mm", "iterations",
        "converged", "rms_mm", "reading_sigma_mm", "reading_freedom", "rotation_sigma_arcsec",
        "rotation_covariance_arcsec2", "boresight_95_arcsec", "boresight_95_angle_deg"]  # fmt: skip
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
    assert list(row) == KEYS + PAIR_KEYS[method] + SIGMAS
    assert row["stars"] == [3, 1] and row["converged"] is True


def test_keys_of_all_stars_and_of_all_pairs() -> None:
    for row in solutions("--method", "church-weighted"):
        assert (
            list(row) == KEYS + SIGMAS and row["stars"] == [1, 2, 3, 4] and row["iterations"] == 0
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
    typed = str(DECKS / "radec2_typed.txt")
    for form in ("text", "json", "csv"):
        by_file = stars("radec", str(DECKS / "table_6_1.csv"), *attitude, "--format", form).stdout
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


HEADING = "matrix (as solved its orthogonality defect is "


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
    assert f"{HEADING}{defect:.1e})" in solve(*options).splitlines()
