"""Options of `vopd stars solve`: what each changes of a solution, and what it leaves."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.kit.command import vopd
from tests.kit.star_files import SAMPLE, seen_straight

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
        SAMPLE.read_text(), "--method single-rotation", "--rotation-angle mean",
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
