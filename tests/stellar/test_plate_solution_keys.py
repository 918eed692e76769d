"""Plate solutions as JSON: every key, limit and sentence."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest

from vopd.findings import Finding, InputError
from vopd.stellar.files.plate_solvers import read_plate_solutions
from vopd.stellar.files.read import StarFile

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
    assert found == [] and file.deck == "a.json"
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
    assert found == [Finding(f"photograph 3: {message}", deck="a.json")]


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
