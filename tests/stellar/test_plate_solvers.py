"""Matched stars of plate solvers."""

from __future__ import annotations

import io
import json
import sys
import warnings
from typing import Any

import numpy as np
import pytest

from vopd.findings import Finding, InputError, VopdError
from vopd.stellar.files.plate_solvers import read_corr_fits, read_plate_solutions
from vopd.stellar.files.read import StarFile

# Plate solutions as JSON: every key, limit and sentence


ONE: dict[str, Any] = {
    "matched_centroids": [[10.0, 20.0], [30.0, 40.0]],
    "matched_stars": [[80.0, -90.0, 2.5], [181.0, 90.0, 3.5]],
}


def plate(*solutions: Any) -> tuple[list[StarFile], list[Finding]]:
    found: list[Finding] = []
    text = json.dumps(solutions[0] if len(solutions) == 1 else solutions)
    return read_plate_solutions(text, "a.json", found.append), found


def test_every_key_of_a_plate_solution() -> None:
    """Everything else in the dictionary means nothing."""
    more = {"FOV": 11.5, "distortion": -0.02, "matched_catID": [5, [1, 22, 3]], "fov": 3, "k1": 4}
    (file,), found = plate(ONE | more)
    assert (file.names, file.line_word, file.photograph) == (("5", "1-22-3"), "match", "")
    assert (file.pixels.field_of_view_deg, file.pixels.distortion) == (11.5, -0.02)
    assert (file.pixels.first_centre, file.pixels.y_down) == (0.5, True)
    assert found == [] and file.source == "a.json"
    assert str(file.finding("x", 0, 1)) == "a.json: matches 1 and 2: x"


BARE: dict[str, dict[str, Any]] = {
    "nothing": {},
    "null": {"FOV": None, "distortion": None, "matched_catID": None},
    "too few names": {"matched_catID": [5]},
    "no list of names": {"matched_catID": "ab"},
}


@pytest.mark.parametrize("name", BARE)
def test_what_need_not_be_there(name: str) -> None:
    (file,), _ = plate(ONE | BARE[name] | {"matched_stars": [[80.0, -90.0], [181.0, 90.0]]})
    assert (file.names, file.magnitude) == (("", ""), None)
    assert (file.pixels.field_of_view_deg, file.pixels.distortion) == (None, 0.0)


def test_a_magnitude_need_not_be_known() -> None:
    (file,), _ = plate(ONE | {"matched_stars": [[80.0, 1.0, None], [181.0, 2.0, 3.5]]})
    assert file.magnitude is not None
    np.testing.assert_array_equal(file.magnitude, [np.nan, 3.5])


