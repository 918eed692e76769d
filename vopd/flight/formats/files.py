"""Files of a flight project: their text, and errors with file and line."""

from __future__ import annotations

import codecs
import re
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from io import StringIO
from itertools import chain
from pathlib import Path
from typing import Any, TextIO
from xml.etree import ElementTree

from vopd.files import (
    A_VIDEO,
    kind_by_first_bytes,
    not_utf8,
    reason,
)
from vopd.findings import VopdError
from vopd.inputs import (
    LONGEST_LINE,
    MOST_BYTES,
    MOST_SETTINGS,
    no_file,
    parse_json,
    parse_xml,
    too_many_bytes,
)

ENCODING = "utf-8-sig"
MATLAB = b"MATLAB "  # the first bytes of a .mat
TEXT_AT_ONCE = 20_000  # characters
UNEXPECTED = (
    ValueError, TypeError, KeyError, IndexError, AttributeError, ArithmeticError, RecursionError,
)  # fmt: skip
"""Errors that a reader of a format may end with where a value is of another kind, or size."""


FIRST_BYTES = 2048
"""By which a file is recognised."""
GPSBABEL = "gpsbabel -i {} -f FILE -o gpx -F track.gpx makes GPX of it"
OF_NMEA = (  # a sentence that is known, or any with its checksum: a header may begin with $, too
    r"\s*\$(?:[A-Z]{2}(?:GGA|GLL|GNS|GSA|GST|GSV|RMC|TXT|VTG|ZDA)"
    r"|P(?:ASHR|GRM[A-Z]|MTK\d+|SRF\d+|TNL|UBX)|[A-Z]{4,6}\d*,[^\n]*\*[0-9A-Fa-f]{2}\s*?(?=\n|\Z))"
    r"(?=[,\s]|\Z)"
)
OF_XML = r"[^A-Za-z]*(?:xml[^>]*>\s*)?(?>(?:<!--.*?-->\s*)*)"  # each comment by itself alone
OF_IGC = r"A[A-Z0-9]{3}[^\n]*\n(?:[^\n]*\n){,20}?HFDTE"
MAVTOGPX = "mavtogpx.py FILE (pip install pymavlink) makes GPX of it"
LOGS = (
    (OF_NMEA, "NMEA of a receiver", GPSBABEL.format("nmea")),
    (f"{OF_IGC}(?:DATE:)?\\s*\\d{{6}}", "IGC of a glider", GPSBABEL.format("igc")),
    (r"[\x0c\x0e].{7}\.FIT", "FIT of a watch", GPSBABEL.format("garmin_fit")),
    (f"{OF_XML}<TrainingCenter", "TCX of a watch", GPSBABEL.format("gtrnctr")),
    (f"{OF_XML}<kml", "KML", GPSBABEL.format("kml")),
    (r"\xa3\x95\x80|FMT, 128, \d+, FMT,", "a log of ArduPilot", MAVTOGPX),
    (r"ULog\x01", "a log of PX4", "ulog2csv FILE (pip install pyulog) makes tables of it"),
)
"""Logs of positions: how they begin, what they are, and what makes another file of them."""

Columns = Mapping[str, str] | list[str]
"""What a project says of the columns of a CSV."""


