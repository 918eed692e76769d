"""Solve a chunk of sources together, and write the outputs of each."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace

from vopd.batch.earlier_records import remove_others, unchanged
from vopd.batch.input_hash import input_sha256
from vopd.batch.settings import BatchSettings
from vopd.batch.solved_source import SolvedSource, make_outputs
from vopd.batch.source_outputs import write_source
from vopd.batch.source_record import SourceRecord, failed_record
from vopd.batch.sources import BatchSource
from vopd.files import OutputError
from vopd.findings import VopdError
from vopd.flight.result import FlightResult
from vopd.pipeline import NAMES_ARE_PATHS, solve_sources
from vopd.results import SolvedJob


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
