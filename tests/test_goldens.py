"""What the outside world printed, to the last digit; and decks/regression, worked out by hand."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.tolerances import assert_close
from vopd.errata import fixes
from vopd.listing.compare import compare_listings
from vopd.results import Outcome, Results

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


# The decks of decks/regression


DECKS = Path(__file__).parents[1] / "decks" / "regression"


def solved(deck: str) -> list[Results]:
    return [vopd.run(job) for job in vopd.read_deck(DECKS / f"{deck}.dat")]


def field_after(lines: list[str], heading: str, row: int, first: int, last: int) -> str:
    """Columns `first` to `last` of a row under a heading; rows count from 1."""
    at = next(k for k, line in enumerate(lines) if heading in line)
    return lines[at + row][first - 1 : last]


def test_requests() -> None:
    """Landmarks 11 to 15 are read in each frame; group 12 names 13, a zero, -1 and 100.

    NK counts what is asked for, and 5 - NK may not fall below 2.
    """
    (results,) = solved("requests")
    left = [results.landmark[f, results.used[f]].tolist() for f in range(7)]
    assert left == [
        [12, 14, 15],  # 11 by group 11, 13 by group 12
        [],  # 100: dropped
        [14, 15],  # 11, 12, 13 go in the order of reading; 14 and 15 would leave one
        [11, 14, 15],  # 100 is not first and does nothing; 12 by the frame's second card
        [12, 14],  # 11; the second card's 100 does nothing and its 15 counts
        [11, 12, 14, 15],
        [11, 12, 14, 15],
    ]
    assert results.outcome.tolist() == [0, Outcome.DROPPED, 0, 0, 0, 0, 0]
    lines = vopd.listing_text(results).split("\n")
    ignored = [line.split()[0] for line in lines if line[7:].startswith("IGNORED BY")]
    assert ignored == ["11", "13", "11", "12", "13", "12", "13", "11", "13", "15", "13", "13"]
    assert [line for line in lines if "FRAME   2" in line] == [
        "      FRAME   2IGNORED BY USERS DIRECTION"
    ]


TRUTH = [
    (5.0, -2.0, 4.0),
    (3.0, 1.0, 2.0),
    (1.0, 4.0, 1.5),
    (2.0, 2.5, 358.0),
    (4.0, 1.0, 3.0),
    (8.0, -1.0, 5.0),
]
"""Yaw, pitch, roll of frames 1 to 6 of `restart.dat`; frame 7 stands at 6, -2, 6."""


def test_restart() -> None:
    """Degrees are compared with 6.2831853 and 3.14159265; group 8 has 85, 51, 271.

    Frame 3's pitch 4, frame 4's roll 358 and frame 6's yaw 8 are beyond them, and
    the frame after each starts in that angle from group 8.
    """
    (results,) = solved("restart")
    assert_close("angle from the film reader", results.camera_deg[:6], TRUTH)
    start = results.start_deg
    restarts = start == [85.0, 51.0, 271.0]
    assert restarts.astype(int).tolist() == [
        [1, 1, 1],
        [0, 0, 0],
        [0, 0, 0],
        [0, 1, 0],
        [0, 0, 1],
        [0, 0, 0],
        [1, 0, 0],
    ]
    assert_close(
        "angle from the film reader", start[1:][~restarts[1:]], np.array(TRUTH)[~restarts[1:]]
    )


def test_restart_shows_in_the_listing() -> None:
    """Frame 7 starts with yaw 85 and ends in another minimum; carried on, it would be right."""
    (job,) = vopd.read_deck(DECKS / "restart.dat")
    last = vopd.run(job).camera_deg[6]
    assert np.abs(last - (6.0, -2.0, 6.0)).max() > 1.0
    assert_close(
        "angle from the film reader", vopd.run(job, fixes("restart")).camera_deg[6], (6, -2, 6)
    )


def test_zero_residuals() -> None:
    """Two jobs without a focal length, yaw from 361, which wraps to 361 - 359.999999569273.

    Job 1: frame 2 has everything at the centre and frame 3 is dropped; frame 4
    starts where frame 1 ended. Job 2: a distortion of -1000 um for each mm takes
    a landmark anywhere to the centre, as 1974's arithmetic would.
    """
    one, two = solved("zero_residuals")
    assert one.outcome.tolist() == [0, Outcome.EXACT, Outcome.DROPPED, 0]
    yaw = 1.000000430727
    assert_close("wrapped angle", one.start_deg[:, 0], [361.0, yaw, yaw, yaw])
    assert two.outcome.tolist() == [Outcome.EXACT]
    assert not two.at_centre.any()
    text = vopd.listing_text(two)
    assert text.count("       0.00000000E+00") + text.count("      -0.00000000E+00") == 8
    assert "\n\n\n\n END OF JOB\n" in text
    assert "0 FRAME" not in text


@pytest.mark.parametrize(
    ("heading", "row", "columns", "text"),
    [
        ("L-MARK LONGITUDE", 3, (8, 17), "*" * 10),  # -1186.30000 has eleven characters
        ("L-MARK LONGITUDE", 4, (8, 17), " 253.54167"),  # 254 - 27.5/60
        ("L-MARK LONGITUDE", 4, (48, 58), "*" * 11),  # -1000000.000 has twelve
        ("L-MARK LONGITUDE", 5, (48, 58), "*" * 11),  # 12345678.000 too
        ("0VEHICLE", 1, (8, 17), "*" * 10),  # -1234567.00 has eleven
        ("0VEHICLE", 1, (18, 27), "*" * 10),  # 12345678.00 too
        ("0VEHICLE", 1, (28, 37), "1199999.00"),
        ("0VEHICLE", 1, (38, 57), "*" * 20),  # (99999 - 3*99999)/4 = -49999.50000: twelve
        ("0 FRAME", 1, (6, 14), "*" * 9),  # 123456.700 has ten
        ("0 FRAME", 1, (42, 55), "*" * 14),  # -35690.463 in F7.3
        ("0L-MARK", 1, (35, 49), "    50481.38305"),  # F15.5 has room
    ],
)
def test_asterisks(heading: str, row: int, columns: tuple[int, int], text: str) -> None:
    """Frame 2 of the deck."""
    (results,) = solved("asterisks")
    lines = vopd.listing_text(results).split("\n1")[1].split("\n")
    assert field_after(lines, heading, row, *columns) == text


def test_no_frame_is_left_unconverged() -> None:
    """Or its digits would be another machine's noise."""
    decks = sorted(path.stem for path in DECKS.glob("*.dat"))
    assert len(decks) >= 11
    for deck in decks:
        assert all(results.converged.all() for results in solved(deck)), deck
