"""Things described whole: every field of a record and every number of an array, as text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import PurePath
from typing import Any

import numpy as np
from PIL.Image import Image

NONE = 1e-9  # a smaller number is none: its digits are rounding


def whole(value: Any, name: str = "", form: str = ".6f") -> str:
    """Describe a record, array, dict or sequence: a line for each of its parts.

    Numbers are written in a form with five decimals, or significant digits, or more, so that
    `tests.approved.compare` allows one unit of the last. Pictures are described by a grid of their
    pixels.
    """

    def lines(value: Any, name: str) -> Iterator[str]:
        parts = _parts(value)
        if parts is not None:
            for key, part in parts:
                yield from lines(part, f"{name}.{key}" if name else key)
            return
        if isinstance(value, Image):
            yield f"{name}: {value.mode} {value.size[0]} x {value.size[1]}: {_cells(value)}"
        else:
            yield f"{name}: {text(value)}"

    def text(value: Any) -> str:
        if isinstance(value, np.ndarray):
            return text(value.tolist())
        if isinstance(value, list | tuple | set | frozenset):
            return f"[{' '.join(map(text, value))}]"
        if isinstance(value, float | np.floating):
            return number(float(value))
        if isinstance(value, PurePath):
            return value.name
        return f"{len(value)} bytes" if isinstance(value, bytes) else str(value)

    def number(value: float) -> str:
        found = f"{0.0 if abs(value) < NONE else value:{form}}"
        return found.removeprefix("-") if not found.strip("-0.") else found

    return "\n".join(lines(value, name))


def _parts(value: Any) -> list[tuple[str, Any]] | None:
    """List the parts of a record, a dict or a table; None of what is a value by itself."""
    if is_dataclass(value) and not isinstance(value, type):
        return [(one.name, getattr(value, one.name)) for one in fields(value)]
    if hasattr(value, "_fields"):
        return list(zip(value._fields, value, strict=True))
    if isinstance(value, Mapping):
        return [(str(key), part) for key, part in value.items()]
    if isinstance(value, np.ndarray) and value.dtype.names:
        return [(str(k), [row[one] for one in value.dtype.names]) for k, row in enumerate(value)]
    if isinstance(value, list | tuple) and any(_parts(one) is not None for one in value):
        return [(str(k), part) for k, part in enumerate(value)]
    return None


def _cells(picture: Image) -> list[int]:
    """Take the grey level of nine places of a picture."""
    grey = np.asarray(picture.convert("L"))
    rows, columns = (np.linspace(0, side - 1, 3).astype(int) for side in grey.shape)
    return [int(one) for one in grey[np.ix_(rows, columns)].ravel()]
