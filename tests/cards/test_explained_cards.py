"""Cards as `vopd cards` explains them: columns, names, units, meanings, decimals, notes.

The table is that of Appendix F and of the FORMATs of the listing, typed in once more.
"""

from __future__ import annotations

import io
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest

import vopd
from tests.approved.texts import refused
from tests.kit.command import CASE_1
from vopd.cards.explain import explain_deck
from vopd.cards.format import BASIC_DATA, GROUPS, format_items, group_of
from vopd.findings import InputError
from vopd.job import Job, Readings

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


# Notes on fields


CARDS_OF_FIELD = CASE_1.read_text().splitlines()


def explained_of_field(card: int, *edits: tuple[int, str]) -> list[str]:
    """The lines about one card of case 1, from its first field on, with texts put into columns."""
    line = CARDS_OF_FIELD[card - 1].ljust(80)
    for column, text in edits:
        line = line[: column - 1] + text + line[column - 1 + len(text) :]
    cards = [*CARDS_OF_FIELD[: card - 1], line, *CARDS_OF_FIELD[card:]]
    deck = io.BytesIO(("\n".join(cards) + "\n").encode())
    found = explain_deck(deck, "deck", lambda _, number: number == card)
    return next(found).splitlines()[2:]


RETURNS = {
    0: "(not a return group)",
    1: "(reading goes on at group 1; the basic data too)",
    2: "(reading goes on at group 2; the basic data too)",
    3: "(reading goes on at group 3; the basic data stay)",
    12: "(reading goes on at group 12; the basic data stay)",
    13: "(stop)",
    14: "(not a return group)",
}


@pytest.mark.parametrize("group", RETURNS)
def test_where_reading_goes_on(group: int) -> None:
    """Groups 1 and 2 come before the basic data, which are then read again (A 25 to A 118)."""
    (line, *_) = explained_of_field(43, (1, f"{group:5d}"))
    assert (
        line == f"   columns 1-5    NGO      {group:12d}             return group  {RETURNS[group]}"
    )


NOTES = {  # of X of the first card of group 7, columns 11 to 20, F10.1
    "   -26742.": ("-26742", ""),
    "          ": ("0", "  (blank: zero)"),
    "   -267429": ("-26742.9", "  (point implied, 1 decimals)"),
    "  -2 6742.": ("-206742", "  (blanks read as zeros)"),
    "         .": ("0", "  (a number without digits)"),
    "    -26x42": ("?", "  (not a number: '-26x42')"),
}


@pytest.mark.parametrize("text", NOTES)
def test_the_note_on_a_field(text: str) -> None:
    value, note = NOTES[text]
    line = explained_of_field(34, (11, text))[1]
    assert line == f"   columns 11-20  XXX      {value:>12} ft          vehicle X, + east{note}"


@pytest.mark.parametrize(("first", "last"), [(71, 71), (75, 80), (80, 80)])
def test_columns_that_hold_something_and_are_not_read(first: int, last: int) -> None:
    """Group 9 ends in column 60."""
    lines = explained_of_field(39, (first, "x" * (last - first + 1)))
    assert lines[-1] == f"   columns {first}-{last} hold something that is not read"
    assert len(lines) == 6 + 1


@pytest.mark.parametrize(("card", "fields"), [(31, 4), (42, 1), (43, 1)])
def test_numbers_behind_the_last_of_a_list_are_not_read(card: int, fields: int) -> None:
    """NT and NFR of group 5 count 3 landmarks and a frame; NOUT is alone."""
    lines = explained_of_field(card, (29, "66"))
    assert lines[-1] == "   columns 29-30 hold something that is not read"
    assert len(lines) == fields + 1


POINTS = {  # of a frame with four fiducials and three landmarks, from its first card, 44
    44: "fiducial 1, reading 1",
    46: "fiducial 1, reading 3",
    55: "fiducial 4, reading 3",
    56: "landmark 1 of 3, reading 1",
    64: "landmark 3 of 3, reading 3",
}


@pytest.mark.parametrize("card", POINTS)
def test_the_point_of_a_card_of_the_film_reader(card: int) -> None:
    deck = io.BytesIO(("\n".join(CARDS_OF_FIELD) + "\n").encode())
    (text,) = explain_deck(deck, "deck", lambda _, number: number == card)
    head = f"card {card}, basic data: readings of the film, frame 1 of the film, "
    assert text.splitlines()[0] == head + POINTS[card]


FIRSTS = {  # card of a list: name and meaning of its first number, and what follows
    31: ("NT", "number of landmarks (group 9)", ""),
    42: ("NOUT", "number of group 11 cards", ""),
    43: ("NGO", "return group", "  (not a return group)"),
}


@pytest.mark.parametrize("card", FIRSTS)
def test_a_list_whose_first_number_is_blank(card: int) -> None:
    """Only the numbers behind it may be blank because the list has ended."""
    name, meaning, more = FIRSTS[card]
    line = explained_of_field(card, (1, "     "))[0]
    assert line.split()[:4] == ["columns", "1-5", name, "0"]
    assert line.endswith(f"{meaning}  (blank: zero){more}")


def test_an_error_names_the_deck() -> None:
    """All cards before it are explained."""
    deck = io.BytesIO(("\n".join(CARDS_OF_FIELD[:30]) + "\n").encode())
    found = []
    with pytest.raises(InputError) as caught:
        for text in explain_deck(deck, "flight 7.dat", lambda *_: True):
            found.append(text.splitlines()[0].partition(",")[0])
    assert (caught.value.finding.source, caught.value.finding.card) == ("flight 7.dat", 31)
    assert found == [f"card {k + 1}" for k in range(30)]


# Several jobs in a deck, and lists that fill their cards


