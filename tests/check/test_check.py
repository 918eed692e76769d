"""`vopd check`: every error and every condition is found once, at its card, and nothing else."""

from __future__ import annotations

import json
import warnings
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from tests.approved.texts import assert_approved
from tests.kit.cards import CardEdit, CardLines, punch, punch_all, two_frames
from tests.kit.command import CASE_1, DECKS, vopd
from vopd.check import check_deck

Report = dict[str, list[dict[str, Any]]]


class Expected(NamedTuple):
    """What an edit of the clean deck must draw."""

    edit: CardEdit
    severity: str
    card: int
    columns: str | None
    message: str


class Found(NamedTuple):
    """A finding of the JSON output."""

    severity: str
    card: int
    columns: str | None
    message: str


def check(cards: CardLines, folder: Path, *options: str) -> tuple[int, list[Found]]:
    deck = folder / "deck.dat"
    deck.write_text("\n".join(cards) + "\n")
    done = vopd("check", "--format", "json", *options, deck)
    (report,) = json.loads(done.stdout)
    return done.status, [
        Found(
            severity.removesuffix("s"),
            row["card"],
            row["columns"] and "{}-{}".format(*row["columns"]),
            row["message"],
        )
        for severity in ("errors", "warnings")
        for row in report[severity]
    ]


def agrees(seen: Found, expected: Expected) -> bool:
    return seen[:3] == expected[1:4] and expected.message in seen.message


def _short_lens_table(cards: CardLines) -> None:
    for card in range(1, 26):
        punch(card, 1, f"{0.1 * card:10.1f}")(cards)


def _short_trajectory(cards: CardLines) -> None:
    """Times 65, 70, 70.3, 70.5: the frames are at 70.87 and 70.90 s."""
    punch(36, 1, "      70.3")(cards)
    punch(37, 1, "      70.5")(cards)


ONE_EACH = {
    "not a number": Expected(
        punch(39, 41, "      5O.3"), "error", 39, "41-50", "not a number: '5O.3'"
    ),
    "not right-justified": Expected(
        punch(32, 1, "   0 "), "warning", 32, "1-5", "blanks read as zeros"
    ),
    "signs": Expected(punch(40, 21, "     32.70"), "warning", 40, "21-30", "differ in sign"),
    "spread": Expected(punch(56, 41, " 010200"), "warning", 56, "41-47", "differ by 0.026 in"),
    "no rectangle": Expected(
        punch_all(range(68, 71), 41, " 014300"), "warning", 65, None, "form no rectangle"
    ),
    "altitude": Expected(
        punch(37, 71, "  151014.9"), "warning", 37, "71-80", "X, Y, Z give 141"
    ),
    "frames out of order": Expected(
        punch_all(range(65, 86), 64, "0729"), "warning", 65, "64-67", "729 comes after frame 730"
    ),
    "wind too low": Expected(
        punch(30, 1, "   141000."), "warning", 30, "1-10", "2 frames"
    ),
    "odd landmark number": Expected(punch(57, 9, "66"), "error", 57, "9-10", "numbered 65, 66, 65"),
    "lens": Expected(_short_lens_table, "warning", 25, "1-10", "the lens table is extrapolated"),
}  # fmt: skip


@pytest.mark.parametrize("name", ONE_EACH)
def test_each_condition_alone(name: str, tmp_path: Path) -> None:
    cards = two_frames()
    ONE_EACH[name].edit(cards)
    status, (seen,) = check(cards, tmp_path)
    assert agrees(seen, ONE_EACH[name]), seen
    assert_approved(seen.message)
    assert status == (1 if ONE_EACH[name].severity == "error" else 0)


def test_ten_conditions_at_once(tmp_path: Path) -> None:
    cards = two_frames()
    for expected in ONE_EACH.values():
        expected.edit(cards)
    status, seen = check(cards, tmp_path)
    for name, expected in ONE_EACH.items():
        assert sum(agrees(one, expected) for one in seen) == 1, (name, seen)
    assert (status, len(seen)) == (1, len(ONE_EACH)), seen


def test_a_clean_deck_has_no_findings(tmp_path: Path) -> None:
    assert check(two_frames(), tmp_path) == (0, [])


def test_case_1_is_questioned_for_its_one_wide_reading() -> None:
    """Landmark 66: x 11.147, 11.137, 11.127."""
    with CASE_1.open("rb") as file:
        (finding,) = check_deck(file, "case1.dat")
    assert "differ by 0.020 in" in finding.message
    with CASE_1.open("rb") as file:
        assert check_deck(file, "case1.dat", spread_in=0.021) == []


