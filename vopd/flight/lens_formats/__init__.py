"""Formats of lens files, one row each; the next format is one more file and one more row."""

from __future__ import annotations

from vopd.flight.input_file import FileFormat
from vopd.flight.lens_formats import colmap, metashape, mrcal, opencv, opensfm
from vopd.flight.lens_formats.lens_parameters import LensRead

LENS_FORMATS: tuple[FileFormat[LensRead], ...] = (
    FileFormat("mrcal", mrcal.recognises, mrcal.read),
    FileFormat("Metashape XML", metashape.recognises, metashape.read),
    FileFormat("OpenSfM or ODM cameras.json", opensfm.recognises, opensfm.read),
    FileFormat("OpenCV yml, xml or json", opencv.recognises, opencv.read),
    FileFormat("COLMAP cameras.txt", colmap.recognises, colmap.read),
)
