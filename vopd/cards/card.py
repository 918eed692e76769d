"""Cards: 80 columns, counted from 1, taken from a deck in the order of reading."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from vopd.findings import DeckError, Finding, Report, VopdError

Bytes = NDArray[np.uint8]

COLUMNS = 80
BLANK = 32
NEWLINE = 10
BLOCK = 1 << 20  # bytes read from the file at a time
LONGEST = 1 << 14  # a line longer than this is no card, whatever comes after


@dataclass(frozen=True)
class Cards:
    """Some cards in a row: their columns as bytes, and where they stand in the deck.

    `text` may hold fewer than 80 columns; what is missing is blank. `trouble`
    says why there are fewer cards than were asked for.
    """

    text: Bytes  # (n, at most 80)
    first: int
    where: Finding  # deck and group, for remarks
    trouble: Finding | None = None

    def __len__(self) -> int:
        return len(self.text)

    def columns(self, first: int, last: int) -> Bytes:
        """Columns `first` to `last`, counted from 1, as an array (n, width) of bytes."""
        part = self.text[:, first - 1 : last]
        short = last - first + 1 - part.shape[1]
        if short <= 0:
            return part
        return np.pad(part, ((0, 0), (0, short)), constant_values=BLANK)

    def image(self, row: int) -> str:
        """The card as text, 80 columns."""
        return str(self.text[row].tobytes(), "ascii").ljust(COLUMNS)

    def finding(self, row: int, message: str, field: str, columns: tuple[int, int]) -> Finding:
        """A remark about one field of one card."""
        return replace(
            self.where,
            message=message,
            card=self.first + row,
            field=field,
            columns=columns,
            image=self.image(row),
        )

    def then(self, more: Cards) -> Cards:
        """These cards followed by those."""
        width = max(self.text.shape[1], more.text.shape[1])
        text = np.concatenate([self.columns(1, width), more.columns(1, width)])
        return replace(self, text=text, trouble=more.trouble)


class CardDeck:
    """A deck being read: gives cards in order and knows what number comes next."""

    def __init__(
        self,
        file: BinaryIO,
        name: str,
        report: Report,
        trace: Callable[[Cards], object] = lambda _: None,
    ) -> None:
        self.name = name
        self.report = report
        self.trace = trace
        self.taken = 0
        self._file = file
        self._buffer = b""
        self._at = 0
        self._ended = False

    def take(self, count: int, group: int) -> Cards:
        """The next `count` cards for `group`; fewer, with `trouble`, where the deck has no more."""
        where = Finding("", deck=self.name, group=group)
        cards = self._regular(count, where)
        if cards is None:
            cards = self._irregular(count, where)
        self.taken += len(cards)
        self.trace(cards)
        return cards

    def at_end(self) -> bool:
        """Whether only blank cards are left."""
        at = self._at
        while True:
            rest = self._buffer[at:].lstrip(b" \r\n")
            if rest:
                return False
            at = len(self._buffer)
            if not self._fill():
                return True
            at -= self._dropped

    def next_card(self, group: int) -> Cards:
        """The next card without taking it, none at the end of the deck."""
        line, _ = self._line()
        where = Finding("", deck=self.name, group=group)
        text = [] if line is None else [_image(line)]
        return Cards(_matrix(text), self.taken + 1, where)

    # Reading ahead

    _dropped = 0

    def _fill(self) -> bool:
        """Read another block; what has been taken is dropped."""
        if self._ended:
            return False
        try:
            block = self._file.read(BLOCK)
        except OSError as error:
            raise VopdError(f"{self.name}: {error.strerror}") from error
        self._ended = not block
        self._dropped = self._at
        self._buffer = self._buffer[self._at :] + block
        self._at = 0
        return bool(block)

    def _line(self) -> tuple[bytes | None, int]:
        """The next line without its end, and where the one after it begins."""
        while True:
            end = self._buffer.find(b"\n", self._at)
            if end >= 0:
                return self._buffer[self._at : end], end + 1
            if len(self._buffer) - self._at > LONGEST or not self._fill():
                rest = self._buffer[self._at :]
                return (rest, len(self._buffer)) if rest else (None, self._at)

    def _regular(self, count: int, where: Finding) -> Cards | None:
        """Cards that are lines of one length and clean, as most are: no copy, no loop."""
        line, after = self._line()
        if line is None or len(line) > COLUMNS or count < 2:
            return None
        width = after - self._at
        while len(self._buffer) - self._at < count * width:
            if not self._fill():
                return None
        lines = np.frombuffer(self._buffer, np.uint8, count * width, self._at)
        lines = lines.reshape(count, width)
        text = lines[:, :-1]
        if not (lines[:, -1] == NEWLINE).all() or not _printable(text):
            return None
        self._at += count * width
        return Cards(text, self.taken + 1, where)

    def _irregular(self, count: int, where: Finding) -> Cards:
        """Cards line by line: short ones, CR LF, and the first that is no card."""
        images: list[bytes] = []
        trouble: Finding | None = None
        while len(images) < count and trouble is None:
            line, after = self._line()
            number = self.taken + len(images) + 1
            if line is None:
                trouble = replace(where, message=_ends_early(count, len(images)), card=number)
                break
            fault = _fault(line, number, where)
            if fault is not None:
                trouble = self._tell(fault)
            if trouble is None:
                images.append(_image(line))
                self._at = after
        return Cards(_matrix(images), self.taken + 1, where, trouble)

    def _tell(self, fault: Finding) -> Finding | None:
        """A reader who collects all faults goes on; for others the fault is the end."""
        try:
            self.report(fault)
        except DeckError:
            return fault
        return None


def _printable(text: Bytes) -> bool:
    return text.size == 0 or (int(text.min()) >= BLANK and int(text.max()) <= 126)


def _clean(line: bytes) -> bool:
    return line.isascii() and line.decode("ascii").isprintable()


def _ends_early(count: int, found: int) -> str:
    cards = "1 card" if count == 1 else f"{count} cards"
    return f"the deck ends here: {cards} expected, {found or 'none'} found"


def _stripped(line: bytes) -> bytes:
    return line.removesuffix(b"\r").rstrip(b" ")


def _image(line: bytes, stand_in: str = " ") -> bytes:
    """80 columns at most, with a stand-in for what is no character of a card."""
    line = _stripped(line)[:COLUMNS]
    if _clean(line):
        return line
    return bytes(byte if BLANK <= byte <= 126 else ord(stand_in) for byte in line)


def _matrix(images: list[bytes]) -> Bytes:
    width = max(map(len, images), default=0)
    joined = b"".join([image.ljust(width) for image in images])
    return np.frombuffer(joined, np.uint8).reshape(len(images), width)


def _fault(line: bytes, number: int, where: Finding) -> Finding | None:
    """What makes a line no card: a character that no card has, or a column too many."""
    line = _stripped(line)
    if len(line) <= COLUMNS and _clean(line):
        return None
    for column, byte in enumerate(line, 1):
        if byte == ord("\t"):
            message = "a tab: cards have blanks only"
        elif not BLANK <= byte <= 126:
            message = f"byte {byte:#04x} is no printable ASCII character: is this a card deck?"
        elif column > COLUMNS and byte != BLANK:
            message = "a card has 80 columns, and this line goes on"
        else:
            continue
        image = _image(line, "?").decode("ascii")
        return replace(where, message=message, card=number, columns=(column, column), image=image)
    return None
