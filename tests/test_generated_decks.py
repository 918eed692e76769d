"""Generated decks: the fast way and the slow way print the same bytes.

The fast way is that of `vopd run`: cards as columns of bytes, all frames of many
decks in one solve, pages by the thousand. The slow way reads the cards line by
line, solves frame after frame, each from the start that the one before leaves it,
and prints page after page. Of every eighth deck it solves each frame by itself and
prints line by line by fortranformat. The tests take the first 200 of a thousand decks;
tools/digits_by_machine.py takes them all.
"""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from tests.kit import page_by_fortranformat
from tests.kit.appendix_a import RAD, wrapped
from tests.kit.jobs import reread
from vopd.arrays import Floats
from vopd.cards.read import read_jobs
from vopd.cards.write import write_deck
from vopd.film import sight_of
from vopd.findings import strict
from vopd.job import Job
from vopd.listing.pages import end_of_case, frame_pages, pages
from vopd.pipeline import solve_decks
from vopd.program.orient import orient
from vopd.program.vopd import AT_A_TIME as LANDMARKS_AT_A_TIME
from vopd.program.vopd import run, run_jobs
from vopd.results import Outcome, Results, SolvedJob
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

DECKS, TESTED, AT_A_TIME = 1000, 200, 50
TWOPI, PI = 6.2831853, 3.14159265  # in degrees, as A 452 to A 454 have them


def deck(seed: int) -> bytes:
    """One to three frames; some with frames and landmarks ignored, some started far off."""
    rng = np.random.default_rng(seed)
    plan = Plan(
        frames=int(rng.integers(1, 4)),
        landmarks=int(rng.integers(2, 7)),
        seed=seed,
        noise_in=float(rng.choice([0.0, 0.003, 0.02])),
        jobs=int(rng.choice([1, 1, 1, 1, 2])),
        trajectory_rows=int(rng.integers(2, 9)),
    )
    jobs, _ = make(plan)
    if len(jobs) == 1:  # a second job reads only a few groups again
        jobs = [_bent(jobs[0], rng)]
    later = np.round(jobs[0].clock.time_s + 0.0003, 5)  # fortranformat rounds exact ties its way
    clock = replace(jobs[0].clock, time_s=later)
    return write_deck([replace(job, clock=clock) for job in jobs]).encode("ascii")


def _bent(job: Job, rng: np.random.Generator) -> Job:
    frames = job.readings.frame
    asked = rng.choice(frames, int(rng.integers(0, 2)), replace=False)
    cards = rng.choice([0, 100, 3, 4], (len(asked), 6))
    ignored = replace(job.ignored, frame=asked, landmark=cards)
    far = job.camera.initial_deg + rng.choice([0.0, 0.0, 40.0]) * rng.uniform(-1.0, 1.0, 3)
    camera = replace(job.camera, initial_deg=np.round(far, 2))
    return replace(job, camera=camera, ignored=ignored)


def frame_by_frame(jobs: list[Job], alone: bool) -> list[list[Results]]:
    """The results of each frame of each job, solved one after the other.

    All first frames, then all second ones: a frame knows none of its own job, and none
    at all if each is to be solved `alone`.
    """
    done: list[list[Results]] = [[] for _ in jobs]
    start = [job.camera.initial_deg for job in jobs]
    for f in range(max(len(job.readings.frame) for job in jobs)):
        which = [k for k, job in enumerate(jobs) if f < len(job.readings.frame)]
        frames = [one_frame(jobs[k], f, start[k]) for k in which]
        solved = [run(frame) for frame in frames] if alone else run_jobs(frames)
        for k, results in zip(which, solved, strict=True):
            assert isinstance(results, Results)
            done[k].append(replace(results, job=jobs[k]))
            if results.outcome[0] == Outcome.SOLVED:
                start[k] = left_to_the_next(results, jobs[k].camera.initial_deg)
    return done


