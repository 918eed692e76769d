"""Matched stars of plate solvers: the tetra3 family and astrometry.net."""

from __future__ import annotations

import io
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np

from vopd.arrays import Floats
from vopd.files import optional_package, reason
from vopd.findings import Finding, InputError, Report, input_error
from vopd.inputs import parse_json
from vopd.stellar.files.read import LIMIT, LIMITS, PixelFormat, StarFile

# The tetra3 family, as JSON
#
# `tetra3` and `cedar-solve` give a dictionary; with `return_matches=True` it has
# `matched_centroids` (y, x in pixels, y downward, .5 the centre of the first pixel),
# `matched_stars` (right ascension and declination in degrees, magnitude),
# `matched_catID`, the horizontal field of view `FOV` in degrees and `distortion`.

NEEDED = ("matched_centroids", "matched_stars")
FIRST_CENTRE = 0.5
LEAST_FIELD_DEG = 1e-6  # of view: a principal distance of 1e11 px and more is none


def read_plate_solutions(text: str, source: str, report: Report) -> list[StarFile]:
    """Read one solution, an array of them, or one a line.

    Raises:
        InputError: the text is not JSON, or its one solution has no matched stars.
    """
    solutions = list(_solutions(text, source))
    if not solutions:
        raise input_error("the file has no plate solution", source)
    found = []
    for k, solution in enumerate(solutions, start=1):
        try:
            found.append(_star_file(solution, str(k) if len(solutions) > 1 else "", source))
        except InputError as error:
            if len(solutions) == 1:
                raise
            report(error.finding)
    return found


def _solutions(text: str, source: str) -> Iterator[Any]:
    """Read the JSON values of a text: one, those of an array, or those of its lines."""
    try:
        whole = parse_json(text)
    except (ValueError, RecursionError) as error:
        lines = [(n, line) for n, line in enumerate(text.splitlines(), start=1) if line.strip()]
        if len(lines) < 2 or not all(line.lstrip().startswith("{") for _, line in lines):
            raise input_error(f"not JSON: {reason(error)}", source) from None
        for number, line in lines:
            try:
                yield parse_json(line)
            except (ValueError, RecursionError) as wrong:
                why = reason(wrong).removeprefix("line 1, ")
                finding = Finding(f"line {number}: not JSON: {why}", source=source)
                raise InputError(finding) from None
        return
    yield from whole if isinstance(whole, list) else [whole]


def _star_file(solution: Any, name: str, source: str) -> StarFile:
    """Read the stars of one solution."""
    where = f"photograph {name}: " if name else ""
    if not isinstance(solution, dict) or any(not solution.get(key) for key in NEEDED):
        raise input_error(
            f"{where}no {' and '.join(NEEDED)}: a star file in JSON is the dictionary that "
            "tetra3 gives with return_matches=True, where it has found a match",
            source,
        )
    try:
        centroids = _numbers(solution["matched_centroids"])
        stars = _numbers(solution["matched_stars"])
        field_of_view = solution.get("FOV")
        degrees = None if field_of_view is None else _number(field_of_view)
        distortion = _number(solution.get("distortion") or 0.0)
    except (TypeError, ValueError, OverflowError, RecursionError):
        raise input_error(
            f"{where}an entry of the plate solution is not a number", source
        ) from None
    count = centroids.size // 2
    if (
        centroids.shape != (count, 2)
        or stars.ndim != 2
        or stars.shape not in [(count, 2), (count, 3)]
    ):
        raise input_error(
            f"{where}matched_centroids must be pairs y, x and matched_stars as many triples "
            "right ascension, declination, magnitude",
            source,
        )
    if not (np.isfinite(centroids).all() and np.isfinite(stars[:, :2]).all()):
        raise input_error(
            f"{where}a coordinate of the plate solution is not a finite number", source
        )
    if (np.abs(centroids) > LIMIT).any():
        raise input_error(f"{where}a pixel of the plate solution is beyond +-{LIMIT:g}", source)
    for k, what, column in ((0, "right ascension", "ra_deg"), (1, "declination", "dec_deg")):
        if (np.abs(stars[:, k]) > LIMITS[column]).any():
            beyond = f"is beyond +-{LIMITS[column]:g}"
            raise input_error(f"{where}a {what} of the plate solution {beyond}", source)
    if degrees is not None and not LEAST_FIELD_DEG <= degrees < 180.0:
        limits = f"between {LEAST_FIELD_DEG:g} and 180 degrees"
        raise input_error(f"{where}FOV: {degrees:g} is not {limits}", source)
    if not abs(distortion) < 1.0:
        raise input_error(f"{where}distortion: {distortion:g} is not between -1 and 1", source)
    return StarFile(
        source,
        tuple(range(1, count + 1)),
        _names(solution.get("matched_catID"), count),
        centroids[:, ::-1],
        "px",
        "ra_deg,dec_deg",
        stars[:, :2],
        photograph=name,
        magnitude=stars[:, 2] if stars.shape[1] > 2 else None,
        pixels=PixelFormat(FIRST_CENTRE, True, degrees, distortion),
        line_word="match",
    )


