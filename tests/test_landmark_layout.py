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
