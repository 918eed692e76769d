"""Records of arrays by frame and landmark: equality, shapes, some frames, several records."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.kit.command import CASE_1, DECKS
from vopd.arrays import Bools, Floats, Ints
from vopd.findings import Finding
from vopd.job import Deck, Readings
from vopd.landmark_layout import LandmarkLayout
from vopd.records import ByLandmark, FrameRecord, Record


@dataclass(frozen=True, eq=False, repr=False)
class Marks(Record):
    """The landmarks of all frames."""

    number: Ints
    seen: Bools
    place: Floats


@dataclass(frozen=True, eq=False, repr=False)
class Small(FrameRecord[Marks]):
    """Two frames, of one landmark and of three."""

    frame: Ints
    speed: Floats
    name: str = "a"
    size: float = 1.5
    note: str = field(default="", compare=False)
    hidden: int = field(default=0, repr=False)

    number = ByLandmark[Ints]()
    seen = ByLandmark[Bools]()
    place = ByLandmark[Floats](np.nan)


def small(counts: tuple[int, ...] = (1, 3), first: int = 0, **changes: Any) -> Small:
    total, frames = sum(counts), len(counts)
    values: dict[str, Any] = {
        "frame": np.arange(frames) + 41 + first,
        "speed": np.arange(2.0 * frames).reshape(frames, 2) + first,
        "number": np.arange(total) + 7 + first, "seen": np.ones(total, bool),
        "place": np.arange(2.0 * total).reshape(total, 2) + first,
        "name": "a", "size": 1.5, "note": "", "hidden": 0,
    }  # fmt: skip
    values |= changes
    marks = Marks(*(values.pop(name) for name in ("number", "seen", "place")))
    return Small(LandmarkLayout(np.array(counts)), marks, **values)


def test_arrays_by_frame_and_landmark() -> None:
    one = small()
    assert one.number.tolist() == [[7, 0, 0], [8, 9, 10]]
    assert one.seen.tolist() == [[True, False, False], [True, True, True]]
    assert one.number.dtype.kind == "i" and one.seen.dtype == bool
    assert np.isnan(one.place[0, 1:]).all() and one.place[1, 2].tolist() == [6.0, 7.0]
    assert one.points.number.tolist() == [7, 8, 9, 10]
    with pytest.raises(AttributeError) as raised:
        one.nothing  # noqa: B018
    assert "has no attribute 'nothing'" in str(raised.value)
    assert repr(one) == (
        "Small(layout=LandmarkLayout(2 frames, 4 landmarks), points=Marks(number=array(4,), "
        "seen=array(4,), place=array(4, 2)), frame=array(2,), speed=array(2, 2), name='a', "
        "size=1.5, note='')"
    )


@pytest.mark.parametrize(
    ("changes", "same"),
    [
        ({}, True), ({"note": "b"}, True), ({"name": "b"}, False), ({"size": 2.5}, False),
        ({"hidden": 1}, False), ({"frame": np.array([41, 43])}, False),
        ({"number": np.array([7, 8, 9, 11])}, False), ({"place": np.zeros((4, 2))}, False),
        ({"counts": (3, 1)}, False), ({"seen": np.array([True, True, True, False])}, False),
        ({"speed": np.array([[0.0, 1.0], [2.0, 3.5]])}, False),
    ],
)  # fmt: skip
def test_records_are_alike_where_all_values_are(changes: dict[str, Any], same: bool) -> None:
    assert (small(**changes) == small()) is same
    assert (small() == small(**changes)) is same


def test_nan_is_alike_and_records_of_other_kinds_are_not() -> None:
    lost = np.array([[0.0, np.nan], [2.0, 3.0]])
    assert small(speed=lost) == small(speed=lost.copy()) and small(speed=lost) != small()
    assert small(size=np.nan) == small(size=np.nan) and small(size=np.nan) != small()
    (job,) = vopd.read_deck(CASE_1)
    assert small() != job.readings and job.camera != job.wind and small() != 3
    assert job == vopd.read_deck(CASE_1)[0]


FOUR = small((1, 3, 0, 2))
EVEN = small((2, 2, 2))


@pytest.mark.parametrize("whole", [FOUR, EVEN], ids=["uneven", "even"])
@pytest.mark.parametrize(
    "frames",
    [
        slice(None), slice(1, 3), slice(2, None), slice(0, 0), slice(3, 1), slice(-1, None),
        slice(None, None, 2), slice(None, None, -1), np.array([2, 0]), np.array([1]),
        np.zeros(0, np.int64), np.array([0, 0, 1]),
    ],
    ids=str,
)  # fmt: skip
def test_some_frames_have_their_own_values(whole: Small, frames: Any) -> None:
    some = whole.take(frames)
    index = np.arange(len(whole.frame))[frames]
    assert some.frame.tolist() == whole.frame[index].tolist()
    assert some.speed.tolist() == whole.speed[index].tolist()
    assert some.layout.count.tolist() == whole.layout.count[index].tolist()
    rows = [k for one in index for k in range(*whole.layout.span(one).indices(99))]
    for name in ("number", "seen", "place"):
        expected = getattr(whole.points, name)[rows].tolist()
        assert getattr(some.points, name).tolist() == expected
    assert (some.name, some.size, some.note, some.hidden) == ("a", 1.5, "", 0)


def test_several_records_one_after_the_other() -> None:
    one, other = small(), small((2,), first=100, name="b")
    both = Small.concat([one, other])
    assert both.frame.tolist() == [41, 42, 141] and both.name == "a"
    assert both.speed.tolist() == [[0, 1], [2, 3], [100, 101]]
    assert both.number.tolist() == [[7, 0, 0], [8, 9, 10], [107, 108, 0]]
    assert both.layout.count.tolist() == [1, 3, 2]
    assert both.take(slice(2, 3)).points.place.tolist() == other.points.place.tolist()
    assert Small.concat([one]) is one


def test_readings_whose_columns_are_free_between_others() -> None:
    """0 stands where a frame has no landmark, also for real numbers."""
    present = np.array([[True, False, True], [False, True, False]])
    read = np.arange(36.0).reshape(2, 3, 3, 2) + 1.0
    number = np.array([[7, 0, 9], [0, 8, 0]])
    one = Readings.of(np.array([1, 2]), np.zeros((2, 4, 3, 2)), number, present, read)
    assert one.points.landmark.tolist() == [7, 9, 8]
    assert one.landmark.tolist() == [[7, 9], [8, 0]]
    assert one.landmark_in[0, 1].tolist() == read[0, 2].tolist()
    assert one.landmark_in[1, 1].tolist() == [[0.0] * 2] * 3
    noted = replace(one, first_card={7: Finding("x")})
    assert noted == one


def test_a_deck_is_a_sequence_of_its_jobs() -> None:
    jobs = tuple(vopd.read_deck(DECKS / "appendix_h" / "cases_1_2_3.dat"))
    deck = Deck(jobs)
    assert len(deck) == 3 and (deck.name, deck.findings) == ("", ())
    assert deck[1] is jobs[1] and deck[-1] is jobs[2] and deck[1:] == jobs[1:]
