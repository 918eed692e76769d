"""Text for a screen: aligned tables, shortened names, and lines broken at words.

Characters of East Asian scripts take two columns, combining marks none.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Collection, Sequence

LEAST, MOST = 80, 120
"""Columns of a screen that a text is set for: a narrower one breaks its lines, a wider is left."""


def fitted(columns: int) -> int:
    """Limit the width of a text to what is read well."""
    return min(max(columns, LEAST), MOST)


def width(text: str) -> int:
    """Measure the columns that a text takes on a screen."""
    if text.isascii():
        return len(text)
    return sum(
        0 if unicodedata.combining(c) else 1 + (unicodedata.east_asian_width(c) in "WF")
        for c in text
    )


def shortened(text: str, most: int) -> str:
    """Leave out the middle of a name that is too wide; its end tells it from its neighbours."""
    if width(text) <= most:
        return text
    begin, end = "", ""
    for c in text:
        if width(begin + c) > (most - 3) // 3:
            break
        begin += c
    for c in reversed(text):
        if width(begin + c + end) > most - 3:
            break
        end = c + end
    return f"{begin}...{end}"


def aligned(
    rows: Sequence[Sequence[str]], left: Collection[int], close: Collection[int] = ()
) -> list[str]:
    """Align the columns of a table.

    Args:
        rows: its cells
        left: columns that are aligned on the left; the others are on the right
        close: columns with one blank before them, not two
    """
    wide = [max(map(width, column)) for column in zip(*rows, strict=True)]
    lines = []
    for row in rows:
        cells = []
        for k, (cell, w) in enumerate(zip(row, wide, strict=True)):
            blank = " " * (w - width(cell))
            gap = "" if not k else " " if k in close else "  "
            cells.append(gap + (cell + blank if k in left else blank + cell))
        lines.append("".join(cells).rstrip())
    return lines


def wrapped(text: str, columns: int, indent: str = "    ") -> str:
    """Break a line at its spaces, if it is too wide; the next ones are indented.

    A word that is wider than the screen, such as the name of a file, stays whole.
    """
    if width(text) <= columns:
        return text
    words = text.lstrip(" ")
    lines, line = [], " " * (len(text) - len(words))
    for word in words.split(" "):
        if line.strip() and width(line) + 1 + width(word) > columns:
            lines.append(line)
            line = indent + word
        else:
            line = f"{line} {word}" if line.strip() else line + word
    return "\n".join([*lines, line])
