"""Decks with other numbers of landmarks and frames, or jobs in another order: the same pages."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest

from tests.kit.command import DECKS, vopd
from tests.kit.jobs import reread
from vopd.arrays import Ints
from vopd.cards.write import write_deck
from vopd.job import Job
from vopd.pipeline import read_deck

MORE, LATER = 24, 3000
"""What is added to the numbers of landmarks, and of frames."""
NO_LANDMARKS = -1, 0, 100  # in groups 11 and 12
WHOLE = re.compile(r"(?<![\d.])\d{2,4}(?![\d.])")
NAMES = [f"appendix_h/{name}" for name in ("case1", "case4", "cases_1_2_3")]
NAMES += [f"regression/{name}" for name in ("ignored", "requests", "restart", "flight")]


def renumbered(job: Job) -> Job:
    """Add to all numbers of landmarks and frames."""

    def more(landmark: Ints) -> Ints:
        return np.where(np.isin(landmark, NO_LANDMARKS), landmark, landmark + MORE)

    own, ignored = job.readings, job.ignored
    return replace(
        job,
        landmarks=replace(job.landmarks, number=job.landmarks.number + MORE),
        clock=replace(job.clock, frame=job.clock.frame + LATER),
        ignored=replace(
            ignored, frame=ignored.frame + LATER, landmark=more(ignored.landmark),
            everywhere=more(ignored.everywhere),
        ),
        readings=reread(own, frame=own.frame + LATER, landmark=own.landmark + MORE),
    )  # fmt: skip


def words(text: str, before: Mapping[str, str]) -> list[str]:
    """List the words of a text, in which new numbers are those of before."""
    back = WHOLE.sub(lambda found: before.get(found[0], found[0]), text)
    return back.replace("FRAME", "FRAME ").split()


@pytest.mark.parametrize("name", NAMES)
def test_numbers_of_landmarks_and_frames_are_names(name: str) -> None:
    """The listing, the table of attitudes, and what is said of the deck."""
    jobs = read_deck(DECKS / f"{name}.dat").jobs
    marks = {int(number) for job in jobs for number in job.landmarks.number}
    frames = {int(number) for job in jobs for number in (*job.readings.frame, *job.ignored.frame)}
    before = {str(number + MORE): str(number) for number in marks}
    before |= {str(number + LATER): str(number) for number in frames}
    texts = [write_deck(some) for some in (jobs, [renumbered(job) for job in jobs])]
    for command in ("run - -q", "attitude - -q", "check -"):
        first, second = (vopd(*command.split(), stdin=text) for text in texts)
        said, again = first.stdout, second.stdout
        if command == "check -":  # without the cards that it shows
            said, again = (re.sub("(?m)^ .*$", "", text) for text in (said, again))
        assert second.status == first.status
        assert words(again, before) == words(said, {})


END = "\n\n END OF CASE\n"


def listing(jobs: Sequence[Job]) -> str:
    """Run jobs, each of which is read from group 1 on."""
    stacked = [replace(job, return_group=1) for job in jobs[:-1]]
    return vopd("run", "-", "-q", stdin=write_deck([*stacked, jobs[-1]])).stdout


def test_jobs_in_another_order_have_the_same_pages() -> None:
    names = ("appendix_h/case1", "regression/ignored", "appendix_h/case3")
    jobs = [read_deck(DECKS / f"{name}.dat").jobs[0] for name in names]
    pages = [listing([job]).removesuffix(END) for job in jobs]
    for order in permutations(range(3)):
        expected = "".join(pages[k] for k in order) + END
        assert listing([jobs[k] for k in order]) == expected
