"""`vopd check`: check flights and decks without solving them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, replace

import click

from vopd.cards.read import open_deck
from vopd.check import check_deck
from vopd.cli.options import (
    NumberRange,
    output_option,
    sources_argument,
    tell_unused,
    text_or_json_option,
)
from vopd.cli.output import refuse_to_overwrite
from vopd.files import whole_file
from vopd.findings import Finding, VopdError, first_of_each_kind
from vopd.pipeline import check_project, is_flight

SHOWN = 3  # findings of one kind

Reports = dict[str, list[Finding]]  # the findings of each deck, by the deck's name


@click.command("check")
@sources_argument
@click.option(
    "--spread",
    metavar="INCHES",
    type=NumberRange(min=0.0),
    help="How far three readings of one point may differ.  [default: by the deck's own noise]",
)
@click.option(
    "--limits-1974",
    is_flag=True,
    help="A deck that exceeds the original's array sizes is an error.",
)
@click.option(
    "--all", "show_all", is_flag=True, help="Show every finding, not only three of each kind."
)
@text_or_json_option("Text for reading, or JSON with every finding.")
@output_option("Write the findings to this file.")
@click.option("--strict", is_flag=True, help="Exit status 3 where there is any warning.")
@click.option("-q", "--quiet", is_flag=True, help="No output, only the exit status.")
@click.pass_context
def command(
    ctx: click.Context,
    sources: tuple[str, ...],
    spread: float | None,
    limits_1974: bool,
    show_all: bool,
    output_format: str,
    output: str,
    strict: bool,
    quiet: bool,
) -> None:
    """Check flights and decks for errors and doubtful values.

    SOURCE is a flight project, whose name ends in .toml, or a deck of 80-column
    cards; - is a deck on standard input.

    An error stops vopd attitude, vopd track or vopd run. A warning names a possible
    mistake. In a flight: a landmark that is never picked, a track that ends before
    the frames do, heights that differ by a geoid undulation, units or axes
    exchanged. In a deck: readings of one point that differ too much, numbers that
    are not right-justified, tables that end too early.

    The first three findings of each kind are shown; the others are counted.

    \b
    Examples:
        vopd check examples/hill/flight.toml
        vopd check decks/appendix_h/case1.dat
        vopd check --all flight.dat
        vopd check --format json -o findings.json flight.dat

    Exit status: 0 no error (there may be warnings); 1 an error; 2 wrong usage;
    3 no error but a warning, with --strict.
    """
    if quiet and output != "-":
        raise click.UsageError("-q writes nothing: leave out -q or -o.")
    tell_unused(sources, quiet)
    refuse_to_overwrite(sources, output)
    reports = {deck: _check(deck, spread, limits_1974) for deck in sources}
    if not quiet:
        text = _as_json(reports) if output_format == "json" else _as_text(reports, show_all)
        with whole_file(output) as file:
            file.write(text.encode(errors="backslashreplace"))
    ctx.exit(_status(reports, strict))


def _check(deck: str, spread: float | None, limits_1974: bool) -> list[Finding]:
    """Check one deck or flight; a source that cannot be opened is one finding."""
    if is_flight(deck):
        return check_project(deck)
    try:
        with open_deck(deck) as file:
            return check_deck(file, deck, spread_in=spread, limits_1974=limits_1974)
    except VopdError as error:
        return [Finding(str(error).removeprefix(f"{deck}: "), deck)]


def _status(reports: Reports, strict: bool) -> int:
    severities = {finding.severity for found in reports.values() for finding in found}
    if "error" in severities:
        return 1
    return 3 if strict and severities else 0


def _as_text(reports: Reports, show_all: bool) -> str:
    lines: list[str] = []
    for deck, found in reports.items():
        counts = []
        for severity in ("error", "warning"):
            some = [finding for finding in found if finding.severity == severity]
            lines += _paragraphs(some, len(some) if show_all else SHOWN)
            counts.append(f"{len(some) or 'no'} {severity}{'' if len(some) == 1 else 's'}")
        doubt = "; its angles contradict the picks: find the cause first" * _misfits(deck, found)
        lines.append(f"{deck}: {counts[0]}, {counts[1]}{doubt}")
    return "\n".join(lines) + "\n"


def _misfits(source: str, found: list[Finding]) -> bool:
    """Tell whether a flight has residuals that nothing stated explains."""
    if not is_flight(source):
        return False
    from vopd.flight.misfits.misfit import MISFITS  # takes scipy

    return any(one.message.startswith(MISFITS) for one in found)


def _paragraphs(found: list[Finding], most: int) -> Iterator[str]:
    """Write the first findings of each kind, and a line for those that are not shown."""
    shown, rest = first_of_each_kind(found, most)
    for finding in shown:
        text = f"{finding.severity}: {finding}"
        yield f"{text}\n" if finding.columns else text
    for finding, count in rest:
        more = f"{count} more like the {most} above; --all shows them"
        whole_kind = replace(finding, message=more, card=None, columns=None, image=None)
        yield f"{finding.severity}: {whole_kind}"


def _as_json(reports: Reports) -> str:
    """List an object for each deck: all its errors and warnings."""
    decks = []
    for deck, found in reports.items():
        report: dict[str, object] = {"deck": deck}
        for severity in ("error", "warning"):
            some = [asdict(finding) for finding in found if finding.severity == severity]
            report[f"{severity}s"] = [
                {key: row[key] for key in row if key not in ("source", "severity")} for row in some
            ]
        decks.append(report)
    return json.dumps(decks, indent=2) + "\n"
