"""Program STARS's printout line by line, and routine TUSTAR's answers, by numbers made by hand."""

from __future__ import annotations

from math import acos, atan2, cos, degrees, sin, sqrt

import numpy as np
import pytest

from tests.kit import rae_listings as listings
from tests.kit.star_files import seen_straight, solve_text
from tests.tolerances import assert_close
from vopd.findings import VopdError
from vopd.stellar import StarField, collinearity, two_star, wahba
from vopd.stellar.listed import stars_printout, tustar
from vopd.stellar.methods.wahba import closed_form
from vopd.stellar.tables_1987 import DIRECTIONS, EXACT_MM, PERTURBED_MM, sample_field

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
    for given, start in ((svd, {}), (svd, {"start": "svd"}), (pair, {"start": "two-star"})):
        shown = first_angles(stars_printout(sample, corrections=1, **start), 0)  # type: ignore[arg-type]
        assert_close("rae printed milliseconds", np.array(shown) * 3600.0, given * 3600.0)


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


def test_what_has_no_printout() -> None:
    same = StarField.of(STRAIGHT[[1, 1]], SEEN[[1, 1]], 100.0)
    with pytest.raises(VopdError, match=r"^the stars do not determine an attitude to start from$"):
        stars_printout(same)
    with pytest.raises(VopdError, match=r"^the attitude is undetermined after 0 corrections$"):
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
