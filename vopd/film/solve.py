"""Solve the jobs of decks, several at once, and warn of what is doubtful in the results."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.errata import NO_FIXES, Fixes
from vopd.film.findings import Condition, frame_finding, solve_findings
from vopd.findings import DeckError, Finding, VopdError
from vopd.job import Job
from vopd.program.positions import UndefinedLandmark
from vopd.program.vopd import run_jobs
from vopd.results import Results
from vopd.solved_job import SolvedJob

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
        limits_1974: whether a deck that exceeds the original's array sizes is an error
    """

    fixes: Fixes = NO_FIXES
    initial: Initial = "deck"
    compare_initial: bool = False
    limits_1974: bool = False


class ReadJob(NamedTuple):
    """A job that has been read and is to be solved.

    `findings` are the warnings about its cards, `start_deg` (F, 3) angles to start from,
    if they are not to be those of the deck.
    """

    deck: str
    number: int
    job: Job
    findings: tuple[Finding, ...] = ()
    start_deg: Floats | None = None


def solve_film(jobs: Sequence[ReadJob], options: SolveOptions) -> list[SolvedJob | VopdError]:
    """Solve jobs together; an error in one job does not affect the others.

    Args:
        jobs: the jobs as they were read
        options: how to solve them

    Returns:
        For each job, in order, the solved job, or the error why it cannot be solved.
    """
    given, start_deg = [one.job for one in jobs], [one.start_deg for one in jobs]
    if options.initial == "deck":
        ended = run_jobs(given, options.fixes, start_deg)
        return _with_findings([_solved(*both) for both in zip(jobs, ended, strict=True)])
    from vopd.film.closed_form_start import closed_form_start  # a twentieth of a start-up

    ended = run_jobs(given, options.fixes, start_deg, closed_form_start)
    from_deck = run_jobs(given, options.fixes, start_deg) if options.compare_initial else ended
    solved = [_solved(*both) for both in zip(jobs, ended, strict=True)]
    return _with_findings([_compared(*both) for both in zip(solved, from_deck, strict=True)])


def _compared(
    solved: SolvedJob | VopdError, from_deck: Results | VopdError
) -> SolvedJob | VopdError:
    """A job with a warning of frames whose attitude is another from the deck's first estimate."""
    if not (isinstance(from_deck, Results) and isinstance(solved, SolvedJob)):
        return solved
    results = solved.results
    apart = np.abs((from_deck.camera_deg - results.camera_deg + 180.0) % 360.0 - 180.0)
    elsewhere = from_deck.solved & results.solved & ~(apart.max(axis=1) < ELSEWHERE_DEG)
    if not elsewhere.any():
        return solved
    condition = Condition(elsewhere, 8, "the deck's first estimate leads to another attitude")
    return replace(solved, findings=(*solved.findings, frame_finding(solved, condition)))


def _solved(one: ReadJob, results: Results | VopdError) -> SolvedJob | VopdError:
    """A job that was solved; an undefined landmark is an error that names its card."""
    if isinstance(results, UndefinedLandmark):
        text = str(results)
        finding = one.job.readings.first_card.get(results.landmark, Finding(text, one.deck))
        return DeckError(replace(finding, message=text))
    if isinstance(results, VopdError):
        return results
    return SolvedJob(one.deck, one.number, results, one.findings)


def _with_findings(solved: Sequence[SolvedJob | VopdError]) -> list[SolvedJob | VopdError]:
    """Jobs with the warnings about their readings and results."""
    found = iter(solve_findings([one for one in solved if isinstance(one, SolvedJob)]))
    return [
        replace(one, findings=(*one.findings, *next(found))) if isinstance(one, SolvedJob) else one
        for one in solved
    ]


def stop_error(solved: SolvedJob) -> DeckError | None:
    """The error of a job whose run was stopped by a table out of order; it ends the deck.

    Args:
        solved: the job

    Returns:
        The error, or None if the run was not stopped.
    """
    stop = solved.results.stop
    if stop is None:
        return None
    message = f"{stop.table} out of order at position {stop.position}: FTLUP stops the run"
    return DeckError(Finding(message, solved.deck, job=solved.number, group=stop.group))
