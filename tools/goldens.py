"""Write or check the regression listings: what the program itself prints, whole.

    python tools/goldens.py --write
    python tools/goldens.py --check

Only golden_outputs/regression/ is touched. What the reports print is
transcribed by hand and never made here.
"""

from __future__ import annotations

import argparse
import io
import sys
from pathlib import Path

from vopd.batch.deck import run_deck

from vopd.findings import VopdError

ROOT = Path(__file__).parents[1]
GOLDENS = ROOT / "golden_outputs" / "regression"
DECKS = sorted((ROOT / "decks").glob("appendix_h/*.dat")) + sorted(
    (ROOT / "decks").glob("regression/*.dat")
)


def listing(deck: Path) -> bytes:
    """The whole listing of a deck, as far as its run gets."""
    text = io.BytesIO()
    with deck.open("rb") as file:
        try:
            run_deck(file, deck.name, text.write, lambda _: None)
        except VopdError as error:
            print(f"{deck.name}: {error}", file=sys.stderr)
    return text.getvalue()


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
