"""Tables of solutions: columns and values, and the output read back."""

from __future__ import annotations

import csv
import io
import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from vopd.findings import InputError
from vopd.stellar.field import Failure, StarField
from vopd.stellar.files.photograph import SolvedPhotograph
from vopd.stellar.files.read import StarFile
from vopd.stellar.files.table import (
    ReadSolution,
    as_csv,
    as_json,
    columns_of,
    read_solutions,
    solution_table,
    stated_conventions,
)
from vopd.stellar.methods.run import SolvedStars
from vopd.version import __version__

# Tables of star attitudes: every column with unit and meaning, and every cell of a full row


# name | unit | meaning | cell of the row below; a star marks columns of text
TABLE = """
*method | | how it was solved | single
*stars | | the stars solved, counted from 1 | 1 3
omega_deg | deg | first turn of the camera axes, about x | 11.0
phi_deg | deg | second turn, about the new y | 12.0
kappa_deg | deg | third turn, about the new z | 13.0
alpha_deg | deg | right ascension of the optical axis, -180 to 180 | 14.0
delta_deg | deg | declination of the optical axis | 15.0
swing_deg | deg | of the photograph's y axis from north toward increasing right ascension | 16.0
m11 | | of the matrix from object to camera axes | 1.25
m12 | | of the matrix from object to camera axes | 1.5
m13 | | of the matrix from object to camera axes | 1.75
m21 | | of the matrix from object to camera axes | 2.25
m22 | | of the matrix from object to camera axes | 2.5
m23 | | of the matrix from object to camera axes | 2.75
m31 | | of the matrix from object to camera axes | 3.25
m32 | | of the matrix from object to camera axes | 3.5
m33 | | of the matrix from object to camera axes | 3.75
orthogonality_defect | | of the matrix as solved | 0.0625
rms_px | px | root mean square of the residuals' coordinates | 0.75
*residuals_px | px | observed minus computed x, y by star | 0.125 -0.25 0.5 -1.0
iterations | | corrections made | 7
*converged | | whether no further correction would change it | true
reading_sigma_px | px | standard deviation of an image coordinate | 0.375
reading_freedom | | degrees of freedom of that; missing where it is given | 9
sigma_x_arcsec | arcsec | standard deviation about a camera axis | 21.0
sigma_y_arcsec | arcsec | standard deviation about a camera axis | 22.0
sigma_z_arcsec | arcsec | standard deviation about a camera axis | 23.0
covariance_xx_arcsec2 | arcsec2 | covariance about two camera axes | 31.0
covariance_xy_arcsec2 | arcsec2 | covariance about two camera axes | 32.0
covariance_xz_arcsec2 | arcsec2 | covariance about two camera axes | 33.0
covariance_yy_arcsec2 | arcsec2 | covariance about two camera axes | 34.0
covariance_yz_arcsec2 | arcsec2 | covariance about two camera axes | 35.0
covariance_zz_arcsec2 | arcsec2 | covariance about two camera axes | 36.0
sigma_omega_deg | deg | standard deviation | 0.1
sigma_phi_deg | deg | standard deviation | 0.2
sigma_kappa_deg | deg | standard deviation | 0.3
sigma_alpha_deg | deg | standard deviation | 0.4
sigma_delta_deg | deg | standard deviation | 0.5
sigma_swing_deg | deg | standard deviation | 0.6
boresight_95_major_arcsec | arcsec | semi-axis of the 95 percent ellipse of the optical axis | 42.0
boresight_95_minor_arcsec | arcsec | semi-axis of the 95 percent ellipse of the optical axis | 41.0
boresight_95_angle_deg | deg | of its longer axis from north toward east | 43.0
weighted_rms_px | px | rms of the residuals with their weights | 0.875
axis_x | | axis of the single rotation | 0.6
axis_y | | axis of the single rotation | 0.0
axis_z | | axis of the single rotation | -0.8
axis_ra_deg | deg | right ascension of that axis | 51.0
axis_dec_deg | deg | its declination | 52.0
angle_deg | deg | angle of the single rotation | 53.0
conditioning | | sin(D1, D2) of the single rotation | 0.25
interstar_discrepancy_arcsec | arcsec | of a pair: sky minus photograph | -4.5
*disagreement_arcsec | arcsec | of each star with all others | 61.0 62.0
*weights | | of the residuals, x, y by star | 1.0 0.5 0.25 0.75
*images_px | px | x right, y up from the principal point | 3.0 4.0 5.0 6.0
focal_px | px | focal, solved with the attitude | 71.0
centre_x_px | px | centre_x, solved with the attitude | 72.0
centre_y_px | px | centre_y, solved with the attitude | 73.0
k1 | | radial distortion, solved with the attitude | 74.0
sigma_focal_px | px | standard deviation of focal | 0.71
sigma_centre_x_px | px | standard deviation of centre_x | 0.72
sigma_centre_y_px | px | standard deviation of centre_y | 0.73
sigma_k1 | | standard deviation of k1 | 0.74
ra_deg | deg | right ascension of the optical axis, 0 to 360 | 81.0
ra_hours | h | the same in hours | 82.0
dec_deg | deg | declination of the optical axis | 83.0
ra_of_date_deg | deg | right ascension, equator and equinox of date | 84.0
ra_of_date_hours | h | the same in hours | 85.0
dec_of_date_deg | deg | declination, equator of date | 86.0
azimuth_deg | deg | of the optical axis, clockwise from north | 87.0
elevation_deg | deg | of the optical axis above the horizon | 88.0
camera_roll_deg | deg | of the camera about the optical axis | 89.0
vehicle_yaw_deg | deg | yaw of the vehicle | 91.0
vehicle_pitch_deg | deg | pitch of the vehicle | 92.0
vehicle_roll_deg | deg | roll of the vehicle | 93.0
*epoch | | what right ascensions and declinations refer to | of date
*camera_m | m | position of the camera, where it is solved | 1001.0 1002.0 1003.0
*camera_sigma_m | m | its standard deviations | 0.01 0.02 0.03
"""
ROWS = [[part.strip() for part in line.split("|")] for line in TABLE.strip().splitlines()]
CELLS = {name.lstrip("*"): cell for name, _, _, cell in ROWS}
CAMERA = ("focal", "centre_x", "centre_y", "k1")

