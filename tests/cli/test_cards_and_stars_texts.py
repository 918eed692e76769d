"""The picture of a star photograph; cards that are explained, and those that are not."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1, DECKS, vopd
from vopd.cli import cards
from vopd.cli import plot as plot_stars
from vopd.findings import VopdError


def test_the_picture_of_a_photograph(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is drawn, in its unit, with its pointing to five decimals."""
    given: list[Any] = []
    monkeypatch.setattr(plot_stars, "draw_star_residuals", lambda *one: given.append(one))
    one = SimpleNamespace(
        image="late", images=[(1.0, 2.0)] * 3, residuals="residuals", labels=["a"], unit="px",
        pointing=(10.123456, -20.5, 359.999996), method="church",
    )  # fmt: skip
    held = {"a.json": [one]}
    monkeypatch.setattr("vopd.stellar.files.table.read_solutions", held.__getitem__)
    plot_stars.plot_stars(["a.json"], "late", (9.0, 6.0))
    ((picture, size),) = given
    assert size == (9.0, 6.0)
    assert picture.title == (
        "a.json, late: church, 3 stars\nalpha 10.12346, delta -20.50000, swing 360.00000 degrees"
    )
    assert picture[1:] == (one.images, "residuals", ["a"], "px")
    held["a.json"] = [one, one]
    with refused(VopdError):
        plot_stars.plot_stars(["a.json"], "x", None)


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

    monkeypatch.setattr(cards, "explain_deck", explained)
    ran = vopd("cards", CASE_1)
    assert ran.stdout == "".join(f"card {k}\n\n" for k in range(1, min(basic, 21) + 1))
    found = ran.stderr
    assert bool(found) == (basic > 21)
    assert_approved(found, parts=[basic - 21] if basic > 21 else [])
    ran = vopd("cards", CASE_1, "--card", f"{basic}-{basic + 1}")
    assert ran.status == 1
    assert_approved(ran.stderr, parts=[CASE_1, basic + 1, basic])
