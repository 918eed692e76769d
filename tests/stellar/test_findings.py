"""Errors and warnings about solutions."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import vopd
from tests.kit.stars import COSINES, GROUND, SKY, STARS, seen_straight
from tests.kit.stars import solve_text as solve
from vopd.findings import Finding, InputError
from vopd.stellar.field import Failure, StarField, image_directions
from vopd.stellar.files.findings import (
    counted,
    explain,
    explain_plausibility,
    refuse_unsolvable,
)
from vopd.stellar.files.mistakes import Plausibility
from vopd.stellar.files.read import StarFile
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


@pytest.mark.parametrize(
    "behind",
    [
        (1,),
        (0, 3),
        (),
    ],
)
def test_stars_behind_the_camera(behind: tuple[int, ...]) -> None:
    """Those that the matrix puts there, at right angles too; all where it is not known which."""
    directions = image_directions(IMAGE, FOCAL)
    directions[2] *= -1.0  # it is not of this solution
    for k in behind:
        directions[k] = [0.6, 0.8, 0.0] if k == 0 else -directions[k]
    one = replace(SOLVED, failure=Failure.BEHIND_CAMERA)
    (found,) = explain(one, star_file(), stars(directions=directions))
    assert_approved(str(found[1]))


def test_the_matrix_turns_stars_into_the_camera() -> None:
    """A quarter turn: object x becomes backward, so that stars along +x are behind."""
    matrix = [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]
    field = stars(directions=[[0.6, 0.0, -0.8], [-0.6, 0.0, 0.8], [1, 0, 0], [-0.6, 0.8, 0.0]])
    one = replace(SOLVED, failure=Failure.BEHIND_CAMERA, matrix=matrix)
    (found,) = explain(one, star_file(), field)
    assert_approved(found[1].message)


def test_an_image_at_the_principal_point() -> None:
    """To a millionth of the principal distance."""
    field = stars([[1.0, 2.0], [1.1e-5, 0.0], [-3.0, 1.0], [0.0, 0.9e-5]])
    one = replace(SOLVED, failure=Failure.PRINCIPAL_POINT)
    (found,) = explain(one, star_file(), field)
    assert_approved(str(found[1]))


@pytest.mark.parametrize(("sine", "said"), [(0.2, None), (0.19999, "0.200"), (0.05, "0.050")])
def test_a_rotation_axis_near_the_plane_of_the_stars(sine: float, said: str | None) -> None:
    one = replace(SOLVED, method="single-rotation", stars=(1, 3), conditioning=sine)
    found = explain(one, star_file(), stars())
    if said is None:
        assert found == []
        return
    assert_approved(
        [(one[0], str(one[1]), one[1].severity) for one in found],
        parts=[said, f"{round(1 / sine)} times"],
    )


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
        assert_approved(
            [(one[0], str(one[1]), one[1].severity) for one in found],
            parts=[method, method, f"{flat:.1e}", f"{1.0 / flat:.0f}"],
        )


PAIR = [[1.0, 2.0], [3.0, 4.0]]
AHEAD = [[0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [0.0, 0.6, -0.8], [0.48, 0.36, -0.8]]
OPPOSITE = [[0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [0.0, 0.6, -0.8], [-0.6, 0.0, 0.8]]
TWICE = [AHEAD[0], AHEAD[1], AHEAD[2], AHEAD[1]]
TWO_TWICE = [AHEAD[1], AHEAD[2], AHEAD[2], AHEAD[1]]
TWO_OTHERS = [AHEAD[2], AHEAD[1], AHEAD[1], AHEAD[2]]
REFUSED = [
    ([[1.0, 2.0], [3.0, 10_000.1]], None),
    ([[-10_000.1, 0.0], [3.0, 4.0]], None),
    ([[1.0, 2.0], [3.0, 4.0], [10_001.0, 0.0], [1.0, 1.0]], None),
    ([[1.0, 2.0]], None),
    (IMAGE, OPPOSITE),
    (IMAGE, TWICE),
    (IMAGE, TWO_TWICE),
    ([[1.0, 2.0], [3.0, 4.0], [1.0, 2.0], [5.0, 6.0]], TWICE),
    (IMAGE, TWO_OTHERS),
    ([[1.0, 2.0], [3.0, 4.0], [1.0, 2.0], [5.0, 6.0]], AHEAD),
]  # fmt: skip


@pytest.mark.parametrize(("image", "directions"), REFUSED)
def test_what_no_method_can_solve(image: Any, directions: Any) -> None:
    with refused(InputError):
        refuse_unsolvable(star_file(len(image)), stars(image, directions))


@pytest.mark.parametrize("image", [PAIR, [[10_000.0, -10_000.0], [1.0, 2.0]], IMAGE])
def test_what_can_be_solved(image: Any) -> None:
    refuse_unsolvable(star_file(len(image)), stars(image))


def test_the_same_star_to_a_fifth_of_a_second() -> None:
    """A sine of 1E-6; the two need not be neighbours by their distance from any plane."""
    for off, refusal in ((0.9e-6, True), (1.1e-6, False)):
        near = [[0.6, 0.0, -0.8], [0.0, 0.6, -0.8], [0.6, off, -0.8], [0.0, 0.0, -1.0]]
        if refusal:
            with refused(InputError):
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
    with refused(InputError):
        refuse_unsolvable(file, stars(image, [one, *between, other]))


# Bad input of every kind: a message that names the line, the right status, no traceback


CIRCLE = COSINES + "1,2,1,0,0\n5,6,0,1,0\n-7,3,.6,.8,0\n"
IMAGES_ON_A_LINE = COSINES + "-5,0,1,0,0\n1,0,0,1,0\n5,0,0,0,1\n"
CENTRE = COSINES + "5,6,0,1,0\n0,0,1,0,0\n-7,3,0,0,1\n"
BAD_REFUSALS = {
    "no star": (SKY, ()),
    "one star": (SKY + "1,2,3,4\n", ()),
    "two of the three Church needs": (
        SKY + "1,2,3,4\n5,6,9,9\n", ("--method", "church")
    ),
    "same star": (SKY + "1,2,3,4\n5,6,3,4\n", ()),
    "same star, a turn on": (SKY + "1,2,-30,4\n5,6,330,4\n", ()),
    "same image": (SKY + "1,2,3,4\n1,2,9,9\n", ()),
    "one great circle": (CIRCLE, ("--method", "church")),
    "images on a line": (IMAGES_ON_A_LINE, ("--method", "church")),
    "behind": (
        (STARS / "stars_block_2.csv").read_text(),
        ("--initial", "20,-15,50")
    ),
    "principal point": (CENTRE, ("--method", "church-weighted")),
    "no number": (SKY + "1,2,3,4\n1,2,3,4x\n", ()),
    "nan": (COSINES + "1,2,nan,0,0\n", ()),
    "inf": (COSINES + "1,inf,1,0,0\n", ()),
    "underscore": (COSINES + "1_0,1,1,0,0\n", ()),
    "nothing": (COSINES + "1,,1,0,0\n", ()),
    "61 minutes": (SKY + "1,2,3 61 0,4\n", ()),
    "beyond the pole": (SKY + "1,2,3,91\n", ()),
    "more than a turn": (SKY + "1,2,361,4\n", ()),
    "hours of declination": (SKY + "1,2,3,5h0m0s\n", ()),
    "too few columns": (SKY + "1,2,3,4\n1,2,3\n", ()),
    "too many columns": (SKY + "1,2,3,4,5\n", ()),
    "no direction": (COSINES + "1,2,0,0,0\n", ()),
    "two kinds": ("x_mm,y_mm,u,v,w,ra_deg,dec_deg\n", ()),
    "half a kind": ("x_mm,y_mm,u,v\n1,2,3,4\n", ()),
    "half a sigma": ("x_mm,y_mm,u,v,w,sigma_x_mm\n", ()),
    "no sigma": ("x_mm;y_mm;u;v;w;sigma\n1;2;0;0;1;0\n", ()),
    "tiny sigma": ("x_mm,y_mm,u,v,w,sigma\n1,2,0,0,1,1e-300\n", ()),
    "twice": ("x_mm,x_mm,y_mm,u,v,w\n", ()),
    "open quote": (SKY + '"1,2,3,4\n', ()),
    "no camera": (GROUND + "1,2,3,4,5\n6,7,8,9,1\n", ()),
    "a needless camera": (SKY + "1,2,3,4\n5,6,7,8\n", ("--camera", "0,0,0")),
    "point at the camera": (
        GROUND + "1,2,3,4,5\n6,7,8,9,1\n", ("--camera", "8,9,1")
    ),
    "no such star": (SKY + "1,2,3,4\n5,6,7,8\n", ("--pair", "1,3")),
    "a catalogue": (SKY + "1,2,3,4\n" * 5001, ()),
    "too many pairs": (
        seen_straight(*((x, y) for x in range(15) for y in range(1, 15))),
        ("--all-pairs",)
    ),
    "a far image": (SKY + "1,2,3,4\n5,90000,7,8\n", ()),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD_REFUSALS)
def test_bad_input_is_status_1_and_names_its_line(name: str) -> None:
    text, arguments = BAD_REFUSALS[name]
    result = solve(text, *arguments)
    assert (result.status, result.stdout) == (1, "")
    why = "not CSV: " if name == "open quote" else ""
    assert_approved(result.stderr, parts=["standard input: "], others_after=why)


def test_what_is_taken_with_a_warning() -> None:
    """Cosines not of length 1, and stars nearly on a great circle; both are solved."""
    long = solve(COSINES + "1,2,1,0,0\n5,6,0,1.001,0\n-7,3,0,0,1.0000005\n")
    assert "warning: standard input: line 3: u, v, w have length 1.001" in long.stderr
    assert "line 4: u, v, w" not in long.stderr
    flat = solve(seen_straight((-9.0, 0.0), (0.0, 0.3), (9.0, 0.0)), "--method", "church")
    assert "warning: " in flat.stderr
    assert_approved(flat.stderr)


@pytest.mark.parametrize("data", [b"\xff\xfe", b"x_mm\0", b"\x00", None])
def test_files_that_are_none(data: bytes | None, tmp_path: Path) -> None:
    path = tmp_path / "stars.csv"
    if data is not None:
        path.write_bytes(data)
    run = vopd("stars", "solve", path, "--focal", "76")
    assert (run.status, run.stdout) == (1, "")
    assert "stars.csv: " in run.stderr and "Traceback" not in run.stderr


@pytest.mark.parametrize(("first", "second"), [(3, 7), (0, 199), (198, 199)])
@pytest.mark.parametrize(("off", "refusal"), [(0.9e-6, True), (1.1e-6, False)])
def test_the_same_star_is_found_among_many(
    first: int, second: int, off: float, refusal: bool
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
    assert (said in result.stderr) == refusal


# What is said of each reason for which stars give no attitude


# Every line of the text of one solution, with its numbers and units, from values made by hand


@pytest.mark.parametrize("severity", ["error", "warning"])
@pytest.mark.parametrize("count", [2, 3, 4, 9])
def test_findings_of_one_kind_are_counted(severity: Any, count: int) -> None:
    """Three are shown; the count of the others has the same severity and no line."""
    given = [("svd: x", Finding(f"svd: {k}", "a.csv", severity=severity)) for k in range(count)]
    shown = counted(given)
    assert shown[: min(count, 3)] == [one[1] for one in given[:3]]
    more = Finding(f"svd: {count - 3} more like these", "a.csv", severity=severity)
    assert shown[3:] == ([more] if count > 3 else [])
    notes = counted(("note 0", one) for _, one in given)
    plain = replace(more, message=f"{count - 3} more like these")
    assert notes[3:] == ([plain] if count > 3 else [])


def test_findings_about_plausibility_are_all_shown() -> None:
    given = [("plausibility", Finding(str(k), "a.csv")) for k in range(9)]
    assert counted(given) == [one[1] for one in given]


@pytest.mark.parametrize(("wrong", "doubted"), [(3, False), (4, True)])
def test_many_stars_that_are_left_out_put_the_others_in_doubt(wrong: int, doubted: bool) -> None:
    """Of ten stars, from four on."""
    outliers = tuple(Outlier(k, 1.0, 1e-9) for k in range(wrong))
    judged = Plausibility(0.01, outliers=outliers)
    file = replace(star_file(), lines=tuple(range(11, 21)))
    found = [one for kind, one in explain_plausibility(judged, file, rejected=True)
             if kind == "many left out"]  # fmt: skip
    assert len(found) == doubted
    if doubted:
        assert_approved(found[0])
    kept = explain_plausibility(judged, file, rejected=False)
    assert not [kind for kind, _ in kept if kind == "many left out"]
