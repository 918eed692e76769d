"""When a rule of `vopd check` is asked, and of which landmarks of a frame."""

from __future__ import annotations

import io

import pytest

from tests.kit.card_edits import CardEdit, landmarks_again, punch, two_frames
from vopd.check import RULES, check_deck

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
    "reading_spread": {0}, "copied_readings": {0}, "fiducials": {0}, "frame_order": {0},
    "too_few_landmarks": {0, 5, 12}, "lens_reach": {0, 1}, "unused_landmarks": {9},
    "signs": {9}, "tables_in_order": {1, 4, 6, 7, 11, 12}, "tables_span": {4, 6, 7},
    "altitudes": {7, 8}, "ignored_all": {12}, "earth_of_1974": {0, 5, 6, 7, 8, 9, 11, 12},
}  # fmt: skip


def test_when_each_rule_is_asked_again() -> None:
    assert {rule.__name__: set(groups) for rule, groups in RULES} == ANEW
    assert len(RULES) == len(ANEW)


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
