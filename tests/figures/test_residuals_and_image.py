"""Residuals by landmark, and the image of a frame: every mark, by numbers of one's own."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tests.approved.texts import assert_approved
from tests.kit.estimates import POINTS
from tests.kit.figures import DARK_RED, OKABE_ITO, arrows_and_key, labelled, points, texts, ticks
from tests.kit.histories import by_hand
from tests.tolerances import assert_close
from vopd.attitude.history import History
from vopd.estimate import Units, Words
from vopd.figures.image import arrow_scale, image, residual_arrows
from vopd.figures.residuals import residuals

X = np.array([[3.0, 1.0, -2.0, 0.0], [1.0, 1.0, 2.0, 0.5], [4.0, 1.0, 2.0, 0.25]])
Y = np.array([[0.0, 5.0, 1.0, 0.5], [6.0, 0.0, 2.0, 0.5], [0.0, 0.0, 4.0, 0.5]])
TIMES = np.array([10.0, 11.0, 14.0])
ALONG = 0.8 * (np.array([0.0, 1.0, 4.0]) / 4.0 - 0.5)  # from left to right in a column .8 wide


def film(**changes: Any) -> History:
    given: dict[str, Any] = {"residual": np.column_stack([X, Y]), "time_s": TIMES}
    return by_hand(3, **(given | changes))


def drawn(*histories: History) -> tuple[Figure, str]:
    figure = Figure()
    said = residuals(figure, histories or [film()], None)
    return figure, said


def test_what_is_drawn() -> None:
    """A point for each residual, x above y, on bars of the root mean square both ways."""
    odd = [[False, True, False, False], [False] * 4, [False, False, True, False]]
    figure, _ = drawn(film(outlier=odd))
    across = np.add.outer(ALONG, np.arange(4.0))
    for axis, values in zip(figure.axes, (X, Y), strict=True):
        (spots,) = [one for one in axis.collections if one.get_label() == "one frame"]
        assert_close(
            "table value", spots.get_offsets(), np.column_stack([across.ravel(), values.ravel()])
        )
        assert to_hex(spots.get_facecolor()[0]) == OKABE_ITO[0]
        assert spots.get_sizes().tolist() == [14.0] and spots.get_alpha() == 0.8
        outliers = labelled(axis)["outlier"]
        expected = [[across[0, 1], values[0, 1]], [across[2, 2], values[2, 2]]]
        assert_close("table value", np.array(points(outliers), float), expected)
        assert outliers.get_markeredgecolor() == DARK_RED
        assert (outliers.get_marker(), outliers.get_linestyle()) == ("o", "None")
        (zero,) = [line for line in axis.lines if line is not outliers]
        assert list(zero.get_ydata()) == [0.0, 0.0]
        rms = np.sqrt((values**2).sum(axis=0) / 3.0)
        for k, bar in enumerate(axis.patches):
            assert_close("table value", [bar.get_y(), bar.get_height()], [-rms[k], 2.0 * rms[k]])
            assert_close("table value", [bar.get_x(), bar.get_width()], [k - 0.48, 0.96])
            assert bar.get_zorder() < spots.get_zorder()
    legend = texts(figure.legends[0])
    assert_approved(sorted(legend))


def test_labels() -> None:
    """Landmarks below the lower panel, in order of their numbers."""
    numbers = np.tile([10, 8, 9, 7], (3, 1))
    figure, _ = drawn(film(landmark=numbers, landmark_names={7: "spire", 8: "$", 9: ""}))
    above, below = figure.axes
    assert above.get_shared_x_axes().joined(above, below)
    assert [above.get_xlabel(), below.get_xlabel()] == ["", "landmark"]
    assert above.get_ylabel() == "residual x, px\nin the image"
    assert below.get_ylabel() == "residual y, px\nin the image"
    assert ticks(below) == ([0, 1, 2, 3], ["spire", r"\$", "9", "10"])
    assert [one.get_rotation() for one in below.get_xticklabels()] == [90.0] * 4
    assert not any(one.get_visible() for one in above.get_xticklabels())
    assert below.get_xlim() == (-0.6, 3.6)
    (spots,) = [one for one in below.collections if one.get_label() == "one frame"]
    first = spots.get_offsets()[:4]
    assert_close("table value", first[:, 0], ALONG[0] + np.array([3.0, 1.0, 2.0, 0.0]))


def test_units_and_words_of_a_film() -> None:
    """Film lengths are mm, and their residuals a thousand times as many micrometres."""
    words = Words(surface="on the film")
    figure, _ = drawn(film(units=Units("ft", "mm", 0.3048, "µm", 1000.0), said={"words": words}))
    above, below = figure.axes
    assert above.get_ylabel() == "residual x, µm\non the film"
    assert below.get_ylabel() == "residual y, µm\non the film"
    (spots,) = [one for one in above.collections if one.get_label() == "one frame"]
    assert_close("drawn residual", spots.get_offsets()[:, 1], X.ravel() * 1000.0)


CAPTION = "hand.toml, job 1: a flight by hand\nmeasured minus computed"
TEXTS = {  # times: what is said of the columns
    "times": (TIMES, "; columns from left to right: 10.000 to 14.000 s"),
    "backwards": (TIMES[::-1] / 3.0, "; columns from left to right: 3.333 to 4.667 s"),
    "numbers": (np.full(3, np.nan), "; columns from left to right: frames 1 to 3"),
    "one time": (np.full(3, 7.0), ""),
}


@pytest.mark.parametrize("name", TEXTS)
def test_the_caption(name: str) -> None:
    times, said = TEXTS[name]
    assert drawn(film(time_s=times))[1] == CAPTION + said


def test_the_caption_of_one_frame_without_a_time_and_of_two_jobs() -> None:
    assert drawn(by_hand(1, time_s=np.array([np.nan])))[1] == CAPTION
    two = drawn(film(), film(said={"job": 2}))[1]
    assert two.startswith("hand.toml, 2 jobs\nmeasured minus computed; ")


def test_residuals_that_are_left_out() -> None:
    """Of landmarks that take no part, or of which a coordinate is no number."""
    used, ignored = np.ones((3, 4), bool), np.zeros((3, 4), bool)
    used[0, 0], ignored[0, 0] = False, True
    both = np.column_stack([X, Y])
    both[1, 1] = np.nan  # x only
    figure, _ = drawn(film(used=used, ignored=ignored, residual=both))
    (spots,) = [one for one in figure.axes[1].collections if one.get_label() == "one frame"]
    assert spots.get_offsets()[:, 1].tolist() == [5.0, 1.0, 0.5, 6.0, 2.0, 0.5, 0.0, 0.0, 4.0, 0.5]


def of_points(monkeypatch: pytest.MonkeyPatch, number: Any, when: Any = None) -> list[Any]:
    """The panels of points of these landmarks, whose residuals are all 1."""
    count = len(number)
    made = (
        np.asarray(number, int), np.zeros(count) if when is None else when, np.ones((count, 2)),
        np.zeros(count, bool),
    )  # fmt: skip
    monkeypatch.setattr(sys.modules["vopd.figures.residuals"], "points", lambda _: made)
    return list(drawn()[0].axes)


@pytest.mark.parametrize(
    ("count", "size", "pixels"),
    [
        (0, 14.0, False),
        (299, 14.0, False),
        (300, 4.0, False),
        (5000, 4.0, False),
        (5001, 4.0, True),
    ],
)
def test_many_points(
    count: int, size: float, pixels: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From 300 on they are small, and above 5,000 they are pixels in any file."""
    above, _ = of_points(monkeypatch, np.full(count, 7))
    (spots,) = [one for one in above.collections if one.get_label() == "one frame"]
    assert (spots.get_sizes().tolist(), bool(spots.get_rasterized())) == ([size], pixels)


