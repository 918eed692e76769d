"""Groups 11 and 12: each rule by a case worked by hand, all of them against the listing's cards."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vopd.job import Ignored, Readings
from vopd.program.ignored import kept


def mark(numbers: Sequence[int]) -> list[int]:
    """A 74 to A 76 and A 80 to A 81: what is below one becomes 101."""
    return [101 if number < 1 else number for number in numbers]


def drop(ifram: int, ifm: Sequence[int], jout: Sequence[Sequence[int]]) -> bool:
    """A 129 to A 137: whether the frame ends with FORMAT 88."""
    nout = len(ifm)
    if nout < 1:
        return False  # GO TO 25
    for i in range(nout):  # DO 24
        if ifram != ifm[i]:
            continue  # GO TO 24
        return mark(jout[i])[0] == 100  # if not GO TO 25; if so WRITE (6,88), GO TO 21
    return False


def taken(
    ifram: int,
    itgts: Sequence[int],
    ifm: Sequence[int],
    jout: Sequence[Sequence[int]],
    iout: Sequence[int],
) -> list[bool]:
    """A 138 to A 161: for each landmark read, whether it reaches label 30."""
    nj, nk, nout, nt = len(itgts), 0, len(ifm), len(iout)
    reached: list[bool] = []
    for itgt in itgts:  # DO 31
        label, i, m = (28 if nout < 1 else 270), 0, 0
        while label != 31:
            if label == 270:  # head of DO 27
                if i == nout:
                    label = 28
                elif ifram != ifm[i]:
                    label = 27
                else:
                    label, m = 260, 0
            elif label == 260:  # head of DO 26
                if m == 6:
                    label = 27
                elif itgt != mark(jout[i])[m]:
                    m += 1
                else:
                    nk += 1
                    label = 28 if nj - nk < 2 else 90
            elif label == 27:
                i += 1
                label = 270
            elif label == 28:
                label, i = 290, 0
            elif label == 290:  # head of DO 29
                if i == nt:
                    label = 30
                elif mark(iout)[i] != itgt:
                    i += 1
                else:
                    nk += 1
                    label = 30 if nj - nk < 2 else 90
            else:  # 90 is WRITE (6,90), 30 takes the landmark in
                reached.append(label == 30)
                label = 31
    return reached


Card = tuple[int, list[int]]


def readings(frames: list[tuple[int, list[int]]]) -> Readings:
    """Frames by number, each with its landmarks in the order of reading."""
    width = max(len(marks) for _, marks in frames)
    landmark = np.array([marks + [0] * (width - len(marks)) for _, marks in frames])
    present = np.array([[k < len(marks) for k in range(width)] for _, marks in frames])
    shape = landmark.shape
    return Readings.of(
        frame=np.array([number for number, _ in frames]),
        fiducial_in=np.zeros((shape[0], 4, 3, 2)),
        landmark=landmark,
        present=present,
        landmark_in=np.zeros((*shape, 3, 2)),
    )


def ignored(cards: list[Card], everywhere: list[int]) -> Ignored:
    """Group 11's cards, filled up with zeros as blank columns are, and group 12."""
    rows = [marks + [0] * (6 - len(marks)) for _, marks in cards]
    return Ignored(
        frame=np.array([frame for frame, _ in cards], np.int64),
        landmark=np.array(rows, np.int64).reshape(-1, 6),
        everywhere=np.array(everywhere, np.int64),
    )


def left(marks: list[int], cards: list[Card], everywhere: list[int]) -> list[int] | str:
    """The landmarks of frame 7 that take part, or that it is dropped."""
    dropped, used = kept(readings([(7, marks)]), ignored(cards, everywhere))
    if dropped[0]:
        assert not used.any()
        return "dropped"
    return [number for number, takes_part in zip(marks, used, strict=True) if takes_part]


