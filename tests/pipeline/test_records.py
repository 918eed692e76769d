"""Records of arrays, layouts of landmarks, and the small records that rooms hand to each other."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import vopd
from tests.approved.texts import assert_approved
from tests.kit.command import CASE_1, DECKS
from tests.kit.estimates import estimate
from tests.kit.jobs import BY_FRAME, BY_LANDMARK, film
from vopd.arrays import Bools, Floats, Ints, among, distinct_in_rows, in_four_bytes
from vopd.estimate import (
    About,
    Estimate,
    FrameStatus,
    Position,
    StatedSigmas,
    Units,
    Vertical,
    Words,
)
from vopd.findings import BASIC_DATA, Finding, InputError, VopdError, group_text
from vopd.job import Deck, Readings
from vopd.landmark_layout import FEW, LandmarkLayout
from vopd.records import ByLandmark, FrameRecord, Rows, alike_together
from vopd.results import Outcome, SolvedJob, SourceEnd, Stage, Stop


@dataclass(frozen=True, eq=False, repr=False)
class Marks(Rows):
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
    one, same = (vopd.run(CASE_1).histories()[0] for _ in range(2))  # with tuples of arrays
    other = vopd.run(CASE_1).histories(vopd.Sigmas(landmark=1.0))[0]
    assert one == same and one.uncertainty != other.uncertainty


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


def test_a_deck_shows_its_name_and_how_many_jobs_it_has() -> None:
    """A deck of a thousand jobs filled a notebook with a megabyte."""
    deck = vopd.read_deck("decks/appendix_h/cases_1_2_3.dat")
    assert repr(deck) == str(deck) == "Deck(decks/appendix_h/cases_1_2_3.dat, 3 jobs)"
    assert repr(vopd.Deck(deck.jobs[:1])) == "Deck(1 job)"


# Layouts of landmarks


COUNTS = st.lists(st.one_of(st.integers(0, 6), st.integers(0, 3000)), max_size=60)
LAYOUT = LandmarkLayout(np.array([2, 0, 3]))
VALUES = np.array([10, 11, 30, 31, 32])


def test_by_hand() -> None:
    assert LAYOUT.total == 5 and LAYOUT.widest == 3 and not LAYOUT.even
    assert LAYOUT.frame.tolist() == [0, 0, 2, 2, 2]
    assert VALUES[LAYOUT.span(2)].tolist() == [30, 31, 32]
    assert VALUES[LAYOUT.rows(np.array([2, 0]))].tolist() == [30, 31, 32, 10, 11]
    assert LAYOUT.only(np.array([2, 0])).count.tolist() == [3, 2]
    arranged = LAYOUT.padded(VALUES)
    assert arranged.tolist() == [[10, 11, 0], [0, 0, 0], [30, 31, 32]]
    assert LAYOUT.flat(arranged).tolist() == VALUES.tolist()
    assert LAYOUT.counted(VALUES > 10).tolist() == [1, 0, 3]


def test_an_array_that_is_made_for_the_asker_cannot_be_written_to() -> None:
    """Or a change would be lost without a word."""
    with pytest.raises(ValueError, match="read-only"):
        LAYOUT.padded(VALUES)[0, 0] = 1
    even = LandmarkLayout(np.array([2, 2]))
    values = np.arange(4)
    even.padded(values)[1, 0] = 7
    assert values.tolist() == [0, 1, 7, 3]


def test_no_frame() -> None:
    none = LandmarkLayout(np.zeros(0, np.int64))
    assert none.total == 0 and none.padded(np.zeros((0, 2))).shape == (0, 0, 2)
    assert none.counted(np.zeros(0, bool)).tolist() == []


@given(COUNTS, st.integers(0, 2**32 - 1))
def test_different_values_are_those_of_a_set(counts: list[int], seed: int) -> None:
    layout = LandmarkLayout(np.array(counts, np.int64))
    rng = np.random.default_rng(seed)
    values, used = rng.integers(-2, 4, layout.total), rng.random(layout.total) < 0.5
    wanted = [
        len(set(values[layout.span(k)][used[layout.span(k)]].tolist())) for k in range(len(counts))
    ]
    assert layout.distinct(values, used).tolist() == wanted


@given(COUNTS, st.one_of(st.none(), st.integers(1, 5000)))
def test_blocks_are_all_frames_and_hardly_larger_than_their_landmarks(
    counts: list[int], most: int | None
) -> None:
    layout = LandmarkLayout(np.array(counts, np.int64))
    blocks = layout.blocks(most)
    assert sorted(k for block in blocks for k in block.tolist()) == list(range(len(counts)))
    elements = 0
    for block in blocks:
        some = layout.only(block)
        arranged = len(block) * some.widest
        elements += arranged
        assert arranged <= max(2 * some.total, some.total + FEW)
        assert most is None or arranged <= most or len(block) == 1
    assert elements <= max(2 * layout.total, layout.total + FEW)


def test_frames_of_like_counts_are_one_block_in_their_order() -> None:
    layout = LandmarkLayout(np.array([4, 6, 3, 5] * 1000))
    (block,) = layout.blocks()
    assert block.tolist() == list(range(4000))


def test_layouts_are_alike_where_every_frame_has_as_many() -> None:
    one = LandmarkLayout(np.array([2, 3]))
    assert one == LandmarkLayout(np.array([2, 3])) and one != LandmarkLayout(np.array([3, 2]))
    assert one != LandmarkLayout(np.array([2, 3, 0])) and one != [2, 3]


def test_frames_without_a_landmark_at_both_ends() -> None:
    layout = LandmarkLayout(np.array([0, 2, 0, 1, 0]))
    assert layout.start.tolist() == [0, 0, 2, 2, 3] and layout.end.tolist() == [0, 2, 2, 3, 3]
    assert layout.present.tolist() == [
        [False] * 2, [True] * 2, [False] * 2, [True, False], [False] * 2,
    ]  # fmt: skip
    values, used = np.array([5, 5, 7]), np.array([True, True, True])
    assert layout.counted(used).tolist() == [0, 2, 0, 1, 0]
    assert layout.counted(values == 5).tolist() == [0, 2, 0, 0, 0]
    assert layout.distinct(values, used).tolist() == [0, 1, 0, 1, 0]
    same = LandmarkLayout(np.array([1, 2]))  # the same number in two frames counts in both
    assert same.distinct(np.array([5, 5, 7]), used).tolist() == [1, 2]
    assert same.distinct(np.array([5, 7, 5]), np.array([True, False, True])).tolist() == [1, 1]
    assert layout.rows(np.array([1, 0, 3, 1])).tolist() == [0, 1, 2, 0, 1]
    assert layout.span(3) == slice(2, 3)


def test_what_stands_where_a_frame_has_no_landmark() -> None:
    layout = LandmarkLayout(np.array([1, 2]))
    pairs = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    found = layout.padded(pairs, np.nan)
    assert np.isnan(found[0, 1]).all() and found[1].tolist() == [[3.0, 4.0], [5.0, 6.0]]
    assert layout.padded(pairs)[0, 1].tolist() == [0.0, 0.0]
    assert layout.padded(np.array([True, True, True])).tolist() == [[True, False], [True, True]]
    assert layout.padded(pairs.astype(np.float32), np.nan).dtype == np.float32
    assert layout.flat(found).tolist() == pairs.tolist()


@pytest.mark.parametrize(
    ("counts", "most", "blocks"),
    [
        ([2, 2, 2, 2, 2], 4, [[0, 1], [2, 3], [4]]), ([2, 2, 2, 2, 2], 5, [[0, 1], [2, 3], [4]]),
        ([2, 2, 2, 2], 4, [[0, 1], [2, 3]]), ([2, 2, 2], 1, [[0], [1], [2]]),
        ([1, 1, 3], 6, [[0, 1], [2]]), ([2, 2], None, [[0, 1]]), ([0, 0], 1, [[0], [1]]),
        ([0, 0, 0], 2, [[0, 1], [2]]),
    ],
)  # fmt: skip
def test_blocks_of_so_many_elements(
    counts: list[int], most: int | None, blocks: list[list[int]]
) -> None:
    found = LandmarkLayout(np.array(counts)).blocks(most)
    assert [block.tolist() for block in found] == blocks


def test_frames_of_very_unlike_counts_are_apart() -> None:
    """By powers of two: 4 to 7 are alike, 8 is not; where few elements would be empty they stay."""
    counts = [4, 7, 8, 5, 15, 6] * 100 + [5000]
    blocks = LandmarkLayout(np.array(counts)).blocks()
    sizes = [sorted({counts[k] for k in block.tolist()}) for block in blocks]
    assert sizes == [[4, 5, 6, 7], [8, 15], [5000]]
    assert len(LandmarkLayout(np.array([1] * 63 + [65])).blocks()) == 1  # 4,160 for 128, 4,032 more
    assert len(LandmarkLayout(np.array([1] * 64 + [66])).blocks()) == 2  # 4,290 for 130, 4,160 more


@pytest.mark.parametrize(
    ("counts", "together", "runs"),
    [
        ([2, 2, 2, 2], 6, [[0], [1, 2], [3]]), ([2, 2, 2, 2], 100, [[0, 1, 2, 3]]),
        ([0, 0, 0, 0], 2, [[0], [1, 2], [3]]), ([2, 2], 1, [[0], [1]]),
    ],
)  # fmt: skip
def test_runs_count_landmarks_and_frames(
    counts: list[int], together: int, runs: list[list[int]]
) -> None:
    """Of 3, 6, 9, 12 so far the first is below 6, two are below 12."""
    found = LandmarkLayout(np.array(counts)).runs(together, 1000)
    assert [[k for block in run for k in block.tolist()] for run in found] == runs
    assert all(len(run) == 1 for run in found)


def test_a_run_is_taken_in_blocks() -> None:
    (run,) = LandmarkLayout(np.array([2] * 5)).runs(1000, 4)
    assert [block.tolist() for block in run] == [[0, 1], [2, 3], [4]]
    two = LandmarkLayout(np.array([2] * 6)).runs(10, 4)
    assert [[block.tolist() for block in run] for run in two] == [[[0, 1], [2]], [[3, 4], [5]]]


# Small records


ANGLES = np.tile([140.0, -60.0, 20.0], (2, 1))


def test_words_and_units_of_any_source() -> None:
    assert asdict(Words()) == {
        "source": "source", "jobs": True, "attack": True, "no_fixes": "", "surface": "in the image",
        "centre": "principal point", "landmark": "its name or number",
        "reading": "a measured image coordinate", "vertical": "",
        "altitude": "above the ellipsoid", "own_position": "", "columns": {}, "flags": {},
        "conventions": {}, "sigma_keys": {},
    }  # fmt: skip
    assert Units() == ("ft", "mm", 0.3048, "µm", 1000.0)
    assert Units._fields == (
        "length", "image", "metres_per_length", "residual", "residuals_per_image",
    )  # fmt: skip
    assert About("a.dat") == (
        "a.dat", 1, "", "", "along the ellipsoid's normal", Words(), None, "",
    )  # fmt: skip
    assert StatedSigmas() == ((0.0,) * 3, (0.0,) * 3, 0.0, 0.0, (0.0, 0.0), (0.0,) * 3, 0.0, 0.0)
    with pytest.raises(AttributeError):
        Words().source = "deck"  # type: ignore[misc]


def test_codes_and_names_of_how_frames_end() -> None:
    assert {one.name: int(one) for one in FrameStatus} == {
        "SOLVED": 0, "IGNORED": 1, "EXACT": 2, "STOPPED": 3, "UNSOLVED": 4,
    }  # fmt: skip
    assert {one.name: int(one) for one in Outcome} == {
        "SOLVED": 0, "DROPPED": 1, "EXACT": 2, "EXACT_LATE": 3, "STOPPED": 4,
    }  # fmt: skip
    assert {one.name: str(one) for one in Vertical} == {
        "GEODETIC": "geodetic", "GEOCENTRIC": "geocentric",
    }  # fmt: skip
    assert {one.name: one.value for one in Stage} == {
        "TIME": "before group 1", "LENS": "after group 3", "WIND": "after group 4",
    }  # fmt: skip


def test_what_an_estimate_has_where_its_source_says_nothing() -> None:
    values = {one.name: getattr(estimate(ANGLES), one.name) for one in fields(Estimate)}
    for name in ("landmark_names", "frame_names"):
        values.pop(name)
    bare = Estimate(**values)
    assert (bare.fiducial_sigma, bare.landmark_names, bare.frame_names) == (0.0, {}, [])
    assert bare.stated == StatedSigmas()
    assert (bare.slip_effect_deg, bare.grid, bare.gimbal_deg, bare.outlier) == (None,) * 4
    place = Position(*np.zeros((5, 2)))
    assert (place.vertical, place.to_own_m, place.largest_lean_deg) == ("geodetic", None, None)


def test_names_of_landmarks_and_frames() -> None:
    named = estimate(ANGLES, frame=np.array([41, 52]))
    assert [named.landmark_label(k) for k in (7, 10, 11, np.int64(8))] == [
        "church tower", "<crossing>", "11", "bridge; north end",
    ]  # fmt: skip
    assert [named.frame_label(k) for k in (0, 1)] == ["DJI_0000.JPG", "DJI_0001.JPG"]
    bare = replace(named, landmark_names={}, frame_names=[])
    assert bare.landmark_label(7) == "7" and [bare.frame_label(k) for k in (0, 1)] == ["41", "52"]


def test_residuals_as_pairs() -> None:
    """x of every landmark stands before y of every landmark; NaN where one takes no part."""
    used = np.array([[True, True, True, True], [True, False, True, True]])
    e = estimate(ANGLES, residual=np.array([[1.0, 2, 3, 4, 5, 6, 7, 8]] * 2), used=used)
    assert e.residual_xy[0].tolist() == [[1, 5], [2, 6], [3, 7], [4, 8]]
    assert np.isnan(e.residual_xy[1, 1]).all() and e.residual_xy[1, 2].tolist() == [3, 7]


def test_a_finding_s_defaults_and_errors() -> None:
    assert asdict(Finding("odd")) == {
        "message": "odd", "source": "", "card": None, "job": None, "group": None, "field": "",
        "columns": None, "image": None, "severity": "error",
    }  # fmt: skip
    assert str(Finding("odd")) == "odd" and BASIC_DATA == 0
    assert [group_text(k) for k in (0, 1, 12)] == ["basic data", "group 1", "group 12"]
    error = InputError(Finding("odd", "a.dat"))
    assert isinstance(error, VopdError) and str(error) == "a.dat: odd"


def test_ends_and_solved_jobs() -> None:
    assert SourceEnd("a") == ("a", None, ())
    assert SourceEnd._fields == ("source", "error", "findings")
    assert Finding("odd", "a.dat").deck == "a.dat"  # its earlier name
    (results,) = vopd.run(vopd.read_deck(CASE_1))
    assert SolvedJob("a", 2, results).findings == ()
    assert results.stop is None
    assert [one.name for one in fields(Stop)] == [
        "frame_index", "stage", "group", "table", "position", "vari", "vard",
    ]  # fmt: skip


FRAME = {
    "frame": "", "outcome": "", "time_s": "", "vehicle_ft": "3", "centre_in": "2", "centre_mm": "2",
    "start_deg": "3", "camera_deg": "3", "vehicle_deg": "3", "alpha_deg": "", "beta_deg": "",
    "eta_deg": "", "airspeed_ft_s": "", "residual_deviation_mm": "", "correction_rad": "3",
    "last_pass": "", "singular": "", "outside_clock": "", "outside_trajectory": "",
    "outside_wind": "",
}  # fmt: skip
LANDMARK = {
    "landmark": "", "used": "", "ignored": "", "longitude_deg": "", "latitude_deg": "",
    "geocentric_latitude_deg": "", "altitude_ft": "", "radius_km": "", "radius_kft": "",
    "direction": "3", "point_in": "2", "point_mm": "2", "radius_mm": "", "distortion_mm": "",
    "residual_mm": "2", "at_centre": "",
}  # fmt: skip


KINDS = dict.fromkeys(("frame", "outcome", "landmark", "last_pass"), np.int64) | dict.fromkeys(
    (
        "used", "ignored", "at_centre", "singular", "outside_clock", "outside_trajectory",
        "outside_wind",
    ),
    np.bool_,
)  # fmt: skip


def test_the_shape_of_every_array_of_results() -> None:
    """As it is declared, and as it is."""
    (results,) = vopd.run(vopd.read_deck(CASE_1))
    shapes = {name: ("F", *more.split()) for name, more in FRAME.items()}
    shapes |= {name: ("F", "L", *more.split()) for name, more in LANDMARK.items()}
    assert (set(BY_FRAME), set(BY_LANDMARK)) == (set(FRAME), set(LANDMARK))
    sizes = {"F": 1, "L": 3}
    for name, axes in shapes.items():
        expected = tuple(sizes.get(axis) or int(axis) for axis in axes)
        assert getattr(results, name).shape == expected, name
        assert getattr(results, name).dtype == KINDS.get(name, np.float64), name
    assert results.focal_length_mm.tolist() == [results.job.camera.focal_length_mm]


def test_counts_and_some_frames_of_results() -> None:
    """Landmarks that take part, not those that are there; a job of some frames has their cards."""
    job = film(2)
    (results,) = vopd.run(job)
    assert results.used_count.tolist() == results.layout.count.tolist() == [5, 5]
    ignored = replace(job.ignored, everywhere=job.readings.landmark[0, :1])
    (fewer,) = vopd.run(replace(job, ignored=ignored))
    assert fewer.used_count.tolist() == [4, 4] and fewer.layout.count.tolist() == [5, 5]
    last = results.as_job(np.array([1]))
    assert last.frame.tolist() == results.frame[1:].tolist()
    assert last.job.readings.frame.tolist() == results.job.readings.frame[1:].tolist()
    assert len(results.job.readings.frame) == 2
    assert last.camera_deg.tolist() == results.camera_deg[1:].tolist()
    assert last.focal_length_mm.tolist() == [results.job.camera.focal_length_mm]
    assert results.focal_length_mm.shape == (2,)


def test_a_run_that_stopped_has_the_landmarks_of_its_frames() -> None:
    """Not those of the frames behind, also where its results are made anew with other values."""
    (job,) = vopd.read_deck(DECKS / "regression" / "wind_out_of_order.dat")
    film_job = replace(job, readings=Readings.concat([job.readings] * 2))
    (stopped,) = vopd.run(film_job)
    assert stopped.stop is not None and len(stopped.frame) < len(film_job.readings.frame)
    anew = replace(stopped, stop=None)
    assert len(anew.layout.count) == len(anew.frame) == len(anew.landmark)
    assert anew.layout.count.tolist() == film_job.readings.layout.count[: len(anew.frame)].tolist()
    assert anew.stop is None and anew.landmark.tolist() == stopped.landmark.tolist()


# Rows of an array


def test_different_values_of_each_row() -> None:
    """5 5 7; nothing used; one 9 of two; the largest number; all alike; and no columns at all."""
    values = np.array([[5, 7, 5], [1, 2, 3], [9, 4, 9], [2**62, 0, 2**62], [6, 6, 6]])
    used = np.array([[1, 1, 1], [0, 0, 0], [1, 0, 1], [1, 1, 0], [1, 1, 1]], bool)
    assert distinct_in_rows(values, used).tolist() == [2, 0, 1, 2, 1]
    assert distinct_in_rows(values[:, :0], used[:, :0]).tolist() == [0] * 5


def test_which_are_among_some() -> None:
    """Few are compared one by one, many by sorting: 10,000 comparisons, and 10,001."""
    values = np.array([3, 1, 4, 1, 5])
    assert among(values, np.array([1, 5])).tolist() == [False, True, False, True, True]
    assert among(values, np.array([], np.int64)).tolist() == [False] * 5
    assert among(values[:0], values).tolist() == []
    for count in (2000, 2001):
        some = np.arange(2, 2 + count)
        assert among(values, some).tolist() == [True, False, True, False, True]


def test_indices_in_half_of_their_memory() -> None:
    found = in_four_bytes(np.array([0, 2**31 - 1, 70_000]))
    assert found.dtype == np.int32 and found.tolist() == [0, 2**31 - 1, 70_000]
    already = np.array([1, 2], np.int32)
    assert in_four_bytes(already) is already  # type: ignore[arg-type]


# Jobs that are alike


def test_jobs_of_a_kind_are_together_until_they_have_enough_frames() -> None:
    """Kind a ends at its third job, 2 + 3 + 5 = 10 frames; what is left comes last."""
    jobs = [("a", 2), ("b", 1), ("a", 3), ("a", 5), ("b", 8), ("a", 1)]
    assert list(alike_together(jobs, 10)) == [[0, 2, 3], [1, 4], [5]]
    assert list(alike_together(jobs, 9)) == [[0, 2, 3], [1, 4], [5]]
    assert list(alike_together(jobs, 11)) == [[0, 2, 3, 5], [1, 4]]


def test_a_long_job_is_a_group_by_itself() -> None:
    assert list(alike_together([("a", 10), ("a", 1)], 10)) == [[0], [1]]
    assert list(alike_together([], 10)) == []


def test_arrays_of_all_jobs_say_what_they_are_where_no_run_is_at_hand() -> None:
    """As for `help(vopd.Run.vehicle_deg)`."""
    assert_approved(vopd.Run.vehicle_deg.__doc__)
    assert isinstance(vopd.run(CASE_1).vehicle_deg, np.ndarray)
