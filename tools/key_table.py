"""Write or check the table of keys in docs/flight-project.md, which is made from the package's.

python tools/key_table.py --write
python tools/key_table.py --check
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from made_page import between, write_or_check

from vopd.flight.project.keys import KEYS, Key, keys_of
from vopd.inputs import MOST_NUMBER

PAGE = Path(__file__).parents[1] / "docs" / "flight-project.md"
BEGIN, END = "<!-- keys -->\n", "<!-- end of keys -->"
VALUES = {
    "text": "text",
    "texts": "list of texts",
    "file": "file",
    "files": "file, or list of files",
    "number": "number",
    "numbers": "list of numbers",
    "size": "list of 2 numbers",
    "sigma": 'number from 0, `"exact"`',
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
        text = f"{text} or list of {key.size}"
    if key.above is not None:
        text = f"{text} above {key.above:g}"
    if key.within < MOST_NUMBER and key.kind == "sigma":
        text = text.replace("from 0", f"from 0 to {key.within:g}")
    elif key.within < MOST_NUMBER:
        text = f"{text}, {-key.within:g} to {key.within:g}"
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


if __name__ == "__main__":
    sys.exit(write_or_check(PAGE, lambda text: between(text, BEGIN, END, table()), __doc__))
