"""Read and solve jobs, decks and flights: the functions that the library and all commands use."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from os import PathLike
from typing import TYPE_CHECKING, Literal, NamedTuple, TypeVar, get_args

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Bools, Floats
from vopd.errata import NO_FIXES, Fix, Fixes
from vopd.findings import (
    BASIC_DATA,
    Finding,
    InputError,
    VopdError,
    frames_text,
    numbers,
    raising,
    refuse_other_kind,
    refuse_other_word,
)
from vopd.geometry.rotations import LARGEST_DEG, ahead, camera_angles_deg, camera_axes
from vopd.job import Deck, Job, checked_fields, copied_readings_text
from vopd.results import Outcome, Results, SolvedJob, SourceEnd
from vopd.solved import Run

if TYPE_CHECKING:  # flights load neither the cards nor the program of 1974, decks no flight
    from vopd.attitude.sigmas import Sigmas
    from vopd.flight.result import FlightResult
    from vopd.program.orient import FilmSight, Sight

FILM_FRAMES = 4000  # jobs are gathered until they have this many frames
LANDMARKS_AS_A_FRAME = 16  # a job holds the landmarks of all earlier jobs too
NAMES_ARE_PATHS: Mapping[str, str] = {}

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

    def __post_init__(self) -> None:
        refuse_other_kind(self.fixes, Fixes, "vopd.run", "fixes that vopd.errata.fixes makes")
        refuse_other_word(self.initial, get_args(Initial), "initial")


class ReadJob(NamedTuple):
    """A job that has been read and is to be solved.

    `findings` are the warnings about its cards, `start_deg` (F, 3) angles to start from,
    if they are not to be those of the deck.
    """

    source: str
    number: int
    job: Job
    findings: tuple[Finding, ...] = ()
    start_deg: Floats | None = None


def run(
    jobs: str | PathLike[str] | Job | Sequence[Job],
    fixes: Fixes = NO_FIXES,
    *,
    initial: Initial = "deck",
    compare_initial: bool = False,
    start_deg: ArrayLike | None = None,
) -> Run:
    """Solve a job, or all jobs of a deck, for all their frames at once.

    Nothing is printed: warnings are in the `findings` of the run. A table
    that is out of order ends the run, as in 1974: the results end there, and `stop`
    names the table.

    Args:
        jobs: the path of a deck; or one job, or several, for instance the deck that `read_deck`
            returns
        fixes: errata to correct, made by `vopd.errata.fixes`; without them the run is faithful
        initial: "deck" starts each frame from the deck's first estimate and the
            frame before, as in 1974; "closed-form" from two of its landmarks
        compare_initial: with the closed form, solve from the deck's first estimate
            too, and name in `findings` the frames that end in another attitude
        start_deg: camera yaw, pitch, roll to start each frame from, (F, 3) degrees,
            the frames of all jobs one after the other; replaces `initial`

    Raises:
        VopdError: if the deck cannot be read or is a flight, a landmark that takes part is not
            defined, or `start_deg` does not have a row for every frame
    """
    if isinstance(jobs, str | PathLike):
        if is_flight(str(jobs)) or os.path.isfile(os.path.join(jobs, "flight.toml")):  # noqa: PTH113, PTH118
            raise VopdError(f"{jobs}: a flight project: vopd.solve_flight({str(jobs)!r}) solves it")
        jobs = read_deck(jobs)
    if isinstance(jobs, bytes) or (not isinstance(jobs, Sequence) and not isinstance(jobs, Job)):
        raise VopdError(
            f"{type(jobs).__name__} is no deck of jobs: vopd.run takes the path of a deck, or what "
            "vopd.read_deck returns; vopd.solve_flight solves a flight project"
        )
    several: list[Job] = [jobs] if isinstance(jobs, Job) else list(jobs)
    for job in several:
        refuse_other_kind(job, Job, "vopd.run", "the path of a deck, or jobs of vopd.read_deck")
    checked = tuple(map(checked_fields, several))
    deck = replace(jobs, jobs=checked) if isinstance(jobs, Deck) else Deck(checked)
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


def _given(deck: Deck, start_deg: ArrayLike | None) -> Iterator[ReadJob | SourceEnd]:
    frames = [len(job.readings.frame) for job in deck]
    starts: Sequence[Floats | None] = [None] * len(frames)
    if start_deg is not None:
        start = numbers(start_deg, "start_deg")
        if start.shape != (sum(frames), 3):
            raise VopdError(f"start_deg has the shape {start.shape}, not {(sum(frames), 3)}")
        starts = np.split(start, np.cumsum(frames)[:-1])
    for number, (job, own) in enumerate(zip(deck, starts, strict=True), 1):
        yield ReadJob(deck.name, number, job, (), own)
    yield SourceEnd(deck.name)


def solve_decks(
    names: Iterable[str],
    options: SolveOptions = SolveOptions(),
    locations: Mapping[str, str] = NAMES_ARE_PATHS,
) -> Iterator[SolvedJob | SourceEnd]:
    """Read and solve decks, job by job; after the last job of each deck comes a `SourceEnd`.

    If a deck cannot be read on, or its run fails, the jobs before the error are given,
    and the `SourceEnd` holds the error; the other decks are solved.

    Args:
        names: files of 80-column cards; - is standard input
        options: how to solve them
        locations: where files are that are not under their names
    """
    yield from solve_jobs(read_decks(names, options.limits_1974, locations), options)


def solve_sources(
    names: Iterable[str],
    options: SolveOptions = SolveOptions(),
    locations: Mapping[str, str] = NAMES_ARE_PATHS,
    sigmas: Sigmas | None = None,
) -> Iterator[SolvedJob | FlightResult | SourceEnd]:
    """Read and solve decks and flights; after each source comes a `SourceEnd`.

    Args:
        names: files of 80-column cards, or flight projects, whose names end in `.toml`;
            - is a deck from standard input
        options: how to solve decks
        locations: where files are that are not under their names
        sigmas: standard deviations in the place of those that flights state; decks state none
    """
    for flights, some in groupby(names, is_flight):
        if not flights:
            yield from solve_decks(some, options, locations)
            continue
        from vopd.flight.result import solve_flight  # decks need not wait for it

        for name in some:
            try:
                yield solve_flight(name, locations.get(name), sigmas)
                yield SourceEnd(name)
            except VopdError as error:
                yield SourceEnd(name, error)


def check_project(name: str) -> list[Finding]:
    """Find all errors and warnings of a flight project."""
    from vopd.flight.check import check_flight  # takes scipy

    return check_flight(name)


def read_deck(path: str | PathLike[str], *, limits_1974: bool = False) -> Deck:
    """Read all jobs of a card deck.

    Args:
        path: the deck's file; `-` is standard input
        limits_1974: whether a deck that exceeds the original's array sizes is an error

    Returns:
        The jobs in the order of the deck, with the warnings about its cards.

    Raises:
        InputError: at the first card that cannot be read; its `finding` says which.
        VopdError: where the file cannot be opened, is empty or is not a deck.

    Source: TM X-3050, Appendix F.
    """
    refuse_other_kind(path, (str, PathLike), "vopd.read_deck", "the path of a deck")
    name, jobs = str(path), []
    findings: list[Finding] = []
    for one in read_decks([name], limits_1974):
        findings += one.findings
        if isinstance(one, ReadJob):
            jobs.append(one.job)
        elif one.error is not None:
            raise one.error
    return Deck(tuple(jobs), name, tuple(findings))


def is_flight(name: str) -> bool:
    """Tell a flight project by its suffix `.toml`."""
    return name.lower().endswith(".toml")


def read_decks(
    names: Iterable[str],
    limits_1974: bool = False,
    locations: Mapping[str, str] = NAMES_ARE_PATHS,
) -> Iterator[ReadJob | SourceEnd]:
    """Read decks, job by job; after the last job of each deck comes a `SourceEnd`.

    Args:
        names: files of 80-column cards; - is standard input
        limits_1974: whether a deck that exceeds the original's array sizes is an error
        locations: where files are that are not under their names
    """
    for name in names:
        yield from _read_deck(name, locations.get(name, name), limits_1974)


def _read_deck(name: str, path: str, limits_1974: bool) -> Iterator[ReadJob | SourceEnd]:
    """Read one deck, each job when it is asked for, with the warnings about its cards."""
    from vopd.cards.miscount import Miscount
    from vopd.cards.read import open_deck
    from vopd.check import checked_jobs

    warnings: list[Finding] = []
    error: VopdError | None = None
    try:
        with open_deck(path) as file:
            jobs = checked_jobs(file, name, raising(warnings.append), limits_1974=limits_1974)
            for number, job in enumerate(jobs, 1):
                yield ReadJob(name, number, job, tuple(warnings))
                warnings.clear()
    except Miscount as found:
        error, warnings = found, found.before(warnings)
    except VopdError as found:
        error = found
    yield SourceEnd(name, error, tuple(warnings))


def solve_jobs(
    items: Iterable[ReadJob | SourceEnd], options: SolveOptions
) -> Iterator[SolvedJob | SourceEnd]:
    """Solve jobs, several at once; after an error, the rest of that deck is left out.

    Args:
        items: jobs as `read_decks` gives them, with a `SourceEnd` behind the last of each deck
        options: how to solve them
    """
    failed = False  # the deck that is being passed on
    for film in _films(items):
        solved = iter(solve_film([item for item in film if isinstance(item, ReadJob)], options))
        for item in film:
            if isinstance(item, SourceEnd):
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
                yield SourceEnd(item.source, error)
                failed = True


def _films(items: Iterable[ReadJob | SourceEnd]) -> Iterator[list[ReadJob | SourceEnd]]:
    film: list[ReadJob | SourceEnd] = []
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


def solve_film(jobs: Sequence[ReadJob], options: SolveOptions) -> list[SolvedJob | VopdError]:
    """Solve jobs together; an error in one job does not affect the others.

    Returns:
        For each job, in order, the solved job, or the error why it cannot be solved.
    """
    from vopd.program.vopd import run_jobs

    given, start_deg = [one.job for one in jobs], [one.start_deg for one in jobs]
    if options.initial == "deck":
        ended = run_jobs(given, options.fixes, start_deg)
        return _with_findings([_solved(*both) for both in zip(jobs, ended, strict=True)])
    ended = run_jobs(given, options.fixes, start_deg, closed_form_start)
    from_deck = run_jobs(given, options.fixes, start_deg) if options.compare_initial else ended
    solved = [_solved(*both) for both in zip(jobs, ended, strict=True)]
    return _with_findings([_compared(*both) for both in zip(solved, from_deck, strict=True)])


def _compared(
    solved: SolvedJob | VopdError, from_deck: Results | VopdError
) -> SolvedJob | VopdError:
    """Warn of frames whose attitude is another from the deck's first estimate."""
    if not (isinstance(from_deck, Results) and isinstance(solved, SolvedJob)):
        return solved
    results = solved.results
    apart = np.abs((from_deck.camera_deg - results.camera_deg + 180.0) % 360.0 - 180.0)
    elsewhere = from_deck.solved & results.solved & ~(apart.max(axis=1) < ELSEWHERE_DEG)
    if not elsewhere.any():
        return solved
    text = "the deck's first estimate leads to another attitude"
    finding = frame_finding(solved, elsewhere, 8, text)
    return replace(solved, findings=(*solved.findings, finding))


