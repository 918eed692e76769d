"""The output folder of a batch: lock, journal of records, outputs, and the summary."""

from __future__ import annotations

import json
import os
import re
import shutil
import socket
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from vopd.attitude.flags import MEANING
from vopd.batch.sources import (
    BATCH_PAGE,
    PAGE,
    SUMMARY,
    SUMMARY_TABLE,
    TIMES,
    BatchSettings,
    BatchSource,
    file_sha256,
    input_sha256,
)
from vopd.export import FORMATS
from vopd.files import OutputError, whole_file
from vopd.findings import VopdError, count_text, one_line
from vopd.inputs import LONGEST_LINE, MOST_NUMBER, no_file
from vopd.screen import aligned
from vopd.version import __version__

# Locks, which the system frees when the process that holds one has ended

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]

FAR = 1 << 30  # Windows locks bytes, which then cannot be read; none is here
WAIT_S, EVERY_S = 60.0, 0.05


class FolderLock:
    """A lock file; it holds the process and the machine of its owner."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file: Any = None

    @property
    def held(self) -> bool:
        """Tell whether this process has taken the lock by this object."""
        return self._file is not None

    def acquire(self, wait: bool = False) -> bool:
        """Take the lock, if no living process has it.

        Raises:
            OSError: where the file cannot be made
        """
        until = time.monotonic() + (WAIT_S if wait else 0.0)
        while not self._try():
            if time.monotonic() >= until:
                return False
            time.sleep(EVERY_S)
        self._file.truncate(0)
        self._file.write(f"process {os.getpid()} on {socket.gethostname()}\n".encode())
        self._file.flush()
        return True

    def _try(self) -> bool:
        self.path.parent.mkdir(parents=True, exist_ok=True)
        file = self.path.open("ab")
        if _locked(file) and self._is_the_file(file):
            self._file = file
            return True
        file.close()
        return False

    def _is_the_file(self, file: Any) -> bool:
        """Check that the file still has its name: its owner may have removed it."""
        try:
            return os.path.samestat(os.fstat(file.fileno()), self.path.stat())
        except FileNotFoundError:
            return False

    def owner(self) -> str:
        """Name the process that has the lock, for a message."""
        with suppress(OSError):
            return self.path.read_text(encoding="utf-8").strip() or "another process"
        return "another process"

    def held_by_another(self) -> bool:
        """Tell whether a living process has the lock."""
        if not self.acquire():
            return True
        self.release()
        return False

    def release(self) -> None:
        """Remove the file and free the lock; nothing happens where it is not held."""
        file, self._file = self._file, None
        if file is None:
            return
        if os.name == "nt":  # an open file cannot be removed there
            file.close()
            with suppress(OSError):
                self.path.unlink(missing_ok=True)
            return
        self.path.unlink(missing_ok=True)
        file.close()


def _locked(file: Any) -> bool:
    try:
        if fcntl is not None:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        else:
            import msvcrt

            file.seek(FAR)
            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined,unused-ignore]
    except OSError:
        return False
    return True


# Records: how each source ended, and what was written of it

SOLVED, MISFITS, UNCONVERGED, FAILED = "solved", "misfits", "not converged", "failed"
"""How a source ended."""


MOST_MESSAGES = 20  # warnings of a source whose words are in the summary


@dataclass(frozen=True)
class SourceRecord:
    """A row of the summary."""

    source: str  # the name of its outputs
    path: str  # the file
    status: str  # solved, misfits (a flight), not converged (some frame), or failed
    error: str  # why it failed; empty where it did not
    input_sha256: str  # hash of the deck, or of the project and all files that it names
    version: str  # of this package
    options: str  # what the outputs depend on besides the input
    jobs: int = 0  # jobs that were solved
    frames: int = 0  # frames of those jobs
    attitudes: int = 0  # frames that have an attitude
    not_converged: int = 0  # frames that did not converge
    flagged: int = 0  # frames that have any flag
    warnings: int = 0  # number of warnings
    messages: list[str] = field(default_factory=list)  # the first `MOST_MESSAGES` of them
    mistaken: int = 0  # 1 where residuals or track of a flight speak for an error of its inputs
    errata: int = 0  # jobs in which errata change an angle by more than its standard deviation
    unread: int = 0  # 1 where a deck goes on behind its last job
    # frames that have each flag, of flags that any frame has
    flags: dict[str, int] = field(default_factory=dict)
    # the files that were written, in the output folder, and their hashes
    outputs: dict[str, str] = field(default_factory=dict)
    # the time that it took; of sources that are solved together, in proportion to their frames
    seconds: float = 0.0

    def row(self) -> dict[str, Any]:
        """Make the row of the summary: the seconds differ between runs, `times.jsonl` has them."""
        return {name: one for name, one in vars(self).items() if name != "seconds"}

    def line(self) -> bytes:
        """Write the whole record as one line of JSON."""
        return json_line(vars(self))


def failed_record(
    source: BatchSource, settings: BatchSettings, message: str, digest: str = ""
) -> SourceRecord:
    """Record a source of which there is nothing but an error."""
    return SourceRecord(
        source.name, source.path, FAILED, message, digest, __version__, settings.options
    )


def json_line(row: dict[str, Any]) -> bytes:
    """Write a row as one line of JSON in UTF-8."""
    return (json.dumps(row, ensure_ascii=False) + "\n").encode("utf-8", "backslashreplace")


def read_record(line: str) -> SourceRecord | None:
    """Read the record of a line; None if no batch writes it so, or it was not written to its end.

    Args:
        line: one line of a summary or of a journal, which may have come from somebody else
    """
    try:
        record = SourceRecord(**json.loads(line))
        return record if _is_sound(record) else None
    except (ValueError, TypeError, AttributeError, RecursionError):
        return None


def _is_sound(record: SourceRecord) -> bool:
    """Tell whether every value is of its kind, and outputs are named by their source.

    An output that is not written again is removed, and must not be a file of somewhere else.
    """
    values: dict[str, list[Any]] = {}
    for one in fields(SourceRecord):
        values.setdefault(str(one.type), []).append(getattr(record, one.name))
    texts = [*values["str"], *record.flags, *record.outputs, *record.outputs.values()]
    texts += record.messages
    counts = [*values["int"], *record.flags.values()]
    return (
        isinstance(record.messages, list)
        and all(isinstance(one, str) for one in texts)
        and all(type(one) is int and 0 <= one < MOST_NUMBER for one in counts)
        and 0.0 <= record.seconds < MOST_NUMBER
        and record.status in WORST_FIRST
        and all(re.fullmatch(rf"{re.escape(record.source)}\.[\w.]+", one) for one in record.outputs)
    )


# The folder, its journal, and the end of all shards
#
# While a batch runs, the hidden folder `.vopd-batch` has a lock, a journal and temporary
# files for each shard. A record is written to the journal when all outputs of its source
# have their names. The shard that ends last writes the summary and removes the hidden folder.

HIDDEN = ".vopd-batch"

Records = dict[str, SourceRecord]  # records by the names of their sources


class BatchFolder:
    """The output folder, as one shard of a batch works in it."""

    def __init__(self, folder: str, part: int = 1, parts: int = 1) -> None:
        self.folder = Path(folder)
        self._parts = parts
        self._hidden = self.folder / HIDDEN
        self._name = f"{part}-of-{parts}"
        self.working = self._hidden / self._name
        self._lock = FolderLock(self._hidden / f"{self._name}.lock")
        self._journal = self._hidden / f"{self._name}.jsonl"

    @contextmanager
    def begun(self, resume: bool, options: str) -> Iterator[Records]:
        """Hold the lock of this shard; gives the records of an earlier run.

        Args:
            resume: whether there may be an earlier run
            options: of this batch, as records have them

        Raises:
            OutputError: where the folder cannot be written in, or another batch works in it
            VopdError: where it holds another batch
        """
        if self.folder.exists() and not self.folder.is_dir():
            raise OutputError(f"{self.folder}: this is a file, not a folder")
        new = not self.folder.exists()
        try:
            records = self._begin(resume, options)
            yield records
        finally:
            self._leave()
            with suppress(OSError):  # where something is left, as the journal of another shard
                self._hidden.rmdir()
                if new:
                    self.folder.rmdir()

    def _begin(self, resume: bool, options: str) -> Records:
        try:
            with self._alone():
                self._take_lock()
                records = self._checked(resume, options)
                shutil.rmtree(self.working, ignore_errors=True)  # a killed run's temporary files
                self.working.mkdir()
                return records
        except OSError as error:
            raise OutputError(f"{self.folder}: cannot be written in: {error.strerror}") from error

    def _leave(self) -> None:
        if self._lock.held:
            shutil.rmtree(self.working, ignore_errors=True)
            self._lock.release()

    def _take_lock(self) -> None:
        for lock in self._other_locks():  # of batches that are divided otherwise
            if not lock.path.stem.endswith(f"-of-{self._parts}") and lock.held_by_another():
                raise self._busy(lock)
        if not self._lock.acquire():
            raise self._busy(self._lock)

    def _busy(self, lock: FolderLock) -> OutputError:
        return OutputError(
            f"{self.folder}: another batch is working in this folder ({lock.owner()}); "
            "wait for it, or name another folder"
        )

    def _other_locks(self) -> list[FolderLock]:
        paths = sorted(self._hidden.glob("*-of-*.lock"))
        return [FolderLock(path) for path in paths if path != self._lock.path]

    def _checked(self, resume: bool, options: str) -> Records:
        """Read the records of an earlier run, and refuse those that this one cannot go on with."""
        records = self._records()
        versions = {one.version for one in records.values()} - {__version__}
        if versions:
            raise VopdError(
                f"{self.folder}: holds a batch of vopd {versions.pop()}, and this is vopd "
                f"{__version__}; name another folder"
            )
        if resume:
            return records
        journals = set(self._hidden.glob("*-of-*.jsonl"))
        others = journals - set(self._hidden.glob(f"*-of-{self._parts}.jsonl"))
        if (self.folder / SUMMARY).exists() or self._journal.exists() or others:
            raise VopdError(
                f"{self.folder}: holds a batch already; give --resume to go on with it, "
                "or name another folder"
            )
        if any(one.options != options for one in records.values()):
            raise VopdError(
                f"{self.folder}: the other shards have other options; give all shards the same, "
                "or name another folder"
            )
        return records

    def _records(self) -> Records:
        """Read all records; of a source that has several, that of the newest journal."""
        records: Records = {}
        seconds = dict(_seconds(self.folder / TIMES))
        journals = [(path.stat().st_mtime_ns, path) for path in self._hidden.glob("*-of-*.jsonl")]
        for file in (self.folder / SUMMARY, *(path for _, path in sorted(journals))):
            for record in _read(file):
                known = seconds.get(record.source, 0.0)
                records[record.source] = replace(record, seconds=record.seconds or known)
        return records

    def keep(self, records: Sequence[SourceRecord]) -> None:
        """Write records to the journal; their outputs have been written.

        Raises:
            OutputError: where the journal cannot be written
        """
        try:
            with self._journal.open("ab") as file:
                file.write(b"\n" + b"".join(one.line() for one in records))
        except OSError as error:
            raise OutputError(f"{self._journal}: cannot be written: {error.strerror}") from error

    def finish(
        self, plan: Sequence[BatchSource], options: str, write: Callable[[list[SourceRecord]], None]
    ) -> bool:
        """Write the summary, if this shard is the last to end.

        Returns:
            Whether it was the last.
        """
        with self._alone():
            records = self._records()
            rows = [records[one.name] for one in plan if one.name in records]
            complete = len(rows) == len(plan) and all(one.options == options for one in rows)
            if not complete or any(lock.held_by_another() for lock in self._other_locks()):
                self._leave()  # so that the next to end sees that this one has
                return False
            write(rows)
            for journal in self._hidden.glob("*-of-*.jsonl"):
                journal.unlink()
            return True

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """Keep the other shards waiting while this one begins or ends."""
        lock = FolderLock(self._hidden / "lock")
        if not lock.acquire(wait=True):
            raise self._busy(lock)
        try:
            yield
        finally:
            lock.release()


def _read(file: Path) -> Iterator[SourceRecord]:
    """Read a summary or a journal; a line that a kill has cut short is left out."""
    for line in _lines(file):
        record = read_record(line)
        if record is not None:
            yield record


def _seconds(file: Path) -> Iterator[tuple[str, float]]:
    with suppress(OSError, ValueError, KeyError, TypeError, RecursionError, OutputError):
        for line in _lines(file):
            row = json.loads(line)
            if 0.0 <= row["seconds"] < MOST_NUMBER:
                yield str(row["source"]), row["seconds"]


def _lines(file: Path) -> Iterator[str]:
    """Read the lines of a file that an earlier run has written; none if there is no file.

    Raises:
        OutputError: where it is a pipe or a device
    """
    if no_file(file):
        raise OutputError(f"{file}: not a file that a batch has written; name another folder")
    try:
        with file.open("rb") as lines:
            while line := lines.readline(LONGEST_LINE):
                yield line.decode("utf-8", "replace")
    except FileNotFoundError:
        return


# Outputs: what an earlier run has left, and what this one writes


def unchanged(
    sources: Sequence[BatchSource],
    settings: BatchSettings,
    earlier: Mapping[str, SourceRecord],
) -> list[SourceRecord]:
    """Find the earlier records of sources that need not be solved again."""
    return [
        earlier[one.name]
        for one in sources
        if one.name in earlier and _still_holds(earlier[one.name], one.path, settings)
    ]


def _still_holds(before: SourceRecord, path: str, settings: BatchSettings) -> bool:
    solved_so = before.path, before.input_sha256, before.version, before.options
    folder = Path(settings.folder)
    return (
        solved_so == (path, input_sha256(path), __version__, settings.options)
        and before.status != FAILED
        and all(file_sha256(folder / name) == one for name, one in before.outputs.items())
    )


def remove_others(
    before: SourceRecord | None, record: SourceRecord, settings: BatchSettings
) -> None:
    """Remove outputs of an earlier run that this one has not written again, and its page of all."""
    if before is None:
        return
    for name in before.outputs:
        if name not in record.outputs:
            (Path(settings.folder) / name).unlink(missing_ok=True)
    if '"report"' in before.options and not settings.report:
        (Path(settings.folder) / BATCH_PAGE).unlink(missing_ok=True)


def write_output(settings: BatchSettings, name: str, content: bytes) -> None:
    """Write one output whole.

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