MATCHES = (
    "no matched_centroids and matched_stars: a star file in JSON is the dictionary that "
    "tetra3 gives with return_matches=True, where it has found a match"
)
PAIRS = (
    "matched_centroids must be pairs y, x and matched_stars as many triples "
    "right ascension, declination, magnitude"
)
NUMBER = "an entry of the plate solution is not a number"
FINITE = "a coordinate of the plate solution is not a finite number"
BEYOND = "a declination of the plate solution is beyond +-90"
REFUSED: dict[str, tuple[Any, str]] = {
    "no dictionary": (7, MATCHES),
    "no centroids": ({"matched_stars": [[1, 2, 3]]}, MATCHES),
    "no stars": ({"matched_centroids": [[1, 2]]}, MATCHES),
    "no match": (ONE | {"matched_centroids": [], "matched_stars": []}, MATCHES),
    "no match of one": (ONE | {"matched_stars": None}, MATCHES),
    "FOV is a word": (ONE | {"FOV": "wide"}, NUMBER),
    "FOV is a list": (ONE | {"FOV": [1.0]}, NUMBER),
    "ragged": (ONE | {"matched_stars": [[1, 2, 3], [1]]}, NUMBER),
    "distortion is a list": (ONE | {"distortion": [1.0]}, NUMBER),
    "triples of pixels": (ONE | {"matched_centroids": [[1, 2, 3], [4, 5, 6]]}, PAIRS),
    "no pairs": (ONE | {"matched_centroids": [1.0, 2.0]}, PAIRS),
    "as many": (ONE | {"matched_stars": [[1, 2, 3]]}, PAIRS),
    "more": (ONE | {"matched_stars": [[1, 2, 3]] * 3}, PAIRS),
    "numbers": (ONE | {"matched_stars": [1.0, 2.0]}, PAIRS),
    "four": (ONE | {"matched_stars": [[1, 2, 3, 4]] * 2}, PAIRS),
    "one": (ONE | {"matched_stars": [[1], [2]]}, PAIRS),
    "pixel": (ONE | {"matched_centroids": [[1, 2], [3, np.nan]]}, FINITE),
    "right ascension": (ONE | {"matched_stars": [[np.inf, 2, 3], [1, 2, 3]]}, FINITE),
    "declination": (ONE | {"matched_stars": [[1, np.nan, 3], [1, 2, 3]]}, FINITE),
    "too far north": (ONE | {"matched_stars": [[1, 2, 3], [1, 90.01, 3]]}, BEYOND),
    "too far south": (ONE | {"matched_stars": [[1, 2, 3], [1, -90.01, 3]]}, BEYOND),
    "FOV below": (ONE | {"FOV": -5}, "FOV: -5 is not between 0 and 180 degrees"),
    "FOV zero": (ONE | {"FOV": 0}, "FOV: 0 is not between 0 and 180 degrees"),
    "FOV above": (ONE | {"FOV": 180}, "FOV: 180 is not between 0 and 180 degrees"),
    "barrel": (ONE | {"distortion": -1}, "distortion: -1 is not between -1 and 1"),
    "cushion": (ONE | {"distortion": 1}, "distortion: 1 is not between -1 and 1"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_plate_solutions_that_are_refused(name: str) -> None:
    """Of several the others are read, and the number of the wrong one is said."""
    wrong, message = REFUSED[name]
    with pytest.raises(InputError) as caught:
        plate(wrong)
    assert str(caught.value) == f"a.json: {message}"
    files, found = plate(ONE, ONE, wrong)
    assert [one.photograph for one in files] == ["1", "2"]
    assert found == [Finding(f"photograph 3: {message}", source="a.json")]


DEEP = "[" * 100_000


def test_what_is_no_json() -> None:
    texts = {
        "": "not JSON: ",
        DEEP: "not JSON: ",
        f'{json.dumps(ONE)}\n\n{{"a":{DEEP}': "line 3: not ",
    }
    for text, message in texts.items():
        with pytest.raises(InputError) as caught:
            read_plate_solutions(text, "a.json", list[Finding]().append)
        assert str(caught.value).startswith(f"a.json: {message}")
    with pytest.raises(InputError, match=r"^a\.json: line 2: not JSON: Expecting value"):
        read_plate_solutions(f'{json.dumps(ONE)}\n{{"a": }}\n', "a.json", list[Finding]().append)
    with pytest.raises(InputError, match=r"^a\.json: the file has no plate solution$"):
        read_plate_solutions("[]", "a.json", list[Finding]().append)


# Plate solutions as JSON: one, an array of them, or one a line, and which line is wrong


ONE_LINES = {
    "matched_centroids": [[10.0, 20.0], [30.0, 40.0]],
    "matched_stars": [[80.0, -5.0, 2.5], [81.0, 6.0, 3.5]],
}


def read(text: str) -> tuple[list[StarFile], list[Finding]]:
    found: list[Finding] = []
    return read_plate_solutions(text, "solved.json", found.append), found


SHAPES = {  # a text: the names of its photographs
    "one": (json.dumps(ONE_LINES), [""]),
    "one, on several lines": (json.dumps(ONE_LINES, indent=2), [""]),
    "an array of one": (json.dumps([ONE_LINES]), [""]),
    "an array of two": (json.dumps([ONE_LINES, ONE_LINES]), ["1", "2"]),
    "two lines": (f"{json.dumps(ONE_LINES)}\n{json.dumps(ONE_LINES)}\n", ["1", "2"]),
    "three lines, one blank": (
        f"{json.dumps(ONE_LINES)}\n\n{json.dumps(ONE_LINES)}\n  {json.dumps(ONE_LINES)}",
        ["1", "2", "3"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SHAPES)
def test_every_shape(name: str) -> None:
    text, photographs = SHAPES[name]
    files, found = read(text)
    assert [one.photograph for one in files] == photographs and found == []
    for one in files:
        assert one.image.tolist() == [[20.0, 10.0], [40.0, 30.0]]  # centroids are y, x
        assert one.positions.tolist() == [[80.0, -5.0], [81.0, 6.0]]
        assert one.magnitude is not None and one.magnitude.tolist() == [2.5, 3.5]
        assert (one.unit, one.kind, one.lines) == ("px", "ra_deg,dec_deg", (1, 2))
        assert one.pixels.first_centre == 0.5 and one.pixels.y_down


WRONG = {
    "{": "not JSON: ",
    "[1, 2": "not JSON: ",
    f"{json.dumps(ONE_LINES)}\n{{": "line 2: not JSON: ",
    f"{json.dumps(ONE_LINES)}\n\n{json.dumps(ONE_LINES)}\n{{,": "line 4: not JSON: ",
    f"\n\n{json.dumps(ONE_LINES)}\n{{,": "line 4: not JSON: ",
    f"{json.dumps(ONE_LINES)}\n7": "not JSON: ",
    "[]": "the file has no plate solution",
}


@pytest.mark.parametrize("text", WRONG, ids=repr)
def test_what_is_not_json(text: str) -> None:
    with pytest.raises(InputError) as caught:
        read(text)
    assert str(caught.value).startswith(f"solved.json: {WRONG[text]}")


BAD = {
    "FOV": ({"FOV": 0.0}, "FOV: 0 is not between 0 and 180 degrees"),
    "FOV too wide": ({"FOV": 180.0}, "FOV: 180 is not between 0 and 180 degrees"),
    "distortion": ({"distortion": -1.0}, "distortion: -1 is not between -1 and 1"),
    "declination": (
        {"matched_stars": [[1.0, 90.5], [2.0, 0.0]]},
        "a declination of the plate solution is beyond +-90",
    ),
    "number": ({"FOV": "wide"}, "an entry of the plate solution is not a number"),
}


@pytest.mark.parametrize("name", BAD)
def test_one_of_several_that_is_wrong_costs_the_others_nothing(name: str) -> None:
    changes, message = BAD[name]
    files, (found,) = read(json.dumps([ONE_LINES, ONE_LINES | changes, ONE_LINES]))
    assert [one.photograph for one in files] == ["1", "3"]
    assert str(found) == f"solved.json: photograph 2: {message}"
    with pytest.raises(InputError) as caught:
        read(json.dumps(ONE_LINES | changes))
    assert str(caught.value) == f"solved.json: {message}"
    near = {"FOV": 179.0, "distortion": 0.99, "matched_stars": [[1.0, 90.0], [2.0, -90.0]]}
    assert len(read(json.dumps(ONE_LINES | near))[0]) == 1


# Matched stars of `corr.fits`: every column, limit and sentence


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
    assert (file.source, file.lines, file.names) == ("corr.fits", (1, 2), ("", ""))
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
