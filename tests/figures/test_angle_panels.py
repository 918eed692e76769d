"""Panels of angles against time: lines, breaks, bands, half-widths, marks, scales and labels."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tests.approved.texts import assert_approved
from tests.kit.figures import (
    ANGLES,
    DARK_RED,
    DRAWN,
    ETA,
    GREY,
    HALF,
    OKABE_ITO,
    alike,
    film,
    panels,
    points,
    texts,
)
from tests.kit.histories import by_hand
from tests.tolerances import assert_close
from vopd.attitude.history import History
from vopd.figures.attitude import (
    ANGLE_TEXTS,
    BAND,
    broken,
    draw_attack,
    draw_attitude,
    draw_flags,
    draw_legend,
    from_cut,
    in_time,
    picked,
    unwrapped_about,
)
from vopd.figures.style import COLOURS, FLAGGED, plain, style

MARKS = ["-", "--", ":"]


@cache
def usual(which: Any = draw_attack) -> list[Any]:
    """The panels of the film, which several tests look at."""
    return panels([film()], which)


def solid(axis: Any) -> list[Any]:
    return [line for line in axis.lines if line.get_linestyle() == "-"]


def band(axis: Any) -> Any:
    (found,) = [one for one in axis.collections if one.get_label() == "band"]
    return found


def ends(axis: Any) -> dict[float, list[float]]:
    """The ends of the band at each time."""
    found: dict[float, set[float]] = {}
    for path in band(axis).get_paths():
        for x, y in path.vertices.tolist():
            found.setdefault(x, set()).add(y)
    return {x: sorted(ys) for x, ys in sorted(found.items())}


@pytest.mark.parametrize("k", range(9))
def test_a_panel(k: int) -> None:
    """A line in order of time with a break, its band, and a bar at the frame that is alone."""
    figure = usual(draw_attack if k > 5 else draw_attitude)
    axis = figure[k - 6] if k > 5 else figure[2 * (k % 3) + k // 3]
    low, high = -HALF[[1, 2, 3, 0, 4], k], HALF[[1, 2, 3, 0, 4], k]
    if k == 8:  # eta has an interval of two ends
        low, high = np.full(5, -0.5), np.full(5, 0.75)
    x, y = [0.0, 1.0, 2.0, 3.0, 12.0], DRAWN[:, k]
    line = axis.lines[0]
    expected = np.column_stack([x, y]).tolist()
    assert points(line) == [*expected[:4], [None, None], expected[4]]
    assert (line.get_marker(), line.get_linestyle(), line.get_linewidth()) == (".", "-", 1.0)
    assert ends(axis) == {t: [a, b] for t, a, b in zip(x, y + low, y + high, strict=True)}
    assert (band(axis).get_alpha(), band(axis).get_linewidth().tolist()) == (0.3, [0.0])
    ((point, caps, (bar,)),) = axis.containers
    assert points(point) == [[12.0, y[4]]] and point.get_marker() == "."
    assert bar.get_segments()[0].tolist() == [[12.0, y[4] + low[4]], [12.0, y[4] + high[4]]]
    assert [cap.get_markersize() for cap in caps] == [6.0, 6.0]
    colours = [band(axis).get_facecolor()[0], bar.get_color()[0], line.get_color()]
    assert {to_hex(one) for one in (*colours, point.get_color())} == {OKABE_ITO[0]}


def test_labels_of_the_panels() -> None:
    """The camera's column and the vehicle's; times below the lowest panels only."""
    axes = np.array(usual(draw_attitude)).reshape(4, 2)
    assert [one.get_title() for one in axes.flat] == ["camera", "vehicle", *[""] * 6]
    for column in axes.T:
        labels = [one.get_ylabel() for one in column]
        assert labels == [
            *(f"{one}, degrees" for one in list(ANGLE_TEXTS.values())[:3]),
            "half of the\nband, degrees",
        ]  # fmt: skip
        assert [one.get_xlabel() for one in column] == ["", "", "", "time, s"]
        assert texts(column[3].get_legend()) == ["yaw", "pitch", "roll"]
    axes = usual()
    labels = [one.get_ylabel() for one in axes[:3]]
    assert labels == [f"{one}, degrees" for one in list(ANGLE_TEXTS.values())[3:]]
    assert texts(axes[3].get_legend()) == ["alpha", "beta", "eta"]
    untimed = film(time_s=np.full(5, np.nan))
    axes = panels([untimed])
    assert [one.get_xlabel() for one in axes] == ["", "", "", "frame"]
    assert [x for x, _ in points(axes[0].lines[0])] == [1.0, 2.0, 3.0, 4.0, 5.0]
    for both in ([untimed, film()], [film(), untimed]):
        assert panels(both)[-1].get_xlabel() == "time, s; of jobs without times: frame"


@pytest.mark.parametrize("which", [draw_attack, draw_attitude])
def test_panels_share_their_times_and_their_heights(which: Any) -> None:
    axes = usual(which)
    assert all(axes[0].get_shared_x_axes().joined(axes[0], one) for one in axes)
    heights = axes[0].get_gridspec().get_height_ratios()
    assert list(heights) == [1.0, 1.0, 1.0, 0.7]


@pytest.mark.parametrize(("which", "columns"), [(draw_attack, 1), (draw_attitude, 2)])
def test_the_caption_and_the_legend(which: Any, columns: int) -> None:
    figure = Figure()
    assert which(figure, [film()], None).splitlines()[0] == "hand.toml, job 1: a flight by hand"
    assert len(figure.axes) == 4 * columns
    assert texts(figure.legends[0]) == [BAND]


def test_a_wind_whose_errors_are_in_no_job_is_told() -> None:
    one, wind = film(), {"wind": np.zeros((5, 9))}
    doubt = replace(one.uncertainty, components=one.uncertainty.components | wind)
    known = replace(one, uncertainty=doubt)
    told = [draw_attack(Figure(), jobs).splitlines() for jobs in ([one], [one, known])]
    assert_approved(sorted({*told[0]} - {*told[1]}))


TICKS = {  # by the angle that is drawn: yaw from 0 to 360, all others from -180 to 180
    -10.0: ("350", "-10"),
    370.0: ("10", "10"),
    190.0: ("190", "-170"),
    180.0: ("180", "180"),
    -180.0: ("180", "180"),
    360.0: ("0", "0"),
    0.1234567: ("0.123457", "0.123457"),
    123.4567: ("123.457", "123.457"),
    -3e-14: ("0", "0"),
}


@pytest.mark.parametrize("value", TICKS)
def test_ticks_are_angles_in_their_range(value: float) -> None:
    axes = [*usual(draw_attitude)[:6], *usual()[:3]]
    circle, half = TICKS[value]
    said = [axis.yaxis.get_major_formatter()(value, None) for axis in axes]
    assert said == [circle] * 2 + [half] * 7


@pytest.mark.parametrize(
    ("rolls", "numbers"),
    [
        ((178.0, 182.0), {179.0: "179", 180.0: "180", 181.0: "181", -179.0: "181"}),
        ((190.0, 192.0), {190.0: "-170", -168.0: "-168"}),
        ((358.0, 2.0), {359.0: "-1", 0.0: "0", 1.0: "1"}),
        ((350.0, 60.0, 190.0), {-10.0: "-10", 190.0: "-170"}),  # about 0 too
    ],
)
def test_a_roll_on_both_sides_of_180_goes_on(
    rolls: tuple[float, ...], numbers: dict[float, str]
) -> None:
    """As in the table, 181 follows 180; elsewhere it is -180 to 180, as on a screen."""
    roll = panels(alike(2, *rolls), draw_attitude)[2].yaxis.get_major_formatter()
    assert {at: roll(at, None) for at in numbers} == numbers


def test_all_jobs_are_cut_at_the_same_direction() -> None:
    """Opposite to the mean of 10, 170 and 200 degrees, 180: at 0, and not at -170."""
    axis = panels(alike(2, 10.0, 170.0, 200.0))[0]
    assert [line.get_ydata().tolist() for line in solid(axis)] == [
        [10.0, 10.1], [170.0, 170.1], [200.0, 200.1]
    ]  # fmt: skip


def test_each_job_has_its_colour_and_the_seventh_is_grey_and_behind() -> None:
    """Two jobs of a colour could not be told apart."""
    axes = panels(alike(2, *range(7)))
    expected = [GREY, *OKABE_ITO]
    for axis in axes[:3]:
        assert [to_hex(line.get_color()) for line in solid(axis)] == expected
        bands = [one for one in axis.collections if one.get_label() == "band"]
        assert [to_hex(one.get_facecolor()[0]) for one in bands] == expected
    drawn = [line for line in axes[3].lines if len(line.get_xdata())]
    assert [to_hex(line.get_color()) for line in drawn] == expected * 3
    assert [line.get_linestyle() for line in drawn] == [mark for mark in MARKS for _ in expected]


@pytest.mark.parametrize(("frames", "unknown", "marker"), [(60, 0, "."), (61, 0, ""), (61, 1, ".")])
def test_up_to_sixty_frames_are_points(frames: int, unknown: int, marker: str) -> None:
    """Of those that have an angle; in the lowest panel points would hide the lines' styles."""
    angles, half = np.zeros((frames, 9)), np.ones((frames, 9))
    angles[:unknown], half[:unknown] = np.nan, np.nan
    eta = np.tile([-1.0, 1.0], (frames, 1))
    axes = panels([by_hand(frames, angles_deg=angles, half_deg=half, eta_deg=eta)])
    assert (axes[0].lines[0].get_marker() or "None") == (marker or "None")
    assert {line.get_marker() or "None" for line in axes[3].lines[:3]} == {"None"}


