"""Write the outputs of a source that was solved, and make its record."""

from __future__ import annotations

import hashlib
import os

import numpy as np

from vopd.batch.settings import LISTING, PAGE, BatchSettings, table_suffix
from vopd.batch.solved_source import SolvedSource
from vopd.batch.source_record import FAILED, SOLVED, UNCONVERGED, SourceRecord
from vopd.files import OutputError, whole_file
from vopd.findings import VopdError
from vopd.listing.pages import end_of_case


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
    return report(now.histories, messages, settings.max_rate_deg_s, failed=bool(errors))


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
