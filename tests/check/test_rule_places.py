"""Rules: the card they point at, when they apply, and that they are asked again of a later job."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.cards import CardEdit, CardLines, landmarks_again, punch, punch_all, two_frames
from vopd import check as earth_rule
from vopd.cards.deck import CardBlock, byte_matrix
from vopd.check import (
    CARD_RULES,
    EARTH_GROUPS,
    RUN_RULES,
    CardLocations,
    check_deck,
    decimal_text,
)
from vopd.findings import Finding
from vopd.job import Job

# The card and the columns that each rule names, for every field and both ends that it looks at


def questioned(*edits: CardEdit) -> list[Finding]:
    """What is said about the clean deck of two frames with some cards punched anew."""
    cards = two_frames()
    for edit in edits:
        edit(cards)
    return check_deck(io.BytesIO("\n".join(cards).encode()), "deck.dat")


SIGNS = {  # card 40: degrees in columns 11 and 31, minutes in 21 and 41
    "longitude": (punch(40, 21, "     32.70"), (21, 30)),
    "latitude": (punch(40, 41, "   -50.000"), (41, 50)),
    "latitude south": (punch(40, 31, "   -33.   "), (41, 50)),
}


@pytest.mark.parametrize("name", SIGNS)
def test_minutes_of_another_sign_than_the_degrees(name: str) -> None:
    """The columns are those of the minutes, of the coordinate that is meant."""
    edit, columns = SIGNS[name]
    (found,) = [one for one in questioned(edit) if "differ in sign" in one.message]
    assert (found.card, found.group, found.columns) == (40, 9, columns)
    assert_approved(found.message)
    assert found.severity == "warning"


TIMES_S = np.interp([730.0, 731.0], [0.0, 2520.0], [48.073, 126.774])
ALTITUDES_FT = np.interp(
    TIMES_S, [70.0, 71.0], [float(card[70:80]) for card in two_frames()[34:36]]
)
"""By groups 6 and 7, of which rows 35 and 36 are those about the frames; the second is lower."""

ENDS = {  # the edits; the card named; the number named
    "frames, below": ([punch(32, 1, "  735")], 32, "frame 730"),
    "frames, above": ([punch(33, 1, "  725")], 33, "frame 731"),
    "times, below": (
        [punch(34, 1, "     70.91"), punch(35, 1, "     70.95")], 34, f"time {TIMES_S[0]:.8g}",
    ),
    "times, above": (
        [punch(36, 1, "      70.1"), punch(37, 1, "      70.2")], 37, f"time {TIMES_S[1]:.8g}",
    ),
    "altitudes, below": (
        [punch(28, 1, "   145000."), punch(29, 1, "   148000.")], 28,
        f"altitude {ALTITUDES_FT[1]:.8g}",
    ),
    "altitudes, above": ([punch(30, 1, "   141000.")], 30, f"altitude {ALTITUDES_FT[0]:.8g}"),
}  # fmt: skip


@pytest.mark.parametrize("name", ENDS)
def test_both_ends_of_every_table(name: str) -> None:
    """Both frames lie outside; the number named is that farther from the table.

    A time or an altitude that is extrapolated may then lie outside the table after it.
    """
    edits, card, number = ENDS[name]
    told = [one for one in questioned(*edits) if "is extrapolated: " in one.message]
    (found,) = [one for one in told if one.card == card]
    assert_approved(found.message)
    assert found.columns == ((1, 5) if "frame" in number else (1, 10))
    assert found.severity == "warning"


def block(group: int, first: int, *texts: bytes) -> CardBlock:
    """Consecutive cards of a group."""
    return CardBlock(byte_matrix(texts), first, Finding("", source="deck", group=group))


def test_cards_of_a_group_in_several_blocks() -> None:
    """A long film is read in blocks, and so are the lists of groups 5 and 12."""
    locations = CardLocations()
    locations.add(block(9, 10, b"a", b"b", b"c"))
    locations.add(block(9, 20, b"d", b"e"))
    found = [locations.warning(9, row, "RJ", "high") for row in range(6)]
    assert [one.card for one in found] == [10, 11, 12, 20, 21, None]
    assert [one.columns for one in found] == [*5 * [(51, 60)], None]
    assert [one.image and one.image[0] for one in found] == [*"abcde", None]
    assert {one.severity for one in found} == {"warning"} and {one.group for one in found} == {9}
    whole = [locations.warning(9, row, "", "high") for row in (0, 2, 3, 4)]
    assert [(one.card, one.columns) for one in whole] == [
        (10, None), (12, None), (20, None), (21, None),
    ]  # fmt: skip


def test_cards_that_are_read_again_replace_the_old_ones() -> None:
    locations = CardLocations()
    locations.add(block(9, 10, b"a", b"b"))
    locations.add(block(7, 12, b"c"))
    assert locations.was_read(9) and locations.was_read(7)
    locations.next_job()
    assert not locations.was_read(9)
    locations.add(block(9, 30, b"d"))
    assert locations.was_read(9) and not locations.was_read(7)
    assert locations.warning(9, 0, "RJ", "").card == 30
    assert locations.warning(9, 1, "RJ", "").card is None
    assert locations.warning(7, 0, "H", "").card == 12


def test_numbers_in_messages_have_a_bounded_length() -> None:
    numbers = (1.25, -1.25, 99999999.4, -99999999.4, 1e8, -1e8, -123456789012.0)
    assert [decimal_text(one, 1) for one in numbers] == [
        "1.2", "-1.2", "99999999.4", "-99999999.4", "1e+08", "-1e+08", "-1.235e+11",
    ]  # fmt: skip


FIELDS = {  # a field that is not a number beside each of the tables, with that table out of order
    "times, position": (punch(36, 1, "       69."), punch(35, 11, "        xx"), 36),
    "times, altitude": (punch(36, 1, "       69."), punch(34, 71, "        xx"), 36),
    "frames, time": (punch(33, 1, "    0"), punch(32, 6, "        xx"), 33),
    "altitudes, wind": (punch(29, 1, "   120000."), punch(28, 11, "        xx"), 29),
    "radii, distortion": (punch(25, 1, "        1."), punch(9, 11, "        xx"), 25),
}


@pytest.mark.parametrize("name", FIELDS)
def test_a_table_out_of_order_that_holds_no_number(name: str) -> None:
    """Both are errors, and nothing else about the deck is lost for them."""
    order, field, card = FIELDS[name]
    found = questioned(order, field, punch(40, 41, "   -50.000"))
    told = {one.card: one.severity for one in found if "values must ascend" in one.message}
    assert told == {card: "error"}
    assert [one.severity for one in found if "not a number" in one.message] == ["error"]
    assert [one.severity for one in found if "differ in sign" in one.message] == ["warning"]


@pytest.mark.parametrize(
    ("edit", "card"), [(punch(33, 1, "    0"), 33), (punch(36, 1, "       69."), 36)]
)
def test_nothing_is_said_about_numbers_that_a_table_out_of_order_would_give(
    edit: CardEdit, card: int
) -> None:
    """Times that cannot be looked up, and altitudes at such times, lie outside no table."""
    (found,) = questioned(edit)
    assert (found.card, found.severity) == (card, "error")
    assert_approved(found.message)


def test_a_deck_of_group_1_alone() -> None:
    """It has no job, which is a warning; where a card is wrong, that is said instead."""
    cards = two_frames()[:25]
    deck = io.BytesIO("\n".join(cards).encode())
    assert_approved(check_deck(deck, "a.dat"))
    punch(7, 1, "       x.")(cards)
    (found,) = check_deck(io.BytesIO("\n".join(cards).encode()), "a.dat")
    assert (found.card, found.severity) == (7, "error")


@pytest.mark.parametrize("limits_1974", [False, True])
def test_limits_are_asked_for(limits_1974: bool) -> None:
    """Landmark 91 exceeds an array of 1974."""
    cards = two_frames()
    punch(41, 1, f"{91:10d}")(cards)
    found = check_deck(io.BytesIO("\n".join(cards).encode()), "a.dat", limits_1974=limits_1974)
    assert any("TTHJ(90)" in one.message for one in found) == limits_1974
    default = check_deck(io.BytesIO("\n".join(cards).encode()), "a.dat")
    assert not any("TTHJ(90)" in one.message for one in default)


def test_findings_are_said_once_in_the_order_of_the_cards() -> None:
    """An undefined landmark of two frames; a card with two findings, by their columns."""
    cards = two_frames()
    for edit in (punch(41, 9, "68"), punch(39, 41, "     5 .3"), punch(39, 21, "    36 65")):
        edit(cards)
    found = check_deck(io.BytesIO("\n".join(cards).encode()), "a.dat")
    places = [(one.card, one.columns) for one in found]
    assert places == sorted(places) and len(set(found)) == len(found)
    undefined = [one for one in found if "not defined" in one.message]
    assert_approved([(one.card, one.message) for one in undefined])
    assert {one.columns for one in found if one.card == 39} == {(21, 30), (41, 50)}


# When a rule of `vopd check` is asked, and of which landmarks of a frame


IGNORED = {  # what is punched into groups 10 to 12: whether landmark 67, not defined, takes part
    "nothing": ([], True),
    "by group 12": ([punch(43, 6, "   67")], False),
    "another by group 12": ([punch(43, 6, "   66")], True),
}


@pytest.mark.parametrize("name", IGNORED)
def test_a_landmark_that_takes_part_must_be_defined(name: str) -> None:
    edits, takes_part = IGNORED[name]
    cards = two_frames()
    all_edits: list[CardEdit] = [punch(41, 9, "68"), *edits]
    for edit in all_edits:
        edit(cards)
    found = check_deck(io.BytesIO("\n".join(cards).encode()), "a.dat")
    undefined = [(one.card, one.severity) for one in found if "is not defined" in one.message]
    assert undefined == ([(62, "error")] if takes_part else [])


ANEW = {  # the rule: the groups whose cards it looks at
    "copied_readings": {0}, "fiducials": {0}, "frame_order": {0},
    "too_few_landmarks": {0, 5, 12}, "lens_reach": {0, 1}, "unused_landmarks": {9},
    "signs": {9}, "tables_in_order": {1, 4, 6, 7, 11, 12}, "tables_span": {4, 6, 7},
    "altitudes": {7, 8},
    "focal_length": {8}, "ignored_all": {12}, "behind_lists": {5, 10, 12},
}  # fmt: skip


RULES = CARD_RULES + RUN_RULES


def test_when_each_rule_is_asked_again() -> None:
    assert {rule.__name__: set(groups) for rule, groups in RULES} == ANEW
    assert len(RULES) == len(ANEW)
    assert set(EARTH_GROUPS) == {0, 5, 6, 7, 8, 9, 11, 12}


def test_a_landmark_that_a_later_job_defines() -> None:
    """The first job ignores it; the second has it in the place of landmark 66."""
    cards = two_frames()
    landmark_67 = cards[40]
    for edit in (punch(41, 9, "68"), punch(43, 6, "   67")):
        edit(cards)
    cards = landmarks_again(cards)
    assert cards[94][8:10] == "66"
    cards[94] = landmark_67
    found = check_deck(io.BytesIO("\n".join(cards).encode()), "a.dat")
    assert [one for one in found if "is not defined" in one.message] == []


# A later job
#
# The first job is clean; the second reads the same cards from a return group on, with one edit.


FIRST = {1: 1, 2: 26, 3: 27, 4: 28, 5: 31, 6: 32, 7: 34, 8: 38, 9: 39, 10: 42, 11: 43, 12: 43}
"""The first card of each group; 43 cards are control cards, and the film has 42."""


def two_jobs(group: int, *edits: CardEdit, before: tuple[CardEdit, ...] = ()) -> CardLines:
    """The clean deck, which returns to a group, and its cards from there on with some edits.

    The basic data come again after groups 1 and 2.
    """
    first = two_frames()
    for edit in before:
        edit(first)
    second = list(first)
    for edit in edits:
        edit(second)
    first[42] = f"{group:5d}" + first[42][5:]
    return [*first, *second[FIRST[group] - 1 : 43], *(second[43:] if group <= 2 else [])]


def said(cards: CardLines) -> list[Finding]:
    return check_deck(io.BytesIO("\n".join(cards).encode()), "a.dat")


def together(*edits: CardEdit) -> CardEdit:
    def edit(cards: CardLines) -> None:
        for one in edits:
            one(cards)

    return edit


SHORT_LENS = together(*(punch(card, 1, f"{0.1 * card:10.1f}") for card in range(1, 26)))
SHORT_PATH = together(punch(36, 1, "      70.3"), punch(37, 1, "      70.5"))
LOW = punch_all(range(34, 38), 11, "  -100000.   -80000.    12000.")  # 13 km from the landmarks
HIGH = punch_all(range(34, 38), 11, "  -100000.   -80000.   138000.")
DOWN = punch(38, 31, " 20799.698")  # the origin is 126000 ft below sea level
ASKED = {  # the return group, the edit of the second job, the card named there, what is said
    "spread": (2, punch(56, 41, " 010200"), 56, "three readings of this point differ"),
    "fiducials": (2, punch_all(range(68, 71), 41, " 014300"), 65, "form no rectangle"),
    "frame order": (2, punch_all(range(65, 86), 64, "0729"), 65, "729 comes after frame 730"),
    "few landmarks": (2, punch_all(range(77, 86), 9, "66"), 65, "has only landmark 66"),
    "lens, new film": (2, punch_all(range(56, 59), 41, " 031000"), None, "lens table is extrap"),
    "lens, new table": (1, SHORT_LENS, 25, "lens table is extrapolated"),
    "unused": (9, punch(41, 9, "68"), 41, "landmark 68 is in no frame"),
    "signs": (9, punch(40, 21, "     32.70"), 40, "differ in sign"),
    "order, lens": (1, punch(25, 1, "        1."), 25, "1 after 6.8, where"),
    "order, wind": (4, punch(29, 1, "   120000."), 29, "120000 after 130000, where"),
    "order, frames": (6, punch(33, 1, "    0"), 33, "0 after 0, where"),
    "order, times": (7, punch(36, 1, "       69."), 36, "69 after 70, where"),
    "span, wind": (4, punch(30, 1, "   141000."), 30, "2 frames are outside this table"),
    "span, frames": (6, punch(33, 1, "  730"), 33, "1 frame is outside this table"),
    "span, times": (7, SHORT_PATH, 37, "outside this table"),
    "altitude": (7, punch(37, 71, "  151014.9"), 37, "X, Y, Z give 141"),
    "all ignored": (12, punch(43, 6, "   65   66   67"), 43, "every landmark is to be ignored"),
    "Earth, trajectory": (7, LOW, None, "the spherical Earth of 1974 turns the attitude"),
}


COLUMNS = {  # that are named, where they are not the first ten
    "spread": (41, 47),
    "fiducials": None,
    "frame order": (64, 67),
    "few landmarks": None,
    "signs": (21, 30),
    "order, frames": (1, 5),
    "span, frames": (1, 5),
    "altitude": (71, 80),
    "all ignored": (6, 10),
}


@pytest.mark.parametrize("name", ASKED)
def test_what_is_new_in_the_second_job_is_said(name: str) -> None:
    """At its card, which is beyond the 85 cards of the first; a card that is not read is None."""
    group, edit, card, words = ASKED[name]
    found = said(two_jobs(group, edit))
    told = [one for one in found if words in one.message]
    assert told
    if card is not None:
        assert [one.card for one in told] == [85 + card - FIRST[group] + 1]
        assert told[0].columns == COLUMNS.get(name, (1, 10))


def test_the_clean_jobs_have_no_findings() -> None:
    for group in (1, 2, 5, 9, 12):
        assert said(two_jobs(group)) == []


def test_what_is_not_read_again_is_said_once() -> None:
    """Card 41, of group 9, is in force for both jobs; from group 9 on it is read twice."""
    unused = (
        punch(41, 9, "68"),
        punch_all(range(62, 65), 9, "66"),
        punch_all(range(83, 86), 9, "66"),
    )
    for group, cards in ((10, [41]), (9, [41, 85 + 3])):
        found = said(two_jobs(group, before=unused))
        assert [one.card for one in found if "is in no frame" in one.message] == cards


def test_a_frame_that_is_left_with_one_landmark() -> None:
    """Frame 731 shows 66 twice, and 67, which group 12 of the second job ignores."""
    twice = (punch_all(range(77, 80), 9, "66"),)
    assert said(two_jobs(12, before=twice)) == []
    (found,) = said(two_jobs(12, punch(43, 6, "   67"), before=twice))
    assert_approved(found.message)
    assert found.card == 65


EARTH = "the spherical Earth of 1974 turns the attitude by 0.36 degrees in 2 frames"


def test_an_origin_that_is_moved() -> None:
    """12000 ft above sea level the Earth of 1974 counts, and 138000 ft it does not."""
    assert not [one for one in said(two_jobs(8, before=(HIGH,))) if "1974" in one.message]
    assert [one.card for one in said(two_jobs(8, DOWN, before=(HIGH,))) if EARTH in one.message]


def test_altitudes_above_another_origin() -> None:
    """Positions 126000 ft lower contradict the altitudes of group 7, which are read once."""
    assert not [one for one in said(two_jobs(8)) if "X, Y, Z give" in one.message]
    told = [one for one in said(two_jobs(8, DOWN)) if "X, Y, Z give" in one.message]
    assert [one.card for one in told] == [34, 35, 36, 37]


def test_a_table_that_a_later_job_uses() -> None:
    """The first job drops both frames, and the lens table is not used; the second solves them."""
    cards = two_frames()
    punch(25, 1, "        1.")(cards)
    dropped = [*cards[:41], "    2", "  730  100", "  731  100", cards[42], *cards[43:]]
    dropped[44] = "   10" + cards[42][5:]
    found = said([*dropped, "    0", "   13    0    0    0"])
    told = [(one.card, one.severity) for one in found if "values must ascend" in one.message]
    assert sorted(told) == [(25, "error"), (25, "warning")]


@pytest.mark.parametrize("group", [2, 5, 11, 12])
def test_the_earth_is_asked_about_every_job(group: int, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    real = earth_rule.earth_cost

    def earth_cost(*jobs: Job) -> tuple[Any, ...]:
        asked.extend(job.return_group for job in jobs)
        return real(*jobs)

    monkeypatch.setattr(earth_rule, "earth_cost", earth_cost)
    said(two_jobs(group))
    assert asked == [group, 13]


def test_frames_that_are_no_longer_dropped() -> None:
    """The first job drops both frames of a low flight; the second, from group 10 on, does not."""
    cards = two_frames()
    LOW(cards)
    dropped = [*cards[:41], "    2", "  730  100", "  731  100", cards[42], *cards[43:]]
    assert not [one for one in said(dropped) if "1974" in one.message]
    dropped[44] = "   10" + cards[42][5:]
    found = said([*dropped, "    0", "   13    0    0    0"])
    assert len([one for one in found if EARTH in one.message]) == 1
