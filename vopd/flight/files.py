"""Files of a project: their text, errors with file and line, formats by content."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property
from importlib import import_module
from io import StringIO
from pathlib import Path
from reprlib import Repr
from typing import Any, Generic, NamedTuple, TextIO, TypeVar

from vopd.findings import VopdError

R = TypeVar("R")
ENCODING = "utf-8-sig"
TEXT_AT_ONCE = 20_000  # characters
UNEXPECTED = (
    ValueError, TypeError, KeyError, IndexError, AttributeError, ArithmeticError, RecursionError,
)  # fmt: skip
"""Errors that a reader of a format may end with where a value is of another kind, or size."""
SHOWN = Repr()
"""Writes the beginning of a wrong value for a message: YAML of a few lines may hold gigabytes."""
SHOWN.maxstring = SHOWN.maxother = 200  # characters
SHOWN.maxlist, SHOWN.maxlevel = 12, 2


@dataclass(frozen=True, eq=False)
class InputFile:
    """A file or a folder that a project names.

    Args:
        name: as the project has it, for messages
        path: where it is
        given: its text, where that is not read from the file
    """

    name: str
    path: Path
    given: str | None = None

    @cached_property
    def text(self) -> str:
        """All of its text; empty for a folder."""
        return "".join(self.chunks())

    @cached_property
    def head(self) -> str:
        """The first of its text, whole lines, by which most formats are recognised."""
        return next(self.chunks(), "")

    def chunks(self) -> Iterator[str]:
        """Its text, `TEXT_AT_ONCE` characters at a time and on to the end of the line.

        Raises:
            VopdError: where it is not text
        """
        if self.given is None and self.path.is_dir():
            return
        try:
            with self._open() as text:
                while chunk := text.read(TEXT_AT_ONCE):
                    yield chunk + text.readline()
        except UnicodeDecodeError as error:
            at = _first_wrong_byte(self.path, error)
            raise VopdError(f"{self.name}: not a text file in UTF-8, at byte {at}") from error

    def _open(self) -> TextIO:
        return self.path.open(encoding=ENCODING) if self.given is None else StringIO(self.given)

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
        file = InputFile(name, path)
        _ = file.head
        return file
    except ValueError as error:  # a name that no file can have
        raise VopdError(f"{name!r}: {error}") from error
    except OSError as error:
        raise VopdError(f"{name}: {error.strerror} (paths are relative to {folder})") from error


def _first_wrong_byte(path: Path, error: UnicodeDecodeError) -> int:
    """Where a file is not UTF-8; the error counts from somewhere in it."""
    try:
        path.read_bytes().decode(ENCODING)
    except UnicodeDecodeError as found:
        return found.start
    return error.start


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
                raise file.error(
                    f"not as {one.name} should be: {reason(error, repr(error))}"
                ) from error
    known = ", ".join(one.name for one in formats)
    raise file.error(f"the format is not recognised; known are {known}")


def reason(error: Exception, plain: str) -> str:
    """Explain why a parser or a reader gave up.

    Args:
        error: what it raised
        plain: the error's own text, which serves for most
    """
    if isinstance(error, RecursionError | MemoryError):
        return "lists or tables stand in each other by the hundreds"
    if isinstance(error, OverflowError):
        return "a number is too large"
    if "integer string conversion" in str(error):
        return "a whole number has thousands of digits"
    return plain


def shown(value: object) -> str:
    """Write a wrong value for a message, the beginning of it if it is long.

    Args:
        value: it, of any kind
    """
    try:
        return SHOWN.repr(value)
    except ValueError:  # the digits of a whole number that has thousands
        return "a whole number of thousands of digits"


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
