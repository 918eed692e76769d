"""`vopd run`: run a deck and print the 1974 listing."""

from __future__ import annotations

from contextlib import ExitStack

import click

from vopd.cli.console import Messages, Progress
from vopd.cli.options import FILE_NAME, decks_argument, output_option, quiet_option, solve_options
from vopd.cli.output import refuse_to_overwrite
from vopd.files import Output, whole_file
from vopd.listing.pages import end_of_case, pages_of_jobs
from vopd.listing.tape10 import tape10 as tape_records
from vopd.pipeline import SolveOptions, in_groups, solve_decks
from vopd.results import SolvedJob, SourceEnd


@click.command("run")
@decks_argument
@output_option("Write the listing to this file.")
@click.option(
    "--tape10",
    type=FILE_NAME,
    metavar="FILE",
    help="Also write tape 10: seven numbers for each frame.",
)
@solve_options
@click.option("--strict", is_flag=True, help="Exit status 3 where there is any warning.")
@quiet_option
@click.pass_context
def command(
    ctx: click.Context,
    decks: tuple[str, ...],
    output: str,
    tape10: str | None,
    solve: SolveOptions,
    strict: bool,
    quiet: bool,
) -> None:
    """Run card decks of program VOPD and print its listing.

    DECK is a file of 80-column cards, - is standard input. Several decks run
    one after the other. The listing goes to standard output or, when it is
    complete, to the file of -o; everything else goes to standard error.

    \b
    Example:
        vopd run decks/appendix_h/case1.dat
        vopd run flight.dat -o flight.lst --tape10 flight.tape

    --fix corrects errata of the original by name, or all (see vopd errata); every
    page of a corrected run says so.

    Exit status: 0 all well; 1 a deck could not be read or its run failed (the
    pages before the error are printed); 2 wrong usage; 3 it ran, but some frame
    did not converge in 22 passes, or with --strict there was a warning.
    """
    refuse_to_overwrite(decks, output, tape10)
    with ExitStack() as files:
        listing = files.enter_context(whole_file(output))
        tape = files.enter_context(whole_file(tape10)) if tape10 else None
        if solve.fixes:
            click.echo(f"corrected run, not the original: {solve.fixes}", err=True)
        status = _run(decks, solve, listing, tape, messages := Messages(quiet))
    ctx.exit(3 if status == 0 and strict and messages.warnings else status)


def _run(
    decks: tuple[str, ...],
    solve: SolveOptions,
    listing: Output,
    tape: Output | None,
    messages: Messages,
) -> int:
    """Print the listings of all decks; a deck that fails does not stop the others."""
    failed = unconverged = False
    progress = Progress("frames")
    for group in in_groups(solve_decks(decks, solve)):
        jobs = [one.results for one in group if isinstance(one, SolvedJob)]
        printed = iter(pages_of_jobs(jobs))
        for one in group:
            if isinstance(one, SourceEnd):
                progress.close()
                for finding in one.findings:
                    messages(finding)
                if one.error is not None:
                    messages.error(str(one.error))
                    failed = True
                else:
                    listing.write(end_of_case())
                    messages.close()
                continue
            for page in next(printed):
                listing.write(page)
                progress.add(page.count(b"STANDARD DEVIATION"))
            if tape is not None:
                tape.write(tape_records(one.results))
            for finding in one.findings:
                messages(finding)
            unconverged = unconverged or not one.results.converged.all()
    return 1 if failed else 3 if unconverged else 0
