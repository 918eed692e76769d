"""What a figure takes from its histories, before anything is drawn: by hand."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit.estimates import estimate
from tests.kit.histories import about, with_estimate
from vopd.attitude.history import History, history
from vopd.attitude.uncertainty import ANGLES
from vopd.figures import (
    arrow_scale,
    caption,
    chosen,
    in_time,
    interval_of,
    label,
    points,
    residuals,
    values_of,
)
from vopd.findings import VopdError

ATTITUDES = [[10.0, -60.0, 20.0], [11.0, -61.0, 21.0], [12.0, -62.0, 22.0]]


@cache
def made() -> History:
    """Three frames with four landmarks each, all of which have residuals."""
    return history(estimate(ATTITUDES, noise=0.1))


def of_source(source: str, job: int = 1, title: str = "a title") -> History:
    return about(made(), source=source, job=job, title=title)


CAPTIONS = {  # sources in their order
    ("a",): "a, job 1: a title",
    ("a", "a"): "a, 2 jobs",
    ("b", "a"): "b, a, 2 jobs",
    ("a", "b", "c"): "a, b, c, 3 jobs",
    ("a", "b", "c", "b"): "a, b, c, 4 jobs",
    ("a", "b", "c", "d"): "a, b, c and 1 more, 4 jobs",
    ("a", "b", "c", "d", "e"): "a, b, c and 2 more, 5 jobs",
}


@pytest.mark.parametrize("sources", CAPTIONS)
def test_the_caption(sources: tuple[str, ...]) -> None:
    """Three sources are named, and one job's title; the fixes have a line of their own."""
    some = [of_source(source) for source in sources]
    assert caption(some) == CAPTIONS[sources]
    fixed = [about(one, fixes="restart, earth") for one in some]
    words = "\ncorrected run, not the original: restart, earth"
    assert caption(fixed) == CAPTIONS[sources] + words


def test_the_label_of_a_job() -> None:
    one, two, other = of_source("a"), of_source("a", 2), of_source("b", 3)
    assert [label(h, [one, two]) for h in (one, two)] == ["job 1", "job 2"]
    assert [label(h, [one, other]) for h in (one, other)] == ["a, job 1", "b, job 3"]


def with_landmarks(*counts: int) -> History:
    """The history with so many landmarks that take part in each frame."""
    used = np.arange(4) < np.array(counts)[:, None]
    return history(replace(made().estimate, used=used))


FEWEST, MOST = (3, 3, 4), (3, 4, 4)


def test_the_frame_with_the_most_landmarks() -> None:
    """The first of several, in the first job that has it."""
    few, many = with_landmarks(*FEWEST), with_landmarks(*MOST)
    assert chosen([few], None) == (few, 2)
    assert chosen([many], None) == (many, 1)
    assert chosen([few, many], None) == (few, 2)
    assert chosen([many, few], None) == (many, 1)


@pytest.mark.parametrize("asked", ["DJI_0001.JPG", " DJI_0001.JPG "])
def test_a_frame_by_its_name(asked: str) -> None:
    """In the first job that has it with an attitude."""
    one, two = made(), of_source("b")
    assert chosen([one, two], asked) == (one, 1)
    angles = one.estimate.vehicle_deg.copy()
    angles[1] = np.nan
    without = with_estimate(one, vehicle_deg=angles)
    assert chosen([without, two], asked) == (two, 1)
    with refused(VopdError):
        chosen([without], asked)
    with refused(VopdError):
        chosen([one], 7)


def test_frames_by_their_numbers() -> None:
    numbered = with_estimate(made(), frame_names=())
    assert [chosen([numbered], one)[1] for one in (1, "2", " 3 ")] == [0, 1, 2]
    with refused(VopdError):
        chosen([numbered], 4)