def one_frame(job: Job, f: int, start_deg: Floats) -> Job:
    """The job with one of its frames, which starts from these angles."""
    whole = job.readings
    parts = {
        name: getattr(whole, name)[f : f + 1]
        for name in ("frame", "fiducial_in", "landmark", "present", "landmark_in")
    }
    camera = replace(job.camera, initial_deg=start_deg)
    return replace(job, camera=camera, readings=reread(whole, **parts))


def left_to_the_next(results: Results, initial: Floats) -> Floats:
    """A 432 to A 454: the 22nd correction, the range, and the restart in degrees for radians.

    To the last bit, which only a frame without an answer of its own needs.
    """
    answered = results.converged[0] and not results.singular[0] and results.used[0].sum() > 1
    if answered:
        after = wrapped(results.camera_deg[0] / RAD + results.correction_rad[0]) * RAD
    else:
        after = orient(results.start_deg.T, sight_of(results, results.focal_length_mm)).next[:, 0]
    if np.isnan(after).any():
        return initial
    limits = ((0.0, TWOPI), (-PI, PI), (0.0, TWOPI))
    stays = [low <= angle <= high for angle, (low, high) in zip(after, limits, strict=True)]
    return np.where(stays, after, initial)


def slowly(decks: list[bytes], by_line: bool) -> list[bytes]:
    """The listings of some decks, card by card, frame by frame, or even line by line."""
    ragged = [b"\n".join(line.rstrip() for line in text.split(b"\n")) for text in decks]
    jobs = [list(read_jobs(io.BytesIO(text), "ragged", strict)) for text in ragged]
    results = iter(frame_by_frame([job for deck in jobs for job in deck], alone=by_line))
    return [
        "".join(listing(job, next(results), by_line) for job in deck).encode("ascii")
        + b"\n\n END OF CASE\n"
        for deck in jobs
    ]


def listing(job: Job, frames: list[Results], by_line: bool) -> str:
    """The pages of a job's frames, each made by itself, and its title again."""
    made = (
        page_by_fortranformat.page(one, 0) if by_line else b"".join(frame_pages(one)).decode()
        for one in frames
    )
    return "".join(made) + job.title.rstrip().ljust(80) + "\n"


def quickly(decks: list[Path]) -> list[bytes]:
    """The listings of some decks, as `vopd run` prints them, all solved as one film."""
    listings = [b""]
    for one in solve_decks([str(deck) for deck in decks]):
        if isinstance(one, SolvedJob):
            listings[-1] += b"".join(pages(one.results))
        else:
            assert one.error is None
            listings[-1] += end_of_case()
            listings.append(b"")
    return listings[:-1]


@pytest.mark.parametrize("first", range(0, TESTED, AT_A_TIME))
def test_the_same_bytes(first: int, tmp_path: Path) -> None:
    """Every eighth deck is printed line by line, and each of its frames is solved alone."""
    texts = {seed: deck(seed) for seed in range(first, first + AT_A_TIME)}
    paths = []
    for seed, text in texts.items():
        paths.append(tmp_path / f"{seed}.dat")
        paths[-1].write_bytes(text)
    quick = dict(zip(texts, quickly(paths), strict=True))
    for by_line in (False, True):
        seeds = [seed for seed in texts if (seed % 8 == 0) == by_line]
        slow = slowly([texts[seed] for seed in seeds], by_line)
        for seed, ours in zip(seeds, slow, strict=True):
            assert quick[seed] == ours, f"deck {seed}"


def test_a_film_of_more_than_a_block() -> None:
    """Every 61st frame of a film that takes two blocks, and those around the seam."""
    block = LANDMARKS_AT_A_TIME // 3
    job = make(Plan(frames=block + 60, landmarks=3, seed=5))[0][0]
    results = run(job)
    frames = [*range(0, block, 61), *range(block - 2, block + 3)]
    for f in frames:
        one = run(one_frame(job, f, results.start_deg[f]))
        np.testing.assert_array_equal(one.camera_deg[0], results.camera_deg[f])
        np.testing.assert_array_equal(one.residual_mm[0], results.residual_mm[f])
