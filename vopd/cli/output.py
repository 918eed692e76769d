"""Check, before any work is done, that a command's outputs can be written."""

from __future__ import annotations

import json
import os
import re
import stat
from pathlib import Path

from vopd.files import OutputError, file_status, is_plain
from vopd.inputs import MOST_BYTES, MOST_SETTINGS, no_file, read_limited


def refuse_to_overwrite(inputs: tuple[str, ...], *outputs: str | None) -> None:
    """Check, before any work is done, that outputs can be written and overwrite no input.

    Args:
        inputs: the files that are read; `-` is standard input. A project (.toml) and star
            solutions (.json) stand for the files that they name, too, a folder for its images,
            and any for the photographs that it or one of its files names
        outputs: the files that will be written; `-` is standard output, None is no file

    Raises:
        OutputError: where an output is one of the inputs (by whatever name), two
            outputs are one file, or an output is a folder, is read-only, or is to
            be in a folder that does not exist or cannot be written in
    """
    files = {path: _files_of(path) for path in inputs}
    read = [*inputs, *(file for named in files.values() for file in named)]
    taken = {key for path in read if (key := _identity(path, 0)) is not None}
    for output in outputs:
        if output is None:
            continue
        key = _identity(output, 1) or (output if output == "-" else None)
        if (key is not None and key in taken) or _is_photograph(output, files):
            raise OutputError(f"{output}: this file is needed already; name another for the output")
        taken.add(key)
        if output != "-":
            _check_place(output)


def _files_of(path: str) -> list[str]:
    """List the images of a folder, and the files that a project or star solutions name."""
    if os.path.isdir(path):  # noqa: PTH112
        from vopd.video import stills_in

        try:
            return [str(one) for one in stills_in(Path(path))]
        except OSError:  # reading it says why
            return []
    if path.lower().endswith(".toml"):
        from vopd.flight.project.named import named_files

        content = _content(path, MOST_SETTINGS)
        return [str(file) for _, file in named_files(content, Path(path).parent)]
    if path.lower().endswith(".json"):
        return [json.loads(one) for one in set(SOURCE.findall(_content(path)))]
    return []


SOURCE = re.compile(rb'"source": ("(?:[^"\\\n]|\\["\\/bfnrt])*")')  # of star solutions


def _content(path: str, most: int = MOST_BYTES) -> bytes:
    """Read a file; nothing of one that cannot be read, of which reading it later says why."""
    try:
        if no_file(path):
            return b""
        with open(path, "rb") as file:  # noqa: PTH123
            return read_limited(file, most)
    except (OSError, ValueError):
        return b""


def _is_photograph(output: str, inputs: dict[str, list[str]]) -> bool:
    """Tell whether an output is a photograph that an input names, where a command looks for it.

    Args:
        output: its name
        inputs: the files of each
    """
    if not os.path.isfile(output):  # noqa: PTH113
        return False
    from vopd.flight.formats.photographs import image_file, image_places
    from vopd.video import STILLS

    name = os.path.basename(os.path.realpath(output))  # noqa: PTH119
    if Path(name).suffix.lower() not in STILLS:
        return False
    spelled = b"|".join(re.escape(os.fsencode(one)) for one in (name, json.dumps(name)[1:-1]))
    word = re.compile(rb"(?<![\w.-])(?:%s)(?![\w.-])" % spelled)
    given = [Path(path) for path in inputs if os.path.isdir(path)]  # noqa: PTH112
    for path, files in inputs.items():
        folders = [*given, *(Path(one).parent for one in (*reversed(files), path))]
        found = image_file(image_places(folders), name)
        if found is None or _identity(str(found), 0) != _identity(output, 1):
            continue
        own = () if path.lower().endswith(".toml") else (path,)  # its comments name figures
        texts = (one for one in (*own, *files) if Path(one).suffix.lower() not in STILLS)
        if any(word.search(_content(one)) for one in texts):
            return True
    return False


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
