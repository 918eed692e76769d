"""Solve the sources of a batch in chunks, in one process or several."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import replace
from math import ceil
from multiprocessing.context import BaseContext
from typing import TypeVar

from vopd.batch.folder import SourceRecord, failed_record, input_sha256, remove_others, unchanged
from vopd.batch.outputs import SolvedSource, make_outputs, write_source
from vopd.batch.sources import BatchSettings, BatchSource
from vopd.files import OutputError
from vopd.findings import VopdError
from vopd.flight.result import FlightResult
from vopd.pipeline import NAMES_ARE_PATHS, solve_sources
from vopd.results import SolvedJob

# -------------------------------------------------------------------------------------------------
# Solve a chunk of sources together, and write the outputs of each.


def solve_chunk(
    sources: Sequence[BatchSource],
    settings: BatchSettings,
    earlier: Mapping[str, SourceRecord],
    locations: Mapping[str, str] = NAMES_ARE_PATHS,
) -> list[SourceRecord]:
    """Solve sources together and write their outputs.

    A source that has an earlier record is left as it is, if its input, the version, the
    options and all its outputs are those of the record and it had not failed.

    Args:
        sources: some sources of the batch
        settings: how to solve them, and what to write
        earlier: the records of an earlier run by the names of their sources
        locations: where files are that are not under the paths of their sources

    Returns:
        The record of every source, in order.

    Raises:
        OutputError: where an output cannot be written
    """
    kept = {one.source: one for one in unchanged(sources, settings, earlier)}
    waiting = [
        SolvedSource(one, input_sha256(locations.get(one.path, one.path)))
        for one in sources
        if one.name not in kept
    ]
    for record in _solve_or_one_by_one(waiting, settings, locations):
        remove_others(earlier.get(record.source), record, settings)
        kept[record.source] = record
    return [kept[source.name] for source in sources]


def _solve_or_one_by_one(
    waiting: Sequence[SolvedSource], settings: BatchSettings, locations: Mapping[str, str]
) -> list[SourceRecord]:
    """The records of sources; one that raises an exception of the program costs no other."""
    try:
        return _solve(waiting, settings, locations)
    except OutputError:
        raise
    except Exception as error:
        if len(waiting) == 1:
            (one,) = waiting
            known = isinstance(error, VopdError)
            what = str(error) if known else f"error in the program: {type(error).__name__}: {error}"
            message = f"{one.source.path}: {what}"
            return [failed_record(one.source, settings, message, one.input_sha256)]
    again = [SolvedSource(one.source, one.input_sha256) for one in waiting]
    return [record for one in again for record in _solve_or_one_by_one([one], settings, locations)]


def _solve(
    waiting: Sequence[SolvedSource], settings: BatchSettings, locations: Mapping[str, str]
) -> list[SourceRecord]:
    start = time.perf_counter()
    _put_together(waiting, settings, locations)
    make_outputs(waiting, settings)
    records = [write_source(one, settings) for one in waiting]
    seconds = time.perf_counter() - start
    total = sum(max(record.frames, 1) for record in records)
    return [replace(one, seconds=seconds * max(one.frames, 1) / total) for one in records]


def _put_together(
    waiting: Sequence[SolvedSource], settings: BatchSettings, locations: Mapping[str, str]
) -> None:
    """Solve all sources, and give each what belongs to it."""
    coming = iter(waiting)
    now = next(coming, None)
    for one in solve_sources([one.source.path for one in waiting], settings.solve, locations):
        assert now is not None
        now.findings.extend(one.findings)
        if isinstance(one, SolvedJob):
            now.jobs.append(one)
        elif isinstance(one, FlightResult):
            now.flight = one
        else:
            now.error = one.error
            now = next(coming, None)


# -------------------------------------------------------------------------------------------------
# Put sources together into chunks: small decks are solved together, a large one by itself.

CHUNK_BYTES = 4_000_000  # about 2,000 frames of four landmarks
CHUNK_SOURCES = 200
LEAST_CHUNKS = 4  # for each process, so that all have work to the end


def even_chunk_bytes(sources: Sequence[BatchSource], processes: int) -> float:
    """The bytes of a chunk for which every process has as many chunks, about equally large.

    Args:
        sources: the sources
        processes: how many work on them
    """
    sizes = [one.size for one in sources if not one.flight]
    for_each = max(sum(sizes) / CHUNK_BYTES, len(sizes) / CHUNK_SOURCES) / processes
    return max(sum(sizes), 1) / (processes * max(LEAST_CHUNKS, ceil(for_each)))


def chunks(
    sources: Iterable[BatchSource], chunk_bytes: float = CHUNK_BYTES
) -> Iterator[list[BatchSource]]:
    """The sources in chunks, in order; a flight is a chunk by itself.

    Args:
        sources: the sources
        chunk_bytes: of the decks in a chunk; each begins with the deck whose middle lies
            behind the next multiple of it
    """
    chunk: list[BatchSource] = []
    before, number = 0, 0.0
    for source in sources:
        now = (before + source.size / 2.0) // chunk_bytes
        full = len(chunk) == CHUNK_SOURCES or now != number
        if chunk and (full or source.flight or chunk[-1].flight):
            yield chunk
            chunk = []
        chunk.append(source)
        number = now
        before += 0 if source.flight else source.size
    if chunk:
        yield chunk


def taken_apart(chunk: list[BatchSource]) -> list[list[BatchSource]]:
    """Every source of a chunk as a chunk by itself."""
    return [[one] for one in chunk]


# -------------------------------------------------------------------------------------------------
# Work on chunks in several processes; a process that dies costs no chunk but its own.

C = TypeVar("C")
R = TypeVar("R")

ATTEMPTS = 2  # by itself in a process; a chunk that ends that process each time is given up
COPIES = "forkserver"  # a way in which Python starts processes
LOADED = "vopd.batch.run"
STARTING = ("SIGINT", "SIGHUP")  # not SIGTERM, by which a pool ends its processes


def in_processes(
    work: Callable[[C], R],
    chunks: Iterable[C],
    jobs: int,
    split: Callable[[C], list[C]],
    given_up: Callable[[C], R],
) -> Iterator[R]:
    """Work on chunks in processes, and give the results as they are made.

    Where a process dies, all chunks that were being worked on are split and worked on
    again, one at a time, so that the one at fault is by itself.

    Args:
        work: what to do with a chunk; it is pickled
        chunks: the chunks
        jobs: the number of processes
        split: takes a chunk apart; one that cannot be is returned by itself
        given_up: makes the result of a chunk that has ended its process `ATTEMPTS` times
    """
    waiting = iter(chunks)
    suspects: deque[tuple[C, int]] = deque()  # with the attempts that each has had
    while True:
        lost: list[C] = []
        if suspects:
            yield from _one_at_a_time(work, suspects, given_up)
        with _pool(jobs) as pool:
            running: dict[Future[R], C] = {}
            while not lost:
                for chunk in _some(waiting, jobs + 1 - len(running)):
                    try:
                        running[_submit(pool, work, chunk)] = chunk
                    except BrokenProcessPool:
                        lost.append(chunk)
                        break
                if not running:
                    break
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    chunk = running.pop(future)
                    try:
                        yield future.result()
                    except BrokenProcessPool:
                        lost.append(chunk)
            if lost:  # all others that were begun are lost with it, or done
                for future, chunk in running.items():
                    try:
                        yield future.result()
                    except BrokenProcessPool:
                        lost.append(chunk)
        if not lost:
            return
        suspects.extend((one, 0) for chunk in lost for one in split(chunk))


def _one_at_a_time(
    work: Callable[[C], R], suspects: deque[tuple[C, int]], given_up: Callable[[C], R]
) -> Iterator[R]:
    """Work on chunks one at a time in a process of their own, until none is left."""
    while suspects:
        with _pool(1) as pool:
            while suspects:
                chunk, attempts = suspects.popleft()
                try:
                    yield _submit(pool, work, chunk).result()
                except BrokenProcessPool:
                    if attempts + 1 < ATTEMPTS:
                        suspects.append((chunk, attempts + 1))
                    else:
                        yield given_up(chunk)
                    break


def _some(waiting: Iterator[C], count: int) -> Iterator[C]:
    for _ in range(count):
        try:
            yield next(waiting)
        except StopIteration:
            return


def _submit(pool: ProcessPoolExecutor, work: Callable[[C], R], chunk: C) -> Future[R]:
    with _signals_wait():
        return pool.submit(work, chunk)


@contextmanager
def _pool(jobs: int) -> Iterator[ProcessPoolExecutor]:
    """Processes of their own, started anew; what has not begun is dropped at an error."""
    pool = ProcessPoolExecutor(jobs, mp_context=_context(), initializer=_begin)
    try:
        yield pool
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def load_ahead() -> None:
    """Begin to load what processes need, while this one goes on to find out what they are to do.

    A process of its own loads it once, and the processes that work are copies of that one.
    Windows has no such copies.
    """
    if _context().get_start_method() == COPIES:
        from multiprocessing import forkserver, resource_tracker

        resource_tracker.ensure_running()  # which would let the signals through
        with _signals_wait():
            forkserver.ensure_running()


def _context() -> BaseContext:
    """How processes are started: as copies of one that has loaded the package, if possible."""
    if COPIES not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context(COPIES)
    context.set_forkserver_preload([LOADED])
    return context


@contextmanager
def _signals_wait() -> Iterator[None]:
    """Hold signals back while processes start, which inherit this: only their parent acts on them.

    Windows has no such mask.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    numbers = [getattr(signal, name) for name in STARTING]
    before = signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin() -> None:
    """Prepare a process: it ends when its parent has ended, however that ended."""
    parent = multiprocessing.parent_process()
    assert parent is not None

    def end_with_parent() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=end_with_parent, daemon=True).start()
