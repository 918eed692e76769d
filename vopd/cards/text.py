"""The text of a deck's file: a card a line, whatever its code and its records."""

from __future__ import annotations

import re
from typing import BinaryIO

import numpy as np

from vopd.findings import VopdError
from vopd.inputs import read_limited

COLUMNS = 80
NUMBERS = r"[\d .+\-EeDd]*"  # what the two fields of a deck's first card can hold, columns 1 to 20
BYTE_ORDER_MARK = b"\xef\xbb\xbf"
EBCDIC = (
    bytes(range(256)).decode("cp037").encode("latin-1").translate(
        bytes.maketrans(b"\x85\x8e", b"\n\n")  # NEL ends a line too, and byte 0A, ASCII's LF
    )
)  # fmt: skip
"""The character of each byte in code page 037; digits and signs are those of all EBCDIC pages."""
RETURNS = bytes.maketrans(b"\r", b"\n")
DESCRIPTOR = 4  # bytes before a record of variable length: its length with them, and two zeros
START = 1 << 14  # bytes by which the code and the records are told


class CardText:
    """Reads a deck's file as ASCII, a card a line.

    EBCDIC becomes ASCII, a byte-order mark is skipped, and a file without line ends is cut into
    records of 80 bytes. In EBCDIC each record may begin with its descriptor word. Any other
    file is passed on as it is.

    Args:
        file: the deck, open for reading bytes
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._started = False
        self._table: bytes | None = None
        self._records = False
        self._described = False
        self._rest = b""

    def read(self, size: int) -> bytes:
        """Read some bytes of the text; none at its end."""
        while True:
            block = self._file.read(size)
            text = self._text_of(block)
            if text or not block:  # a few bytes at the end of a file may complete no record
                return text

    def _text_of(self, block: bytes) -> bytes:
        """Make the text of the bytes that come next; none of them stand for the file's end."""
        if not self._started:
            self._started = True
            block = block.removeprefix(BYTE_ORDER_MARK)
            self._recognise(block[:START])
        if self._described:
            block = self._without_descriptors(self._rest + block, ended=not block)
        if self._table is not None:
            block = block.translate(self._table)
        if self._records:
            block = self._lines(self._rest + block, ended=not block)
        return block

    def all(self, name: str) -> bytes:
        """Read the whole text.

        Args:
            name: the deck's name, for an error

        Raises:
            VopdError: if it has more than `MOST_BYTES`
        """
        try:
            return read_limited(self)
        except ValueError as error:
            raise VopdError(f"{name}: {error}") from error

    def _recognise(self, start: bytes) -> None:
        if is_ebcdic(start):
            self._table = EBCDIC
            self._described = _record_length(start, _record_length(start, 0)) > 0
        elif b"\n" not in start and b"\r" in start:
            self._table = RETURNS
        text = start if self._table is None else start.translate(self._table)
        first, second = (str(text[k : k + 20], "latin-1") for k in (0, COLUMNS))
        numbers = second and re.fullmatch(NUMBERS, first) and re.fullmatch(NUMBERS, second)
        self._records = bool(numbers) and b"\n" not in text and len(text) >= 2 * COLUMNS

    def _lines(self, data: bytes, *, ended: bool) -> bytes:
        """Cut data into records, each with a newline; the last may be shorter."""
        whole = len(data) // COLUMNS * COLUMNS
        self._rest = b"" if ended else data[whole:]
        records = np.frombuffer(data, np.uint8, whole).reshape(-1, COLUMNS)
        newlines = np.full((len(records), 1), ord("\n"), np.uint8)
        lines = np.concatenate([records, newlines], axis=1).tobytes()
        return lines + data[whole:] if ended else lines

    def _without_descriptors(self, data: bytes, *, ended: bool) -> bytes:
        """Cut data into records, each with an EBCDIC newline in place of its descriptor word."""
        records, begin = list[bytes](), 0
        while length := _record_length(data, begin):
            if begin + length > len(data):
                break
            records.append(data[begin + DESCRIPTOR : begin + length] + b"\x25")
            begin += length
        self._described = not ended and (length > 0 or len(data) - begin < DESCRIPTOR)
        self._rest = data[begin:] if self._described else b""
        lines = b"".join(records)
        return lines if self._described else lines + data[begin:]  # what is no record is a bad card


def _record_length(data: bytes, begin: int) -> int:
    """Read a descriptor word: a card's length with the word's own 4 bytes, or 0 for none."""
    length = int.from_bytes(data[begin : begin + 2], "big")
    zeros = data[begin + 2 : begin + DESCRIPTOR] == b"\0\0"
    return length if zeros and DESCRIPTOR <= length <= DESCRIPTOR + COLUMNS else 0


def is_ebcdic(start: bytes) -> bool:
    """Tell a deck in EBCDIC by its blanks and digits, which are most of it."""
    digits = sum(map(start.count, range(0xF0, 0xFA)))
    return digits > 0 and digits + start.count(0x40) > 0.5 * len(start)
