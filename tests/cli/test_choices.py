"""Which cards, photographs and options a command takes, and the limits that its help states."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import click
import pytest

from tests.approved.texts import assert_approved, refused
from tests.kit.command import CASE_1, vopd
from vopd.cli import plot
from vopd.cli import plot as plot_stars
from vopd.cli.cards import SHOWN, CardChoice
from vopd.findings import VopdError
from vopd.stellar.files import table as read_solution
from vopd.synthetic import LIMITS, Plan


def chosen(*groups: str, cards: tuple[str, ...] = ()) -> list[int]:
    """Of a deck of cards 1 to 60, of group 8 up to 10 and then basic data, those explained."""
    choice = CardChoice(groups, cards)
    return [card for card in range(1, 61) if choice(8 if card <= 10 else 0, card)]


def test_cards_are_chosen_by_group_and_by_number() -> None:
    """With both, cards of that group among those numbers; basic data is held back unasked."""
    assert SHOWN == 21
    assert chosen() == [*range(1, 32)]
    assert chosen("8") == [*range(1, 11)]
    assert chosen("basic") == [*range(11, 61)]
    assert chosen("8", "basic") == [*range(1, 61)]
    assert chosen(cards=("9-12", "40")) == [9, 10, 11, 12, 40]
    assert chosen("8", cards=("9-12", "40")) == [9, 10]
    assert chosen("basic", cards=("9-12", "40")) == [11, 12, 40]
    assert chosen("9") == []
    choice = CardChoice((), ())
    for card in range(1, 61):
        choice(0, card)
    assert choice.held_back == 60 - 21


@pytest.mark.parametrize(
    ("groups", "cards", "message"),
    [
        ((), ("61",), "d: there is no card 61: the deck has 60 cards"),
        ((), ("5-61", "3"), "d: there is no card 61: the deck has 60 cards"),
        (("9",), (), "d: no card belongs to group 9"),
        (("9", "1"), (), "d: no card belongs to group 1 or group 9"),
        (("9", "basic"), (), ""),
        (("9", "12"), ("1-5",), "d: none of these cards belongs to group 9 or group 12"),
        ((), ("60",), ""),
    ],
)
def test_cards_that_are_not_there(
    groups: tuple[str, ...], cards: tuple[str, ...], message: str
) -> None:
    choice = CardChoice(groups, cards)
    for card in range(1, 61):
        choice(8 if card <= 10 else 0, card)
    if message:
        with refused(VopdError):
            choice.check_all_found("d")
    else:
        choice.check_all_found("d")


def test_the_help_of_demo_has_every_default_and_both_limits() -> None:
    text = re.sub(r"\s+", " ", vopd("demo", "--help").stdout)
    for part, (low, high) in LIMITS.items():
        default = getattr(Plan, part)
        shown = " ".join(map(str, default)) if isinstance(default, tuple) else f"{default:g}"
        if part == "seed":
            assert f"[default: {shown}]" in text
        else:
            limits = [f"{one:,.0f}" if one == int(one) else repr(one) for one in (low, high)]
            assert f"[default: {shown}; {limits[0]} to {limits[1]}]" in text, part


def photograph(image: str, stars: int) -> Any:
    return SimpleNamespace(
        image=image, images=[None] * stars, pointing=(1.0, 2.0, 3.0), method="svd", residuals=None,
        labels=None, unit="mm",
    )  # fmt: skip


def test_of_star_photographs_the_one_asked_for_or_with_the_most_stars_is_drawn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    held = {"a.json": [photograph("one", 3), photograph("two", 7)], "b.json": [photograph("", 5)]}
    monkeypatch.setattr(read_solution, "read_solutions", held.__getitem__)
    monkeypatch.setattr(plot_stars, "draw_star_residuals", lambda picture, size: picture)
    found = plot_stars.plot_stars(["b.json", "a.json"], None, None)
    assert found.title.startswith(
        "a.json, two: svd, 7 stars\nalpha 1.00000, delta 2.00000, swing 3"
    )
    found = plot_stars.plot_stars(["a.json", "b.json"], None, None)
    assert found.title.startswith("a.json, two: svd, 7 stars\n")
    assert plot_stars.plot_stars(["a.json"], "one", None).title.startswith("a.json, one: svd, 3 st")
    assert plot_stars.plot_stars(["b.json"], None, None).title.startswith("b.json: svd, 5 stars")
    with refused(VopdError):
        plot_stars.plot_stars(["a.json", "b.json"], "three", None)
    with refused(VopdError):
        plot_stars.plot_stars(["b.json"], "three", None)


OF_DECKS = [
    option.opts[0]
    for option in plot.command.params
    if isinstance(option, click.Option)
    and option.opts[0] not in ("-o", "--format", "--frame", "--size", "--dpi", "--help")
]


@pytest.mark.parametrize("option", OF_DECKS)
def test_options_of_decks_are_not_for_star_photographs(option: str, tmp_path: Path) -> None:
    """Every one but those of the picture itself."""
    (parameter,) = [one for one in plot.command.params if option in one.opts]
    flag = isinstance(parameter, click.Option) and parameter.is_flag
    values = {"--figure": "attitude", "--initial": "closed-form", "--ellipsoid": "wgs84",
              "--vertical": "geodetic", "--fix": "earth"}  # fmt: skip
    given = [option] if flag else [option, values.get(option, "1")]
    more = {"--ellipsoid": ["--fix", "earth"], "--compare-initial": ["--initial", "closed-form"]}
    ran = vopd("plot", tmp_path / "a.json", "-o", tmp_path / "a.svg", *given, *more.get(option, []))
    assert ran.status == 2
    first = more.get(option, [option])[0]
    assert_approved(ran.stderr, parts=[first])
    assert {"--figure", "--job", "--vertical", "--max-rate", "--strict"} <= set(OF_DECKS)


def test_star_photographs_and_decks_are_not_drawn_together(tmp_path: Path) -> None:
    ran = vopd("plot", tmp_path / "a.json", CASE_1, "-o", tmp_path / "a.svg")
    assert ran.status == 2
    assert_approved(ran.stderr)
