"""Whole decks: lines to cards, cards to jobs, jobs to cards; several decks; blocks of cards."""

from __future__ import annotations

import io
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import vopd
from tests.approved.texts import refused
from tests.kit.cards import landmarks_again, two_frames
from tests.kit.command import CASE_1
from tests.kit.jobs import APPENDIX_H, reread
from vopd.cards import deck as card_deck
from vopd.cards import read as basic_data
from vopd.cards.deck import CardBlock, CardDeck, byte_matrix
from vopd.cards.explain import explain_deck
from vopd.cards.head import read_head
from vopd.cards.read import open_deck, read_jobs
from vopd.cards.sequence import strip_sequence
from vopd.cards.text import CardText
from vopd.findings import BASIC_DATA, Finding, InputError, VopdError
from vopd.job import Job, Readings
from vopd.pipeline import ReadJob, read_deck, read_decks
from vopd.results import SourceEnd

DECKS = sorted((Path(__file__).parents[2] / "decks").glob("*/*.dat"))
DECKS = [deck for deck in DECKS if deck.parent.name != "stars"]
(JOB,) = vopd.read_deck(CASE_1)


def jobs(text: str | bytes) -> list[Job]:
    data = text.encode() if isinstance(text, str) else text
    return list(read_jobs(io.BytesIO(data), "deck"))


@pytest.mark.parametrize("deck", DECKS, ids=lambda path: path.stem)
def test_read_write_read(deck: Path) -> None:
    first = list(vopd.read_deck(deck))
    written = vopd.write_deck(first)
    second = jobs(written)
    assert second == first
    assert vopd.write_deck(second) == written


