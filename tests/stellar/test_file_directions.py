"""Directions of a star file by each kind of position, and how findings name its lines."""

from __future__ import annotations

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import Finding, InputError
from vopd.stellar.files.read import StarFile, file_directions, lines_text


def star_file(kind: str, positions: list[list[float]], **more: str) -> StarFile:
    count = len(positions)
    lines = tuple(range(11, 11 + count))
    return StarFile(
        "a.csv", lines, ("",) * count, np.zeros((count, 2)), "mm", kind, np.array(positions), **more
    )  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", ["ra_deg,dec_deg", "ra_hours,dec_deg"])
def test_right_ascension_and_declination(kind: str) -> None:
    """Both are in degrees, as they were read."""
    file = star_file(kind, [[0.0, 0.0], [90.0, 0.0], [0.0, 90.0], [180.0, -30.0]])
    expected = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-(0.75**0.5), 0, -0.5]]
    assert_close("rae element", file_directions(file), expected)


def test_ground_points() -> None:
    file = star_file("x_m,y_m,z_m", [[10.0, 20.0, 30.0], [13.0, 24.0, 30.0]])
    camera = np.array([10.0, 20.0, 40.0])
    long = (9.0 + 16.0 + 100.0) ** 0.5
    expected = [[0.0, 0.0, -1.0], [3.0 / long, 4.0 / long, -10.0 / long]]
    assert_close("rae element", file_directions(file, camera), expected)
    with pytest.raises(InputError) as caught:
        file_directions(file)
    assert str(caught.value) == "a.csv: ground points need the camera's position"
    with pytest.raises(InputError) as caught:
        file_directions(file, np.array([13.0, 24.0, 30.0]))
    assert str(caught.value) == "a.csv: line 12: the point is at the camera"


def test_direction_cosines() -> None:
    """Those of length 1 to a millionth are as they are given; others are said, and divided."""
    near = [[0.6, 0.8, 0.99e-3], [0.6, 0.8, 1.4e-3], [0.0, 0.0, 1.0 - 0.99e-6]]
    far = [[0.0, 0.0, 1.0 + 1.01e-6], [0.0, 0.0, 1.0 - 1.01e-6], [0.0, -3.0, 4.0]]
    said: list[Finding] = []
    found = file_directions(star_file("u,v,w", near + far), report=said.append)
    assert found[:3].tolist() == near
    assert_close("rae element", found[3:], [[0, 0, 1], [0, 0, 1], [0, -0.6, 0.8]])
    taken = "and are taken as a direction"
    assert [str(one) for one in said] == [
        f"a.csv: line 14: u, v, w have length 1 {taken}",
        f"a.csv: line 15: u, v, w have length 0.999999 {taken}",
        f"a.csv: line 16: u, v, w have length 5 {taken}",
    ]
    assert {one.severity for one in said} == {"warning"}


def test_direction_cosines_that_are_none() -> None:
    with pytest.raises(InputError) as caught:
        file_directions(star_file("u,v,w", [[0, 0, 1.0], [0, 0, 1e-160], [0, 0, 0]]))
    assert str(caught.value) == "a.csv: line 12: u, v, w have no direction"
    tiny = star_file("u,v,w", [[0.0, 2e-154, 0.0]])
    found = file_directions(tiny, report=list[Finding]().append)
    assert_close("rae element", found, [[0.0, 1.0, 0.0]])


LINES = {
    (): "",
    (3,): "{} 3",
    (3, 4): "{}s 3 and 4",
    (4, 2, 9): "{}s 4, 2 and 9",
    (3, 4, 5, 6): "{}s 3, 4, 5 and 6",
    (3, 4, 5, 6, 7): "{}s 3 to 7",
    (3, 4, 5, 6, 8): "{}s 3, 4, 5, 6 and 8",
    (2, 4, 5, 6, 7): "{}s 2, 4, 5, 6 and 7",
    (7, 6, 5, 4, 3): "{}s 7, 6, 5, 4 and 3",
}


@pytest.mark.parametrize("lines", LINES)
def test_lines_in_words(lines: tuple[int, ...]) -> None:
    for word in ("line", "row"):
        assert lines_text(list(lines), word) == LINES[lines].format(word)
    assert lines_text(list(lines)) == LINES[lines].format("line")
    plural = LINES[lines].replace("{}s", "matches").replace("{}", "match")
    assert lines_text(list(lines), "match") == plural


def test_what_a_finding_is_about() -> None:
    """The lines of its stars; without any the photograph, where there are several."""
    three = [[0.0, 0.0, 1.0]] * 3
    one, other = star_file("u,v,w", three), star_file("u,v,w", three, photograph="night")
    assert str(one.finding("x", 2, 0)) == "a.csv: lines 13 and 11: x"
    assert str(one.error("x", 1)) == "a.csv: line 12: x"
    assert str(one.error("x", 0, 1)) == "a.csv: lines 11 and 12: x"
    assert str(one.finding("x")) == "a.csv: x"
    assert str(other.finding("x")) == "a.csv: photograph night: x"
    assert str(other.error("x", 0)) == "a.csv: line 11: x"
    named = star_file("u,v,w", three, line_word="match")
    assert str(named.finding("x", 0, 2)) == "a.csv: matches 11 and 13: x"
    assert one.finding("x").severity == "error" and one.finding("x").deck == "a.csv"
