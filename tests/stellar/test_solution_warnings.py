"""Every error and warning about a star solution: its words, numbers, lines, limits and severity."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from vopd.findings import InputError
from vopd.stellar.field import Failure, StarField, image_directions
from vopd.stellar.files.findings import explain, explain_plausibility, refuse_unsolvable
from vopd.stellar.files.mistakes import Plausibility, UsualMistake
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.church import flatness
from vopd.stellar.methods.run import SolvedStars
from vopd.stellar.outlier_search import Outlier

FOCAL = 10.0
IMAGE = np.array([[1.0, 2.0], [0.0, 0.9e-5], [-3.0, 1.0], [4.0, -2.0]])


def star_file(count: int = 4, unit: str = "mm") -> StarFile:
    lines = tuple(range(11, 11 + count))
    return StarFile("a.csv", lines, ("",) * count, IMAGE[:count], unit, "name", IMAGE[:count])


def stars(image: Any = IMAGE, directions: Any = None) -> StarField:
    image = np.array(image)
    seen = image_directions(image, FOCAL) if directions is None else np.array(directions, float)
    return StarField.of(seen, image, FOCAL)


SOLVED = SolvedStars(
    "church", (1, 2, 4), Failure.NONE, [], np.eye(3).tolist(), 0.0, [], 9, True, 0.0
)
FAILED = {  # the reason, as the end of the sentence
    Failure.NOT_FINITE: "a coordinate is not a finite number",
    Failure.TOO_FEW_STARS: "takes three stars at least",
    Failure.SAME_STAR: "the same star twice: two directions, or two images, coincide",
    Failure.GREAT_CIRCLE: "the stars, or their images, lie on one great circle",
    Failure.NO_ROTATION: "the rotation is zero, or a star lies on its axis",
    Failure.AXIS_IN_PLANE: "the rotation axis lies in the plane of the two stars",
    Failure.SINGULAR: "the stars leave the attitude undetermined, or every weight is zero",
    Failure.NO_CONVERGENCE: "no convergence in 50 corrections",
    Failure.NOT_A_ROTATION: "the matrix as solved is far from a rotation: the stars lie too near "
    "one great circle for the errors of their images",
    Failure.TOO_UNCERTAIN: "the stars do not determine the attitude with readings of this "
    "accuracy: its standard deviation is 3.1 degrees, above 3",
}


@pytest.mark.parametrize("failure", FAILED)
def test_why_there_is_no_solution(failure: Failure) -> None:
    one = replace(SOLVED, failure=failure, rotation_sigma_arcsec=[3600.0, 11_160.0, 7200.0])
    (found,) = explain(one, star_file(), stars())
    assert str(found.finding) == f"a.csv: lines 11, 12 and 14: church: {FAILED[failure]}"
    assert (found.kind, found.finding.severity) == (f"church: {failure.name}", "error")


def test_an_attitude_that_is_too_uncertain_to_say_how_much() -> None:
    (found,) = explain(replace(SOLVED, failure=Failure.TOO_UNCERTAIN), star_file(), stars())
    assert found.finding.message.endswith("with readings of this accuracy")


@pytest.mark.parametrize(
    ("behind", "said"),
    [
        ((1,), "line 12: church: the star lies behind the camera in the solution"),
        ((0, 3), "lines 11 and 14: church: these stars lie behind the camera in the solution"),
        ((), "lines 11, 12 and 14: church: these stars lie behind the camera in the solution"),
    ],
)
def test_stars_behind_the_camera(behind: tuple[int, ...], said: str) -> None:
    """Those that the matrix puts there, at right angles too; all where it is not known which."""
    directions = image_directions(IMAGE, FOCAL)
    directions[2] *= -1.0  # it is not of this solution
    for k in behind:
        directions[k] = [0.6, 0.8, 0.0] if k == 0 else -directions[k]
    one = replace(SOLVED, failure=Failure.BEHIND_CAMERA)
    (found,) = explain(one, star_file(), stars(directions=directions))
    assert str(found.finding) == f"a.csv: {said}"


def test_the_matrix_turns_stars_into_the_camera() -> None:
    """A quarter turn: object x becomes backward, so that stars along +x are behind."""
    matrix = [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
    field = stars(directions=[[0.6, 0.0, -0.8], [-0.6, 0.0, 0.8], [1, 0, 0], [-0.6, 0.8, 0.0]])
    one = replace(SOLVED, failure=Failure.BEHIND_CAMERA, matrix=matrix)
    (found,) = explain(one, star_file(), field)
    assert found.finding.message.startswith("line 11: church: the star lies behind")


def test_an_image_at_the_principal_point() -> None:
    """To a millionth of the principal distance."""
    field = stars([[1.0, 2.0], [1.1e-5, 0.0], [-3.0, 1.0], [0.0, 0.9e-5]])
    one = replace(SOLVED, failure=Failure.PRINCIPAL_POINT)
    (found,) = explain(one, star_file(), field)
    assert str(found.finding) == (
        "a.csv: line 14: church: an image at the principal point, where weight wR (eq. 3.17) is "
        "infinite; a reading sigma bounds it (--reading-sigma)"
    )


@pytest.mark.parametrize(("sine", "said"), [(0.2, None), (0.19999, "0.200"), (0.05, "0.050")])
def test_a_rotation_axis_near_the_plane_of_the_stars(sine: float, said: str | None) -> None:
    one = replace(SOLVED, method="single-rotation", stars=(1, 3), conditioning=sine)
    found = explain(one, star_file(), stars())
    if said is None:
        assert found == []
        return
    text = (
        "a.csv: lines 11 and 13: single-rotation: the rotation axis lies near the plane of the two "
        f"stars: sin(D1, D2) = {said} is below 0.2, and reading errors grow about "
        f"{round(1 / sine)} times"
    )
    assert [(one.kind, str(one.finding), one.finding.severity) for one in found] == [
        ("single-rotation: axis", text, "warning")
    ]


@pytest.mark.parametrize("method", ["church", "church-weighted", "svd"])
def test_stars_near_a_great_circle(method: str) -> None:
    """Below a flatness of .01, of the stars that are solved; only Church's matrix minds."""
    for height, near in ((0.05, True), (0.9, False)):
        field = stars([[-3.0, 0.0], [0.0, height], [5.0, 5.0], [3.0, 0.0]])
        flat = float(flatness(field.only(np.array([0, 1, 3]))))
        assert (100.0 * flat < 1.0) == near
        found = explain(replace(SOLVED, method=method), star_file(), field)
        if not near or method == "svd":
            assert found == []
            continue
        text = f"{method}: the stars lie nearly on one great circle ({flat:.1e}): reading errors "
        text += f"grow up to {1.0 / flat:.0f} times"
        assert [(one.kind, str(one.finding), one.finding.severity) for one in found] == [
            (f"{method}: great circle", f"a.csv: lines 11, 12 and 14: {text}", "warning")
        ]