def test_frames_without_a_neighbour_have_a_bar() -> None:
    """By which frames have an angle; no line leads to them."""
    alone = {
        (True, False, False, False, False): [0.0],
        (True, True, False, False, False): [],
        (True, False, True, True, False): [0.0],
        (True, True, False, True, False): [3.0],
        (False, True, False, False, True): [1.0, 4.0],
        (False, False, False, False, False): [],
    }
    jobs = []
    for known in alone:
        angles = np.where(np.array(known)[:, None], np.zeros(9), np.nan)
        jobs.append(by_hand(5, angles_deg=angles, half_deg=np.ones((5, 9))))
    bars = {
        bar[0].get_color(): [x for x, _ in points(bar[0])] for bar in panels(jobs)[0].containers
    }
    expected = dict(zip(OKABE_ITO, alone.values(), strict=True))
    assert bars == {colour: times for colour, times in expected.items() if times}


def test_a_frame_alone_without_an_interval_has_no_bar() -> None:
    """But its point."""
    angles = np.zeros((3, 9))
    angles[1] = np.nan
    (bar,) = panels([by_hand(3, angles_deg=angles, half_deg=np.full((3, 9), np.inf))])[0].containers
    assert np.ptp(bar[2][0].get_segments()[0], axis=0).tolist() == [0.0, 0.0]


