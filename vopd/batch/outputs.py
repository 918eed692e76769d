"""The summary of a batch: a row for each source, as files and as a table for a terminal."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vopd.attitude.flags import MEANING
from vopd.batch.settings import PAGE, BatchSettings
from vopd.batch.source_record import FAILED, SOLVED, UNCONVERGED, SourceRecord, json_line
from vopd.files import whole_file
from vopd.findings import VopdError

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
        files["index.html"] = _page(records)
    for name, content in files.items():
        with whole_file(str(Path(settings.folder) / name), settings.working) as file:
            file.write(content)


def _page(records: Sequence[SourceRecord]) -> bytes:
    from vopd.report.batch_page import batch_page, source_row

    rows = []
    for one in worst_first(records):
        page = one.source + PAGE
        counts = one.frames, one.attitudes, one.not_converged, one.flagged, one.warnings
        words = _flags(one), one.error
        found = page if page in one.outputs else None
        rows.append(source_row(one.source, found, one.status, *counts, *words))
    failed = sum(one.status == FAILED for one in records)
    return batch_page(rows, totals(records), failed)


def _parquet(records: Sequence[SourceRecord]) -> bytes | None:
    """The summary as Parquet, with a column for each flag; None without pyarrow."""
    from vopd.export import FORMATS
    from vopd.export.parquet import table_file

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
    """Records in the order of how doubtful their sources are; alike ones stay as they are."""
    return sorted(
        records, key=lambda one: (WORST_FIRST.index(one.status), -one.not_converged, -one.flagged)
    )


def summary_text(records: Sequence[SourceRecord]) -> str:
    """A table of the worst sources, and a line with the totals.

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
    """How many sources, frames and attitudes there are, in one line."""
    ended = [one.status for one in records]
    count = ", ".join(f"{ended.count(word)} {word}" for word in WORST_FIRST if word in ended)
    frames, attitudes = sum(o.frames for o in records), sum(o.attitudes for o in records)
    sources = "1 source" if len(records) == 1 else f"{len(records)} sources"
    return f"{sources}: {count}; {frames} frames, {attitudes} with an attitude"
