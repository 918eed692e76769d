"""Write or check the table of keys in docs/flight-project.md, which is made from the package's.

python tools/key_table.py --write
python tools/key_table.py --check
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from vopd.flight.project import KEYS, Key, keys_of

PAGE = Path(__file__).parents[1] / "docs" / "flight-project.md"
BEGIN, END = "<!-- keys -->\n", "<!-- end of keys -->"
VALUES = {
    "text": "text",
    "texts": "list of texts",
    "file": "file",
    "number": "number",
    "numbers": "list of numbers",
    "sigma": "number from 0",
    "date": "date and time",
    "other": "list",
}
"""A value in words, by its kind."""


def value(key: Key) -> str:
    """Describe the values that a key may have, and its default."""
    default = "" if key.default in (None, "") else json.dumps(key.default)
    if key.choices:
        texts = [json.dumps(one) for one in key.choices]
        return ", ".join(f"`{one}`{' (default)' * (one == default)}" for one in texts) + _table(key)
    text = VALUES[key.kind]
    if key.kind == "numbers" and key.size:
        text = f"list of {key.size} numbers"
    if key.kind == "sigma" and key.size > 1:
        text = f"{text}, or list of {key.size}"
    if key.above is not None:
        text = f"{text} above {key.above:g}"
    return text + _table(key) + (f"; default {default}" if default else "")


def _table(key: Key) -> str:
    return " or a table" if keys_of(f"{key.section}.{key.name}") else ""


def table() -> str:
    """Tabulate all keys in Markdown."""
    rows, section = ["| section, key | value | what it is |", "|---|---|---|"], ""
    for key in KEYS:
        own, _, inside = key.section.partition(".")
        name = f"`{inside}.{key.name}`" if inside else f"`{key.name}`"
        if own != section:
            section, name = own, f"`[{own}]` {name}"
        rows.append(f"| {name} | {value(key)} | {key.about or key.comment} |")
    return "\n".join([*rows, ""])


def main() -> int:
    """Put the table into the page, or compare it with the page's."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--write", action="store_true")
    what.add_argument("--check", action="store_true")
    before, rest = PAGE.read_text(encoding="utf-8").split(BEGIN)
    old, after = rest.split(END)
    if parser.parse_args().write:
        PAGE.write_text(f"{before}{BEGIN}{table()}{END}{after}", encoding="utf-8", newline="\n")
        return 0
    if old == table():
        return 0
    print("docs/flight-project.md: run tools/key_table.py --write", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