def test_one_frame_is_a_table() -> None:
    """Of several jobs a column for each, of more than four a row; digits follow the interval."""
    angles, half = np.arange(9.0)[None], np.full((1, 9), 0.5)
    one = by_hand(1, angles_deg=angles, half_deg=half, flags={"jump": [0]})
    for jobs, rows, columns in (([one], 8, 2), ([one, one], 9, 3), ([one] * 5, 6, 9)):
        (axis,) = panels(jobs, draw_attitude)
        (table,) = axis.tables
        cells = {place: cell.get_text().get_text() for place, cell in table.get_celld().items()}
        assert max(cells) == (rows - 1, columns - 1)
        assert {"0.00 ± 0.50", "5.00 ± 0.50", "jump"} <= set(cells.values())
    sharp = by_hand(1, angles_deg=angles, half_deg=np.full((1, 9), 1.23456e-4))
    (table,) = panels([sharp], draw_attitude)[0].tables
    assert "5.0000 ± 0.0001" in {one.get_text().get_text() for one in table.get_celld().values()}


def test_a_camera_that_is_not_turned_has_no_panels_of_its_own() -> None:
    angles = np.tile([10.0, 20.0, 30.0, 370.0, 20.0, 30.0, 0.0, 0.0, 0.0], (3, 1))
    one = by_hand(3, angles_deg=angles)
    assert len(panels([one], draw_attitude)) == 4
    assert draw_attitude(Figure(), [one]).endswith("no mount turns them apart")


