"""Write the outputs of a source that was solved, and make its record."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from vopd.attitude.history import History
from vopd.attitude.misfit_findings import misfit_findings
from vopd.batch.settings import LISTING, PAGE, BatchSettings, table_suffix
from vopd.batch.source_record import FAILED, SOLVED, UNCONVERGED, SourceRecord
from vopd.batch.sources import BatchSource
from vopd.export import FORMATS
from vopd.export.file_request import FileRequest, own_epoch
from vopd.findings import Finding, VopdError
from vopd.flight.flight_result import FlightResult
from vopd.listing.pages import end_of_case
from vopd.solved_job import SolvedJob
from vopd.whole_file import OutputError, whole_file


@dataclass
class SolvedSource:
    """What the pipeline has made of a source; `error` ended it early."""

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


def write_source(
    now: SolvedSource, listing: Sequence[bytes], histories: list[History], settings: BatchSettings
) -> SourceRecord:
    """Write all outputs of a source.

    Args:
        now: the source
        listing: the pages of each of its jobs
        histories: of its jobs, or of its flight
        settings: what to write

    Raises:
        OutputError: where an output cannot be written
    """
    outputs: dict[str, str] = {}
    errors = [] if now.error is None else [str(now.error)]
    if now.jobs:
        content = b"".join(listing if errors else [*listing, end_of_case()])
        _write(settings, now.source.name + LISTING, content, outputs)
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
    now: SolvedSource, histories: list[History], errors: list[str], settings: BatchSettings
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
    now: SolvedSource,
    histories: list[History],
    errors: list[str],
    outputs: dict[str, str],
    settings: BatchSettings,
) -> SourceRecord:
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
        version=settings.version,
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