FULL = SolvedStars(
    "single", (1, 3), Failure.NONE, [11.0, 12.0, 13.0, 14.0, 15.0, 16.0],
    [[1.25, 1.5, 1.75], [2.25, 2.5, 2.75], [3.25, 3.5, 3.75]],
    0.0625, [[0.125, -0.25], [0.5, -1.0]], 7, True, 0.75, 0.375, 9,
    [21.0, 22.0, 23.0], [[31.0, 32.0, 33.0], [32.0, 34.0, 35.0], [33.0, 35.0, 36.0]],
    [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], [42.0, 41.0], 43.0, 0.875, [0.6, 0.0, -0.8], 51.0, 52.0, 53.0,
    0.25, -4.5, [[1.0, 0.5], [0.25, 0.75]], [61.0, 62.0],
    [1001.0, 1002.0, 1003.0], [0.01, 0.02, 0.03],
    {name: float(CELLS[name]) for name in (
        "ra_deg", "ra_hours", "dec_deg", "ra_of_date_deg", "ra_of_date_hours", "dec_of_date_deg",
        "azimuth_deg", "elevation_deg", "camera_roll_deg",
        "vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg",
    )},
    dict(zip(CAMERA, (71.0, 72.0, 73.0, 74.0), strict=True)),
    dict(zip(CAMERA, (0.71, 0.72, 0.73, 0.74), strict=True)),
    [[3.0, 4.0], [5.0, 6.0]],
)  # fmt: skip
BARE = SolvedStars(
    "svd", (2,), Failure.NONE, [0.0] * 6, np.eye(3).tolist(), 0.0, [[0.5, 0.25]], 0, False, 0.5
)


def photograph(one: SolvedStars, unit: str = "px", label: str = "", **more: Any) -> Any:
    image = np.zeros((3, 2))
    names = ("Rigel", "", "Saiph") if label != "nameless" else ("", "", "")
    file = StarFile(f"{label}.csv", (2, 3, 4), names, image, unit, "name", image)
    stars = StarField.of(np.tile([0.0, 0.0, -1.0], (3, 1)), image, 76.0)
    whole = SolvedPhotograph(label, file, stars, np.arange(3), (one,), (), 0)
    return replace(whole, **more)


