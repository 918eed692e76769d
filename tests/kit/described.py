"""Any record as lines of text, for approved texts: each field by its path."""

from __future__ import annotations

import dataclasses
from enum import Enum
from typing import Any

import numpy as np


def described(value: Any, path: str = "", digits: int = 9) -> list[str]:
    """Describe a record, or a list of them: a line a field, of an array its numbers."""
    if dataclasses.is_dataclass(value):
        fields = {one.name: getattr(value, one.name) for one in dataclasses.fields(value)}
    elif hasattr(value, "_asdict"):
        fields = value._asdict()
    elif isinstance(value, dict):
        fields = value
    elif isinstance(value, list | tuple) and any(map(_is_record, value)):
        fields = dict(enumerate(value))
    else:
        return [f"{path}: {_text(value, digits)}"]
    return [
        line
        for name, one in fields.items()
        for line in described(one, f"{path}.{name}".lstrip("."), digits)
    ]


def _is_record(value: Any) -> bool:
    return dataclasses.is_dataclass(value) or hasattr(value, "_asdict")


def _text(value: Any, digits: int) -> str:
    if isinstance(value, np.ndarray):
        return f"{value.shape} {' '.join(_text(one, digits) for one in value.ravel().tolist())}"
    if isinstance(value, float):
        return f"{0.0 if abs(value) < 1e-9 else value:.{digits}g}"
    if isinstance(value, list | tuple):
        return " ".join(_text(one, digits) for one in value)
    return value.name if isinstance(value, Enum) else str(value)
