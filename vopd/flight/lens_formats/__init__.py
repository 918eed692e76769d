"""Formats of lens files, one row each; the next format is one more file and one more row."""

from __future__ import annotations

from vopd.flight.files import InputFormat
from vopd.flight.formats import lens as opencv
from vopd.flight.lens_formats import colmap, metashape, mrcal, opensfm
from vopd.flight.lens_formats.lens_parameters import LensRead

LENS_FORMATS: tuple[InputFormat[LensRead], ...] = (
    InputFormat("mrcal", mrcal.recognises, mrcal.read),
    InputFormat("Metashape XML", metashape.recognises, metashape.read),
    InputFormat("OpenSfM or ODM cameras.json", opensfm.recognises, opensfm.read),
    InputFormat("OpenCV yml, xml or json", opencv.recognises, opencv.read),
    InputFormat("COLMAP cameras.txt", colmap.recognises, colmap.read),
)
