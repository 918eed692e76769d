"""Arrays of landmarks without gaps, and their blocks of frames with like counts."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vopd.landmark_layout import FEW, LandmarkLayout

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
