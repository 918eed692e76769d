"""Picks as a CSV: frame or image, landmark, u_px, v_px and perhaps sigma_px."""

from __future__ import annotations

from array import array

import numpy as np

from vopd.flight.csv_table import CsvTable, frames_of_column, whole_numbers
from vopd.flight.files import InputFile
from vopd.flight.pick_formats.pick_rows import Names, PickRows
from vopd.flight.read_csv import csv_blocks, has_columns, read_csv


def recognises(file: InputFile) -> bool:
    """Whether the header names a landmark and pixels, or is near to that."""
    return has_columns(file, ("landmark",), ("u_px",), ("v_px",))


def read(file: InputFile) -> PickRows:
    """The picks of a CSV, block by block. Frames are whole numbers from 0, or names of images."""
    frame, pixel, sigma = array("q"), array("d"), array("d")
    landmark, image = Names(), Names()
    named = False
    for block in csv_blocks(file):
        _add_names(landmark, block, "landmark")
        if block.has("image"):
            _add_names(image, block, "image")
        elif not named:
            numbers = whole_numbers(block, "frame")
            named = numbers is None
            frame.frombytes(b"" if numbers is None else numbers.tobytes())
        both = np.stack([block.numbers("u_px"), block.numbers("v_px")], axis=1)
        pixel.frombytes(both.tobytes())
        if block.has("sigma_px"):
            sigma.frombytes(block.sigmas("sigma_px").tobytes())
    if not len(landmark):
        raise file.error("no pick is in the file")
    if named:  # or a number is wrong
        table = read_csv(file)
        frames_of_column(table)
        _add_names(image, table, "frame")
    return PickRows(
        image if len(image) else np.asarray(frame),
        landmark,
        np.asarray(pixel).reshape(-1, 2),
        np.asarray(sigma) if len(sigma) else np.broadcast_to(np.nan, len(landmark)),
        None,
        None,
        "CSV",
    )


def _add_names(names: Names, table: CsvTable, column: str) -> None:
    """Add the names of a column, none of which may be empty."""
    row = 0
    for block in table.blocks(column):
        if "" in block:
            raise table.error("the cell is empty", row + block.index(""), column)
        names.extend(block)
        row += len(block)
