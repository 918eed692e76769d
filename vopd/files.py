"""Files that appear whole or not at all, binary files by their first bytes, what parsers say."""

from __future__ import annotations

import codecs
import io
import os
import re
import stat
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any, BinaryIO, NoReturn, Protocol

from vopd.findings import VopdError
from vopd.inputs import TOO_DEEP

# -------------------------------------------------------------------------------------------------
# Write output at once to a pipe, but to a file only as a whole.
#
# A file appears under its name by one rename, when all of it has been written.
# docs/promises.md says what a file holds after any failure.

ESCAPED = "backslashreplace"
"""How bytes of names of files that are not UTF-8 are written in texts, with `str.encode`."""
TEMPORARY: set[str] = set()
"""The temporary files there are at this moment; what ends the process removes them."""


class Output(Protocol):
    """Something that output is written to."""

    def write(self, data: bytes, /) -> object:
        """Write all of `data`."""


class OutputError(VopdError):
    """An output cannot be written; a file that was there before is unchanged."""


@contextmanager
def whole_file(path: str, working: str = "") -> Iterator[Output]:
    """Open an output; a file appears under its name only when the block ends.

    The file is not touched before something is written, and not at all where
    nothing is. A block left by a `VopdError` has written all it could, and that
    appears too; on any other way out the file stays as it was.

    Args:
        path: the file; `-` is standard output; a device or a pipe is written as it is
        working: the folder of the temporary file, in the same file system, for files
            that are checked by their content afterwards: they are not synchronised to
            the disk. By default the file's own folder

    Raises:
        OutputError: where the output cannot be written
    """
    if path == "-":
        yield sys.stdout.buffer
        sys.stdout.buffer.flush()
        return
    file = _WholeFile(path, working)
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

    def __init__(self, path: str, working: str = "") -> None:
        self._path = path
        self._working = working
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
        before = file_status(self._path)
        if before is not None and not is_plain(self._path, before):
            device: BinaryIO = open(self._path, "wb")  # noqa: PTH123, SIM115 (appear closes it)
            return io.BufferedWriter(Terminal(device, "utf-8")) if device.isatty() else device
        if before is not None or os.path.islink(self._path):  # noqa: PTH114
            self._target = os.path.realpath(self._path)
        self._mode = None if before is None else stat.S_IMODE(before.st_mode)
        mode = 0o666 if self._mode is None else self._mode | stat.S_IWUSR
        folder = self._working or os.path.dirname(self._target)  # noqa: PTH120
        name = os.path.join(folder, f".vopd-{os.urandom(6).hex()}")  # noqa: PTH118
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
                if self._temporary is not None and not self._working:
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


def file_status(path: str | int) -> os.stat_result | None:
    """Ask the system for the status of a file; None where there is no such file."""
    try:
        return os.stat(path)  # noqa: PTH116
    except FileNotFoundError:
        return None


def is_plain(path: str, status: os.stat_result) -> bool:
    """Tell whether a path leads to a regular file that has a name of its own.

    A descriptor, as /dev/stdout, may be open on a file that has lost its name.
    """
    target = file_status(os.path.realpath(path))
    return stat.S_ISREG(status.st_mode) and target is not None and os.path.samestat(status, target)


# -------------------------------------------------------------------------------------------------
# What a file is that is not text, by its first bytes.

A_VIDEO = "a video"
SIGNATURES: tuple[tuple[bytes, str], ...] = (
    (b"\x89PNG\r\n", "a PNG image"),
    (b"\xff\xd8\xff", "a JPEG image"),
    (b"GIF8", "a GIF image"),
    (b"II*\x00", "a TIFF image"),
    (b"MM\x00*", "a TIFF image"),
    (b"%PDF-", "a PDF document"),
    (b"PK\x03\x04", "a zip archive or an office document"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"7z\xbc\xaf", "a 7-Zip archive"),
    (b"{\\rtf", "an RTF document"),
    (b"\xd0\xcf\x11\xe0", "an office document"),
    (b"\xff\xfe\0\0", "UTF-32 text"),
    (b"\xff\xfe", "UTF-16 text"),
    (b"\xfe\xff", "UTF-16 text"),
    (b"\x1aE\xdf\xa3", A_VIDEO),
)
"""First bytes of a file, and what it is."""
PICTURES = (b"heic", b"heix", b"mif1", b"avif")  # of the containers that videos are in too


ENDS = 1 << 24  # bytes from either end of a large file that are digested


