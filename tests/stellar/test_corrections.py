"""Corrections of collinearity, and the printout of STARS."""

from __future__ import annotations

import re
from collections.abc import Callable
from math import acos, atan2, cos, degrees, sin, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.approved.texts import assert_approved, refused
from tests.kit import rae_listings as listings
from tests.kit.command import vopd
from tests.kit.rae_listings import Golden
from tests.kit.stars import SAMPLE, seen_straight, solve_text
from tests.kit.stars import STARS as STARS_PRINTOUT
from tests.tolerances import assert_close, within
from vopd.findings import VopdError
from vopd.stellar import StarField, church, collinearity, orientation_matrix, two_star, wahba
from vopd.stellar.listed import stars_printout, tustar
from vopd.stellar.methods.two_star import closed_form
from vopd.stellar.methods.weights import church_formula_weights as formula_weights
from vopd.stellar.methods.weights import huber, listed
from vopd.stellar.tables_1987 import DIRECTIONS, EXACT_MM, PERTURBED_MM, TRUTH_DEG, sample_field

# Differential corrections and weights, against program STARS and the report's equations


STARS = [tuple(u) for u in DIRECTIONS.tolist()]
IMAGES = [tuple(xy) for xy in PERTURBED_MM.tolist()]
START = (150.0, -15.0, 50.0)


@pytest.mark.parametrize("rule", ["uniform", "listed"])
@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_each_correction_is_that_of_stars(rule: str, count: int) -> None:
    """PARSHL's partials by the angles, RESWTS's weights, INV3X3."""
    theirs = listings.stars_corrections(START, STARS, IMAGES, 76.0, count, rule == "listed")
    mine = collinearity(
        sample_field(),
        initial_deg=START,
        corrections=count,
        weights=rule,  # type: ignore[arg-type]
    )
    assert mine.iterations == count
    turned = orientation_matrix(np.array(theirs))  # angles may differ by whole turns
    assert np.abs(mine.matrix - turned).max() < within("rae rotation")


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_no_other_attitude_has_less_squares(axis: int) -> None:
    best = tuple(collinearity(sample_field()).omega_phi_kappa_deg.tolist())
    least = listings.sum_of_squares(best, STARS, IMAGES, 76.0)
    for step in (-1e-3, 1e-3):
        moved = [angle + step * (k == axis) for k, angle in enumerate(best)]
        assert listings.sum_of_squares(tuple(moved), STARS, IMAGES, 76.0) > least


@given(st.tuples(st.floats(-179, 179), st.floats(-80, 80), st.floats(-179, 179)))
def test_the_start_does_not_change_where_it_ends(start: tuple[float, float, float]) -> None:
    """A start either leads to the one attitude in front of the camera, or is reported."""
    solution = collinearity(sample_field(), initial_deg=start)
    if solution.converged:
        truth = [156.1262074559, -18.7687854195, 46.0656513621]  # the source notes
        assert_close("rae printed angle", solution.omega_phi_kappa_deg, truth)
    else:
        assert solution.failure != 0


@pytest.mark.parametrize(
    "size", [0.0, 0.9999e-7, 1.0001e-7, 1e-4, 0.9999e-3, 1.0001e-3, 0.003, 0.1, 5.0]
)
def test_listed_weights_are_those_of_reswts(size: float) -> None:
    for residual in (size, -size):
        weight = listed(np.array([[residual, 1.0]]))[0, 0]
        assert abs(weight - listings.reswts(residual)) < within("table value")


@given(st.lists(st.floats(1e-9, 1e3), min_size=2, max_size=20), st.floats(1e-4, 10.0))
def test_robust_weights_are_bounded_and_never_rise(sizes: list[float], sigma: float) -> None:
    length = np.sort(sizes)
    residual = np.column_stack([0.6 * length, -0.8 * length])
    for scale in (sigma, None):
        weight = huber(residual, np.ones(len(length), bool), np.array([76.0]), scale)[:, 0]
        assert (weight > 0.0).all() and (weight <= 1.0).all()
        assert (np.diff(weight) <= 0.0).all()
    assert (weight[length < 1e-9 * 76.0] == 1.0).all()


def test_robust_weights_bend_at_two_sigmas() -> None:
    """.05 mm is five sigmas of .01, 2.5 bends: weight .4."""
    residual = np.array([[0.03, 0.04], [0.012, 0.016], [0.0, 0.01]])
    weight = huber(residual, np.ones(3, bool), np.array([76.0]), 0.01)
    assert np.abs(weight - [[0.4, 0.4], [1.0, 1.0], [1.0, 1.0]]).max() < within("table value")