def _solved(one: ReadJob, results: Results | VopdError) -> SolvedJob | VopdError:
    """Label the results of a job; an undefined landmark is an error that names its card."""
    from vopd.program.positions import UndefinedLandmark

    if isinstance(results, UndefinedLandmark):
        text = str(results)
        finding = one.job.readings.first_card.get(results.landmark, Finding(text, one.source))
        return InputError(replace(finding, message=text))
    if isinstance(results, VopdError):
        return results
    return SolvedJob(one.source, one.number, results, one.findings)


def _with_findings(solved: Sequence[SolvedJob | VopdError]) -> list[SolvedJob | VopdError]:
    """Add the warnings about readings and results to jobs."""
    found = iter(solve_findings([one for one in solved if isinstance(one, SolvedJob)]))
    return [
        replace(one, findings=(*one.findings, *next(found))) if isinstance(one, SolvedJob) else one
        for one in solved
    ]


def stop_error(solved: SolvedJob) -> InputError | None:
    """Make the error of a job that a table out of order stopped; it ends the deck.

    Returns:
        The error, or None if the run was not stopped.
    """
    stop = solved.results.stop
    if stop is None:
        return None
    message = f"{stop.table} out of order at position {stop.position}: FTLUP stops the run"
    return InputError(Finding(message, solved.source, job=solved.number, group=stop.group))


