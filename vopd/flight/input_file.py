"""Files of a project: their text, errors with file and line, formats by content."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import Any, Generic, NamedTuple, TypeVar

from vopd.findings import VopdError

R = TypeVar("R")
UNEXPECTED = (ValueError, TypeError, KeyError, IndexError, AttributeError, ArithmeticError)


class InputFile(NamedTuple):
    """A file or a folder that a project names."""

    name: str  # as the project has it, for messages
    path: Path
    text: str  # empty for a folder

    def error(self, message: str, line: int | None = None, column: str = "") -> VopdError:
        """An error about this file.

        Args:
            message: what is wrong and what to do
            line: counted from 1
            column: the name of a column or a key
        """
        where = [self.name]
        if line is not None:
            where.append(f"line {line}" + (f", column {column}" if column else ""))
        elif column:
            where.append(column)
        return VopdError(": ".join([*where, message]))


def open_input(name: str, folder: Path) -> InputFile:
    """A file of a project.

    Args:
        name: as the project has it, relative to the project's folder
        folder: the project's

    Raises:
        VopdError: where it cannot be read, or is not text
    """
    path = folder / name
    try:
        if not name.strip():
            raise VopdError("the name of a file is needed")
        if path.is_dir():
            return InputFile(name, path, "")
        return InputFile(name, path, path.read_text(encoding="utf-8-sig"))
    except UnicodeDecodeError as error:
        raise VopdError(f"{name}: not a text file in UTF-8, at byte {error.start}") from error
    except ValueError as error:  # a name that no file can have
        raise VopdError(f"{name!r}: {error}") from error
    except OSError as error:
        raise VopdError(f"{name}: {error.strerror} (paths are relative to {folder})") from error


class InputFormat(NamedTuple, Generic[R]):
    """A format of a file: one row of a table of formats."""

    name: str
    recognises: Callable[[InputFile], bool]  # by content
    read: Callable[..., R]


def read_by_content(formats: Sequence[InputFormat[R]], file: InputFile, *more: Any) -> R:
    """What the file holds, read by the first format that recognises it.

    Args:
        formats: the formats that are looked for
        file: the file
        more: further arguments of the formats' readers

    Raises:
        VopdError: where none does
    """
    for one in formats:
        if one.recognises(file):
            try:
                return one.read(file, *more)
            except UNEXPECTED as error:  # a value of another kind than the format has there
                raise file.error(f"not as {one.name} should be: {error!r}") from error
    known = ", ".join(one.name for one in formats)
    raise file.error(f"the format is not recognised; known are {known}")


def did_you_mean(word: str, known: Sequence[str]) -> str:
    """A hint for a mistyped word: `; did you mean x?`, or the words that are known."""
    near = get_close_matches(word, known, 1, 0.6)
    return f"; did you mean {near[0]}?" if near else f"; known are {', '.join(known)}"


def needed(module: str, extra: str, what: str) -> Any:
    """An optional package, imported when it is needed.

    Args:
        module: its module
        extra: the extra of this package that installs it
        what: what it is needed for

    Raises:
        VopdError: where it is not installed
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise VopdError(f"{what} needs {module}: python -m pip install 'vopd[{extra}]'") from error