@pytest.mark.parametrize(
    ("corner", "printed"), [((12.0, 16.0), (6468, 6714)), ((16.0, 12.0), (6714, 6468))]
)
def test_formula_weights_have_the_numbers_of_eq_3_20(
    corner: tuple[float, float], printed: tuple[int, int]
) -> None:
    """wP and wQ at the corner of 24 x 32 mm (6714 is cut, not rounded); f squared at the centre."""
    w = formula_weights(np.array([corner, (0.0, 0.0)]), np.array([76.0]))
    assert np.abs(w[:2, 0] - printed).max() < within("rae weight")
    assert np.abs(w[:2, 1] - 5776.0).max() < within("rae rotation")


def test_the_text_s_frame_has_other_ratios() -> None:
    """24 x 36 mm: 1.131 and 1.201 (the source notes)."""
    w = formula_weights(np.array([[12.0, 18.0], [0.0, 0.0]]), np.array([76.0]))
    assert [f"{ratio:.3f}" for ratio in w[:2, 0] / w[:2, 1]] == ["1.131", "1.201"]


def test_formula_weight_of_the_third_cosine() -> None:
    """Eq. 3.20: 36.5 between 3 and 20 mm; infinite at 0; a reading sigma bounds it by f**4/s**2."""
    images = np.array([[3.0, 0.0], [0.0, 20.0], [0.0, 0.0]])
    w = formula_weights(images, np.array([76.0]))[2]
    assert (round(float(w[0])), round(float(w[1]))) == (3724263, 101961) and np.isinf(w[2])
    bounded = formula_weights(images, np.array([76.0]), 0.01)[2, 2]
    assert_close("ratio", bounded / (76.0**4 / 0.01**2), 1.0)


def test_formula_weights_are_inverse_variances() -> None:
    """Of P, Q, R under equal errors of x and y, by differences of the unit vector itself."""
    x, y, f, step = 17.0, -9.0, 76.0, 1e-4

    def ray(a: float, b: float) -> np.ndarray:
        return np.array([a, b, -f]) / np.sqrt(a * a + b * b + f * f)

    by_x = (ray(x + step, y) - ray(x - step, y)) / (2 * step)
    by_y = (ray(x, y + step) - ray(x, y - step)) / (2 * step)
    expected = 1.0 / (by_x**2 + by_y**2)
    w = formula_weights(np.array([[x, y]]), np.array([f]))[:, 0]
    assert_close("rae weight by differences", w / expected, 1.0)


