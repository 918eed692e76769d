"""A long film in two halves, the second in a process of its own.

The halves are the same computation on fewer frames. What binds them is the
start that a frame takes from the one before: the second half begins a few frames
early, and its results count only if its start in the middle is, to the last bit,
the one that the first half leaves. If it is not, or anything else goes wrong, the
whole film is run here, in one piece.
"""

from __future__ import annotations

import os
import pickle
import sys
import warnings
from collections.abc import Callable, Iterable
from dataclasses import fields, replace
from typing import Any

import numpy as np

from vopd.errata import Fixes
from vopd.job import Job
from vopd.listing.pages import frame_pages
from vopd.program.vopd import run
from vopd.results import Results

LONG = 3000  # frames from which two processes are worth their while
EARLY = 64  # frames that the second half begins before its own

Printed = list[bytes]


def run_and_print(job: Job, fixes: Fixes) -> tuple[Results, Iterable[bytes]]:
    """A job's results, and the pages of its frames in pieces."""
    if len(job.readings.frame) >= LONG and _processors() > 1:
        found = _in_halves(job, fixes)
        if found is not None:
            return found
    results = run(job, fixes)
    return results, frame_pages(results)


def _processors() -> int:
    """How many there are for this process; 1 where it cannot be split."""
    return len(os.sched_getaffinity(0)) if sys.platform == "linux" else 1


def _in_halves(job: Job, fixes: Fixes) -> tuple[Results, Printed] | None:
    count = len(job.readings.frame)
    middle = count * 11 // 20  # the other starts later, and its answer takes its time
    early = min(EARLY, middle)

    def second_half() -> tuple[Results, Printed]:
        results = run(_frames(job, middle - early, count), fixes)
        return results, list(frame_pages(results, early))

    other = _Child(second_half)
    try:
        first = run(_frames(job, 0, middle + 1), fixes)
        printed = list(frame_pages(first, 0, middle))
    except Exception:  # what is wrong with a job is told by its run in one piece
        return None
    finally:
        answer = other.answer()
    if answer is None:
        return None
    second, rest = answer
    if first.stop is not None or second.stop is not None:
        return None
    if first.start_deg[middle].tobytes() != second.start_deg[early].tobytes():
        return None
    return _joined(job, first, middle, second, early), printed + rest


def _frames(job: Job, first: int, last: int) -> Job:
    """The job with some of its frames."""
    r = job.readings
    names = "frame", "fiducial_in", "landmark", "present", "landmark_in"
    return replace(job, readings=replace(r, **{n: getattr(r, n)[first:last] for n in names}))


def _joined(job: Job, first: Results, middle: int, second: Results, early: int) -> Results:
    arrays: dict[str, Any] = {}
    for field in fields(Results):
        one, other = getattr(first, field.name), getattr(second, field.name)
        if isinstance(one, np.ndarray):
            arrays[field.name] = np.concatenate([one[:middle], other[early:]])
    return replace(first, job=job, **arrays)


class _Child:
    """Work in a copy of this process; its answer comes back through memory."""

    def __init__(self, work: Callable[[], object]) -> None:
        self._memory = os.memfd_create("second half")
        with warnings.catch_warnings():  # of threads: numpy's, which are idle
            warnings.simplefilter("ignore", DeprecationWarning)
            self._process = os.fork()
        if self._process == 0:
            self._work(work)

    def _work(self, work: Callable[[], object]) -> None:
        status = 1
        try:
            with os.fdopen(self._memory, "wb") as file:
                pickle.dump(work(), file, protocol=5)
            status = 0
        finally:
            os._exit(status)

    def answer(self) -> Any:
        """What the work returned; None where it failed."""
        _, status = os.waitpid(self._process, 0)
        with os.fdopen(self._memory, "rb") as file:
            if status != 0:
                return None
            file.seek(0)
            return pickle.load(file)
