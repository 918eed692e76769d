"""Comparison of two outputs: text as text, numbers by the table of tolerances."""

from __future__ import annotations

import csv
import re
from typing import NamedTuple

from tests.tolerances import within

NUMBER = re.compile(r"[-+]?(?:\d+\.\d*|\.\d+|\d+)(?:[eED][-+]\d+)?")
KEY = re.compile(r'"([^"]*)": ')
CORRECTIONS = re.compile(r"\d+ corrections")
TOLERANCE = {
    "deg": "approved deg",
    "deg2": "approved deg2",
    "rad": "approved rad",
    "last_correction_rad": "approved last_correction_rad",
    "ft": "approved ft",
    "ft_s": "approved ft/s",
    "m_s": "approved m/s",
    "m": "approved m",
    "px": "approved px",
    "mm": "approved mm",
    "s": "approved s",
    "chance": "approved chance",
    "arcsec": "approved arcsec",
    "arcsec2": "approved arcsec2",
    "iterations": "approved iterations",
}
"""Rows of the table of tolerances by the unit that ends a column or key, or by its whole name."""
FEWEST_DIGITS = 5
"""A number of fewer printed digits is compared as text: its last one is far from any rounding."""


class Number(NamedTuple):
    """A number as printed, with its column or key; "" in running text."""

    text: str
    name: str = ""

    @property
    def value(self) -> float:
        return float(self.text.replace("D", "E"))

    @property
    def is_whole(self) -> bool:
        return self.text.lstrip("+-").isdigit()

    @property
    def last_digit(self) -> float:
        """One unit of the last printed digit; 0 for whole numbers and for few digits."""
        mantissa, _, exponent = re.sub("[eD]", "E", self.text).partition("E")
        before, _, after = mantissa.lstrip("+-0").partition(".")
        if self.is_whole or len(before + after) < FEWEST_DIGITS:
            return 0.0
        return 10.0 ** (int(exponent or 0) - len(after))


Split = tuple[list[str], list[Number]]
"""A line: its texts, and the numbers between them."""


def tolerance(name: str) -> float:
    """Look up the tolerance of a column or key: by its name, or by the unit that ends it."""
    parts = name.split("_")
    rows = (TOLERANCE.get("_".join(parts[k:])) for k in range(len(parts)))
    return within(next(filter(None, rows), "approved number"))


def equal_numbers(expected: Number, actual: Number) -> bool:
    """Compare two printed numbers.

    Whole numbers must be equal. Others may differ by one unit of the last digit (of the finer
    print), or by the tolerance of their column or key.
    """
    if expected.text == actual.text:
        return True
    if (expected.is_whole or actual.is_whole) and expected.name != "iterations":
        return False
    digit = 1.001 * min(expected.last_digit, actual.last_digit)
    return abs(expected.value - actual.value) <= max(digit, tolerance(expected.name))


def split(line: str, columns: list[str]) -> Split:
    """Split a line into its texts and the numbers between them.

    Args:
        columns: of the table in which the line is a row; empty elsewhere
    """
    if columns:
        texts, numbers = [""], []
        for name, cell in zip(columns, next(csv.reader([line])), strict=True):
            words = cell.split(" ")
            if not all(map(NUMBER.fullmatch, words)):
                texts[-1] += f"{cell},"
                continue
            for word in words:  # a cell may hold several
                numbers.append(Number(word, name))
                texts.append(" ")
            texts[-1] = ","
        return texts, numbers
    keys = [(match.end(), match[1]) for match in KEY.finditer(line)]
    texts, numbers, end = [], [], 0
    for match in NUMBER.finditer(line):
        while len(keys) > 1 and keys[1][0] <= match.start():
            del keys[0]
        name = keys[0][1] if keys and keys[0][0] <= match.start() else ""
        if CORRECTIONS.fullmatch(line):
            name = "iterations"
        texts.append(line[end : match.start()])
        numbers.append(Number(match[0], name))
        end = match.end()
    return [*texts, line[end:]], numbers


def split_lines(text: str) -> list[Split]:
    """Split every line of an output; rows of a CSV know their columns."""
    lines, columns = [], list[str]()
    for line in text.split("\n"):
        if line.count(",") >= 2 and re.fullmatch(r"\w+(,\w+)+", line) and not line[0].isdigit():
            columns = line.split(",")
            lines.append(split(line, []))
        elif columns and not line.startswith('"') and _cells(line) == len(columns):
            lines.append(split(line, columns))
        else:
            columns = []
            lines.append(split(line, []))
    return lines


def _cells(line: str) -> int:
    return len(next(csv.reader([line]), []))


class Difference(NamedTuple):
    """One difference. `kind` is text, number or rows; a text may be approved as it is."""

    kind: str
    what: str


def compare(expected: str, actual: str) -> list[Difference]:
    """Compare two outputs.

    Returns: the differences; where lines cannot be paired, those of all texts and numbers as a
    whole, of which numbers come first.
    """
    if expected == actual:
        return []
    old, new = split_lines(expected), split_lines(actual)
    if len(old) == len(new):
        lines = zip(old, new, expected.split("\n"), actual.split("\n"), strict=True)
        found = [
            Difference(kind, f"line {k}: {_where(a, b) or f'{was!r}, now {now!r}'}")
            for k, (a, b, was, now) in enumerate(lines, 1)
            if (kind := _unequal(a, b))
        ]
        if all(one.kind == "number" for one in found):
            return found
    else:
        found = [Difference("text", f"{len(old) - 1} lines, now {len(new) - 1}")]
    before, after = ([n for _, numbers in lines for n in numbers] for lines in (old, new))
    if len(before) != len(after):
        return [Difference("rows", f"{len(before)} numbers, now {len(after)}"), *found]
    numbers = [
        Difference("number", f"{a.name} {a.text}, now {b.text}".strip())
        for a, b in zip(before, after, strict=True)
        if not equal_numbers(a, b)
    ]
    return [*numbers, *(one for one in found if one.kind == "text")]


def _where(expected: Split, actual: Split) -> str:
    """Name the numbers that differ in two lines of the same text; "" where the text differs."""
    if _unequal(expected, actual) != "number":
        return ""
    pairs = zip(expected[1], actual[1], strict=True)
    return ", ".join(
        f"{a.name} {a.text} now {b.text}".strip() for a, b in pairs if not equal_numbers(a, b)
    )


def _unequal(expected: Split, actual: Split) -> str:
    """Name the kind of difference of two lines; "" for none.

    A number that is printed longer may take blanks from the texts beside it: the line then has the
    same length.
    """
    if len(expected[1]) != len(actual[1]):
        return "text"
    if expected[0] != actual[0]:
        if [text.strip(" ") for text in expected[0]] != [text.strip(" ") for text in actual[0]]:
            return "text"
        if _length(expected) != _length(actual):
            return "text"
    pairs = zip(expected[1], actual[1], strict=True)
    return "" if all(equal_numbers(a, b) for a, b in pairs) else "number"


def _length(line: Split) -> int:
    return sum(map(len, line[0])) + sum(len(number.text) for number in line[1])
