"""The one place where an exception becomes a message on standard error and an exit status."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable

import click

from vopd.findings import VopdError


class ReaderGone(Exception):
    """The reader of standard output has closed it: there is nothing more to do."""


def at_the_boundary(command: Callable[[], object]) -> int:
    """Run a click command and return the exit status; what the user can mend is one message.

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
    """Run a click command and return its exit status, with the user's mistakes said."""
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
    """Let the rest of standard output go nowhere: the interpreter flushes it once more at exit."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, sys.stdout.fileno())