# The lowest panel


def test_half_widths() -> None:
    """Broken at the gap and nowhere else; none where it is 0 or there is none."""
    angles, half, eta = ANGLES.copy(), HALF.copy(), ETA.copy()
    angles[:, 6] = np.arange(5) * 170.0  # which wraps
    half[0, 6], half[1, 7] = 0.0, np.inf
    eta[2] = angles[2, 8]
    axis = panels([film(angles_deg=angles, half_deg=half, eta_deg=eta)])[3]
    alpha, beta = HALF[[1, 2, 3, 0, 4], 6], HALF[[1, 2, 3, 0, 4], 7]
    expected = [
        [alpha[0], alpha[1], alpha[2], None, None, alpha[4]],
        [None, beta[1], beta[2], beta[3], None, beta[4]],
        [0.625, None, 0.625, 0.625, None, 0.625],
    ]
    drawn = [line for line in axis.lines if len(line.get_xdata())]
    for line, values in zip(drawn, expected, strict=True):
        assert [y for _, y in points(line)] == values
        assert [x for x, _ in points(line)] == [0.0, 1.0, 2.0, 3.0, None, 12.0]
    looks = [(one.get_marker(), one.get_markersize(), one.get_linewidth()) for one in drawn]
    assert looks == [(".", 2.5, 1.0)] * 3
    # what no line leads to: a frame after a gap, and beside one without a half-width
    assert [one.get_markevery() for one in drawn] == [[5], [5], [0, 5]]


SCALES = {  # smallest and largest half-width: both ends of the scale
    (0.02, 0.5): (0.01, 1.0),
    (1e-9, 0.5): (5e-7, 1.0),
    (2e-6, 2.0): (2e-6, 4.0),
    (8e-6, 2.0): (4e-6, 4.0),
}


@pytest.mark.parametrize("least_and_most", SCALES)
def test_the_scale_of_half_widths(least_and_most: tuple[float, float]) -> None:
    """Twice as far as they go both ways, but six powers of ten at most."""
    half = np.tile([*least_and_most, least_and_most[1]], (9, 1)).T
    axis = panels([by_hand(3, half_deg=half, eta_deg=np.full((3, 2), np.nan))])[3]
    assert axis.get_yscale() == "log"
    assert_close("relative, in blocks or not", axis.get_ylim(), SCALES[least_and_most])
    assert axis.yaxis.get_major_formatter()(0.003, None) == "0.003"
    assert axis.yaxis.get_minor_formatter()(0.02, None) == ""
    marked = axis.yaxis.get_major_locator().tick_values(0.009, 1.1)
    assert_close(
        "table value", marked[(marked > 0.009) & (marked < 1.1)], [0.01, 0.03, 0.1, 0.3, 1]
    )
    assert axis.yaxis.get_major_locator().numticks == 7
    legend = axis.get_legend()
    assert [one.get_linestyle() for one in legend.get_lines()] == MARKS
    assert {one.get_color() for one in legend.get_lines()} == {"0.3"}
    assert legend._ncols == 3