def test_every_column_with_its_unit_and_meaning() -> None:
    columns = columns_of([photograph(FULL)])
    found = [("*" * one.text + one.name, one.unit, one.meaning) for one in columns]
    assert found == [(name, unit, meaning) for name, unit, meaning, _ in ROWS]


def test_every_cell_of_a_full_row() -> None:
    """In CSV, and as arrays: numbers of numbers, and text of lists and words."""
    full = photograph(FULL, epoch="of date")
    (row,) = csv.DictReader(io.StringIO(as_csv([full])))
    assert dict(row) == CELLS
    values, _ = solution_table([full])
    for name, _, _, cell in ROWS:
        (value,) = values[name.lstrip("*")].tolist()
        assert value == (cell if name.startswith("*") else float(cell)), name


def test_the_text_of_both_formats() -> None:
    """Lines end with a line feed alone; a number that is none is no JSON."""
    text = as_csv([photograph(FULL), photograph(BARE)])
    assert "\r" not in text and text.count("\n") == 3 and text.endswith("\n")
    with pytest.raises(ValueError, match="not JSON compliant"):
        as_json([photograph(replace(BARE, rms=float("nan")))])


def test_what_is_not_known_is_empty() -> None:
    known = {
        "method": "svd", "stars": "2", "orthogonality_defect": "0.0", "rms_px": "0.5",
        "residuals_px": "0.5 0.25", "iterations": "0", "converged": "false",
        **{f"m{i}{j}": "1.0" if i == j else "0.0" for i in (1, 2, 3) for j in (1, 2, 3)},
        **{f"{name}_deg": "0.0" for name in ("omega", "phi", "kappa", "alpha", "delta", "swing")},
    }  # fmt: skip
    (row,) = csv.DictReader(io.StringIO(as_csv([photograph(BARE)])))
    assert dict(row) == {name: known.get(name, "") for name in CELLS}
    values, _ = solution_table([photograph(BARE)])
    for name, _, _, _ in ROWS:
        (value,) = values[name.lstrip("*")].tolist()
        text = known.get(name.lstrip("*"), "")
        assert value == text if name.startswith("*") else (np.isnan(value) or str(float(text)))


def test_both_units_and_several_photographs() -> None:
    """Columns of one quantity stand together, mm and px in the order of the photographs."""
    some = [photograph(BARE, "mm", "b"), photograph(BARE, "px", "a"), photograph(BARE, "mm", "b")]
    columns = columns_of(some)
    assert (columns[0].name, columns[0].meaning, columns[0].text) == (
        "image",
        "the photograph",
        True,
    )
    names = [one.name for one in columns]
    at = names.index("rms_mm")
    assert names[at : at + 4] == ["rms_mm", "rms_px", "residuals_mm", "residuals_px"]
    assert {one.name: one.unit for one in columns}["sigma_focal_mm"] == "mm"
    assert len(names) == len(set(names)) == len(ROWS) + 11 + 1  # eleven have the images' unit
    two = replace(some[0], solved=(BARE, BARE))
    assert solution_table([two, some[1]])[0]["method"].tolist() == ["svd"] * 3
    names = [one.name for one in columns_of(some[1:])]
    assert names[names.index("rms_px") + 1] == "rms_mm"
    assert solution_table(some)[0]["image"].tolist() == ["b", "a", "b"]
    assert stated_conventions(some) == {
        "program": f"vopd {__version__}",
        "source": "b.csv, a.csv",
        "matrix": "M from object axes (U V W, or those of the ground points) to camera axes: "
        "x, y of the photograph, a positive seen from behind, y up; z backward",
        "sequence": "M = Rz(kappa) Ry(phi) Rx(omega); alpha, delta, swing from the same matrix",
        "sigmas": "one standard deviation; the 95 percent ellipse allows for the degrees of "
        "freedom",
    }
    assert columns_of([photograph(BARE, label="x")])[0].name == "image"
    assert columns_of([photograph(BARE)] * 2)[0].name == "method"
    one_label = columns_of([photograph(BARE, label="x"), photograph(BARE)])
    assert one_label[0].name == "image" and columns_of([photograph(BARE)])[0].name == "method"
    assert "rms_mm" in solution_table([])[0]


