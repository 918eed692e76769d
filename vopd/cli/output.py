"""Write the output of commands: at once to a pipe, but to a file only as a whole.

A file appears under its name by one rename, when the command has ended its
work on it. docs/promises.md says what a file holds after any failure.
"""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import BinaryIO, NoReturn, Protocol

from vopd.findings import VopdError

TEMPORARY: set[str] = set()
"""The temporary files there are at this moment; what ends the process removes them."""


class Output(Protocol):
    """Something that a command writes its output to."""

    def write(self, data: bytes, /) -> object:
        """Write all of `data`."""


class OutputError(VopdError):
    """An output cannot be written; a file that was there before is unchanged."""


@contextmanager
def whole_file(path: str) -> Iterator[Output]:
    """Open an output; a file appears under its name only when the block ends.

    The file is not touched before something is written, and not at all where
    nothing is. A block left by a `VopdError` has written all it could, and that
    appears too; on any other way out the file stays as it was.

    Args:
        path: the file; `-` is standard output; a device or a pipe is written as it is

    Raises:
        OutputError: where the output cannot be written
    """
    if path == "-":
        yield sys.stdout.buffer
        sys.stdout.buffer.flush()
        return
    file = _WholeFile(path)
    try:
        yield file
    except OutputError:
        raise
    except VopdError:
        file.appear()
        raise
    except BrokenPipeError as error:  # standard output's, and this file is not complete
        raise OutputError(f"{path}: not written, because standard output was closed") from error
    else:
        file.appear()
    finally:
        file.discard()


class _WholeFile:
    """A temporary file beside its target, opened at the first write."""

    def __init__(self, path: str) -> None:
        self._path = path
        self._file: BinaryIO | None = None
        self._temporary: str | None = None
        self._target = path
        self._mode: int | None = None  # of the file that is replaced

    def write(self, data: bytes) -> None:
        try:
            if self._file is None:
                self._file = self._open()
            self._file.write(data)
        except OSError as error:
            self._fail(error)

    def _open(self) -> BinaryIO:
        before = _status(self._path)
        if before is not None and not _is_plain(self._path, before):
            return open(self._path, "wb")  # noqa: PTH123 (closed by appear or discard)
        self._target = os.path.realpath(self._path)
        self._mode = None if before is None else stat.S_IMODE(before.st_mode)
        mode = 0o666 if self._mode is None else self._mode | stat.S_IWUSR
        name = os.path.join(os.path.dirname(self._target), f".vopd-{os.urandom(6).hex()}")  # noqa: PTH118, PTH120
        TEMPORARY.add(name)  # before there is a file, so that a signal always finds it
        self._temporary = name
        return open(name, "xb", opener=lambda file, flags: os.open(file, flags, mode))

    def appear(self) -> None:
        """Close the file and give it its name; nothing happens where nothing was written."""
        file, self._file = self._file, None
        if file is None:
            return
        try:
            with file:
                file.flush()
                if self._temporary is not None:
                    os.fsync(file.fileno())
            if self._temporary is not None:
                if self._mode not in (None, stat.S_IMODE(os.stat(self._temporary).st_mode)):  # noqa: PTH116
                    os.chmod(self._temporary, self._mode or 0)  # noqa: PTH101
                os.replace(self._temporary, self._target)  # noqa: PTH105
                TEMPORARY.discard(self._temporary)
                self._temporary = None
        except OSError as error:
            self._fail(error)

    def discard(self) -> None:
        """Remove the temporary file, where there is one still."""
        if self._file is not None:
            with suppress(OSError):
                self._file.close()
            self._file = None
        if self._temporary is not None:
            with suppress(OSError):
                os.unlink(self._temporary)  # noqa: PTH108
            TEMPORARY.discard(self._temporary)
            self._temporary = None

    def _fail(self, error: OSError) -> NoReturn:
        self.discard()
        raise OutputError(f"{self._path}: cannot be written: {error.strerror}") from error


def _status(path: str | int) -> os.stat_result | None:
    """The status of a file, None where there is no such file."""
    try:
        return os.stat(path)  # noqa: PTH116
    except FileNotFoundError:
        return None


def _is_plain(path: str, status: os.stat_result) -> bool:
    """Whether a path leads to a regular file that has a name of its own.

    A descriptor, as /dev/stdout, may be open on a file that has lost its name.
    """
    target = _status(os.path.realpath(path))
    return stat.S_ISREG(status.st_mode) and target is not None and os.path.samestat(status, target)


def refuse_to_overwrite(inputs: tuple[str, ...], *outputs: str | None) -> None:
    """Check, before any work is done, that outputs can be written and overwrite no input.

    Args:
        inputs: the files that are read; `-` is standard input
        outputs: the files that will be written; `-` is standard output, None is no file

    Raises:
        OutputError: where an output is one of the inputs (by whatever name), two
            outputs are one file, or an output is a folder, is read-only, or is to
            be in a folder that does not exist or cannot be written in
    """
    taken = {key for path in inputs if (key := _identity(path, 0)) is not None}
    for output in outputs:
        if output is None:
            continue
        key = _identity(output, 1) or (output if output == "-" else None)
        if key is not None and key in taken:
            raise OutputError(f"{output}: this file is needed already; name another for the output")
        taken.add(key)
        if output != "-":
            _check_place(output)


def _identity(path: str, stream: int) -> object:
    """What tells a file from all others, None for what many may read or write at once."""
    try:
        status = _status(stream if path == "-" else path)
    except OSError:  # a closed descriptor, a loop of links
        return None
    if status is None:
        return os.path.realpath(path)
    return (status.st_dev, status.st_ino) if stat.S_ISREG(status.st_mode) else None


def _check_place(path: str) -> None:
    """Refuse what opening the file would refuse after all the work, and read-only files."""
    try:
        status = _status(path)
        folder = os.path.dirname(os.path.realpath(path))  # noqa: PTH120
        if status is None:
            os.stat(folder)  # noqa: PTH116
            if not os.path.basename(path):  # noqa: PTH119
                reason = "it names no file"
            else:
                reason = "" if os.access(folder, os.W_OK | os.X_OK) else "its folder is read-only"
        elif stat.S_ISDIR(status.st_mode):
            reason = "Is a directory"
        elif not os.access(path, os.W_OK) or not status.st_mode & 0o222:
            reason = "it is read-only"
        elif _is_plain(path, status) and not os.access(folder, os.W_OK | os.X_OK):
            reason = "its folder is read-only"
        else:
            reason = ""
    except OSError as error:
        reason = str(error.strerror)
    if reason:
        raise OutputError(f"{path}: cannot be written: {reason}")
