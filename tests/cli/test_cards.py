"""`vopd cards`: each field of a card in words, worked by hand from Appendix F."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from vopd.cli import cli
from vopd.findings import VopdError

DECKS = Path(__file__).parents[2] / "decks"
CASE_1 = DECKS / "appendix_h" / "case1.dat"


def cards(*arguments: str, deck: Path = CASE_1, text: str | None = None) -> Result:
    name = "-" if text is not None else str(deck)
    return CliRunner().invoke(cli, ["cards", name, *arguments], input=text)


def test_a_card_of_group_9() -> None:
    assert cards("--card", "39").stdout.splitlines() == [
        "card 39, group 9: landmarks",
        "  |        65     -106.    -36.65       32.      50.3    10000.",
        "   columns 1-10   ITGT               65             landmark number",
        "   columns 11-20  THJ              -106 deg         landmark longitude degrees, + east",
        "   columns 21-30  THJMI          -36.65 min         landmark longitude minutes",
        "   columns 31-40  PHIJ               32 deg         landmark latitude degrees",
        "   columns 41-50  PHIJMI           50.3 min         landmark latitude minutes",
        "   columns 51-60  RJ              10000 ft          landmark altitude",
        "",
    ]


def test_every_card_has_its_group_and_fits_a_terminal() -> None:
    """25 lens cards, the title, 17 more: 43, and 21 of basic data, which is all of it."""
    text = cards().stdout
    heads = [line for line in text.splitlines() if line.startswith("card ")]
    assert [int(head.split()[1].strip(",")) for head in heads] == list(range(1, 65))
    assert heads[24].startswith("card 25, group 1:") and heads[25] == "card 26, group 2: title"
    assert max(map(len, text.splitlines())) <= 120


def test_basic_data_names_point_and_reading() -> None:
    """Card 62 is the 19th of its frame: four fiducials and two landmarks are 18 cards."""
    text = cards("--card", "62").stdout
    assert "frame 1 of the film, landmark 3 of 3, reading 1" in text
    assert "XSAVE          12.869 in          x on the reader  (point implied, 3 dec" in text


def test_lists_groups_and_return_groups() -> None:
    stack = DECKS / "appendix_h" / "cases_1_2_3.dat"
    text = cards("--group", "12", deck=stack).stdout
    assert text.count("group 12:") == 3
    assert text.count("(reading goes on at group 9; the basic data stay)") == 2
    assert text.count("(stop)") == 1
    assert "IOUT(1)            65             landmark to ignore" in text
    flight = cards("--group", "5", deck=DECKS / "regression" / "flight.dat").stdout
    assert "NPT(14)             3             landmarks in frame 14 of the film" in flight


def test_long_basic_data_is_held_back() -> None:
    """Thirty frames of three landmarks: 630 cards, 21 shown."""
    flight = DECKS / "regression" / "flight.dat"
    assert cards(deck=flight).stdout.endswith("or all by --group basic\n")
    assert "\n609 more cards of basic data" in cards(deck=flight).stdout
    everything = cards("--group", "basic", deck=flight).stdout
    assert everything.count("basic data: readings") == 630
    assert "more cards" not in everything


def test_faults_are_shown_where_they_are() -> None:
    lines = CASE_1.read_text().splitlines()
    lines[38] = lines[38].replace("50.3", "5O.3") + "  x"
    lines[31] = "   0"
    text = cards("--group", "9", "--group", "6", text="\n".join(lines)).stdout
    assert "?" in text and "(not a number: '5O.3')" in text
    assert "columns 63-63 hold something that is not read" in text
    assert "(blanks read as zeros)" in text


def test_a_deck_that_ends_is_explained_so_far() -> None:
    """Two of three cards of group 9, then the error."""
    lines = CASE_1.read_text().splitlines()[:40]
    result = cards("--group", "9", text="\n".join(lines))
    assert result.stdout.count("group 9: landmarks") == 2
    assert isinstance(result.exception, VopdError)
    assert "group 9: the deck ends here" in str(result.exception)


@pytest.mark.parametrize("arguments", [("--group", "13"), ("--group", "x"), ("--card", "0"),
                                       ("--card", "5-"), ("--card", "a")])  # fmt: skip
def test_wrong_usage(arguments: tuple[str, str]) -> None:
    result = cards(*arguments)
    assert result.exit_code == 2 and arguments[1] in result.stderr
