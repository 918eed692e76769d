"""`vopd punch`: write a flight as a deck of 1974 cards."""

from __future__ import annotations

import csv
import io

import click

from vopd.cli.console import Messages
from vopd.cli.options import FILE_NAME, output_option, project_argument, quiet_option
from vopd.cli.output import refuse_to_overwrite
from vopd.files import not_a_formula, whole_file
from vopd.findings import VopdError

SHOWN = 12  # rows of the table of numbers


@click.command("punch")
@project_argument
@output_option("The deck to write; by default standard output.")
@click.option(
    "--numbers",
    type=FILE_NAME,
    metavar="FILE",
    help="Also write the table of new numbers of landmarks and frames, CSV.",
)
@quiet_option
def command(project: str, output: str, numbers: str | None, quiet: bool) -> None:
    """Write a flight project as a deck of 1974 cards: the same frames and landmarks.

    PROJECT is a flight project, .toml. vopd run --fix all of the deck gives the
    angles of the flight within .0005 degree, which is what the columns of the
    cards can hold. Robust losses and picks of different weight are exceptions.
    What does not fit on cards is listed on standard error. Landmarks and frames
    whose names or numbers do not fit get new numbers; their table is shown there,
    or written to the file of --numbers.

    vopd new --deck does the reverse.

    \b
    Examples:
        vopd punch examples/hill/flight.toml -o hill.dat --numbers hill.csv
        vopd run --fix all hill.dat

    Exit status: 0 the deck is written; 1 the project could not be read or does not
    fit on cards; 2 wrong usage.
    """
    from vopd.cards.write import write_deck
    from vopd.convert.flight_to_deck import flight_job
    from vopd.flight.result import solve_flight

    refuse_to_overwrite((project,), output, numbers)
    try:
        result = solve_flight(project)
        job, numbered, notes = flight_job(result)
    except VopdError as error:
        said = str(error)
        raise VopdError(said if said.startswith(project) else f"{project}: {said}") from error
    deck = write_deck([job])
    table = io.StringIO()
    rows_of = ((kind, number, not_a_formula(name)) for kind, number, name in numbered)
    csv.writer(table, lineterminator="\n").writerows(rows_of)
    rows = table.getvalue().splitlines()
    with whole_file(output) as file:
        file.write(deck.encode("ascii"))
    if numbers is not None:
        with whole_file(numbers) as file:
            file.write("\n".join(["kind,number,name", *rows, ""]).encode())
    messages = Messages(quiet)
    for finding in result.findings:
        messages(finding)
    messages.close()
    if not quiet:
        for note in notes:
            click.echo(f"{project}: {note}", err=True)
        if numbers is None and rows:
            click.echo(f"{project}: numbered anew (kind,number,name):", err=True)
            for line in rows[:SHOWN]:
                click.echo(f"    {line}", err=True)
            if len(rows) > SHOWN:
                click.echo(f"    and {len(rows) - SHOWN} more: --numbers writes them", err=True)
