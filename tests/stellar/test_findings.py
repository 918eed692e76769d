"""Errors and warnings about solutions."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit.command import vopd
from tests.kit.stars import COSINES, GROUND, SAMPLE, SKY, STARS, seen_straight
from tests.kit.stars import solve_text as solve
from vopd.findings import Finding, InputError
from vopd.mistakes import Explanation
from vopd.stellar.field import REASONS, Failure, StarField, image_directions
from vopd.stellar.files.findings import (
    counted,
    explain,
    explain_plausibility,
    refuse_unsolvable,
)
from vopd.stellar.files.mistakes import Plausibility
from vopd.stellar.files.photograph import SolvedPhotograph
from vopd.stellar.files.read import StarFile
from vopd.stellar.files.table import as_csv, solution_table, stated_conventions
from vopd.stellar.files.text import as_text
from vopd.stellar.methods.church import flatness
from vopd.stellar.methods.run import SolvedStars
from vopd.stellar.outlier_search import Outlier

# Every error and warning about a star solution: its words, numbers, lines, limits and severity


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
    assert str(found[1]) == f"a.csv: lines 11, 12 and 14: church: {FAILED[failure]}"
    assert (found[0], found[1].severity) == (f"church: {failure.name}", "error")


def test_an_attitude_that_is_too_uncertain_to_say_how_much() -> None:
    (found,) = explain(replace(SOLVED, failure=Failure.TOO_UNCERTAIN), star_file(), stars())
    assert found[1].message.endswith("with readings of this accuracy")


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
    assert str(found[1]) == f"a.csv: {said}"


def test_the_matrix_turns_stars_into_the_camera() -> None:
    """A quarter turn: object x becomes backward, so that stars along +x are behind."""
    matrix = [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
    field = stars(directions=[[0.6, 0.0, -0.8], [-0.6, 0.0, 0.8], [1, 0, 0], [-0.6, 0.8, 0.0]])
    one = replace(SOLVED, failure=Failure.BEHIND_CAMERA, matrix=matrix)
    (found,) = explain(one, star_file(), field)
    assert found[1].message.startswith("line 11: church: the star lies behind")


def test_an_image_at_the_principal_point() -> None:
    """To a millionth of the principal distance."""
    field = stars([[1.0, 2.0], [1.1e-5, 0.0], [-3.0, 1.0], [0.0, 0.9e-5]])
    one = replace(SOLVED, failure=Failure.PRINCIPAL_POINT)
    (found,) = explain(one, star_file(), field)
    assert str(found[1]) == (
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
    assert [(one[0], str(one[1]), one[1].severity) for one in found] == [
        ("single-rotation: axis", text, "warning")
    ]


@pytest.mark.parametrize("method", ["church", "church-weighted", "svd"])
def test_stars_near_a_great_circle(method: str) -> None:
    """Below a flatness of .01, of the stars that are solved; only Church's matrix minds."""
    for height, near in ((0.05, True), (0.9, False)):
        field = stars([[-3.0, 0.0], [0.0, height], [5.0, 5.0], [3.0, 0.0]])
        flat = float(flatness(field.select(np.array([0, 1, 3]))))
        assert (100.0 * flat < 1.0) == near
        found = explain(replace(SOLVED, method=method), star_file(), field)
        if not near or method == "svd":
            assert found == []
            continue
        text = f"{method}: the stars lie nearly on one great circle ({flat:.1e}): reading errors "
        text += f"grow up to {1.0 / flat:.0f} times"
        assert [(one[0], str(one[1]), one[1].severity) for one in found] == [
            (f"{method}: great circle", f"a.csv: lines 11, 12 and 14: {text}", "warning")
        ]


ABOUT_STARS = Explanation(0.0123456, "stars 2, 4 disagree", (1, 3))
ABOUT_UNITS = Explanation(0.0123456, "hours")
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
    assert [str(one[1]) for one in found] == [f"a.csv: {line}" for line in said]
    assert {(one[0], one[1].severity) for one in found} <= {("plausibility", "warning")}


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


# Bad input of every kind: a message that names the line, the right status, no traceback


