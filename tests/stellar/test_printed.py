"""What the report printed, and what its listings answer when they are compiled."""

from __future__ import annotations

import json
from collections.abc import Callable
from math import asin, atan2, degrees

import numpy as np
import pytest

from tests.kit import rae_listings as listings
from tests.kit.command import vopd
from tests.kit.rae_goldens import Golden
from tests.kit.star_files import SAMPLE
from tests.tolerances import assert_close
from vopd.stellar import (
    StarField,
    StarSolution,
    church,
    collinearity,
    image_directions,
    single_rotation,
    two_star,
)
from vopd.stellar.listed import truopk, tustar
from vopd.stellar.radec import radec2
from vopd.stellar.tables_1987 import DIRECTIONS, EXACT_MM, PERTURBED_MM, TRUTH_DEG, sample_field

Tangent = Callable[[float, float], float]
COLUMNS = ("omega", "phi", "kappa")


def solve(method: str, stars: list[int]) -> StarSolution:
    """The perturbed sample, or a pair of it, by a golden file's name of a method."""
    index = np.array(stars) - 1
    field = StarField.of(DIRECTIONS[index], PERTURBED_MM[index], 76.0)
    return {
        "collinearity": lambda: collinearity(field),
        "church": lambda: church(field),
        "church-weighted": lambda: church(field, weights="formula"),
        "two-star raw": lambda: two_star(field, unit_cross_products=False),
        "two-star unit": lambda: two_star(field),
        "two-star": lambda: two_star(field),
        "single-rotation": lambda: single_rotation(field),
    }[method]()


def test_converged_values(golden: Golden) -> None:
    rows = golden("converged.csv")
    assert {"collinearity", "church", "church-weighted"} <= {row["method"] for row in rows}
    for row in rows:
        solution = solve(row["method"], [int(n) for n in row["stars"].split()])
        alpha = row["angles"] == "alpha delta swing"
        angles = solution.alpha_delta_swing_deg if alpha else solution.omega_phi_kappa_deg
        printed = [float(row[name]) for name in ("first", "second", "third")]
        assert_close("rae printed angle", angles, printed)


def test_single_rotation(golden: Golden) -> None:
    (row,) = golden("single_rotation.csv")
    solution = solve("single-rotation", [1, 2])
    assert solution.axis is not None and solution.angle_deg is not None
    axis = [float(row[name]) for name in ("x_r", "y_r", "z_r")]
    assert_close("rae printed cosine", solution.axis, axis)
    assert_close("rae printed angle", solution.angle_deg, float(row["angle_deg"]))
    assert solution.conditioning is not None
    assert f"{solution.conditioning:.2f}" == "0.30"  # the source notes


def test_radec2(golden: Golden) -> None:
    made = radec2(EXACT_MM, 76.0, TRUTH_DEG)
    for k, row in enumerate(golden("radec2.csv")):
        assert_close("rae RADEC2 angle", made.ra_deg[k], float(row["ra_deg"]))
        assert_close("rae RADEC2 angle", made.dec_deg[k], float(row["dec_deg"]))


def test_table_6_2(golden: Golden) -> None:
    """Every cell but the misprint, which is row 4's R in row 3."""
    misprints = {(m["table"], m["row"], m["column"]): m for m in golden("misprints.csv")}
    rows = golden("table_6_2.csv")
    computed = np.concatenate([DIRECTIONS, image_directions(PERTURBED_MM, 76.0)], axis=1)
    for k, row in enumerate(rows):
        for column, name in enumerate("UVWPQR"):
            wrong = misprints.get(("6.2", row["star"], name))
            assert wrong is None or row[name] == wrong["printed"]
            value = float(wrong["should_be"] if wrong else row[name])
            assert_close("rae printed cosine", computed[k, column], value)
    assert ("6.2", "3", "R") in misprints


def test_table_6_4(golden: Golden) -> None:
    """Truth minus estimate to the printed digit; the collinearity row is that of three corrections.

    STARS prints before it corrects, so the fourth correction is never printed:
    .0216 and .0605 come of three from a start such as 140, -10, 45.
    """
    for row in golden("table_6_4.csv"):
        solution = solve(row["method"], [1, 2, 3, 4])
        printed = np.array([float(row[name]) for name in COLUMNS])
        error = TRUTH_DEG - solution.omega_phi_kappa_deg
        if row["method"] == "collinearity":
            assert_close("rae table 6.4 early", error, printed)
            three = collinearity(sample_field(), initial_deg=[140.0, -10.0, 45.0], corrections=3)
            assert_close("rae table 6.4", TRUTH_DEG - three.omega_phi_kappa_deg, printed)
        elif row["method"] == "church":
            assert row["kappa"] == "-0.2318"  # a misprint for .2315
            assert_close("rae table 6.4", error, [*printed[:2], -0.2315])
        else:
            assert_close("rae table 6.4", error, printed)


