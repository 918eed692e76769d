"""The command line of stars."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import pytest

from tests.kit.command import DECKS, Ran, vopd
from tests.kit.stars import SAMPLE as SAMPLE_EFFECTS
from tests.kit.stars import seen_straight
from tests.tolerances import assert_close

# `vopd stars`: the files it reads, what it prints, what it refuses


STARS = DECKS / "stars"
SAMPLE = str(STARS / "table_6_3_cosines.csv")


def stars(*arguments: str, text: str | None = None) -> Ran:
    return vopd("stars", *arguments, stdin=text)


def solve(*arguments: str, text: str | None = None) -> Ran:
    return stars("solve", *(["-"] if text is not None else []), *arguments, text=text)


KEYS = [
    "method", "stars", "omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg", "swing_deg",
    "matrix", "orthogonality_defect", "residuals_mm", "iterations", "converged",
]  # fmt: skip


def test_json_is_one_array_with_these_keys() -> None:
    rows = json.loads(solve(SAMPLE, "--focal", "76", "--method", "all", "--format", "json").stdout)
    assert [row["method"] for row in rows] == [
        "collinearity", "church", "church-weighted", "church-weighted-r",
        "two-star", "single-rotation", "svd"
    ]  # fmt: skip
    for row in rows:
        assert list(row)[: len(KEYS)] == KEYS
        assert len(row["matrix"]) == 3 and len(row["residuals_mm"]) == len(row["stars"])
    assert rows[4]["stars"] == [1, 2] and "interstar_discrepancy_arcsec" in rows[4]
    assert {"axis", "angle_deg", "conditioning"} <= set(rows[5])
    assert_close("rae printed angle", rows[0]["omega_deg"], 156.1262074559)
    assert_close("rae printed angle", rows[5]["angle_deg"], 151.11914529)


def test_csv_and_text_say_the_same() -> None:
    table = solve(SAMPLE, "--focal", "76", "--format", "csv").stdout
    (row,) = csv.DictReader(io.StringIO(table))
    assert_close("rae printed angle", float(row["kappa_deg"]), 46.0656513621)
    assert "46.0656514" in solve(SAMPLE, "--focal", "76").stdout


def test_pairs_and_options() -> None:
    pair = ("--focal", "76", "--format", "json", "--method", "two-star")
    (row,) = json.loads(solve(SAMPLE, *pair, "--pair", "2,4").stdout)
    assert row["stars"] == [2, 4]
    assert len(json.loads(solve(SAMPLE, *pair, "--all-pairs").stdout)) == 6
    (raw,) = json.loads(
        solve(
            SAMPLE, *pair, "--pair", "1,2", "--cross-products", "raw", "--rotation", "as-solved"
        ).stdout
    )
    assert_close("rae printed angle", raw["omega_deg"], 156.1936243362)  # the source notes
    start = ("--focal", "76", "--format", "json", "--initial", "140,-10,45")
    (four,) = json.loads(solve(SAMPLE, *start, "--corrections", "3").stdout)
    assert f"{156.1413452 - four['omega_deg']:.4f}" == "0.0151" and four["iterations"] == 3
    (robust,) = json.loads(solve(SAMPLE, *start[:4], "--weights", "robust").stdout)
    assert robust["omega_deg"] != 156.1262074559 and robust["converged"]


def test_sexagesimal_and_decimal_angles_agree() -> None:
    """-4 25 49.68 is -4.4304666...; 5h12m3s is 78.0125 degrees."""
    head = "x_mm,y_mm,ra_deg,dec_deg\n"
    rest = "-15,15,82 19 23.81,65 40 39.65\n"
    one = solve("--focal", "76", text=head + "24,24,-4 25 49.68,73 17 20.53\n" + rest)
    two = solve("--focal", "76", text=head + f"24,24,{-(4 + 25 / 60 + 49.68 / 3600):.12f},"
                f"{73 + 17 / 60 + 20.53 / 3600:.12f}\n" + rest)  # fmt: skip
    assert one.stdout == two.stdout and one.status == 0


def test_ground_points() -> None:
    """The made-up photograph: omega 2, phi -3, kappa 40, to some thousandths."""
    ground = ("--focal", "152.4", "--camera", "1000,2000,3000", "--format", "json")
    (row,) = json.loads(solve(str(STARS / "ground_points.csv"), *ground).stdout)
    found = [row[name] for name in ("omega_deg", "phi_deg", "kappa_deg")]
    assert_close("rae ground photograph", found, (2.0, -3.0, 40.0))


def test_a_misidentified_star_is_named() -> None:
    result = solve(str(STARS / "orion_misidentified.csv"), "--focal", "76", "--all-pairs",
                   "--method", "two-star")  # fmt: skip
    assert "line 10: star 8 disagrees with the others" in result.stderr
    assert "disagrees" not in solve(str(STARS / "orion.csv"), "--focal", "76", "--all-pairs",
                                   "--method", "two-star").stderr  # fmt: skip


def test_radec_and_back() -> None:
    """Stars made for table 6.1's images solve to the attitude they were made with."""
    made = stars("radec", str(STARS / "table_6_1.csv"), "--focal", "76", "--attitude",
                 "156.1413452,-18.7472372,46.0052148", "--format", "csv")  # fmt: skip
    (row,) = json.loads(solve("--focal", "76", "--format", "json", text=made.stdout).stdout)
    found = [row["alpha_deg"], row["swing_deg"]]
    assert_close("rae angle of nine digits", found, [50.0, 10.0])
    typed = stars("radec", str(STARS / "radec2_typed.txt"), "--typed")
    kept = STARS.parents[1] / "golden_outputs" / "rae_1987" / "radec2_printout.txt"
    uncontrolled = [line[1:].rstrip() for line in kept.read_text().splitlines()]
    assert [line.rstrip() for line in typed.stdout.splitlines()] == uncontrolled


