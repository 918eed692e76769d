"""The lock of an output folder: who has it, and who waits for it."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from vopd.batch import folder as folder_lock
from vopd.batch.folder import FolderLock

Locks = tuple[FolderLock, FolderLock]


@pytest.fixture
def two(tmp_path: Path) -> Iterator[Locks]:
    """The same lock twice: each opens the file anew, so that one process stands for two."""
    first, second = FolderLock(tmp_path / "lock"), FolderLock(tmp_path / "lock")
    yield first, second
    first.release()
    second.release()


@pytest.fixture
def naps(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """The clock stands still but for naps, which are noted and take no time."""
    slept: list[float] = []
    monkeypatch.setattr(time, "sleep", slept.append)
    monkeypatch.setattr(time, "monotonic", lambda: 1000.0 + sum(slept))
    return slept


def test_a_lock_that_is_held_is_refused_at_once(two: Locks, naps: list[float]) -> None:
    first, second = two
    assert first.acquire() and first.held
    assert not second.acquire() and not second.held
    assert second.held_by_another() and naps == []


def test_a_wait_ends_after_a_minute(two: Locks, naps: list[float]) -> None:
    first, second = two
    assert first.acquire()
    assert not second.acquire(wait=True) and not second.held
    assert 60.0 <= sum(naps) < 61.0


def test_a_wait_ends_when_the_lock_is_free(two: Locks, monkeypatch: pytest.MonkeyPatch) -> None:
    first, second = two
    assert first.acquire()
    monkeypatch.setattr(time, "sleep", lambda _: first.release())
    assert second.acquire(wait=True) and second.held and not first.held


def test_the_owner_is_named_and_nothing_is_left_behind(tmp_path: Path) -> None:
    lock, other = FolderLock(tmp_path / "new" / "lock"), FolderLock(tmp_path / "new" / "lock")
    assert lock.acquire()
    assert other.owner().startswith(f"process {os.getpid()} on ")
    lock.release()
    assert not lock.held and not lock.path.exists()
    assert not other.held_by_another() and not lock.path.exists()
    assert other.owner() == "another process"
    lock.release()  # a second time does nothing


@pytest.mark.parametrize("again", [False, True])
def test_a_file_that_its_owner_has_removed_is_no_lock(
    again: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Between opening and locking it; a third process may have made it again by then."""
    lock, locked, removed = FolderLock(tmp_path / "lock"), folder_lock._locked, []

    def late(file: object) -> bool:
        if not removed:
            removed.append(lock.path)
            lock.path.unlink()
            if again:
                lock.path.write_text("another's")
        return locked(file)

    monkeypatch.setattr(folder_lock, "_locked", late)
    assert not lock.acquire() and not lock.held and removed
    assert lock.acquire() and lock.held and lock.path.exists()
    lock.release()
    assert not lock.path.exists()
