"""Jobs one after the other: errors end their deck, findings stay with their job."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.kit.command import CASE_1, DECKS
from tests.kit.jobs import reread
from vopd import pipeline
from vopd.errata import Fix, fixes
from vopd.findings import Finding, InputError, VopdError
from vopd.job import Deck, Job
from vopd.pipeline import ReadJob, SolveOptions, read_decks, solve_jobs
from vopd.results import DeckEnd, SolvedJob

ELSEWHERE = {"a": str(CASE_1), "b": str(CASE_1)}


def items(*outline: tuple[str, Any]) -> Iterable[ReadJob | DeckEnd]:
    """Jobs that solve to a result, an error or a stopped run, and ends of decks."""
    for number, (deck, what) in enumerate(outline):
        if what == "end":
            yield DeckEnd(deck, None, (Finding(f"late {number}"),))
        elif isinstance(what, VopdError) and deck.startswith("lost"):
            yield DeckEnd(deck, what)
        else:
            yield ReadJob(deck, number, what, ())


def test_after_an_error_the_rest_of_that_deck_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """One error a deck, at its end; the next decks are passed on whole."""
    (job,) = vopd.read_deck(CASE_1)
    error, stopped = VopdError("undefined"), VopdError("out of order")

    def solve_film(jobs: list[ReadJob], _: SolveOptions) -> list[Any]:
        results: Any = SimpleNamespace(stop=None)
        return [
            error if one.number in (1, 2) else SolvedJob(one.deck, one.number, results)
            for one in jobs
        ]

    monkeypatch.setattr(pipeline, "solve_film", solve_film)
    monkeypatch.setattr(
        pipeline, "stop_error", lambda one: stopped if one.number in (7, 8) else None
    )
    outline = [
        ("a", job), ("a", job), ("a", job), ("a", "end"), ("b", job), ("b", "end"),
        ("c", job), ("c", job), ("c", job), ("c", "end"), ("lost", error), ("d", job), ("d", "end"),
    ]  # fmt: skip
    found = [*solve_jobs(items(*outline), SolveOptions())]
    told = [
        (one.deck, one.number)
        if isinstance(one, SolvedJob)
        else (one.deck, str(one.error), len(one.findings))
        for one in found
    ]
    assert told == [
        ("a", 0), ("a", "undefined", 0), ("b", 4), ("b", "None", 1), ("c", 6), ("c", 7),
        ("c", "out of order", 0), ("lost", "undefined", 0), ("d", 11), ("d", "None", 1),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("frames", "films"),
    [([3999, 1], [[3999, 1]]), ([4000, 1], [[4000], [1]]), ([2500, 1499, 1, 5], [[2500, 1499, 1],
                                                                            [5]]),
     ([5000, 3999], [[5000], [3999]])],
)  # fmt: skip
def test_jobs_are_gathered_until_they_have_4000_frames(
    frames: list[int], films: list[list[int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Sixteen landmarks of a job's table count as a frame."""
    counts: list[list[int]] = []

    def solve_film(jobs: list[ReadJob], _: SolveOptions) -> list[SolvedJob]:
        counts.append([len(one.job.readings.frame) for one in jobs])
        results: Any = SimpleNamespace(stop=None)
        return [SolvedJob(one.deck, one.number, results) for one in jobs]

    monkeypatch.setattr(pipeline, "solve_film", solve_film)
    for landmarks in (15, 16):
        counts.clear()
        some: list[Any] = [
            SimpleNamespace(
                readings=SimpleNamespace(frame=np.zeros(count - landmarks // 16)),
                landmarks=SimpleNamespace(number=np.zeros(landmarks)),
            )
            for count in frames
        ]
        read = [ReadJob("a", k, one, ()) for k, one in enumerate(some)]
        assert len([*solve_jobs(read, SolveOptions())]) == len(frames)
        least = landmarks // 16
        told = [[one + least for one in film] for film in counts if film]
        assert told == films


def test_warnings_of_the_deck_come_first_and_errors_are_raised() -> None:
    """A landmark that is not defined; a table out of order does not raise, nor what follows it."""
    (job,) = vopd.read_deck(CASE_1)
    warning = Finding("odd", severity="warning")
    assert vopd.run(Deck((job, job), "a", (warning,))).findings == (warning,)
    assert vopd.run(Deck((job,), "a")).findings == ()
    missing = reread(job.readings, landmark=job.readings.landmark + 40)
    with pytest.raises(InputError, match="landmark"):
        vopd.run([job, replace(job, readings=missing)])
    stops = vopd.read_deck(DECKS / "regression" / "wind_out_of_order.dat")
    run = vopd.run([*stops, replace(job, readings=missing)])
    assert len(run) == len(stops) and run[-1].stop is not None
    assert not vopd.run([job]).jobs[0].results.fixes
    assert Fix.RESTART in vopd.run([job], fixes("restart"))[0].fixes


def test_the_findings_of_each_job_and_deck_are_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of each job, and behind the last job those of the deck's end, with its error."""
    own, late = Finding("own", severity="warning"), Finding("late", severity="warning")
    error = VopdError("broken")
    (job,) = vopd.read_deck(CASE_1)

    def jobs(_: object, name: str, report: Any, **__: object) -> Iterator[Job]:
        if name == "a":
            yield job
        report(own)
        yield job
        if name == "a":
            report(late)
            raise error

    monkeypatch.setattr("vopd.cards.read.read_jobs", jobs)
    found = [*read_decks(["a", "b"], locations=dict.fromkeys("ab", str(CASE_1)))]
    assert [one.findings for one in found] == [(), (own,), (late,), (own,), ()]
    assert [one.deck for one in found] == ["a", "a", "a", "b", "b"]
    assert [one.error for one in found if isinstance(one, DeckEnd)] == [error, None]
    assert [one.number for one in found if isinstance(one, ReadJob)] == [1, 2, 1]