ABOUT_STARS = UsualMistake("stars 2, 4 disagree", 0.0123456, (1, 3))
ABOUT_UNITS = UsualMistake("hours", 0.0123456)
OUTLIERS = (Outlier(3, 1.23456, 1.23e-7), Outlier(0, 0.5, 0.0009))
LARGE = "the residuals are implausible: 9.88 px, where less is allowed"
UNKNOWN = "the residuals are implausible: no attitude fits, where less is allowed"
THEN = "; the residuals are then 0.0123 px"
AWAY = "from where their attitude puts it (chance {})"
NOT_FIT = [
    "line 14: star 4 does not fit the others: its image is 1.23 px " + AWAY.format("1e-07"),
    "line 11: star 1 does not fit the others: its image is 0.5 px " + AWAY.format("0.0009"),
]
LEFT_OUT = [line.replace("does not fit the others", "is left out") for line in NOT_FIT]
STARS_LINE = "lines 12 and 14: stars 2, 4 disagree" + THEN
BAD = Plausibility(9.87654, "less is allowed", unexplained="why?")
SAID: list[tuple[Plausibility, bool, list[str]]] = [
    (Plausibility(0.1), False, []),
    (Plausibility(0.1), True, []),
    (BAD, False, [LARGE, "why?"]),
    (BAD, True, [LARGE, "why?"]),
    (BAD._replace(sigma=np.inf), False, [UNKNOWN, "why?"]),
    (BAD._replace(mistake=ABOUT_UNITS), False, [LARGE, "hours" + THEN]),
    (BAD._replace(mistake=ABOUT_UNITS), True, [LARGE, "hours" + THEN]),
    (BAD._replace(mistake=ABOUT_STARS, outliers=OUTLIERS), False, [LARGE, STARS_LINE]),
    (BAD._replace(mistake=ABOUT_STARS, outliers=OUTLIERS), True, LEFT_OUT),
    (BAD._replace(outliers=OUTLIERS), False, [LARGE, "why?", *NOT_FIT]),
    (BAD._replace(outliers=OUTLIERS), True, [LARGE, "why?", *LEFT_OUT]),
    (Plausibility(0.1, outliers=OUTLIERS), False, NOT_FIT),
    (Plausibility(0.1, outliers=OUTLIERS), True, LEFT_OUT),
]  # fmt: skip