MORE: dict[str, Expected] = {
    "trajectory order": Expected(
        punch(36, 1, "       69."), "error", 36, "1-10", "69 after 70"
    ),
    "time order": Expected(
        punch(33, 1, "    0"), "error", 33, "1-5", "0 after 0"
    ),
    "wind order": Expected(
        punch(29, 1, "   120000."), "error", 29, "1-10", "120000 after 130000"
    ),
    "lens order": Expected(
        punch(25, 1, "        1."), "error", 25, "1-10", "1 after 6.8"
    ),
    "time table ends": Expected(
        punch(33, 1, "  730"), "warning", 33, "1-5",
        ": frame 731",
    ),
    "time table begins": Expected(
        punch(32, 1, "  731"), "warning", 32, "1-5",
        ": frame 730",
    ),
    "trajectory ends": Expected(
        _short_trajectory, "warning", 37, "1-10",
        ": time 70.9",
    ),
    "unused landmark": Expected(
        punch(41, 9, "68"), "warning", 41, "1-10", "landmark 68"
    ),
    "ignores everything": Expected(
        punch(43, 6, "   65   66   67"), "warning", 43, "6-10", "every landmark is to be ignored"
    ),
    "a frame that is not counted": Expected(
        punch(31, 30, "4"), "warning", 31, "30-30", "'4' stands behind the last number"
    ),
    "a second NOUT": Expected(punch(42, 8, "1  2"), "warning", 42, "8-11", "'1  2' stands behind"),
    "a landmark that is not read": Expected(
        punch(43, 29, "66"), "warning", 43, "29-30", "NT of group 5 counts"
    ),
    "return group": Expected(punch(43, 4, "14"), "error", 43, "1-5", "14 is not a return group"),
    "tab": Expected(punch(28, 5, "\t"), "error", 28, "5-5", "a tab"),
    "too many columns": Expected(punch(28, 90, "x"), "error", 28, "81-81", "80 columns"),
    "undefined": Expected(
        punch(41, 9, "68"), "error", 62, "9-10", "landmark 67"
    ),
    "one number too few": Expected(
        punch(31, 16, "    2"), "error", 62, "64-67", "counts 2 landmarks"
    ),
    "one number too many": Expected(
        punch(31, 16, "    4"), "error", 65, "64-67", "4 landmarks for frame 730"
    ),
    "too few at the end": Expected(punch(31, 21, "    2"), "error", 83, "64-67", "one more"),
    "too many at the end": Expected(
        punch(31, 21, "    4"), "error", 86, None, "45 cards expected, 42"
    ),
    "a mispunched frame": Expected(
        punch(70, 64, "0713"), "error", 70, "64-67", "frame 713"
    ),
    "no digits": Expected(
        punch(27, 16, "    ."), "warning", 27, "16-20", "a number without digits: '.' is 0"
    ),
    "one landmark": Expected(
        punch_all(range(77, 86), 9, "66"), "warning", 65, None,
        "731 has only landmark 66; an attitude",
    ),
    "repeated frame": Expected(
        punch_all(range(65, 86), 64, "0730"), "warning", 65, "64-67",
        "frame 730",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", MORE)
def test_more_conditions(name: str, tmp_path: Path) -> None:
    """Some of these edits have further consequences, which are found too."""
    cards = two_frames()
    MORE[name].edit(cards)
    status, seen = check(cards, tmp_path)
    assert sum(agrees(one, MORE[name]) for one in seen) == 1, seen
    assert_approved([one.message for one in seen])
    assert status == (1 if any(one.severity == "error" for one in seen) else 0)


def test_one_landmark_read_twice_is_one_landmark(tmp_path: Path) -> None:
    """With 65 and 67 ignored in frame 731, only two sightings of 66 take part."""
    cards = two_frames()
    punch_all(range(77, 80), 9, "66")(cards)  # the first landmark of frame 731
    punch(42, 5, "1")(cards)
    cards.insert(42, "  731   67")
    status, seen = check(cards, tmp_path)
    assert (status, [(one.severity, one.card) for one in seen]) == (0, [("warning", 66)])
    assert_approved(seen[0].message)


DROPPED = ["  730  100", "  731  100"]
"""Group 11: no frame is solved."""


@pytest.mark.parametrize(
    ("edit", "stops"),
    [
        (punch(25, 1, "        1."), False),  # lens
        (punch(29, 1, "   120000."), False),  # wind
        (punch(33, 1, "    0"), True),  # the time of a dropped frame is looked up
        (punch(36, 1, "       69."), True),  # and its position
    ],
    ids=["lens", "wind", "time", "trajectory"],
)
def test_a_table_out_of_order_is_an_error_where_a_run_stops(
    edit: CardEdit, stops: bool, tmp_path: Path
) -> None:
    """A run and the check agree: a table is only in order or not when it is used."""
    cards = two_frames()
    edit(cards)
    punch(42, 5, "2")(cards)
    cards[42:42] = DROPPED
    status, seen = check(cards, tmp_path)
    (finding,) = [one for one in seen if "values must ascend" in one.message]
    run = vopd("run", "-q", tmp_path / "deck.dat")
    assert (run.status, status) == ((1, 1) if stops else (0, 0))
    assert ("FTLUP stops the run" in run.stderr) == stops
    assert finding.severity == ("error" if stops else "warning")
    assert_approved(finding.message)


def test_numbers_that_are_far_too_large_are_questioned(tmp_path: Path) -> None:
    """A reading of 1E300 overflows in every square: the findings come out nevertheless."""
    cards = two_frames()
    punch(56, 41, " 1.E300")(cards)
    punch(44, 51, "-1.E300")(cards)
    punch(37, 71, "    1.E300")(cards)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        status, seen = check(cards, tmp_path)
    assert (status, {one.card for one in seen}) == (0, {25, 37, 44, 56})
    assert max(len(one.message) for one in seen) < 100


@pytest.mark.parametrize("together", [1, 2, 10_000])
def test_jobs_are_checked_some_at_a_time_as_all_at_once(
    together: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    deck = DECKS / "appendix_h" / "cases_1_2_3.dat"
    expected = vopd("check", deck).stdout
    monkeypatch.setattr("vopd.check.TOGETHER", together)
    assert vopd("check", deck).stdout == expected and "card 59" in expected
