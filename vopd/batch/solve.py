"""A chunk of a batch: solve its sources together, and write the outputs of each."""

from __future__ import annotations

import hashlib
import os
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import PurePath

import numpy as np

from vopd.attitude.findings import findings_of, summary_of
from vopd.attitude.history import History
from vopd.batch.folder import (
    FAILED,
    MISFITS,
    MOST_MESSAGES,
    SOLVED,
    UNCONVERGED,
    SourceRecord,
    failed_record,
    write_output,
)
from vopd.batch.sources import (
    LISTING,
    PAGE,
    BatchSettings,
    BatchSource,
    input_sha256,
    table_suffix,
)
from vopd.export import FORMATS, FileRequest, own_epoch
from vopd.files import OutputError
from vopd.findings import Finding, VopdError, findings_in
from vopd.flight.result import FlightResult, unused_options
from vopd.inputs import no_file
from vopd.job import goes_on
from vopd.listing.pages import end_of_case, pages_of_jobs
from vopd.pipeline import NAMES_ARE_PATHS, is_flight, solve_sources
from vopd.results import SolvedJob
from vopd.solved import histories_of_run
from vopd.version import __version__


def solve_chunk(
    sources: Sequence[BatchSource],
    settings: BatchSettings,
    locations: Mapping[str, str] = NAMES_ARE_PATHS,
) -> list[SourceRecord]:
    """Solve sources together and write their outputs; one that fails costs no other.

    Args:
        sources: some sources of the batch
        settings: how to solve them, and what to write
        locations: where files are that are not under the paths of their sources

    Returns:
        The record of every source, in order.

    Raises:
        OutputError: where an output cannot be written
    """
    digests = [input_sha256(locations.get(one.path, one.path)) for one in sources]
    try:
        for one in sources:
            if kind := no_file(locations.get(one.path, one.path)):
                raise VopdError(kind)
        return _solve(sources, digests, settings, locations)
    except OutputError:
        raise
    except Exception as error:
        if len(sources) == 1:
            path = sources[0].path
            known = isinstance(error, VopdError)
            what = str(error) if known else f"error in the program: {type(error).__name__}: {error}"
            return [failed_record(sources[0], settings, f"{path}: {what}", digests[0])]
    return [record for one in sources for record in solve_chunk([one], settings, locations)]


@dataclass
class SolvedSource:
    """What has been made of a source."""

    source: BatchSource  # the source
    input_sha256: str  # hash of its input
    jobs: list[SolvedJob] = field(default_factory=list)  # solved jobs of a deck
    flight: FlightResult | None = None  # a solved flight
    findings: list[Finding] = field(default_factory=list)  # all warnings
    error: VopdError | None = None  # what ended it early
    listing: bytes = b""  # of a deck
    histories: list[History] = field(default_factory=list)  # of each job, or of the flight
    # by format; the error of one that cannot be made
    tables: dict[str, bytes | VopdError] = field(default_factory=dict)
    errata: int = 0  # jobs in which errata change an angle by more than its standard deviation

    @property
    def has_attitude(self) -> bool:
        """Tell whether any frame has an attitude."""
        return any(h.has_attitude.any() for h in self.histories)


def _solve(
    sources: Sequence[BatchSource],
    digests: Sequence[str],
    settings: BatchSettings,
    locations: Mapping[str, str],
) -> list[SourceRecord]:
    """Solve sources, make and write all their outputs, and share the time by their frames."""
    start = time.perf_counter()
    solved = [SolvedSource(*one) for one in zip(sources, digests, strict=True)]
    ended = 0
    paths, sigmas = [one.path for one in sources], settings.history.sigmas
    for one in solve_sources(paths, settings.solve, locations, sigmas):
        now = solved[ended]
        now.findings.extend(one.findings)
        if isinstance(one, SolvedJob):
            now.jobs.append(one)
        elif isinstance(one, FlightResult):
            now.flight = one
        else:  # the end of a source
            now.error = one.error
            ended += 1
    make_outputs(solved, settings)
    records = [write_source(one, settings) for one in solved]
    seconds = time.perf_counter() - start
    total = sum(max(record.frames, 1) for record in records)
    return [replace(one, seconds=seconds * max(one.frames, 1) / total) for one in records]


