"""Solve the jobs of decks, several as one film, and say what is doubtful in the results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.errata import NO_FIXES, Fixes
from vopd.film.findings import Condition, frame_finding, solve_findings
from vopd.findings import DeckError, Finding, VopdError
from vopd.job import Job
from vopd.program.positions import UndefinedLandmark
from vopd.program.vopd import run_jobs
from vopd.results import Results
from vopd.solved import SolvedJob

ELSEWHERE_DEG = 0.001  # the last digit printed

Initial = Literal["deck", "closed-form"]


@dataclass(frozen=True)
class SolveOptions:
    """How to solve a deck.

    Args:
        fixes: errata to correct; none is the original
        initial: start each frame from the deck's first estimate and the frame
            before, as in 1974, or from the closed form of two of its landmarks
        compare_initial: with the closed form, solve from the deck's first estimate
            too, and say which frames end in another attitude
        limits_1974: hold the deck to the original's array sizes
    """

    fixes: Fixes = NO_FIXES
    initial: Initial = "deck"
    compare_initial: bool = False
    limits_1974: bool = False


class ReadJob(NamedTuple):
    """A job that has been read and is to be solved; the warnings are those of its cards."""

    deck: str
    number: int
    job: Job
    findings: tuple[Finding, ...] = ()
    start_deg: Floats | None = None


def solve_film(jobs: Sequence[ReadJob], options: SolveOptions) -> list[SolvedJob | VopdError]:
    """Solve jobs together; a job that cannot be solved is its error, and the others are solved."""
    inputs = [one.job for one in jobs]
    starts = [one.start_deg for one in jobs]
    ended = run_jobs(inputs, options.fixes, starts)
    findings: list[list[Finding]] = [[] for _ in jobs]
    if options.initial == "closed-form":
        ended = _closed_form(jobs, ended, options, findings)
    return [_solved(*one) for one in zip(jobs, ended, findings, strict=True)]


def _closed_form(
    jobs: Sequence[ReadJob],
    from_deck: Sequence[Results | VopdError],
    options: SolveOptions,
    findings: Sequence[list[Finding]],
) -> list[Results | VopdError]:
    """Solve again from the closed form what was solved from the deck's first estimate."""
    from vopd.film.closed_form_start import closed_form_start  # a twentieth of a start-up

    ended = list(from_deck)
    again = [
        (index, results)
        for index, (one, results) in enumerate(zip(jobs, from_deck, strict=True))
        if one.start_deg is None and isinstance(results, Results) and results.stop is None
    ]
    starts = [closed_form_start(before) for _, before in again]
    solved = run_jobs([before.job for _, before in again], options.fixes, starts)
    for (index, before), results in zip(again, solved, strict=True):
        ended[index] = results
        if not (options.compare_initial and isinstance(results, Results)):
            continue
        elsewhere = _elsewhere(before, results)
        if elsewhere.any():
            message = "the deck's first estimate leads to another attitude"
            one, condition = jobs[index], Condition(elsewhere, 8, message)
            findings[index].append(frame_finding(results, condition, one.deck, one.number))
    return ended


def _solved(
    one: ReadJob, results: Results | VopdError, findings: list[Finding]
) -> SolvedJob | VopdError:
    """A job with its findings; an undefined landmark is an error that names its card."""
    if isinstance(results, UndefinedLandmark):
        text = str(results)
        finding = one.job.readings.first_card.get(results.landmark, Finding(text, one.deck))
        return DeckError(replace(finding, message=text))
    if isinstance(results, VopdError):
        return results
    findings = findings + solve_findings(results, one.deck, one.number)
    return SolvedJob(one.deck, one.number, results, (*one.findings, *findings))


def _elsewhere(one: Results, other: Results) -> Bools:
    """Frames that end in another attitude, (F,)."""
    apart = np.abs((one.camera_deg - other.camera_deg + 180.0) % 360.0 - 180.0).max(axis=1)
    return np.asarray(one.solved & other.solved & ~(apart < ELSEWHERE_DEG))


def stop_error(solved: SolvedJob) -> DeckError | None:
    """The error that ends a deck where a table out of order stopped the run in this job."""
    stop = solved.results.stop
    if stop is None:
        return None
    message = f"{stop.table} out of order at position {stop.position}: FTLUP stops the run"
    return DeckError(Finding(message, solved.deck, job=solved.number, group=stop.group))
