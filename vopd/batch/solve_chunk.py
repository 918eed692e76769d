"""Solve a chunk of sources, write their outputs, and make their records."""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path

from vopd.attitude.history import History
from vopd.attitude.misfit_findings import misfit_findings
from vopd.batch.input_hash import file_sha256, input_sha256
from vopd.batch.settings import LISTING, PAGE, BatchSettings, table_suffix
from vopd.batch.source_record import FAILED, SOLVED, UNCONVERGED, SourceRecord
from vopd.batch.sources import BatchSource
from vopd.export import FORMATS
from vopd.export.file_request import FileRequest, own_epoch
from vopd.findings import Finding, VopdError
from vopd.flight.flight_result import FlightResult
from vopd.listing.pages import end_of_case, pages
from vopd.pipeline import NAMES_ARE_PATHS, solve_sources
from vopd.solved import Run, SolvedJob
from vopd.whole_file import OutputError, whole_file


@dataclass
class SourceInWork:
    """A source whose jobs are coming out of the pipeline; `error` ended it early."""

    source: BatchSource
    input_sha256: str
    jobs: list[SolvedJob] = field(default_factory=list)
    flight: FlightResult | None = None
    findings: list[Finding] = field(default_factory=list)
    error: VopdError | None = None

    @property
    def parts(self) -> int:
        """The number of its histories."""
        return len(self.jobs) + (self.flight is not None)


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
        SourceInWork(one, input_sha256(locations.get(one.path, one.path)))
        for one in sources
        if one.name not in kept
    ]
    for record in _solve_or_one_by_one(waiting, settings, locations):
        remove_others(earlier.get(record.source), record, settings)
        kept[record.source] = record
    return [kept[source.name] for source in sources]


def unchanged(
    sources: Sequence[BatchSource],
    settings: BatchSettings,
    earlier: Mapping[str, SourceRecord],
) -> list[SourceRecord]:
    """The earlier records of sources that need not be solved again.

    Args:
        sources: some sources
        settings: of the batch
        earlier: records by the names of their sources
    """
    return [
        earlier[one.name]
        for one in sources
        if one.name in earlier and _still_holds(earlier[one.name], input_sha256(one.path), settings)
    ]


def _still_holds(before: SourceRecord, digest: str, settings: BatchSettings) -> bool:
    same = (before.input_sha256, before.version, before.options) == (
        *(digest, settings.version),
        settings.options,
    )
    folder = Path(settings.folder)
    return (
        same
        and before.status != FAILED
        and all(file_sha256(folder / name) == one for name, one in before.outputs.items())
    )


def remove_others(
    before: SourceRecord | None, record: SourceRecord, settings: BatchSettings
) -> None:
    """Remove outputs of an earlier run that this one has not written again.

    Args:
        before: the record of the earlier run, if there is one
        record: the new one
        settings: of the batch
    """
    for name in before.outputs if before is not None else ():
        if name not in record.outputs:
            (Path(settings.folder) / name).unlink(missing_ok=True)


def _solve_or_one_by_one(
    waiting: Sequence[SourceInWork], settings: BatchSettings, locations: Mapping[str, str]
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
    again = [SourceInWork(one.source, one.input_sha256) for one in waiting]
    return [record for one in again for record in _solve_or_one_by_one([one], settings, locations)]


def failed_record(
    source: BatchSource, settings: BatchSettings, message: str, digest: str = ""
) -> SourceRecord:
    """The record of a source of which there is nothing but an error."""
    return SourceRecord(
        source.name, source.path, FAILED, message, digest, settings.version, settings.options
    )


def _solve(
    waiting: Sequence[SourceInWork], settings: BatchSettings, locations: Mapping[str, str]
) -> list[SourceRecord]:
    start = time.perf_counter()
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
    made = iter(_histories(waiting, settings))
    records = [_written(one, list(islice(made, one.parts)), settings) for one in waiting]
    seconds = time.perf_counter() - start
    total = sum(max(record.frames, 1) for record in records)
    return [replace(one, seconds=seconds * max(one.frames, 1) / total) for one in records]


def _histories(waiting: Sequence[SourceInWork], settings: BatchSettings) -> list[History]:
    """The histories of all sources, one source after the other; all decks together."""
    rate, vertical = settings.max_rate_deg_s, settings.vertical
    jobs = [job for one in waiting for job in one.jobs]
    of_decks = iter(Run(jobs).histories(settings.sigmas, rate, vertical))
    made: list[History] = []
    for one in waiting:
        made.extend(islice(of_decks, len(one.jobs)))
        if one.flight is not None:
            made.append(one.flight.history(settings.sigmas, rate, vertical))
    return made


def _written(now: SourceInWork, histories: list[History], settings: BatchSettings) -> SourceRecord:
    """Write all outputs of a source, and make its record."""
    outputs: dict[str, str] = {}
    errors = [] if now.error is None else [str(now.error)]
    if now.jobs:
        parts = [page for job in now.jobs for page in pages(job.results)]
        listing = b"".join(parts if errors else [*parts, end_of_case()])
        _write(settings, now.source.name + LISTING, listing, outputs)
    now.findings.extend(finding for h in histories for finding in misfit_findings(h))
    if any(h.has_attitude.any() for h in histories):
        request = FileRequest(epoch=own_epoch(histories))
        for form in settings.formats:
            try:
                table = FORMATS[form].render(histories, request, now.findings.append)
            except VopdError as error:
                errors.append(f"{now.source.path}: {form}: {error}")
            else:
                _write(settings, now.source.name + table_suffix(form), table, outputs)
        if settings.report:
            page = _page(now, histories, errors, settings)
            _write(settings, now.source.name + PAGE, page, outputs)
    elif not errors:
        errors.append(f"{now.source.path}: no frame has an attitude")
    return _record(now, histories, errors, outputs, settings)


def _page(
    now: SourceInWork, histories: list[History], errors: list[str], settings: BatchSettings
) -> bytes:
    from vopd.report import report

    messages = [*map(str, now.findings), *errors]
    return report(histories, messages, settings.max_rate_deg_s, failed=bool(errors))


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
    try:
        os.makedirs(os.path.dirname(path), exist_ok=True)  # noqa: PTH103, PTH120
    except OSError as error:
        raise OutputError(f"{path}: its folder cannot be made: {error.strerror}") from error
    with whole_file(path, settings.working) as file:
        file.write(content)


def _record(
    now: SourceInWork,
    histories: list[History],
    errors: list[str],
    outputs: dict[str, str],
    settings: BatchSettings,
) -> SourceRecord:
    raised: dict[str, int] = {}
    for h in histories:
        for name, frames in h.flags.raised.items():
            raised[name] = raised.get(name, 0) + int(frames.sum())
    lost = raised.get("not_converged", 0)
    return SourceRecord(
        source=now.source.name,
        path=now.source.path,
        status=FAILED if errors else UNCONVERGED if lost else SOLVED,
        error="\n".join(errors),
        input_sha256=now.input_sha256,
        version=settings.version,
        options=settings.options,
        jobs=len(histories),
        frames=sum(len(h.status) for h in histories),
        attitudes=sum(int(h.has_attitude.sum()) for h in histories),
        not_converged=lost,
        flagged=sum(int(h.flags.any().sum()) for h in histories),
        warnings=len(now.findings),
        flags={name: count for name, count in raised.items() if count},
        outputs=outputs,
    )