@pytest.mark.parametrize("name", ANGLES)
def test_values_and_intervals_of_every_angle(name: str) -> None:
    """Each angle from its own column; NaN where the half-width is not finite, for eta too."""
    one = made()
    index = ANGLES.index(name)
    angles = np.arange(27.0).reshape(3, 9)
    half = 1.0 + np.arange(27.0).reshape(3, 9) / 10.0
    half[1] = np.inf
    eta = np.array([[7.0, 10.0], [0.0, 180.0], [20.0, 30.0]])
    given = with_estimate(
        one, camera_deg=angles[:, :3], vehicle_deg=angles[:, 3:6], attack_deg=angles[:, 6:]
    )
    doubt = replace(one.uncertainty, half_width_95=half, eta_interval_95_deg=eta)
    given = replace(given, uncertainty=doubt)
    assert values_of(given, name).tolist() == angles[:, index].tolist()
    low, high = interval_of(given, name)
    if name == "eta":
        assert low[[0, 2]].tolist() == [7.0 - 8.0, 20.0 - 26.0]
        assert high[[0, 2]].tolist() == [10.0 - 8.0, 30.0 - 26.0]
    else:
        assert low[[0, 2]].tolist() == (-half[[0, 2], index]).tolist()
        assert high[[0, 2]].tolist() == half[[0, 2], index].tolist()
    assert np.isnan([low[1], high[1]]).all()


def test_frames_in_order_of_time() -> None:
    """Frames without a time are left out; of equal times the first stays first."""
    assert in_time(with_estimate(made(), time_s=np.array([2.0, np.nan, 1.0]))).tolist() == [2, 0]
    assert in_time(with_estimate(made(), time_s=np.array([1.0, 1.0, 0.5]))).tolist() == [2, 0, 1]
    assert in_time(with_estimate(made(), time_s=np.full(3, np.nan))).tolist() == [0, 1, 2]


def test_points_of_residuals() -> None:
    """Of landmarks that take part, with a residual and a time."""
    number, when, pair, outlier = points([made()])
    assert number.tolist() == [7, 8, 9, 10] * 3
    assert when.tolist() == [0.0] * 4 + [1.0] * 4 + [2.0] * 4
    assert pair.tolist() == made().estimate.residual_xy.reshape(-1, 2).tolist()
    assert outlier.shape == (12,)
    untimed = with_estimate(made(), time_s=np.array([0.0, np.nan, 2.0]))
    _, when, pair, _ = points([untimed])
    assert when.tolist() == [0.0] * 4 + [2.0] * 4 and len(pair) == 8
    used = made().estimate.used.copy()
    used[0, 2] = False
    number, *_ = points([history(replace(made().estimate, used=used))])
    assert number.tolist() == [7, 8, 10] + [7, 8, 9, 10] * 2


class TicksOnly:
    """Axes that take everything and keep the labels below them."""

    def __init__(self) -> None:
        self.labels: list[str] = []

    def __getattr__(self, name: str) -> Any:
        return lambda *_, **__: ([], [])

    def set_xticks(self, _: Any, labels: list[str], rotation: float) -> None:
        self.labels, self.rotation = labels, rotation


LONG = "a name of sixteen"
NAMES = [  # of landmark 7 in the first and the second job: its label
    ("tower", "spire", "tower", 90.0),
    ("", "spire", "spire", 90.0),
    ("", "", "7", 0.0),
    (LONG[:16], "", LONG[:16], 90.0),
    (LONG, "", LONG[:15] + "…", 90.0),
    ("abcd", "", "abcd", 0.0),
]


@pytest.mark.parametrize(("first", "second", "text", "rotation"), NAMES)
def test_labels_of_landmarks(first: str, second: str, text: str, rotation: float) -> None:
    """The name that the first job has that has one; sixteen characters, turned above four."""
    jobs = [
        with_estimate(made(), landmark=np.full((3, 4), 7), landmark_names={7: name} if name else {})
        for name in (first, second)
    ]
    above, below = TicksOnly(), TicksOnly()
    figure = SimpleNamespace(subplots=lambda *_, **__: (above, below), legend=lambda *_, **__: None)
    words = residuals(figure, jobs, None)
    assert (below.labels, below.rotation) == ([text], rotation)
    assert words.endswith("measured minus computed; columns from left to right: 0.000 to 2.000 s")


SCALES = [
    (0.011, 10.0, 100.0),
    (0.013, 10.0, 50.0),
    (0.03, 10.0, 20.0),
    (1.2, 10.0, 1.0),
    (0.0, 9.0, 1.0),
]


@pytest.mark.parametrize(("longest", "width", "scale"), SCALES)
def test_arrows_are_a_round_number_of_times_as_long(
    longest: float, width: float, scale: float
) -> None:
    """The longest is about .12 of the width: 1.2 of 10."""
    assert arrow_scale(np.array([[0.0, longest], [longest / 2.0, 0.0]]), width) == scale
