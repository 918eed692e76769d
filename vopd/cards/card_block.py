"""Consecutive cards of a deck as an array of bytes, and where they are in the deck."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vopd.findings import Finding, Severity

Bytes = NDArray[np.uint8]

COLUMNS = 80
BLANK = 32
LAST_PRINTABLE = 126


@dataclass(frozen=True, eq=False, repr=False)
class CardBlock:
    """Consecutive cards of one group.

    Attributes:
        text: the columns as bytes, shape (number of cards, at most 80); columns that are
            missing are blank
        first: number of the first card in the deck, from 1
        where: a finding without a message that names the deck and the group
        stopped_by: why there are fewer cards than were asked for; None where there are not
    """

    text: Bytes
    first: int
    where: Finding
    stopped_by: Finding | None = None

    def __len__(self) -> int:
        return len(self.text)

    def columns(self, first: int, last: int) -> Bytes:
        """Some columns of every card, as an array (cards, width) of bytes.

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
        """The text of one card, 80 columns.

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
            where.deck,
            self.first + row,
            where.job,
            where.group,
            field,
            columns,
            self.image(row),
            severity,
        )

    def followed_by(self, more: CardBlock) -> CardBlock:
        """Join these cards with the cards that come next in the deck.

        Args:
            more: the cards that come next
        """
        if not len(self):
            return more
        width = max(self.text.shape[1], more.text.shape[1])
        text = np.concatenate([self.columns(1, width), more.columns(1, width)])
        return replace(self, text=text, stopped_by=more.stopped_by)


def byte_matrix(images: Iterable[bytes]) -> Bytes:
    """Texts of cards as one array (cards, width) of bytes, filled with blanks on the right.

    Args:
        images: the text of each card
    """
    images = list(images)
    width = max(map(len, images), default=0)
    joined = b"".join([image.ljust(width) for image in images])
    return np.frombuffer(joined, np.uint8).reshape(len(images), width)
