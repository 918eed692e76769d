"""COLMAP's cameras.txt: one camera a line, pixels counted from the image's corner."""

from __future__ import annotations

import re

from vopd.flight.files import InputFile
from vopd.flight.lens_formats.lens_parameters import LensQuestion, LensRead, checked, make_lens

MODELS = {  # model here, number of focal lengths, OpenCV positions of the coefficients
    "SIMPLE_PINHOLE": ("brown", 1, ()),
    "PINHOLE": ("brown", 2, ()),
    "SIMPLE_RADIAL": ("brown", 1, (0,)),
    "RADIAL": ("brown", 1, (0, 1)),
    "OPENCV": ("brown", 2, (0, 1, 2, 3)),
    "FULL_OPENCV": ("brown", 2, (0, 1, 2, 3, 4, 5, 6, 7)),
    "OPENCV_FISHEYE": ("fisheye", 2, (0, 1, 2, 3)),
    "SIMPLE_RADIAL_FISHEYE": ("fisheye", 1, (0,)),
    "RADIAL_FISHEYE": ("fisheye", 1, (0, 1)),
    "SIMPLE_FISHEYE": ("fisheye", 1, ()),
    "FISHEYE": ("fisheye", 2, ()),
}
LINE = re.compile(r"^\s*(\d+)\s+([A-Z][A-Z_]+)\s+(\d+)\s+(\d+)\s+\S", re.M)


def recognises(file: InputFile) -> bool:
    """Whether a line has a number, a model's name, and the image's size."""
    return bool(LINE.search(file.text))


def read(file: InputFile, question: LensQuestion) -> LensRead:
    """The lens of a cameras.txt; of several the one that the project names by its CAMERA_ID."""
    rows = [
        (number, line.split())
        for number, line in enumerate(file.text.splitlines(), 1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if question.camera is not None:
        rows = [row for row in rows if row[1][0] == question.camera]
    if len(rows) != 1:
        raise file.error(f"{len(rows)} cameras: name one by its number with [camera] camera")
    number, (_, name, *fields) = rows[0]
    if name not in MODELS:
        raise file.error(f"model {name} is not known; {', '.join(MODELS)} are", number)
    model, focals, places = MODELS[name]
    try:
        width, height, *values = (float(field) for field in fields)
    except ValueError as error:
        raise file.error(str(error), number) from error
    if len(values) != focals + 2 + len(places):
        raise file.error(
            f"{name} has {focals + 2 + len(places)} parameters, not {len(values)}", number
        )
    k = [0.0] * (4 if model == "fisheye" else 12)
    for place, value in zip(places, values[focals + 2 :], strict=True):
        k[place] = value
    centre = values[focals] - 0.5, values[focals + 1] - 0.5
    lens = make_lens(model, (int(width), int(height)), (values[0], values[focals - 1]), centre, k)
    said = f"{file.name}: COLMAP, {name}, corner grid, half a pixel taken off"
    return LensRead(checked(file, lens), said)
