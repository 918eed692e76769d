"""Write or check the regression listings: what the program itself prints, whole.

    python tools/goldens.py --write
    python tools/goldens.py --check

Only golden_outputs/regression/ is touched. What the reports print is
transcribed by hand and never made here.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from vopd.listing.pages import end_of_case, pages
from vopd.pipeline import solve_decks
from vopd.solved import SolvedJob

ROOT = Path(__file__).parents[1]
GOLDENS = ROOT / "golden_outputs" / "regression"
DECKS = sorted((ROOT / "decks").glob("appendix_h/*.dat")) + sorted(
    (ROOT / "decks").glob("regression/*.dat")
)


def listing(deck: Path) -> bytes:
    """The whole listing of a deck, as far as its run gets."""
    text = b""
    for one in solve_decks([str(deck)]):
        if isinstance(one, SolvedJob):
            text += b"".join(pages(one.results))
        elif one.error is not None:
            print(f"{deck.name}: {one.error}", file=sys.stderr)
        else:
            text += end_of_case()
    return text


def golden(deck: Path) -> Path:
    """Where the listing of a deck is kept."""
    return GOLDENS / deck.parent.name / f"{deck.stem}.lst"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--write", action="store_true")
    what.add_argument("--check", action="store_true")
    write = parser.parse_args().write
    stale = [d for d in DECKS if not golden(d).exists() or golden(d).read_bytes() != listing(d)]
    for deck in stale:
        if write:
            golden(deck).parent.mkdir(parents=True, exist_ok=True)
            golden(deck).write_bytes(listing(deck))
        print(f"{'written' if write else 'differs'}: {golden(deck).relative_to(ROOT)}")
    return 1 if stale and not write else 0


if __name__ == "__main__":
    sys.exit(main())
