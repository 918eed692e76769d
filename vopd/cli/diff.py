"""`vopd diff`: compare two listings field by field."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from decimal import Decimal
from itertools import chain, islice

import click

from vopd.cli.options import FILE_NAME, output_option, text_or_json_option
from vopd.cli.output import refuse_to_overwrite
from vopd.files import Output, whole_file
from vopd.findings import VopdError, count_text
from vopd.listing.compare import (
    Comparison,
    Difference,
    Within,
    exact_units,
    find_differences,
    read_listing,
    read_within,
    tolerance_rows,
    undetermined_fields,
)

WRITTEN_AT_ONCE = 500  # differences
UNITS = ("deg", "ft", "1000 ft", "s", "mm", "in", "")
"""Units in the order in which differences are written."""
SORTED = 200_000  # differences that are held at once, some 100 MB


def _units(ctx: click.Context, param: click.Parameter, value: str) -> Decimal:
    """Check the value of --units."""
    try:
        return exact_units(value)
    except VopdError:
        raise click.BadParameter(f"{value!r} is not a number of 0 or more.") from None


def _within(ctx: click.Context, param: click.Parameter, value: str | None) -> Within:
    """Check the value of --within."""
    try:
        return {} if value is None else read_within(value)
    except VopdError as error:
        raise click.BadParameter(f"{error}.") from None


def _show_tolerances(ctx: click.Context, param: click.Parameter, wanted: bool) -> None:
    """Print the table of tolerances, where it is asked for, and end the command."""
    if wanted and not ctx.resilient_parsing:
        for row in tolerance_rows():
            click.echo("{:<22}{:<9}{:<12}{:<8}{}".format(*row).rstrip())
        ctx.exit()


@click.command("diff")
@click.argument("expected", type=FILE_NAME)
@click.argument("actual", type=FILE_NAME)
@click.option(
    "--units",
    metavar="N",
    default="1",
    show_default=True,
    callback=_units,
    help="How many units of its last printed digit a number may differ by; fractions are "
    "possible, and 0 asks for identical text.",
)
@click.option(
    "--within",
    metavar="TOLERANCES",
    callback=_within,
    help="Besides, how far numbers of a unit may differ, such as .01deg,1ft; the units are deg, "
    "ft, in, mm and s.",
)
@click.option(
    "--tolerances",
    is_flag=True,
    is_eager=True,
    expose_value=False,
    callback=_show_tolerances,
    help="Print how far each quantity may differ, and why, and compare nothing.",
)
@click.option(
    "--undetermined",
    metavar="LOW HIGH",
    type=FILE_NAME,
    nargs=2,
    help="Two listings of the same deck that bracket its numbers, such as those of two "
    "computers. A difference within them is named and counted, but is no failure.",
)
@output_option("Write the differences to this file.")
@text_or_json_option("How the differences are written.")
@click.option("-q", "--quiet", is_flag=True, help="Write nothing: only set the exit status.")
@click.pass_context
def command(
    ctx: click.Context,
    expected: str,
    actual: str,
    units: Decimal,
    within: Within,
    undetermined: tuple[str, str] | None,
    output: str,
    output_format: str,
    quiet: bool,
) -> None:
    """Compare two listings page by page and field by field.

    One of the two may be - for standard input. Text must be equal, except for
    blanks at the end of a line. Numbers may differ by one unit of their last
    printed digit; --units and --within set other limits. Angles are compared around
    the circle; numbers of landmarks and frames must be equal. Fields are found by
    the columns of the listing's FORMATs, so they may touch (112.175-158.836). A
    line or page that only one listing has counts as one difference, and the
    comparison continues after it. The output begins with these differences; numbers
    follow by unit (deg, ft, s, mm, in), the largest difference of each first.

    \b
    Example:
      $ vopd run case1.dat | vopd diff --units 0 case1.lst -
      page 1, frame 730, line 18, PHI: expected 75.837,
          actual 75.836 (off by 0.001 deg)
      largest: 0.001 deg (frame 730, PHI)
      1 difference; 82 fields on 2 pages compared, 0 illegible

    Pages are counted from 1, lines from the start of EXPECTED. EXPECTED may be
    the transcript of a damaged print: in it a field that has only ? is illegible
    and not compared, and a line that is a single ? stands for any one line, even a
    blank line or the first line of a page. In ACTUAL a ? is text.

    A digit next to the boundary between two decimals depends on the last bits of
    the computer's sines. --undetermined says which digits these are.

    Exit status: 0 no difference, or only in digits that are not determined; 1 a
    difference, or a file that cannot be read or is not a listing; 2 wrong usage.
    """
    if expected == actual == "-":
        raise click.UsageError("EXPECTED and ACTUAL cannot both be standard input.")
    if "-" in (undetermined or ()):
        raise click.UsageError("LOW and HIGH cannot be standard input.")
    if quiet and output != "-":
        raise click.UsageError("With --quiet nothing is written; leave out --output.")
    texts = read_listing(expected), read_listing(actual)
    refuse_to_overwrite((expected, actual, *(undetermined or ())), output)
    free = undetermined_fields(*map(read_listing, undetermined)) if undetermined else {}
    counts = Comparison()
    found = find_differences(*texts, units, counts, free, within)
    if quiet:
        ctx.exit(int(any(difference.determined for difference in found)))
    write = _write_json if output_format == "json" else _write_text
    with whole_file(output) as file:
        differences = write(file, found, counts)
    ctx.exit(int(differences > counts.fields_undetermined))


def _write_text(file: Output, found: Iterable[Difference], counts: Comparison) -> int:
    """Write the differences, the largest first, then lines that sum them up; return their number.

    Beyond `SORTED` differences the others follow in the order of the pages.
    """
    rest = iter(found)
    first = sorted(islice(rest, SORTED), key=_rank)
    number = 0
    largest: dict[str, Difference] = {}
    for some in _batches(chain(first, rest)):
        file.write("".join(f"{difference}\n" for difference in some).encode())
        number += len(some)
        for one in some:
            before = largest.get(one.unit)
            if (
                one.apart is not None
                and one.determined
                and (before is None or one.apart > (before.apart or 0))
            ):
                largest[one.unit] = one
    if largest:
        texts = (f"{one.amount()} ({_place(one)})" for one in largest.values())
        file.write(f"largest: {'; '.join(texts)}\n".encode())
    free, near = counts.fields_undetermined, counts.fields_within
    beyond = " beyond the tolerances" if near else ""
    within = count_text(near, "field differs within them", "fields differ within them")
    alone = ((counts.pages_missing, "EXPECTED"), (counts.pages_extra, "ACTUAL"))
    only = "".join(f"; {_counted(count, 'page')} only in {of}" for count, of in alone if count)
    summary = (
        f"{_counted(number - free, 'difference')}{beyond}; "
        + (f"{within} (--units 0 shows all); " if near else "")
        + (f"{_counted(free, 'field')} not determined; " if free else "")
        + f"{_counted(counts.fields_compared, 'field')} on "
        f"{_counted(counts.pages, 'page')} compared, {counts.fields_illegible} illegible{only}\n"
    )
    file.write(summary.encode())
    return number


def _rank(one: Difference) -> tuple[int, Decimal]:
    """Order text first, then numbers unit by unit, the largest difference of each first."""
    return (-1, Decimal(0)) if one.apart is None else (UNITS.index(one.unit), -one.apart)


def _place(one: Difference) -> str:
    """Name frame, landmark and field of a difference."""
    named = (("frame", one.frame), ("landmark", one.landmark))
    return ", ".join([*(f"{what} {name}" for what, name in named if name), one.field])


def _counted(number: int, noun: str) -> str:
    """Write a number with its noun: `no differences`, `1 page`, `81 fields`."""
    return count_text(number, noun) if number else f"no {noun}s"


def _write_json(file: Output, found: Iterable[Difference], counts: Comparison) -> int:
    """Write one JSON object, each difference on a line of its own; return their number."""
    number = 0
    file.write(b'{"differences": [')
    for some in _batches(found):
        rows = ",\n".join(json.dumps(asdict(difference), default=float) for difference in some)
        file.write(((",\n" if number else "\n") + rows).encode())
        number += len(some)
    totals = {name: count for name, count in asdict(counts).items() if name != "differences"}
    file.write(("\n], " + json.dumps(totals)[1:] + "\n").encode())
    return number


def _batches(found: Iterable[Difference]) -> Iterator[list[Difference]]:
    """Gather the differences in lists, because to write them one by one is slow."""
    rest = iter(found)
    while some := list(islice(rest, WRITTEN_AT_ONCE)):
        yield some