def make_outputs(sources: Sequence[SolvedSource], settings: BatchSettings) -> None:
    """Make listings, histories and tables of sources, each for all of them at once."""
    jobs = [job for one in sources for job in one.jobs]
    pages = iter(pages_of_jobs([job.results for job in jobs]))
    histories = iter(histories_of_run(jobs, settings.history))
    for one in sources:
        if one.jobs:
            of_jobs = [b"".join(pieces) for pieces in islice(pages, len(one.jobs))]
            one.listing = b"".join(of_jobs if one.error else [*of_jobs, end_of_case()])
        one.histories = list(islice(histories, len(one.jobs)))
        if one.flight is not None:
            one.findings.extend(unused_options(one.flight, settings.history))
            one.histories.append(one.flight.history_parts(settings.history).whole)
        for h in one.histories:
            summary = summary_of([h])
            one.findings.extend(findings_of(h.about, summary))
            one.errata += summary.errata > 0
    with_tables = [one for one in sources if one.has_attitude]
    for form in settings.formats:
        files = [
            (one.histories, FileRequest(epoch=own_epoch(one.histories)), one.findings.append)
            for one in with_tables
        ]
        for one, table in zip(with_tables, FORMATS[form].render_files(files), strict=True):
            one.tables[form] = table


MOST_NAME_BYTES = 255  # of a file, in the file systems of Linux and macOS


def write_source(now: SolvedSource, settings: BatchSettings) -> SourceRecord:
    """Write all outputs of a source, and count its frames.

    Raises:
        OutputError: where an output cannot be written
    """
    name, histories = now.source.name, now.histories
    errors = [] if now.error is None else [str(now.error)]
    if now.error is not None and is_flight(now.source.path):  # one in a file that it names
        errors = [*map(str, findings_in(now.error, now.source.path))]
    contents = {name + LISTING: now.listing} if now.jobs else {}
    for form, table in now.tables.items():
        if isinstance(table, VopdError):
            errors.append(f"{now.source.path}: {form}: {table}")
        else:
            contents[name + table_suffix(form)] = table
    raised: Counter[str] = Counter()
    for h in histories:
        raised.update({flag: int(np.sum(frames)) for flag, frames in h.flags.raised.items()})
    misfits = now.flight is not None and now.flight.misfits
    mistaken = now.flight is not None and now.flight.mistaken
    doubtful = bool(errors or misfits or mistaken or +raised)
    if now.has_attitude and (settings.report == "all" or (settings.report and doubtful)):
        from vopd.report import report

        messages = [*map(str, now.findings), *errors]
        rate = settings.history.max_rate_deg_s
        contents[name + PAGE] = report(histories, messages, rate, failed=bool(errors))
    if not now.has_attitude and not errors:
        errors.append(f"{now.source.path}: no frame has an attitude")
    for file in [*contents]:
        if (size := len(os.fsencode(PurePath(file).name))) > MOST_NAME_BYTES:
            del contents[file]
            errors.append(
                f"{now.source.path}: the name of its output {PurePath(file).suffix} would have "
                f"{size} bytes, and that of a file has {MOST_NAME_BYTES} at most; rename it"
            )
    for file, content in contents.items():
        write_output(settings, file, content)
    lost = raised["not_converged"]
    return SourceRecord(
        source=name,
        path=now.source.path,
        status=FAILED if errors else UNCONVERGED if lost else MISFITS if misfits else SOLVED,
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
        messages=[one.headline() for one in now.findings[:MOST_MESSAGES]],
        mistaken=int(mistaken),
        errata=now.errata,
        unread=int(goes_on(now.findings)),
        flags={flag: count for flag, count in raised.items() if count},
        outputs={file: hashlib.sha256(one).hexdigest() for file, one in contents.items()},
    )
