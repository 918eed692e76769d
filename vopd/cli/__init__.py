"""The command line: one command a file, each imported when it is called."""

from __future__ import annotations

import os
import sys
from importlib import import_module

import click

import vopd
from vopd.findings import VopdError

COMMANDS = {
    "run": "run a card deck and print the 1974 listing",
    "attitude": "write the attitude table: CSV, JSON, npz, Parquet, AEM, CZML, KML",
    "plot": "draw attitude, angles of attack, residuals and a frame's image",
    "report": "write one HTML page: summary, pictures, frames, flags, landmarks",
    "check": "look a deck over without running it",
    "cards": "explain a deck card by card",
    "errata": "list the original's known slips",
    "diff": "compare two listings, field by field",
    "stars": "orientation of a camera that sees stars (Rae 1987)",
    "demo": "make a deck of a synthetic flight, with its true attitude",
}
"""Every command and its one line of help; the code is in the module of the same name."""


class _Lazy(click.Group):
    """A group that lists its commands without importing them."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        command: click.Command = import_module(f"vopd.cli.{name}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.group(cls=_Lazy, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(vopd.__version__, prog_name="vopd")
def cli() -> None:
    """Vehicle attitude from the film of one onboard camera.

    Exit status: 0 all well; 1 an input could not be read or a run failed, or a
    comparison found a difference; 2 wrong usage; 3 it ran, but some frame did
    not converge, or was flagged where --strict was asked for.
    """


def main() -> None:
    """Run the command line; what the user can mend is one message and status 1."""
    try:
        sys.exit(cli.main(prog_name="vopd", standalone_mode=False))
    except click.ClickException as error:
        error.show()
        sys.exit(error.exit_code)
    except click.Abort:
        sys.exit(130)
    except BrokenPipeError:  # the reader has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    except VopdError as error:
        click.echo(str(error), err=True)
        sys.exit(1)
    except OSError as error:  # a full disk
        click.echo(f"{error.filename or 'standard output'}: {error.strerror}", err=True)
        sys.exit(1)