def _number(value: Any) -> float:
    """Take a number of JSON; `float` also takes `true` and "1"."""
    if type(value) not in (int, float):
        raise TypeError
    return float(value)


def _numbers(values: Any) -> Floats:
    """Take numbers of JSON, or null; numpy also takes `true` and "1"."""
    found = np.array(values, dtype=object)
    if any(type(one) not in (int, float, type(None)) for one in found.flat):
        raise TypeError
    return found.astype(np.float64)


def _names(numbers: Any, count: int) -> tuple[str, ...]:
    """Format catalogue numbers as names; those of several parts (Tycho) with hyphens between."""
    if not isinstance(numbers, list) or len(numbers) != count:
        return ("",) * count
    return tuple("-".join(map(str, one)) if isinstance(one, list) else str(one) for one in numbers)


# `corr.fits` of astrometry.net (`solve-field --corr`)

COLUMNS = ("field_x", "field_y", "index_ra", "index_dec")
"""Position of the image in pixels, and right ascension and declination of its star in degrees."""

CORR_FIRST_CENTRE = 1.0  # coordinate of the centre of the first pixel, as everywhere in FITS


def read_corr_fits(data: bytes, source: str) -> StarFile:
    """Read the first table of a FITS file that has the columns of COLUMNS.

    Returns:
        The stars. A column `mag` (or one whose name ends in `_mag`) is their magnitude.

    Raises:
        InputError: the file is no FITS file, or has no such table.
        VopdError: where astropy is not installed.

    Source: astrometry.net, solver/onefield.c, `write_corr_file`.
    """
    fits = optional_package("astropy.io.fits", "fits")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of headers that bend the standard
            with fits.open(io.BytesIO(data), memmap=False) as units:
                tables = [_columns(unit) for unit in units]
    except Exception as error:  # astropy raises what its parts raise
        raise input_error(f"not a FITS file that can be read: {reason(error)}", source) from None
    found = next((table for table in tables if set(COLUMNS) <= set(table)), None)
    if found is None:
        raise input_error(
            f"the FITS file has no table with the columns {', '.join(COLUMNS)}", source
        )
    x, y, ra_deg, dec_deg = (found[name] for name in COLUMNS)
    if not len(x):
        raise input_error("the table of matched stars is empty", source)
    rows = np.column_stack([x, y, ra_deg, dec_deg])
    most = [LIMIT, LIMIT, LIMITS["ra_deg"], LIMITS["dec_deg"]]
    bad = ~(np.abs(rows) <= most).all(axis=1)
    if bad.any():
        raise input_error(
            f"row {int(np.argmax(bad)) + 1}: a coordinate is not a number in range", source
        )
    magnitudes = [name for name in found if name == "mag" or name.endswith("_mag")]
    return StarFile(
        source,
        tuple(range(1, len(rows) + 1)),
        ("",) * len(rows),
        rows[:, :2],
        "px",
        "ra_deg,dec_deg",
        rows[:, 2:],
        magnitude=found[magnitudes[0]] if magnitudes else None,
        pixels=PixelFormat(CORR_FIRST_CENTRE),
        line_word="row",
    )


def _columns(unit: Any) -> dict[str, Floats]:
    """Read the columns of numbers of one part of a FITS file, by their names in small letters.

    Of whole numbers, that of TNULL stands for none.
    """
    table = getattr(unit, "data", None)
    if table is None or getattr(table, "names", None) is None:
        return {}
    found = {}
    for column in table.columns:
        values = np.asarray(table[column.name])
        if values.ndim == 1 and values.dtype.kind in "iuf":
            found[column.name.lower()] = numbers = values.astype(np.float64)
            if column.null not in (None, ""):  # as it is stored
                numbers[numbers == column.null * (column.bscale or 1) + (column.bzero or 0)] = (
                    np.nan
                )
    return found
