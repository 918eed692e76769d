"""Check, before any work is done, that a command's outputs can be written."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from vopd.files import OutputError, file_status, is_plain
from vopd.inputs import MOST_SETTINGS, named_files, no_file, read_limited


def refuse_to_overwrite(inputs: tuple[str, ...], *outputs: str | None) -> None:
    """Check, before any work is done, that outputs can be written and overwrite no input.

    Args:
        inputs: the files that are read; `-` is standard input. A project (.toml) stands for
            the files that it names, too
        outputs: the files that will be written; `-` is standard output, None is no file

    Raises:
        OutputError: where an output is one of the inputs (by whatever name), two
            outputs are one file, or an output is a folder, is read-only, or is to
            be in a folder that does not exist or cannot be written in
    """
    read = [*inputs, *(file for path in inputs for file in _files_of_project(path))]
    taken = {key for path in read if (key := _identity(path, 0)) is not None}
    for output in outputs:
        if output is None:
            continue
        key = _identity(output, 1) or (output if output == "-" else None)
        if key is not None and key in taken:
            raise OutputError(f"{output}: this file is needed already; name another for the output")
        taken.add(key)
        if output != "-":
            _check_place(output)


def _files_of_project(path: str) -> list[str]:
    """List the files that a project names, none for any other input."""
    if not path.lower().endswith(".toml"):
        return []
    try:
        if no_file(path):
            return []
        with open(path, "rb") as file:  # noqa: PTH123
            content = read_limited(file, MOST_SETTINGS)
    except (OSError, ValueError):  # reading it says why
        return []
    return [str(file) for _, file in named_files(content, Path(path).parent)]


def _identity(path: str, stream: int) -> object:
    """Identify a file among all others; None for one that many may read or write at once."""
    try:
        status = file_status(stream if path == "-" else path)
    except OSError:  # a closed descriptor, a loop of links
        return None
    if status is None:
        return os.path.realpath(path)
    return (status.st_dev, status.st_ino) if stat.S_ISREG(status.st_mode) else None


def _check_place(path: str) -> None:
    """Refuse what opening the file would refuse after all the work, and read-only files."""
    try:
        status = file_status(path)
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
        elif is_plain(path, status) and not os.access(folder, os.W_OK | os.X_OK):
            reason = "its folder is read-only"
        else:
            reason = ""
    except OSError as error:
        reason = str(error.strerror)
    if reason:
        raise OutputError(f"{path}: cannot be written: {reason}")
