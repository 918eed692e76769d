"""ODM's and OpenSfM's gcp_list.txt: landmarks and their picks in one file.

The first line is the coordinate reference system; each other line has x y z u v
image and mostly a name. x is the easting or the longitude. A point without a name
is known by its coordinates.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.flight.files import InputFile

CRS = re.compile(r"^(EPSG:\d+(\+\d+)?|['\"]?\+proj=.*|WGS ?84.*)$", re.I)


class GcpList(NamedTuple):
    """The rows of a gcp_list.txt."""

    crs: str
    position: Floats  # (n, 3) x y z as they stand
    pixel: Floats  # (n, 2) u, v from the first pixel's centre
    image: list[str]
    name: list[str]
    line: list[int]


def is_gcp_list(file: InputFile) -> bool:
    """Whether the first line is a coordinate reference system and others have numbers."""
    if not CRS.match(file.head[:500].lstrip().partition("\n")[0].strip()):
        return False
    lines = _lines(file)
    if len(lines) < 2:
        return False
    fields = lines[1][1].split()
    return len(fields) >= 6 and all(_is_number(field) for field in fields[:5])


def read_gcp_list(file: InputFile) -> GcpList:
    """The rows of a gcp_list.txt.

    Raises:
        VopdError: where a line is not as it should be
    """
    lines = _lines(file)
    numbers, images, names = [], [], []
    for number, line in lines[1:]:
        fields = line.split()
        if len(fields) < 6:
            raise file.error(f"{len(fields)} fields, not x y z u v image [name]", number)
        try:
            values = [float(field) for field in fields[:5]]
        except ValueError as error:
            raise file.error(str(error), number) from error
        if not np.isfinite(values).all():
            raise file.error("a number is not finite: a landmark needs x, y and height", number)
        numbers.append(values)
        images.append(fields[5])
        names.append(fields[6] if len(fields) > 6 else " ".join(fields[:3]))
    if not numbers:
        raise file.error("no line has a landmark")
    table = np.array(numbers)
    return GcpList(
        lines[0][1].strip("'\""), table[:, :3], table[:, 3:], images, names,
        [number for number, _ in lines[1:]],
    )  # fmt: skip


def _lines(file: InputFile) -> list[tuple[int, str]]:
    return [
        (number, line.strip())
        for number, line in enumerate(file.text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
