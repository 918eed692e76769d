"""A thousand generated decks: the fast way and the slow way print the same bytes.

The fast way is that of `vopd run`: cards as columns of bytes, all frames in one solve,
pages by the thousand. The slow way reads the cards line by line, solves frame
after frame, each by itself from the start that the one before leaves it, and
prints page after page, those of every fourth deck line by line by fortranformat.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

import vopd
from tests.kit import page_by_fortranformat
from vopd.arrays import Floats
from vopd.cards.reader import read_jobs
from vopd.cards.writer import write_deck
from vopd.findings import strict
from vopd.job import Job
from vopd.listing.pages import frame_pages
from vopd.program.orient import BLOCK, orient
from vopd.program.sight import sight_of
from vopd.program.vopd import run
from vopd.results import Outcome, Results
from vopd.synthetic.plan import Plan
from vopd.synthetic.scene import make

DECKS, AT_A_TIME = 1000, 50
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


def one_by_one(job: Job) -> Iterator[Results]:
    """The results of each frame by itself."""
    start = job.camera.initial_deg
    whole = job.readings
    for f in range(len(whole.frame)):
        parts = {
            name: getattr(whole, name)[f : f + 1]
            for name in ("frame", "fiducial_in", "landmark", "present", "landmark_in")
        }
        one = replace(
            job,
            camera=replace(job.camera, initial_deg=start),
            readings=replace(whole, **parts),
        )
        results = run(one)
        yield replace(results, job=job)
        if results.outcome[0] == Outcome.SOLVED and f + 1 < len(whole.frame):
            start = left_to_the_next(results, job.camera.initial_deg)


def left_to_the_next(results: Results, initial: Floats) -> Floats:
    """A 432 to A 454: the 22nd correction, the range, and the restart in degrees for radians."""
    after = orient(results.start_deg.T, sight_of(results)).next[:, 0]
    if np.isnan(after).any():
        return initial
    limits = ((0.0, TWOPI), (-PI, PI), (0.0, TWOPI))
    stays = [low <= angle <= high for angle, (low, high) in zip(after, limits, strict=True)]
    return np.where(stays, after, initial)


def slowly(text: bytes, by_line: bool) -> bytes:
    """The listing of a deck, card by card, frame by frame, of some decks line by line."""
    ragged = b"\n".join(line.rstrip() for line in text.split(b"\n"))
    listing = ""
    for job in read_jobs(io.BytesIO(ragged), "ragged", strict):
        for results in one_by_one(job):
            page = (
                page_by_fortranformat.page(results, 0)
                if by_line
                else b"".join(frame_pages(results)).decode()
            )
            listing += page
        listing += job.title.rstrip().ljust(80) + "\n"
    return (listing + "\n\n END OF CASE\n").encode("ascii")


def quickly(text: bytes) -> bytes:
    """The listing of a deck as `vopd run` prints it."""
    jobs = list(read_jobs(io.BytesIO(text), "deck", strict))
    return vopd.listing_text(vopd.run(jobs)).encode("ascii")


@pytest.mark.parametrize("first", range(0, DECKS, AT_A_TIME))
def test_the_same_bytes(first: int) -> None:
    for seed in range(first, first + AT_A_TIME):
        text = deck(seed)
        assert quickly(text) == slowly(text, seed % 4 == 0), f"deck {seed}"


def test_a_film_of_more_than_a_block() -> None:
    """Every 61st frame of a film that takes two blocks, and those around the seam."""
    job = make(Plan(frames=BLOCK + 60, landmarks=3, seed=5))[0][0]
    results = run(job)
    for f in [*range(0, BLOCK, 61), *range(BLOCK - 2, BLOCK + 3)]:
        parts = {
            name: getattr(job.readings, name)[f : f + 1]
            for name in ("frame", "fiducial_in", "landmark", "present", "landmark_in")
        }
        camera = replace(job.camera, initial_deg=results.start_deg[f])
        one = run(replace(job, camera=camera, readings=replace(job.readings, **parts)))
        np.testing.assert_array_equal(one.camera_deg[0], results.camera_deg[f])
        np.testing.assert_array_equal(one.residual_mm[0], results.residual_mm[f])
