"""`vopd check`: look a deck over without running it."""

from __future__ import annotations

import json
from dataclasses import asdict

import click

from vopd.cards.reader import open_deck
from vopd.check.deck import check_deck
from vopd.check.rules import SPREAD_IN
from vopd.cli.file_options import decks_argument
from vopd.findings import Finding, VopdError


@click.command("check")
@decks_argument
@click.option(
    "--spread",
    metavar="INCHES",
    type=click.FloatRange(min=0.0),
    default=SPREAD_IN,
    show_default=True,
    help="How far three readings of one point may differ.",
)
@click.option("--limits-1974", is_flag=True, help="Hold the deck to the original's array sizes.")
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text")
@click.pass_context
def command(
    ctx: click.Context, decks: tuple[str, ...], spread: float, limits_1974: bool, form: str
) -> None:
    """Read decks without solving and report all that is wrong with them.

    Errors are what vopd run would stop at. Warnings are what the original took
    without a word and a careful person would question: readings that spread,
    numbers not right-justified, tables that end before the frames do, and so on.

    \b
    Example:
        vopd check decks/appendix_h/case1.dat
        vopd check --format json flight.dat

    Exit status: 0 no error (there may be warnings); 1 an error; 2 wrong usage.
    """
    reports = {deck: _check(deck, spread, limits_1974) for deck in decks}
    if form == "json":
        click.echo(json.dumps([_as_json(deck, found) for deck, found in reports.items()], indent=2))
    else:
        for deck, found in reports.items():
            _print(deck, found)
    errors = any(f.severity == "error" for found in reports.values() for f in found)
    ctx.exit(1 if errors else 0)


def _check(deck: str, spread: float, limits_1974: bool) -> list[Finding]:
    try:
        with open_deck(deck) as file:
            return check_deck(file, deck, spread_in=spread, limits_1974=limits_1974)
    except VopdError as error:
        return [Finding(str(error).removeprefix(f"{deck}: "), deck)]


def _print(deck: str, found: list[Finding]) -> None:
    counts = []
    for severity in ("error", "warning"):
        some = [finding for finding in found if finding.severity == severity]
        for finding in some:
            click.echo(f"{severity}: {finding}\n" if finding.columns else f"{severity}: {finding}")
        counts.append(f"{len(some) or 'no'} {severity}{'' if len(some) == 1 else 's'}")
    click.echo(f"{deck}: {counts[0]}, {counts[1]}")


def _as_json(deck: str, found: list[Finding]) -> dict[str, object]:
    rows = [{k: v for k, v in asdict(f).items() if k not in ("deck", "severity")} for f in found]
    kinds = [finding.severity for finding in found]
    return {
        "deck": deck,
        "errors": [row for row, kind in zip(rows, kinds, strict=True) if kind == "error"],
        "warnings": [row for row, kind in zip(rows, kinds, strict=True) if kind == "warning"],
    }
