"""Run a batch: solve all sources of a shard in one process or several, and keep their records."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

from vopd.batch.dask import can_travel, in_cluster
from vopd.batch.folder import (
    BatchFolder,
    Records,
    SourceRecord,
    failed_record,
    remove_others,
    unchanged,
)
from vopd.batch.outputs import write_output
from vopd.batch.solve import (
    CHUNK_BYTES,
    chunks,
    even_chunk_bytes,
    in_processes,
    solve_chunk,
    taken_apart,
)
from vopd.batch.sources import BatchSettings, BatchSource


class ClusterRequest(NamedTuple):
    """A cluster of dask.distributed to solve on."""

    address: str  # of its scheduler
    shared: bool  # whether its machines read the sources and write the outputs themselves
    warn: Callable[[str], object]  # is given messages about workers that are refused


KILLED = "its process was killed each time that it was solved; is there enough memory?"


def run_batch(
    sources: Sequence[BatchSource],
    settings: BatchSettings,
    folder: BatchFolder,
    earlier: Records,
    jobs: int,
    done: Callable[[int], object],
    cluster: ClusterRequest | None = None,
) -> list[SourceRecord]:
    """Solve sources and write their outputs.

    Args:
        sources: the sources of this shard
        settings: how to solve them, and what to write
        folder: the output folder, begun
        earlier: the records of an earlier run
        jobs: the number of processes; 1 is this one
        done: is called with the number of sources that have been finished
        cluster: the cluster to solve on, in the place of this machine

    Returns:
        The record of every source, in order.

    Raises:
        OutputError: where an output cannot be written
    """
    records: Records = {}
    if cluster is None:
        solved = _solved(sources, settings, earlier, jobs)
    else:
        solved = _solved_in_cluster(sources, settings, earlier, cluster)
    for some in solved:
        if some:
            folder.keep(some)
        records.update((one.source, one) for one in some)
        done(len(some))
    return [records[one.name] for one in sources]


def _solved(
    sources: Sequence[BatchSource], settings: BatchSettings, earlier: Records, jobs: int
) -> Iterator[list[SourceRecord]]:
    chunk_bytes = CHUNK_BYTES if jobs == 1 else even_chunk_bytes(sources, jobs)
    work = partial(_work, settings)
    plan = (
        (chunk, {one.name: earlier[one.name] for one in chunk if one.name in earlier})
        for chunk in chunks(sources, chunk_bytes)
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


def _solved_in_cluster(
    sources: Sequence[BatchSource],
    settings: BatchSettings,
    earlier: Records,
    cluster: ClusterRequest,
) -> Iterator[list[SourceRecord]]:
    """Solve on a cluster; a project with files that cannot travel there is solved here."""
    kept = unchanged(sources, settings, earlier)
    names = {one.source for one in kept}
    left = [one for one in sources if one.name not in names]
    travelling = [one for one in left if cluster.shared or can_travel(one)]
    pieces = chunks(travelling)
    for chunk, answer in in_cluster(cluster.address, pieces, settings, *cluster[1:]):
        if isinstance(answer, str):
            yield [failed_record(one, settings, f"{one.path}: {answer}") for one in chunk]
            continue
        for name, content in answer.outputs.items():
            write_output(settings, name, content)
        for record in answer.records:
            remove_others(earlier.get(record.source), record, settings)
        yield answer.records
    yield kept
    for one in left:
        if one not in travelling:
            yield solve_chunk([one], settings, earlier)
