"""Picks as a CSV: frame or image, landmark, u_px, v_px and perhaps sigma_px."""

from __future__ import annotations

import numpy as np

from vopd.flight.csv_table import frames_of_cells, has_columns, read_csv
from vopd.flight.input_file import InputFile
from vopd.flight.pick_formats.pick_rows import PickRows


def recognises(file: InputFile) -> bool:
    """Whether the header names a landmark and pixels, or is near to that."""
    return has_columns(file, ("landmark",), ("u_px",), ("v_px",))


def read(file: InputFile) -> PickRows:
    """The picks of a CSV. Frames are whole numbers from 0, or names of images."""
    table = read_csv(file)
    key = "image" if table.has("image") else "frame"
    texts, landmark = table.column(key), table.column("landmark")
    if not texts:
        raise file.error("no pick is in the file")
    pixel = np.stack([table.numbers("u_px"), table.numbers("v_px")], axis=1)
    sigma = np.full(len(texts), np.nan)
    if table.has("sigma_px"):
        sigma = table.numbers("sigma_px", empty=np.nan)
    for row, (one, name) in enumerate(zip(texts, landmark, strict=True)):
        if not one or not name:
            raise table.error("the cell is empty", row, "landmark" if one else key)
        if sigma[row] <= 0.0:
            raise table.error(f"{sigma[row]:g} is not a standard deviation", row, "sigma_px")
    frame: list[int] | list[str] = texts if key == "image" else frames_of_cells(table, texts)
    return PickRows(frame, landmark, pixel, sigma, table.line, None, None, "CSV")
