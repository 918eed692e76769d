"""ODM's geo.txt: a coordinate reference system, then image, x, y, z and more, a line each."""

from __future__ import annotations

import numpy as np

from vopd.flight.files import InputFile
from vopd.flight.formats.landmarks import CRS
from vopd.flight.track_formats.track_rows import TrackRows


def recognises(file: InputFile) -> bool:
    """Whether the first line is a coordinate reference system and others begin with a name."""
    lines = file.text.split("\n", 1)
    return len(lines) > 1 and bool(CRS.match(lines[0].strip()))


def read(file: InputFile) -> TrackRows:
    """The positions of a geo.txt; its angles are not used."""
    images, values, numbers = [], [], []
    for number, line in enumerate(file.text.splitlines(), 1):
        fields = line.split()
        if number == 1 or not fields or fields[0].startswith("#"):
            continue
        if len(fields) < 4:
            raise file.error("a line needs image, x, y and z", number)
        try:
            values.append([float(field) for field in fields[1:4]])
        except ValueError as error:
            raise file.error(str(error), number) from error
        if not np.isfinite(values[-1]).all():
            raise file.error("a position is not finite", number)
        images.append(fields[0])
        numbers.append(number)
    if not images:
        raise file.error("no position is in the file")
    crs = file.text.splitlines()[0].strip()
    return TrackRows(
        np.array(values), False, crs, None, None,
        f"ODM geo.txt, {len(images)} images, x east or longitude; its angles are not used",
        images, None, numbers,
    )  # fmt: skip
