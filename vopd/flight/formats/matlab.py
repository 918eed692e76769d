"""Variables of MATLAB's files, level 5: real numbers, texts, cells and structures.

scipy's reader trusts the sizes in a file: of damaged ones it ends the whole process. Here every
size is checked (MathWorks, MAT-File Format, 2023, chapter 1).
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Sequence
from math import prod
from typing import Any

import numpy as np

HEADER = 128  # bytes
MOST = 16_000_000  # bytes of a variable that is compressed
MOST_ELEMENTS = 20_000  # elements of a variable, of a calibration some hundreds
DEEPEST = 20  # cells and structures that stand in each other
NUMBERS = {
    1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8",
}  # fmt: skip
"""The types of numbers, as numpy names them."""
UTF = {16: "utf-8", 17: "utf-16", 18: "utf-32"}
MATRIX, COMPRESSED = 14, 15
CELL, STRUCTURE, TEXT = 1, 2, 4
NUMERIC = range(6, 16)  # classes of arrays of numbers
COMPLEX = 0x800


def read_variables(data: bytes, names: Sequence[str]) -> dict[str, Any]:
    """Read variables of a file, those of these names that are there.

    Args:
        data: of the file
        names: of the variables

    Returns:
        Arrays of numbers, without axes of length 1; texts; lists of cells; a structure as a
        mapping, several of them as a list.

    Raises:
        ValueError, KeyError, IndexError, zlib.error: if it is damaged, or of another kind
    """
    order = {b"IM": "<", b"MI": ">"}[data[126:HEADER]]
    found = {}
    for kind, content in _elements(data[HEADER:], order):
        if kind == COMPRESSED:
            content = zlib.decompressobj().decompress(content, MOST)
            if len(content) < 8:
                raise ValueError("a variable is cut short")
            kind, content = int(np.frombuffer(content, order + "u4", 1)[0]), content[8:]
        if kind != MATRIX:
            continue
        head = [part for (_, part), _ in zip(_elements(content, order), range(3), strict=False)]
        name = head[2].decode("ascii")
        if name in names:
            found[name] = _matrix(content, order, 0)
    return found


def _elements(data: bytes, order: str) -> Iterator[tuple[int, bytes]]:
    """Split data into elements: the type of each, and its bytes."""
    at = count = 0
    while at < len(data):
        count += 1
        if count > MOST_ELEMENTS:
            raise ValueError(f"it has more than {MOST_ELEMENTS} elements")
        kind, size = np.frombuffer(data[at : at + 8], order + "u4", 2).tolist()
        first, most = at + 8, len(data) - at - 8
        if kind >> 16:  # four bytes at most, in the tag itself
            kind, size, first, most = kind & 0xFFFF, kind >> 16, at + 4, 4
        if size > most:
            raise ValueError("an element is longer than there is room")
        yield kind, data[first : first + size]
        at = first + size
        at += 0 if kind == COMPRESSED else -at % 8


def _numbers(part: tuple[int, bytes], order: str) -> Any:
    return np.frombuffer(part[1], order + NUMBERS[part[0]])


def _matrix(data: bytes, order: str, depth: int) -> Any:
    """Read an array of numbers, a text, cells or structures."""
    parts = list(_elements(data, order))
    if not parts:  # an empty one
        return np.zeros(0)
    flags = int(_numbers(parts[0], order)[0])
    shape = _numbers(parts[1], order).tolist()
    kind, count = flags & 0xFF, prod(shape)
    if depth > DEEPEST or min(shape) < 0 or flags & COMPLEX:
        raise ValueError("not real numbers, or too deep")
    if kind == TEXT:
        if parts[3][0] in UTF:
            return parts[3][1].decode(UTF[parts[3][0]])
        return "".join(map(chr, _numbers(parts[3], order).tolist()))
    if kind in NUMERIC:
        values = _numbers(parts[3], order)
        if len(values) != count:
            raise ValueError("an array has another size than it says")
        return values.astype(np.float64).reshape(shape, order="F").squeeze()
    if kind == CELL:
        return _several(parts[3:], order, depth, count)
    if kind != STRUCTURE:
        raise ValueError("neither numbers, text, cells nor a structure")
    width = int(_numbers(parts[3], order)[0])
    fields = [
        parts[4][1][k : k + width].split(b"\0")[0].decode("ascii")
        for k in range(0, len(parts[4][1]), width)
    ]
    values = _several(parts[5:], order, depth, count * len(fields))
    rows = [
        dict(zip(fields, values[k : k + len(fields)], strict=True))
        for k in range(0, len(values), max(len(fields), 1))
    ]
    return rows[0] if count == 1 else rows


def _several(parts: Sequence[tuple[int, bytes]], order: str, depth: int, count: int) -> list[Any]:
    if len(parts) != count or any(kind != MATRIX for kind, _ in parts):
        raise ValueError("another number of elements than it says")
    return [_matrix(content, order, depth + 1) for _, content in parts]
