"""Picks as a CSV: frame or image, landmark, u_px, v_px and perhaps sigma_px."""

from __future__ import annotations

import numpy as np

from vopd.flight.csv_table import CsvTable, frames_of_column, has_columns, read_csv
from vopd.flight.input_file import InputFile
from vopd.flight.pick_formats.pick_rows import PickRows


def recognises(file: InputFile) -> bool:
    """Whether the header names a landmark and pixels, or is near to that."""
    return has_columns(file, ("landmark",), ("u_px",), ("v_px",))


def read(file: InputFile) -> PickRows:
    """The picks of a CSV. Frames are whole numbers from 0, or names of images."""
    table = read_csv(file)
    by_image = table.has("image")
    landmark = _names(table, "landmark")
    if not landmark:
        raise file.error("no pick is in the file")
    frame = _names(table, "image") if by_image else frames_of_column(table)
    if isinstance(frame, list) and not by_image:
        frame = _names(table, "frame")
    pixel = np.stack([table.numbers("u_px"), table.numbers("v_px")], axis=1)
    sigma = np.full(len(landmark), np.nan)
    if table.has("sigma_px"):
        sigma = table.numbers("sigma_px", empty=np.nan)
        for row in np.flatnonzero(sigma <= 0.0).tolist():
            raise table.error(f"{sigma[row]:g} is not a standard deviation", row, "sigma_px")
    return PickRows(frame, landmark, pixel, sigma, table.line, None, None, "CSV")


def _names(table: CsvTable, column: str) -> list[str]:
    """The names of a column, none empty; the same name is the same object, which saves memory."""
    known: dict[str, str] = {}
    names = [known.setdefault(name, name) for block in table.blocks(column) for name in block]
    if "" in known:
        raise table.error("the cell is empty", names.index(""), column)
    return names
