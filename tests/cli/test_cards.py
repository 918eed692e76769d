"""`vopd cards`: each field of a card in words, worked by hand from Appendix F."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1, DECKS, Ran, vopd
from vopd.cli import plot
from vopd.findings import VopdError
from vopd.stellar.files.table import ReadSolution

FLIGHT = DECKS / "regression" / "flight.dat"


def cards(*arguments: str, deck: Path = CASE_1, text: str | None = None) -> Ran:
    return vopd("cards", "-" if text is not None else deck, *arguments, stdin=text)


def test_a_card_of_group_9() -> None:
    assert_approved(cards("--card", "39").stdout.splitlines())


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
    assert_approved(text)


def test_lists_groups_and_return_groups() -> None:
    stack = DECKS / "appendix_h" / "cases_1_2_3.dat"
    text = cards("--group", "12", deck=stack).stdout
    assert text.count("group 12:") == 3
    assert text.count("(reading goes on at group 9; the basic data stay)") == 2
    assert text.count("(stop)") == 1
    assert_approved(text)
    flight = cards("--group", "5", deck=FLIGHT).stdout
    assert "NPT(14)             3             landmarks in frame 14 of the film" in flight


def test_long_basic_data_is_held_back() -> None:
    """Thirty frames of three landmarks: 630 cards, 21 shown; that is said on standard error."""
    some = cards(deck=FLIGHT)
    assert some.stdout.count("basic data: readings") == 21
    assert some.stderr.startswith("609 more cards of basic data")
    everything = cards("--group", "basic", deck=FLIGHT)
    assert everything.stdout.count("basic data: readings") == 630
    assert "frame 30 of the film, landmark 3 of 3, reading 3" in everything.stdout
    assert everything.stderr == ""


def test_unreadable_fields_are_shown() -> None:
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
    assert result.status == 1
    assert "group 9: the deck ends here" in result.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ("--card", "500"),
        ("--card", "3", "--card", "60-65"),
        ("--group", "11"),
        ("--card", "39", "--group", "8"),
    ],
)
def test_cards_that_are_not_there(arguments: tuple[str, ...]) -> None:
    result = cards(*arguments)
    assert result.status == 1
    assert_approved(result.stderr, parts=[CASE_1])


def test_the_cards_before_the_missing_one_are_explained() -> None:
    text = cards("--card", "63-65").stdout
    assert [line[:8] for line in text.splitlines() if line.startswith("card ")] == [
        "card 63,", "card 64,"
    ]  # fmt: skip


def test_output_to_a_file(tmp_path: Path) -> None:
    saved = tmp_path / "cards.txt"
    result = cards("--card", "39", "-o", str(saved))
    assert (result.status, result.stdout, result.stderr) == (0, "", "")
    assert saved.read_bytes() == cards("--card", "39").output


def test_a_file_is_left_alone_where_there_is_nothing_to_write(tmp_path: Path) -> None:
    saved = tmp_path / "cards.txt"
    saved.write_text("before")
    assert cards("--card", "500", "-o", str(saved)).status == 1
    assert vopd("cards", tmp_path / "none.dat", "-o", saved).status == 1
    assert saved.read_text() == "before"


@pytest.mark.parametrize("option", ["--group 13", "--group x", "--card 0", "--card 5-",
                                    "--card a", "--card 9-3"])  # fmt: skip
def test_wrong_usage(option: str) -> None:
    result = cards(*option.split())
    assert result.status == 2 and f"{option}: " in result.stderr


# Cards that are held back; the picture of a star photograph


def test_the_picture_of_a_photograph(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is drawn, in its unit; its pointing with as many digits as are known, and doubts."""
    given: list[Any] = []
    monkeypatch.setattr(plot, "draw_star_residuals", lambda *one: given.append(one))
    residuals = np.array([[3.0, 4.0], [0.0, 0.0], [0.0, 0.0]])
    one = ReadSolution(
        "late", "church", ("a", "b", "c"), np.ones((3, 2)), residuals, "px",
        (10.123456, -20.5, 359.999996), (1, 2, 3), "", None, (0.0234, 0.012, 1.5),
    )  # fmt: skip
    held = {"a.json": [one]}
    monkeypatch.setattr("vopd.stellar.files.table.read_solutions", held.__getitem__)
    plot.plot_stars(["a.json"], "late", (9.0, 6.0))
    ((picture, size),) = given
    assert size == (9.0, 6.0)
    assert_approved(picture.title)
    assert picture[1:5] == (one.images, residuals, one.labels, "px")
    unknown = (None, None, None)
    held["a.json"] = [one._replace(half_95_deg=unknown, doubtful=("too large", "why", "more"))]
    plot.plot_stars(["a.json"], "late", (9.0, 6.0))
    assert_approved(given[-1][0].title)
    held["a.json"] = [one, one]
    with refused(VopdError):
        plot.plot_stars(["a.json"], "x", None)