def solve_findings(jobs: Sequence[SolvedJob]) -> list[list[Finding]]:
    """Find the warnings about the readings and the results of each of some jobs."""
    if not jobs:
        return []
    from vopd.check import earth_texts

    found: list[list[Finding]] = []
    for one, (earth, _) in zip(jobs, earth_texts([one.results.job for one in jobs]), strict=True):
        texts = [copied_readings_text(one.results.job.readings)]
        texts += [earth] * (Fix.EARTH not in one.results.fixes)
        about = Finding("", one.source, job=one.number, group=BASIC_DATA, severity="warning")
        found.append([replace(about, message=text) for text in texts if text])
    frames = np.cumsum([0, *(len(one.results.frame) for one in jobs)])
    for marked, group, message in _conditions([one.results for one in jobs]):
        where = np.searchsorted(frames, np.flatnonzero(marked), side="right") - 1
        for k in np.flatnonzero(np.bincount(where)).tolist():  # np.unique would load numpy.ma
            own = marked[frames[k] : frames[k + 1]]
            found[k].append(frame_finding(jobs[k], own, group, message))
    return found


def frame_finding(job: SolvedJob, frames: Bools, group: int | None, message: str) -> Finding:
    """Make a warning about some frames of a job.

    Args:
        job: the job
        frames: which of its frames (F,)
        group: the group concerned
        message: what is wrong with them
    """
    numbers = job.results.frame[frames]
    text = f"{frames_text([str(number) for number in numbers])}: {message}"
    return Finding(text, job.source, job=job.number, group=group, severity="warning")


