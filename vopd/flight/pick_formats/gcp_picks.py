"""The picks in a gcp_list.txt."""

from __future__ import annotations

import numpy as np

from vopd.flight.files import InputFile
from vopd.flight.formats.landmarks import is_gcp_list, read_gcp_list
from vopd.flight.pick_formats.pick_rows import Names, PickRows

recognises = is_gcp_list


def read(file: InputFile) -> PickRows:
    """The picks of a gcp_list.txt; pixels are counted from the first pixel's centre."""
    rows = read_gcp_list(file)
    sigma = np.full(len(rows.line), np.nan)
    return PickRows(
        Names(rows.image), Names(rows.name), rows.pixel, sigma, "centre", None,
        "gcp_list.txt",
    )  # fmt: skip
