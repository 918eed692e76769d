"""Residuals by landmark: where every point, bar, tick and word stands, by numbers of one's own."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tests.kit.figures import DARK_RED, OKABE_ITO, labelled, points, texts, ticks
from tests.kit.histories import by_hand
from tests.tolerances import assert_close
from vopd import figures as residuals_by_landmark
from vopd.attitude.history import History
from vopd.estimate import Units, Words
from vopd.figures import residuals

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
    assert sorted(legend) == ["one frame", "outlier", "root mean square, both ways"]


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
    monkeypatch.setattr(residuals_by_landmark, "points", lambda _: made)
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