@dataclass(frozen=True, eq=False)
class InputFile:
    """A file or a folder that a project names.

    Args:
        name: as the project has it, for messages
        path: where it is
        given: its text, where that is not read from the file
        columns: of a CSV, its own header names by the names here, or the names of all its columns
            where it has no header
        crs: that the project gives its coordinates
        clock: that it gives its times, utc or gps
        mappable: whether the project may say in `columns` what its columns are
    """

    name: str
    path: Path
    given: str | None = None
    columns: Columns | None = None
    crs: str | None = None
    clock: str | None = None
    mappable: bool = True

    @cached_property
    def text(self) -> str:
        """All of its text; empty for a folder or a video.

        Raises:
            VopdError: where it is not text, or has more than `MOST_BYTES`
        """
        if self.given is None and self.path.stat().st_size > MOST_BYTES:
            raise self.error(too_many_bytes())
        return "".join(self.chunks())

    @cached_property
    def _first_bytes(self) -> bytes:
        """Read its first bytes, by which files without text are recognised."""
        if self.given is not None or not self.path.is_file():
            return b""
        with self.path.open("rb") as file:
            return file.read(FIRST_BYTES)

    @cached_property
    def logs(self) -> dict[str, str]:
        """Recognise a log of positions that is not read: its name, with what to do about it."""
        start = self._first_bytes.decode("latin-1") or (self.given or "")[:FIRST_BYTES]
        return {
            what: f"is {what}, which is not read: {how}"
            for begins, what, how in LOGS
            if re.match(begins, start, re.DOTALL)
        }

    @property
    def is_video(self) -> bool:
        """Tell whether it is a video."""
        return kind_by_first_bytes(self._first_bytes) == A_VIDEO

    @property
    def is_matlab(self) -> bool:
        """Tell whether it is a file of MATLAB's variables, which has no text."""
        return self._first_bytes.startswith(MATLAB)

    @cached_property
    def head(self) -> str:
        """The first of its text, whole lines, by which most formats are recognised."""
        return next(self.chunks(), "")

    def chunks(self) -> Iterator[str]:
        """Read its text, `TEXT_AT_ONCE` characters at a time and on to the end of the line.

        The end of a line of more than `LONGEST_LINE` characters comes in the next piece.

        Raises:
            VopdError: where it is not text
        """
        if self.given is None and (self.path.is_dir() or self.is_video or self.is_matlab):
            return
        try:
            with self._open() as text:
                while chunk := text.read(TEXT_AT_ONCE):
                    chunk += text.readline(LONGEST_LINE)
                    if "\0" in chunk:
                        raise self._no_text("not a text file: it has null characters")
                    yield chunk
        except UnicodeDecodeError as error:
            at = _first_wrong_byte(self.path)
            raise self._no_text(not_utf8(self._first_bytes, at)) from error

    def _no_text(self, message: str) -> VopdError:
        """Make an error about a file that is not text: of a log, what makes a track of it."""
        return self.error(next(iter(self.logs.values()), message))

    def refuse_folder(self) -> None:
        """Refuse a folder in the place of a file."""
        if self.given is None and self.path.is_dir():
            raise self.error("is a folder, not a file")

    def line_of(self, word: str) -> int | None:
        """Find the first line with a word, such as a cell, counted from 1; None if none has it."""
        alone = re.compile(rf"(?<![\w./\\#-]){re.escape(word)}(?![\w.-])")
        lines = chain.from_iterable(chunk.splitlines() for chunk in self.chunks())
        return next((k for k, line in enumerate(lines, 1) if alone.search(line)), None)

    def matlab(self, *names: str) -> dict[str, Any]:
        """Read variables of a file of MATLAB's, those of these names that are there.

        Raises:
            VopdError: where it cannot be read
        """
        from vopd.flight.formats.matlab import read_variables

        if self.path.stat().st_size > MOST_SETTINGS:
            raise self.error(too_many_bytes(MOST_SETTINGS))
        data = self.path.read_bytes()
        if data[124:126] in (b"\0\2", b"\2\0"):
            raise self.error("MATLAB's format 7.3 is not read: save it with -v7")
        try:
            return read_variables(data, names)
        except (*UNEXPECTED, zlib.error) as error:
            raise self.error("a file of MATLAB's that is damaged: save it again") from error

    def json(self, advice: str = "") -> Any:
        """Parse its text as JSON.

        Args:
            advice: the end of the message where it is none

        Raises:
            VopdError: where it is none
        """
        try:
            return parse_json(self.text)
        except (ValueError, RecursionError) as error:
            raise self.error(f"not valid JSON: {reason(error)}{advice}") from error

    def xml(self) -> ElementTree.Element:
        """Parse its text as XML.

        Raises:
            VopdError: where it is none
        """
        try:
            return parse_xml(self.text)
        except (ElementTree.ParseError, ValueError) as error:
            raise self.error(f"not valid XML: {reason(error)}") from error

    def _open(self) -> TextIO:
        return self.path.open(encoding=ENCODING) if self.given is None else StringIO(self.given)

    def error(self, message: str, line: int | None = None, column: str = "") -> VopdError:
        """Make an error about this file.

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


def open_input(
    name: str,
    folder: Path,
    columns: Columns | None = None,
    crs: str | None = None,
    clock: str | None = None,
) -> InputFile:
    """Find a file of a project.

    Args:
        name: as the project has it, relative to the project's folder
        folder: the project's
        columns: what the project says of the columns of a CSV
        crs: that it gives the file's coordinates
        clock: that it gives the file's times

    Raises:
        VopdError: where it cannot be read, or is not text
    """
    path = folder / name
    try:
        if not name.strip():
            raise VopdError("the name of a file is needed")
        if kind := no_file(path):
            raise VopdError(f"{name}: {kind}")
        if path.is_dir():
            next(path.iterdir(), None)  # to see that it can be read
        file = InputFile(name, path, columns=columns, crs=crs, clock=clock)
        _ = file.head
        return file
    except OSError as error:
        raise VopdError(f"{name}: {error.strerror} (paths are relative to {folder})") from error


def _first_wrong_byte(path: Path) -> int:
    """Find the byte that is not UTF-8, from 0, the first of the file, on."""
    decoder, at = codecs.getincrementaldecoder("utf-8")(), 0
    with path.open("rb") as file:
        for block in chain(iter(lambda: file.read(1 << 20), b""), [b""]):
            kept = len(decoder.getstate()[0])
            try:
                decoder.decode(block, final=not block)
            except UnicodeDecodeError as error:
                return at - kept + error.start
            at += len(block)
    return at
