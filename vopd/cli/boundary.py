"""Turn exceptions into messages on standard error and an exit status, for all commands."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable

import click

from vopd.findings import VopdError


class ReaderGone(Exception):
    """The program that reads standard output has closed it, so nothing more can be written."""


def at_the_boundary(command: Callable[[], object]) -> int:
    """Run a click command; print errors that the user can correct; return the exit status.

    Args:
        command: runs a click command with `standalone_mode` off, so that it raises
    """
    returned = 0
    try:
        returned = command_status(command)
        sys.stdout.flush()
    except (BrokenPipeError, ReaderGone):
        discard_output()
    except OSError as error:  # a full disk, noticed while writing or while flushing
        discard_output()
        click.echo(f"{error.filename or 'standard output'}: {error.strerror}", err=True)
        return 1
    except MemoryError:
        click.echo("there is not enough memory for this input", err=True)
        return 1
    return returned


def command_status(command: Callable[[], object]) -> int:
    """Run a click command and return its exit status; wrong usage is explained."""
    try:
        returned = command()
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except click.Abort:
        return 130
    except VopdError as error:
        click.echo(str(error), err=True)
        return 1
    return returned if isinstance(returned, int) else 0


def discard_output() -> None:
    """Discard the rest of standard output, which the interpreter would flush again at exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
