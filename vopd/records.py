"""Dataclasses of arrays: what a job and its results have in common.

The shape of an array is a part of its type: `Annotated[Floats, "F L 2"]` is an array of
F frames by L landmarks by two.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import fields
from types import SimpleNamespace
from typing import Any, ClassVar, Self

import numpy as np

from vopd.arrays import Ints
from vopd.landmark_layout import LandmarkLayout

_ARRAY = re.compile(r"Annotated\[(\w+), ['\"]([\w ]+)['\"]\]")
_KINDS = {"Floats": np.float64, "Ints": np.int64, "Bools": np.bool_}


class Record:
    """Base class of dataclasses of arrays: equal if all values are, NaN included; prints shapes."""

    def __repr__(self) -> str:
        names = (f.name for f in fields(self) if f.repr)  # type: ignore[arg-type]
        return f"{type(self).__name__}({', '.join(f'{n}={self._brief(n)}' for n in names)})"

    def _brief(self, name: str) -> str:
        value = getattr(self, name)
        return f"array{value.shape}" if isinstance(value, np.ndarray) else repr(value)

    def _compared(self) -> list[Any]:
        """The values that make two records equal."""
        return [getattr(self, f.name) for f in fields(self) if f.compare]  # type: ignore[arg-type]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Record) or type(self) is not type(other):
            return NotImplemented
        pairs = zip(self._compared(), other._compared(), strict=True)
        return all(_same(one, two) for one, two in pairs)


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray | float):
        return np.array_equal(one, other, equal_nan=np.asarray(one).dtype.kind == "f")
    return bool(one == other)


class LandmarkRecord(Record):
    """A record with arrays of frames by landmarks, which are kept without gaps.

    `points` has these arrays as (N, ...), one element for each landmark of each frame, by
    the `layout`. Under its own name each is an array (F, L, ...) that is made when it is
    asked for, with `EMPTY`, 0 or false where a frame has fewer landmarks than L.
    """

    EMPTY: ClassVar[float] = np.nan  # of real numbers
    SHAPES: ClassVar[dict[str, tuple[type, tuple[str, ...]]]]
    """The element type and the axes of every array, by field name."""
    BY_LANDMARK: ClassVar[tuple[str, ...]]
    """The fields that are arrays of frames by landmarks."""
    layout: LandmarkLayout
    points: SimpleNamespace

    def __init_subclass__(cls) -> None:
        arrays = {name: _ARRAY.fullmatch(str(kind)) for name, kind in cls.__annotations__.items()}
        cls.SHAPES = {
            name: (_KINDS[array[1]], tuple(array[2].split()))
            for name, array in arrays.items()
            if array is not None
        }
        cls.BY_LANDMARK = tuple(n for n, (_, axes) in cls.SHAPES.items() if axes[:2] == ("F", "L"))

    @classmethod
    def made(cls, layout: LandmarkLayout, **values: Any) -> Self:
        """Make a record of arrays that have no gaps.

        Args:
            layout: how many landmarks each frame has
            values: every field; arrays of frames by landmarks as (N, ...)
        """
        record = object.__new__(cls)
        record.__dict__.update(values)
        record.keep_flat(layout)
        return record

    @classmethod
    def joined(cls, records: Sequence[Self]) -> Self:
        """The frames of several records, one after the other.

        Args:
            records: one or more; what is not an array of frames is that of the first
        """
        if len(records) == 1:
            return records[0]
        own = [one.__dict__ | one.points.__dict__ for one in records]
        arrays = {name: np.concatenate([one[name] for one in own]) for name in cls.SHAPES}
        layout = LandmarkLayout(np.concatenate([one.layout.count for one in records]))
        others = {f.name: own[0][f.name] for f in fields(cls) if f.name not in arrays}  # type: ignore[arg-type]
        return cls.made(layout, **others, **arrays)

    def keep_flat(self, layout: LandmarkLayout) -> None:
        """Move the arrays of frames by landmarks into `points`.

        Args:
            layout: how many landmarks each frame has
        """
        values = self.__dict__
        points = SimpleNamespace()
        for name in self.BY_LANDMARK:
            array = values.pop(name)
            arranged = array.ndim == len(self.SHAPES[name][1])
            setattr(points, name, layout.flat(array) if arranged else array)
        values["layout"], values["points"] = layout, points

    def only(self, frames: Ints | slice) -> Self:
        """The record of some of its frames.

        Args:
            frames: their indices
        """
        own = self.__dict__
        points = self.points.__dict__
        values = {f.name: own[f.name] for f in fields(self) if f.name in own}  # type: ignore[arg-type]
        layout = self.layout.only(frames)
        if isinstance(frames, slice) and frames.step is None:
            first, last, _ = frames.indices(len(self.layout.count))
            before = int(self.layout.start[first]) if first < last else 0
            rows: Ints | slice = slice(before, before + layout.total)
        else:
            rows = self.layout.rows(np.arange(len(self.layout.count))[frames])
        values |= {name: array[rows] for name, array in points.items()}
        for name in self.SHAPES:
            if name not in points:
                values[name] = values[name][frames]
        return self.made(layout, **values)

    def __getattr__(self, name: str) -> Any:
        if name not in self.BY_LANDMARK or "points" not in self.__dict__:
            raise AttributeError(f"{type(self).__name__} has no {name!r}")
        array = getattr(self.points, name)
        return self.layout.padded(array, self.EMPTY if array.dtype.kind == "f" else 0)

    def _brief(self, name: str) -> str:
        if name not in self.BY_LANDMARK:
            return super()._brief(name)
        shape = len(self.layout.count), self.layout.widest
        return f"array{(*shape, *getattr(self.points, name).shape[1:])}"

    def _compared(self) -> list[Any]:
        arrays = self.BY_LANDMARK
        names = [f.name for f in fields(self) if f.compare and f.name not in arrays]  # type: ignore[arg-type]
        own = [getattr(self, name) for name in names]
        return [self.layout, *own, *(getattr(self.points, name) for name in arrays)]
