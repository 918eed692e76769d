"""Marks of frames, the legend below the panels, and the look of all figures."""

from __future__ import annotations

from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tests.kit.figures import DARK_RED, OKABE_ITO, points, texts
from tests.kit.histories import by_hand
from vopd.attitude.history import History
from vopd.figures import COLOURS, FLAGGED, draw_legend, draw_marks, plain, style

TIMES = np.array([3.0, 1.0, 2.0, 0.0])
ORDER = np.array([3, 1, 2, 0])
ANGLE = np.array([10.0, 11.0, 12.0, 13.0])  # in order of time

OTHERS = (
    "not_converged", "undetermined", "out_of_range", "behind_camera", "two_landmarks",
    "weak_geometry", "second_solution", "pitch_near_90", "outlier", "jump",
)  # fmt: skip
MARKED = {  # flags by index of the frame: marker, points
    **{name: ({name: [1]}, {"o": [[1.0, 11.0]]}) for name in OTHERS},
    "two flags": ({"outlier": [1], "jump": [0, 1]}, {"o": [[1.0, 11.0], [3.0, 13.0]]}),
    "misfit": ({"misfit": [0, 2]}, {"X": [[2.0, 12.0], [3.0, 13.0]]}),
    "model error": ({"model_error": [0, 3]}, {"|": [[0.0, 0.03], [3.0, 0.03]]}),
    "all": (
        {"misfit": [0], "model_error": [2], "jump": [1]},
        {"o": [[1.0, 11.0]], "X": [[3.0, 13.0]], "|": [[2.0, 0.03]]},
    ),
}


def drawn(one: History, known: Any = True) -> Any:
    axis = Figure().subplots()
    draw_marks(axis, one, ORDER, ANGLE, np.full(4, known) if known is True else known)
    return axis


@pytest.mark.parametrize("name", MARKED)
def test_marks(name: str) -> None:
    """At the angle of the frame; those of the errata at the bottom, at .03 of the height."""
    flags, expected = MARKED[name]
    axis = drawn(by_hand(4, time_s=TIMES, flags=flags))
    assert {line.get_marker(): points(line) for line in axis.lines} == expected
    for line in axis.lines:
        assert line.get_linestyle() == "None"
        bottom = axis.get_xaxis_transform() if line.get_marker() == "|" else axis.transData
        assert line.get_transform() == bottom


def test_frames_without_an_angle_are_not_marked() -> None:
    flags = {"misfit": [0, 1], "model_error": [0], "jump": [0]}
    known = np.array([True, True, True, False])  # in order of time: frame 0 is the last
    axis = drawn(by_hand(4, time_s=TIMES, flags=flags), known)
    assert [points(line) for line in axis.lines] == [[[1.0, 11.0]]]


def test_the_look_of_the_marks() -> None:
    """Red rings and crosses; the errata's in orange, behind the angles, and not so loud."""
    one = by_hand(4, time_s=TIMES, flags={"misfit": [0], "model_error": [2], "jump": [1]})
    axis, figure = drawn(one), Figure()
    draw_legend(figure, [one])
    ring, cross, bar = axis.lines
    in_legend = figure.legends[0].get_lines()
    for k, lines in enumerate(zip(axis.lines, in_legend, strict=True)):
        for line in lines:
            assert line.get_marker() == "oX|"[k] and line.get_linestyle() == "None"
            assert line.get_markersize() == (5.0, 8.0, 9.0)[k]
            edge, face = line.get_markeredgecolor(), line.get_markerfacecolor()
            assert (edge, face)[: 2 if k < 2 else 1] == (
                (DARK_RED, "none"), ("white", DARK_RED), (OKABE_ITO[5],)
            )[k]  # fmt: skip
    assert (ring.get_markeredgewidth(), bar.get_markeredgewidth()) == (0.6, 1.2)
    assert bar.get_zorder() < ring.get_zorder() == cross.get_zorder()


def legend(*histories: History) -> Any:
    figure = Figure(layout="constrained")
    draw_legend(figure, list(histories))
    return figure.legends[0]


def of(source: str, job: int, **changes: Any) -> History:
    return by_hand(4, said={"source": source, "job": job}, **changes)


def test_the_legend() -> None:
    """Jobs by their colour where there are several; the band; and the marks that any job has."""
    last = of("b", 3, flags={"misfit": [1], "outlier": [0], "model_error": [0]})
    marks = ["flagged", "misfit", "model error"]
    one = legend(last)
    assert texts(one) == ["95 % interval", *marks]
    (band,) = one.get_patches()
    assert (to_hex(band.get_facecolor()), band.get_alpha()) == (OKABE_ITO[0], 0.3)
    two = legend(of("a", 1), last)
    assert texts(two) == ["a, job 1", "b, job 3", "95 % interval", *marks]
    assert [line.get_color() for line in two.get_lines()[:2]] == list(OKABE_ITO[:2])
    (band,) = two.get_patches()
    assert to_hex(band.get_facecolor()) == to_hex("0.5")
    assert texts(legend(of("a", 1), of("a", 2))) == ["job 1", "job 2", "95 % interval"]
    many = legend(*[of("a", k) for k in range(1, 9)])
    assert texts(many) == [*[f"job {k}" for k in range(1, 7)], "95 % interval"]
    assert [line.get_color() for line in many.get_lines()] == list(OKABE_ITO)


def test_the_legend_is_outside_the_panels() -> None:
    """Below them, in the middle, in four columns; so that the layout leaves room for it."""
    made = legend(of("a", 1), of("a", 2))
    assert (made._outside_loc, made._loc, made._ncols) == ("lower", 8, 4)


def test_flags_of_frames_without_an_attitude_are_not_in_the_legend() -> None:
    angles = np.zeros((4, 3))
    angles[1] = np.nan
    one = of("a", 1, vehicle_deg=angles, flags={"misfit": [1]})
    assert texts(legend(one)) == ["95 % interval"]


SETTINGS = {
    "font.size": 9.0, "axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False,
    "axes.spines.right": False, "axes.spines.left": True, "axes.formatter.useoffset": False,
    "legend.frameon": False, "svg.hashsalt": "vopd", "svg.fonttype": "path", "path.simplify": True,
    "lines.linewidth": 1.5,
}  # fmt: skip


def test_the_style() -> None:
    """The same whatever the user has set, which is restored afterwards."""
    assert (COLOURS, FLAGGED) == (OKABE_ITO, DARK_RED)
    with mpl.rc_context({"lines.linewidth": 7.0, "font.size": 30.0, "path.simplify": False}):
        with style():
            assert {name: mpl.rcParams[name] for name in SETTINGS} == SETTINGS
        assert mpl.rcParams["lines.linewidth"] == 7.0 and mpl.rcParams["font.size"] == 30.0


def test_text_is_shown_as_it_is() -> None:
    """No formulas, a question mark for what cannot be printed, and lines stay lines."""
    assert plain("$a$ é\n\tb\a") == "\\$a\\$ é\n?b?"
