"""The command line: one command a file, each imported when it is called."""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import TYPE_CHECKING, Any, NoReturn

import click

import vopd
from vopd.cli.console import ReaderGone, at_the_boundary
from vopd.cli.options import GroupOfCommands
from vopd.findings import nearest_word

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

GROUPS = {
    "Decks of cards": {
        "run": "run a card deck and print the 1974 listing",
        "cards": "explain a deck card by card",
        "diff": "compare two listings field by field",
        "errata": "list the known errata of the originals",
        "demo": "make a deck of a synthetic flight, with its true attitude",
    },
    "Frames of a camera, decks, stars": {
        "new": "start a flight project, from your files or as an example",
        "pick": "make a page for clicking landmarks in frames",
        "track": "follow clicked landmarks through a video",
        "punch": "write a flight as a deck of 1974 cards",
        "check": "check flights and decks for errors and doubtful values",
        "attitude": "write the attitude table: CSV, JSON, Parquet, AEM, CZML, KML, ...",
        "adjust": "solve for lens, clock and landmarks with all frames together",
        "plot": "draw attitude, angles of attack, residuals and a frame's image",
        "report": "write one HTML page: summary, pictures, frames, flags, landmarks",
        "batch": "solve many decks and flights into one folder",
        "stars": "solve the orientation of a camera that sees stars (Rae 1987)",
        "help": "show a page of the documentation",
    },
}
"""Every command and its one line of help, by what its input is."""
COMMANDS = {name: text for group in GROUPS.values() for name, text in group.items()}
"""All commands; the code of each is in the module of the same name."""


class Commands(GroupOfCommands):
    """The commands of `vopd`, each imported when it is called, behind one error boundary."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        command: click.Command = import_module(f"vopd.cli.{name}").command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        mistyped = args and args[0] not in COMMANDS and not args[0].startswith("-")
        if mistyped and not ctx.resilient_parsing:  # a shell that completes wants no message
            near = nearest_word(args[0], COMMANDS)
            hint = f"Did you mean {near[0]!r}?" if near else f"There are: {', '.join(COMMANDS)}."
            ctx.fail(f"No such command {args[0]!r}. {hint}")
        return super().resolve_command(ctx, args)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem]:
        """Complete a command or an option; no command is imported for it."""
        from click.shell_completion import CompletionItem

        names = [name for name in COMMANDS if name.startswith(incomplete)]
        commands = [CompletionItem(name, help=COMMANDS[name]) for name in names]
        return commands + click.Command.shell_complete(self, ctx, incomplete)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands by groups, without blank lines: help and a prompt fit 24 lines."""
        width = max(map(len, COMMANDS)) + 2
        for title, commands in GROUPS.items():
            formatter.write(f"{title}:\n")
            formatter.write("".join(f"  {n:{width}}{text}\n" for n, text in commands.items()))

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands alone; the two options stand in the line of usage."""
        self.format_commands(ctx, formatter)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the chosen command; without this, click would end a closed pipe with status 1."""
        if "SOURCE_DATE_EPOCH" in os.environ:  # which numpy reads while it is imported
            from vopd.export import created_now

            created_now()
            if not os.environ["SOURCE_DATE_EPOCH"]:
                del os.environ["SOURCE_DATE_EPOCH"]
        try:
            return super().invoke(ctx)
        except BrokenPipeError as error:
            raise ReaderGone from error

    def main(self, *args: Any, **options: Any) -> NoReturn:
        """Run the command line and end the process with its exit status."""
        options |= {"prog_name": "vopd", "standalone_mode": False}
        sys.exit(at_the_boundary(lambda: super(Commands, self).main(*args, **options)))


@click.group(
    cls=Commands,
    context_settings={"help_option_names": ["-h", "--help"]},
    options_metavar="[--version] [-h | --help]",
)
@click.version_option(vopd.__version__, prog_name="vopd")
def cli() -> None:
    """
    \b
    Attitude of a vehicle or a camera from landmarks in its images.
    Exit status: 0 all well; 1 failed, listings differ; 2 wrong usage; 3 doubtful.
    """
