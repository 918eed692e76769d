"""The command line of stars."""

from __future__ import annotations

import json
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