def test_cards_are_parted_by_an_empty_line_and_the_rest_is_counted(tmp_path: Path) -> None:
    deck = DECKS / "regression" / "flight.dat"
    out = tmp_path / "cards.txt"
    ran = vopd("cards", deck, "-o", out)
    assert (ran.status, ran.stdout) == (0, "")
    assert_approved(ran.stderr)
    text = out.read_text()
    assert text.count("\n\ncard ") == text.count("\ncard ") and text.endswith("\n\n")
    assert vopd("cards", CASE_1, "-o", out).stderr == ""
    for card in (
        "5-",
        "0",
        "9-8",
    ):
        ran = vopd("cards", CASE_1, "--card", card)
        assert ran.status == 2
        assert_approved(ran.stderr)
    assert vopd("cards", CASE_1, "--card", "9-9").status == 0
    for group in ("0", "13", "x", "٣"):
        ran = vopd("cards", CASE_1, "--group", group)
        assert_approved(ran.stderr, parts=[group])


@pytest.mark.parametrize("basic", [20, 21, 22, 23])
def test_cards_that_are_held_back_are_counted(basic: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """From the 22nd card of basic data on; of a deck, and not over the deck."""

    def explained(_: object, __: str, choice: Any) -> Any:
        return [f"card {k}" for k in range(1, basic + 1) if choice(0, k)]

    monkeypatch.setattr("vopd.cli.cards.explain_deck", explained)
    ran = vopd("cards", CASE_1)
    assert ran.stdout == "".join(f"card {k}\n\n" for k in range(1, min(basic, 21) + 1))
    found = ran.stderr
    assert bool(found) == (basic > 21)
    assert_approved(found, parts=[basic - 21] if basic > 21 else [])
    ran = vopd("cards", CASE_1, "--card", f"{basic}-{basic + 1}")
    assert ran.status == 1
    assert_approved(ran.stderr, parts=[CASE_1, basic + 1, basic])


@pytest.mark.parametrize("option", ["--card", "--group"])
def test_a_number_of_thousands_of_digits(option: str) -> None:
    """Python refuses to read more than 4,300."""
    assert vopd("cards", CASE_1, option, "9" * 5000).status == 2


@pytest.mark.parametrize("option", ["--card", "--group"])
def test_sequence_numbers_are_taken_off_all_cards(option: str, tmp_path: Path) -> None:
    ran = vopd("cards", CASE_1, "--strip-sequence", option, "8", "-o", tmp_path / "a.dat")
    assert ran.status == 2 and not (tmp_path / "a.dat").exists()
    assert_approved(ran.stderr.splitlines()[-1])


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_sequence_numbers_are_taken_off(end: str, tmp_path: Path) -> None:
    """Of all cards but those of group 7, which have the altitude there."""
    lines = CASE_1.read_text().splitlines()
    heads = re.findall(r"(?m)^card \d+, group (\d+)", cards().stdout)[: len(lines)]
    groups = [int(one) for one in heads] + [13] * (len(lines) - len(heads))
    free = [group != 7 and len(line) <= 72 for line, group in zip(lines, groups, strict=True)]
    both = zip(lines, free, strict=True)
    numbered = [f"{line:72}{k:08}" if one else line for k, (line, one) in enumerate(both, 1)]
    (tmp_path / "numbered.dat").write_bytes(end.join([*numbered, ""]).encode())
    numbered_text = (tmp_path / "numbered.dat").read_bytes()
    own = ("--strip-sequence", "-o", tmp_path / "numbered.dat")
    assert vopd("cards", tmp_path / "numbered.dat", *own).status == 1
    assert (tmp_path / "numbered.dat").read_bytes() == numbered_text
    ran = vopd("cards", tmp_path / "numbered.dat", "--strip-sequence", "-o", tmp_path / "bare.dat")
    assert (ran.status, ran.stdout) == (0, "")
    assert sum(free) > 50
    assert_approved(ran.stderr, parts=[sum(free)])
    bare = (tmp_path / "bare.dat").read_bytes().decode().split("\n")
    assert [line.rstrip() for line in bare] == [*(line.rstrip() for line in lines), ""]
    assert vopd("run", tmp_path / "bare.dat").stdout == vopd("run", CASE_1).stdout
    (tmp_path / "numbered.dat").write_text("\n".join(numbered[:30]))  # what is wrong is kept
    ran = vopd("cards", tmp_path / "numbered.dat", "--strip-sequence")
    assert ran.stdout.split("\n") == [line.rstrip() for line in lines[:30]]
