"""Dataclasses of arrays: equality, printing, some rows of a record, several records in a row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Generic, Self, TypeVar, overload

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.landmark_layout import LandmarkLayout

Array = TypeVar("Array", Bools, Floats, Ints)


@dataclass(frozen=True, eq=False, repr=False)
class Record:
    """Base class of dataclasses of arrays: equal if all values are, NaN included; prints shapes."""

    def __repr__(self) -> str:
        shown = [(f.name, getattr(self, f.name)) for f in fields(self) if f.repr]
        texts = (f"{name}={_brief(value)}" for name, value in shown)
        return f"{type(self).__name__}({', '.join(texts)})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Record) or type(self) is not type(other):
            return NotImplemented
        names = [f.name for f in fields(self) if f.compare]
        return all(_same(getattr(self, name), getattr(other, name)) for name in names)

    def take(self, rows: Ints | slice) -> Self:
        """The record of some rows of all its arrays.

        Args:
            rows: their indices
        """
        return replace(self, **{name: array[rows] for name, array in self.arrays().items()})

    @classmethod
    def concat(cls, records: Sequence[Self]) -> Self:
        """The rows of several records, one record after the other.

        Args:
            records: one or more; what is no array is that of the first
        """
        if len(records) == 1:
            return records[0]
        own = [one.arrays() for one in records]
        return replace(records[0], **{n: np.concatenate([one[n] for one in own]) for n in own[0]})

    def arrays(self) -> dict[str, Any]:
        """The arrays of the record by the names of their fields."""
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}


def _brief(value: object) -> str:
    return f"array{value.shape}" if isinstance(value, np.ndarray) else repr(value)


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray | float):
        return np.array_equal(one, other, equal_nan=np.asarray(one).dtype.kind == "f")
    return bool(one == other)


Marks = TypeVar("Marks", bound=Record)


@dataclass(frozen=True, eq=False, repr=False)
class FrameRecord(Record, Generic[Marks]):
    """A record of arrays by frame (F, ...), with a record `points` by landmark (N, ...).

    `layout` says which landmarks each frame has. `ByLandmark` makes an array by frame and
    landmark (F, L, ...) of one of `points`.
    """

    layout: LandmarkLayout
    points: Marks

    def take(self, rows: Ints | slice) -> Self:
        """The record of some frames.

        Args:
            rows: their indices
        """
        every, layout = np.arange(len(self.layout.count)), self.layout.only(rows)
        if isinstance(rows, slice) and rows.step is None:  # views of consecutive landmarks
            first = int(self.layout.start[rows][0]) if len(every[rows]) else 0
            points = self.points.take(slice(first, first + layout.total))
        else:
            points = self.points.take(self.layout.rows(every[rows]))
        arrays = {name: array[rows] for name, array in self.arrays().items()}
        return replace(self, layout=layout, points=points, **arrays)

    @classmethod
    def concat(cls, records: Sequence[Self]) -> Self:
        """The frames of several records, one record after the other.

        Args:
            records: one or more; what is no array is that of the first
        """
        if len(records) == 1:
            return records[0]
        counts = np.concatenate([one.layout.count for one in records])
        points = type(records[0].points).concat([one.points for one in records])
        own = [one.arrays() for one in records]
        arrays = {name: np.concatenate([one[name] for one in own]) for name in own[0]}
        return replace(records[0], layout=LandmarkLayout(counts), points=points, **arrays)


class ByLandmark(Generic[Array]):
    """An array of `points` by frame and landmark (F, L, ...), made when it is asked for.

    Args:
        empty: stands where a frame has fewer landmarks than L
    """

    def __init__(self, empty: float = 0) -> None:
        self.empty = empty

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    @overload
    def __get__(self, record: None, owner: type) -> Self: ...
    @overload
    def __get__(self, record: FrameRecord[Any], owner: type) -> Array: ...
    def __get__(self, record: FrameRecord[Any] | None, owner: type) -> Self | Array:
        if record is None:
            return self
        arranged: Array = record.layout.padded(getattr(record.points, self.name), self.empty)
        return arranged
