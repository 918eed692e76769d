"""Every field of every card as `vopd cards` explains it: columns, name, unit, meaning, decimals.

The table is that of Appendix F and of the FORMATs of the listing, typed in once more.
"""

from __future__ import annotations

import io
from typing import NamedTuple

import pytest

from tests.kit.command import CASE_1
from vopd.cards.explain import explain_deck
from vopd.cards.format import BASIC_DATA, GROUPS, format_items, group_of

CASE = CASE_1.read_text().splitlines()
CARDS = [*CASE[:41], "    1", "  731   67", f"{13:5d}{0:5d}{0:5d}{0:5d}", *CASE[43:]]
"""Case 1 with a card of group 11, and zeros on that of group 12."""


class Group(NamedTuple):
    """A card of a group, its title, how many cards the group has, and the fields of the card."""

    card: int
    title: str
    cards: str
    fields: str


TABLE = {
    1: Group(1, "lens distortion", "25", """
        1-10 F3 XRR mm radial distance
        11-20 F3 RRR micrometre radial distortion"""),
    3: Group(27, "camera in the vehicle", "1", """
        1-5 I III - number of trajectory cards (group 7)
        6-10 I IWV - number of wind cards (group 4)
        11-15 F0 S1M - yaw multiplier
        16-20 F0 S1A deg yaw offset
        21-25 F0 S2M - pitch multiplier
        26-30 F0 S2A deg pitch offset
        31-35 F0 S3M - roll multiplier
        36-40 F0 S3A deg roll offset"""),
    4: Group(28, "wind", "IWV", """
        1-10 F1 ALT ft altitude above sea level
        11-20 F1 VXO ft/s wind velocity, + from south
        21-30 F1 VYO ft/s wind velocity, + from west"""),
    5: Group(31, "counts", "(NFR + 3)/16, rounded up", """
        1-5 I NT - number of landmarks (group 9)
        6-10 I NFR - number of frames
        11-15 I NTFR - number of time cards (group 6)
        16-20 I NPT(1) - landmarks in frame 1 of the film"""),
    6: Group(32, "time of frames", "NTFR", """
        1-5 I IFRM - frame number
        6-15 F1 TIMX s flight time"""),
    7: Group(34, "trajectory", "III", """
        1-10 F1 TX s time
        11-20 F1 XXX ft vehicle X, + east
        21-30 F1 YYY ft vehicle Y, + north
        31-40 F1 ZZZ ft vehicle Z, + up
        41-50 F1 VVX ft/s vehicle velocity, + north
        51-60 F1 VVY ft/s vehicle velocity, + east
        61-70 F1 VVZ ft/s vehicle velocity, + down
        71-80 F1 H ft vehicle altitude above sea level"""),
    8: Group(38, "focal length, origin, first estimate", "1", """
        1-10 F1 CC mm focal length
        11-20 F1 PHI deg origin geodetic latitude
        21-30 F1 THZ deg origin longitude, + east
        31-40 F1 RZ 1000_ft origin distance from Earth's centre
        41-50 F1 SIG1 deg initial camera yaw
        51-60 F1 SIG2 deg initial camera pitch
        61-70 F1 SIG3 deg initial camera roll"""),
    9: Group(39, "landmarks", "NT", """
        1-10 I ITGT - landmark number
        11-20 F2 THJ deg landmark longitude degrees, + east
        21-30 F2 THJMI min landmark longitude minutes
        31-40 F2 PHIJ deg landmark latitude degrees
        41-50 F2 PHIJMI min landmark latitude minutes
        51-60 F2 RJ ft landmark altitude"""),
    10: Group(42, "number of group 11 cards", "1", "1-5 I NOUT - number of group 11 cards"),
    11: Group(43, "ignored in one frame", "NOUT", """
        1-5 I IFM - frame number
        6-10 I JOUT(1) - landmark to ignore (100 first: the whole frame)
        11-15 I JOUT(2) - landmark to ignore (100 first: the whole frame)
        16-20 I JOUT(3) - landmark to ignore (100 first: the whole frame)
        21-25 I JOUT(4) - landmark to ignore (100 first: the whole frame)
        26-30 I JOUT(5) - landmark to ignore (100 first: the whole frame)
        31-35 I JOUT(6) - landmark to ignore (100 first: the whole frame)"""),
    12: Group(44, "return group, ignored in all frames", "(NT + 1)/16, rounded up", """
        1-5 I NGO - return group
        6-10 I IOUT(1) - landmark to ignore
        11-15 I IOUT(2) - landmark to ignore
        16-20 I IOUT(3) - landmark to ignore"""),
    0: Group(45, "readings of the film", "12 + 3 NPT a frame", """
        9-10 I ISAVE - landmark number
        41-47 F3 XSAVE in x on the reader
        51-57 F3 YSAVE in y on the reader
        64-67 I IFRAM - frame number"""),
}  # fmt: skip


