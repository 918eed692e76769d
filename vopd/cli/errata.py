"""`vopd errata`: list the known errata of the original programs."""

from __future__ import annotations

import json
from textwrap import fill

import click

from vopd.cli.options import output_option, text_or_json_option
from vopd.cli.output import refuse_to_overwrite
from vopd.errata import VOPD_ERRATA, Erratum
from vopd.files import whole_file
from vopd.findings import nearest_word

PARTS = ("where", "original", "fix", "evidence", "effect")


@click.command("errata")
@click.argument("names", metavar="[NAME]...", nargs=-1)
@click.option(
    "--program",
    type=click.Choice(["vopd", "rae"]),
    default="vopd",
    show_default=True,
    help="Whose errata: program VOPD's, or those of Rae's report and programs.",
)
@output_option("Write the list to this file.")
@text_or_json_option("How the errata are written.")
def command(names: tuple[str, ...], program: str, output: str, output_format: str) -> None:
    """List the known errata of program VOPD, or of Rae's report and programs.

    For each erratum: where it is, what the original has there, what it should
    have, how that is known, and how much it changes a result. All are listed
    unless NAMEs are given. `vopd run --fix NAME` runs with that erratum of
    program VOPD corrected.

    \b
    Examples:
        vopd errata restart
        vopd errata --program rae --format json -o rae.json

    Exit status: 0 listed; 2 wrong usage, such as an unknown NAME.
    """
    shown = chosen(names, errata_of(program))
    refuse_to_overwrite((), output)
    if output_format == "json":
        listed = json.dumps([erratum._asdict() for erratum in shown], indent=2)
    else:
        listed = "\n\n".join(map(text, shown))
    with whole_file(output) as file:
        file.write(f"{listed}\n".encode())


def errata_of(program: str) -> tuple[Erratum, ...]:
    """List the errata of one of the two sources."""
    if program == "vopd":
        return VOPD_ERRATA
    from vopd.stellar.errata import RAE_ERRATA

    return RAE_ERRATA


def chosen(names: tuple[str, ...], errata: tuple[Erratum, ...]) -> list[Erratum]:
    """Select the errata with these names, or all if no names are given."""
    known = {erratum.name: erratum for erratum in errata}
    for name in names:
        if name not in known:
            near = nearest_word(name, known)
            hint = f"Did you mean {near[0]!r}?" if near else f"There are: {', '.join(known)}."
            raise click.UsageError(f"No erratum is called {name!r}. {hint}")
    return [known[name] for name in names] if names else list(errata)


def text(erratum: Erratum) -> str:
    """Write an erratum as text, in lines of at most 80 columns."""
    lines = [erratum.name]
    for part in PARTS:
        lines.append(fill(f"  {part:9} {getattr(erratum, part)}", 80, subsequent_indent=" " * 12))
    return "\n".join(lines)
