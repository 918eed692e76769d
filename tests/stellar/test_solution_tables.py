"""The table of attitudes as text: columns, widths, labels, marks, and what follows the table."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from vopd.stellar.field import Failure, StarField, image_directions
from vopd.stellar.files.photograph import SolvedPhotograph
from vopd.stellar.files.read import StarFile
from vopd.stellar.files.text import as_text
from vopd.stellar.methods.run import SolvedStars

ONE = SolvedStars(
    "svd", (1, 2), Failure.NONE, [1.0, 2.0, 3.0, 4.0, 5.0, -176.12345678],
    np.eye(3).tolist(), 0.0, [[0.0, 0.0], [0.0, 0.0]], 0, True, 0.123456,
)  # fmt: skip
IMAGES = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])


def photograph(*solved: SolvedStars, unit: str = "mm", **more: Any) -> SolvedPhotograph:
    file = StarFile("a.csv", (2, 3, 4), ("Rigel", "", "Saiph"), IMAGES, unit, "name", IMAGES)
    stars = StarField.of(image_directions(IMAGES, 1.0), IMAGES, 1.0)
    whole = SolvedPhotograph("", file, stars, np.arange(3), solved, (), 0)
    return replace(whole, **more)


HEAD = "   omega deg      phi deg    kappa deg    alpha deg    delta deg    swing deg"
ANGLES = "   1.0000000    2.0000000    3.0000000    4.0000000    5.0000000 -176.1234568"


def test_every_column_of_pairs_and_both_units() -> None:
    """A column is there where any row has a value of it; the others leave it empty."""
    some = [
        photograph(replace(ONE, conditioning=0.98765), ONE, unit="px", label="b"),
        photograph(
            replace(ONE, interstar_discrepancy_arcsec=-12.345, method="collinearity"),
            replace(ONE, rotation_sigma_arcsec=[3.0, 4.0, 12.06]),
            label="longest",
        ),
    ]
    assert as_text(some).splitlines() == [
        f"image   method            stars     {HEAD}    rms px    rms mm  sigma sec sin(D1,D2) "
        "discr. sec",
        f"b       svd               1,2       {ANGLES}   0.12346                           0.988",
        f"b       svd               1,2       {ANGLES}   0.12346",
        f"longest collinearity      1,2       {ANGLES}             0.12346" + " " * 27 + "-12.35",
        f"longest svd               1,2       {ANGLES}             0.12346       13.1",
    ]


def test_a_short_label_leaves_room_for_its_title() -> None:
    head, first, second = as_text([photograph(ONE, label="x"), photograph(ONE)]).splitlines()
    assert head.startswith("image method            stars ")
    assert first.startswith("x     svd ") and second.startswith("      svd ")


STARS = {
    (3,): "3", (1, 2): "1,2", (1, 2, 3, 4): "1,2,3,4", (1, 2, 3, 4, 5): "1-5",
    (7, 8, 9, 10, 11, 12): "7-12", (1, 2, 3, 4, 6): "1,2,3,4,6", (1, 3, 4, 5, 6): "1,3,4,5,6",
    (2, 1, 3, 4, 5): "2,1,3,4,5",
}  # fmt: skip


@pytest.mark.parametrize("stars", STARS)
def test_numbers_of_stars(stars: tuple[int, ...]) -> None:
    two = [replace(ONE, stars=stars), ONE]
    assert as_text([photograph(*two)]).splitlines()[1].split()[1] == STARS[stars]


def test_solutions_that_still_moved_are_marked() -> None:
    """Those without iteration never are; the sentence is there once, where one is marked."""
    still, moved = replace(ONE, iterations=4), replace(ONE, iterations=1, converged=False)
    no_iteration = replace(ONE, converged=False)
    lines = as_text([photograph(still, moved, no_iteration, ONE)]).splitlines()
    assert [line.endswith("  *") for line in lines[1:5]] == [False, True, False, False]
    assert lines[5:] == ["* the last correction still moved an image"]
    assert "*" not in as_text([photograph(still, no_iteration)])


def test_details_are_of_a_single_solution() -> None:
    assert "matrix" in as_text([photograph(ONE)])
    assert "matrix" in as_text([photograph(), photograph(ONE)])
    assert "matrix" not in as_text([photograph(ONE, ONE)])
    assert "matrix" not in as_text([photograph(ONE), photograph(ONE)])
    assert as_text([photograph()]) == "" and as_text([]) == ""


@pytest.mark.parametrize(
    ("defect", "line"),
    [
        (0.9e-9, "matrix"),
        (1.1e-9, "matrix (as solved its orthogonality defect is 1.1e-09)"),
        (0.01234, "matrix (as solved its orthogonality defect is 1.2e-02)"),
    ],
)
def test_a_matrix_that_is_no_rotation(defect: float, line: str) -> None:
    lines = as_text([photograph(replace(ONE, orthogonality_defect=defect))]).splitlines()
    assert lines[2:4] == ["", line]


@pytest.mark.parametrize("iterations", [1, 2])
def test_corrections(iterations: int) -> None:
    text = as_text([photograph(replace(ONE, iterations=iterations))])
    assert f"\n\n{iterations} corrections\n" in text


def test_epochs_of_all_photographs() -> None:
    """Each once, in their order, of those that have a solution."""
    some = [
        photograph(ONE, epoch="b"), photograph(ONE, epoch="a"), photograph(ONE, epoch="b"),
        photograph(epoch="c"), photograph(ONE), photograph(ONE, ONE, epoch="d"),
    ]  # fmt: skip
    lines = as_text(some).splitlines()
    assert lines[-4:] == ["", *(f"right ascension and declination: {one}" for one in "bad")]


def test_weights_that_make_a_star_count_less() -> None:
    """Below .5 in both of its coordinates; only where they are robust."""
    weights = [[0.5, 0.1], [0.4999, 0.3]]
    one = photograph(replace(ONE, weights=weights))
    lines = as_text([one], robust=True).splitlines()[-4:]
    assert [line.rstrip()[-1:] == "*" or " *  " in line for line in lines[1:3]] == [False, True]
    assert lines[3] == "* weight below 0.5: the star is not in the rms"
    assert lines[1].endswith("0.5         0.1    Rigel") and "0.3 *" in lines[2]
    plain = as_text([one])
    assert "*" not in plain and "computed, and weights\n" in plain
    assert "weights" not in as_text([photograph(ONE)], robust=True)
    full = photograph(replace(ONE, weights=[[1.0, 1.0], [0.5, 0.5]]))
    assert "weight below" not in as_text([full], robust=True)
    first = photograph(replace(ONE, weights=weights[::-1]))
    assert as_text([first], robust=True).endswith(
        "* weight below 0.5: the star is not in the rms\n"
    )


def test_digits_of_a_solved_camera() -> None:
    one = replace(
        ONE, camera={"focal": 1234.56789, "k1": -0.0123456789},
        camera_sigmas={"focal": 1.2345, "k1": 0.00456},
    )  # fmt: skip
    lines = as_text([photograph(one, unit="px", file=photograph(unit="px").file)]).splitlines()
    assert "focal 1234.5679 px, standard deviation 1.2 px" in lines
    assert "k1 -0.012345679, standard deviation 0.0046" in lines


def test_digits_of_deviations_and_weights() -> None:
    one = replace(
        ONE, reading_sigma=0.0123456, rotation_sigma_arcsec=[1.26, 2.34, 12.06],
        angle_sigmas_deg=[0.123456] * 6, boresight_95_arcsec=[20.26, 10.04],
        boresight_95_angle_deg=43.6, reading_freedom=1,
        weighted_rms=0.0123456,
        weights=[[0.98765, 1.0], [12.3456, 2.0]],
    )  # fmt: skip
    lines = as_text([photograph(one)]).splitlines()
    for part in (
        "image coordinates good to 0.0123 mm (as the residuals tell):",
        "x, y, z 1.3 2.3 12.1 seconds of arc",
        "omega 0.12346, phi 0.12346,", "semi-axes of 20.3 and 10.0", "the longer one 44 degrees",
        "weighted rms of the residuals 0.0123 mm", " 0.988           1", " 12.3           2",
    ):  # fmt: skip
        assert any(part in line for line in lines), part


def test_disagreements_of_stars() -> None:
    """Images at 45 degrees from the first and 60 from each other, of stars at right angles."""
    sky = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    stars = StarField.of(sky, IMAGES, 1.0)
    pair = replace(ONE, disagreement_arcsec=[0.0, 0.0])
    pages = as_text([photograph(ONE, pair, stars=stars, label="night"), photograph(ONE)])
    assert pages.split("\n\n")[-1].splitlines() == [
        "night",
        "disagreement of each star with the others: angles between the stars minus angles",
        "between their images, sizes added up, and their median, seconds of arc",
        "  star          sum       median",
        "     1    324000.00    162000.00  Rigel",  # 45 and 45 degrees
        "     2    270000.00    135000.00",  # 45 and 30
        "     3    270000.00    135000.00  Saiph",
    ]
    two = [photograph(pair, stars=stars, label=name) for name in ("night", "day")]
    assert [line for line in as_text(two).splitlines() if line in ("night", "day")] == [
        "night",
        "day",
    ]
    alone = as_text([photograph(pair, pair, stars=stars)])
    assert "\n\ndisagreement of each star" in alone and alone.endswith("Saiph\n")