# The summary: a row for each source, as files and as a table for a terminal

WORST_FIRST = (FAILED, UNCONVERGED, MISFITS, SOLVED)
SHOWN = 20  # rows of the table for a terminal
COLUMNS = {
    "source": "name of the outputs, without their suffix",
    "path": "file of the source",
    "status": "solved, misfits (a flight), not converged (some frame) or failed",
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
    "messages": f"the first {MOST_MESSAGES} warnings, a line each",
    "mistaken": "1 where residuals or track of a flight speak for an error of its inputs",
    "errata": "jobs in which errata change an angle by more than its standard deviation",
    "unread": "1 where a deck goes on behind its last job",
}
"""The columns of the Parquet file before those of the flags."""


def write_summary(settings: BatchSettings, records: Sequence[SourceRecord]) -> None:
    """Write the summary, the times, with pyarrow the summary as Parquet, and the page."""
    files = {
        SUMMARY: b"".join(json_line(one.row()) for one in records),
        TIMES: b"".join(
            json_line({"source": one.source, "seconds": round(one.seconds, 6)}) for one in records
        ),
    }
    parquet, earlier = _parquet(records), Path(settings.folder) / SUMMARY_TABLE
    if parquet is not None:
        files[SUMMARY_TABLE] = parquet
    elif _is_of_a_batch(earlier):  # it would contradict the other files
        earlier.unlink()
    if settings.report:
        files[BATCH_PAGE] = _summary_page(records)
    for name, content in files.items():
        write_output(settings, name, content)


