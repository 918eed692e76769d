"""Every line of the text of one solution, with its numbers and units, from values made by hand."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from vopd.findings import Finding
from vopd.stellar.field import Failure, StarField
from vopd.stellar.files.findings import KindOfFinding, counted
from vopd.stellar.files.photograph import SolvedPhotograph
from vopd.stellar.files.read import StarFile
from vopd.stellar.files.table import as_csv, solution_table
from vopd.stellar.files.text import as_text
from vopd.stellar.methods.run import SolvedStars

PLAIN = SolvedStars(
    method="svd",
    stars=(1, 3),
    failure=Failure.NONE,
    angles_deg=[1.0, -2.25, 3.5, 4.0, 5.0, -6.125],
    matrix=[[0.5, -0.25, 0.125], [1.0, 0.0, -1.0], [0.75, 0.0625, 0.03125]],
    orthogonality_defect=0.0,
    residuals=[[0.001, -0.002], [0.03, 0.04]],
    iterations=0,
    converged=True,
    rms=0.0125,
)
SIGMAS: dict[str, Any] = {
    "reading_sigma": 0.0123,
    "rotation_sigma_arcsec": [3.04, 4.0, 12.0],
    "rotation_covariance_arcsec2": np.eye(3).tolist(),
    "angle_sigmas_deg": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
    "boresight_95_arcsec": [20.0, 10.0],
    "boresight_95_angle_deg": 30.0,
}


def photograph(one: SolvedStars, **more: Any) -> SolvedPhotograph:
    image = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    file = StarFile(
        "orion.csv", (2, 3, 4), ("Rigel", "", "Saiph"), image, "mm", "ra_deg,dec_deg", image
    )
    stars = StarField.of(np.tile([0.0, 0.0, -1.0], (3, 1)), image, 76.0)
    file = replace(file, unit=more.pop("unit", "mm"))
    whole = SolvedPhotograph("", file, stars, np.arange(3), (one,), (), 0)
    return replace(whole, **more)


def details(one: SolvedStars, *, robust: bool = False, unit: str = "mm", **more: Any) -> list[str]:
    """The lines below the table, from `matrix` on."""
    lines = as_text([photograph(one, unit=unit, **more)], robust=robust).splitlines()
    return lines[3:]


MATRIX = [
    "matrix",
    "    0.5000000000   -0.2500000000    0.1250000000",
    "    1.0000000000    0.0000000000   -1.0000000000",
    "    0.7500000000    0.0625000000    0.0312500000",
]
RESIDUALS = [
    "",
    "residuals, observed minus computed",
    "  star        x mm        y mm",
    "     1    0.001000   -0.002000  Rigel",
    "     3    0.030000    0.040000  Saiph",
]
UNKNOWN = [
    "",
    "no standard deviations: two stars do not tell the reading error; --reading-sigma states it",
]


def test_the_table() -> None:
    head, row, *_ = as_text([photograph(replace(PLAIN, **SIGMAS))]).splitlines()
    assert " ".join(head.split()) == (
        "method stars omega deg phi deg kappa deg alpha deg delta deg swing deg rms mm sigma sec"
    )
    assert row == (
        "svd               1,3          1.0000000   -2.2500000    3.5000000    4.0000000    "
        "5.0000000   -6.1250000   0.01250       13.0"
    )


def test_a_solution_without_uncertainty() -> None:
    assert details(PLAIN) == MATRIX + UNKNOWN + RESIDUALS


@pytest.mark.parametrize(("freedom", "known"), [(None, "as stated"), (4, "as the residuals tell")])
def test_standard_deviations(freedom: int | None, known: str) -> None:
    lines = details(replace(PLAIN, **SIGMAS, reading_freedom=freedom))
    assert lines == [
        *MATRIX,
        "",
        f"standard deviations, for image coordinates good to 0.0123 mm ({known}):",
        "about the camera's x, y, z 3.0 4.0 12.0 seconds of arc",
        "in degrees omega 0.10000, phi 0.20000, kappa 0.30000, alpha 0.40000, delta 0.50000, "
        "swing 0.60000",
        "with a probability of 95 percent the optical axis lies in an ellipse with semi-axes of "
        "20.0 and 10.0",
        "seconds of arc, the longer one 30 degrees from north toward east",
        *RESIDUALS,
    ]


def test_weights_and_corrections_in_pixels() -> None:
    one = replace(
        PLAIN, **SIGMAS, iterations=3, weighted_rms=0.25, weights=[[0.5, 0.5], [0.25, 0.4]]
    )
    lines = details(one, robust=True, unit="px")
    assert lines[4:6] == ["", "3 corrections"]
    assert "good to 0.0123 px" in "\n".join(lines)
    assert "weighted rms of the residuals 0.25 px" in lines
    assert lines[-5:] == [
        "residuals, observed minus computed, and weights",
        "  star        x px        y px",
        "     1    0.001000   -0.002000         0.5         0.5    Rigel",
        "     3    0.030000    0.040000        0.25         0.4 *  Saiph",
        "* weight below 0.5: the star is not in the rms",
    ]
    assert not any("*" in line for line in details(one, unit="px"))


SKY = {
    "ra_deg": 83.25, "dec_deg": -5.5, "ra_of_date_deg": 84.0, "dec_of_date_deg": -5.25,
    "azimuth_deg": 120.5, "elevation_deg": 35.25, "camera_roll_deg": 7.0,
    "vehicle_yaw_deg": 1.5, "vehicle_pitch_deg": -2.5, "vehicle_roll_deg": 3.5,
}  # fmt: skip
MORE: dict[str, tuple[dict[str, Any], list[str]]] = {
    "sky": (
        {"sky": SKY},
        [
            "",
            "optical axis: right ascension 83.25000 = 5h33m00.000s, declination -5.50000 = "
            "-5°30'00.00\"",
            "optical axis: right ascension of date 84.00000 = 5h36m00.000s, declination -5.25000 "
            "= -5°15'00.00\"",
            "azimuth 120.50000, elevation 35.25000, camera roll 7.00000",
            "vehicle yaw 1.50000, pitch -2.50000, roll 3.50000",
        ],
    ),
    "camera": (
        {
            "camera": {"focal": 76.5, "centre_x": 0.25, "centre_y": -0.5, "k1": -0.01},
            "camera_sigmas": {"focal": 0.5, "centre_x": 0.02, "centre_y": 0.03, "k1": 0.004},
        },
        [
            "",
            "focal 76.5 mm, standard deviation 0.5 mm",
            "centre_x 0.25 mm, standard deviation 0.02 mm",
            "centre_y -0.5 mm, standard deviation 0.03 mm",
            "k1 -0.01, standard deviation 0.004",
        ],
    ),
    "resection": (
        {"camera_m": [1.0, -2.5, 3.0], "camera_sigma_m": [0.1, 0.25, 0.5]},
        ["", "camera at 1.000 -2.500 3.000 m, standard deviations 0.100 0.250 0.500 m"],
    ),
    "one rotation": (
        {
            "axis": [0.6, 0.0, -0.8], "angle_deg": 45.5, "axis_ra_deg": 0.5, "axis_dec_deg": -53.0,
            "conditioning": 0.5,
        },
        [
            "",
            "one rotation: 45.5000000 degrees about 0.6000000000 0.0000000000 -0.8000000000,",
            "right ascension 0.5000000, declination -53.0000000",
        ],
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MORE)
def test_what_else_is_solved(name: str) -> None:
    changes, lines = MORE[name]
    assert details(replace(PLAIN, **changes)) == MATRIX + UNKNOWN + lines + RESIDUALS


def test_the_epoch_and_what_moved_last() -> None:
    moving = replace(PLAIN, iterations=50, converged=False)
    text = as_text([photograph(moving, epoch="ICRS, epoch 1991.25")]).splitlines()
    assert text[1].endswith("  *") and text[2] == "* the last correction still moved an image"
    assert text[-1] == "right ascension and declination: ICRS, epoch 1991.25"
    assert "*" not in as_text([photograph(replace(moving, iterations=0))])


@pytest.mark.parametrize("severity", ["error", "warning"])
@pytest.mark.parametrize("count", [2, 3, 4, 9])
def test_findings_of_one_kind_are_counted(severity: Any, count: int) -> None:
    """Three are shown; the count of the others has the same severity and no line."""
    given = [
        KindOfFinding("svd: x", Finding(f"svd: {k}", "a.csv", severity=severity))
        for k in range(count)
    ]
    shown = counted(given)
    assert shown[: min(count, 3)] == [one.finding for one in given[:3]]
    more = Finding(f"svd: {count - 3} more like these", "a.csv", severity=severity)
    assert shown[3:] == ([more] if count > 3 else [])


def test_findings_about_plausibility_are_all_shown() -> None:
    given = [KindOfFinding("plausibility", Finding(str(k), "a.csv")) for k in range(9)]
    assert counted(given) == [one.finding for one in given]


def test_a_table_of_photographs_in_both_units() -> None:
    """Each has its cells in the columns of its own unit, and none in those of the other."""
    some = [
        photograph(replace(PLAIN, rms=0.5), label="a.csv"),
        photograph(replace(PLAIN, rms=2.5), label="b.csv", unit="px"),
    ]
    rows = list(csv.DictReader(io.StringIO(as_csv(some))))
    assert [(row["image"], row["rms_mm"], row["rms_px"]) for row in rows] == [
        ("a.csv", "0.5", ""),
        ("b.csv", "", "2.5"),
    ]
    table = solution_table(some)
    np.testing.assert_array_equal(table.values["rms_mm"], [0.5, np.nan])
    np.testing.assert_array_equal(table.values["rms_px"], [np.nan, 2.5])
    assert table.values["residuals_px"].tolist() == ["", "0.001 -0.002 0.03 0.04"]
    for unit in ("mm", "px"):
        assert table.columns[f"rms_{unit}"]["unit"] == unit
    assert list(table.columns) == list(rows[0])
    assert (table.conventions["source"], table.values["converged"].tolist()) == (
        "orion.csv",
        ["true", "true"],
    )


def test_a_table_of_one_photograph_has_no_column_for_its_name() -> None:
    (row,) = csv.DictReader(io.StringIO(as_csv([photograph(replace(PLAIN, **SIGMAS))])))
    assert "image" not in row and not any(name.endswith("_px") for name in row)
    assert [row[name] for name in ("m11", "m12", "m21", "m33")] == [
        "0.5",
        "-0.25",
        "1.0",
        "0.03125",
    ]
    sigmas = [row[f"sigma_{axis}_arcsec"] for axis in "xyz"]
    assert sigmas == ["3.04", "4.0", "12.0"]
    covariance = [
        row[f"covariance_{pair}_arcsec2"] for pair in ("xx", "xy", "xz", "yy", "yz", "zz")
    ]
    assert covariance == ["1.0", "0.0", "0.0", "1.0", "0.0", "1.0"]
    major, minor = (row[f"boresight_95_{which}_arcsec"] for which in ("major", "minor"))
    assert (major, minor, row["boresight_95_angle_deg"]) == ("20.0", "10.0", "30.0")
    angles = [row[f"{name}_deg"] for name in ("omega", "phi", "kappa", "alpha", "delta", "swing")]
    assert angles == ["1.0", "-2.25", "3.5", "4.0", "5.0", "-6.125"]
    of_angles = [row[f"sigma_{name}_deg"] for name in ("omega", "phi", "kappa", "swing")]
    assert of_angles == ["0.1", "0.2", "0.3", "0.6"]
