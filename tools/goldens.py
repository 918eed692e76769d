"""Write or check the regression listings: what the program itself prints, whole.

    python tools/goldens.py --write
    python tools/goldens.py --check

Only golden_outputs/regression/ is touched. What the reports print is
transcribed by hand and never made here. Where a listing differs, the deck is
solved with other sines too: a digit that depends on their last bits is named as
not determined, and is no failure.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from other_sines import low_and_high

from vopd.listing.compare import compare_listings, undetermined_fields
from vopd.listing.pages import end_of_case, pages
from vopd.pipeline import solve_decks
from vopd.results import SolvedJob

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


def is_kept(deck: Path, kept: bytes) -> bool:
    """Whether a deck prints the listing that is kept, up to digits that are not determined."""
    made = listing(deck)
    if made == kept or not kept:
        return made == kept
    name = f"{deck.parent.name}/{deck.stem}.lst"
    low, high = low_and_high(deck)
    if [text.count(b"\n") for text in (low, high)] != [made.count(b"\n")] * 2:
        print(f"differs: {name}: the run of the deck has another end")
        return False
    free = undetermined_fields(low.decode(), high.decode())
    found = compare_listings(kept.decode(), made.decode(), 0, free)
    for difference in found.differences:
        print(f"{name}: {difference}")
    determined = len(found.differences) - found.fields_undetermined
    same_lines = made.count(b"\n") == kept.count(b"\n")
    print(f"{name}: {determined} differ, {found.fields_undetermined} not determined")
    return determined == 0 and len(found.differences) > 0 and same_lines


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--write", action="store_true")
    what.add_argument("--check", action="store_true")
    write = parser.parse_args().write
    stale = []
    for deck in DECKS:
        kept = golden(deck).read_bytes() if golden(deck).exists() else b""
        if listing(deck) != kept if write else not is_kept(deck, kept):
            stale.append(deck)
    for deck in stale:
        if write:
            golden(deck).parent.mkdir(parents=True, exist_ok=True)
            golden(deck).write_bytes(listing(deck))
        print(f"{'written' if write else 'differs'}: {golden(deck).relative_to(ROOT)}")
    return 1 if stale and not write else 0


if __name__ == "__main__":
    sys.exit(main())
