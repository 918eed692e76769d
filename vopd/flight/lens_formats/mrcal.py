"""mrcal's .cameramodel: a Python dict of literals, pixels from the first pixel's centre."""

from __future__ import annotations

import ast

from vopd.flight.files import UNEXPECTED, InputFile, reason
from vopd.flight.lens_formats.lens_parameters import (
    LensQuestion,
    LensRead,
    checked,
    coefficients_said,
    make_lens,
)

COUNTS = {"PINHOLE": 0, "OPENCV4": 4, "OPENCV5": 5, "OPENCV8": 8, "OPENCV12": 12}


def recognises(file: InputFile) -> bool:
    """Whether the text names a lens model of mrcal's."""
    return "LENSMODEL_" in file.text or "DISTORTION_OPENCV" in file.text


def read(file: InputFile, question: LensQuestion) -> LensRead:
    """The lens of a .cameramodel."""
    try:
        found = ast.literal_eval(file.text.strip())
        name = found.get("lensmodel", found.get("lens_model", found.get("distortion_model")))
        kind = (
            str(name)
            .removeprefix("LENSMODEL_")
            .removeprefix("DISTORTION_")
            .replace("NONE", "PINHOLE")
        )
        values = [float(value) for value in found["intrinsics"]]
        width, height = (int(value) for value in found["imagersize"])
    except (*UNEXPECTED, SyntaxError, MemoryError) as error:  # the last by deep nesting
        raise file.error(f"not a mrcal camera model: {reason(error, str(error))}") from error
    if kind not in COUNTS:
        raise file.error(f"model {name} is not known; LENSMODEL_ {', '.join(COUNTS)} are")
    if len(values) != 4 + COUNTS[kind]:
        raise file.error(f"{name} has {4 + COUNTS[kind]} intrinsics, not {len(values)}")
    lens = make_lens("brown", (width, height), values[:2], values[2:4], values[4:])
    said = f"{file.name}: mrcal, {coefficients_said(values[4:], 'brown')}, centre grid"
    return LensRead(checked(file, lens), said)