def _conditions(jobs: Sequence[Results]) -> Iterator[tuple[Bools, int | None, str]]:
    """Mark the frames, of all jobs in a row, that have each condition; its group and message."""
    r = Results.concat(jobs)
    flying = (r.outcome != Outcome.DROPPED) & (r.outcome != Outcome.STOPPED)
    few = flying & (r.used_count < 2)
    single = flying & (r.layout.distinct(r.points.landmark, r.points.used) < 2) & ~few
    behind, beyond, centred = (
        r.layout.counted(marked) > 0
        for marked in (_behind_camera(r), _beyond_lens(r, jobs), r.points.at_centre)
    )
    extrapolated = "values are extrapolated"
    yield from (
        (r.outside_clock & flying, 6, f"outside the time table; {extrapolated}"),
        (r.outside_trajectory & flying, 7, f"outside the trajectory table; {extrapolated}"),
        (r.outside_wind & r.solved & flying, 4, f"outside the wind table; {extrapolated}"),
        (few, BASIC_DATA, "fewer than two landmarks; the angles are rounding noise"),
        (single, BASIC_DATA, "one landmark, read twice; the angles are rounding noise"),
        (
            r.singular & ~few & ~single & flying,
            BASIC_DATA,
            "the normal matrix is singular; the angles are meaningless",
        ),
        (behind & flying, 8, "landmarks lie behind the camera; try --initial closed-form"),
        (beyond & flying, 1, f"landmarks lie beyond the lens table; {extrapolated}"),
        (
            centred & flying,
            BASIC_DATA,
            "a landmark lies at the frame's centre; its distortion is not corrected",
        ),
        (
            ~r.converged,
            None,
            "not converged: the 22nd correction exceeds 1e-6 rad or is not a number",
        ),
        (
            _out_of_range(r) & r.solved & r.converged,
            None,
            "an angle of camera or vehicle is beyond a full circle, although the solve converged; "
            "the listing may have asterisks",
        ),
    )


