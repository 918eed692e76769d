"""Bad input of every kind: a message that names the line, the right status, no traceback."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from tests.kit.star_files import COSINES, GROUND, SAMPLE, SKY, STARS, seen_straight
from tests.kit.star_files import solve_text as solve

CIRCLE = COSINES + "1,2,1,0,0\n5,6,0,1,0\n-7,3,.6,.8,0\n"
IMAGES_ON_A_LINE = COSINES + "-5,0,1,0,0\n1,0,0,1,0\n5,0,0,0,1\n"
CENTRE = COSINES + "5,6,0,1,0\n0,0,1,0,0\n-7,3,0,0,1\n"
BAD = {
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


@pytest.mark.parametrize("name", BAD)
def test_bad_input_is_status_1_and_names_its_line(name: str) -> None:
    text, arguments, said = BAD[name]
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
    run = subprocess.run(
        [sys.executable, "-m", "vopd", "stars", "solve", str(path), "--focal", "76"],
        capture_output=True, text=True,
    )  # fmt: skip
    assert run.returncode == 1 and "stars.csv: " in run.stderr and "Traceback" not in run.stderr


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