def test_without_half_widths_there_is_no_logarithmic_scale() -> None:
    none = by_hand(3, half_deg=np.full((3, 9), np.inf), eta_deg=np.full((3, 2), np.nan))
    axis = panels([none])[3]
    assert axis.get_yscale() == "linear" and axis.get_ylabel() == "half of the\nband, degrees"


# Breaks of lines


@pytest.mark.parametrize(
    ("angles", "cut"),
    [([0.0], -180.0), ([100.0], -80.0), ([350.0, 30.0], -170.0), ([-100.0], -280.0),
     ([20.4, np.nan], -160.0), ([20.6], -159.0), ([90.0, 90.0, 91.0], -90.0)],
)  # fmt: skip
def test_the_cut_is_opposite_to_the_mean(angles: list[float], cut: float) -> None:
    """At a whole degree."""
    assert unwrapped_about(np.array(angles)) == cut


def test_angles_from_the_cut() -> None:
    """The cut itself belongs to the angles that begin there."""
    angles = np.array([-170.0, 190.0, 189.0, 0.0, 720.0])
    assert from_cut(angles, -170.0).tolist() == [-170.0, -170.0, 189.0, 0.0, 0.0]
    assert from_cut(angles, 100.0).tolist() == [190.0, 190.0, 189.0, 360.0, 360.0]


BREAKS = {  # times, angles: the index of each point, -1 at a break
    "three usual steps": ([0, 1, 2, 5, 6], [0, 0, 0, 0, 0], [0, 1, 2, 3, 4]),
    "more": ([0, 1, 2, 5.1, 6], [0, 0, 0, 0, 0], [0, 1, 2, -1, 3, 4]),
    "equal times": ([0, 0, 0, 0, 1, 3.9], [0] * 6, [0, 1, 2, 3, 4, 5]),
    "no steps": ([4, 4, 4], [0, 0, 0], [0, 1, 2]),
    "median and not mean": ([0, 1, 2, 3, 13], [0] * 5, [0, 1, 2, 3, -1, 4]),
    "half a circle": ([0, 1, 2], [0, 180, 0], [0, 1, 2]),
    "over half": ([0, 1, 2, 3], [0, 180.5, 0, 1], [0, -1, 1, -1, 2, 3]),
    "an angle that is none": ([0, 1, 2], [0, np.nan, 0], [0, 1, 2]),
    "one": ([7], [0], [0]),
    "none": ([], [], []),
}


@pytest.mark.parametrize("name", BREAKS)
def test_where_a_line_breaks(name: str) -> None:
    times, angles, expected = BREAKS[name]
    where, index = broken(np.array(times, float), np.array(angles, float))
    assert index.tolist() == expected
    seen = [None if np.isnan(x) else x for x in where.tolist()]
    assert seen == [None if k < 0 else times[k] for k in expected]
    values = picked(np.array(angles, float) + 5.0, index).tolist()
    for value, k in zip(values, expected, strict=True):
        assert np.isnan(value) if k < 0 or np.isnan(angles[k]) else value == angles[k] + 5.0


def test_frames_of_equal_times_stay_in_their_order() -> None:
    """Of more frames than are sorted by insertion."""
    times = np.tile([1.0, 0.0, np.nan, 1.0], 20)
    zeros, ones = np.flatnonzero(times == 0.0), np.flatnonzero(times == 1.0)
    order = in_time(by_hand(80, time_s=times)).tolist()
    assert order == [*zeros.tolist(), *ones.tolist()]


# Marks, legend and look

TIMES = np.array([3.0, 1.0, 2.0, 0.0])


