"""What an earlier run of a batch has left: sources that are solved already, and old outputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from vopd.batch.input_hash import file_sha256, input_sha256
from vopd.batch.settings import BatchSettings
from vopd.batch.source_record import FAILED, SourceRecord
from vopd.batch.sources import BatchSource


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
