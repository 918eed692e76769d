"""Run a batch: solve all sources of a shard in one process or several, and keep their records."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from vopd.batch.batch_folder import BatchFolder, Records
from vopd.batch.chunks import CHUNK_SOURCES, chunks, taken_apart
from vopd.batch.processes import in_processes
from vopd.batch.settings import BatchSettings
from vopd.batch.solve_chunk import failed_record, solve_chunk
from vopd.batch.source_record import SourceRecord
from vopd.batch.sources import BatchSource

KILLED = "its process was killed each time that it was solved; is there enough memory?"


def run_batch(
    sources: Sequence[BatchSource],
    settings: BatchSettings,
    folder: BatchFolder,
    earlier: Records,
    jobs: int,
    done: Callable[[int], object],
) -> list[SourceRecord]:
    """Solve sources and write their outputs.

    Args:
        sources: the sources of this shard
        settings: how to solve them, and what to write
        folder: the output folder, begun
        earlier: the records of an earlier run
        jobs: the number of processes; 1 is this one
        done: is called with the number of sources that have been finished

    Returns:
        The record of every source, in order.

    Raises:
        OutputError: where an output cannot be written
    """
    records: Records = {}
    for some in _solved(sources, settings, earlier, jobs):
        folder.keep(some)
        records.update((one.source, one) for one in some)
        done(len(some))
    return [records[one.name] for one in sources]


def _solved(
    sources: Sequence[BatchSource], settings: BatchSettings, earlier: Records, jobs: int
) -> Iterator[list[SourceRecord]]:
    most = max(1, min(CHUNK_SOURCES, len(sources) // (4 * jobs)))  # so that all processes have work
    work = partial(_work, settings)
    plan = (
        (chunk, {one.name: earlier[one.name] for one in chunk if one.name in earlier})
        for chunk in chunks(sources, most if jobs > 1 else CHUNK_SOURCES)
    )
    if jobs == 1:
        yield from map(work, plan)
        return

    def split(piece: Piece) -> list[Piece]:
        return [(one, piece[1]) for one in taken_apart(piece[0])]

    def given_up(piece: Piece) -> list[SourceRecord]:
        return [failed_record(one, settings, f"{one.path}: {KILLED}") for one in piece[0]]

    yield from in_processes(work, plan, jobs, split, given_up)


Piece = tuple[list[BatchSource], Records]
"""A chunk, with the earlier records of its sources."""


def _work(settings: BatchSettings, piece: Piece) -> list[SourceRecord]:
    return solve_chunk(piece[0], settings, piece[1])