@pytest.mark.parametrize(
    ("marks", "cards", "everywhere", "wanted"),
    [
        # nothing asked for; a zero or a negative number is no landmark (A 76, A 81)
        ([1, 2, 3], [], [], [1, 2, 3]),
        ([1, 2, 3], [(7, [0, -1])], [0, 0, -5], [1, 2, 3]),
        # group 11 in its frame only
        ([1, 2, 3], [(7, [2])], [], [1, 3]),
        ([1, 2, 3], [(8, [2])], [], [1, 2, 3]),
        # group 12 in all frames
        ([1, 2, 3], [], [3, 0], [1, 2]),
        # every card of the frame counts for landmarks, and any of its six places
        ([1, 2, 3, 4], [(7, [1]), (8, [2]), (7, [0, 0, 0, 0, 0, 4])], [], [2, 3]),
        # 100 first on the frame's first card drops it
        ([1, 2, 3], [(8, [2]), (7, [100])], [], "dropped"),
        ([1, 2, 3], [(7, [100, 2])], [], "dropped"),
        ([1], [(7, [100])], [], "dropped"),
        # 100 in another place does nothing
        ([1, 2, 3], [(7, [2, 100])], [], [1, 3]),
        ([1, 2, 3], [(7, [0, 100])], [], [1, 2, 3]),
        # 100 first on the frame's second card does nothing, but the rest of that card counts
        ([1, 2, 3], [(7, [2]), (7, [100])], [], [1, 3]),
        ([1, 2, 3, 4], [(7, [2]), (7, [100, 4])], [], [1, 3]),
        # first card drops, the second is not looked at
        ([1, 2, 3], [(7, [100]), (7, [2])], [], "dropped"),
        # 100 in group 12 does nothing
        ([1, 2, 3], [], [100], [1, 2, 3]),
        # never fewer than two: 3 - 1 = 2 is allowed, 3 - 2 = 1 is not
        ([1, 2, 3], [(7, [1, 2])], [], [2, 3]),
        ([1, 2], [(7, [1])], [], [1, 2]),
        ([1], [(7, [1])], [], [1]),
        ([1, 2, 3], [], [1, 2, 3], [2, 3]),
        # it is the order of reading that decides, not that of the cards
        ([3, 2, 1], [(7, [1, 2])], [], [3, 1]),
        # both groups count on: 1 by group 11, 2 by group 12, then 4 - 3 = 1
        ([1, 2, 3, 4], [(7, [1])], [2, 3], [3, 4]),
        ([1, 2, 3, 4], [(7, [3])], [1, 2], [3, 4]),
        # once refused, always refused: NK 1 for the first 5, 2 and 3 for the others
        ([5, 5, 5], [(7, [5])], [], [5, 5]),
        # a refused one of group 11 is tried again by group 12: NK 1, then 2 and 3, then 4
        ([1, 2, 3], [(7, [1, 2])], [2, 3], [2, 3]),
        ([1, 2], [(7, [1])], [1], [1, 2]),
        # one that both groups ignore counts once: NK 1, and 4 - 2 = 2 is allowed
        ([1, 2, 3, 4], [(7, [1, 2])], [1], [3, 4]),
        # landmarks of one number are landmarks each
        ([6, 6, 7, 8], [(7, [6])], [], [7, 8]),
    ],
)
def test_by_hand(
    marks: list[int], cards: list[Card], everywhere: list[int], wanted: list[int] | str
) -> None:
    """Frame 7: NJ landmarks are read; each one asked for counts NK up, and NJ - NK is compared."""
    assert left(marks, cards, everywhere) == wanted


def test_frames_do_not_touch_each_other() -> None:
    """Of four frames, 1 is dropped, 2 has 11 out, 3 is left alone, 4 has three places."""
    read = readings([(1, [11, 12]), (2, [11, 12, 13]), (3, [11, 12]), (4, [11, 12, 13])])
    asked = ignored([(2, [11]), (1, [100])], [13, 12])
    dropped, used = kept(read, asked)
    assert dropped.tolist() == [True, False, False, False]
    assert used.tolist() == [
        *(False, False),
        *(False, True, True),  # 11 by group 11; then 12 and 13 would leave one
        *(True, True),  # two landmarks: nothing can be ignored
        *(True, False, True),  # 12, and then no more
    ]


def test_the_readings_are_not_changed() -> None:
    read = readings([(7, [1, 2, 3])])
    kept(read, ignored([(7, [1])], []))
    assert read.present.all()


NUMBERS = st.sampled_from([-3, 0, 1, 2, 3, 4, 5, 99, 100, 101])
MARKS = st.lists(st.sampled_from([1, 2, 3, 4, 5, 99]), min_size=1, max_size=6)
CARDS = st.lists(
    st.tuples(st.integers(1, 3), st.lists(NUMBERS, min_size=1, max_size=6)), max_size=5
)


@settings(max_examples=300)
@given(st.lists(MARKS, min_size=1, max_size=4), CARDS, st.lists(NUMBERS, max_size=4))
def test_against_the_listing(
    frames: list[list[int]], cards: list[Card], everywhere: list[int]
) -> None:
    """Frames 1 to 4 of any landmarks, against cards A 129 to A 161 as they stand."""
    numbered = list(enumerate(frames, 1))
    asked = ignored(cards, everywhere)
    read = readings(numbered)
    dropped, used = kept(read, asked)
    ifm, jout = asked.frame.tolist(), asked.landmark.tolist()
    for k, (number, marks) in enumerate(numbered):
        assert dropped[k] == drop(number, ifm, jout)
        wanted = taken(number, marks, ifm, jout, everywhere)
        got = used[read.layout.span(k)].tolist()
        assert got == ([False] * len(marks) if dropped[k] else wanted)
