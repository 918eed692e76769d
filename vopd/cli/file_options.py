"""Arguments and options for file names, shared by all commands."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

FILE_NAME = click.Path(readable=False)
"""A name of a file, or `-`. Shells complete it; whether it can be read is seen when it is read."""

decks_argument = click.argument("decks", type=FILE_NAME, metavar="DECK...", nargs=-1, required=True)
"""One deck or several; `-` is standard input."""

sources_argument = click.argument(
    "sources", type=FILE_NAME, metavar="SOURCE...", nargs=-1, required=True
)
"""Flight projects, whose names end in .toml, and decks; `-` is a deck on standard input."""


def output_option(help_text: str, required: bool = False) -> Callable[[Any], Any]:
    """The option `-o FILE`; unless it is required, the default is standard output."""
    needed: dict[str, Any] = {"required": True} if required else {"default": "-"}
    return click.option("-o", "--output", type=FILE_NAME, metavar="FILE", help=help_text, **needed)


def text_or_json_option(help_text: str) -> Callable[[Any], Any]:
    """The option `--format text|json`; the command is given it as `output_format`."""
    return click.option(
        "--format",
        "output_format",
        type=click.Choice(["text", "json"]),
        default="text",
        show_default=True,
        help=help_text,
    )
