"""Pages of several jobs that are printed together, in pieces or in part; corrected runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from tests.kit.jobs import film, with_arrays, without
from vopd.errata import fixes
from vopd.listing import pages as module
from vopd.listing.pages import (
    end_of_job,
    frame_pages,
    frames_of,
    head,
    listing_text,
    pages,
    pages_of_frames,
    pages_of_jobs,
)
from vopd.program.vopd import run
from vopd.results import Outcome, Results


@cache
def solved(frames: int, title: str = "1 JOB", focal_mm: float = 10.4) -> Results:
    """A film of so many frames; the focal length is printed and not used again."""
    results = run(film(frames))
    camera = replace(results.job.camera, focal_length_mm=focal_mm)
    job = replace(results.job, title=title.ljust(80), camera=camera)
    return replace(results, job=job)


def with_ends(results: Results, *outcomes: Outcome) -> Results:
    return replace(results, outcome=np.array(outcomes))


def joined(jobs: Sequence[Results]) -> list[str]:
    return [b"".join(pieces).decode() for pieces in pages_of_jobs(jobs)]


def test_each_job_has_its_own_title_frames_and_focal_length() -> None:
    jobs = [solved(2, "1 ONE"), solved(1, "1 TWO", 99.5), solved(3, "1 THREE", 7.25)]
    made = joined(jobs)
    for text, one, name in zip(made, jobs, ("ONE", "TWO", "THREE"), strict=True):
        lines = text.split("\n")
        titles = [line for line in lines if line.startswith("1")]
        assert titles == [f"1 {name}".ljust(80)] * (len(one.frame) + 1)
        assert lines[-2] == titles[0] and lines[-1] == ""
        vehicles = [lines[k + 1] for k, line in enumerate(lines) if line.startswith("0VEHICLE")]
        focal = {"ONE": "10.40000", "TWO": "99.50000", "THREE": "7.25000"}[name]
        assert [line[57:67].strip() for line in vehicles] == [focal] * len(one.frame)
        frames = [lines[k + 1][:5] for k, line in enumerate(lines) if line.startswith("0 FRAME")]
        assert [int(frame) for frame in frames] == one.frame.tolist()


@pytest.mark.parametrize("chunk", [1, 2, 3, 1000])
def test_long_jobs_are_printed_in_pieces_and_short_ones_together(
    chunk: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The text is the same; a piece has at most so many pages."""
    jobs = [solved(1, "1 A"), solved(2, "1 LONGER" + "X" * 20), solved(3, "1 B"), solved(1, "1 C")]
    alone = [listing_text(one) for one in jobs]
    monkeypatch.setattr(module, "CHUNK", chunk)
    assert joined(jobs) == alone
    for one, text in zip(jobs, alone, strict=True):
        pieces = [piece.decode() for piece in pages(one)]
        assert "".join(pieces) == text and pieces[-1] == one.job.title + "\n"
        counts = [piece.count("0VEHICLE") for piece in pieces[:-1]]
        frames = len(one.frame)
        assert counts == [min(chunk, frames - k) for k in range(0, frames, chunk)]


@pytest.mark.parametrize(
    ("first", "last"), [(0, None), (1, None), (0, 2), (1, 3), (2, 3), (1, 1), (0, 4)]
)
@pytest.mark.parametrize("chunk", [2, 1000])
def test_some_of_the_frames(
    first: int, last: int | None, chunk: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = pages_of_frames(frames_of([solved(4)]))
    monkeypatch.setattr(module, "CHUNK", chunk)
    assert b"".join(frame_pages(solved(4), first, last)) == b"".join(whole[first:last])


def test_frames_that_end_in_different_ways_stand_in_their_order() -> None:
    ends = Outcome.SOLVED, Outcome.DROPPED, Outcome.EXACT, Outcome.EXACT_LATE, Outcome.SOLVED
    results = with_ends(solved(5), *ends)
    made = [page.decode() for page in pages_of_frames(frames_of([results]))]
    all_groups = ["L-MARK LONG", "VEHICLE", "XCO", "R DIST", "PSI", "RESIDUALS "]
    words = [*all_groups, "END OF JOB", "STANDARD", "IGNORED"]
    groups = [[word for word in words if word in page] for page in made]
    assert groups == [
        [*all_groups, "STANDARD"], ["IGNORED"], [*all_groups[:3], "END OF JOB"],
        [*all_groups, "END OF JOB"], [*all_groups, "STANDARD"],
    ]  # fmt: skip
    for k in (0, 3, 4):
        assert made[k].split("\n0 FRAME")[1].split("\n")[1].startswith(f"{k + 1:5d}")
    assert made[1] == "\n\n\n      FRAME   2IGNORED BY USERS DIRECTION\n"


def test_frames_with_other_numbers_of_landmarks() -> None:
    """Some ignored, which have their line in group 1; some that were not read."""
    used = np.ones((3, 5), bool)
    ignored = np.zeros((3, 5), bool)
    used[1, 2], used[2, :3], ignored[2, 0] = False, False, True
    made = pages_of_frames(frames_of([with_arrays(solved(3), used=used, ignored=ignored)]))
    counts = []
    for page in made:
        blocks = page.decode().split("\n0")
        counts.append((
            blocks[0].count("\n") - 2, blocks[0].count("IGNORED"), blocks[2].count("\n"),
            blocks[3].count("\n"), blocks[5].count("\n"),
        ))  # fmt: skip
    assert counts == [(5, 0, 5, 5, 5), (4, 0, 4, 4, 4), (3, 1, 2, 2, 2)]


def test_residuals_that_vanish_are_printed_of_landmarks_that_take_part() -> None:
    used = np.ones((2, 5), bool)
    used[0, 1], used[1, 2:] = False, False
    ends = with_ends(solved(2), Outcome.EXACT, Outcome.EXACT_LATE)
    results = with_arrays(ends, used=used, residual_mm=np.arange(20.0).reshape(2, 5, 2))
    first, second = (page.decode() for page in pages_of_frames(frames_of([results])))
    wanted = "".join(f"\n\n{x:21.8E}{x + 1:21.8E}\n" for x in (0.0, 4.0, 6.0, 8.0))
    assert first.endswith(f"{wanted}\n\n\n END OF JOB\n") and first.count("E+00") == 8
    wanted = "".join(f"\n\n{x:21.8E}{x + 1:21.8E}\n" for x in (10.0, 12.0))
    assert second.endswith(f"{wanted}\n\n\n END OF JOB\n") and second.count("E+01") == 4


def test_a_corrected_run_says_so_below_each_title() -> None:
    """At the end of the job too; the original's numbers have the title alone."""
    original, corrected = run(film(2)), run(film(2), fixes("first-landmark"))
    title = original.job.title
    assert head(original) == title
    assert head(corrected) == f"{title}\n CORRECTED RUN, NOT THE ORIGINAL: first-landmark"
    assert end_of_job(corrected) == f"{head(corrected)}\n".encode()
    text = listing_text(corrected)
    assert text.count(f"{head(corrected)}\n") == 3 and text.count(title) == 3
    assert text.startswith(f"{head(corrected)}\n\n L-MARK")
    both = joined([original, corrected, original])
    assert both == [listing_text(one) for one in (original, corrected, original)]


def test_a_dropped_frame_beside_others() -> None:
    """Its line stands between the pages, without a title."""
    results = run(without(film(3), 2))
    text = listing_text(results)
    assert text.count(results.job.title) == 3
    first, rest = text.split("\n\n\n      FRAME   2IGNORED BY USERS DIRECTION\n")
    assert first.count("0VEHICLE") == rest.count("0VEHICLE") == 1
