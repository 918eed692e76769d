"""The blocks in which a deck is read, blank cards at its end, and files that are no decks."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from tests.kit.command import CASE_1
from vopd.cards import deck as card_deck
from vopd.cards.deck import CardBlock, CardDeck
from vopd.cards.read import open_deck, read_deck, read_jobs
from vopd.findings import Finding, InputError, VopdError


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


@pytest.mark.parametrize("behind", [b"", b"\n", b" \n\r\n   ", b"\n" * 300])
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
        (".", "Is a directory"),
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
    assert [(one.deck, one.card) for one in deck.findings] == [(str(doubtful), 32)]
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
        with pytest.raises(InputError, match=r"TTHJ\(90\)"):
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