def rows(*histories: History) -> tuple[list[str], list[list[list[float]]]]:
    """The rows of flags: their texts, and the times and heights of their marks."""
    axis = Figure().subplots()
    draw_flags(axis, list(histories))
    labels = [one.get_text() for one in axis.get_yticklabels()]
    return labels, [points(line) for line in axis.lines]


def test_a_flag_is_a_row_of_marks() -> None:
    one = by_hand(4, time_s=TIMES, flags={"misfit": [2], "jump": [1, 0]})
    labels, marks = rows(one)
    assert labels == ["misfit\n1 of 4", "jump\n2 of 4"]
    assert marks == [[[2.0, 0.0]], [[3.0, 1.0], [1.0, 1.0]]]
    other = by_hand(4, time_s=TIMES, flags={"jump": [3]})
    assert rows(one, other)[0] == ["misfit\n1 of 8", "jump\n3 of 8"]


def test_a_fact_has_one_flag() -> None:
    """Two landmarks always have a second solution, which is not drawn beside them."""
    flags = {"two_landmarks": [0, 1], "second_solution": [0, 1, 3]}
    told = ["two landmarks, second solution\n2 of 4", "second solution\n1 of 4"]
    assert rows(by_hand(4, flags=flags))[0] == told
    assert rows(by_hand(4, flags={"two_landmarks": [0]}))[0] == ["two landmarks\n1 of 4"]


def test_flags_of_frames_without_an_attitude_are_not_drawn() -> None:
    angles = np.zeros((4, 3))
    angles[1] = np.nan
    assert rows(by_hand(4, vehicle_deg=angles, flags={"misfit": [1]}))[0] == []


def test_flags_stand_below_the_angles() -> None:
    """In a panel of their own, which shares the times."""
    axes = panels([film(flags={"misfit": [2]})])
    assert len(axes) == 5 and axes[0].get_shared_x_axes().joined(axes[0], axes[4])
    assert [one.get_xlabel() for one in axes] == ["", "", "", "", "time, s"]


def legend(*histories: History) -> Any:
    figure = Figure((9.0, 8.0), layout="constrained")
    draw_legend(figure, list(histories))
    return figure.legends[0]


def of(source: str, job: int, **changes: Any) -> History:
    return by_hand(4, said={"source": source, "job": job}, **changes)


def test_the_legend() -> None:
    """Jobs by their colour where there are several, and the band."""
    last = of("b", 3)
    one = legend(last)
    assert texts(one) == [BAND]
    (band,) = one.get_patches()
    assert (to_hex(band.get_facecolor()), band.get_alpha()) == (OKABE_ITO[0], 0.3)
    two = legend(of("a", 1), last)
    assert texts(two) == ["a, job 1", "b, job 3", BAND]
    assert [line.get_color() for line in two.get_lines()[:2]] == list(OKABE_ITO[:2])
    (band,) = two.get_patches()
    assert to_hex(band.get_facecolor()) == to_hex("0.5")
    assert texts(legend(of("a", 1), of("a", 2))) == ["job 1", "job 2", BAND]
    many = legend(*[of("a", k) for k in range(1, 9)])
    *named, others, band_text = texts(many)
    assert (named, band_text) == ([f"job {k}" for k in range(1, 7)], BAND)
    assert_approved(others)
    assert [to_hex(line.get_color()) for line in many.get_lines()] == [*OKABE_ITO, GREY]


def test_the_legend_is_outside_the_panels() -> None:
    """Below them, in the middle, in four columns; so that the layout leaves room for it."""
    made = legend(of("a", 1), of("a", 2))
    assert (made._outside_loc, made._loc, made._ncols) == ("lower", 8, 4)


SETTINGS = {
    "font.size": 9.0, "axes.grid": True, "grid.alpha": 0.3, "axes.spines.top": False,
    "axes.spines.right": False, "axes.spines.left": True, "axes.formatter.useoffset": False,
    "legend.frameon": False, "svg.hashsalt": "vopd", "svg.fonttype": "none", "path.simplify": True,
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
