"""The cards of a deck in order, as images of 80 columns that know their card numbers."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools
from vopd.cards.text import COLUMNS, NUMBERS, CardText
from vopd.files import (
    A_VIDEO,
    TAKES_STARS,
    kind_by_first_bytes,
    names_stars,
    written_by_vopd,
)
from vopd.findings import Finding, InputError, Report, Severity, VopdError, count_text

# Consecutive cards as an array of bytes

Bytes = NDArray[np.uint8]

BLANK = 32
BEHIND_A_DECK = b" \r\n\x1a"  # blanks, and the control-Z by which CP/M and DOS ended files
LAST_PRINTABLE = 126


@dataclass(frozen=True, eq=False, repr=False)
class CardBlock:
    """Consecutive cards of one group."""

    # the columns as bytes, shape (number of cards, at most 80); columns that are missing are blank
    text: Bytes
    first: int  # number of the first card in the deck, from 1
    where: Finding  # a finding without a message that names the deck and the group
    # why there are fewer cards than were asked for; None where there are not
    stopped_by: Finding | None = None

    def __len__(self) -> int:
        return len(self.text)

    def columns(self, first: int, last: int) -> Bytes:
        """Cut columns out of every card: an array (cards, width) of bytes.

        Args:
            first: the first column, from 1
            last: the last column
        """
        part = self.text[:, first - 1 : last]
        missing = last - first + 1 - part.shape[1]
        if missing <= 0:
            return part
        padded = np.full((len(part), last - first + 1), BLANK, np.uint8)
        padded[:, : part.shape[1]] = part
        return padded

    def image(self, row: int) -> str:
        """Read one card as text, 80 columns.

        Args:
            row: index of the card in the block, from 0
        """
        return str(self.text[row].tobytes(), "ascii").ljust(COLUMNS)

    def finding(
        self,
        row: int,
        message: str,
        field: str,
        columns: tuple[int, int],
        severity: Severity = "error",
    ) -> Finding:
        """Make a finding about one field of one card.

        Args:
            row: index of the card in the block, from 0
            message: what is wrong
            field: what the field means
            columns: first and last column of the field, from 1
            severity: whether it is an error or a warning
        """
        where = self.where  # built anew: a copy by `replace` takes eight times as long
        return Finding(
            message,
            where.source,
            self.first + row,
            where.job,
            where.group,
            field,
            columns,
            self.image(row),
            severity,
        )

    def followed_by(self, more: CardBlock) -> CardBlock:
        """Join these cards with the cards that come next in the deck."""
        if not len(self):
            return more
        width = max(self.text.shape[1], more.text.shape[1])
        text = np.concatenate([self.columns(1, width), more.columns(1, width)])
        return replace(self, text=text, stopped_by=more.stopped_by)


def byte_matrix(images: Iterable[bytes]) -> Bytes:
    """Join texts of cards to one array (cards, width) of bytes, with blanks on the right."""
    images = list(images)
    width = max(map(len, images), default=0)
    joined = b"".join([image.ljust(width) for image in images])
    return np.frombuffer(joined, np.uint8).reshape(len(images), width)


# The cards of a deck in order

NEWLINE = 10
BLOCK_BYTES = 1 << 20  # read from the file at a time, at least
LONGEST_AHEAD = 256  # bytes of a line that is looked at ahead, on average: other lines are no cards
MOST_BYTES = 1 << 24  # ... however many cards are asked for
NO_CARDS = np.zeros((0, 0), np.uint8)
LONGEST_LINE = 1 << 14  # characters of a line of a deck: a longer one is no card, however it ends


class CardDeck:
    """Reads a deck from a file and gives out its cards in order.

    Args:
        file: the deck, open for reading bytes
        name: the deck's name, for findings
        report: is given the findings about lines that are not cards
        on_cards: is called with every block of cards that is taken
    """

    def __init__(
        self,
        file: BinaryIO,
        name: str,
        report: Report,
        on_cards: Callable[[CardBlock], object] = lambda _: None,
    ) -> None:
        self.name = name
        self.report = report
        self.on_cards = on_cards
        self.taken = 0
        self._text = CardText(file)
        self._buffer = b""
        self._at = 0
        self._ended = False
        self._clean = True  # whether the buffer holds printable characters and newlines only
        self._dropped = 0  # bytes that the last `_fill` removed from the front of the buffer

    def take(self, count: int, group: int) -> CardBlock:
        """Take the next cards for a group.

        Args:
            count: how many cards
            group: number of the group, for findings

        Returns:
            The cards. Where the deck has fewer, or a line is not a card, the block is shorter
            and `stopped_by` says why.
        """
        where = Finding("", source=self.name, group=group)
        cards = CardBlock(self._take_regular(count), self.taken + 1, where)
        if len(cards) < count:
            cards = cards.followed_by(self._take_line_by_line(count, len(cards), where))
        self.taken += len(cards)
        self.on_cards(cards)
        return cards

    def at_end(self) -> bool:
        """Tell whether only blank cards are left, or what files were ended with."""
        at = self._at
        while True:
            if self._buffer[at:].lstrip(BEHIND_A_DECK):
                return False
            at = len(self._buffer)
            if not self._fill():
                return True
            at -= self._dropped

    def next_card(self, group: int) -> CardBlock:
        """Look at the next card, which stays in the deck; an empty block at the end of the deck."""
        line, _ = self._line()
        where = Finding("", source=self.name, group=group)
        return CardBlock(byte_matrix([] if line is None else [_image(line)]), self.taken + 1, where)

    def following(self, most: int) -> Bytes:
        """Look at the next cards as bytes (cards, at most 80), which stay in the deck."""
        while (
            self._buffer.count(b"\n", self._at) < most
            and len(self._buffer) - self._at < most * LONGEST_AHEAD
            and self._fill()
        ):
            pass
        lines = self._buffer[self._at :].split(b"\n", most)
        return byte_matrix([_image(line) for line in lines[:most]])

    def next_bytes(self) -> bytes:
        """Look at the bytes that come next, at most one block of them, without taking them."""
        if self._at == len(self._buffer):
            self._fill()
        return self._buffer[self._at :]

    def _fill(self, at_least: int = 0) -> bool:
        """Read more of the file and drop what has been taken; false at the end of the file."""
        if self._ended:
            return False
        try:
            block = self._text.read(max(at_least, BLOCK_BYTES))
        except OSError as error:
            raise VopdError(f"{self.name}: {error.strerror}") from error
        self._ended = not block
        self._dropped = self._at
        self._buffer = self._buffer[self._at :] + block
        self._at = 0
        self._clean = _all_clean(self._buffer)
        return bool(block)

    def _line(self) -> tuple[bytes | None, int]:
        """Find the next line without its end, and the index at which the line after it begins."""
        while True:
            end = self._buffer.find(b"\n", self._at)
            if end >= 0:
                return self._buffer[self._at : end], end + 1
            if len(self._buffer) - self._at > LONGEST_LINE or not self._fill():
                rest = self._buffer[self._at :]
                return (rest, len(self._buffer)) if rest else (None, self._at)

    def _take_regular(self, count: int) -> Bytes:
        """Take cards as long as they are clean lines of one length, all at once.

        Most decks are such lines; what follows the first other line is left to
        `_take_line_by_line`.
        """
        line, after = self._line()
        if line is None or len(line) > COLUMNS:
            return NO_CARDS
        width = after - self._at
        while (missing := count * width - len(self._buffer) + self._at) > 0:
            if not self._fill(min(missing, MOST_BYTES)):
                break
        count = min(count, (len(self._buffer) - self._at) // width)
        lines = np.frombuffer(self._buffer, np.uint8, count * width, self._at)
        lines = lines.reshape(count, width)
        ends = lines == NEWLINE
        if not (self._clean and ends[:, -1].all() and np.count_nonzero(ends) == count):
            good = _regular(lines)
            lines = lines if good.all() else lines[: good.argmin()]
        self._at += lines.size
        return lines[:, :-1] if len(lines) else NO_CARDS

    def _take_line_by_line(self, count: int, found: int, where: Finding) -> CardBlock:
        """Take the cards after the first `found` of `count`, up to the first that is no card."""
        images: list[bytes] = []
        stopped_by: Finding | None = None
        first = self.taken + found + 1
        while found + len(images) < count and stopped_by is None:
            line, after = self._line()
            number = first + len(images)
            if line is None:
                message = _ends_early(count, found + len(images))
                stopped_by = replace(where, message=message, card=number)
                break
            finding = _not_a_card(line, number, where)
            if finding is not None:
                stopped_by = self._tell(finding)
            if stopped_by is None:
                images.append(_image(line))
                self._at = after
        return CardBlock(byte_matrix(images), first, where, stopped_by)

    def _tell(self, finding: Finding) -> Finding | None:
        """Report a line that is not a card; returns the finding where reading has to end there."""
        try:
            self.report(finding)
        except InputError:
            return finding
        return None


def _all_clean(content: bytes) -> bool:
    """Test bytes for printable characters and newlines only."""
    characters = np.frombuffer(content, np.uint8)
    others = characters - np.uint8(BLANK) > LAST_PRINTABLE - BLANK
    return bool(np.count_nonzero(others) == np.count_nonzero(characters == NEWLINE))


def _regular(lines: Bytes) -> Bools:
    """Mark lines (cards, width) that end where they should and hold printable characters only."""
    text = lines[:, :-1]
    good = lines[:, -1] == NEWLINE
    if text.size and (text.min() < BLANK or text.max() > LAST_PRINTABLE):
        good &= ((text >= BLANK) & (text <= LAST_PRINTABLE)).all(axis=1)
    return np.asarray(good)


def _clean(line: bytes) -> bool:
    return line.isascii() and line.decode("ascii").isprintable()


def _ends_early(count: int, found: int) -> str:
    return f"the deck ends here: {count_text(count, 'card')} expected, {found or 'none'} found"


def _stripped(line: bytes) -> bytes:
    return line.removesuffix(b"\r").rstrip(b" ")


def _image(line: bytes, stand_in: str = " ") -> bytes:
    """Cut a line to 80 columns; bytes that are not printable ASCII become `stand_in`."""
    line = _stripped(line)[:COLUMNS]
    if _clean(line):
        return line
    return bytes(byte if BLANK <= byte <= LAST_PRINTABLE else ord(stand_in) for byte in line)


A_TAB = "a tab, which no card has: "


def _tab_text(line: bytes, column: int, source: str) -> str:
    """Say what to write in the place of a tab, and where `expand` brings what is behind it."""
    before = line[:column].expandtabs()
    behind = line.expandtabs()[len(before) :]
    if not behind.strip():
        return f"{A_TAB}leave it out"
    brought = len(before) + len(behind) - len(behind.lstrip(b" ")) + 1
    return (
        f"{A_TAB}write blanks up to the columns of what is behind it (expand {source} > NEW "
        f"brings that to column {brought})"
    )


def _not_a_card(line: bytes, number: int, where: Finding) -> Finding | None:
    """Explain why a line is no card: a character that cards do not have, or an 81st column."""
    line = _stripped(line)
    if len(line) <= COLUMNS and _clean(line):
        return None
    for column, byte in enumerate(line, 1):
        if byte == ord("\t"):
            message = _tab_text(line, column, where.source)
        elif not BLANK <= byte <= LAST_PRINTABLE:
            message = f"byte {byte:#04x} is not a printable ASCII character; is this a card deck?"
        elif column > COLUMNS and byte != BLANK:
            message = "a card has 80 columns, and this line is longer"
        else:
            continue
        image = _image(line, "?").decode("ascii")
        return replace(where, message=message, card=number, columns=(column, column), image=image)
    return None


# Files that are not decks of cards

_OF_A_FLIGHT = "a file of a flight is named in its project: vopd new DIR --{} {}"
_PICTURE = "vopd pick {1} -o pick.html makes a page to pick landmarks on"
ADVICE = {
    "a CSV file of stars": f"{TAKES_STARS} takes it",
    "a listing": "vopd diff compares listings",
    "a CSV file": f"{_OF_A_FLIGHT} (or --landmarks, --track, --wind)",
    "a JSON file": f"{_OF_A_FLIGHT} (or --picks, --landmarks)",
    "an XML file": f"{_OF_A_FLIGHT} (or --lens, --track)",
    A_VIDEO: "vopd new DIR --video {1} --landmarks FILE makes a flight project of it",
    "a TOML file": "vopd attitude, plot, report and check take a flight project NAME.toml",
    "a gzip archive": "unpack it: gunzip",
    "UTF-16 text": "iconv -f UTF-16 -t ASCII converts it",
}
"""What to do with a file of some kinds; {} are its usual option in a new project and its name."""
_EXAMPLE = "vopd demo writes an example of a deck"
_OPTION = {"a CSV file": "picks", "a JSON file": "lens", "an XML file": "picks"}

_COMMA_SEPARATED = r"[^,;]*[,;][^,;]*[,;]|[A-Za-z_]\w*\s*[,;]"
_TOML = r"\[+[\w.\"' -]+\]+\s*(#.*)?$|[\w.\"'-]+\s*=\s*\S"
_JSON = r"[\[{]\s*($|[{\"\d-]|\[(?![A-Za-z_])|\]|\})"  # [[table]] is TOML
_MARKUP = r"(?i)<(!doctype html|html|head|body)\b"


_LISTING = "L-MARK LONGITUDE"


def refuse_other_file(start: bytes, name: str) -> None:
    """Raise `VopdError` for a file that is certainly not a deck of cards.

    Args:
        start: the first bytes of the file; a few thousand suffice
        name: the file's name, for the message
    """
    own = written_by_vopd(start[:4096].decode("utf-8-sig", "replace"))
    kind, advice = own or (_kind(start[:4096]), "")
    if kind is not None:
        usual = _PICTURE if kind.endswith(" image") else _EXAMPLE
        source = "FILE" if name == "-" else name
        advice = advice or ADVICE.get(kind, usual).format(_OPTION.get(kind), source)
        raise VopdError(f"{name}: this is {kind}, not a deck of 80-column cards; {advice}")


def _kind(start: bytes) -> str | None:
    """Recognise a file, such as "a PNG image"; None if it may be a deck."""
    kind = kind_by_first_bytes(start)
    if kind is not None:
        return kind
    text = start.removeprefix(b"\xef\xbb\xbf").decode("latin-1")
    if _LISTING in text:
        return "a listing"
    lines = filter(str.strip, text.splitlines())
    line = next(lines, "")
    if re.fullmatch(NUMBERS, line[:20]):
        return None
    while line.lstrip().startswith("#"):
        line = next(lines, "")
    return _kind_of_text(line.strip()) if line else None


def _kind_of_text(line: str) -> str | None:
    """Recognise a text file by its first line that is neither blank nor a comment."""
    if line.startswith("<"):
        return "an HTML page" if re.match(_MARKUP, line) else "an XML file"
    if re.match(_JSON, line):
        return "a JSON file"
    if re.match(_TOML, line):
        return "a TOML file"
    if re.match(_COMMA_SEPARATED, line) is None:
        return None
    return "a CSV file of stars" if names_stars(re.split("[,;]", line)) else "a CSV file"