def not_a_formula(text: str) -> str:
    """Put an apostrophe before a text that a spreadsheet would take for a formula."""
    return "'" + text if len(text) > 1 and text[0] in "=+-@" else text


def from_folder(path: str | Path, folder: Path) -> str:
    """Name a file from a folder; by its whole path where there is no way from there.

    The system takes `..` from where a link leads to, not from where it stands.
    """
    try:
        found = os.path.relpath(path, folder)
        real = os.path.realpath(folder)
        if os.path.realpath(Path(real, found)) != os.path.realpath(path):
            found = os.path.relpath(os.path.realpath(path), real)
    except ValueError:  # on another drive
        found = os.path.abspath(path)  # noqa: PTH100
    return Path(found).as_posix()


def size_and_ends(path: Path) -> Iterator[bytes]:
    """Read the size of a file and both its ends, `ENDS` bytes each, for a digest."""
    size = path.stat().st_size
    yield f"{size}\0".encode()
    with path.open("rb") as content:
        yield content.read(ENDS)
        if size > ENDS:
            content.seek(max(size - ENDS, ENDS))
            yield content.read()


def kind_by_first_bytes(start: bytes) -> str | None:
    """Recognise a file by its first bytes, such as "a PNG image"; None for an unknown signature."""
    if start[4:8] == b"ftyp":
        return "a HEIC or AVIF image" if start[8:12] in PICTURES else A_VIDEO
    if start[:4] == b"RIFF" and start[8:12] == b"AVI ":
        return A_VIDEO
    return next((kind for signature, kind in SIGNATURES if start.startswith(signature)), None)


_TEXT = r'"(?:[^"\\\n]|\\.)*"'  # of JSON
_OF_ADJUST = rf'\s*"(?:source|version)": (?:{_TEXT}|\d+),\s*"(?:frames|adjusted_from)": '
_OF_CHECK = rf'\[\s*\{{\s*"deck": {_TEXT},\s*"errors": \['
STAR_SOLUTIONS = "a file of solutions that vopd stars solve wrote"
_WRITTEN = (
    (
        rf'# program: vopd \d|\{{[^#]*?"program": "vopd \d|\{{{_OF_ADJUST}|{_OF_CHECK}',
        "a file of results that vopd wrote",
        "give the flight project NAME.toml or the deck that it was made from",
    ),
    (
        rf'\[\s*\{{(?:"image": {_TEXT}, )?"method": "|(?:image,)?method,stars,omega_deg,',
        STAR_SOLUTIONS,
        "vopd plot draws those of vopd stars solve -o NAME.json",
    ),
)
"""How files begin that vopd itself writes, what they are, and what to do with them."""


def written_by_vopd(start: str) -> tuple[str, str] | None:
    """Recognise a file that vopd wrote by its first characters: what it is, and what to do."""
    start = start.lstrip()
    known = ((what, advice) for begins, what, advice in _WRITTEN if re.match(begins, start))
    return next(known, None)


STARS = {"ra", "ra_deg", "ra_hours", "star", "hip"}
"""Columns that only a file of stars has."""
TAKES_STARS = "vopd stars solve"
"""The command that takes such a file."""


def names_stars(columns: Iterable[str]) -> bool:
    """Tell from the columns that a header names whether a file is one of stars."""
    names = {column.strip(' "').lower() for column in columns}
    return bool(names & STARS) or {"x_mm", "y_mm"} <= names


def not_utf8(start: bytes, at: int) -> str:
    """Say what a file is that is no text in UTF-8, and what to do, as the end of a sentence.

    Args:
        start: its first bytes
        at: where its first byte is that is not UTF-8
    """
    kind = kind_by_first_bytes(start)
    if kind is None:
        return f"not a text file in UTF-8, at byte {at}"
    what = "; unpack it, and name the file in it" if "archive" in kind else ""
    what = ": save it as UTF-8" if kind.endswith("text") else what
    return f"is {kind}, which is not read{what}"


# Optional packages, which an extra of this one installs

ROOT = Path(__file__).parent.parent  # the folder of the package: a clone, or that of all packages


