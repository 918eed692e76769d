"""The record of one source of a batch: what was solved, how it ended, and what was written."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any

from vopd.batch.settings import BatchSettings
from vopd.batch.sources import BatchSource

SOLVED, UNCONVERGED, FAILED = "solved", "not converged", "failed"
"""How a source ended."""
NOT_IN_SUMMARY = ("seconds",)
"""What differs between runs that give the same files; `times.jsonl` has it."""


@dataclass(frozen=True)
class SourceRecord:
    """A row of the summary.

    Attributes:
        source: the name of its outputs
        path: the file
        status: solved, not converged (some frame), or failed
        error: why it failed; empty where it did not
        input_sha256: hash of the deck, or of the project and all files that it names
        version: of this package
        options: what the outputs depend on besides the input
        jobs: jobs that were solved
        frames: frames of those jobs
        attitudes: frames that have an attitude
        not_converged: frames that did not converge
        flagged: frames that have any flag
        warnings: number of warnings
        flags: frames that have each flag, of flags that any frame has
        outputs: the files that were written, in the output folder, and their hashes
        seconds: the time that it took; of sources that are solved together, in proportion
            to their frames
    """

    source: str
    path: str
    status: str
    error: str
    input_sha256: str
    version: str
    options: str
    jobs: int = 0
    frames: int = 0
    attitudes: int = 0
    not_converged: int = 0
    flagged: int = 0
    warnings: int = 0
    flags: dict[str, int] = field(default_factory=dict)
    outputs: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0

    def row(self) -> dict[str, Any]:
        """The record as it stands in the summary, without what differs between runs."""
        return {name: one for name, one in vars(self).items() if name not in NOT_IN_SUMMARY}

    def line(self) -> bytes:
        """The whole record as one line of JSON."""
        return json_line(vars(self))


def failed_record(
    source: BatchSource, settings: BatchSettings, message: str, digest: str = ""
) -> SourceRecord:
    """The record of a source of which there is nothing but an error.

    Args:
        source: the source
        settings: of the batch
        message: the error
        digest: the hash of the input, where it was read
    """
    return SourceRecord(
        source.name, source.path, FAILED, message, digest, settings.version, settings.options
    )


def json_line(row: dict[str, Any]) -> bytes:
    """A row as one line of JSON in UTF-8."""
    return (json.dumps(row, ensure_ascii=False) + "\n").encode("utf-8", "backslashreplace")


def read_record(line: str) -> SourceRecord | None:
    """The record of a line; None for a line that was not written to its end, or is another.

    Args:
        line: one line of a summary or of a journal
    """
    try:
        return SourceRecord(**json.loads(line))
    except (ValueError, TypeError):
        return None