@pytest.mark.parametrize(("judged", "rejected", "said"), SAID)
def test_residuals_that_are_too_large(
    judged: Plausibility, rejected: bool, said: list[str]
) -> None:
    found = explain_plausibility(judged, star_file(unit="px"), rejected=rejected)
    assert [str(one.finding) for one in found] == [f"a.csv: {line}" for line in said]
    assert {(one.kind, one.finding.severity) for one in found} <= {("plausibility", "warning")}


OUT = "the image is more than 1000 focal lengths out"
PAIR = [[1.0, 2.0], [3.0, 4.0]]
AHEAD = [[0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [0.0, 0.6, -0.8], [0.48, 0.36, -0.8]]
OPPOSITE = [[0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [0.0, 0.6, -0.8], [-0.6, 0.0, 0.8]]
TWICE = [AHEAD[0], AHEAD[1], AHEAD[2], AHEAD[1]]
TWO_TWICE = [AHEAD[1], AHEAD[2], AHEAD[2], AHEAD[1]]
TWO_OTHERS = [AHEAD[2], AHEAD[1], AHEAD[1], AHEAD[2]]
REFUSED: list[tuple[Any, Any, str]] = [
    ([[1.0, 2.0], [3.0, 10_000.1]], None, f"line 12: {OUT}"),
    ([[-10_000.1, 0.0], [3.0, 4.0]], None, f"line 11: {OUT}"),
    ([[1.0, 2.0], [3.0, 4.0], [10_001.0, 0.0], [1.0, 1.0]], None, f"line 13: {OUT}"),
    ([[1.0, 2.0]], None, "line 11: the only star: an attitude takes two at least"),
    (IMAGE, OPPOSITE, "lines 12 and 14: two stars in opposite directions"),
    (IMAGE, TWICE, "lines 12 and 14: the same star twice"),
    (IMAGE, TWO_TWICE, "lines 11 and 14: the same star twice"),
    ([[1.0, 2.0], [3.0, 4.0], [1.0, 2.0], [5.0, 6.0]], TWICE, "lines 12 and 14: the same star "
     "twice"),
    (IMAGE, TWO_OTHERS, "lines 11 and 14: the same star twice"),
    ([[1.0, 2.0], [3.0, 4.0], [1.0, 2.0], [5.0, 6.0]], AHEAD, "lines 11 and 13: the same image "
     "twice"),
]  # fmt: skip


@pytest.mark.parametrize(("image", "directions", "said"), REFUSED)
def test_what_no_method_can_solve(image: Any, directions: Any, said: str) -> None:
    with pytest.raises(InputError) as caught:
        refuse_unsolvable(star_file(len(image)), stars(image, directions))
    assert str(caught.value) == f"a.csv: {said}"


@pytest.mark.parametrize("image", [PAIR, [[10_000.0, -10_000.0], [1.0, 2.0]], IMAGE])
def test_what_can_be_solved(image: Any) -> None:
    refuse_unsolvable(star_file(len(image)), stars(image))


def test_the_same_star_to_a_fifth_of_a_second() -> None:
    """A sine of 1E-6; the two need not be neighbours by their distance from any plane."""
    for off, refused in ((0.9e-6, True), (1.1e-6, False)):
        near = [[0.6, 0.0, -0.8], [0.0, 0.6, -0.8], [0.6, off, -0.8], [0.0, 0.0, -1.0]]
        if refused:
            with pytest.raises(InputError, match=r"lines 11 and 13: the same star twice"):
                refuse_unsolvable(star_file(), stars(IMAGE, near))
        else:
            refuse_unsolvable(star_file(), stars(IMAGE, near))


def test_the_same_star_with_others_between_in_any_order() -> None:
    """Sixty others lie between the two by their distance from any of sixty planes."""
    rng = np.random.default_rng(1)
    one = np.array([0.6, 0.0, -0.8])
    step = np.array([0.64, 0.6, 0.48])
    other = one + 0.9e-6 * (step - (step @ one) * one) / np.linalg.norm(np.cross(step, one))
    normal = np.array([0.48, -0.64, 0.6])
    normals = [normal, *rng.normal(size=(59, 3))]
    between = []
    for k, axis in enumerate(normals):
        axis = axis / np.linalg.norm(axis)
        middle = (axis @ one + axis @ other) / 2.0
        across = np.cross(axis, [np.sin(k), np.cos(k), 0.3])
        across /= np.linalg.norm(across)
        between.append(middle * axis + (1.0 - middle**2) ** 0.5 * across)
    image = rng.uniform(-9.0, 9.0, (62, 2))
    lines = tuple(range(11, 73))
    file = StarFile("a.csv", lines, ("",) * 62, image, "mm", "name", image)
    with pytest.raises(InputError, match=r"lines 11 and 72: the same star twice"):
        refuse_unsolvable(file, stars(image, [one, *between, other]))
