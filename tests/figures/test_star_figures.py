"""Pictures of star photographs and of the report's figures 6.1 to 6.3."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.kit.command import DECKS, Ran, vopd
from tests.tolerances import assert_close
from vopd.figures import StarPicture, draw_star_residuals
from vopd.stellar.files.table import read_solutions

ORION = DECKS / "stars" / "orion.csv"


@pytest.fixture
def solved(tmp_path: Path) -> Path:
    path = tmp_path / "solved.json"
    other = DECKS / "stars" / "table_6_3.csv"
    done = vopd("stars", "solve", ORION, other, "--focal", "76", "-o", path)
    assert done.status == 0, done.stderr
    return path


def plot(*arguments: str | Path) -> Ran:
    return vopd("plot", *arguments)


def test_a_photograph_is_drawn_to_scale() -> None:
    images = np.array([[1.0, 2.0], [-3.0, 4.0], [10.0, -10.0]])
    residuals = np.array([[0.01, 0.0], [0.0, -0.02], [0.0, 0.0]])
    picture = StarPicture("a $title$", images, residuals, ("a", "b", "c"), "mm")
    (axis,) = draw_star_residuals(picture).axes
    computed, measured, centre = axis.lines
    assert_close("unit element", np.transpose(measured.get_data()), images)
    assert_close("unit element", np.transpose(computed.get_data()), images - residuals)
    assert_close("unit element", centre.get_data(), [[0.0], [0.0]])
    assert [text.get_text() for text in axis.texts] == ["a", "b", "c"]
    assert axis.get_xlim()[0] < -10.0 and axis.get_xlim()[1] > 10.0  # x to the right
    (arrows,) = [one for one in axis.collections if hasattr(one, "U")]
    assert_close("unit element", np.column_stack([arrows.U, arrows.V]), residuals)


UNITS = {  # of the images: of the longest residual, .03, in the unit of residuals, and of the axes
    "mm": ("20 µm", 0.02, "x, mm in the image, to the right", "y, mm in the image, up"),
    "px": ("0.02 px", 0.02, "x, px in the image, to the right", "y, px in the image, up"),
}


@pytest.mark.parametrize("unit", UNITS)
def test_the_units_of_a_photograph(unit: str) -> None:
    """The key is a round length, and as long as it says; residuals of mm are in micrometres."""
    images = np.array([[1.0, 2.0], [-3.0, 4.0]])
    residuals = np.array([[0.03, 0.0], [0.0, -0.02]])
    figure = draw_star_residuals(StarPicture("title", images, residuals, ("a", "b"), unit))
    (axis,) = figure.axes
    (key,) = [artist for artist in axis.get_children() if type(artist).__name__ == "QuiverKey"]
    label, length, x, y = UNITS[unit]
    assert key.text.get_text() == label
    assert_close("unit element", key.U, length)
    assert (axis.get_xlabel(), axis.get_ylabel()) == (x, y)
    legend = [text.get_text() for text in axis.get_legend().get_texts()]
    assert legend == ["computed", "measured", "principal point"]
    (arrows,) = [one for one in axis.collections if hasattr(one, "U")]
    title, words = figure.get_suptitle().split("\n")
    assert title == "title" and words == (
        f"arrows: residuals, measured minus computed, {1.0 / arrows.scale:g} times as long"
    )


@pytest.mark.usefixtures("not_laid_out")
@pytest.mark.parametrize("suffix", [".png", ".svg", ".pdf"])
def test_tables_to_a_picture(tmp_path: Path, suffix: str) -> None:
    file = tmp_path / f"figures{suffix}"
    result = vopd("stars", "tables", "-o", file)
    begins = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}[suffix]
    assert result.status == 0 and file.read_bytes().startswith(begins)
    if suffix == ".svg":  # which has its texts in comments too
        titles = re.findall(r"<!-- (Figure 6.*) -->", file.read_text(encoding="utf-8"))
        assert titles == [
            f"Figure 6.{number}. Error of {name}, truth minus estimate, degrees"
            for number, name in enumerate(("omega", "phi", "kappa"), 1)
        ]


@pytest.mark.usefixtures("not_laid_out")
def test_plot_takes_a_star_solution(tmp_path: Path, solved: Path) -> None:
    file = tmp_path / "picture.svg"
    assert plot(solved, "-o", file).status == 0 and b"<svg" in file.read_bytes()
    other = tmp_path / "other.svg"
    assert plot(solved, "-o", other, "--frame", str(DECKS / "stars" / "table_6_3.csv")).status == 0
    assert file.read_bytes() != other.read_bytes()
    missing = plot(solved, "-o", file, "--frame", "nothing")
    assert missing.status == 1 and "no photograph nothing: there are" in missing.stderr


def test_what_is_read_back_is_what_was_read(solved: Path) -> None:
    first, second = read_solutions(str(solved))
    assert first.labels[0] == "Betelgeuse" and second.labels == ("1", "2", "3", "4")
    assert_close("unit element", first.images[1], [1.816, -12.990])
    assert first.unit == "mm" and len(first.residuals) == 8


BAD: dict[str, Any] = {
    "not json": "{",
    "another array": [1],
    "no images": [{"method": "x", "stars": [1]}],
    "too few": [{"images_mm": [[1, 2]], "residuals_mm": [[1, 2], [3, 4]]}],
    "nothing": [],
}


@pytest.mark.parametrize("name", BAD)
def test_what_is_no_solution_is_refused(tmp_path: Path, name: str) -> None:
    file = tmp_path / "bad.json"
    file.write_text(BAD[name] if isinstance(BAD[name], str) else json.dumps(BAD[name]))
    result = plot(file, "-o", tmp_path / "x.png")
    assert result.status == 1 and result.stderr.startswith(f"{file}: ")


def test_options_that_are_not_for_photographs_are_refused(tmp_path: Path, solved: Path) -> None:
    result = plot(solved, "-o", tmp_path / "x.png", "--job", "1")
    assert result.status == 2 and "--job is not for star photographs" in result.stderr
    mixed = plot(solved, DECKS / "appendix_h" / "case1.dat", "-o", tmp_path / "x.png")
    assert mixed.status == 2 and "not drawn together" in mixed.stderr
