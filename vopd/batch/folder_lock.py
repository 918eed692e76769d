"""Locks in an output folder, which the system frees when the process that holds one has ended."""

from __future__ import annotations

import os
import socket
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

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
        """Whether this process has taken the lock by this object."""
        return self._file is not None

    def acquire(self, wait: bool = False) -> bool:
        """Take the lock, if no living process has it.

        Args:
            wait: wait a minute for it

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
        """Whether the file is still there under its name: its owner may have removed it."""
        try:
            return os.path.samestat(os.fstat(file.fileno()), self.path.stat())
        except FileNotFoundError:
            return False

    def owner(self) -> str:
        """The process that has the lock, for a message."""
        with suppress(OSError):
            return self.path.read_text(encoding="utf-8").strip() or "another process"
        return "another process"

    def held_by_another(self) -> bool:
        """Whether a living process has the lock."""
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
