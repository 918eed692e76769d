"""Where a command's output goes: to a pipe as it comes, to a file whole."""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO

from vopd.findings import VopdError

if TYPE_CHECKING:
    from pathlib import Path


@contextmanager
def whole_file(path: str) -> Iterator[BinaryIO]:
    """A file to write that appears under its name by one rename when the block ends.

    `-` is standard output, and what is no regular file (a device, a pipe) is
    written as it is. A block left by a `VopdError` has said all it could, and
    the file appears too; on any other way out it does not. Raises `VopdError`
    where the place cannot be written.
    """
    if path == "-":
        yield sys.stdout.buffer
        sys.stdout.buffer.flush()
    else:
        with _appearing(path) as file:
            yield file


@contextmanager
def _appearing(path: str) -> Iterator[BinaryIO]:
    import tempfile  # slow to import, and standard output does without
    from pathlib import Path

    target = Path(os.path.realpath(path))
    try:
        if target.exists() and not stat.S_ISREG(target.stat().st_mode):
            with target.open("wb") as file:
                yield file
            return
        handle, name = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent)
    except OSError as error:
        raise VopdError(f"{path}: cannot be written: {error.strerror}") from error
    try:
        with os.fdopen(handle, "wb") as file:
            try:
                yield file
            except VopdError:
                _appear(file, name, target)
                raise
            _appear(file, name, target)
    except OSError as error:
        raise VopdError(f"{path}: cannot be written: {error.strerror}") from error
    finally:
        Path(name).unlink(missing_ok=True)


def _appear(file: BinaryIO, name: str, target: Path) -> None:
    file.flush()
    umask = os.umask(0)
    os.umask(umask)
    mode = stat.S_IMODE(target.stat().st_mode) if target.exists() else 0o666 & ~umask
    os.chmod(name, mode)  # noqa: PTH101
    os.replace(name, target)  # noqa: PTH105


def refuse_to_overwrite(inputs: tuple[str, ...], *outputs: str | None) -> None:
    """Raise `VopdError` where an output is one of the inputs, or both outputs are one file."""
    taken = {os.path.realpath(path) for path in inputs if path != "-"}
    for output in outputs:
        if output is None:
            continue
        place = os.path.realpath(output) if output != "-" else output
        if place in taken:
            raise VopdError(f"{output}: this file is needed already; name another for the output")
        if output == "-" or os.path.isfile(place) or not os.path.exists(place):  # noqa: PTH110, PTH113
            taken.add(place)
