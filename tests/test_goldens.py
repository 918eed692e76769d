"""What the outside world printed, to the last digit; and what the program prints, byte for byte."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import vopd
from vopd.listing.compare import compare_listings

ROOT = Path(__file__).parents[1]
PRINTED = ROOT / "golden_outputs" / "appendix_h"

LEGIBLE = {"case1": 48, "case2": 62, "case3": 60, "case4": 122}
"""Fields the report shows: 244 numbers, 43 landmark numbers, and the titles of five pages."""


def printed(case: str) -> str:
    return (PRINTED / f"{case}.lst").read_text(encoding="ascii")


def listing(deck: str) -> str:
    return vopd.listing_text(vopd.run(vopd.read_deck(ROOT / f"decks/appendix_h/{deck}.dat")))


def test_the_report_shows_so_much() -> None:
    assert sum(LEGIBLE.values()) == 244 + 43 + 5
    assert sorted(path.stem for path in PRINTED.glob("*.lst")) == sorted(LEGIBLE)


@pytest.mark.parametrize("case", LEGIBLE)
def test_every_legible_field_comes_out_to_its_last_digit(case: str) -> None:
    found = compare_listings(printed(case), listing(case), units=0)
    assert found.differences == ()
    assert found.fields_compared == LEGIBLE[case]


def test_the_stack_prints_the_three_cases() -> None:
    """Cases 1 to 3 one after the other; only the last is followed by END OF CASE."""
    cases = [printed(f"case{n}").splitlines() for n in (1, 2, 3)]
    expected = [line for case in cases[:2] for line in case[:-3]] + cases[2]
    found = compare_listings("\n".join(expected), listing("cases_1_2_3"), units=0)
    assert found.differences == ()
    assert found.fields_compared == sum(LEGIBLE[f"case{n}"] for n in (1, 2, 3))


@pytest.mark.parametrize("case", LEGIBLE)
def test_any_digit_of_any_golden_counts(case: str) -> None:
    """Each digit of the transcript, made another one, is noticed: fields, names, titles, ejects."""
    golden, actual = printed(case), listing(case)
    places = [place for place, char in enumerate(golden) if char.isdigit()]
    assert len(places) > 5 * LEGIBLE[case]
    for place in places:
        other = str((int(golden[place]) + 5) % 10)
        wrong = golden[:place] + other + golden[place + 1 :]
        assert compare_listings(wrong, actual, units=0).differences, (case, place)


def test_one_wrong_digit_is_one_difference_with_its_place() -> None:
    wrong = printed("case1").replace(".11718", ".11719")
    (difference,) = compare_listings(wrong, listing("case1"), units=0).differences
    assert "STANDARD DEVIATION" in str(difference)


def test_regression_listings() -> None:
    tool = ROOT / "tools" / "goldens.py"
    run = subprocess.run([sys.executable, tool, "--check"], capture_output=True, text=True)
    assert run.returncode == 0, run.stdout
    kept = list((ROOT / "golden_outputs" / "regression").rglob("*.lst"))
    decks = [d for d in (ROOT / "decks").rglob("*.dat") if d.parent.name != "stars"]
    assert len(kept) == len(decks) > 10
