"""A history in parts: what is made when, how often, and under which words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.kit.estimates import ABOUT, estimate
from vopd.attitude.findings import summary_of
from vopd.attitude.history import History, history
from vopd.attitude.long_history import HistoryParts, one_part
from vopd.attitude.sigmas import Sigmas

LOST = np.full((2, 3), np.nan)


@cache
def some(known: tuple[bool, bool]) -> History:
    """Two frames, of which some have no attitude, and the first has not converged."""
    angles = np.where(np.array(known)[:, None], [140.0, -60.0, 20.0], np.nan)
    e = estimate(np.tile([140.0, -60.0, 20.0], (2, 1)), converged=np.array([False, True]))
    one = history(e, sigmas=Sigmas(reading=1.0))
    return replace(one, estimate=replace(one.estimate, camera_deg=angles, vehicle_deg=angles))


NEITHER, ONE, BOTH = (False, False), (False, True), (True, True)


class Job:
    """A history in parts that counts what is made."""

    def __init__(self, *known: tuple[bool, bool]) -> None:
        self.made: list[str] = []
        self.known = known
        self.parts = HistoryParts(some(known[0]), 2 * len(known), self.make, self.whole)

    def make(self) -> Iterator[History]:
        for k, known in enumerate(self.known):
            self.made.append(f"part {k}")
            yield some(known)

    def whole(self) -> History:
        self.made.append("whole")
        return some(self.known[-1])


@pytest.mark.parametrize(
    ("known", "has", "made"),
    [
        ([NEITHER, NEITHER], False, 2), ([NEITHER, ONE, BOTH], True, 2), ([BOTH, BOTH], True, 1),
        ([ONE], True, 1), ([NEITHER, NEITHER, ONE], True, 3),
    ],
)  # fmt: skip
def test_parts_are_made_up_to_the_first_attitude(
    known: list[tuple[bool, bool]], has: bool, made: int
) -> None:
    job = Job(*known)
    assert job.parts.has_attitude() is has
    assert job.made == [f"part {k}" for k in range(made)]
    assert job.parts.frames == 2 * len(known)


def test_parts_are_made_anew_and_the_whole_once() -> None:
    job = Job(NEITHER, ONE)
    assert [*job.parts] == [some(NEITHER), some(ONE)] and job.parts.counted
    assert job.parts.summary is job.parts.summary
    assert job.made == ["part 0", "part 1"]  # the summary is of the same pass
    assert len([*job.parts]) == 2 and job.made == ["part 0", "part 1"] * 2
    assert job.parts.whole is job.parts.whole is some(ONE)
    assert job.made[4:] == ["whole"]
    assert [*job.parts] == [some(ONE)] and job.made[5:] == []  # it is there already


def test_a_pass_that_is_broken_off_is_no_summary() -> None:
    job = Job(NEITHER, ONE)
    next(iter(job.parts))
    assert not job.parts.counted
    assert job.parts.summary == summary_of([some(NEITHER), some(ONE)]) and job.parts.counted
    assert Job(NEITHER).parts.counted is False
    later = Job(ONE)
    assert later.parts.whole and later.parts.counted


def test_a_second_pass_counts_no_frame_twice() -> None:
    job = Job(NEITHER, ONE)
    flagged = int(some(NEITHER).flags.any().sum() + some(ONE).flags.any().sum())
    for _ in range(3):
        assert len([*job.parts]) == 2
        assert (job.parts.summary.unconverged, job.parts.summary.flagged) == (2, flagged)


def test_other_words_reach_head_parts_and_whole() -> None:
    about = ABOUT._replace(source="other.toml", job=5)
    job = Job(NEITHER, ONE)
    renamed = job.parts.with_about(about)
    assert renamed.about == renamed.head.about == about and renamed.frames == 4
    assert [one.about for one in renamed] == [about] * 2
    assert renamed.whole.about == about
    assert job.parts.about == job.parts.head.about == job.parts.whole.about == ABOUT


def test_who_watches_is_told_of_every_part_before_it_is_used() -> None:
    job = Job(NEITHER, ONE, BOTH)
    seen: list[int] = []
    watched = job.parts.watched(seen.append)
    assert watched.frames == 6 and watched.about == ABOUT and watched.head is job.parts.head
    for k, _ in enumerate(watched, 1):
        assert seen == [2] * k
    assert watched.counted and job.parts.counted
    assert watched.whole is job.parts.whole and job.made.count("whole") == 1


def test_one_part_is_made_already() -> None:
    one = one_part(some(BOTH))
    assert one.counted and one.frames == 2 and one.head is one.whole is some(BOTH)
    assert [*one] == [some(BOTH)] and one.has_attitude()


def test_what_a_summary_counts() -> None:
    """Frames, not flags; labels of frames that misfit with what explains them, part by part."""
    base = some(BOTH)
    numbered = replace(base.estimate, frame=np.array([41, 52]), frame_names=())

    def part(lost: list[int], misfit: list[int], text: list[str]) -> History:
        raised = {name: np.zeros(2, bool) for name in base.flags.raised}
        for name, frames in (("not_converged", lost), ("misfit", misfit), ("jump", misfit)):
            raised[name] = np.isin([0, 1], frames)
        detail = base.flags.detail | {"misfit": text}
        return replace(
            base, estimate=numbered, flags=replace(base.flags, raised=raised, detail=detail)
        )

    found = summary_of([part([0], [0, 1], ["a", "b"]), part([0, 1], [1], ["", "c"])])
    assert (found.unconverged, found.flagged) == (3, 4)
    assert found.misfits == [("41", "a"), ("52", "b"), ("52", "c")]
    empty = summary_of([])
    assert (empty.unconverged, empty.flagged, empty.misfits) == (0, 0, [])
    assert summary_of([part([], [], ["", ""])]) == empty