def _out_of_range(results: Results) -> Bools:
    """Mark frames with an angle that was not brought back into a full circle (F,)."""
    angles = np.hstack([results.camera_deg, results.vehicle_deg])
    return np.asarray((np.abs(angles) > LARGEST_DEG).any(axis=1))


@np.errstate(invalid="ignore")
def _behind_camera(results: Results) -> Bools:
    """Mark landmarks that the camera, as solved, looks away from (N,)."""
    frame, points = results.layout.frame, results.points
    axes = camera_axes(np.radians(results.camera_deg))[frame]
    cosine = ahead(axes, points.direction[:, None])[:, 0]
    return np.asarray(points.used & results.solved[frame] & (cosine < 0))


@np.errstate(invalid="ignore")
def _beyond_lens(results: Results, jobs: Sequence[Results]) -> Bools:
    """Mark landmarks that are imaged outside their job's lens table (N,)."""
    radius, count = results.points.radius_mm, [one.layout.total for one in jobs]
    tables = [one.job.camera.lens_radius_mm for one in jobs]
    least, most = (np.repeat([end(table) for table in tables], count) for end in (np.min, np.max))
    return np.asarray(results.points.used & ((radius > most) | (radius < least)))


AT_A_TIME = 100_000  # landmarks


@np.errstate(all="ignore")
def closed_form_start(seen: FilmSight) -> Floats:
    """Estimate camera yaw, pitch, roll, (F, 3) degrees, from two landmarks far apart.

    In each frame the two that are farthest apart are used. The estimate is NaN for a frame
    without two landmarks, or whose focal length is not positive.
    """
    angles = np.full((len(seen.cc), 3), np.nan)
    for frames in seen.alike(np.flatnonzero(seen.nj >= 2), AT_A_TIME):
        angles[frames] = _closed_form(seen.of(frames))
    return angles


def _closed_form(seen: Sight) -> Floats:
    """Solve frames of like counts for camera yaw, pitch, roll (F, 3), degrees; NaN for none."""
    from vopd.stellar.field import StarField
    from vopd.stellar.methods.two_star import closed_form  # a twentieth of a start-up

    possible = seen.cc > 0.0
    used = seen.used.T
    # VOPD's image is the one before the lens, x y +c; Rae's lies behind it, x y -f.
    # Half a turn about x takes one into the other.
    image = np.where(used[..., None], np.stack([seen.x.T, -seen.y.T], axis=-1), 0.0)
    direction = np.stack([part.T for part in seen.dircos], axis=-1)
    directions = np.where(used[..., None], direction, [0.0, 0.0, 1.0])
    field = StarField.of(directions, image, np.where(possible, seen.cc, 1.0), used)
    matrix = closed_form(field) * np.array([[1.0], [-1.0], [-1.0]])
    return np.where(possible[:, None], camera_angles_deg(matrix), np.nan)


TOGETHER = 2000  # frames

Solved = TypeVar("Solved")


def in_groups(sources: Iterator[Solved]) -> Iterator[list[Solved]]:
    """Group jobs of decks, about `TOGETHER` frames at a time.

    What comes between them is in the groups too, in its order; a flight is the last of its group.
    """
    group: list[Solved] = []
    frames = 0
    for one in sources:
        group.append(one)
        frames += len(one.results.frame) if isinstance(one, SolvedJob) else 0
        if frames >= TOGETHER or not isinstance(one, SolvedJob | SourceEnd):
            yield group
            group, frames = [], 0
    if group:
        yield group