def test_against_the_listings_statement_for_statement() -> None:
    """CHURCH, TUSTAR's matrix and TWOSTAR, written again on plain numbers from the listings."""
    stars = [tuple(u) for u in DIRECTIONS.tolist()]
    photo = [tuple(p) for p in image_directions(PERTURBED_MM, 76.0).tolist()]
    assert_close("rae element", church(sample_field()).matrix, listings.church(stars, photo))
    for unit in (False, True):
        mine = solve("two-star unit" if unit else "two-star raw", [1, 2]).matrix
        theirs = listings.tustar(stars[:2], photo[:2], unit)
        assert_close("rae element", mine, theirs)
    axis, angle, matrix = listings.twostar(stars[:2], photo[:2])
    mine = solve("single-rotation", [1, 2])
    assert mine.axis is not None and mine.angle_deg is not None
    assert_close("rae element", mine.axis, axis)
    assert_close("rae angle", mine.angle_deg, angle)
    assert_close("rae element", mine.matrix, matrix)


def test_tustar_feeds_degrees_to_its_cosines(golden: Golden) -> None:
    exact = StarField.of(DIRECTIONS[:2], EXACT_MM[:2], 76.0)
    answer = tustar(exact)
    printed = {row["quantity"]: row["printed"] for row in golden("as_listed.csv")}
    assert f"{answer.omega_phi_kappa_deg[1]:.4f}" == printed["PHI"]
    assert f"{answer.alpha_delta_swing_deg[1]:.4f}" == printed["DELTA"]


def test_truopk_cannot_have_made_table_6_4() -> None:
    """It rejects the very matrix of the table, and of a true one it cannot tell two attitudes.

    Its four elements have no cos phi in them: with omega and kappa both turned by 180 degrees
    they are the same, so it takes the first it tries.
    """

    def answer(m: np.ndarray, tangent: Tangent) -> np.ndarray:
        omega = np.degrees(tangent(-m[2, 1], m[2, 2]))
        kappa = np.degrees(tangent(-m[1, 0], m[0, 0]))
        raw = np.array([omega, np.degrees(np.arcsin(m[2, 0])), kappa])
        return truopk(raw, m[0, 1], m[0, 2], m[1, 1], m[1, 2])

    assert np.isnan(answer(church(sample_field()).matrix, np.arctan2)).all()
    true = np.array(listings.jnkmat(*TRUTH_DEG))
    assert_close("rae printed angle", answer(true, np.arctan2), TRUTH_DEG)
    other = answer(true, lambda y, x: np.arctan(y / x))
    assert_close("rae printed angle", other, TRUTH_DEG - [180.0, 0.0, 180.0])


@pytest.mark.parametrize("pair", [[1, 2], [1, 3], [2, 4]])
def test_the_mean_rotation_angle_by_hand(pair: list[int]) -> None:
    """Angles of both stars about the axis, by planes through it; weights: squares of the arms."""
    field = StarField.of(DIRECTIONS[np.array(pair) - 1], PERTURBED_MM[np.array(pair) - 1], 76.0)
    solution = single_rotation(field, angle="mean")
    assert solution.axis is not None and solution.angle_deg is not None
    axis = solution.axis
    angles, weights = [], []
    for star, image in zip(field.directions, field.photo, strict=True):
        normals = np.cross(axis, star), np.cross(axis, image)
        between = np.arctan2(axis @ np.cross(*normals), normals[0] @ normals[1])
        angles.append(np.degrees(between))
        weights.append(normals[0] @ normals[0])
    assert abs(angles[0] - angles[1]) > 0.001  # or there would be nothing to average
    mean = np.average(angles, weights=weights)
    assert_close("rae mean angle", solution.angle_deg, mean)
    farther = single_rotation(field).angle_deg
    assert farther is not None
    assert_close("rae angle of nine digits", farther, angles[int(np.argmax(weights))])


def test_the_axis_as_right_ascension_and_declination() -> None:
    """PIKFAR: the arc tangent of YR, XR and the arc sine of ZR."""
    result = vopd("stars", "solve", SAMPLE, "--focal", "76", "--method", "single-rotation",
                  "--pair", "1,2", "--format", "json")  # fmt: skip
    (row,) = json.loads(result.stdout)
    x, y, z = row["axis"]
    assert_close("rae angle", row["axis_ra_deg"], degrees(atan2(y, x)))
    assert_close("rae angle", row["axis_dec_deg"], degrees(asin(z)))
