"""The image of one frame: every mark, arrow, label, limit and sentence, by numbers of one's own."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tests.kit.estimates import POINTS
from tests.kit.figures import DARK_RED, OKABE_ITO, arrows_and_key, labelled, points, texts
from tests.kit.histories import by_hand
from tests.tolerances import assert_close
from vopd.attitude.history import History
from vopd.estimate import Units, Words
from vopd.figures import arrow_scale, image, residual_arrows

MICROMETRES = Units("ft", "mm", 0.3048, "µm", 1000.0)
RESIDUAL = np.array([[0.0303, 0.0404], [0.0, -0.01], [-0.02, 0.0], [0.0, 0.0]])  # longest .0505
SAID = {"source": "a.dat", "job": 2, "title": "a title", "fixes": ""}


def film(residual: Any = RESIDUAL, frames: int = 2, **changes: Any) -> History:
    """Frames alike, with these residuals of the four landmarks."""
    both = np.tile(np.asarray(residual).T.ravel(), (frames, 1))
    return by_hand(frames, residual=both, **changes)


def drawn(*histories: History, frame: Any = None) -> tuple[Any, list[str]]:
    figure = Figure()
    said = image(figure, histories, frame)
    (axis,) = figure.axes
    return axis, said.split("\n")


def test_what_is_drawn() -> None:
    """Marks where landmarks were measured and computed, as seen from behind the camera."""
    axis, _ = drawn(film(outlier=[[False, True, False, False]] * 2))
    lines = labelled(axis)
    assert list(lines) == ["computed", "measured", "outlier", "principal point"]
    assert texts(axis.get_legend()) == list(lines)
    assert points(lines["measured"]) == POINTS.tolist()
    assert_close("table value", np.array(points(lines["computed"]), float), POINTS - RESIDUAL)
    assert points(lines["outlier"]) == [POINTS[1].tolist()]
    assert points(lines["principal point"]) == [[0.0, 0.0]]
    looks = {name: (one.get_marker(), one.get_markersize()) for name, one in lines.items()}
    assert looks == {
        "computed": ("+", 9), "measured": ("o", 7), "outlier": ("s", 12),
        "principal point": ("x", 8),
    }  # fmt: skip
    edges = {name: to_hex(line.get_markeredgecolor()) for name, line in lines.items()}
    assert edges["measured"] == OKABE_ITO[0] and edges["outlier"] == DARK_RED
    assert lines["measured"].get_markerfacecolor() == "none"
    assert_close("table value", axis.get_xlim(), (5.4, -5.4))  # 1.35 times the farthest, 4
    assert_close("table value", axis.get_ylim(), (-5.4, 5.4))
    assert axis.get_aspect() == 1.0
    assert axis.get_xlabel() == "x, px in the image, to the left"
    assert axis.get_ylabel() == "y, px in the image, up"
    names = [(t.get_text(), list(t.xy), t.xyann, t.anncoords) for t in axis.texts]
    expected = ["church tower", "bridge; north end", "=A1", "<crossing>"]
    assert names == [
        (name, xy, (7, 7), "offset points")
        for name, xy in zip(expected, POINTS.tolist(), strict=True)
    ]


ARROWS = {  # units: times as long, the key, its length in image units
    "px": (Units("m", "px", 1.0, "px", 1.0), 20.0, "0.05 px", 0.05),
    "mm": (MICROMETRES, 20.0, "50 µm", 0.05),
}


@pytest.mark.parametrize("unit", ARROWS)
def test_the_arrows_and_their_key(unit: str) -> None:
    """From the computed position; the longest, .0505, is drawn about .12 of the width, 10.8."""
    units, times, key, length = ARROWS[unit]
    axis, said = drawn(film(units=units))
    arrows, label = arrows_and_key(axis)
    assert_close("table value", np.column_stack([arrows.X, arrows.Y]), POINTS - RESIDUAL)
    assert_close("table value", np.column_stack([arrows.U, arrows.V]), RESIDUAL)
    assert (arrows.angles, arrows.scale_units) == ("xy", "xy")
    assert_close("table value", arrows.scale, 1.0 / times)
    assert to_hex(arrows.get_facecolor()[0]) == OKABE_ITO[1]
    assert label.text.get_text() == key and label.coord == "axes"
    assert_close("table value", label.U, length)
    assert said[2] == "arrows: residuals, measured minus computed, 20 times as long"
    assert axis.get_xlabel() == f"x, {unit} in the image, to the left"
    assert axis.get_ylabel() == f"y, {unit} in the image, up"


def test_residuals_of_zero_have_no_key() -> None:
    axis, said = drawn(film(np.zeros((4, 2))))
    assert arrows_and_key(axis)[1] is None and said[2].endswith("computed, 1 times as long")


LENGTHS = {  # of the longest residual, µm: of the key
    0.9: "0.5", 1.0: "1", 1.99: "1", 2.0: "2", 4.99: "2", 5.0: "5", 9.99: "5", 10.0: "10",
    25.0: "20", 100.0: "100", 0.3: "0.2", 0.003: "0.002",
}  # fmt: skip


@pytest.mark.parametrize("longest_um", LENGTHS)
def test_round_lengths(longest_um: float) -> None:
    """1, 2 or 5 of a power of ten, not above the longest, which is one coordinate: not rounded."""
    axis = Figure().subplots()
    residual = np.array([[0.0, -1.0]]) * longest_um / 1000.0
    residual_arrows(axis, np.zeros((1, 2)), residual, 1.0, MICROMETRES)
    assert arrows_and_key(axis)[1].text.get_text() == f"{LENGTHS[longest_um]} µm"


def test_the_scale_of_arrows_is_by_the_longest_and_not_by_a_coordinate() -> None:
    """1.2 of 10 wide: 24 times .05, 30 times .04."""
    assert arrow_scale(np.array([[0.03, 0.04]]), 10.0) == 20.0
    assert arrow_scale(np.array([[0.024, 0.032], [0.0, 0.001]]), 10.0) == 20.0
    assert arrow_scale(np.array([[24.0, 32.0]]), 10.0) == 0.02
    assert arrow_scale(np.zeros((0, 2)), 10.0) == 1.0


TITLES = {  # changes: the lines below the title
    "usual": ({}, 1, "a.dat, job 2: a title", "DJI_0001.JPG, 1.000 s, 4"),
    "time 0": ({}, 0, "a.dat, job 2: a title", "DJI_0000.JPG, 0.000 s, 4"),
    "no time": ({"time_s": np.full(2, np.nan)}, 1, "a.dat, job 2: a title", "DJI_0001.JPG, 4"),
    "a number": ({"frame_names": ()}, 1, "a.dat, job 2: a title", "2, 1.000 s, 4"),
    "formula": ({"frame_names": ("a", "$b\a")}, 1, "a.dat, job 2: a title", r"\$b?, 1.000 s, 4"),
}


@pytest.mark.parametrize("name", TITLES)
def test_the_title(name: str) -> None:
    """Of the job that has the frame, though there are several."""
    changes, k, caption, frame = TITLES[name]
    one = film(said=SAID, **changes)
    other = film(said=SAID | {"job": 3}, frame_names=("x", "y"), frame=np.array([8, 9]))
    _, said = drawn(other, one, frame=one.estimate.frame_label(k))
    assert said == [
        caption,
        f"frame {frame} landmarks; corrected for distortion",
        "arrows: residuals, measured minus computed, 20 times as long",
    ]


def test_a_misfit_is_explained_below_its_own_frame_only() -> None:
    one = film(flags={"misfit": [1]}, misfit=["", "without $7"])
    assert drawn(one, frame="DJI_0001.JPG")[1][3:] == [r"misfit: without \$7"]
    assert drawn(one, frame="DJI_0000.JPG")[1][3:] == []


def test_landmarks_that_take_no_part_or_have_no_numbers_are_not_drawn() -> None:
    used, ignored = np.ones((2, 4), bool), np.zeros((2, 4), bool)
    used[1, 0], ignored[1, 0] = False, True
    points_px, residual = np.tile(POINTS, (2, 1, 1)), np.tile(RESIDUAL.T.ravel(), (2, 1))
    points_px[1, 1, 0], residual[1, 6] = np.nan, np.nan  # x of the second, residual y of the third
    one = by_hand(2, used=used, ignored=ignored, image=points_px, residual=residual)
    axis, said = drawn(one, frame="DJI_0001.JPG")
    assert points(labelled(axis)["measured"]) == [[2.0, 2.0]]
    assert [t.get_text() for t in axis.texts] == ["<crossing>"]
    assert said[1] == "frame DJI_0001.JPG, 1.000 s, 3 landmarks; corrected for distortion"
    assert len(points(labelled(drawn(one, frame="DJI_0000.JPG")[0])["measured"])) == 4


@pytest.mark.parametrize(("count", "labels"), [(200, 200), (201, 0)])
def test_up_to_200_landmarks_have_labels(count: int, labels: int) -> None:
    flat = np.zeros((1, count))
    many = by_hand(
        1, landmark=flat.astype(int) + 7, used=flat == 0, ignored=flat == 1, outlier=flat == 1,
        image=np.ones((1, count, 2)), residual=np.zeros((1, 2 * count)), landmark_names={7: "$"},
    )  # fmt: skip
    axis, said = drawn(many)
    assert [t.get_text() for t in axis.texts] == [r"\$"] * labels
    more = "" if labels else "; too many landmarks to label"
    assert said[1].endswith(f"{count} landmarks; corrected for distortion{more}")


def test_the_words_of_a_source() -> None:
    words = Words(surface="on the film", centre="centre of the image")
    axis, _ = drawn(film(units=MICROMETRES, said={"words": words}))
    assert axis.get_xlabel() == "x, mm on the film, to the left"
    assert axis.get_ylabel() == "y, mm on the film, up"
    assert list(labelled(axis)) == ["computed", "measured", "centre of the image"]


def test_an_image_whose_landmarks_are_all_at_the_centre_has_a_size() -> None:
    axis, _ = drawn(by_hand(1, image=np.zeros((1, 4, 2))))
    assert_close("table value", axis.get_ylim(), (-0.00135, 0.00135))
