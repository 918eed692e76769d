"""`vopd report`: decks in, one HTML page out."""

from __future__ import annotations

from pathlib import PurePath

import click

from vopd.cli.file_options import decks_argument, output_option
from vopd.cli.histories import collect_histories
from vopd.cli.options import HistoryOptions, history_options
from vopd.cli.output import refuse_to_overwrite, whole_file
from vopd.report import report

SUFFIXES = (".html", ".htm")


@click.command("report")
@decks_argument
@output_option("The page: .html, or - for a pipe.", required=True)
@history_options
@click.pass_context
def command(
    ctx: click.Context, /, decks: tuple[str, ...], output: str, asked: HistoryOptions
) -> None:
    """Write a report of card decks: one HTML page that needs nothing else.

    Summary, warnings, pictures, a table of frames to sort and to filter by flag,
    statistics of every landmark, conventions and the fixes in force. The page
    opens from disk, asks nothing of a network, and can be printed. Its numbers are
    those of vopd attitude. Pictures take matplotlib: pip install 'vopd[plots]'.

    \b
    Examples:
        vopd report decks/appendix_h/case4.dat -o case4.html
        vopd report flight.dat -o flight.html --position-sigma 100 --max-rate 40

    Exit status: 0 all well; 1 a deck could not be read or its run failed (the
    page says so), or no frame has an attitude; 2 wrong usage; 3 it ran, but
    some frame did not converge, or with --strict was flagged.
    """
    if output != "-" and PurePath(output).suffix.lower() not in SUFFIXES:
        raise click.UsageError(f"{output}: name the file .html.")
    refuse_to_overwrite(decks, output)
    heard: list[str] = []
    histories, status = collect_histories(decks, asked, heard.append)
    page = report(histories, heard, asked.sigmas, asked.max_rate_deg_s, failed=status == 1)
    with whole_file(output) as file:
        file.write(page)
    ctx.exit(status)
