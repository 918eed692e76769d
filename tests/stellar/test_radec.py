"""Program RADEC2's input and printout: every field, limit and sentence of what was typed."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit import rae_listings as listings
from tests.tolerances import assert_close
from vopd.findings import Finding, InputError
from vopd.stellar.radec import printout, radec2, radec_text, read_typed
from vopd.stellar.tables_1987 import EXACT_MM, FOCAL_LENGTH_MM, TRUTH_DEG

HEAD = ["76.", "1.", "2.", "3."]
END = "9999.9"


def typed(*lines: str) -> tuple[str, list[str], list[list[float]]]:
    """What was wrong, the warnings and the images."""
    found: list[Finding] = []
    try:
        focal, angles, images = read_typed("\n".join(lines), "typed.txt", found.append)
    except InputError as error:
        return str(error), [], []
    assert all(one.severity == "warning" and one.source == "typed.txt" for one in found)
    assert (focal, angles.tolist()) == (76.0, [1.0, 2.0, 3.0])
    return "", [str(one) for one in found], images.tolist()


ERRORS = {
    "nothing": [],
    "no omega": ["76."],
    "no phi": ["76.", "1."],
    "no kappa": ["76.", "1.", "2."],
    "no y": [*HEAD, "1."],
    "no second y": [*HEAD, "1.", "2.", "3."],
    "no image": HEAD,
    "the end at once": [*HEAD, END],
    "zero": ["0.", *HEAD[1:], "1.", "2."],
    "negative": ["-7.5", *HEAD[1:], "1.", "2."],
    "word": ["76.", "x1", "2.", "3."],
    "blanks": ["76.", "x 1", "2.", "3."],
    "x": [*HEAD, "1..", "2."],
    "y": [*HEAD, "1.", "2.", "3.", "4,"],
    "another alphabet": [*HEAD, "\u0663.", "2."],
    "1E9": [*HEAD, "1.", "1.E9", END],
    "-1E9": ["76.", "-1.E9", "2.", "3."],
    "1E300": [*HEAD, "1.", "0.E300", END],
}


@pytest.mark.parametrize("name", ERRORS)
def test_every_error_names_its_line_and_number(name: str) -> None:
    assert_approved(typed(*ERRORS[name])[0])


@pytest.mark.parametrize(
    ("field", "value", "point"),
    [
        ("76.", 76.0, True), ("7.6D1", 76.0, True), ("7.6d1", 76.0, True), ("7.6E+1", 76.0, True),
        ("7.6e1", 76.0, True), ("7.6+1", 76.0, True), ("760.-1", 76.0, True),
        (" 7 6 .", 76.0, True),
        ("76000000", 76.0, False), ("76D6", 76.0, False), ("76D+6", 76.0, False),
        ("76", 76e-6, False), ("-76000000", -76.0, False), ("+.5", 0.5, True), ("", 0.0, True),
        ("0", 0.0, True), (".", 0.0, True), ("-5E0", -5e-6, False),
        ("999999999.", 999999999.0, True),
        ("1.E-299", 1e-299, True),
    ],
)  # fmt: skip
def test_a_field_of_f15_6(field: str, value: float, point: bool) -> None:
    """Without a point the last six digits are the fraction; zero is zero either way."""
    wrong, warnings, images = typed(*HEAD, "1.", field, END)
    assert wrong == "" and len(images) == 1
    assert images[0][0] == 1.0
    assert_close("unit element", images[0][1] / value if value else images[0][1] + 1.0, 1.0)
    shown = field.replace(" ", "")
    assert bool(warnings) == (not point)
    assert_approved(warnings, parts=[f"{shown!r}"] if not point else [])


def test_columns_1_to_15_are_read_and_the_rest_is_named() -> None:
    """Fifteen columns are one number; what stands in column 16 is another matter."""
    _, warnings, images = typed(*HEAD, "00000000000012.", "000000000012.34", END)
    assert (warnings, images) == ([], [[12.0, 12.34]])
    _, warnings, images = typed(*HEAD, "1.", "000000000012.345", END)
    assert images == [[1.0, 12.34]]
    assert_approved(warnings)
    _, warnings, _ = typed(*HEAD, "1.", "          5" + "     x. y", END)
    assert_approved(warnings)


def test_where_the_images_end() -> None:
    """An x above 9999 ends them, 9999 itself does not; nor does any y; 50 at most."""
    assert typed(*HEAD, "9999.", "1.", END)[1:] == ([], [[9999.0, 1.0]])
    assert typed(*HEAD, "1.", "9999.9", "9999.1", "5.")[1:] == ([], [[1.0, 9999.9]])
    last = "typed.txt: no 9999.9 after the last image"
    assert typed(*HEAD, "1.", "2.")[1:] == ([last], [[1.0, 2.0]])
    fifty = ["1.", "2."] * 50
    assert typed(*HEAD, *fifty) == ("", [last], [[1.0, 2.0]] * 50)
    assert typed(*HEAD, *fifty, "7.", "8.") == ("", [], [[1.0, 2.0]] * 50)


def test_the_printout_is_that_of_the_formats() -> None:
    """Formats 10, 20 and 28 to 31 by hand; FORTRAN writes no zero before the point in F11.9."""
    stars = radec2(EXACT_MM, FOCAL_LENGTH_MM, TRUTH_DEG)
    m = listings.jnkmat(*TRUTH_DEG)

    def f11(value: float) -> str:
        text = f"{value:.9f}"
        return (text if len(text) <= 11 else text.replace("0.", ".")).rjust(11)

    lines = ["", " " * 10 + "ORIENTATION MATRIX"]
    for row in m:
        cells = "".join(f"{'':6}{value:12.9f}{'':6}" for value in row)
        lines += [cells.rstrip(), ""]
    for k, (x, y) in enumerate(EXACT_MM.tolist()):
        p = listings.unit((x, y, -76.0))
        u, v, w = (sum(m[i][j] * p[i] for i in range(3)) for j in range(3))
        lines.append(f" N {k + 1:3d}    X {x:10.3f}    Y {y:10.3f}")
        lines.append("COSALP" + f11(p[0]) + " COSBET" + f11(p[1]) + " COSGAM" + f11(p[2]))
        lines.append(" U" + f11(u) + " V" + f11(v) + " W" + f11(w))
        ra, dec = np.degrees(np.arctan2(v, u)), np.degrees(np.arcsin(w))
        lines.append(f" RIGHT ASCENSION{ra:15.8f}   DECLINATION{dec:15.8f}")
    assert printout(stars) == "\n".join(lines) + "\n"
    assert "RIGHT ASCENSION    -4.4304" in printout(stars)  # -4 25 49.68, not 355


def made(form: str, **given: object) -> tuple[str, list[Finding]]:
    found: list[Finding] = []
    options: dict[str, object] = {
        "name": None, "focal_length_mm": 76.0, "omega_phi_kappa_deg": TRUTH_DEG.tolist(),
        "images": EXACT_MM[:2].tolist(), **given,
    }  # fmt: skip
    text = radec_text(form=form, report=found.append, **options)  # type: ignore[arg-type]
    return text, found


def test_csv_and_json_name_every_column() -> None:
    """The first two stars of tables 6.1 and 6.2."""
    page, _ = made("csv")
    assert page.startswith("x_mm,y_mm,ra_deg,dec_deg\n24.0,24.0,-4.4304")
    rows = list(csv.DictReader(io.StringIO(page)))
    stars = json.loads(made("json")[0])
    assert len(rows) == len(stars) == 2
    expected = [
        (24.0, 24.0, -4.4304661, 73.2890365, 0.286684559, -0.022212524, 0.957767491),
        (-15.0, 15.0, 82.3232818, 65.6776816, 0.055018946, 0.408177992, 0.911242911),
    ]
    for row, star, values in zip(rows, stars, expected, strict=True):
        assert list(star) == ["x_mm", "y_mm", "ra_deg", "dec_deg", *"uvwpqr"]
        x, y = values[:2]
        photo = listings.unit((x, y, -76.0))
        for name, value in zip(star, (*values, *photo), strict=True):
            assert_close("seven digits", star[name], value)
            if name in row:
                assert float(row[name]) == star[name]
    assert made("json")[0].startswith('[\n{"x_mm": 24.0, ') and made("json")[0].endswith("}\n]\n")
    assert made("json")[0].count("\n") == 4


def test_without_focal_length_or_attitude_the_file_is_what_was_typed(tmp_path: Path) -> None:
    file = tmp_path / "typed.txt"
    file.write_text("\n".join([*HEAD, "1.", "2"]))
    for left_out in ("focal_length_mm", "omega_phi_kappa_deg"):
        text, found = made("csv", name=str(file), **{left_out: None})
        assert text.splitlines()[1].startswith("1.0,2e-06,")
        assert_approved([str(one).removeprefix(f"{file}: ") for one in found])
