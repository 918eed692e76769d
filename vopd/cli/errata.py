"""`vopd errata`: the known slips of the original programs."""

from __future__ import annotations

import json
from dataclasses import asdict
from textwrap import fill

import click

from vopd.errata import VOPD_ERRATA, Erratum
from vopd.findings import VopdError

PARTS = ("where", "slip", "remedy", "evidence", "effect")


@click.command("errata")
@click.argument("names", metavar="[NAME]...", nargs=-1)
@click.option("--program", type=click.Choice(["vopd", "rae"]), default="vopd", show_default=True)
@click.option("--format", "form", type=click.Choice(["text", "json"]), default="text")
def command(names: tuple[str, ...], program: str, form: str) -> None:
    """List the known slips of program VOPD, or of Rae's report and programs.

    For each: where it stands, what it should be, how it is known, what it does
    to a result. `vopd run --fix NAME` runs without a slip of program VOPD.

    \b
    Example:
        vopd errata restart
        vopd errata --program rae --format json
    """
    shown = chosen(names, errata_of(program))
    if form == "json":
        click.echo(json.dumps([asdict(erratum) for erratum in shown], indent=2))
    else:
        click.echo("\n\n".join(map(text, shown)))


def errata_of(program: str) -> tuple[Erratum, ...]:
    """The errata of one of the two sources."""
    if program == "vopd":
        return VOPD_ERRATA
    from vopd.stellar.rae1987.errata import RAE_ERRATA

    return RAE_ERRATA


def chosen(names: tuple[str, ...], errata: tuple[Erratum, ...]) -> list[Erratum]:
    """The errata of these names, all where there is none; raises `VopdError` for an unknown one."""
    known = {erratum.name: erratum for erratum in errata}
    for name in names:
        if name not in known:
            raise VopdError(f"no slip is called {name!r}; there are: {', '.join(known)}")
    return [known[name] for name in names] if names else list(errata)


def text(erratum: Erratum) -> str:
    """One erratum for a reader on an 80 column terminal."""
    lines = [erratum.name]
    for part in PARTS:
        lines.append(fill(f"  {part:9} {getattr(erratum, part)}", 80, subsequent_indent=" " * 12))
    return "\n".join(lines)
