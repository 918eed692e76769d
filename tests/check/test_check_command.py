"""The options of `vopd check`: what is shown, what is counted, where it goes, exit statuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.approved.texts import assert_approved
from tests.kit.cards import CardEdit, punch, punch_all, two_frames
from tests.kit.command import CASE_1, vopd


@pytest.fixture(autouse=True)
def in_a_new_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def write_deck_file(name: str, *edits: CardEdit) -> None:
    cards = two_frames()
    for edit in edits:
        edit(cards)
    Path(name).write_text("\n".join(cards) + "\n")


MANY = punch_all(range(34, 38), 71, "  149000.0")
"""Four altitudes that disagree with their positions."""


def test_text_of_several_decks() -> None:
    """Errors come before warnings, with a ruler; a deck that is not there is an error."""
    write_deck_file("deck.dat", punch(39, 41, "      5O.3"), punch(56, 41, " 010200"))
    done = vopd("check", "deck.dat", "none.dat")
    assert (done.status, done.stderr) == (1, "")
    assert_approved(done.stdout)
    assert "deck.dat: 1 error, 1 warning\n" in done.stdout
    assert done.stdout.index("error: ") < done.stdout.index("warning: ")
    assert "error: none.dat: No such file or directory" in done.stdout
    assert "^^^^^^^^^^" in done.stdout


def test_many_of_one_kind_are_counted() -> None:
    write_deck_file("deck.dat", MANY, punch(56, 41, " 010200"))
    text = vopd("check", "deck.dat").stdout
    assert text.count("X, Y, Z give") == 3
    assert (
        "warning: deck.dat: group 7, vehicle altitude above sea level: "
        "1 more like the 3 above; --all shows them\n"
    ) in text
    assert text.count("three readings") == 1
    assert text.endswith("deck.dat: no errors, 5 warnings\n")


def test_all_and_json_have_every_one() -> None:
    write_deck_file("deck.dat", MANY)
    everything = vopd("check", "--all", "deck.dat").stdout
    assert everything.count("X, Y, Z give") == 4 and "more like" not in everything
    (report,) = json.loads(vopd("check", "--format", "json", "deck.dat").stdout)
    assert [row["card"] for row in report["warnings"]] == [34, 35, 36, 37]
    assert report["deck"] == "deck.dat" and report["errors"] == []


def test_errors_of_one_kind_are_counted_too() -> None:
    write_deck_file("deck.dat", *(punch(card, 45, f"XX{card}") for card in range(44, 54)))
    text = vopd("check", "deck.dat").stdout
    assert text.count("not a number") == 3
    assert_approved(text)
    assert "10 errors" in text


@pytest.mark.parametrize(
    ("deck", "options", "status"),
    [
        ("clean", (), 0),
        ("clean", ("--strict",), 0),
        ("warned", (), 0),
        ("warned", ("--strict",), 3),
        ("wrong", (), 1),
        ("wrong", ("--strict",), 1),
    ],
)
def test_exit_status_with_and_without_output(
    deck: str, options: tuple[str, ...], status: int
) -> None:
    write_deck_file("clean")
    write_deck_file("warned", MANY)
    write_deck_file("wrong", MANY, punch(39, 41, "      5O.3"))
    assert vopd("check", *options, deck).status == status
    for quiet in ("-q", "--quiet"):
        done = vopd("check", quiet, *options, deck)
        assert (done.status, done.stdout, done.stderr) == (status, "", "")


@pytest.mark.parametrize("form", ["text", "json"])
def test_output_to_a_file(form: str) -> None:
    write_deck_file("deck.dat", MANY)
    printed = vopd("check", "--format", form, "deck.dat")
    saved = vopd("check", "--format", form, "-o", "found.txt", "deck.dat")
    assert (saved.status, saved.stdout) == (0, "")
    assert Path("found.txt").read_bytes() == printed.output


def test_refusals() -> None:
    write_deck_file("deck.dat")
    before = Path("deck.dat").read_bytes()
    done = vopd("check", "-o", "deck.dat", "deck.dat")
    assert done.status == 1 and "deck.dat: this file is needed already" in done.stderr
    assert Path("deck.dat").read_bytes() == before
    assert vopd("check", "-q", "-o", "found.txt", "deck.dat").status == 2
    assert vopd("check").status == 2
    for wrong in ("-1", "nan", "x"):
        assert vopd("check", "--spread", wrong, "deck.dat").status == 2
    assert "No such option" in vopd("check", "--stict", "deck.dat").stderr


def test_spread_and_limits() -> None:
    write_deck_file("deck.dat", punch(56, 41, " 010200"))
    assert vopd("check", "--strict", "-q", "--spread", "0.03", "deck.dat").status == 0
    assert vopd("check", "--strict", "-q", "--spread", "0.025", "deck.dat").status == 3
    write_deck_file("deck.dat", punch(39, 9, "91"))
    done = vopd("check", "--limits-1974", "deck.dat")
    assert done.status == 1 and "TTHJ(90)" in done.stdout


def test_standard_input() -> None:
    done = vopd("check", "-", stdin=CASE_1.read_bytes())
    assert done.status == 0 and done.stdout.endswith("-: no errors, 1 warning\n")


def test_help_explains_the_statuses() -> None:
    text = " ".join(vopd("check", "--help").stdout.split())
    for word in ("--all", "--strict", "-q, --quiet", "-o, --output", "3 no error but a warning"):
        assert word in text


def test_a_deck_that_ends_after_group_1_has_no_job() -> None:
    Path("deck.dat").write_text("\n".join(two_frames()[:25]) + "\n")
    done = vopd("check", "deck.dat")
    assert done.status == 0 and "warning: deck.dat: the deck ends after group 1" in done.stdout
    assert vopd("run", "deck.dat").status == 0
