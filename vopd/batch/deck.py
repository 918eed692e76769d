"""One deck, from its cards to the printed listing and tape 10."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import BinaryIO

import numpy as np

from vopd.arrays import Bools, Ints
from vopd.batch.halves import run_and_print
from vopd.cards.reader import read_jobs
from vopd.errata import NO_FIXES, Fixes
from vopd.findings import BASIC_DATA, DeckError, Finding, Report
from vopd.job import Job
from vopd.listing.pages import end_of_case, end_of_job, frame_pages
from vopd.listing.tape10 import tape10
from vopd.program.positions import UndefinedLandmark
from vopd.program.vopd import run
from vopd.results import Outcome, Results

ELSEWHERE_DEG = 0.001  # the last digit printed


@dataclass(frozen=True)
class Solved:
    """One job of a deck, solved: its number in the deck, from 1, and its results."""

    deck: str
    number: int
    results: Results
    pages: Iterable[bytes] = ()  # those of its frames, where they are asked for


def run_only(job: Job, fixes: Fixes) -> tuple[Results, Iterable[bytes]]:
    """A job's results, and no pages."""
    return run(job, fixes), ()


def solve_deck(
    file: BinaryIO,
    name: str,
    report: Report,
    *,
    fixes: Fixes = NO_FIXES,
    closed_form: bool = False,
    limits_1974: bool = False,
    solve: Callable[[Job, Fixes], tuple[Results, Iterable[bytes]]] = run_only,
) -> Iterator[Solved]:
    """The jobs of a deck, each solved as soon as it is read; `report` is given the warnings.

    `fixes` are slips to correct; with `closed_form` every frame starts from the
    two-landmark solution and not from group 8. `solve` is what runs a job.

    Raises `DeckError` where the deck cannot be read on, after the jobs before.
    """
    jobs = read_jobs(file, name, report, limits_1974=limits_1974)
    for number, job in enumerate(jobs, 1):
        solved = Solved(name, number, *_run(job, name, fixes, solve))
        if closed_form:
            solved, elsewhere = from_closed_form(solved)
            if elsewhere.any():
                message = "the deck's first estimate leads to another attitude"
                report(_remark(solved, elsewhere, 8, message).warned())
        for warning in warnings(solved):
            report(warning)
        yield solved


def run_deck(
    file: BinaryIO,
    name: str,
    write: Callable[[bytes], object],
    report: Report,
    *,
    tape: Callable[[bytes], object] = lambda _: None,
    fixes: Fixes = NO_FIXES,
    closed_form: bool = False,
    limits_1974: bool = False,
) -> list[Finding]:
    """Print a deck's listing piece by piece, and its tape; returns what did not converge.

    Raises `DeckError` after all pages that the original would have printed.
    """
    unconverged: list[Finding] = []
    for solved in solve_deck(
        file, name, report, fixes=fixes, closed_form=closed_form, limits_1974=limits_1974,
        solve=run_and_print,
    ):  # fmt: skip
        for page in solved.pages:
            write(page)
        write(end_of_job(solved.results))
        tape(tape10(solved.results))
        unconverged += not_converged(solved)
        raise_stop(solved)
    write(end_of_case())
    return unconverged


def raise_stop(solved: Solved) -> None:
    """Raise `DeckError` where a table out of order ended the run in this job."""
    stop = solved.results.stop
    if stop is not None:
        message = f"{stop.table} out of order at position {stop.position}: FTLUP stops the run"
        raise DeckError(Finding(message, solved.deck, job=solved.number, group=stop.group))


def _run(
    job: Job,
    name: str,
    fixes: Fixes,
    solve: Callable[[Job, Fixes], tuple[Results, Iterable[bytes]]],
) -> tuple[Results, Iterable[bytes]]:
    try:
        return solve(job, fixes)
    except UndefinedLandmark as error:
        finding = job.readings.first_card.get(error.landmark, Finding(str(error), name))
        raise DeckError(replace(finding, message=str(error))) from error


def from_closed_form(solved: Solved) -> tuple[Solved, Bools]:
    """The same job started from the closed form, and which frames end elsewhere by it."""
    from vopd.stellar.closed_form_start import closed_form_start

    before = solved.results
    if before.stop is not None:
        return solved, np.zeros(len(before.frame), bool)
    start = closed_form_start(before)
    after = run(before.job, before.fixes, start)
    apart = np.abs((after.camera_deg - before.camera_deg + 180.0) % 360.0 - 180.0).max(axis=1)
    elsewhere = after.solved & before.solved & ~(apart < ELSEWHERE_DEG)
    return replace(solved, results=after, pages=frame_pages(after)), elsewhere


def not_converged(solved: Solved) -> list[Finding]:
    """The frames that the 22nd pass still corrected by more than 1e-6 rad, or that are NaN."""
    bad = ~solved.results.converged
    message = "not converged: the 22nd correction exceeds 1e-6 rad or is not a number"
    return [_remark(solved, bad, None, message)] if bad.any() else []


def warnings(solved: Solved) -> Iterator[Finding]:
    """What the original computed without a word and a careful person would question."""
    r = solved.results
    flying = (r.outcome != Outcome.DROPPED) & (r.outcome != Outcome.STOPPED)
    few = flying & (r.used.sum(axis=1) < 2)
    kinds = [
        (r.outside_clock, 6, "outside the time table: extrapolated"),
        (r.outside_trajectory, 7, "outside the trajectory table: extrapolated"),
        (r.outside_wind & r.solved, 4, "altitude outside the wind table: extrapolated"),
        (few, BASIC_DATA, "fewer than two landmarks: the angles are rounding noise"),
        (r.singular & ~few, BASIC_DATA, "the normal matrix is singular: the angles mean nothing"),
        (
            _behind(r).any(axis=1),
            8,
            "landmarks behind the camera: try --initial closed-form",
        ),
        (_beyond_lens(r).any(axis=1), 1, "landmarks beyond the lens table: extrapolated"),
        (r.at_centre.any(axis=1), BASIC_DATA, "a landmark at the frame's centre: not corrected"),
    ]
    for frames, group, message in kinds:
        if (frames & flying).any():
            yield _remark(solved, frames & flying, group, message).warned()


def _behind(r: Results) -> Bools:
    """Landmarks that the camera, as solved, looks away from (F, L)."""
    yaw, pitch, _ = np.radians(r.camera_deg).T
    axis = np.stack([np.sin(yaw) * np.cos(pitch), np.cos(yaw) * np.cos(pitch), np.sin(pitch)], 1)
    along = (r.direction * axis[:, None]).sum(axis=2)
    return np.asarray(r.used & r.solved[:, None] & (along < 0))


def _beyond_lens(r: Results) -> Bools:
    table = r.job.camera.lens_radius_mm
    return np.asarray(r.used & ((r.radius_mm > table.max()) | (r.radius_mm < table.min())))


def _remark(solved: Solved, frames: Bools, group: int | None, message: str) -> Finding:
    which = named_frames(solved.results.frame[frames])
    return Finding(f"{which}: {message}", solved.deck, job=solved.number, group=group)


def named_frames(numbers: Ints) -> str:
    """Frame numbers for a reader: `frame 7`, `frames 7, 9-12, 20`, runs drawn together."""
    if len(numbers) == 1:
        return f"frame {numbers[0]}"
    runs = np.split(numbers, np.flatnonzero(np.diff(numbers) != 1) + 1)
    named = [str(run[0]) if len(run) == 1 else f"{run[0]}-{run[-1]}" for run in runs]
    return "frames " + ", ".join(named)
