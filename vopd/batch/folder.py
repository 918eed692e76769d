"""The output folder of a batch: its lock, the journal of records, and the end of all shards.

While a batch runs, the hidden folder `.vopd-batch` has a lock, a journal and temporary
files for each shard. A record is written to the journal when all outputs of its source
have their names. The shard that ends last writes the summary and removes the hidden folder.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

from vopd.batch.folder_lock import FolderLock
from vopd.batch.source_record import SourceRecord, read_record
from vopd.batch.sources import BatchSource, Shard
from vopd.files import OutputError
from vopd.findings import VopdError
from vopd.version import __version__

HIDDEN = ".vopd-batch"
SUMMARY, TIMES = "summary.jsonl", "times.jsonl"

Records = dict[str, SourceRecord]
"""Records by the names of their sources."""


class BatchFolder:
    """The output folder, as one shard of a batch works in it."""

    def __init__(self, folder: str, shard: Shard) -> None:
        self.folder = Path(folder)
        self.shard = shard
        self._hidden = self.folder / HIDDEN
        self._name = f"{shard.number}-of-{shard.count}"
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
        others = [lock for lock in self._other_locks() if not _of_count(lock, self.shard.count)]
        for lock in others:
            if lock.held_by_another():
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
        """The records of an earlier run, if this one may go on with them."""
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
        others = journals - set(self._hidden.glob(f"*-of-{self.shard.count}.jsonl"))
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
        """All records there are; of a source that has several, that of the newest journal."""
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

        Args:
            plan: all sources of the batch, those of other shards too
            options: of this batch, as records have them
            write: writes the summary of the records

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


def _of_count(lock: FolderLock, count: int) -> bool:
    return lock.path.stem.endswith(f"-of-{count}")


def _read(file: Path) -> Iterator[SourceRecord]:
    """The records of a summary or a journal; a line that a kill has cut short is left out."""
    try:
        text = file.read_bytes().decode("utf-8", "replace")
    except FileNotFoundError:
        return
    for line in text.split("\n"):
        record = read_record(line)
        if record is not None:
            yield record


def _seconds(file: Path) -> Iterator[tuple[str, float]]:
    with suppress(OSError, ValueError, KeyError, TypeError):
        for line in file.read_text(encoding="utf-8").splitlines():
            row = json.loads(line)
            yield row["source"], row["seconds"]
