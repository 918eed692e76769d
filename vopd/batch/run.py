"""Runs of a batch: solve sources in chunks, in one process or several, and write their outputs."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import islice
from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from vopd.attitude.findings import misfit_findings
from vopd.attitude.flags import MEANING
from vopd.attitude.history import History
from vopd.batch.folder import (
    FAILED,
    SOLVED,
    UNCONVERGED,
    BatchFolder,
    Records,
    SourceRecord,
    failed_record,
    input_sha256,
    json_line,
    remove_others,
    unchanged,
)
from vopd.batch.processes import in_processes
from vopd.batch.sources import LISTING, PAGE, BatchSettings, BatchSource, table_suffix
from vopd.export import FORMATS, FileRequest, TableFile, own_epoch
from vopd.files import OutputError, whole_file
from vopd.findings import Finding, VopdError
from vopd.flight.result import FlightResult
from vopd.listing.pages import end_of_case, pages_of_jobs
from vopd.pipeline import NAMES_ARE_PATHS, solve_sources
from vopd.results import SolvedJob
from vopd.solved import histories_of_run
from vopd.version import __version__

# A source that was solved, and its listing and tables, which are made for many at once.


@dataclass
class SolvedSource:
    """What has been made of a source.

    Attributes:
        source: the source
        input_sha256: hash of its input
        jobs: solved jobs of a deck
        flight: a solved flight
        findings: all warnings
        error: what ended it early
        pages: of each job of a deck
        histories: of each job, or of the flight
        tables: by format; the error of one that cannot be made
    """

    source: BatchSource
    input_sha256: str
    jobs: list[SolvedJob] = field(default_factory=list)
    flight: FlightResult | None = None
    findings: list[Finding] = field(default_factory=list)
    error: VopdError | None = None
    pages: list[bytes] = field(default_factory=list)
    histories: list[History] = field(default_factory=list)
    tables: dict[str, bytes | VopdError] = field(default_factory=dict)

    @property
    def has_attitude(self) -> bool:
        """Tell whether any frame has an attitude."""
        return any(h.has_attitude.any() for h in self.histories)


def make_outputs(sources: Sequence[SolvedSource], settings: BatchSettings) -> None:
    """Make pages, histories and tables of sources.

    Args:
        sources: as the pipeline has solved them
        settings: what to make
    """
    jobs = [job for one in sources for job in one.jobs]
    pages = iter(pages_of_jobs([job.results for job in jobs]))
    histories = iter(histories_of_run(jobs, settings.history))
    for one in sources:
        one.pages = [b"".join(pieces) for pieces in islice(pages, len(one.jobs))]
        one.histories = list(islice(histories, len(one.jobs)))
        if one.flight is not None:
            one.histories.append(one.flight.history_parts(settings.history).whole)
        one.findings.extend(finding for h in one.histories for finding in misfit_findings(h))
    _make_tables([one for one in sources if one.has_attitude], settings)


def _make_tables(sources: Sequence[SolvedSource], settings: BatchSettings) -> None:
    for form in settings.formats:
        files = []
        for one in sources:
            request = FileRequest(epoch=own_epoch(one.histories))
            files.append(TableFile(one.histories, request, one.findings.append))
        for one, table in zip(sources, FORMATS[form].render_files(files), strict=True):
            one.tables[form] = table


# Write the outputs of a source that was solved, and make its record.


def write_source(now: SolvedSource, settings: BatchSettings) -> SourceRecord:
    """Write all outputs of a source.

    Args:
        now: the source, with its pages, histories and tables
        settings: of the batch

    Raises:
        OutputError: where an output cannot be written
    """
    outputs: dict[str, str] = {}
    errors = [] if now.error is None else [str(now.error)]
    if now.jobs:
        listing = b"".join(now.pages if errors else [*now.pages, end_of_case()])
        _write(settings, now.source.name + LISTING, listing, outputs)
    for form, table in now.tables.items():
        if isinstance(table, VopdError):
            errors.append(f"{now.source.path}: {form}: {table}")
        else:
            _write(settings, now.source.name + table_suffix(form), table, outputs)
    if now.has_attitude and settings.report:
        _write(settings, now.source.name + PAGE, _page(now, errors, settings), outputs)
    if not now.has_attitude and not errors:
        errors.append(f"{now.source.path}: no frame has an attitude")
    return _record(now, errors, outputs, settings)


def _page(now: SolvedSource, errors: list[str], settings: BatchSettings) -> bytes:
    from vopd.report import report

    messages = [*map(str, now.findings), *errors]
    return report(now.histories, messages, settings.history.max_rate_deg_s, failed=bool(errors))


def _write(settings: BatchSettings, name: str, content: bytes, outputs: dict[str, str]) -> None:
    write_output(settings, name, content)
    outputs[name] = hashlib.sha256(content).hexdigest()


def write_output(settings: BatchSettings, name: str, content: bytes) -> None:
    """Write one output whole.

    Args:
        settings: of the batch
        name: the file in the output folder, folders parted by /
        content: all of it

    Raises:
        OutputError: where it cannot be written
    """
    path = os.path.join(settings.folder, *name.split("/"))  # noqa: PTH118
    if "/" in name:
        try:
            os.makedirs(os.path.dirname(path), exist_ok=True)  # noqa: PTH103, PTH120
        except OSError as error:
            raise OutputError(f"{path}: its folder cannot be made: {error.strerror}") from error
    with whole_file(path, settings.working) as file:
        file.write(content)


def _record(
    now: SolvedSource,
    errors: list[str],
    outputs: dict[str, str],
    settings: BatchSettings,
) -> SourceRecord:
    histories = now.histories
    raised: dict[str, int] = {}
    for h in histories:
        for name, frames in h.flags.raised.items():
            raised[name] = raised.get(name, 0) + int(np.count_nonzero(frames))
    lost = raised.get("not_converged", 0)
    return SourceRecord(
        source=now.source.name,
        path=now.source.path,
        status=FAILED if errors else UNCONVERGED if lost else SOLVED,
        error="\n".join(errors),
        input_sha256=now.input_sha256,
        version=__version__,
        options=settings.options,
        jobs=len(histories),
        frames=sum(len(h.estimate.frame) for h in histories),
        attitudes=sum(int(h.has_attitude.sum()) for h in histories),
        not_converged=lost,
        flagged=sum(int(h.flags.any().sum()) for h in histories),
        warnings=len(now.findings),
        flags={name: count for name, count in raised.items() if count},
        outputs=outputs,
    )


# The summary of a batch: a row for each source, as files and as a table for a terminal.

WORST_FIRST = (FAILED, UNCONVERGED, SOLVED)
SHOWN = 20  # rows of the table for a terminal
COLUMNS = {
    "source": "name of the outputs, without their suffix",
    "path": "file of the source",
    "status": "solved, not converged (some frame) or failed",
    "error": "why it failed",
    "input_sha256": "hash of the deck, or of the project and all files that it names",
    "version": "version of vopd",
    "options": "what the outputs depend on besides the input, as JSON",
    "jobs": "jobs that were solved",
    "frames": "frames of these jobs",
    "attitudes": "frames that have an attitude",
    "not_converged": "frames that did not converge",
    "flagged": "frames that have any flag",
    "warnings": "number of warnings",
}
"""The columns of the Parquet file before those of the flags."""


def write_summary(settings: BatchSettings, records: Sequence[SourceRecord]) -> None:
    """Write `summary.jsonl`, `times.jsonl`, with pyarrow `summary.parquet`, and the page.

    Args:
        settings: of the batch
        records: of all sources, in order
    """
    files = {
        "summary.jsonl": b"".join(json_line(one.row()) for one in records),
        "times.jsonl": b"".join(
            json_line({"source": one.source, "seconds": round(one.seconds, 6)}) for one in records
        ),
    }
    parquet = _parquet(records)
    if parquet is not None:
        files["summary.parquet"] = parquet
    if settings.report:
        files["index.html"] = _summary_page(records)
    for name, content in files.items():
        with whole_file(str(Path(settings.folder) / name), settings.working) as file:
            file.write(content)


def _summary_page(records: Sequence[SourceRecord]) -> bytes:
    from vopd.report import batch_page

    rows = []
    for one in worst_first(records):
        page = one.source + PAGE
        counts = one.frames, one.attitudes, one.not_converged, one.flagged, one.warnings
        cells = one.source, one.status, *counts, _flags(one), one.error
        rows.append((page if page in one.outputs else None, cells))
    return batch_page(rows, totals(records), sum(one.status == FAILED for one in records))


def _parquet(records: Sequence[SourceRecord]) -> bytes | None:
    """Write the summary as Parquet, with a column for each flag; None without pyarrow."""
    from vopd.export import FORMATS
    from vopd.export.tables import table_file

    try:
        FORMATS["parquet"].ready()
    except VopdError:
        return None
    values: dict[str, Any] = {
        name: np.array([getattr(one, name) for one in records]) for name in COLUMNS
    }
    meanings = COLUMNS | {f"flag_{name}": f"frames with the flag {name}" for name in MEANING}
    values |= {
        f"flag_{name}": np.array([one.flags.get(name, 0) for one in records]) for name in MEANING
    }
    described = {name: {"unit": "", "meaning": meaning} for name, meaning in meanings.items()}
    return table_file(values, {"table": "a row for each source of a batch"}, described)


def worst_first(records: Sequence[SourceRecord]) -> list[SourceRecord]:
    """Sort records, the most doubtful source first; equal ones stay in their order."""
    return sorted(
        records, key=lambda one: (WORST_FIRST.index(one.status), -one.not_converged, -one.flagged)
    )


def summary_text(records: Sequence[SourceRecord]) -> str:
    """Tabulate the worst sources, with a line of totals.

    Args:
        records: of all sources
    """
    shown = worst_first(records)[:SHOWN]
    heads = ("source", "status", "frames", "attitudes", "flagged", "flags")
    rows = [heads, *(_cells(one) for one in shown)]
    wide = [max(len(row[k]) for row in rows) for k in range(len(heads))]
    lines = []
    for row in rows:
        words = [row[k].ljust(wide[k]) for k in (0, 1)]
        numbers = [row[k].rjust(wide[k]) for k in (2, 3, 4)]
        lines.append("  ".join([*words, *numbers, row[5]]).rstrip())
    more = len(records) - len(shown)
    if more:
        lines.append(f"... and {more} more, none worse than the last of these")
    lines.append(totals(records))
    return "\n".join(lines) + "\n"


def _cells(one: SourceRecord) -> tuple[str, ...]:
    counts = str(one.frames), str(one.attitudes), str(one.flagged)
    return one.source, one.status, *counts, _flags(one)


def _flags(one: SourceRecord) -> str:
    return " ".join(f"{name}:{count}" for name, count in one.flags.items())


def totals(records: Sequence[SourceRecord]) -> str:
    """Count sources, frames and attitudes in one line."""
    ended = [one.status for one in records]
    count = ", ".join(f"{ended.count(word)} {word}" for word in WORST_FIRST if word in ended)
    frames, attitudes = sum(o.frames for o in records), sum(o.attitudes for o in records)
    sources = "1 source" if len(records) == 1 else f"{len(records)} sources"
    return f"{sources}: {count}; {frames} frames, {attitudes} with an attitude"


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
    """Solve sources; one that raises an exception of the program costs no other."""
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


# Put sources together into chunks: small decks are solved together, a large one by itself.

CHUNK_BYTES = 4_000_000  # about 2,000 frames of four landmarks
CHUNK_SOURCES = 200
LEAST_CHUNKS = 4  # for each process, so that all have work to the end


def even_chunk_bytes(sources: Sequence[BatchSource], processes: int) -> float:
    """Choose the bytes of a chunk so that all processes have as many chunks of about one size.

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
    """Divide sources into chunks, in order; a flight is a chunk by itself.

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


# A run

Piece = tuple[list[BatchSource], Records]
"""A chunk, with the earlier records of its sources."""
KILLED = "its process was killed each time that it was solved; is there enough memory?"


def run_batch(
    sources: Sequence[BatchSource],
    settings: BatchSettings,
    folder: BatchFolder,
    earlier: Records,
    done: Callable[[int], object],
    *,
    jobs: int = 1,
    dask: str | None = None,
    shared: bool = False,
    warn: Callable[[str], object] = lambda _: None,
) -> list[SourceRecord]:
    """Solve sources and write their outputs.

    Args:
        sources: the sources of this shard
        settings: how to solve them, and what to write
        folder: the output folder, begun
        earlier: the records of an earlier run
        done: is called with the number of sources that have been finished
        jobs: the number of processes; 1 is this one
        dask: the address of a scheduler whose cluster solves, in the place of this machine
        shared: its machines read the sources and write the outputs themselves
        warn: is given messages about workers that are refused

    Returns:
        The record of every source, in order.

    Raises:
        OutputError: where an output cannot be written
    """
    records: Records = {}
    if dask is None:
        solved = _solved(sources, settings, earlier, jobs)
    else:
        solved = _solved_in_cluster(sources, settings, earlier, dask, shared, warn)
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
        return [([one], piece[1]) for one in piece[0]]

    def given_up(piece: Piece) -> list[SourceRecord]:
        return [failed_record(one, settings, f"{one.path}: {KILLED}") for one in piece[0]]

    yield from in_processes(work, plan, jobs, split, given_up)


def _work(settings: BatchSettings, piece: Piece) -> list[SourceRecord]:
    return solve_chunk(piece[0], settings, piece[1])


def _solved_in_cluster(
    sources: Sequence[BatchSource],
    settings: BatchSettings,
    earlier: Records,
    address: str,
    shared: bool,
    warn: Callable[[str], object],
) -> Iterator[list[SourceRecord]]:
    """Solve on a cluster; a project with files that cannot travel there is solved here."""
    from vopd.batch.dask import can_travel, in_cluster

    kept = unchanged(sources, settings, earlier)
    names = {one.source for one in kept}
    left = [one for one in sources if one.name not in names]
    travelling = [one for one in left if shared or can_travel(one)]
    pieces = chunks(travelling)
    for chunk, answer in in_cluster(address, pieces, settings, shared, warn):
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
