"""Pages of the documentation that are made from the package's tables: written, or checked."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path


def between(text: str, begin: str, end: str, made: str) -> str:
    """Replace what stands between two marks of a page."""
    before, rest = text.split(begin)
    return f"{before}{begin}{made}{end}{rest.split(end)[1]}"


def write_or_check(page: Path, make: Callable[[str], str], about: str | None) -> int:
    """Write a page by --write, or by --check fail if it is not as it would be made.

    Args:
        page: the page
        make: makes its text of the text that it has
        about: what the tool's help says first
    """
    parser = argparse.ArgumentParser(description=(about or "").splitlines()[0])
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--write", action="store_true")
    what.add_argument("--check", action="store_true")
    is_written = parser.parse_args().write
    old = page.read_text(encoding="utf-8")
    new = make(old)
    if is_written:
        page.write_text(new, encoding="utf-8", newline="\n")
    elif old != new:
        tool = Path(sys.argv[0]).name
        print(f"docs/{page.name} is not current: run tools/{tool} --write", file=sys.stderr)
        return 1
    return 0
