"""Write two listings of a deck between which its numbers lie, for `vopd diff --undetermined`.

    python tools/listing_range.py flight.dat low.lst high.lst

The deck is solved with sines that differ by up to four units in the last place, in eight
ways. Digits that the two listings do not share depend on the computer.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from other_sines import low_and_high


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("deck", type=Path)
    parser.add_argument("low", type=Path)
    parser.add_argument("high", type=Path)
    given = parser.parse_args()
    low, high = low_and_high(given.deck)
    given.low.write_bytes(low)
    given.high.write_bytes(high)


if __name__ == "__main__":
    main()
