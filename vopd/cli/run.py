"""`vopd run`: a deck in, the 1974 listing out."""

from __future__ import annotations

from contextlib import ExitStack
from typing import Any, BinaryIO

import click

from vopd.batch.deck import run_deck
from vopd.cards.reader import open_deck
from vopd.cli.console import Remarks
from vopd.cli.fixes import fix_options
from vopd.cli.output import refuse_to_overwrite, whole_file
from vopd.cli.progress import Progress
from vopd.errata import Fixes
from vopd.findings import VopdError


@click.command("run")
@click.argument("decks", metavar="DECK...", nargs=-1, required=True)
@click.option("-o", "--output", metavar="FILE", default="-", help="The listing's file.")
@click.option("--tape10", metavar="FILE", help="Also write tape 10: seven numbers a frame.")
@click.option("--limits-1974", is_flag=True, help="Hold the deck to the original's array sizes.")
@fix_options
@click.option(
    "--initial",
    type=click.Choice(["deck", "closed-form"]),
    default="deck",
    show_default=True,
    help="Start from group 8 and the frame before, or each frame from two of its landmarks.",
)
@click.option("-q", "--quiet", is_flag=True, help="No warnings.")
@click.pass_context
def command(
    ctx: click.Context,
    decks: tuple[str, ...],
    output: str,
    tape10: str | None,
    limits_1974: bool,
    fixes: Fixes,
    initial: str,
    quiet: bool,
) -> None:
    """Run card decks of program VOPD and print its listing.

    DECK is a file of 80-column cards, - is standard input. Several decks run
    one after the other. The listing goes to standard output, or whole into the
    file of -o; everything else goes to standard error.

    \b
    Example:
        vopd run decks/appendix_h/case1.dat
        vopd run flight.dat -o flight.lst --tape10 flight.tape

    --fix corrects slips of the original by name (see vopd errata); every page
    of a corrected run says so.

    Exit status: 0 all well; 1 a deck could not be read or its run failed (the
    pages before the fault are printed); 2 wrong usage; 3 it ran, but some frame
    did not converge in 22 passes.
    """
    refuse_to_overwrite(decks, output, tape10)
    with ExitStack() as files:
        listing = files.enter_context(whole_file(output))
        tape = files.enter_context(whole_file(tape10)) if tape10 else None
        if fixes:
            click.echo(f"corrected run, not the original: {fixes}", err=True)
        options = {
            "fixes": fixes,
            "closed_form": initial == "closed-form",
            "limits_1974": limits_1974,
            "tape": tape.write if tape else lambda _: None,
        }
        statuses = [_run(deck, listing, Remarks(quiet), options) for deck in decks]
    ctx.exit(1 if 1 in statuses else max(statuses))


def _run(deck: str, listing: BinaryIO, remarks: Remarks, options: dict[str, Any]) -> int:
    """Run one deck; the others still run where it fails."""
    progress = Progress(listing.write)
    try:
        with open_deck(deck) as file:
            unconverged = run_deck(file, deck, progress, remarks, **options)
    except VopdError as error:
        remarks.close()
        click.echo(str(error), err=True)
        return 1
    finally:
        progress.close()
    remarks.close()
    for finding in unconverged:
        click.echo(str(finding), err=True)
    return 3 if unconverged else 0