def test_every_key_of_json() -> None:
    """What is known, lists as lists, one solution a line; names only where a star has one."""
    some = [photograph(FULL, label="a", epoch="of date"), photograph(BARE, "mm", "nameless")]
    text = as_json(some)
    assert text.splitlines()[0] == "[" and text.endswith("}\n]\n") and text.count("\n") == 4
    full, bare = json.loads(text)
    assert list(full)[:3] == ["image", "method", "stars"]
    assert (full["image"], full["stars"], full["names"]) == ("a", [1, 3], ["Rigel", "Saiph"])
    assert full["matrix"] == FULL.matrix and full["epoch"] == "of date"
    assert full["rotation_covariance_arcsec2"] == FULL.rotation_covariance_arcsec2
    assert (full["converged"], full["focal_px"], full["sigma_k1"]) == (True, 71.0, 0.74)
    assert full["residuals_px"] == [[0.125, -0.25], [0.5, -1.0]]
    single = set(CELLS) & set(full)
    lists = {name.lstrip("*") for name, *_ in ROWS if name.startswith("*")}
    for name in single - lists:
        assert full[name] == float(CELLS[name]), name
    assert (
        len(single) == len(CELLS) - 9 - 3 - 3 - 6 - 2
    )  # matrix, axis, sigmas, covariance, ellipse
    assert set(bare) == {
        "image", "method", "stars", "omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg",
        "swing_deg", "matrix", "orthogonality_defect", "residuals_mm", "iterations", "converged",
        "rms_mm",
    }  # fmt: skip
    (alone,) = json.loads(as_json([photograph(BARE)]))
    assert not {"image", "names", "epoch"} & set(alone)
    (two,) = json.loads(as_json([photograph(replace(FULL, stars=(1, 2)))]))
    assert two["names"] == ["Rigel", ""]


# The table of attitudes as text: columns, widths, labels, marks, and what follows the table


# Solutions read back from JSON: every field, what need not be there, and what is refused


ONE_SOLUTIONS: dict[str, Any] = {
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
    return {name: value for name, value in ONE_SOLUTIONS.items() if name not in names}


def test_every_field(tmp_path: Path) -> None:
    """A star without a name has its number."""
    (one,) = read(tmp_path, [ONE_SOLUTIONS])
    assert (one.image, one.method, one.labels, one.unit) == ("night", "svd", ("Rigel", "1"), "px")
    assert one.images.tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert one.residuals.tolist() == [[0.1, 0.2], [0.3, 0.4]]
    assert one.pointing == (10.5, -20.5, 30.5)


def test_what_need_not_be_there(tmp_path: Path) -> None:
    mm = {"images_mm": [[1.0, 2.0]], "residuals_mm": [[3.0, 4.0]], "stars": [7]}
    bare = without("image", "names", "images_px", "residuals_px") | mm
    one, other = read(tmp_path, [bare, ONE_SOLUTIONS])
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
    "an angle that is none": ([ONE_SOLUTIONS | {"delta_deg": None}], WHAT + "float() argument"),
    "one residual": ([ONE_SOLUTIONS | {"residuals_px": [[0.1, 0.2]]}], TOGETHER),
    "triples": (
        [ONE_SOLUTIONS | {"images_px": [[1, 2, 3]], "residuals_px": [[1, 2, 3]]}],
        TOGETHER,
    ),
    "no pairs": ([ONE_SOLUTIONS | {"images_px": [1, 2], "residuals_px": [1, 2]}], TOGETHER),
    "an image that is none": ([ONE_SOLUTIONS | {"images_px": [[1, 2], [None, 4]]}], FINITE),
    "a residual that is none": ([ONE_SOLUTIONS | {"residuals_px": [[1, 2], [None, 4]]}], FINITE),
    "one name": ([ONE_SOLUTIONS | {"names": ["Rigel"]}], NAMES),
    "three stars": ([ONE_SOLUTIONS | {"stars": [1, 2, 3], "names": ["", "", ""]}], NAMES),
    "three images": ([ONE_SOLUTIONS | {"images_px": THREE, "residuals_px": THREE}], NAMES),
    "one of two": ([ONE_SOLUTIONS, without("method")], WHAT + "'method'"),
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