def test_church_weighted_is_the_weighted_normal_equations() -> None:
    """Each row of M by itself, with the weights of the equations written out."""
    f2 = 76.0**2
    x2, y2 = PERTURBED_MM[:, 0] ** 2, PERTURBED_MM[:, 1] ** 2
    cube = (x2 + y2 + f2) ** 3
    rows: list[Callable[[], np.ndarray]] = [
        lambda: cube / ((y2 + f2) ** 2 + x2 * y2),
        lambda: cube / ((x2 + f2) ** 2 + x2 * y2),
        lambda: cube / (f2 * (x2 + y2)),
    ]
    rays = np.column_stack([PERTURBED_MM, np.full(4, -76.0)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    u = DIRECTIONS
    expected = [
        np.linalg.solve(u.T @ (w()[:, None] * u), u.T @ (w() * rays[:, k]))
        for k, w in enumerate(rows)
    ]
    field = StarField.of(u, PERTURBED_MM, 76.0)
    mine = church(field, weights="formula").matrix
    assert np.abs(mine - expected).max() < within("rae rotation")
    alone = church(field, weights="formula-r").matrix  # wR alone: the first two rows as they were
    assert np.abs(alone[:2] - church(field).matrix[:2]).max() < within("rae rotation")
    assert np.abs(alone[2] - expected[2]).max() < within("rae rotation")


# `vopd stars solve --listing`: what program STARS prints


START_PRINTOUT = (140.0, -10.0, 45.0)
SKY = [tuple(u) for u in DIRECTIONS.tolist()]


def blocks(text: str) -> list[list[str]]:
    """The lines of each correction."""
    return [("OMEGA" + part).splitlines() for part in text.split("OMEGA")[1:]]


def angles_deg(block: list[str]) -> list[float]:
    found = []
    for line in block[:3]:
        degrees, minutes, seconds = line.split("=")[1].split()
        size = abs(int(degrees)) + int(minutes) / 60 + float(seconds) / 3600
        found.append(-size if degrees.startswith("-") else size)
    return found


def run(*arguments: str) -> str:
    result = vopd("stars", "solve", SAMPLE, "--focal", "76", "--listing", *arguments)
    assert result.status == 0 and result.stderr == ""
    return result.stdout


@pytest.mark.parametrize("rule", ["uniform", "listed"])
def test_the_history_is_that_of_the_listing(rule: str) -> None:
    """STARS statement for statement, on plain numbers; angles to half a printed millisecond."""
    options = ("--corrections", "4", "--weights", rule) if rule == "listed" else ()
    found = blocks(run("--initial", "140,-10,45", *options))
    assert len(found) == 4
    for done, block in enumerate(found):
        expected = listings.stars_corrections(
            START_PRINTOUT, SKY, IMAGES, 76.0, done, rule == "listed"
        )
        for mine, theirs in zip(angles_deg(block), expected, strict=True):
            assert_close("rae printed milliseconds", mine * 3600.0, theirs * 3600.0)
        m = listings.jnkmat(*expected)
        x, y = [], []
        for u, (image_x, image_y) in zip(SKY, IMAGES, strict=True):
            xn, yn, de = (listings.dot(tuple(row), u) for row in m)  # type: ignore[arg-type]
            x.append(image_x + 76.0 * xn / de)
            y.append(image_y + 76.0 * yn / de)
        for k, line in enumerate(block[4:8]):
            assert line == f"{k + 1:10d}{'':10}{x[k]:10.4f}{'':10}{y[k]:10.4f}"
        sums = (*(sum(v * v for v in values) for values in (x, y)),
                *(sum(abs(v) for v in values) for values in (x, y)))  # fmt: skip
        for total, line in zip(sums, block[8:], strict=True):
            assert line.endswith(f"{total:13.7f}") and line.startswith("SUM OF THE ")


def test_the_last_angles_are_those_of_table_6_4(golden: Golden) -> None:
    """The report's row of the collinearity equations, to the printed digit."""
    (row,) = [row for row in golden("table_6_4.csv") if row["method"] == "collinearity"]
    last = angles_deg(blocks(run("--initial", "140,-10,45"))[-1])
    errors = [f"{truth - angle:.4f}" for truth, angle in zip(TRUTH_DEG, last, strict=True)]
    assert errors == [row[name] for name in ("omega", "phi", "kappa")]


def test_angles_are_not_wrapped_and_keep_their_sign() -> None:
    """STARS adds corrections: from 500 degrees it stays there. -0.25 degree keeps its sign."""
    turned = blocks(run("--initial", "500,-0.25,45", "--corrections", "2"))
    assert turned[0][:2] == ["OMEGA  =   500   0   0.000", "PHI    =    -0  15   0.000"]
    assert 400.0 < angles_deg(turned[1])[0] < 600.0


def test_without_a_start_and_where_it_ends_behind_the_camera() -> None:
    assert len(blocks(run("--corrections", "2"))) == 2
    behind = vopd("stars", "solve", STARS_PRINTOUT / "stars_block_2.csv", "--focal", "76",
                  "--initial", "20,-15,50", "--listing")  # fmt: skip
    assert behind.status == 1
    assert_approved(behind.stderr)
    assert re.search(r"OMEGA  = +20   0   4.584", behind.stdout)


# Program STARS's printout line by line, and routine TUSTAR's answers, by numbers made by hand


STRAIGHT = np.array([[0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [0.0, -0.6, -0.8]])
SEEN = np.array([[0.25, -0.5], [75.0, 1.0], [-2.0, 74.0]])
"""Seen straight on with 100 mm the stars are at 0 0, 75 0 and 0 -75."""


def field(images: np.ndarray = SEEN) -> StarField:
    return StarField.of(STRAIGHT, images, 100.0)


def test_the_lines_of_one_correction_by_hand() -> None:
    """Residuals .25 -.5, 0 1 and -2 149; their squares and sizes add up by axis."""
    assert stars_printout(field(), initial_deg=[0.0, 0.0, 0.0], corrections=1) == (
        "OMEGA  =     0   0   0.000\n"
        "PHI    =     0   0   0.000\n"
        "KAPPA  =     0   0   0.000\n"
        " OBSERVATION NUMBER          X RESIDUAL          Y RESIDUAL\n"
        "         1              0.2500             -0.5000\n"
        "         2              0.0000              1.0000\n"
        "         3             -2.0000            149.0000\n"
        "SUM OF THE SQUARED X RESIDUALS =     4.0625000\n"
        "SUM OF THE SQUARED Y RESIDUALS = 22202.2500000\n"
        "SUM OF THE ABSOLUTE X RESIDUALS =    2.2500000\n"
        "SUM OF THE ABSOLUTE Y RESIDUALS =  150.5000000\n"
    )


@pytest.mark.parametrize(
    ("angle", "cells"),
    [
        (0.0, "     0   0   0.000"),
        (-0.25, "    -0  15   0.000"),
        (12.5 + 7.0625 / 3600.0, "    12  30   7.062"),
        (-179.0 - 59.0 / 60.0 - 59.9996 / 3600.0, "  -180   0   0.000"),  # rounded up all through
        (359.0 + 59.9994 / 3600.0, "   359   0  59.999"),
        (-500.0 - 1.0 / 60.0, "  -500   1   0.000"),
    ],
)
def test_an_angle_in_degrees_minutes_and_seconds(angle: float, cells: str) -> None:
    text = stars_printout(field(), initial_deg=[angle, 10.0, -20.0], corrections=1)
    assert text.splitlines()[:3] == [
        f"OMEGA  ={cells}",
        "PHI    =    10   0   0.000",
        "KAPPA  =   -20   0   0.000",
    ]


def first_angles(text: str, block: int) -> list[float]:
    """omega, phi, kappa of a block, degrees."""
    lines = [line for line in text.splitlines() if line.startswith(("OMEGA", "PHI", "KAPPA"))]
    found = []
    for line in lines[3 * block : 3 * block + 3]:
        whole, minutes, seconds = line.split("=")[1].split()
        size = abs(int(whole)) + int(minutes) / 60.0 + float(seconds) / 3600.0
        found.append(-size if whole.startswith("-") else size)
    return found


def test_four_blocks_from_the_start_that_is_named() -> None:
    """The default is the singular-value solution; both starts differ by half a degree."""
    sample = sample_field()
    assert stars_printout(sample).count("OMEGA") == 4
    svd = wahba(sample).omega_phi_kappa_deg
    pair = collinearity(sample, start="two-star", corrections=0).omega_phi_kappa_deg
    assert np.abs(svd - pair).max() > 0.1 and np.isfinite(closed_form(sample)).all()
    for begun, start in ((svd, {}), (svd, {"start": "svd"}), (pair, {"start": "two-star"})):
        shown = first_angles(stars_printout(sample, corrections=1, **start), 0)  # type: ignore[arg-type]
        assert_close("rae printed milliseconds", np.array(shown) * 3600.0, begun * 3600.0)


@pytest.mark.parametrize("rule", ["uniform", "listed", "robust"])
def test_the_rule_of_weights_from_block_to_block(rule: str) -> None:
    """Robust weights begin with the second correction; the first has none."""
    images = [(9.0 * cos(k), 9.0 * sin(k)) for k in range(8)]
    rays = np.array([listings.unit((x, y, -76.0)) for x, y in images])
    wrong = np.array(images) + ([[0.02 * (k % 3), 0.0] for k in range(7)] + [[0.9, 0.3]])
    sample = StarField.of(rays, wrong, 76.0)
    start = [1.0, -2.0, 3.0]
    text = stars_printout(sample, initial_deg=start, weights=rule, corrections=3)  # type: ignore[arg-type]
    for done in (1, 2):
        solved = collinearity(sample, initial_deg=start, weights=rule, corrections=done)  # type: ignore[arg-type]
        expected = solved.omega_phi_kappa_deg * 3600.0
        shown = np.array(first_angles(text, done)) * 3600.0
        assert_close("rae printed milliseconds", shown, expected)
    if rule == "robust":
        plain = stars_printout(sample, initial_deg=start, corrections=3)
        assert first_angles(plain, 1) == first_angles(text, 1)
        assert first_angles(plain, 2) != first_angles(text, 2)
        given = {"initial_deg": start, "weights": "robust", "reading_sigma_mm": 0.05}
        text = stars_printout(sample, corrections=3, **given)  # type: ignore[arg-type]
        solved = collinearity(sample, corrections=2, **given)  # type: ignore[arg-type]
        shown = np.array(first_angles(text, 2)) * 3600.0
        expected = solved.omega_phi_kappa_deg * 3600.0
        assert_close("rae printed milliseconds", shown, expected)


def test_the_command_hands_weights_and_sigma_on_to_the_listing() -> None:
    images = [(9.0 * cos(k), 9.0 * sin(k)) for k in range(8)]
    *lines, last = seen_straight(*images).splitlines()
    wrong = "\n".join([*lines, ",".join(["2", "-8", *last.split(",")[2:]])]) + "\n"
    ways = [(), ("--weights", "robust"), ("--weights", "robust", "--reading-sigma", ".01")]
    pages = [solve_text(wrong, "--initial", "1,-2,3", "--listing", *way).stdout for way in ways]
    assert len({tuple(first_angles(page, 1)) for page in pages}) == 1
    assert len({tuple(first_angles(page, 2)) for page in pages}) == 3
    head, *lines = wrong.splitlines()
    stated = "\n".join([f"{head},sigma_mm", *(f"{line},.01" for line in lines)])
    own = solve_text(stated, "--initial", "1,-2,3", "--listing", "--weights", "robust").stdout
    assert first_angles(own, 2) == first_angles(pages[2], 2)


def test_what_has_no_printout() -> None:
    same = StarField.of(STRAIGHT[[1, 1]], SEEN[[1, 1]], 100.0)
    with refused(VopdError):
        stars_printout(same)
    with refused(VopdError):
        stars_printout(same, initial_deg=[0.0, 0.0, 0.0])
    assert stars_printout(same, initial_deg=[0.0, 0.0, 0.0], corrections=1).count("OMEGA") == 1


@pytest.mark.parametrize("pair", [[0, 1], [1, 3], [2, 3]])
@pytest.mark.parametrize("sky", [(0.0, 0.0, 0.0), (180.0, -20.0, 40.0), (60.0, 60.0, 40.0)])
def test_every_answer_of_tustar(pair: list[int], sky: tuple[float, float, float]) -> None:
    """Appendix D on plain numbers: cosines of degrees, arcs of scalar products, raw products.

    With the sky turned, one or the other quotient passes 1 and is cut.
    """
    turned = DIRECTIONS @ np.array(listings.jnkmat(*sky)).T
    one = StarField.of(turned[pair], PERTURBED_MM[pair], 76.0)
    stars = [tuple(turned[k]) for k in pair]
    photo = [listings.unit((*PERTURBED_MM[k], -76.0)) for k in pair]
    m = listings.tustar(stars, photo, unit_third=False)  # type: ignore[arg-type]
    omega, alpha = degrees(atan2(-m[2][1], m[2][2])), degrees(atan2(-m[2][1], -m[2][0]))
    phi = degrees(atan2(m[2][0], min(m[2][2] / cos(omega), 1.0)))
    delta = degrees(atan2(-m[2][2], min(-m[2][0] / cos(alpha), 1.0)))
    answer = tustar(one)
    assert_close("rae element", answer.matrix, m)
    kappa, swing = degrees(atan2(-m[1][0], m[0][0])), degrees(atan2(m[0][2], m[1][2]))
    assert_close("rae angle", answer.omega_phi_kappa_deg, [omega, phi, kappa])
    assert_close("rae angle", answer.alpha_delta_swing_deg, [alpha, delta, swing])
    arc = acos(sum(a * b for a, b in zip(*stars, strict=True)))
    assert_close("rae angle", answer.interstar_rad, arc)
    off = degrees(arc - acos(listings.dot(*photo))) * 3600.0
    assert_close("rae arc cosine", answer.discrepancy_arcsec, off)
    assert np.abs(two_star(one).matrix - np.array(m)).max() > 1e-7  # the unit product's


def test_the_sample_data_are_those_of_the_report() -> None:
    """Tables 6.1 and 6.3; stars of length 1 to nine digits."""
    assert EXACT_MM.tolist() == [[24.0, 24.0], [-15.0, 15.0], [-24.0, -24.0], [20.0, -10.0]]
    assert PERTURBED_MM.tolist() == [[24.1, 23.8], [-15.2, 15.3], [-23.7, -24.0], [19.8, -10.0]]
    default = sample_field()
    assert (default.image_mm == PERTURBED_MM).all() and (default.focal_length_mm == 76.0).all()
    for u in DIRECTIONS.tolist():
        assert_close("rae cosine of nine digits", sqrt(listings.dot(u, u)), 1.0)