def _summary_page(records: Sequence[SourceRecord]) -> bytes:
    from vopd.report import batch_page

    rows = []
    for one in worst_first(records):
        page = one.source + PAGE
        counts = one.frames, one.attitudes, one.not_converged, one.flagged, one.warnings
        cells = one.source, one.status, *counts, _flags(one), one.error
        rows.append((page if page in one.outputs else None, cells))
    return batch_page(rows, totals(records), sum(one.status == FAILED for one in records))


STATED = {"table": "a row for each source of a batch"}
PARQUET_END = b"PAR1"  # behind four bytes for the length of what describes the columns


def _is_of_a_batch(file: Path) -> bool:
    """Tell whether a Parquet file is the summary of a batch; without pyarrow, which has gone."""
    if not file.is_file():
        return False
    with suppress(OSError), file.open("rb") as content:
        size = content.seek(0, os.SEEK_END)
        content.seek(size - 8)  # an error before the beginning
        end = content.read()
        content.seek(size - 8 - int.from_bytes(end[:4], "little"))
        return end[4:] == PARQUET_END and json.dumps(STATED).encode() in content.read()
    return False


def _parquet(records: Sequence[SourceRecord]) -> bytes | None:
    """Write the summary as Parquet, with a column for each flag; None without pyarrow."""
    from vopd.export.tables import table_file

    try:
        FORMATS["parquet"].ready()
    except VopdError:
        return None
    values: dict[str, Any] = {
        name: np.array([getattr(one, name) for one in records])
        for name in COLUMNS
        if name != "messages"
    }
    values["messages"] = np.array(["\n".join(one.messages) for one in records])
    values = {name: values[name] for name in COLUMNS}
    meanings = COLUMNS | {f"flag_{name}": f"frames with the flag {name}" for name in MEANING}
    values |= {
        f"flag_{name}": np.array([one.flags.get(name, 0) for one in records]) for name in MEANING
    }
    described = {name: {"unit": "", "meaning": meaning} for name, meaning in meanings.items()}
    return table_file(values, STATED, described)


