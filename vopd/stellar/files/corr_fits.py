"""Read `corr.fits`, the matched stars that astrometry.net writes (`solve-field --corr`)."""

from __future__ import annotations

import io
import warnings
from typing import Any

import numpy as np

from vopd.arrays import Floats
from vopd.findings import DeckError, Finding, VopdError
from vopd.stellar.files.star_file import PixelFormat, StarFile

COLUMNS = ("field_x", "field_y", "index_ra", "index_dec")
"""Position of the image in pixels, and right ascension and declination of its star in degrees."""

FIRST_CENTRE = 1.0
"""Coordinate of the centre of the first pixel, as everywhere in FITS."""


def read_corr_fits(data: bytes, deck: str) -> StarFile:
    """Read the first table of a FITS file that has the columns of COLUMNS.

    Args:
        data: the file's bytes
        deck: its name in messages

    Returns:
        The stars. A column `mag` (or one whose name ends in `_mag`) is their magnitude.

    Raises:
        DeckError: the file is no FITS file, or has no such table.
        VopdError: where astropy is not installed.

    Source: astrometry.net, solver/onefield.c, `write_corr_file`.
    """
    try:
        from astropy.io import fits
    except ImportError as error:
        raise VopdError("astropy is not installed: pip install 'vopd[fits]'") from error
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of headers that bend the standard
            with fits.open(io.BytesIO(data), memmap=False) as units:
                tables = [_columns(unit) for unit in units]
    except Exception as error:  # astropy raises what its parts raise
        raise _error(f"not a FITS file that can be read: {error}", deck) from None
    found = next((table for table in tables if set(COLUMNS) <= set(table)), None)
    if found is None:
        raise _error(f"the FITS file has no table with the columns {', '.join(COLUMNS)}", deck)
    x, y, ra_deg, dec_deg = (found[name] for name in COLUMNS)
    if not len(x):
        raise _error("the table of matched stars is empty", deck)
    rows = np.column_stack([x, y, ra_deg, dec_deg])
    bad = ~np.isfinite(rows).all(axis=1) | (np.abs(rows[:, 3]) > 90.0)
    if bad.any():
        raise _error(f"row {int(np.argmax(bad)) + 1}: a coordinate is not a number in range", deck)
    magnitudes = [name for name in found if name == "mag" or name.endswith("_mag")]
    return StarFile(
        deck,
        tuple(range(1, len(rows) + 1)),
        ("",) * len(rows),
        rows[:, :2],
        "px",
        "ra_deg,dec_deg",
        rows[:, 2:],
        magnitude=found[magnitudes[0]] if magnitudes else None,
        pixels=PixelFormat(FIRST_CENTRE),
        line_word="row",
    )


def _columns(unit: Any) -> dict[str, Floats]:
    """The columns of numbers of one part of a FITS file, by their names in small letters."""
    table = getattr(unit, "data", None)
    if table is None or getattr(table, "names", None) is None:
        return {}
    columns = {name.lower(): np.asarray(table[name]) for name in table.names}
    return {
        name: values.astype(np.float64)
        for name, values in columns.items()
        if values.ndim == 1 and values.dtype.kind in "iuf"
    }


def _error(message: str, deck: str) -> DeckError:
    return DeckError(Finding(message, deck=deck))