def optional_package(module: str, extra: str, purpose: str = "") -> Any:
    """Import an optional package when it is needed.

    Args:
        module: the package, or a module of it
        extra: the extra of this package that installs it
        purpose: names what needs the package, for instance "a lens in YAML"; it may be empty

    Raises:
        VopdError: if it is not installed, with the command that installs it, or cannot be loaded
    """
    try:
        found = import_module(module)
        if getattr(found, "__file__", None) is None:  # a mere folder of that name
            raise ImportError
    except ValueError as error:  # of its own settings, as matplotlib's matplotlibrc
        name = module.partition(".")[0]
        raise VopdError(f"{name} cannot be loaded with its settings: {reason(error)}") from error
    except ImportError as error:
        package = module.partition(".")[0]
        need = f"{purpose} needs {package}, which" if purpose else package
        if str(error) and not isinstance(error, ModuleNotFoundError):  # its library, or memory
            raise VopdError(f"{need} is installed but cannot be loaded: {error}") from error
        raise VopdError(f"{need} is not installed{install_command(extra, ': ')}") from error
    return found


def install_command(extra: str, before: str = "") -> str:
    """Write the command that installs the packages of an extra, wherever this package came from.

    This package is on no registry, so `pip install 'vopd[...]'` finds nothing: the packages of
    the extra are read from the pyproject.toml of a clone, or else from the installed metadata.

    Args:
        extra: as pyproject.toml names it
        before: stands before the command; all is empty where neither file is found
    """
    import tomllib
    from importlib.metadata import PackageNotFoundError, requires

    try:
        project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
        needs = project["optional-dependencies"][extra] if project["name"] == "vopd" else None
    except (OSError, ValueError, KeyError):
        needs = None
    if needs is None:
        of_extra = re.compile(rf"extra *== *['\"]{extra}['\"]")
        try:
            needs = [need for need in requires("vopd") or () if of_extra.search(need)]
        except PackageNotFoundError:
            needs = []
    names = [found[0] for need in needs if (found := re.match(r"[\w.-]+", need))]
    return f"{before}pip install {' '.join(names)}" if names else ""


# Errors of parsers in plain words

BACKSLASH = "a backslash begins a code: write / in a path, or the text in single quotes"
PARSERS = {
    "Expecting value": "a value is missing",
    "Expecting property name enclosed in double quotes": "a name in double quotes is missing",
    "Expecting ':' delimiter": "a colon is missing",
    "Expecting ',' delimiter": "a comma is missing",
    "Illegal trailing comma before end of object": "a comma stands before the end",
    "Illegal trailing comma before end of array": "a comma stands before the end",
    "Extra data": "something follows the end",
    "Unterminated string starting at": "a text has no closing quote",
    "Invalid control character at": "a text has no closing quote on its line",
    "not well-formed (invalid token)": "a character that cannot stand there",
    "mismatched tag": "a tag ends that is not the last one begun",
    "no element found": "the end comes too early",
    "unclosed token": "a tag has no closing bracket",
    "junk after document element": "something follows the end",
    "undefined entity": "an entity is not defined",
    "duplicate attribute": "an attribute stands twice",
    "Invalid value": "not a value",
    "Invalid statement": "neither a key nor a section",
    "Invalid initial character for a key part": (
        "a key cannot begin with this character; a table in braces stands on one line"
    ),
    "Invalid hex value": BACKSLASH,
    "Unescaped '\\' in a string": BACKSLASH,
    "Escaped character is not a Unicode scalar value": BACKSLASH,
    "Unclosed inline table": "a table in braces has no closing brace on its line",
    "Expected '=' after a key in a key/value pair": "no equals sign after a key",
    "Expected newline or end of document after a statement": "something follows the value",
    "Cannot overwrite a value": "a key stands twice",
    "Unclosed array": "a list has no closing bracket",
    "Unterminated string": "a text has no closing quote",
    "Illegal character '\\n'": "a text has no closing quote on its line",
    "Expected ']' at the end of a table declaration": "a section has no closing bracket",
}
"""What Python's parsers of JSON, XML and TOML say, and the same in plain words."""

