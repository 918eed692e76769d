"""Columns of an Arrow table, made of the buffers of numpy arrays.

`pyarrow.array` would do, but it loads pandas wherever that is installed, a third of a second.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools, Floats


def arrow_column(values: NDArray[Any]) -> Any:
    """An Arrow array of one value, or one matrix, for each row; NaN is null.

    Args:
        values: numbers, truth values or texts (F,), or matrices (F, 3, 3)
    """
    import pyarrow as pa

    if values.ndim > 1:
        return _matrices(values)
    if values.dtype.kind == "U":
        return _texts(values)
    missing = np.isnan(values) if values.dtype.kind == "f" else np.zeros(len(values), bool)
    truth = values.dtype.kind == "b"
    kind = pa.bool_() if truth else pa.from_numpy_dtype(values.dtype)
    content = _bits(values) if truth else _buffer(values)
    return pa.Array.from_buffers(kind, len(values), [_present(missing), content])


def _texts(values: NDArray[np.str_]) -> Any:
    import pyarrow as pa

    texts = [text.encode("utf-8", "backslashreplace") for text in values.tolist()]
    content = [None, _offsets([len(text) for text in texts]), pa.py_buffer(b"".join(texts))]
    return pa.Array.from_buffers(pa.string(), len(texts), content)


def _matrices(values: Floats) -> Any:
    """Matrices as lists of rows; null where all elements are missing."""
    import pyarrow as pa

    missing: Bools = np.asarray(np.isnan(values).all(axis=(1, 2)))
    numbers = values[~missing].ravel()
    number = pa.Array.from_buffers(pa.float64(), len(numbers), [None, _buffer(numbers)])
    rows = len(numbers) // 3
    row = pa.Array.from_buffers(
        pa.list_(pa.float64()), rows, [None, _offsets([3] * rows)], children=[number]
    )
    content = [_present(missing), _offsets(np.where(missing, 0, 3))]
    return pa.Array.from_buffers(pa.list_(row.type), len(values), content, children=[row])


def _present(missing: Bools) -> Any:
    """The buffer that says which values there are; None where none is missing."""
    return _bits(~missing) if missing.any() else None


def _bits(marks: Bools) -> Any:
    return _buffer(np.packbits(marks, bitorder="little"))


def _offsets(lengths: Any) -> Any:
    """The buffer of where each list or text begins, and where the last ends."""
    return _buffer(np.concatenate([[0], np.cumsum(lengths)]).astype(np.int32))


def _buffer(values: NDArray[Any]) -> Any:
    import pyarrow as pa

    return pa.py_buffer(np.ascontiguousarray(values))