def worst_first(records: Sequence[SourceRecord]) -> list[SourceRecord]:
    """Sort records, the most doubtful source first; equal ones stay in their order."""
    return sorted(
        records, key=lambda one: (WORST_FIRST.index(one.status), -one.not_converged, -one.flagged)
    )


def summary_text(records: Sequence[SourceRecord]) -> str:
    """Tabulate the worst sources, with a line of totals."""
    shown = worst_first(records)[:SHOWN]
    heads = ("source", "status", "frames", "attitudes", "flagged", "flags")
    rows = [heads, *(_cells(one) for one in shown)]
    lines = aligned(rows, {0, 1, 5})
    more = len(records) - len(shown)
    if more:
        lines.append(f"... and {more} more, none worse than the last of these")
    lines.append(totals(records))
    return "\n".join(lines) + "\n"


def _cells(one: SourceRecord) -> tuple[str, ...]:
    counts = str(one.frames), str(one.attitudes), str(one.flagged)
    return one_line(one.source), one.status, *counts, _flags(one)


def _flags(one: SourceRecord) -> str:
    return " ".join(f"{name}:{count}" for name, count in one.flags.items())


def totals(records: Sequence[SourceRecord]) -> str:
    """Count sources, frames and attitudes in one line."""
    ended = [one.status for one in records]
    count = ", ".join(f"{ended.count(word)} {word}" for word in WORST_FIRST if word in ended)
    frames, attitudes = sum(o.frames for o in records), sum(o.attitudes for o in records)
    sources = count_text(len(records), "source")
    return f"{sources}: {count}; {count_text(frames, 'frame')}, {attitudes} with an attitude"
