"""Plate solutions as JSON: one, an array of them, or one a line, and which line is wrong."""

from __future__ import annotations

import json

import pytest

from vopd.findings import Finding, InputError
from vopd.stellar.files.plate_solvers import read_plate_solutions
from vopd.stellar.files.read import StarFile

ONE = {
    "matched_centroids": [[10.0, 20.0], [30.0, 40.0]],
    "matched_stars": [[80.0, -5.0, 2.5], [81.0, 6.0, 3.5]],
}


def read(text: str) -> tuple[list[StarFile], list[Finding]]:
    found: list[Finding] = []
    return read_plate_solutions(text, "solved.json", found.append), found


SHAPES = {  # a text: the names of its photographs
    "one": (json.dumps(ONE), [""]),
    "one, on several lines": (json.dumps(ONE, indent=2), [""]),
    "an array of one": (json.dumps([ONE]), [""]),
    "an array of two": (json.dumps([ONE, ONE]), ["1", "2"]),
    "two lines": (f"{json.dumps(ONE)}\n{json.dumps(ONE)}\n", ["1", "2"]),
    "three lines, one blank": (
        f"{json.dumps(ONE)}\n\n{json.dumps(ONE)}\n  {json.dumps(ONE)}", ["1", "2", "3"],
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
    f"{json.dumps(ONE)}\n{{": "line 2: not JSON: ",
    f"{json.dumps(ONE)}\n\n{json.dumps(ONE)}\n{{,": "line 4: not JSON: ",
    f"\n\n{json.dumps(ONE)}\n{{,": "line 4: not JSON: ",
    f"{json.dumps(ONE)}\n7": "not JSON: ",
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
    files, (found,) = read(json.dumps([ONE, ONE | changes, ONE]))
    assert [one.photograph for one in files] == ["1", "3"]
    assert str(found) == f"solved.json: photograph 2: {message}"
    with pytest.raises(InputError) as caught:
        read(json.dumps(ONE | changes))
    assert str(caught.value) == f"solved.json: {message}"
    near = {"FOV": 179.0, "distortion": 0.99, "matched_stars": [[1.0, 90.0], [2.0, -90.0]]}
    assert len(read(json.dumps(ONE | near))[0]) == 1
