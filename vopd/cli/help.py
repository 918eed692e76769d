"""`vopd help`: the pages of the documentation, which the package brings along."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from pathlib import Path

import click

import vopd
from vopd.findings import nearest_word
from vopd.screen import aligned

PACKAGE = Path(vopd.__file__).parent
PLACES = (PACKAGE / "docs", PACKAGE.parent / "docs")  # of an installed package, and of a checkout


def pages() -> dict[str, Path]:
    """List the pages by name."""
    folder = next((one for one in PLACES if (one / "README.md").exists()), PLACES[0])
    return {one.stem: one for one in sorted(folder.glob("*.md")) if one.stem != "README"}


def page_of(command: str, every: Mapping[str, Path]) -> str | None:
    """Look up the page of a command in the table of commands; None if there is none."""
    text = every["command-line"].read_text(encoding="utf-8")
    row = re.search(rf"^\| `vopd {re.escape(command)}[ `].*?\]\(([\w-]+)\.md", text, re.M)
    return row[1] if row else None


def _complete(ctx: click.Context, argument: click.Parameter, begun: str) -> list[str]:
    return [name for name in pages() if name.startswith(begun)]


@click.command("help")
@click.argument("page", required=False, shell_complete=_complete)
def command(page: str | None) -> None:
    """Show a page of the documentation, or list the pages.

    \b
    Examples:
        vopd help
        vopd help flight-project
        vopd help track

    PAGE may also be a command: its page is shown. Options are listed by the command
    itself: vopd attitude --help.

    Exit status: 0; 2 there is no such page.
    """
    every = pages()
    if page is None:
        rows = [[name, _title(path)] for name, path in every.items()]
        click.echo("\n".join(aligned(rows, {0, 1})))
        return
    name = page.removeprefix("docs/").removesuffix(".md")
    name = name if name in every else page_of(name, every) or name
    if name not in every:
        near = nearest_word(name, every)
        hint = f"did you mean {near[0]}?" if near else f"there are: {', '.join(every)}"
        raise click.UsageError(f"no page {page!r}; {hint}")
    text = every[name].read_text(encoding="utf-8")
    (click.echo_via_pager if sys.stdout.isatty() else click.echo)(text)


def _title(path: Path) -> str:
    found = re.search(r"^# (.+)$", path.read_text(encoding="utf-8"), re.M)
    return found[1] if found else ""
