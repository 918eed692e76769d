"""Read the photographs of an input file, whichever of the known formats it has."""

from __future__ import annotations

from vopd.findings import Report
from vopd.stellar.files.corr_fits import read_corr_fits
from vopd.stellar.files.input_text import as_text, read_bytes
from vopd.stellar.files.plate_solvers import read_plate_solutions
from vopd.stellar.files.read import read_star_csv
from vopd.stellar.files.star_file import StarFile

FITS = b"SIMPLE  ="
"""How every FITS file begins."""


def read_photographs(name: str, report: Report) -> list[StarFile]:
    """Read the photographs of a file: CSV, a plate solution in JSON, or astrometry.net's corr.fits.

    The format is known by the content, not by the name.

    Args:
        name: the file's name; `-` is standard input
        report: takes warnings, and errors of one photograph of several

    Raises:
        DeckError: the file cannot be read, or is none of these.
        VopdError: where a package that the format needs is not installed.
    """
    data, deck = read_bytes(name)
    if data.startswith(FITS):
        return [read_corr_fits(data, deck)]
    text = as_text(data, deck)
    if text.lstrip()[0] in "{[":
        return read_plate_solutions(text, deck, report)
    return read_star_csv(text, deck, report=report)