@pytest.mark.parametrize(("count", "step"), [(1, 1), (40, 1), (41, 2), (81, 3)])
def test_up_to_forty_columns_have_labels(
    count: int, step: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    numbers = np.arange(count) + 100
    _, below = of_points(monkeypatch, numbers)
    assert ticks(below) == (
        list(range(0, count, step)), [str(k) for k in range(100, 100 + count, step)]
    )  # fmt: skip
    assert below.get_xlim() == (-0.6, count - 0.4)
    assert {one.get_rotation() for one in below.get_xticklabels()} == {0.0}


# The image of one frame

MICROMETRES = Units("ft", "mm", 0.3048, "µm", 1000.0)
RESIDUAL = np.array([[0.0303, 0.0404], [0.0, -0.01], [-0.02, 0.0], [0.0, 0.0]])  # longest .0505
SAID = {"source": "a.dat", "job": 2, "title": "a title", "fixes": ""}


def film_image(residual: Any = RESIDUAL, frames: int = 2, **changes: Any) -> History:
    """Frames alike, with these residuals of the four landmarks."""
    both = np.tile(np.asarray(residual).T.ravel(), (frames, 1))
    return by_hand(frames, residual=both, **changes)


def drawn_image(*histories: History, frame: Any = None) -> tuple[Any, list[str]]:
    figure = Figure()
    said = image(figure, histories, frame)
    (axis,) = figure.axes
    return axis, said.split("\n")


def test_what_is_drawn_image() -> None:
    """Marks where landmarks were measured and computed, as seen from behind the camera."""
    axis, _ = drawn_image(film_image(outlier=[[False, True, False, False]] * 2))
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
    axis, said = drawn_image(film_image(units=units))
    arrows, label = arrows_and_key(axis)
    assert_close("table value", np.column_stack([arrows.X, arrows.Y]), POINTS - RESIDUAL)
    assert_close("table value", np.column_stack([arrows.U, arrows.V]), RESIDUAL)
    assert (arrows.angles, arrows.scale_units) == ("xy", "xy")
    assert_close("table value", arrows.scale, 1.0 / times)
    assert to_hex(arrows.get_facecolor()[0]) == OKABE_ITO[1]
    assert label.text.get_text() == key and label.coord == "axes"
    assert_close("table value", label.U, length)
    assert_approved(said[2], parts=[20])
    assert axis.get_xlabel() == f"x, {unit} in the image, to the left"
    assert axis.get_ylabel() == f"y, {unit} in the image, up"


def test_residuals_of_zero_have_no_key() -> None:
    axis, said = drawn_image(film_image(np.zeros((4, 2))))
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
    one = film_image(said=SAID, **changes)
    other = film_image(said=SAID | {"job": 3}, frame_names=("x", "y"), frame=np.array([8, 9]))
    _, said = drawn_image(other, one, frame=one.estimate.frame_label(k))
    assert said[0] == caption
    assert_approved(said[1:], parts=[frame, 20])


def test_a_misfit_is_explained_below_its_own_frame_only() -> None:
    one = film_image(flags={"misfit": [1]}, misfit=["", "without $7"])
    assert drawn_image(one, frame="DJI_0001.JPG")[1][3:] == [r"misfit: without \$7"]
    assert drawn_image(one, frame="DJI_0000.JPG")[1][3:] == []


def test_landmarks_that_take_no_part_or_have_no_numbers_are_not_drawn() -> None:
    used, ignored = np.ones((2, 4), bool), np.zeros((2, 4), bool)
    used[1, 0], ignored[1, 0] = False, True
    points_px, residual = np.tile(POINTS, (2, 1, 1)), np.tile(RESIDUAL.T.ravel(), (2, 1))
    points_px[1, 1, 0], residual[1, 6] = np.nan, np.nan  # x of the second, residual y of the third
    one = by_hand(2, used=used, ignored=ignored, image=points_px, residual=residual)
    axis, said = drawn_image(one, frame="DJI_0001.JPG")
    assert points(labelled(axis)["measured"]) == [[2.0, 2.0]]
    assert [t.get_text() for t in axis.texts] == ["<crossing>"]
    assert_approved(said[1], parts=["DJI_0001.JPG", "1.000 s", "3 landmarks"])
    assert len(points(labelled(drawn_image(one, frame="DJI_0000.JPG")[0])["measured"])) == 4


@pytest.mark.parametrize(("count", "labels"), [(200, 200), (201, 0)])
def test_up_to_200_landmarks_have_labels(count: int, labels: int) -> None:
    flat = np.zeros((1, count))
    many = by_hand(
        1, landmark=flat.astype(int) + 7, used=flat == 0, ignored=flat == 1, outlier=flat == 1,
        image=np.ones((1, count, 2)), residual=np.zeros((1, 2 * count)), landmark_names={7: "$"},
    )  # fmt: skip
    axis, said = drawn_image(many)
    assert [t.get_text() for t in axis.texts] == [r"\$"] * labels
    assert_approved(said[1], parts=[f"{count} landmarks"])


def test_the_words_of_a_source() -> None:
    words = Words(surface="on the film", centre="centre of the image")
    axis, _ = drawn_image(film_image(units=MICROMETRES, said={"words": words}))
    assert axis.get_xlabel() == "x, mm on the film, to the left"
    assert axis.get_ylabel() == "y, mm on the film, up"
    assert list(labelled(axis)) == ["computed", "measured", "centre of the image"]


def test_an_image_whose_landmarks_are_all_at_the_centre_has_a_size() -> None:
    axis, _ = drawn_image(by_hand(1, image=np.zeros((1, 4, 2))))
    assert_close("table value", axis.get_ylim(), (-0.00135, 0.00135))
