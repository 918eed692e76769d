"""Dataclasses of arrays: equality, printing, some rows of a record, several records in a row."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Sequence
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


def _brief(value: object) -> str:
    return f"array{value.shape}" if isinstance(value, np.ndarray) else repr(value)


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray | float):
        return np.array_equal(one, other, equal_nan=np.asarray(one).dtype.kind == "f")
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(_same(one[key], other[key]) for key in one)
    if isinstance(one, tuple):  # of arrays, too
        return len(one) == len(other) and all(map(_same, one, other))
    return bool(one == other)


@dataclass(frozen=True, eq=False, repr=False)
class Rows(Record):
    """A record of rows: all its arrays and lists have as many, and its `Rows` and dicts of them."""

    def take(self, rows: Ints | Bools | slice) -> Self:
        """Select some rows of the record.

        Args:
            rows: their indices, or a mark for each row
        """
        return replace(self, **{name: _taken(v, rows) for name, v in self.by_row().items()})

    @classmethod
    def concat(cls, records: Sequence[Self]) -> Self:
        """Concatenate the rows of several records.

        Args:
            records: one or more; what has no rows is that of the first
        """
        if len(records) == 1:
            return records[0]
        own = [one.by_row() for one in records]
        return replace(records[0], **{n: _concatenated([one[n] for one in own]) for n in own[0]})

    def by_row(self) -> dict[str, Any]:
        """List the values that have rows, by the names of their fields."""
        values = ((name, getattr(self, name)) for name in self.__dataclass_fields__)
        return {name: value for name, value in values if _has_rows(value)}


def _has_rows(value: object) -> bool:
    if isinstance(value, dict):
        return bool(value) and all(map(_has_rows, value.values()))
    return isinstance(value, (np.ndarray, Rows, list))


def _taken(value: Any, rows: Ints | Bools | slice) -> Any:
    if isinstance(value, np.ndarray):
        return value[rows]
    if isinstance(value, dict):
        return {key: _taken(one, rows) for key, one in value.items()}
    if isinstance(value, list):  # of texts, empty where no row has one
        return [value[k] for k in np.arange(len(value))[rows]] if value else value
    return value.take(rows)


def _concatenated(parts: list[Any]) -> Any:
    first = parts[0]
    if isinstance(first, dict):
        return {key: _concatenated([one[key] for one in parts]) for key in first}
    if isinstance(first, list):
        return [one for part in parts for one in part]
    return type(first).concat(parts) if isinstance(first, Rows) else np.concatenate(parts)


Marks = TypeVar("Marks", bound=Rows)


@dataclass(frozen=True, eq=False, repr=False)
class FrameRecord(Rows, Generic[Marks]):
    """A record of arrays by frame (F, ...), with a record `points` by landmark (N, ...).

    `layout` says which landmarks each frame has. `ByLandmark` makes an array by frame and
    landmark (F, L, ...) of one of `points`.
    """

    layout: LandmarkLayout
    points: Marks

    def take(self, rows: Ints | Bools | slice) -> Self:
        """Select some frames of the record.

        Args:
            rows: their indices, or a mark for each frame
        """
        every, layout = np.arange(len(self.layout.count)), self.layout.only(rows)
        if isinstance(rows, slice) and rows.step is None:  # views of consecutive landmarks
            first = int(self.layout.start[rows][0]) if len(every[rows]) else 0
            points = self.points.take(slice(first, first + layout.total))
        else:
            points = self.points.take(self.layout.rows(every[rows]))
        return replace(super().take(rows), layout=layout, points=points)

    @classmethod
    def concat(cls, records: Sequence[Self]) -> Self:
        """Concatenate the frames of several records.

        Args:
            records: one or more; what has no rows is that of the first
        """
        if len(records) == 1:
            return records[0]
        layout = LandmarkLayout(np.concatenate([one.layout.count for one in records]))
        points = type(records[0].points).concat([one.points for one in records])
        return replace(super().concat(records), layout=layout, points=points)

    def by_row(self) -> dict[str, Any]:
        """List the values by frame, by the names of their fields."""
        return {name: value for name, value in super().by_row().items() if name != "points"}


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


def alike_together(jobs: Iterable[tuple[Hashable, int]], enough: int) -> Iterator[list[int]]:
    """Group jobs that are alike, to be computed together: indices, about `enough` frames a group.

    Args:
        jobs: of each job what those that are alike have in common, and how many frames it has
        enough: frames at which a group ends
    """
    alike: dict[Hashable, list[int]] = {}
    frames: dict[Hashable, int] = {}
    for index, (kind, count) in enumerate(jobs):
        alike.setdefault(kind, []).append(index)
        frames[kind] = frames.get(kind, 0) + count
        if frames[kind] >= enough:
            del frames[kind]
            yield alike.pop(kind)
    yield from alike.values()