def test_typed_numbers_without_a_point_are_millionths() -> None:
    """F15.6: 76 without a point would be .000076."""
    text = "76\n10.\n20.\n30.\n1.\n1.\n9999.9\n"
    result = stars("radec", "-", "--typed", text=text)
    assert "line 1" in result.stderr


HEAD = "x_mm,y_mm,u,v,w\n"
SKY = "x_mm,y_mm,ra_deg,dec_deg\n"
BAD = {
    "one star": (SKY + "1,2,3,4\n", "church", "line 2: the only star"),
    "same star": (SKY + "1,2,3,4\n5,6,3,4\n", "two-star", "lines 2 and 3: the same star twice"),
    "great circle": (HEAD + "1,2,1,0,0\n5,6,0,1,0\n3,3,.6,.8,0\n", "church", "one great circle"),
    "principal point": (
        HEAD + "0,0,1,0,0\n5,6,0,1,0\n3,3,0,0,1\n", "church-weighted", "principal point",
    ),
    "no rotation": (HEAD + "0,76,0,1,-1\n76,0,1,0,-1\n", "single-rotation", "rotation is zero"),
    "no number": (SKY + "1,2,3,4\n5,6,x,4\n", "collinearity", "line 3: ra_deg: not an angle: 'x'"),
    "columns": (SKY + "1,2,3,4\n5,6,3\n", "collinearity", "line 3: 3 values, where the header"),
    "empty": ("", "collinearity", "the file is empty"),
    "no header": ("a,b\n1,2\n", "collinearity", "the header must name x_mm and y_mm"),
    "nan": (SKY + "1,2,3,4\nnan,6,3,5\n", "collinearity", "line 3"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_bad_input_names_its_line(name: str) -> None:
    text, method, said = BAD[name]
    result = solve("--focal", "76", "--method", method, text=text)
    assert said in result.stderr, result.stderr
    assert result.status == 1


def test_stars_behind_the_camera() -> None:
    block = solve(str(STARS / "stars_block_2.csv"), "--focal", "76", "--initial", "20,-15,50")
    assert "lines 4, 5 and 6: collinearity: these stars lie behind the camera" in block.stderr
    assert block.status == 1


def test_no_convergence_is_status_3() -> None:
    """The listed weights wander on the perturbed sample from a far start."""
    result = solve(SAMPLE, "--focal", "76", "--weights", "listed", "--initial", "100,40,-120")
    assert result.status == 3 and "no convergence" in result.stderr


@pytest.mark.parametrize(
    "wrong", [("--focal", "0"), ("--focal", "x"), ("--focal", "76", "--pair", "1,1"),
              ("--focal", "76", "--method", "magic"), ()],
)  # fmt: skip
def test_wrong_usage(wrong: tuple[str, ...]) -> None:
    assert solve(SAMPLE, *wrong).status == 2


def test_tables_show_the_printed_beside_the_computed(tmp_path: Path) -> None:
    text = stars("tables").stdout
    for part in ("Table 6.1", "Table 6.5", "Figure 6.3", "-0.2318*", "0.0216+", "TRUOPK"):
        assert part in text
    out = tmp_path / "tables.txt"
    assert stars("tables", "-o", str(out)).stdout == "" and out.read_text() == text


# Options of `vopd stars solve`: what each changes of a solution, and what it leaves


ANGLES = {"omega_deg", "phi_deg", "kappa_deg"}
SIGMAS = {"reading_sigma_mm", "sigma_omega_deg", "sigma_phi_deg", "sigma_kappa_deg"}
EXACT = seen_straight(
    (0.0, 0.0), (20.0, 0.0), (0.0, 20.0), (-15.0, 12.0), (-9.0, -18.0), (14.0, -11.0), (5.0, 21.0)
)
OFF_UM = ((0, 2), (3, -4), (-5, 1), (4, 4), (-2, -3), (1, 5), (-3, 0))


def misread() -> str:
    """Every star is off by a few um; the first is near the principal point."""
    head, *rows = EXACT.splitlines()
    lines = []
    for row, (dx, dy) in zip(rows, OFF_UM, strict=True):
        x, y, *cosines = row.split(",")
        lines.append(
            ",".join([f"{float(x) + dx / 1e3:.3f}", f"{float(y) + dy / 1e3:.3f}", *cosines])
        )
    return "\n".join([head, *lines]) + "\n"


MISREAD = misread()
WRONG = EXACT.replace("\n20,0,", "\n20.4,0.3,")


def solved(text: str, *options: str) -> dict[str, Any]:
    ran = vopd(
        *("stars", "solve", "-", "--focal", "76", "--format", "json"),
        *" ".join(options).split(),
        stdin=text,
    )
    (row,) = json.loads(ran.stdout)
    doubtful = any(word in ran.stderr for word in ("implausible", "no convergence"))
    assert ran.status == (3 if doubtful else 0), ran.stderr
    return dict(row)


def changed(one: dict[str, Any], other: dict[str, Any]) -> set[str]:
    return {name for name in one | other if one.get(name) != other.get(name)}


CASES = [  # the file, the options of both, an option, what it changes, what it leaves
    (MISREAD, "--reading-sigma .003", "--reading-sigma .006", SIGMAS, ANGLES),
    (MISREAD, "--reading-sigma .001 --weights robust", "--reading-sigma .006", SIGMAS | ANGLES, ()),
    (
        MISREAD, "--reading-sigma .003 --method church-weighted", "--reading-sigma .3",
        {"reading_sigma_mm"} | ANGLES, (),
    ),
    (
        MISREAD, "--reading-sigma .003 --method church-weighted-r", "--reading-sigma .3",
        {"reading_sigma_mm"} | ANGLES, (),
    ),
    (MISREAD, "--reading-sigma .002", "--weights robust", ANGLES, {"reading_sigma_mm"}),
    (MISREAD, "--reading-sigma .003", "--weights listed", ANGLES, {"reading_sigma_mm"}),
    (MISREAD, "", "--corrections 1", {"iterations", "converged"}, ()),
    (MISREAD, "--corrections 1", "--initial two-star", ANGLES, {"iterations"}),
    (MISREAD, "--corrections 1", "--initial 1,1,1", ANGLES, {"iterations"}),
    (MISREAD, "--method two-star", "--cross-products raw", {"matrix"}, {"stars", "method"}),
    (
        SAMPLE_EFFECTS.read_text(), "--method single-rotation", "--rotation-angle mean",
        {"angle_deg"}, {"stars"},
    ),
    (MISREAD, "--method church", "--rotation as-solved", {"matrix"}, {"stars"}),
    (WRONG, "", "--reject", {"stars"} | ANGLES, {"method"}),
    (WRONG, "", "--edit-by-pairs", {"stars"} | ANGLES, {"method"}),
]  # fmt: skip


@pytest.mark.parametrize(
    ("text", "both", "option", "columns", "others"), CASES, ids=[f"{c[2]}, {c[1]}" for c in CASES]
)
def test_an_option_changes_what_it_says(
    text: str, both: str, option: str, columns: set[str], others: set[str]
) -> None:
    found = changed(solved(text, both), solved(text, both, option))
    assert columns <= found and not found & set(others)


def test_the_uncertainty_of_weighted_church_has_the_reading_sigma() -> None:
    """Without it the star at the principal point has an infinite weight, and no angle a sigma."""
    one = solved(MISREAD, "--reading-sigma .003 --method church-weighted")
    other = solved(MISREAD, "--reading-sigma .006 --method church-weighted")
    ratio = other["sigma_kappa_deg"] / one["sigma_kappa_deg"]
    assert 1.5 < ratio < 2.5  # twice, but for the weight of the one star
