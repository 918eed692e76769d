"""Matched stars of `corr.fits`: every column, limit and sentence."""

from __future__ import annotations

import io
import sys
import warnings
from typing import Any

import numpy as np
import pytest

from vopd.findings import InputError, VopdError
from vopd.stellar.files.plate_solvers import read_corr_fits
from vopd.stellar.files.read import StarFile

ROWS = {
    "field_x": [10.5, 20.5], "field_y": [30.0, 40.0], "index_ra": [80.0, 81.0],
    "index_dec": [-90.0, 90.0], "field_ra": [1.0, 2.0], "field_dec": [3.0, 4.0],
    "index_x": [5.0, 6.0], "index_y": [7.0, 8.0],
}  # fmt: skip


def form_of(data: np.ndarray) -> str:
    """The FITS code of a column: words, pairs of numbers, or numbers."""
    return "4A" if data.dtype.kind == "U" else "2D" if data.ndim > 1 else "D"


def corr(*tables: dict[str, Any]) -> StarFile:
    """Read a FITS file with these tables."""
    fits = pytest.importorskip("astropy.io.fits")
    units = [fits.PrimaryHDU()]
    for table in tables:
        columns = [
            fits.Column(name, form_of(np.array(data)), array=np.array(data))
            for name, data in table.items()
        ]
        units.append(fits.BinTableHDU.from_columns(columns))
    page = io.BytesIO()
    fits.HDUList(units).writeto(page)
    return read_corr_fits(page.getvalue(), "corr.fits")


def test_every_column_of_corr_fits() -> None:
    """The first table that has them is read; names may be in capitals."""
    upper = {name.upper(): data for name, data in ROWS.items()}
    other = ROWS | {"field_x": [0.0, 0.0]}
    file = corr({"field_x": [9.0]}, upper, other)
    assert (file.deck, file.lines, file.names) == ("corr.fits", (1, 2), ("", ""))
    assert (file.unit, file.kind, file.line_word) == ("px", "ra_deg,dec_deg", "row")
    assert file.image.tolist() == [[10.5, 30.0], [20.5, 40.0]]
    assert file.positions.tolist() == [[80.0, -90.0], [81.0, 90.0]]
    assert (file.pixels.first_centre, file.pixels.y_down) == (1.0, False)
    assert (file.pixels.field_of_view_deg, file.pixels.distortion) == (None, 0.0)
    assert file.magnitude is None and file.photograph == ""


MAGNITUDES: dict[str, tuple[dict[str, Any], list[float] | None]] = {
    "mag": ({"mag": [1.0, 2.0]}, [1.0, 2.0]),
    "of a catalogue": ({"phot_g_mean_mag": [1.0, 2.0], "b_mag": [3.0, 4.0]}, [1.0, 2.0]),
    "another word": ({"xmag": [1.0, 2.0]}, None),
    "words": ({"mag": ["a", "b"]}, None),
    "pairs": ({"mag": [[1.0, 2.0], [3.0, 4.0]]}, None),
}


@pytest.mark.parametrize("name", MAGNITUDES)
def test_magnitudes(name: str) -> None:
    columns, expected = MAGNITUDES[name]
    found = corr(ROWS | columns).magnitude
    assert (None if found is None else found.tolist()) == expected


def test_whole_numbers_are_numbers() -> None:
    fits = pytest.importorskip("astropy.io.fits")
    columns = [fits.Column(name, "J", array=np.array([1, 2])) for name in ROWS]
    page = io.BytesIO()
    fits.BinTableHDU.from_columns(columns).writeto(page)
    assert read_corr_fits(page.getvalue(), "a").image.tolist() == [[1.0, 1.0], [2.0, 2.0]]


RANGE = "a coordinate is not a number in range"
NO_TABLE = "the FITS file has no table with the columns field_x, field_y, index_ra, index_dec"
WRONG_TABLES: dict[str, tuple[dict[str, Any], str]] = {
    "x": ({"field_x": [np.nan, 1.0]}, f"row 1: {RANGE}"),
    "y": ({"field_y": [1.0, np.inf]}, f"row 2: {RANGE}"),
    "ra": ({"index_ra": [1.0, np.nan]}, f"row 2: {RANGE}"),
    "north": ({"index_dec": [1.0, 90.01]}, f"row 2: {RANGE}"),
    "south": ({"index_dec": [-90.01, np.nan]}, f"row 1: {RANGE}"),
    "words": ({"index_ra": ["a", "b"]}, NO_TABLE),
    "none": ({name: np.zeros(0) for name in ROWS}, "the table of matched stars is empty"),
}


@pytest.mark.parametrize("name", WRONG_TABLES)
def test_tables_that_are_refused(name: str) -> None:
    changes, message = WRONG_TABLES[name]
    with pytest.raises(InputError) as caught:
        corr(ROWS | changes)
    assert str(caught.value) == f"corr.fits: {message}"


def test_what_is_no_fits_file_is_an_error_without_warnings(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whatever astropy raises, and without what it says about headers."""
    fits = pytest.importorskip("astropy.io.fits")

    def opened(*_: Any, **__: Any) -> None:
        warnings.warn("a header bends the standard", UserWarning, stacklevel=1)
        raise RuntimeError("too short")

    with pytest.raises(InputError, match=r"^a: not a FITS file that can be read: "):
        read_corr_fits(b"SIMPLE  =" + b"x" * 3000, "a")
    monkeypatch.setattr(fits, "open", opened)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError) as caught:
            read_corr_fits(b"SIMPLE  =", "a")
    assert str(caught.value) == "a: not a FITS file that can be read: too short"


def test_a_package_that_lacks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "astropy.io.fits", None)
    with pytest.raises(VopdError) as caught:
        read_corr_fits(b"SIMPLE  =", "a")
    assert str(caught.value) == "astropy is not installed: pip install 'vopd[fits]'"