SHAPES = {
    "CR LF": lambda text: text.replace("\n", "\r\n"),
    "full cards": lambda text: "\n".join(line.ljust(80) for line in text.splitlines()) + "\n",
    "one full card": lambda text: text.replace("CAMERA\n", "CAMERA".ljust(37) + "\n", 1),
    "trailing blanks": lambda text: text.replace("\n", " " * 90 + "\n"),
    "trailing blank lines": lambda text: text + "\n  \n\r\n",
    "no last end": lambda text: text.rstrip("\n"),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_harmless_shapes(shape: str) -> None:
    assert jobs(SHAPES[shape](CASE_1.read_text())) == [JOB]


def test_a_blank_card_is_a_card() -> None:
    """Group 10 left blank: NOUT is zero."""
    cards = CASE_1.read_text().splitlines()
    cards[41] = ""
    assert jobs("\n".join(cards)) == [JOB]


@pytest.mark.parametrize("card", [1, 2, 30, 36, 40])
def test_cards_of_any_length_begin_in_column_1(card: int) -> None:
    """Blanks at the end may be there or not, card by card of one group."""
    cards = CASE_1.read_text().splitlines()
    cards[card - 1] = cards[card - 1].ljust(80)
    assert jobs("\n".join(cards)) == [JOB]
    rows = byte_matrix([b"ab", b"", b"a", b"abcd"])
    assert [bytes(row) for row in rows] == [b"ab  ", b"    ", b"a   ", b"abcd"]


@pytest.mark.parametrize("at_a_time", [1, 40, 43, 100])
def test_a_film_read_in_portions_is_the_film_read_at_once(
    at_a_time: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where an undefined landmark is first read too: 99 in frames 3, 5 and 6, 98 in 4."""
    readings = JOB.readings
    film = replace(
        JOB,
        readings=Readings.of(
            np.arange(7) + 1,
            *(np.repeat(a, 7, axis=0) for a in (
                readings.fiducial_in, readings.landmark, readings.present, readings.landmark_in
            )),
        ),
    )  # fmt: skip
    film.readings.points.landmark[[8, 12, 16]] = 99
    film.readings.points.landmark[9] = 98
    deck = vopd.write_deck([film]).encode()
    (once,) = read_jobs(io.BytesIO(deck), "deck")
    monkeypatch.setattr(basic_data, "CARDS_AT_A_TIME", at_a_time)
    (portions,) = read_jobs(io.BytesIO(deck), "deck")
    assert portions == once == film
    first = {number: found.card for number, found in portions.readings.first_card.items()}
    assert first == {99: 43 + 2 * 21 + 12 + 6 + 1, 98: 43 + 3 * 21 + 12 + 1}
    assert portions.readings.first_card == once.readings.first_card


def test_group_5_and_12_go_on_over_cards() -> None:
    """3 counts and 15 frames are 18 numbers, two cards; NGO and 16 landmarks are 17, two cards."""
    readings = JOB.readings
    many = replace(
        JOB,
        readings=Readings.of(
            np.arange(15) + 100,
            *(np.repeat(a, 15, axis=0) for a in (
                readings.fiducial_in, readings.landmark, readings.present, readings.landmark_in
            )),
        ),
        landmarks=replace(
            JOB.landmarks,
            number=np.append(JOB.landmarks.number, np.arange(1, 14)),
            **{
                name: np.append(getattr(JOB.landmarks, name), np.zeros(13))
                for name in ("longitude_deg", "longitude_min", "latitude_deg", "latitude_min",
                             "altitude_ft")
            },
        ),
        ignored=replace(JOB.ignored, everywhere=np.array([0] * 15 + [66])),
    )  # fmt: skip
    cards = vopd.write_deck([many]).splitlines()
    assert cards[30] == "   16   15    2" + "    3" * 13
    assert cards[31] == "    3" * 2
    assert cards[56] == "   13" + "    0" * 15
    assert cards[57] == "   66"
    assert jobs("\n".join(cards)) == [many]


readings_in = st.integers(-99999, 99999).map(lambda n: n / 1000.0)


@st.composite
def films(draw: st.DrawFn) -> Job:
    """Case 1 with other frames: any number of landmarks in each, any readings."""
    frames = draw(st.integers(1, 5))
    counts = np.array(draw(st.lists(st.integers(1, 4), min_size=frames, max_size=frames)))
    width = int(counts.max())
    present = np.arange(width) < counts[:, None]
    landmark = draw(arrays(np.int64, (frames, width), elements=st.integers(0, 99)))
    points = draw(arrays(float, (frames, width, 3, 2), elements=readings_in))
    return replace(
        JOB,
        readings=Readings.of(
            frame=draw(arrays(np.int64, frames, elements=st.integers(0, 9999), unique=True)),
            fiducial_in=draw(arrays(float, (frames, 4, 3, 2), elements=readings_in)),
            landmark=np.where(present, landmark, 0),
            present=present,
            landmark_in=np.where(present[..., None, None], points, 0.0),
        ),
    )


@settings(max_examples=25)
@given(films())
def test_any_film_comes_back(job: Job) -> None:
    written = vopd.write_deck([job])
    (back,) = jobs(written)
    assert back == job
    assert vopd.write_deck([back]) == written


@pytest.mark.parametrize("group", range(1, 13))
def test_a_next_job_begins_with_its_return_group(group: int) -> None:
    """Behind the first job are the cards from there on; readings again with NGO 1 and 2 alone."""
    one = vopd.write_deck([JOB])
    own = Counter(of for of in groups_of(one))
    expected = own + Counter({k: own[k] for k in own if k >= group or (k == 0 and group <= 2)})
    both = vopd.write_deck([replace(JOB, return_group=group), JOB])
    assert Counter(of for of in groups_of(both)) == expected
    assert jobs(both) == [replace(JOB, return_group=group), JOB]


def groups_of(deck: str) -> list[int]:
    """The group of each card of a deck, 0 for basic data."""
    found: list[int] = []
    list(explain_deck(io.BytesIO(deck.encode()), "deck", lambda of, _: bool(found.append(of))))
    return found


def test_a_stack_that_cannot_be_written() -> None:
    """Return group 9 does not read the wind again."""
    first = replace(JOB, return_group=9)
    calm = replace(JOB, wind=replace(JOB.wind, velocity_ft_s=np.zeros((3, 2))))
    with refused(VopdError):
        vopd.write_deck([first, calm])
    again = replace(JOB, return_group=4)
    assert jobs(vopd.write_deck([again, calm])) == [again, calm]
    with refused(VopdError):  # nothing is read behind it, not even a job that is the same
        vopd.write_deck([replace(JOB, return_group=13), JOB])


def test_a_job_by_itself_has_the_landmarks_of_those_before_it() -> None:
    """Its own group 9 gives one of three: 0 in the two more fields of group 12 names none."""
    one = replace(JOB, ignored=replace(JOB.ignored, everywhere=np.array([0])), return_group=13)
    _, later = jobs(vopd.write_deck([replace(JOB, return_group=5), one]))
    assert later == one
    (back,) = jobs(vopd.write_deck(later))
    assert back.ignored.everywhere.tolist() == [0] * len(JOB.landmarks.number)
    assert replace(back, ignored=later.ignored) == later


@pytest.mark.parametrize(("group", "written"), [(1, False), (2, True), (9, False), (13, True)])
def test_the_last_job_ends_the_deck(group: int, written: bool) -> None:
    """One of a stack read on where nothing is; return group 2 may end so (A 28)."""
    last = replace(JOB, return_group=group)
    if written:
        assert jobs(vopd.write_deck(last)) == [last]
        return
    with refused(VopdError):
        vopd.write_deck(last)


def test_a_short_title_is_filled_up() -> None:
    titled = replace(JOB, title="1 SHORT")
    assert jobs(vopd.write_deck(titled))[0].title == "1 SHORT".ljust(80)
    assert vopd.run(titled)[0].job.title == "1 SHORT".ljust(80)


def test_values_that_do_not_fit() -> None:
    long = replace(JOB, clock=replace(JOB.clock, time_s=np.array([1 / 3, 2.0])))
    with pytest.raises(VopdError) as error:
        vopd.write_deck([long])
    assert str(error.value) == (
        "group 6, flight time: 0.3333333333333333 does not fit in 10 columns; "
        "rounded to 9 decimals, 0.333333333, it does"
    )
    vopd.write_deck([replace(JOB, clock=replace(JOB.clock, time_s=np.array([0.333333333, 2.0])))])
    far = replace(JOB, readings=reread(JOB.readings, frame=np.array([12345])))
    with refused(VopdError):
        vopd.write_deck([far])


def test_a_bad_field_among_very_many_cards_is_named() -> None:
    """Card 43 + 24 * 2100 + 7 is the seventh of frame 2101: a letter in its x."""
    readings = JOB.readings
    count = 3000
    film = replace(
        JOB,
        readings=Readings.of(
            np.arange(count) + 1,
            *(np.repeat(a, count, axis=0) for a in (
                readings.fiducial_in, readings.landmark, readings.present, readings.landmark_in
            )),
        ),
    )  # fmt: skip
    cards = vopd.write_deck([film]).splitlines()
    control = len(cards) - 21 * count
    at = control + 21 * 2100 + 7
    cards[at - 1] = cards[at - 1].replace("014476", "0144T6")
    cards[at + 500] = cards[at + 500][:5]  # a later error is not the one that is reported
    with pytest.raises(vopd.InputError) as caught:
        jobs("\n".join(cards))
    finding: Finding = caught.value.finding
    assert (finding.card, finding.columns, finding.group) == (at, (41, 47), BASIC_DATA)
    assert "0144T6" in finding.message


def test_landmarks_that_stay_from_the_job_before_are_not_written_again() -> None:
    """The second job gives two of three landmarks: its group 5 counts two, and so does group 12."""
    cards = landmarks_again(two_frames())
    read = jobs("\n".join(cards))
    assert vopd.write_deck(read).splitlines() == cards
    assert [len(one.landmarks.number) for one in read] == [3, 3]
    assert [len(one.ignored.everywhere) for one in read] == [3, 2]


# Several decks


ROOT = Path(__file__).parents[2]
REGRESSION = sorted((ROOT / "decks" / "regression").glob("*.dat"))
HOSTILE = sorted((ROOT / "tests" / "robustness" / "inputs").glob("*.dat"))
CASES = [APPENDIX_H / f"case{number}.dat" for number in range(1, 5)]


def said(item: ReadJob | SourceEnd) -> list[str]:
    """The messages of a job or of the end of a deck."""
    error = [str(item.error)] if isinstance(item, SourceEnd) else []
    return [item.source, *map(str, item.findings), *error]


@pytest.mark.parametrize("limits_1974", [False, True])
def test_together_as_alone(limits_1974: bool, tmp_path: Path) -> None:
    """Decks of the report, with several jobs, with errors, without a card, and no decks at all."""
    names = [str(path) for path in (*CASES, *REGRESSION, *HOSTILE, ROOT / "README.md")]
    names += [str(tmp_path), str(tmp_path / "none.dat")]
    assert len(REGRESSION) > 5 and len(HOSTILE) > 10
    together = list(read_decks(names, limits_1974))
    alone = [item for name in names for item in read_decks([name], limits_1974)]
    assert [said(item) for item in together] == [said(item) for item in alone]
    for ours, theirs in zip(together, alone, strict=True):
        assert isinstance(ours, ReadJob) == isinstance(theirs, ReadJob)
        if isinstance(ours, ReadJob) and isinstance(theirs, ReadJob):
            assert (ours.number, ours.job) == (theirs.number, theirs.job)
            assert ours.job.readings.first_card == theirs.job.readings.first_card
    ends = [item for item in together if isinstance(item, SourceEnd)]
    assert [end.source for end in ends] == names
    assert 5 < sum(end.error is None for end in ends) < len(ends) - 10


def test_an_error_is_that_of_its_own_deck(tmp_path: Path) -> None:
    """Case 1 has 43 cards before the basic data, so that the 50th is the seventh of them."""
    lines = CASES[0].read_text().splitlines()
    short, odd, good = (tmp_path / f"{name}.dat" for name in ("short", "odd", "good"))
    short.write_text("\n".join(lines[:49]) + "\n")
    odd.write_text("\n".join([lines[0], "     X.000" + lines[1][10:], *lines[2:]]) + "\n")
    good.write_text("\n".join(lines) + "\n")
    decks = [str(path) for path in (good, short, odd, good)]
    read = list(read_decks(decks))
    assert [type(item).__name__ for item in read] == [
        "ReadJob", "SourceEnd", "SourceEnd", "SourceEnd", "ReadJob", "SourceEnd",
    ]  # fmt: skip
    errors = [str(item.error).splitlines()[0] for item in read if isinstance(item, SourceEnd)]
    assert errors[0] == errors[3] == "None"
    assert errors[1].startswith(f"{short}: card 50, basic data: the deck ends here")
    assert errors[2].startswith(
        f"{odd}: card 2, group 1, radial distance (columns 1-10): not a number"
    )


def test_warnings_stay_with_their_deck_and_job(tmp_path: Path) -> None:
    """A blank among the digits of card 3 of the second deck."""
    lines = CASES[0].read_text().splitlines()
    lines[2] = "     1 .5 " + lines[2][10:]
    doubtful = tmp_path / "doubtful.dat"
    doubtful.write_text("\n".join(lines) + "\n")
    names = [str(path) for path in (CASES[1], doubtful, CASES[0])]
    jobs = [item for item in read_decks(names) if isinstance(item, ReadJob)]
    assert [len(job.findings) for job in jobs] == [1, 2, 1]  # a reading of .020 in in each
    finding, _ = jobs[1].findings
    assert (finding.source, finding.card, finding.group) == (str(doubtful), 3, 1)


@pytest.mark.parametrize("limits_1974", [False, True])
def test_findings_have_the_name_of_the_deck_and_not_its_path(
    limits_1974: bool, tmp_path: Path
) -> None:
    """A warning, an error, and a limit where it is asked for; and a file that is not there."""
    lines = CASES[0].read_text().splitlines()
    doubtful = [*lines[:2], "     1 .5 " + lines[2][10:], *lines[3:]]
    wrong = [*lines[:38], "        xx" + lines[38][10:], *lines[39:]]
    large = [*lines[:40], f"{91:10d}" + lines[40][10:], *lines[41:]]
    decks = []
    for name, cards in (("doubtful", doubtful), ("wrong", wrong), ("large", large)):
        (tmp_path / f"{name}.dat").write_text("\n".join(cards))
        decks.append(str(tmp_path / f"{name}.dat"))
    where = dict(zip(("doubtful", "wrong", "large"), decks, strict=True))
    read = list(read_decks(where, limits_1974, where))
    jobs = [item for item in read if isinstance(item, ReadJob)]
    one, other, third = (item for item in read if isinstance(item, SourceEnd))
    found = [(found.source, found.card) for found in jobs[0].findings]
    assert found == [("doubtful", 3), ("doubtful", 59)]  # and a reading of .020 in
    assert one.error is None and one.findings == ()
    assert isinstance(other.error, InputError) and [job.source for job in jobs][1:2] != ["wrong"]
    assert (other.error.finding.source, other.error.finding.card) == ("wrong", 39)
    if limits_1974:
        assert isinstance(third.error, InputError) and third.error.finding.source == "large"
    else:
        assert third.error is None and [job.source for job in jobs] == ["doubtful", "large"]
    missing, good, _ = read_decks(
        ["x", "doubtful"], locations={"x": str(tmp_path / "none"), **where}
    )
    assert isinstance(missing, SourceEnd) and "No such file" in str(missing.error)
    assert isinstance(good, ReadJob)


# The blocks in which a deck is read


def cards_of(content: bytes, sizes: list[int]) -> list[list[str]]:
    """The texts of cards that are taken so many at a time."""
    deck = CardDeck(io.BytesIO(content), "deck", lambda _: None)
    taken = [deck.take(size, 1) for size in sizes]
    return [[block.image(k).rstrip() for k in range(len(block))] for block in taken]


@pytest.mark.parametrize("block_bytes", [1, 7, 64, 1 << 20])
@pytest.mark.parametrize("end", [b"\n", b"\r\n"])
def test_a_deck_in_blocks_of_any_size(
    block_bytes: int, end: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Lines of one length and of others, with a last one that has no end."""
    monkeypatch.setattr(card_deck, "BLOCK_BYTES", block_bytes)
    monkeypatch.setattr(card_deck, "MOST_BYTES", max(block_bytes, 2))
    texts = ["a1", "b2", "c3", "long one", "d", "", "e5", "f" * 80, "g7"]
    content = end.join(text.encode() for text in texts)
    assert cards_of(content, [2, 3, 4]) == [texts[:2], texts[2:5], texts[5:]]
    assert cards_of(content, [9]) == [texts]
    assert cards_of(content, [10]) == [texts]


@pytest.mark.parametrize("sizes", [[4], [5], [1, 3], [1, 4], [3, 1, 1], [2, 9]])
def test_lines_of_one_length_up_to_the_end(sizes: list[int]) -> None:
    """More cards may be asked for than are left."""
    texts = ["a1", "b2", "c3", "d4"]
    taken = cards_of("".join(f"{text}\n" for text in texts).encode(), sizes)
    assert [card for block in taken for card in block] == texts
    assert [len(block) for block in taken[:-1]] == sizes[:-1]


def test_short_lines_behind_a_long_one_up_to_the_end() -> None:
    """More bytes are asked for than are left, and then more cards than are left."""
    texts = ["x" * 40, "a", "b", "c1", "d1", "e1"]
    content = "".join(f"{text}\n" for text in texts).encode()
    assert cards_of(content, [3, 4]) == [texts[:3], texts[3:]]
    assert cards_of(content, [3, 2, 2]) == [texts[:3], texts[3:5], texts[5:]]


BEHIND = [b"", b"\n", b" \n\r\n   ", b"\n" * 300, b"\x1a\r\n", b"\x1a" * 128]


@pytest.mark.parametrize("behind", BEHIND)
@pytest.mark.parametrize("block_bytes", [1, 64])
def test_blank_cards_behind_the_last_are_the_end(
    behind: bytes, block_bytes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(card_deck, "BLOCK_BYTES", block_bytes)
    for more, ended in ((b"", True), (b"x", False)):
        deck = CardDeck(io.BytesIO(b"card\n" + behind + more), "deck", lambda _: None)
        assert not deck.at_end()
        deck.take(1, 1)
        assert deck.at_end() == ended


def test_blocks_are_numbered_and_told() -> None:
    """The first card of each, what ended the last, and each to whoever listens."""
    told: list[CardBlock] = []
    deck = CardDeck(io.BytesIO(b"a\nb\nc\n"), "deck", lambda _: None, told.append)
    assert len(deck.next_card(3)) == 1 and deck.next_card(3).first == 1
    blocks = [deck.take(2, 3), deck.take(2, 4)]
    assert told == blocks and deck.taken == 3
    assert [(one.first, len(one), one.where.group) for one in blocks] == [(1, 2, 3), (3, 1, 4)]
    assert blocks[0].stopped_by is None
    message = "the deck ends here: 2 cards expected, 1 found"
    assert blocks[1].stopped_by == Finding(message, "deck", card=4, group=4)
    assert len(deck.next_card(5)) == 0 and deck.next_card(5).first == 4


def test_reading_goes_on_after_a_line_that_is_no_card_if_nobody_raises() -> None:
    told: list[Finding] = []
    deck = CardDeck(io.BytesIO(b"a\n\tb\nc\n"), "deck", told.append)
    block = deck.take(3, 1)
    assert (len(block), block.stopped_by, block.image(2).rstrip()) == (3, None, "c")
    assert [one.card for one in told] == [2]


@pytest.mark.parametrize("block_bytes", [4, 1 << 20])
def test_the_bytes_that_come_next(block_bytes: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """They stay in the deck, and there are some wherever a card is left."""
    monkeypatch.setattr(card_deck, "BLOCK_BYTES", block_bytes)
    content = b"one\ntwo\nsix\n"
    deck = CardDeck(io.BytesIO(content), "deck", lambda _: None)
    for number, text in enumerate(("one", "two", "six")):
        rest = deck.next_bytes()
        assert rest and content[4 * number :].startswith(rest)
        assert deck.next_card(1).image(0).rstrip() == text
        taken = deck.take(1, 1)
        assert (taken.first, taken.image(0).rstrip()) == (number + 1, text)
    assert deck.next_bytes() == b""


def test_files_that_are_no_decks(tmp_path: Path) -> None:
    """Not there, a folder, empty, blank: each is named; a deck has its name and its warnings."""
    (tmp_path / "empty.dat").write_text("")
    (tmp_path / "blank.dat").write_text("\n   \r\n")
    for name, why in (
        ("none.dat", "No such file or directory"),
        (
            ".",
            "is a folder, without a project flight.toml; vopd new writes one, and vopd batch "
            "takes all decks and projects of a folder",
        ),
        ("empty.dat", "the deck is empty"),
        ("blank.dat", "the deck is empty"),
    ):
        with pytest.raises(VopdError) as caught:
            read_deck(tmp_path / name)
        assert str(caught.value) == f"{tmp_path / name}: {why}"
    cards = CASE_1.read_text().splitlines()
    cards[31] = "   0 " + "    48.073"
    doubtful = tmp_path / "doubtful.dat"
    doubtful.write_text("\n".join(cards))
    deck = read_deck(str(doubtful))
    assert deck.name == str(doubtful) and len(deck) == 1
    assert [(one.source, one.card) for one in deck.findings] == [
        (str(doubtful), 32),
        (str(doubtful), 59),  # a reading of .020 in
    ]
    with open_deck(doubtful) as file:
        pass
    assert file.closed


def test_the_arrays_of_1974_are_asked_for(tmp_path: Path) -> None:
    """Landmark 91 of case 1 exceeds TTHJ(90), by both ways to read a deck."""
    cards = CASE_1.read_text().splitlines()
    cards[40] = f"{91:10d}" + cards[40][10:]
    file = tmp_path / "large.dat"
    file.write_text("\n".join(cards))
    assert len(read_deck(file)) == 1
    for limited in (
        lambda: read_deck(file, limits_1974=True),
        lambda: list(read_jobs(io.BytesIO(file.read_bytes()), "a", limits_1974=True)),
    ):
        with refused(InputError):
            limited()


@pytest.mark.parametrize("card", [1, 26, 27, 31, 42, 43, 44])
def test_a_first_card_of_a_group_that_is_no_card(card: int) -> None:
    """Nothing of its block could be read, and that is what is said."""
    cards = CASE_1.read_text().splitlines()
    cards[card - 1] = "\t" + cards[card - 1]
    with pytest.raises(InputError) as caught:
        list(read_jobs(io.BytesIO("\n".join(cards).encode()), "a"))
    found = caught.value.finding
    assert (found.card, found.columns) == (card, (1, 1)) and found.message.startswith("a tab")


TEXT = Path(CASE_1).read_text("ascii")
RECORDS = "".join(card.ljust(80) for card in TEXT.splitlines())


class Pieces(io.BytesIO):
    """A file that gives some bytes first, and then five at a time."""

    def read(self, _: int | None = -1, /) -> bytes:
        return super().read(5 if self.tell() else 400)


def described(width: int = 0, text: str = TEXT) -> bytes:
    """Write each card as a record of variable length: two bytes of length, two zeros, EBCDIC."""
    cards = [card.ljust(width).encode("cp037") for card in text.splitlines()]
    return b"".join(bytes([0, 4 + len(card), 0, 0]) + card for card in cards)


@pytest.mark.parametrize(
    "content",
    {
        "a byte-order mark": TEXT.encode("utf-8-sig"),
        "CR alone": TEXT.replace("\n", "\r").encode(),
        "records of 80 bytes": RECORDS.encode(),
        "the last record shorter": RECORDS.rstrip().encode(),
        "EBCDIC lines": TEXT.encode("cp037"),
        "EBCDIC with NEL": TEXT.encode("cp037").replace(b"\x25", b"\x15"),
        "EBCDIC with LF": TEXT.encode("cp037").replace(b"\x25", b"\x0a"),
        "EBCDIC records": RECORDS.encode("cp500"),
        "EBCDIC records with descriptors": described(80),
        "EBCDIC records of their own lengths": described(),
    }.items(),
    ids=lambda one: one[0],
)
def test_a_deck_in_another_code_or_in_records(content: tuple[str, bytes]) -> None:
    (job,) = read_jobs(io.BytesIO(content[1]), "a")
    (usual,) = read_jobs(io.BytesIO(TEXT.encode()), "a")
    assert job == usual
    by_parts = CardText(io.BytesIO(content[1]))
    pieces = iter(lambda: by_parts.read(5003), b"")  # no multiple of a record
    whole = CardText(io.BytesIO(content[1])).all("a")
    assert b"".join(pieces) == whole
    few = CardText(Pieces(content[1]))  # bytes that complete no record are not the end
    assert b"".join(iter(lambda: few.read(1), b"")) == whole


def test_a_blank_card_may_be_a_record_without_columns() -> None:
    text = "".join(f"{card}\n" for card in ("", *TEXT.splitlines()[:9], "", "", "end"))
    assert CardText(io.BytesIO(described(text=text))).all("deck").decode() == text


def test_a_record_without_its_descriptor_is_a_bad_card() -> None:
    """Everything after it is passed on as it is: no card is lost without a word."""
    cut = described(80)
    whole = CardText(io.BytesIO(cut[: 84 * 9])).all("deck")
    damaged = CardText(io.BytesIO(cut[: 84 * 9] + cut[84 * 9 + 1 :])).all("deck")
    assert whole.decode() == "".join(f"{card:80}\n" for card in TEXT.splitlines()[:9])
    assert damaged.startswith(whole) and len(damaged) == 9 * 81 + len(cut) - 84 * 9 - 1


def test_a_last_record_that_is_cut_short_is_passed_on_as_it_is() -> None:
    cut = described(80)[: 84 * 9 + 54]
    passed_on = CardText(io.BytesIO(cut)).all("deck")
    assert passed_on.startswith(CardText(io.BytesIO(cut[: 84 * 9])).all("deck"))
    assert len(passed_on) == 9 * 81 + 54


FORMS = {
    "letters": "CASE{0:04d}", "short": "  AB{0:04d}", "apart": "AB{0:6d}", "left": " AB {0:04d}",
    "zeros": "{0:08d}", "blanks": "{0:8d}", "five": "   {0:05d}", "small": "vop {0:04d}",
}  # fmt: skip


@pytest.mark.parametrize("form", [*FORMS])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_deck_without_its_sequence_numbers_is_the_deck(end: str, form: str) -> None:
    """Numbers in columns 73 to 80 of all cards but those of group 7, where the altitude stands."""
    cards = TEXT.splitlines()
    numbered = [
        card if card[72:].strip() else f"{card:<72}{FORMS[form].format(10 * k)}"
        for k, card in enumerate(cards, 1)
    ]
    assert sum(a != b for a, b in zip(cards, numbered, strict=True)) == 60
    bare, stripped = strip_sequence(end.join([*numbered, ""]).encode(), "a")
    assert bare.decode() == TEXT.replace("\n", end)
    assert stripped == set(range(1, 65)) - {34, 35, 36, 37}


def test_sequence_numbers_from_nought_on_in_steps_of_one() -> None:
    """Of more cards than the farthest step to the next number; a smaller one at the end is none."""
    cards = [*TEXT.splitlines()[:33], *TEXT.splitlines()[43:64] * 5]
    numbered = [f"{card:<72}{k:08}" for k, card in enumerate(cards)]
    numbered.append(f"{'END':<72}{7:08}")
    cards.append(numbered[-1])
    bare, stripped = strip_sequence("\n".join(numbered).encode(), "a")
    assert (bare.decode().split("\n"), stripped) == (cards, set(range(1, 139)))


def test_a_sequence_number_that_is_there_twice_stays_on_the_second_card() -> None:
    cards = TEXT.splitlines()
    numbered = [f"{card:<72}{10 * k:08}" for k, card in enumerate(cards[:33], 1)]
    numbered[30] = numbered[30][:72] + numbered[29][72:]
    bare, stripped = strip_sequence("\n".join(numbered).encode(), "a")
    assert bare.decode().split("\n")[30] == numbered[30]
    assert stripped == {*range(1, 34)} - {31}


def test_blank_lines_behind_the_head_of_a_deck_are_no_cards() -> None:
    content = CASE_1.read_bytes()
    assert read_head(content + b"\n   \n\n", "deck") == read_head(content, "deck")


def test_the_head_of_a_deck_in_records_has_all_cards_behind_it() -> None:
    """Of a second job, whose film is not read, either; the last record is not filled up."""
    cards = [*landmarks_again(two_frames())[:43], "    2    0    2", *two_frames()[31:43]]
    cards[30] = "    3    0    2"
    head = read_head("\n".join(cards).encode(), "deck")
    assert (head.counts, head.behind) == ([3, 2], cards[43:])
    records = "".join(card.ljust(80) for card in cards).rstrip().encode()
    assert len(records) % 80
    for content in (records, records.decode().encode("cp037"), described(text="\n".join(cards))):
        assert [card.rstrip() for card in read_head(content, "deck").behind] == cards[43:]


def test_the_jobs_behind_a_film_that_is_counted_and_not_read_stay_in_the_deck() -> None:
    """As many cards as the film has were taken from them."""
    cards = landmarks_again(two_frames())
    for text in (cards, cards[:43] + cards[85:]):
        assert read_head("\n".join(text).encode(), "deck").behind == cards[85:]


def test_a_deck_that_cannot_be_read_on_is_named() -> None:
    """A disk may fail behind the first block."""

    class Failing(io.BytesIO):
        def read(self, size: int | None = -1, /) -> bytes:
            if self.tell():
                raise OSError(5, "words of the system")
            return super().read(min(size or 1, 2000) if size != -1 else 2000)

    with refused(VopdError):
        [*read_jobs(Failing(CASE_1.read_bytes()), "deck", lambda _: None)]


def test_a_long_line_of_letters_is_no_record() -> None:
    """Records of a deck begin with numbers: group 1, twice."""
    for text in (
        "a" * 400,
        f"{'        0.        0.':80}{'a' * 320}",
        f"{'a' * 80}{1.0:20}{1.0:300}",
    ):
        with pytest.raises(VopdError, match=r"this line is longer"):
            jobs(text)