def explained(cards: list[str], card: int) -> list[str]:
    """The lines about one card."""
    deck = io.BytesIO("\n".join(cards).encode())
    (text,) = explain_deck(deck, "deck", lambda _, number: number == card)
    return text.splitlines()


SEVENS = {1: (1, 80), 3: (11, 40), 4: (1, 80), 6: (6, 80), 7: (1, 80), 8: (1, 80), 9: (11, 60)}
"""Columns that can hold anything without making another deck of it."""


@pytest.mark.parametrize("number", TABLE)
def test_every_field_of_a_card(number: int) -> None:
    """A card of 7s where it can be, so that each field shows its implied decimals."""
    group = TABLE[number]
    label = f"group {number}" if number else "basic data"
    first, last = SEVENS.get(number, (1, 0))
    text = CARDS[group.card - 1].ljust(80)
    text = (text[: first - 1] + "7" * (last - first + 1) + text[last:]).rstrip()
    lines = explained([*CARDS[: group.card - 1], text, *CARDS[group.card :]], group.card)
    place = ", frame 1 of the film, fiducial 1, reading 1" if number == 0 else ""
    assert lines[:2] == [f"card {group.card}, {label}: {group.title}{place}", f"  |{text}"]
    fields = [line.split(maxsplit=4) for line in group.fields.splitlines() if line.strip()]
    for line, (columns, kind, name, unit, meaning) in zip(lines[2:], fields, strict=False):
        unit = "" if unit == "-" else unit.replace("_", " ")
        assert line.startswith(f"   {'columns ' + columns:13}  {name:8} ")
        assert line[40:].startswith(f"{unit:10}  {meaning}")
        begin, end = map(int, columns.split("-"))
        if first <= begin and end <= last:
            decimals = int(kind[1:] or 0)
            value = float("7" * (end - begin + 1)) / 10.0**decimals
            assert float(line[27:39]) == float(f"{value:.12g}")
            implied = f"  (point implied, {decimals} decimals)" if decimals else ""
            assert line[52:] == meaning + implied
    said = [line for line in lines[2:] if "hold something" not in line]
    assert len(said) == len(fields)


def test_the_title() -> None:
    assert explained(CARDS, 26)[::2] == [
        "card 26, group 2: title",
        "   columns 1-80  TITLE   printed at the top of every page",
    ]


@pytest.mark.parametrize("number", TABLE)
def test_how_many_cards_a_group_has_in_words(number: int) -> None:
    assert group_of(number).cards == TABLE[number].cards
    assert group_of(number).label == (f"group {number}" if number else "basic data")


def test_edit_descriptors() -> None:
    """Of FORMAT 83 and of FORMAT 86."""
    assert [item.descriptor for item in format_items(83)] == ["I10", *5 * ["F10.2"]]
    assert [item.descriptor for item in format_items(86)] == ["I2", "F7.3", "F7.3", "I4"]


def test_which_groups_are_lists_and_what_their_last_field_means() -> None:
    """Findings name a field by its meaning; in a list the last field repeats."""
    assert [n for n, group in GROUPS.items() if group.is_list] == [5, 10, 12]
    assert not BASIC_DATA.is_list and BASIC_DATA.number == 0 and list(GROUPS) == [*range(1, 13)]
    assert GROUPS[5].fields[-1].meaning == "number of landmarks in a frame"
    assert GROUPS[2].fields[0].meaning == "title, a 1 in column 1"
