"""Solutions read back from JSON: every field, what need not be there, and what is refused."""

from __future__ import annotations

import io
import json
import sys
from pathlib import Path
from typing import Any

import pytest

from vopd.findings import InputError
from vopd.stellar.files.table import ReadSolution, read_solutions

ONE: dict[str, Any] = {
    "image": "night", "method": "svd", "stars": [3, 1], "names": ["Rigel", ""],
    "alpha_deg": 10.5, "delta_deg": -20.5, "swing_deg": 30.5,
    "omega_deg": 1, "phi_deg": 2, "kappa_deg": 3,
    "images_px": [[1.0, 2.0], [3.0, 4.0]], "residuals_px": [[0.1, 0.2], [0.3, 0.4]],
}  # fmt: skip


def read(folder: Path, what: Any) -> list[ReadSolution]:
    file = folder / "solved.json"
    file.write_text(what if isinstance(what, str) else json.dumps(what))
    return read_solutions(str(file))


def without(*names: str) -> dict[str, Any]:
    return {name: value for name, value in ONE.items() if name not in names}


def test_every_field(tmp_path: Path) -> None:
    """A star without a name has its number."""
    (one,) = read(tmp_path, [ONE])
    assert (one.image, one.method, one.labels, one.unit) == ("night", "svd", ("Rigel", "1"), "px")
    assert one.images.tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert one.residuals.tolist() == [[0.1, 0.2], [0.3, 0.4]]
    assert one.pointing == (10.5, -20.5, 30.5)


def test_what_need_not_be_there(tmp_path: Path) -> None:
    mm = {"images_mm": [[1.0, 2.0]], "residuals_mm": [[3.0, 4.0]], "stars": [7]}
    bare = without("image", "names", "images_px", "residuals_px") | mm
    one, other = read(tmp_path, [bare, ONE])
    assert (one.image, one.labels, one.unit, other.unit) == ("", ("7",), "mm", "px")
    assert (one.images.tolist(), one.residuals.tolist()) == ([[1.0, 2.0]], [[3.0, 4.0]])


WHAT = "not the JSON of `vopd stars solve`: "
TOGETHER = WHAT + "images and residuals do not go together"
FINITE = WHAT + "a coordinate is not a finite number"
NAMES = WHAT + "names and stars do not go together"
THREE = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]]
REFUSED: dict[str, tuple[Any, str]] = {
    "nothing": ([], "it has no solution"),
    "a number": ("7", WHAT + "'int' object is not iterable"),
    "no JSON": ("{", WHAT + "Expecting property name"),
    "too deep": ("[" * 100_000, WHAT),
    "a list of numbers": ([7], WHAT),
    "no images": ([without("images_px")], WHAT + "'images_mm'"),
    "no residuals": ([without("residuals_px")], WHAT + "'residuals_px'"),
    "no angle": ([without("swing_deg")], WHAT + "'swing_deg'"),
    "an angle that is none": ([ONE | {"delta_deg": None}], WHAT + "float() argument"),
    "one residual": ([ONE | {"residuals_px": [[0.1, 0.2]]}], TOGETHER),
    "triples": ([ONE | {"images_px": [[1, 2, 3]], "residuals_px": [[1, 2, 3]]}], TOGETHER),
    "no pairs": ([ONE | {"images_px": [1, 2], "residuals_px": [1, 2]}], TOGETHER),
    "an image that is none": ([ONE | {"images_px": [[1, 2], [None, 4]]}], FINITE),
    "a residual that is none": ([ONE | {"residuals_px": [[1, 2], [None, 4]]}], FINITE),
    "one name": ([ONE | {"names": ["Rigel"]}], NAMES),
    "three stars": ([ONE | {"stars": [1, 2, 3], "names": ["", "", ""]}], NAMES),
    "three images": ([ONE | {"images_px": THREE, "residuals_px": THREE}], NAMES),
    "one of two": ([ONE, without("method")], WHAT + "'method'"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(name: str, tmp_path: Path) -> None:
    what, said = REFUSED[name]
    with pytest.raises(InputError) as caught:
        read(tmp_path, what)
    assert str(caught.value).startswith(f"{tmp_path / 'solved.json'}: {said}")


def test_standard_input_has_a_name(monkeypatch: pytest.MonkeyPatch) -> None:
    for text, said in (("[]", "it has no solution"), ("7", WHAT)):
        monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text.encode())))
        with pytest.raises(InputError) as caught:
            read_solutions("-")
        assert str(caught.value).startswith(f"standard input: {said}")
