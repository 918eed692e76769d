"""The landmarks in a gcp_list.txt."""

from __future__ import annotations

import numpy as np

from vopd.flight.files import InputFile
from vopd.flight.formats.landmarks import is_gcp_list, read_gcp_list
from vopd.flight.landmark_formats.landmark_rows import LandmarkRows

recognises = is_gcp_list


def read(file: InputFile) -> LandmarkRows:
    """Each landmark of a gcp_list.txt once.

    Raises:
        VopdError: where one name has two positions
    """
    rows = read_gcp_list(file)
    first: dict[str, int] = {}
    for k, name in enumerate(rows.name):
        before = first.setdefault(name, k)
        if not np.array_equal(rows.position[k], rows.position[before]):
            raise file.error(
                f"{name} has another position than in line {rows.line[before]}", rows.line[k]
            )
    kept = list(first.values())
    return LandmarkRows(
        list(first), rows.position[kept], False, rows.crs, np.full(len(kept), np.nan),
        [rows.line[k] for k in kept], "gcp_list.txt, x east or longitude",
    )  # fmt: skip
