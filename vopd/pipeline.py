"""Read and solve jobs, decks and flights: the functions that the library and all commands use."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Floats
from vopd.cards.decks_together import DeckFile, groups_of_decks, read_together
from vopd.cards.reader import open_deck, read_jobs
from vopd.errata import NO_FIXES, Fixes
from vopd.film.solve import Initial, ReadJob, SolveOptions, solve_film, stop_error
from vopd.findings import Finding, VopdError, raising
from vopd.job import Deck, Job
from vopd.solved import Run
from vopd.solved_job import DeckEnd, SolvedJob

if TYPE_CHECKING:
    from vopd.flight.flight_result import FlightResult

FILM_FRAMES = 4000  # jobs are gathered until they have this many frames
LANDMARKS_AS_A_FRAME = 16  # a job holds the landmarks of all earlier jobs too
NAMES_ARE_PATHS: Mapping[str, str] = {}


def run(
    jobs: Job | Sequence[Job],
    fixes: Fixes = NO_FIXES,
    *,
    initial: Initial = "deck",
    compare_initial: bool = False,
    start_deg: Floats | None = None,
) -> Run:
    """Solve a job, or all jobs of a deck, for all their frames at once.

    Nothing is printed: what is doubtful is in the `findings` of the run. A table
    that is out of order ends the run, as in 1974: the results go that far and say
    so in `stop`.

    Args:
        jobs: one job, or several, for instance the deck that `read_deck` returns
        fixes: errata to correct, made by `vopd.errata.fixes`; none is the original
        initial: "deck" starts each frame from the deck's first estimate and the
            frame before, as in 1974; "closed-form" from two of its landmarks
        compare_initial: with the closed form, solve from the deck's first estimate
            too, and name in `findings` the frames that end in another attitude
        start_deg: camera yaw, pitch, roll to start each frame from, (F, 3) degrees,
            the frames of all jobs one after the other; in the place of `initial`

    Raises:
        VopdError: where a landmark that takes part is not defined, or `start_deg`
            does not have a row for every frame
    """
    several = [jobs] if isinstance(jobs, Job) else list(jobs)
    deck = jobs if isinstance(jobs, Deck) else Deck(tuple(several))
    options = SolveOptions(fixes, initial, compare_initial)
    solved: list[SolvedJob] = []
    for one in solve_jobs(_given(deck, start_deg), options):
        if isinstance(one, SolvedJob):
            solved.append(one)
        elif one.error is not None and not (solved and solved[-1].results.stop is not None):
            raise one.error
    if solved and deck.findings:
        solved[0] = replace(solved[0], findings=deck.findings + solved[0].findings)
    return Run(solved)


def _given(deck: Deck, start_deg: Floats | None) -> Iterator[ReadJob | DeckEnd]:
    frames = [len(job.readings.frame) for job in deck]
    starts: Sequence[Floats | None] = [None] * len(frames)
    if start_deg is not None:
        if np.shape(start_deg) != (sum(frames), 3):
            raise VopdError(
                f"start_deg has the shape {np.shape(start_deg)}, not {(sum(frames), 3)}"
            )
        starts = np.split(np.asarray(start_deg, dtype=np.float64), np.cumsum(frames)[:-1])
    for number, (job, start) in enumerate(zip(deck, starts, strict=True), 1):
        yield ReadJob(deck.name, number, job, (), start)
    yield DeckEnd(deck.name)


def solve_decks(
    names: Iterable[str],
    options: SolveOptions = SolveOptions(),  # noqa: B008  it is frozen
    locations: Mapping[str, str] = NAMES_ARE_PATHS,
) -> Iterator[SolvedJob | DeckEnd]:
    """Read and solve decks, job by job; after the last job of each deck comes a `DeckEnd`.

    If a deck cannot be read on, or its run fails, the jobs before the error are given,
    and the `DeckEnd` holds the error; the other decks are solved.

    Args:
        names: files of 80-column cards; - is standard input
        options: how to solve them
        locations: where files are that are not under their names
    """
    yield from solve_jobs(read_decks(names, options.limits_1974, locations), options)


def solve_sources(
    names: Iterable[str],
    options: SolveOptions = SolveOptions(),  # noqa: B008  it is frozen
    locations: Mapping[str, str] = NAMES_ARE_PATHS,
) -> Iterator[SolvedJob | FlightResult | DeckEnd]:
    """Read and solve decks and flights; after each source comes a `DeckEnd`.

    Args:
        names: files of 80-column cards, or flight projects, whose names end in `.toml`;
            - is a deck from standard input
        options: how to solve decks
        locations: where files are that are not under their names
    """
    for flights, some in groupby(names, is_flight):
        if not flights:
            yield from solve_decks(some, options, locations)
            continue
        from vopd.flight.solve_project import solve_flight  # decks need not wait for it

        for name in some:
            try:
                yield solve_flight(name, locations.get(name))
                yield DeckEnd(name)
            except VopdError as error:
                yield DeckEnd(name, error)


def check_project(name: str) -> list[Finding]:
    """Find all errors and warnings of a flight project.

    Args:
        name: the path of the project file
    """
    from vopd.flight.check_flight import check_flight  # takes scipy

    return check_flight(name)


def is_flight(name: str) -> bool:
    """Whether a file is a flight project, going by its suffix `.toml`.

    Args:
        name: the name of the file
    """
    return name.lower().endswith(".toml")


def read_decks(
    names: Iterable[str],
    limits_1974: bool = False,
    locations: Mapping[str, str] = NAMES_ARE_PATHS,
) -> Iterator[ReadJob | DeckEnd]:
    """Read decks, job by job; after the last job of each deck comes a `DeckEnd`.

    Args:
        names: files of 80-column cards; - is standard input
        limits_1974: whether a deck that exceeds the original's array sizes is an error
        locations: where files are that are not under their names
    """
    files = (DeckFile(name, locations.get(name, name)) for name in names)
    for some in groups_of_decks(files):
        if len(some) == 1:
            yield from _read_deck(some[0], limits_1974)
            continue
        for file, deck in zip(some, read_together(some, limits_1974), strict=True):
            for number, (job, findings) in enumerate(deck.jobs, 1):
                yield ReadJob(file.name, number, job, findings)
            yield DeckEnd(file.name, deck.error, tuple(deck.findings))


def _read_deck(deck: DeckFile, limits_1974: bool) -> Iterator[ReadJob | DeckEnd]:
    """Read one deck, each job when it is asked for."""
    warnings: list[Finding] = []
    error: VopdError | None = None
    try:
        with open_deck(deck.path) as file:
            report = raising(warnings.append)
            jobs = read_jobs(file, deck.name, report, limits_1974=limits_1974)
            for number, job in enumerate(jobs, 1):
                yield ReadJob(deck.name, number, job, tuple(warnings))
                warnings.clear()
    except VopdError as found:
        error = found
    yield DeckEnd(deck.name, error, tuple(warnings))


def solve_jobs(
    items: Iterable[ReadJob | DeckEnd], options: SolveOptions
) -> Iterator[SolvedJob | DeckEnd]:
    """Solve jobs, several at once; after an error, the rest of that deck is left out.

    Args:
        items: jobs as `read_decks` gives them, with a `DeckEnd` behind the last of each deck
        options: how to solve them
    """
    failed = False  # the deck that is being passed on
    for film in _films(items):
        solved = iter(solve_film([item for item in film if isinstance(item, ReadJob)], options))
        for item in film:
            if isinstance(item, DeckEnd):
                if not failed:
                    yield item
                failed = False
                continue
            one = next(solved)
            if failed:
                continue
            if isinstance(one, SolvedJob):
                yield one
            error = one if isinstance(one, VopdError) else stop_error(one)
            if error is not None:
                yield DeckEnd(item.deck, error)
                failed = True


def _films(items: Iterable[ReadJob | DeckEnd]) -> Iterator[list[ReadJob | DeckEnd]]:
    film: list[ReadJob | DeckEnd] = []
    frames = 0
    for item in items:
        film.append(item)
        if isinstance(item, ReadJob):
            landmarks = len(item.job.landmarks.number)
            frames += len(item.job.readings.frame) + landmarks // LANDMARKS_AS_A_FRAME
        if frames >= FILM_FRAMES:
            yield film
            film, frames = [], 0
    yield film