CONVERSIONS = (
    (r"could not convert string to float: (.*)", r"\1 is not a number"),
    (r".*\(could not convert string to float: (.*)\)", r"\1 is not a number"),  # of gpxpy
    (r"invalid literal for int\(\) with base 10: (.*)", r"\1 is not a whole number"),
    (r".*integer string conversion.*", "a whole number has thousands of digits"),
    (r".*Excessive depth in document.*", "elements stand in each other by the hundreds"),
    (r"field larger than field limit \((\d+)\)", r"a cell has more than \1 characters"),
    (r"too many values to unpack.*", "more values stand together than belong there"),
    (r"not enough values to unpack.*", "fewer values stand together than belong there"),
    (r"unexpected end of data", "a quoted cell has no closing quote"),
    (r"'.' expected after '\"'", "a quoted cell goes on behind its closing quote"),
    (r"embedded null (byte|character)", "a null character is in the name"),
    (r"cannot identify image file.*", "no kind of image that is known"),
    (r"malformed node or string.*", "something that is neither a number, a text nor a list"),
    (r"(.*) \(<unknown>, line (\d+)\)", r"line \2: \1"),
    (r"Cannot (declare|redefine) .*", "a section stands twice"),
    (r"Cannot mutate .*", "a table in braces is whole: write all of its keys in it"),
    (r"Duplicate inline table key (.*)", r"\1 stands twice"),
    (r"(?:Found invalid|Illegal) character (.*)", r"\1 cannot stand there"),
    (r"setting an array element with a sequence.*", "a list stands in the place of a number"),
)
"""What Python and numpy say of a value that they cannot take, as a pattern, and plain words."""

AT_END = " (at end of document)"
PLACE = r"(.*?):? \(?(?:at )?line (\d+),? column (\d+)\)?(?: \(char \d+\))?"


def reason(error: BaseException) -> str:
    """Explain in plain words why a parser or a reader gave up: where, and what is wrong."""
    if isinstance(error, RecursionError | MemoryError) and not hasattr(error, "strerror"):
        return TOO_DEEP
    if isinstance(error, OverflowError):
        return "a number is too large"
    if isinstance(error, ZeroDivisionError):
        return "a number is 0 that cannot be"
    if isinstance(error, KeyError) and error.args:
        return f"{error.args[0]} is missing"
    if isinstance(error, IndexError):
        return "a part is missing"
    if isinstance(error, TypeError | AttributeError):
        return "a value is of another kind than belongs there"
    if isinstance(error, UnicodeDecodeError):
        return "not text in UTF-8"
    if mark := getattr(error, "problem_mark", None):  # of YAML
        problem = getattr(error, "problem", None) or ""
        if "nesting depth" in problem:  # PyYAML from 6.0.4 on, which looks ahead
            return TOO_DEEP
        return f"line {mark.line + 1}, column {mark.column + 1}: {problem}"
    text = " ".join(str(getattr(error, "strerror", None) or error).split())
    if found := re.fullmatch(PLACE, text):
        what = found[1].rpartition(": ")[2]
        column = int(found[3]) + hasattr(error, "position")  # expat counts columns from 0
        return f"line {found[2]}, column {column}: {PARSERS.get(what) or _plain(found[1])}"
    if text.endswith(AT_END):
        what = text.removesuffix(AT_END)
        return f"at the end: {PARSERS.get(what, what)}"
    return _plain(text)


def _plain(text: str) -> str:
    """Replace what Python or numpy says of a value by plain words, if it is known."""
    for pattern, plain in CONVERSIONS:
        if found := re.fullmatch(pattern, text):
            return found.expand(plain)
    return text


# Terminals

TURNING = "\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"  # what follows reads right to left
UNSEEN = "\u200b\u2028\u2029\u2060\ufeff"  # nobody sees them in a name that is not found
CONTROL = rf"(?!\r\n|\A\r|\r\Z)[\x00-\x08\x0b-\x1f\x7f-\x9f{TURNING}{UNSEEN}]"
"""Control characters, but for tabs, ends of lines, and the return of a line of progress."""


def readable(text: str) -> str:
    """Write the control characters of a text as \\x1b."""
    return re.sub(CONTROL, _escape, text)


def _escape(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}"


class Terminal(io.RawIOBase):
    """Writes to a terminal; a control character, or a byte that is no text, as \\x1b."""

    def __init__(self, terminal: Any, encoding: str) -> None:
        self._terminal = terminal
        self._encoding = encoding
        self._text = codecs.getincrementaldecoder(encoding)("backslashreplace")

    def writable(self) -> bool:
        return True

    def isatty(self) -> bool:
        return True

    def fileno(self) -> int:
        return int(self._terminal.fileno())

    def close(self) -> None:
        if not self.closed:
            super().close()
            self._terminal.close()

    def write(self, data: Any, /) -> int:
        text = readable(self._text.decode(bytes(data)))
        self._terminal.write(text.encode(self._encoding, "backslashreplace"))
        self._terminal.flush()
        return len(data)
