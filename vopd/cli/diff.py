"""`vopd diff`: two listings against each other, field by field."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from decimal import Decimal
from itertools import islice

import click

from vopd.compare.difference import Difference
from vopd.compare.fields import units_allowed
from vopd.compare.listing_file import read_listing
from vopd.compare.listings import Tally, find_differences
from vopd.compare.tolerances import table
from vopd.findings import VopdError


def _units(ctx: click.Context, param: click.Parameter, value: str) -> Decimal:
    try:
        return units_allowed(value)
    except VopdError:
        raise click.BadParameter(f"{value!r} is not a number of 0 or more.") from None


def _show_tolerances(ctx: click.Context, param: click.Parameter, wanted: bool) -> None:
    if wanted and not ctx.resilient_parsing:
        for row in table():
            click.echo("{:<22}{:<9}{:<12}{:<8}{}".format(*row).rstrip())
        ctx.exit()


@click.command()
@click.argument("expected")
@click.argument("actual")
@click.option(
    "--units",
    metavar="N",
    default="1",
    show_default=True,
    callback=_units,
    help="Units of its last printed digit by which a number may differ, fractions too; "
    "0 asks for the same characters.",
)
@click.option(
    "--tolerances",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_show_tolerances,
    help="Print what every quantity is allowed, and why; compare nothing.",
)
@click.option(
    "--format",
    "form",
    type=click.Choice(["text", "json"]),
    default="text",
    show_default=True,
    help="How the differences are written.",
)
@click.option("-q", "--quiet", is_flag=True, help="Write nothing; the exit status tells.")
@click.pass_context
def command(
    ctx: click.Context, expected: str, actual: str, units: Decimal, form: str, quiet: bool
) -> None:
    """Compare two listings page by page, field by field.

    One of the two may be - for standard input. Text must be equal but for
    trailing blanks. Numbers may differ by one unit of their last printed digit,
    or by --units; angles that wrap are compared around the circle, landmark and
    frame numbers must be equal. Fields are cut by the columns of the listing's
    FORMATs, so they may touch (112.175-158.836). A line or page that only one
    listing has is one difference, and the comparison goes on behind it.

    \b
    Example:
      $ vopd run case1.dat | vopd diff --units 0 case1.lst -
      page 1, frame 730, line 18, PHI: expected 75.837, actual 75.836 (off by 1)
      1 difference; 82 fields on 2 pages compared, 0 not legible

    Pages count from 1, lines from the start of EXPECTED. EXPECTED may be the
    transcript of a damaged print: in it a field of nothing but ? is not legible
    and not compared, and a line that is a single ? stands for any one line, a
    blank one or a page's first too. In ACTUAL a ? is text.

    Exit status: 0 no difference; 1 a difference, or a file that cannot be read
    or is no listing; 2 wrong usage.
    """
    if expected == actual == "-":
        raise click.UsageError("EXPECTED and ACTUAL cannot both be standard input.")
    tally = Tally()
    try:
        found = find_differences(read_listing(expected), read_listing(actual), units, tally)
    except VopdError as error:
        click.echo(str(error), err=True)
        ctx.exit(1)
    if quiet:
        ctx.exit(int(any(True for _ in found)))
    write = _write_json if form == "json" else _write_text
    ctx.exit(int(write(found, tally) > 0))


def _write_text(found: Iterable[Difference], tally: Tally) -> int:
    count = 0
    for batch in _batches(found):
        click.echo("\n".join(map(str, batch)))
        count += len(batch)
    click.echo(
        f"{_number(count, 'difference')}; {_number(tally.fields_compared, 'field')} on "
        f"{_number(tally.pages, 'page')} compared, {tally.fields_illegible} not legible"
    )
    return count


def _number(count: int, thing: str) -> str:
    return f"{count or 'no'} {thing}{'' if count == 1 else 's'}"


def _write_json(found: Iterable[Difference], tally: Tally) -> int:
    """One object; the differences, each on its own line, are written as they are found."""
    count = 0
    click.echo('{"differences": [', nl=False)
    for batch in _batches(found):
        rows = ",\n".join(json.dumps(asdict(difference), default=float) for difference in batch)
        click.echo((",\n" if count else "\n") + rows, nl=False)
        count += len(batch)
    click.echo("\n], " + json.dumps(asdict(tally))[1:])
    return count


def _batches(found: Iterable[Difference], size: int = 500) -> Iterator[list[Difference]]:
    rest = iter(found)
    while batch := list(islice(rest, size)):
        yield batch