(JOB,) = vopd.read_deck(CASE_1)


def stack(frames: int, landmarks: int, group: int, jobs: int = 2) -> list[str]:
    """A job of so many frames and landmarks, and again from a return group on, as cards."""
    r, marks = JOB.readings, JOB.landmarks
    more = landmarks - len(marks.number)
    columns = ("longitude_deg", "longitude_min", "latitude_deg", "latitude_min", "altitude_ft")
    films = (r.fiducial_in, r.landmark, r.present, r.landmark_in)
    job: Job = replace(
        JOB,
        readings=Readings.of(np.arange(frames) + 1, *(np.repeat(a, frames, axis=0) for a in films)),
        landmarks=replace(
            marks,
            number=np.append(marks.number, np.arange(1, more + 1)),
            **{name: np.append(getattr(marks, name), np.zeros(more)) for name in columns},
        ),
        ignored=replace(JOB.ignored, everywhere=np.zeros(landmarks, np.int64)),
    )
    again = replace(job, return_group=group)
    return vopd.write_deck([*[again] * (jobs - 1), job]).splitlines()


def explained_of_stack(cards: list[str], *groups: int) -> list[list[str]]:
    """The lines about each card of some groups."""
    deck = io.BytesIO("\n".join(cards).encode())
    return [one.splitlines() for one in explain_deck(deck, "deck", lambda of, _: of in groups)]


def names(lines: list[str]) -> list[str]:
    return [line.split()[2] for line in lines[2:]]


@pytest.mark.parametrize("frames", [12, 13, 14, 29])
def test_the_counts_of_a_later_job_begin_anew(frames: int) -> None:
    """Three counts and one of each frame, sixteen a card; both jobs have as many."""
    expected = ["NT", "NFR", "NTFR", *(f"NPT({k + 1})" for k in range(frames))]
    cards = explained_of_stack(stack(frames, 3, 5), 5)
    found = [name for card in cards for name in names(card)]
    assert found == 2 * expected
    assert [len(names(card)) for card in cards[: len(cards) // 2]] == [
        len(expected[k : k + 16]) for k in range(0, len(expected), 16)
    ]
    meanings = [line[52:] for card in cards for line in card[2:]]
    assert meanings[3 : 3 + frames] == [
        f"landmarks in frame {k + 1} of the film" for k in range(frames)
    ]


@pytest.mark.parametrize("group", [9, 12])
@pytest.mark.parametrize("landmarks", [14, 15, 16, 31])
def test_the_list_of_group_12_begins_anew(landmarks: int, group: int) -> None:
    """Where reading goes on at group 12, one list follows the other."""
    expected = ["NGO", *(f"IOUT({k + 1})" for k in range(landmarks))]
    cards = explained_of_stack(stack(1, landmarks, group, 3), 12)
    assert [name for card in cards for name in names(card)] == 3 * expected
    assert f"(reading goes on at group {group}; the basic data stay)" in cards[0][2]
    assert [line[52:] for line in cards[-1][2:] if "IOUT" in line] == ["landmark to ignore"] * len(
        [name for name in names(cards[-1]) if name != "NGO"]
    )


def test_cards_of_the_film_of_a_later_job() -> None:
    """Two frames of 21 cards, read again: the frames are counted from 1 again."""
    heads = [card[0].partition("film, ")[2] for card in explained_of_stack(stack(2, 3, 2), 0)]
    points = [f"fiducial {k}" for k in range(1, 5)] + [f"landmark {k} of 3" for k in (1, 2, 3)]
    once = [
        f"frame {frame} of the film, {point}, reading {reading}"
        for frame in (1, 2)
        for point in points
        for reading in (1, 2, 3)
    ]
    assert heads == 2 * once


def test_the_number_of_each_card_and_its_text() -> None:
    cards = stack(1, 3, 9)
    found = explained_of_stack(cards, *range(13))
    assert [card[0].split(",")[0] for card in found] == [
        f"card {k}" for k in range(1, len(cards) + 1)
    ]
    assert [card[1] for card in found] == [f"  |{text}" for text in cards]


def test_what_could_be_read_is_explained_before_the_error() -> None:
    """Card 30 is not a number, and is explained; card 40 is missing, which ends the deck."""
    cards = stack(1, 3, 9)[:39]
    cards[29] = "        xx" + cards[29][10:]
    deck = io.BytesIO("\n".join(cards).encode())
    texts = explain_deck(deck, "deck", lambda _, card: card in (30, 38))
    first, second = next(texts).splitlines(), next(texts).splitlines()
    assert second[0] == "card 38, group 8: focal length, origin, first estimate"
    with refused(InputError):
        next(texts)
    assert first[0] == "card 30, group 4: wind"
    assert first[2] == (
        "   columns 1-10   ALT                 ? ft          altitude above sea level"
        "  (not a number: 'xx')"
    )


@pytest.mark.parametrize("frames", [13, 14, 16, 30])
def test_cards_of_the_film_whose_counts_take_several_cards(frames: int) -> None:
    """Twelve cards of fiducials and nine of landmarks a frame, the film at the end of the deck."""
    cards = stack(frames, 3, 13, jobs=1)
    heads = [one[0] for one in explained_of_stack(cards, 0)]
    assert len(heads) == 21 * frames
    first = len(cards) - len(heads) + 1
    for frame in range(frames):
        for row, point in (
            (0, "fiducial 1, reading 1"),
            (11, "fiducial 4, reading 3"),
            (12, "landmark 1 of 3, reading 1"),
            (20, "landmark 3 of 3, reading 3"),
        ):
            number = 21 * frame + row
            assert heads[number] == (
                f"card {first + number}, basic data: readings of the film, "
                f"frame {frame + 1} of the film, {point}"
            )
