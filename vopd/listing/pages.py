"""Make the pages that program VOPD printed (TM X-3050, Appendix G)."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
from itertools import islice

from vopd.jobs_alike import alike_together
from vopd.listing.frame_pages import frames_of, head, pages_of_frames
from vopd.listing.line_formats import LINES
from vopd.listing.one_number import fixed, general, line_without_numbers
from vopd.results import Results, Stop

CHUNK = 4000  # pages made at a time


def listing_text(results: Results | Sequence[Results]) -> str:
    """The listing as text: the pages of one job, or of all jobs of a run.

    Column 1 is carriage control. The title is printed again at the end of each job;
    a corrected run has a second line under each title. Lines end in a newline. A run
    ends with `end_of_case()`, unless a table out of order stopped it.

    Args:
        results: one job, or all jobs of a run.
    """
    if isinstance(results, Results):
        return b"".join(pages(results)).decode("ascii")
    text = "".join(listing_text(one) for one in results)
    stopped = len(results) > 0 and results[-1].stop is not None
    return text if stopped else text + end_of_case().decode("ascii")


def end_of_case() -> bytes:
    """The lines that end a run."""
    return line_without_numbers(LINES["end of case"]).encode("ascii")


def pages(results: Results) -> Iterator[bytes]:
    """The pages of one job, in pieces of about `CHUNK` pages, so that long runs need little memory.

    Args:
        results: the job.
    """
    yield from frame_pages(results)
    yield end_of_job(results)


def frame_pages(results: Results, first: int = 0, last: int | None = None) -> Iterator[bytes]:
    """The pages of some consecutive frames, in pieces of about `CHUNK` pages.

    Args:
        results: the job.
        first: index of the first frame.
        last: index behind the last frame; to the end by default.
    """
    stop = len(results.outcome) if last is None else last
    for start in range(first, stop, CHUNK):
        some = results.take(slice(start, min(start + CHUNK, stop)))
        yield b"".join(pages_of_frames(frames_of([some])))


def pages_of_jobs(jobs: Sequence[Results]) -> list[Iterable[bytes]]:
    """The pages of each of several jobs, in pieces; short jobs together take less time than alone.

    Args:
        jobs: the jobs.
    """
    made: dict[int, Iterable[bytes]] = {}
    kinds = ((_kind(one, k), len(one.frame)) for k, one in enumerate(jobs))
    for indices in alike_together(kinds, CHUNK):
        some = [jobs[k] for k in indices]
        if len(some) == 1:
            made[indices[0]] = pages(some[0])
            continue
        printed = iter(pages_of_frames(frames_of(some)))
        for k, one in zip(indices, some, strict=True):
            made[k] = [*islice(printed, len(one.frame)), end_of_job(one)]
    return [made[k] for k in range(len(jobs))]


def _kind(job: Results, index: int) -> Hashable:
    """Jobs with heads of one length are printed together; long ones, and one that stops, alone."""
    return -1 - index if job.stop is not None or len(job.frame) >= CHUNK else len(head(job))


def end_of_job(results: Results) -> bytes:
    """The lines after a job's pages: its title again, or the table that stopped the run.

    Args:
        results: the job.
    """
    last = head(results) + "\n" if results.stop is None else table_out_of_order(results.stop)
    return last.encode("ascii")


def table_out_of_order(stop: Stop) -> str:
    """The lines that FTLUP prints before it stops the run.

    Args:
        stop: the table, and where it is out of order.

    Source: TM X-3050, Appendix D.
    """
    order, location = LINES["table out of order"], LINES["table location"]
    text = order.text.ljust(order.fields[0].first - 1)
    text += fixed(stop.position, order.fields[0]) + "\n" + line_without_numbers(location) + "\n"
    for table in (stop.vari, stop.vard):
        for first in range(0, len(table), 8):
            text += " " + "".join(general(v, 15, 8) for v in table[first : first + 8]) + "\n"
    return text
