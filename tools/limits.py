"""Write or check the limits of input files in docs/promises.md, of constants and their comments.

python tools/limits.py --write
python tools/limits.py --check
"""

from __future__ import annotations

import re
import sys
from importlib import import_module
from pathlib import Path

from made_page import between, write_or_check

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "promises.md"
BEGIN, END = "<!-- limits of vopd/inputs.py -->\n", "<!-- end of limits -->\n"
ELSEWHERE = (
    ("cards.deck", "LONGEST_LINE"),
    ("batch.sources", "LONGEST_NAME"),
    ("flight.formats.image_tags", "MOST_PIXELS"),
    ("flight.coordinates", "LONGEST_CRS"),
    ("flight.formats.lens", "MOST"),
    ("stellar.sky", "MOST_CATALOGUE"),
    ("findings", "LONGEST_MESSAGE"),
)
LIMIT = re.compile(r"(?m)^([A-Z_]+) = [\d_< ]+  # (.+)$")


def limits(name: str) -> dict[str, str]:
    """Read the numbers of a module that have a comment, as rows of a table."""
    module = import_module(f"vopd.{name}")
    found = LIMIT.findall(Path(module.__file__ or "").read_text(encoding="utf-8"))
    return {one: f"| {getattr(module, one):,} | {comment} |\n" for one, comment in found}


def page(text: str) -> str:
    """Write the rows of the table into the page."""
    rows = list(limits("inputs").values())
    rows += [limits(module)[name] for module, name in ELSEWHERE]
    return between(text, BEGIN, END, "\n| at most | of what |\n|---|---|\n" + "".join(rows) + "\n")


if __name__ == "__main__":
    sys.exit(write_or_check(PAGE, page, __doc__))