CIRCLE = COSINES + "1,2,1,0,0\n5,6,0,1,0\n-7,3,.6,.8,0\n"
IMAGES_ON_A_LINE = COSINES + "-5,0,1,0,0\n1,0,0,1,0\n5,0,0,0,1\n"
CENTRE = COSINES + "5,6,0,1,0\n0,0,1,0,0\n-7,3,0,0,1\n"
BAD_REFUSALS = {
    "no star": (SKY, (), "line 2: no star follows"),
    "one star": (SKY + "1,2,3,4\n", (), "line 3: the only star"),
    "two of the three Church needs": (
        SKY + "1,2,3,4\n5,6,9,9\n", ("--method", "church"), "lines 3 and 4: church: takes three",
    ),
    "same star": (SKY + "1,2,3,4\n5,6,3,4\n", (), "lines 3 and 4: the same star twice"),
    "same star, a turn on": (SKY + "1,2,-30,4\n5,6,330,4\n", (), "the same star twice"),
    "same image": (SKY + "1,2,3,4\n1,2,9,9\n", (), "lines 3 and 4: the same image twice"),
    "one great circle": (CIRCLE, ("--method", "church"), "lines 2, 3 and 4: church: the stars"),
    "images on a line": (IMAGES_ON_A_LINE, ("--method", "church"), "on one great circle"),
    "behind": (
        (STARS / "stars_block_2.csv").read_text(),
        ("--initial", "20,-15,50"), "lines 4, 5 and 6: collinearity: these stars lie behind",
    ),
    "principal point": (CENTRE, ("--method", "church-weighted"), "line 3: church-weighted: an im"),
    "no number": (SKY + "1,2,3,4\n1,2,3,4x\n", (), "line 4: dec_deg: not an angle: '4x'"),
    "nan": (COSINES + "1,2,nan,0,0\n", (), "line 2: u: not a number: 'nan'"),
    "inf": (COSINES + "1,inf,1,0,0\n", (), "line 2: y_mm: not a number: 'inf'"),
    "underscore": (COSINES + "1_0,1,1,0,0\n", (), "line 2: x_mm: not a number: '1_0'"),
    "nothing": (COSINES + "1,,1,0,0\n", (), "line 2: y_mm: the cell is empty"),
    "61 minutes": (SKY + "1,2,3 61 0,4\n", (), "line 3: ra_deg: minutes and seconds"),
    "beyond the pole": (SKY + "1,2,3,91\n", (), "line 3: dec_deg: 91 is beyond +-90"),
    "more than a turn": (SKY + "1,2,361,4\n", (), "line 3: ra_deg: 361 is beyond +-360"),
    "hours of declination": (SKY + "1,2,3,5h0m0s\n", (), "line 3: dec_deg: not an angle"),
    "too few columns": (SKY + "1,2,3,4\n1,2,3\n", (), "line 4: 3 values, where the header names 4"),
    "too many columns": (SKY + "1,2,3,4,5\n", (), "line 3: 5 values, where the header names 4"),
    "no direction": (COSINES + "1,2,0,0,0\n", (), "line 2: u, v, w have no direction"),
    "two kinds": ("x_mm,y_mm,u,v,w,ra_deg,dec_deg\n", (), "line 1: the header must name one of"),
    "half a kind": ("x_mm,y_mm,u,v\n1,2,3,4\n", (), "line 1: the header lacks w"),
    "half a sigma": ("x_mm,y_mm,u,v,w,sigma_x_mm\n", (), "line 1: the header must name sigma_x_mm"),
    "no sigma": ("x_mm;y_mm;u;v;w;sigma\n1;2;0;0;1;0\n", (), "line 2: sigma: 0 is not a standard"),
    "tiny sigma": ("x_mm,y_mm,u,v,w,sigma\n1,2,0,0,1,1e-300\n", (), "line 2: sigma: 1e-300 is not"),
    "twice": ("x_mm,x_mm,y_mm,u,v,w\n", (), "line 1: the header names a column twice: x_mm"),
    "open quote": (SKY + '"1,2,3,4\n', (), "line 3: not CSV"),
    "no camera": (GROUND + "1,2,3,4,5\n6,7,8,9,1\n", (), "ground points need --camera"),
    "a needless camera": (SKY + "1,2,3,4\n5,6,7,8\n", ("--camera", "0,0,0"), "--camera is for"),
    "point at the camera": (
        GROUND + "1,2,3,4,5\n6,7,8,9,1\n", ("--camera", "8,9,1"), "line 3: the point is at the",
    ),
    "no such star": (SKY + "1,2,3,4\n5,6,7,8\n", ("--pair", "1,3"), "there is no star 3"),
    "a catalogue": (SKY + "1,2,3,4\n" * 5001, (), "line 5003: more than 5000 stars"),
    "too many pairs": (
        seen_straight(*((x, y) for x in range(15) for y in range(1, 15))),
        ("--all-pairs",), "210 stars: all pairs are solved of 200 at most",
    ),
    "a far image": (SKY + "1,2,3,4\n5,90000,7,8\n", (), "line 4: the image is more than 1000"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD_REFUSALS)
def test_bad_input_is_status_1_and_names_its_line(name: str) -> None:
    text, arguments, said = BAD_REFUSALS[name]
    result = solve(text, *arguments)
    assert (result.status, result.stdout) == (1, "")
    assert "standard input: " in result.stderr and said in result.stderr


def test_what_is_taken_with_a_warning() -> None:
    """Cosines not of length 1, and stars nearly on a great circle; both are solved."""
    long = solve(COSINES + "1,2,1,0,0\n5,6,0,1.001,0\n-7,3,0,0,1.0000005\n")
    assert "warning: standard input: line 3: u, v, w have length 1.001" in long.stderr
    assert "line 4: u, v, w" not in long.stderr
    flat = solve(seen_straight((-9.0, 0.0), (0.0, 0.3), (9.0, 0.0)), "--method", "church")
    assert "warning: " in flat.stderr and "nearly on one great circle" in flat.stderr


def test_no_convergence_in_50() -> None:
    """Status 3, and what it came to is shown: it is the caller's to judge."""
    far = ("--weights", "listed", "--initial", "100,40,-120", "--format", "json")
    result = solve(SAMPLE.read_text(), *far)
    assert result.status == 3 and "no convergence in 50 corrections" in result.stderr
    assert '"converged": false' in result.stdout and '"iterations": 50' in result.stdout


def test_one_method_that_fails_leaves_the_others() -> None:
    text = seen_straight((5.0, 6.0), (0.0, 0.0), (-7.0, 3.0), (4.0, -9.0))
    result = solve(text, "--method", "all", "--format", "csv")
    assert result.status == 1 and "church-weighted" in result.stderr
    assert any(line.startswith("church,") for line in result.stdout.splitlines())


@pytest.mark.parametrize("data", [b"\xff\xfe", b"x_mm\0", b"\x00", None])
def test_files_that_are_none(data: bytes | None, tmp_path: Path) -> None:
    path = tmp_path / "stars.csv"
    if data is not None:
        path.write_bytes(data)
    run = vopd("stars", "solve", path, "--focal", "76")
    assert (run.status, run.stdout) == (1, "")
    assert "stars.csv: " in run.stderr and "Traceback" not in run.stderr


@pytest.mark.parametrize(("first", "second"), [(3, 7), (0, 199), (198, 199)])
@pytest.mark.parametrize(("off", "refused"), [(0.9e-6, True), (1.1e-6, False)])
def test_the_same_star_is_found_among_many(
    first: int, second: int, off: float, refused: bool
) -> None:
    """Two of 200 stars are .19 seconds of arc apart, or .23; the limit is a sine of 1e-6."""
    rng = np.random.default_rng(17)
    vectors = rng.normal(size=(200, 3))
    vectors /= np.linalg.norm(vectors, axis=1)[:, None]
    across = np.cross(vectors[first], [0.0, 0.0, 1.0])
    vectors[second] = -(vectors[first] + off * across / np.linalg.norm(across))
    images = rng.uniform(-20.0, 20.0, (200, 2))
    lines = [
        ",".join(f"{v:.17g}" for v in (*xy, *u)) for xy, u in zip(images, vectors, strict=True)
    ]
    result = solve(COSINES + "\n".join(lines) + "\n")
    said = f"lines {first + 2} and {second + 2}: two stars in opposite directions"
    assert (said in result.stderr) == refused


# What is said of each reason for which stars give no attitude


def test_every_reason_in_words() -> None:
    """Rae's equation 3.17 is the weight wR = 1/r; it has no value at r = 0."""
    assert {failure.name: text for failure, text in REASONS.items()} == {
        "NOT_FINITE": "a coordinate is not a finite number",
        "TOO_FEW_STARS": "too few stars",
        "SAME_STAR": "the same star twice: two directions, or two images, coincide",
        "GREAT_CIRCLE": "the stars, or their images, lie on one great circle",
        "PRINCIPAL_POINT": "an image at the principal point, where weight wR (eq. 3.17) is "
        "infinite",
        "NO_ROTATION": "the rotation is zero, or a star lies on its axis",
        "AXIS_IN_PLANE": "the rotation axis lies in the plane of the two stars",
        "SINGULAR": "the stars leave the attitude undetermined, or every weight is zero",
        "NO_CONVERGENCE": "no convergence",
        "BEHIND_CAMERA": "a star lies behind the camera in the solution",
        "NOT_A_ROTATION": "the matrix as solved is far from a rotation: the stars lie too near "
        "one great circle for the errors of their images",
        "TOO_UNCERTAIN": "the stars do not determine the attitude with readings of this accuracy",
    }
    assert set(REASONS) == set(Failure) - {Failure.NONE}


# Every line of the text of one solution, with its numbers and units, from values made by hand


PLAIN = SolvedStars(
    method="svd",
    stars=(1, 3),
    failure=Failure.NONE,
    angles_deg=[1.0, -2.25, 3.5, 4.0, 5.0, -6.125],
    matrix=[[0.5, -0.25, 0.125], [1.0, 0.0, -1.0], [0.75, 0.0625, 0.03125]],
    orthogonality_defect=0.0,
    residuals=[[0.001, -0.002], [0.03, 0.04]],
    iterations=0,
    converged=True,
    rms=0.0125,
)
SIGMAS: dict[str, Any] = {
    "reading_sigma": 0.0123,
    "rotation_sigma_arcsec": [3.04, 4.0, 12.0],
    "rotation_covariance_arcsec2": np.eye(3).tolist(),
    "angle_sigmas_deg": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
    "boresight_95_arcsec": [20.0, 10.0],
    "boresight_95_angle_deg": 30.0,
}


def photograph(one: SolvedStars, **more: Any) -> SolvedPhotograph:
    image = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    file = StarFile(
        "orion.csv", (2, 3, 4), ("Rigel", "", "Saiph"), image, "mm", "ra_deg,dec_deg", image
    )
    stars = StarField.of(np.tile([0.0, 0.0, -1.0], (3, 1)), image, 76.0)
    file = replace(file, unit=more.pop("unit", "mm"))
    whole = SolvedPhotograph("", file, stars, np.arange(3), (one,), (), 0)
    return replace(whole, **more)


def details(one: SolvedStars, *, robust: bool = False, unit: str = "mm", **more: Any) -> list[str]:
    """The lines below the table, from `matrix` on."""
    lines = as_text([photograph(one, unit=unit, **more)], robust=robust).splitlines()
    return lines[3:]


MATRIX = [
    "matrix",
    "    0.5000000000   -0.2500000000    0.1250000000",
    "    1.0000000000    0.0000000000   -1.0000000000",
    "    0.7500000000    0.0625000000    0.0312500000",
]
RESIDUALS = [
    "",
    "residuals, observed minus computed",
    "  star        x mm        y mm",
    "     1    0.001000   -0.002000  Rigel",
    "     3    0.030000    0.040000  Saiph",
]
UNKNOWN_SENTENCE = [
    "",
    "no standard deviations: two stars do not tell the reading error; --reading-sigma states it",
]


def test_the_table() -> None:
    head, row, *_ = as_text([photograph(replace(PLAIN, **SIGMAS))]).splitlines()
    assert " ".join(head.split()) == (
        "method stars omega deg phi deg kappa deg alpha deg delta deg swing deg rms mm sigma sec"
    )
    assert row == (
        "svd               1,3          1.0000000   -2.2500000    3.5000000    4.0000000    "
        "5.0000000   -6.1250000   0.01250       13.0"
    )


def test_a_solution_without_uncertainty() -> None:
    assert details(PLAIN) == MATRIX + UNKNOWN_SENTENCE + RESIDUALS


@pytest.mark.parametrize(("freedom", "known"), [(None, "as stated"), (4, "as the residuals tell")])
def test_standard_deviations(freedom: int | None, known: str) -> None:
    lines = details(replace(PLAIN, **SIGMAS, reading_freedom=freedom))
    assert lines == [
        *MATRIX,
        "",
        f"standard deviations, for image coordinates good to 0.0123 mm ({known}):",
        "about the camera's x, y, z 3.0 4.0 12.0 seconds of arc",
        "in degrees omega 0.10000, phi 0.20000, kappa 0.30000, alpha 0.40000, delta 0.50000, "
        "swing 0.60000",
        "with a probability of 95 percent the optical axis lies in an ellipse with semi-axes of "
        "20.0 and 10.0",
        "seconds of arc, the longer one 30 degrees from north toward east",
        *RESIDUALS,
    ]


def test_weights_and_corrections_in_pixels() -> None:
    one = replace(
        PLAIN, **SIGMAS, iterations=3, weighted_rms=0.25, weights=[[0.5, 0.5], [0.25, 0.4]]
    )
    lines = details(one, robust=True, unit="px")
    assert lines[4:6] == ["", "3 corrections"]
    assert "good to 0.0123 px" in "\n".join(lines)
    assert "weighted rms of the residuals 0.25 px" in lines
    assert lines[-5:] == [
        "residuals, observed minus computed, and weights",
        "  star        x px        y px",
        "     1    0.001000   -0.002000         0.5         0.5    Rigel",
        "     3    0.030000    0.040000        0.25         0.4 *  Saiph",
        "* weight below 0.5: the star is not in the rms",
    ]
    assert not any("*" in line for line in details(one, unit="px"))


SKY_SENTENCE = {
    "ra_deg": 83.25, "dec_deg": -5.5, "ra_of_date_deg": 84.0, "dec_of_date_deg": -5.25,
    "azimuth_deg": 120.5, "elevation_deg": 35.25, "camera_roll_deg": 7.0,
    "vehicle_yaw_deg": 1.5, "vehicle_pitch_deg": -2.5, "vehicle_roll_deg": 3.5,
}  # fmt: skip
MORE: dict[str, tuple[dict[str, Any], list[str]]] = {
    "sky": (
        {"sky": SKY_SENTENCE},
        [
            "",
            "optical axis: right ascension 83.25000 = 5h33m00.000s, declination -5.50000 = "
            "-5°30'00.00\"",
            "optical axis: right ascension of date 84.00000 = 5h36m00.000s, declination -5.25000 "
            "= -5°15'00.00\"",
            "azimuth 120.50000, elevation 35.25000, camera roll 7.00000",
            "vehicle yaw 1.50000, pitch -2.50000, roll 3.50000",
        ],
    ),
    "camera": (
        {
            "camera": {"focal": 76.5, "centre_x": 0.25, "centre_y": -0.5, "k1": -0.01},
            "camera_sigmas": {"focal": 0.5, "centre_x": 0.02, "centre_y": 0.03, "k1": 0.004},
        },
        [
            "",
            "focal 76.5 mm, standard deviation 0.5 mm",
            "centre_x 0.25 mm, standard deviation 0.02 mm",
            "centre_y -0.5 mm, standard deviation 0.03 mm",
            "k1 -0.01, standard deviation 0.004",
        ],
    ),
    "resection": (
        {"camera_m": [1.0, -2.5, 3.0], "camera_sigma_m": [0.1, 0.25, 0.5]},
        ["", "camera at 1.000 -2.500 3.000 m, standard deviations 0.100 0.250 0.500 m"],
    ),
    "one rotation": (
        {
            "axis": [0.6, 0.0, -0.8], "angle_deg": 45.5, "axis_ra_deg": 0.5, "axis_dec_deg": -53.0,
            "conditioning": 0.5,
        },
        [
            "",
            "one rotation: 45.5000000 degrees about 0.6000000000 0.0000000000 -0.8000000000,",
            "right ascension 0.5000000, declination -53.0000000",
        ],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MORE)
def test_what_else_is_solved(name: str) -> None:
    changes, lines = MORE[name]
    assert details(replace(PLAIN, **changes)) == MATRIX + UNKNOWN_SENTENCE + lines + RESIDUALS


def test_the_epoch_and_what_moved_last() -> None:
    moving = replace(PLAIN, iterations=50, converged=False)
    text = as_text([photograph(moving, epoch="ICRS, epoch 1991.25")]).splitlines()
    assert text[1].endswith("  *") and text[2] == "* the last correction still moved an image"
    assert text[-1] == "right ascension and declination: ICRS, epoch 1991.25"
    assert "*" not in as_text([photograph(replace(moving, iterations=0))])


@pytest.mark.parametrize("severity", ["error", "warning"])
@pytest.mark.parametrize("count", [2, 3, 4, 9])
def test_findings_of_one_kind_are_counted(severity: Any, count: int) -> None:
    """Three are shown; the count of the others has the same severity and no line."""
    given = [("svd: x", Finding(f"svd: {k}", "a.csv", severity=severity)) for k in range(count)]
    shown = counted(given)
    assert shown[: min(count, 3)] == [one[1] for one in given[:3]]
    more = Finding(f"svd: {count - 3} more like these", "a.csv", severity=severity)
    assert shown[3:] == ([more] if count > 3 else [])


def test_findings_about_plausibility_are_all_shown() -> None:
    given = [("plausibility", Finding(str(k), "a.csv")) for k in range(9)]
    assert counted(given) == [one[1] for one in given]


def test_a_table_of_photographs_in_both_units() -> None:
    """Each has its cells in the columns of its own unit, and none in those of the other."""
    some = [
        photograph(replace(PLAIN, rms=0.5), label="a.csv"),
        photograph(replace(PLAIN, rms=2.5), label="b.csv", unit="px"),
    ]
    rows = list(csv.DictReader(io.StringIO(as_csv(some))))
    assert [(row["image"], row["rms_mm"], row["rms_px"]) for row in rows] == [
        ("a.csv", "0.5", ""),
        ("b.csv", "", "2.5"),
    ]
    values, columns = solution_table(some)
    np.testing.assert_array_equal(values["rms_mm"], [0.5, np.nan])
    np.testing.assert_array_equal(values["rms_px"], [np.nan, 2.5])
    assert values["residuals_px"].tolist() == ["", "0.001 -0.002 0.03 0.04"]
    for unit in ("mm", "px"):
        assert columns[f"rms_{unit}"]["unit"] == unit
    assert list(columns) == list(rows[0])
    assert (stated_conventions(some)["source"], values["converged"].tolist()) == (
        "orion.csv",
        ["true", "true"],
    )


def test_a_table_of_one_photograph_has_no_column_for_its_name() -> None:
    (row,) = csv.DictReader(io.StringIO(as_csv([photograph(replace(PLAIN, **SIGMAS))])))
    assert "image" not in row and not any(name.endswith("_px") for name in row)
    assert [row[name] for name in ("m11", "m12", "m21", "m33")] == [
        "0.5",
        "-0.25",
        "1.0",
        "0.03125",
    ]
    sigmas = [row[f"sigma_{axis}_arcsec"] for axis in "xyz"]
    assert sigmas == ["3.04", "4.0", "12.0"]
    covariance = [
        row[f"covariance_{pair}_arcsec2"] for pair in ("xx", "xy", "xz", "yy", "yz", "zz")
    ]
    assert covariance == ["1.0", "0.0", "0.0", "1.0", "0.0", "1.0"]
    major, minor = (row[f"boresight_95_{which}_arcsec"] for which in ("major", "minor"))
    assert (major, minor, row["boresight_95_angle_deg"]) == ("20.0", "10.0", "30.0")
    angles = [row[f"{name}_deg"] for name in ("omega", "phi", "kappa", "alpha", "delta", "swing")]
    assert angles == ["1.0", "-2.25", "3.5", "4.0", "5.0", "-6.125"]
    of_angles = [row[f"sigma_{name}_deg"] for name in ("omega", "phi", "kappa", "swing")]
    assert of_angles == ["0.1", "0.2", "0.3", "0.6"]
