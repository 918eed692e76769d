"""Every rule is asked again about a later job where the cards that it looks at are read anew.

The first job is clean; the second reads the same cards from a return group on, with one edit.
"""

from __future__ import annotations

import io

import pytest

from tests.kit.cards import CardEdit, CardLines, punch, punch_all, two_frames
from vopd import check as earth_rule
from vopd.check import EarthCost, check_deck
from vopd.findings import Finding
from vopd.job import Job

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
    "order, lens": (1, punch(25, 1, "        1."), 25, "1 does not exceed 6.8"),
    "order, wind": (4, punch(29, 1, "   120000."), 29, "120000 does not exceed 130000"),
    "order, frames": (6, punch(33, 1, "    0"), 33, "0 does not exceed 0"),
    "order, times": (7, punch(36, 1, "       69."), 36, "69 does not exceed 70"),
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
    assert found.message.startswith("frame 731 has only landmark 66; ") and found.card == 65


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
    told = [(one.card, one.severity) for one in found if "does not exceed" in one.message]
    assert sorted(told) == [(25, "error"), (25, "warning")]


@pytest.mark.parametrize("group", [2, 5, 11, 12])
def test_the_earth_is_asked_about_every_job(group: int, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    real = earth_rule.earth_cost

    def earth_cost(job: Job) -> EarthCost:
        asked.append(job.return_group)
        return real(job)

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
