"""`vopd report`: write one HTML page about flights and decks."""

from __future__ import annotations

import sys
from pathlib import PurePath

import click

from vopd.cli.console import notes
from vopd.cli.histories import collect_histories
from vopd.cli.options import SharedOptions, history_options, output_option, sources_argument
from vopd.cli.output import refuse_to_overwrite
from vopd.files import whole_file
from vopd.report import check_ready, report

SUFFIXES = (".html", ".htm")


@click.command("report")
@sources_argument
@output_option("The page: .html; - is standard output.", required=True)
@click.option(
    "--photographs",
    is_flag=True,
    help="Put the frames' photographs into the page, reduced to 1024 pixels, some .1 MB each.",
)
@history_options
@click.pass_context
def command(
    ctx: click.Context,
    /,
    sources: tuple[str, ...],
    output: str,
    photographs: bool,
    options: SharedOptions,
) -> None:
    """Write a report: one HTML page that needs no other file.

    SOURCE is a flight project, whose name ends in .toml, or a deck of 80-column
    cards; - is a deck on standard input. The page begins with the angles, their
    uncertainty and the doubtful frames. A slider, the curves or the arrow keys
    choose a frame: its image with the residuals, a map and its row of the table
    follow. Frames can be filtered by flag and by range. Below are statistics of
    every landmark, the warnings, the conventions and the fixes in force.

    The page opens from disk, loads nothing from a network, and can be printed. Its
    numbers are those of vopd attitude. The command needs jinja2, and matplotlib for
    the figure of all residuals.

    \b
    Examples:
        vopd report examples/hill/flight.toml -o hill.html
        vopd report decks/appendix_h/case4.dat -o case4.html
        vopd report flight.dat -o flight.html --position-sigma 100 --max-rate 40
        vopd report survey/flight.toml -o survey.html --photographs

    Exit status: 0 the page is written; 1 a source could not be read or solved
    (the page says so), or no frame has an attitude; 2 wrong usage; 3 the page is
    written, but some frame did not converge, a flight misfits, or with --strict
    some frame has a flag.
    """
    check_page_name(output)
    refuse_to_overwrite(sources, output)
    check_ready()
    messages: list[str] = []
    histories, status = collect_histories(sources, options, messages.append)
    rate = options.history.max_rate_deg_s
    page = report(
        histories,
        messages,
        rate,
        failed=status == 1,
        photographs=photographs,
        on_missing=notes(options.quiet),
    )
    with whole_file(output) as file:
        file.write(page)
    ctx.exit(status)


def check_page_name(output: str) -> None:
    """Check the name of the file of a page.

    Raises:
        click.UsageError: where it is not .html, or a page would go to a terminal
    """
    if output != "-" and PurePath(output).suffix.lower() not in SUFFIXES:
        raise click.UsageError(f"{output}: name the file .html.")
    if output == "-" and sys.stdout.isatty():
        raise click.UsageError("a page is not sent to a terminal: name a file with -o.")
