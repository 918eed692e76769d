"""Panels of angles against time: lines, bands, bars, scales and labels, of angles by hand."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from tests.kit.figures import DRAWN, HALF, OKABE_ITO, alike, film, panels, points, texts
from tests.kit.histories import by_hand
from vopd.figures import attack, attitude

MARKS = ["-", "--", ":"]


@cache
def usual(which: Any = attack) -> list[Any]:
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
    figure = usual(attack if k > 5 else attitude)
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
    axes = np.array(usual(attitude)).reshape(4, 2)
    assert [one.get_title() for one in axes.flat] == ["camera", "vehicle", *[""] * 6]
    for column in axes.T:
        labels = [one.get_ylabel() for one in column]
        assert labels == [
            "yaw, degrees", "pitch, degrees", "roll, degrees", "half of 95 %,\ndegrees"
        ]  # fmt: skip
        assert [one.get_xlabel() for one in column] == ["", "", "", "time, s"]
        assert texts(column[3].get_legend()) == ["yaw", "pitch", "roll"]
    axes = usual()
    labels = [one.get_ylabel() for one in axes[:3]]
    assert labels == ["alpha, degrees", "beta, degrees", "eta, degrees"]
    assert texts(axes[3].get_legend()) == ["alpha", "beta", "eta"]
    untimed = film(time_s=np.full(5, np.nan))
    axes = panels([untimed])
    assert [one.get_xlabel() for one in axes] == ["", "", "", "frame"]
    assert [x for x, _ in points(axes[0].lines[0])] == [1.0, 2.0, 3.0, 4.0, 5.0]


@pytest.mark.parametrize("which", [attack, attitude])
def test_panels_share_their_times_and_their_heights(which: Any) -> None:
    axes = usual(which)
    assert all(axes[0].get_shared_x_axes().joined(axes[0], one) for one in axes)
    heights = axes[0].get_gridspec().get_height_ratios()
    assert heights == (1, 1, 1, 0.7)


@pytest.mark.parametrize(("which", "columns"), [(attack, 1), (attitude, 2)])
def test_the_caption_and_the_legend(which: Any, columns: int) -> None:
    figure = Figure()
    assert which(figure, [film()], None) == "hand.toml, job 1: a flight by hand"
    assert len(figure.axes) == 4 * columns
    assert texts(figure.legends[0]) == ["95 % interval"]


TICKS = {  # by the angle that is drawn: yaw and roll from 0 to 360, all others from -180 to 180
    -10.0: ("350", "-10"),
    370.0: ("10", "10"),
    190.0: ("190", "-170"),
    180.0: ("180", "-180"),
    -180.0: ("180", "-180"),
    360.0: ("0", "0"),
    0.1234567: ("0.123457", "0.123457"),
    123.4567: ("123.457", "123.457"),
    -3e-14: ("0", "0"),
}


@pytest.mark.parametrize("value", TICKS)
def test_ticks_are_angles_in_their_range(value: float) -> None:
    axes = [*usual(attitude)[:6], *usual()[:3]]
    circle, half = TICKS[value]
    said = [axis.yaxis.get_major_formatter()(value, None) for axis in axes]
    assert said == [circle] * 2 + [half] * 2 + [circle] * 2 + [half] * 3


def test_all_jobs_are_cut_at_the_same_direction() -> None:
    """Opposite to the mean of 10, 170 and 200 degrees, 180: at 0, and not at -170."""
    axis = panels(alike(2, 10.0, 170.0, 200.0))[0]
    assert [line.get_ydata().tolist() for line in solid(axis)] == [
        [10.0, 10.1], [170.0, 170.1], [200.0, 200.1]
    ]  # fmt: skip


def test_each_job_has_its_colour_and_the_seventh_the_first_s() -> None:
    axes = panels(alike(2, *range(7)))
    expected = [*OKABE_ITO, OKABE_ITO[0]]
    for axis in axes[:3]:
        assert [to_hex(line.get_color()) for line in solid(axis)] == expected
        bands = [one for one in axis.collections if one.get_label() == "band"]
        assert [to_hex(one.get_facecolor()[0]) for one in bands] == expected
    drawn = [line for line in axes[3].lines if len(line.get_xdata())]
    assert [to_hex(line.get_color()) for line in drawn] == expected * 3
    assert [line.get_linestyle() for line in drawn] == [mark for mark in MARKS for _ in expected]


@pytest.mark.parametrize(("frames", "unknown", "marker"), [(60, 0, "."), (61, 0, ""), (61, 1, ".")])
def test_up_to_sixty_frames_are_points(frames: int, unknown: int, marker: str) -> None:
    """Of those that have an angle, and in the lowest panel a half-width."""
    angles, half = np.zeros((frames, 9)), np.ones((frames, 9))
    angles[:unknown], half[:unknown] = np.nan, np.nan
    eta = np.tile([-1.0, 1.0], (frames, 1))
    axes = panels([by_hand(frames, angles_deg=angles, half_deg=half, eta_deg=eta)])
    lines = [axes[0].lines[0], *axes[3].lines[:3]]
    assert [line.get_marker() or "None" for line in lines] == [marker or "None"] * 4


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
    (bar,) = panels([by_hand(1, half_deg=[[np.inf] * 9])])[0].containers
    assert np.ptp(bar[2][0].get_segments()[0], axis=0).tolist() == [0.0, 0.0]
