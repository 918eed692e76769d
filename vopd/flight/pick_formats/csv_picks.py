"""Picks as a CSV: frame or image, landmark, u_px, v_px and perhaps sigma_px."""

from __future__ import annotations

import numpy as np

from vopd.flight.csv_table import (
    CsvTable,
    csv_blocks,
    frames_of_column,
    has_columns,
    read_csv,
    whole_numbers,
)
from vopd.flight.input_file import InputFile
from vopd.flight.pick_formats.pick_rows import Names, PickRows


def recognises(file: InputFile) -> bool:
    """Whether the header names a landmark and pixels, or is near to that."""
    return has_columns(file, ("landmark",), ("u_px",), ("v_px",))


def read(file: InputFile) -> PickRows:
    """The picks of a CSV, block by block. Frames are whole numbers from 0, or names of images."""
    frames, pixels, sigmas = [], [], []
    landmark, image = Names(), Names()
    for block in csv_blocks(file):
        _add_names(landmark, block, "landmark")
        if block.has("image"):
            _add_names(image, block, "image")
        else:
            frames.append(whole_numbers(block, "frame"))
        pixels.append(np.stack([block.numbers("u_px"), block.numbers("v_px")], axis=1))
        sigmas.append(block.sigmas("sigma_px"))
    if not len(landmark):
        raise file.error("no pick is in the file")
    number = [block for block in frames if block is not None]
    if len(number) < len(frames):  # names, or some of them are
        table = read_csv(file)
        frames_of_column(table)
        _add_names(image, table, "frame")
    return PickRows(
        np.concatenate(number) if number and not len(image) else image,
        landmark,
        np.concatenate(pixels),
        np.concatenate(sigmas),
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
