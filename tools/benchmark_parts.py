"""The parts of `vopd run` in one process, for benchmark.py: parse, solve, print, each by itself.

    python tools/benchmark_parts.py DECK REPEAT

Prints the seconds of every repetition as JSON. Without a deck it imports what
`vopd run` needs and ends: that is start-up.
"""

from __future__ import annotations

import json
import sys
import time

import vopd.cli.run  # noqa: F401  all that the command imports
from vopd.cards.reader import read_deck
from vopd.listing.pages import pages
from vopd.program.vopd import run


def parts(deck: str, repeat: int) -> dict[str, list[float]]:
    """Seconds of `repeat` runs after one that does not count."""
    seconds: dict[str, list[float]] = {"parse": [], "solve": [], "print": []}
    for _ in range(repeat + 1):
        times = [time.perf_counter()]
        jobs = read_deck(deck)
        times.append(time.perf_counter())
        results = [run(job) for job in jobs]
        times.append(time.perf_counter())
        for one in results:
            for _ in pages(one):
                pass
        times.append(time.perf_counter())
        for name, start, end in zip(seconds, times, times[1:], strict=False):
            seconds[name].append(end - start)
    return {name: all_of[1:] for name, all_of in seconds.items()}


if __name__ == "__main__" and len(sys.argv) > 1:
    print(json.dumps(parts(sys.argv[1], int(sys.argv[2]))))
