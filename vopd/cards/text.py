"""The text of a deck's file: a card a line, whatever its code and its records."""

from __future__ import annotations

import re
from typing import BinaryIO

import numpy as np

COLUMNS = 80
NUMBERS = r"[\d .+\-EeDd]*"
"""What the two fields of a deck's first card can hold, columns 1 to 20."""

BYTE_ORDER_MARK = b"\xef\xbb\xbf"
EBCDIC = (
    bytes(range(256)).decode("cp037").encode("latin-1").translate(
        bytes.maketrans(b"\x85", b"\n")  # NEL ends a line too
    )
)  # fmt: skip
"""The character of each byte in code page 037; digits and signs are those of all EBCDIC pages."""
RETURNS = bytes.maketrans(b"\r", b"\n")
START = 1 << 14  # bytes by which the code and the records are told


class CardText:
    """Reads a deck's file as ASCII, a card a line.

    EBCDIC becomes ASCII, a byte-order mark is skipped, and a file without line ends is cut into
    records of 80 bytes. Any other file is passed on as it is.

    Args:
        file: the deck, open for reading bytes
    """

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._started = False
        self._table: bytes | None = None
        self._records = False
        self._rest = b""

    def read(self, size: int) -> bytes:
        """Read some bytes of the text; none at its end.

        Args:
            size: how many bytes of the file are read
        """
        block = self._file.read(size)
        if not self._started:
            self._started = True
            block = block.removeprefix(BYTE_ORDER_MARK)
            self._recognise(block[:START])
        if self._table is not None:
            block = block.translate(self._table)
        if self._records:
            block = self._lines(self._rest + block, ended=not block)
        return block

    def all(self) -> bytes:
        """Read the whole text."""
        return b"".join(iter(lambda: self.read(START), b""))

    def _recognise(self, start: bytes) -> None:
        if is_ebcdic(start):
            self._table = EBCDIC
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


def is_ebcdic(start: bytes) -> bool:
    """Tell a deck in EBCDIC by its blanks and digits, which are most of it.

    Args:
        start: the first bytes of the file
    """
    digits = sum(map(start.count, range(0xF0, 0xFA)))
    return digits > 0 and digits + start.count(0x40) > 0.5 * len(start)
