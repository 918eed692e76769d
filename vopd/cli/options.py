"""Decks to attitude histories: the options and the steps that several commands share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Any

import click

from vopd.attitude.history import History
from vopd.attitude.input_sigmas import Sigmas
from vopd.batch.attitude import deck_histories
from vopd.cards.reader import open_deck
from vopd.cli.console import Remarks
from vopd.cli.fixes import fix_options
from vopd.cli.progress import Progress
from vopd.errata import Fixes
from vopd.findings import VopdError

_SIGMAS = (
    ("--reading-sigma", "mm", "Of a landmark's film coordinate; by default its three readings'."),
    ("--landmark-sigma", "ft", "Of a landmark's place, each way."),
    ("--position-sigma", "ft", "Of the vehicle's place, each way."),
    ("--focal-sigma", "mm", "Of the focal length."),
    ("--time-sigma", "s", "Of a frame's time."),
)


@dataclass(frozen=True)
class Asked:
    """What the shared options ask for."""

    fixes: Fixes
    closed_form: bool
    sigmas: Sigmas
    max_rate_deg_s: float | None
    strict: bool
    quiet: bool


def history_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options of a run, the sigmas and the flags; the command is given one `asked`."""

    @fix_options
    @wraps(function)
    def with_asked(
        *,
        fixes: Fixes,
        initial: str,
        max_rate: float | None,
        strict: bool,
        quiet: bool,
        **rest: Any,
    ) -> Any:
        given = {option[2:].replace("-", "_"): unit for option, unit, _ in _SIGMAS}
        values = {f"{name[:-6]}_{unit}": rest.pop(name) for name, unit in given.items()}
        try:
            sigmas = Sigmas(**values)
            if max_rate is not None and not max_rate > 0.0:
                raise VopdError(f"--max-rate: {max_rate:g} is not above 0")
        except VopdError as error:
            raise click.UsageError(f"{error}.") from error
        asked = Asked(fixes, initial == "closed-form", sigmas, max_rate, strict, quiet)
        return function(**rest, asked=asked)

    options = [
        click.option(
            "--initial",
            type=click.Choice(["deck", "closed-form"]),
            default="deck",
            show_default=True,
            help="Start from group 8 and the frame before, or from two landmarks.",
        ),
        *(
            click.option(
                name, type=float, metavar=unit.upper(), default=None if k == 0 else 0.0, help=text
            )
            for k, (name, unit, text) in enumerate(_SIGMAS)
        ),
        click.option(
            "--max-rate", type=float, metavar="DEG/S", help="Flag frames that turn faster."
        ),
        click.option("--strict", is_flag=True, help="Exit status 3 where any frame is flagged."),
        click.option("-q", "--quiet", is_flag=True, help="No warnings."),
    ]
    command: Callable[..., Any] = with_asked
    for option in reversed(options):
        command = option(command)
    return command


def gather(
    decks: tuple[str, ...], asked: Asked, heard: Callable[[str], object] = lambda _: None
) -> tuple[list[History], int]:
    """The histories of all decks, and the exit status so far.

    A deck that fails is told on standard error, and the others still run;
    `heard` is told all warnings and faults, however many and however quiet.
    Raises `VopdError` where no frame of any deck is left with an attitude.
    """
    histories: list[History] = []
    failed = False
    remarks = Remarks(asked.quiet, heard)
    for deck in decks:
        progress = Progress(unit="frames")
        try:
            with open_deck(deck) as file:
                for one in deck_histories(
                    file,
                    deck,
                    remarks,
                    fixes=asked.fixes,
                    closed_form=asked.closed_form,
                    sigmas=asked.sigmas,
                    max_rate_deg_s=asked.max_rate_deg_s,
                ):
                    histories.append(one)
                    progress.add(len(one.results.frame))
        except VopdError as error:
            remarks.close()
            click.echo(str(error), err=True)
            heard(str(error))
            failed = True
        finally:
            progress.close()
        remarks.close()
    if not any(h.has_attitude.any() for h in histories):
        if failed:
            raise click.exceptions.Exit(1)
        raise VopdError(f"{', '.join(decks)}: no frame is left with an attitude")
    return histories, 1 if failed else _status(histories, asked)


def _status(histories: list[History], asked: Asked) -> int:
    """3 where a frame did not converge, or has any flag and `--strict` was asked for."""
    strays = any(h.flags.raised["not_converged"].any() for h in histories)
    flagged = any(h.flags.any().any() for h in histories)
    if asked.strict and flagged and not asked.quiet:
        count = sum(int(h.flags.any().sum()) for h in histories)
        click.echo(f"--strict: {count} frames are flagged", err=True)
    return 3 if strays or (asked.strict and flagged) else 0
