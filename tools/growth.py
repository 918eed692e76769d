"""Sweep over sizes: processor time or memory that grows by more than the input does.

    python tools/growth.py
    python tools/growth.py --only landmarks

Each command runs on a small input, which tells its start-up, and on one of a size and of four
times that size. What is above the start-up may grow with the size to the power `MOST` at most:
1 is linear. Exit status 1 where something grows faster.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable
from math import log
from pathlib import Path
from typing import NamedTuple

import sized
from benchmark import VOPD, Cost, measured

MOST = 1.25
LEAST_S, LEAST_MB = 0.1, 20.0  # above the start-up: less is noise, and has no power
SMALL, TIMES = 20, 4
RUNS = 3  # of each the quickest counts


class Sweep(NamedTuple):
    """An input that grows, and the commands that read it; {} is the input."""

    what: str
    size: int
    sizes: Callable[[int], tuple[int, ...]]  # as the function of tools/sized.py takes them
    commands: tuple[str, ...]


STARS = "stars solve {} --focal 76 -q -o stars.json"
SWEEPS = {
    "frames": Sweep("deck", 4000, lambda n: (n,), ("check {}", "run {} -q -o lst",
                                                   "attitude {} -q -o out.csv")),
    "jobs": Sweep("jobs", 250, lambda n: (n,), ("check {}", "run {} -q -o lst",
                                                "attitude {} -q -o out.csv")),
    "picks": Sweep("flight", 2500, lambda n: (n,), ("check {}", "attitude {} -q -o out.csv")),
    "frames of a flight that misfits": Sweep("misfit", 500, lambda n: (n,), (
        "check {}", "attitude {} -q -o out.csv")),
    "landmarks": Sweep("flight", 50_000, lambda n: (100, n),
                       ("check {}", "attitude {} -q -o out.csv")),
    "rows of track": Sweep("flight", 25_000, lambda n: (100, 0, n),
                           ("check {}", "attitude {} -q -o out.csv")),
    "photographs": Sweep("photographs", 250, lambda n: (n, 30), (STARS,)),
    "stars of a photograph": Sweep("photographs", 1200, lambda n: (1, n), (STARS,)),
    "pages": Sweep("listing", 2000, lambda n: (n,), ("diff {} {}",)),
}  # fmt: skip


def power(least: float, costs: list[float]) -> float | None:
    """Find the power of the size with which a cost grows; None if it is too small to tell."""
    small, one, four = costs
    if four - small < least:
        return None
    return log((four - small) / max(one - small, least / TIMES)) / log(TIMES)


def main() -> int:
    """Run the sweeps; return the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--only", choices=SWEEPS)
    only = parser.parse_args().only
    print("| input | command | small | one size | four times | power of time, memory |")
    print("|---|---|---|---|---|---|")
    grows = False
    for name, sweep in SWEEPS.items() if not only else [(only, SWEEPS[only])]:
        sizes = (SMALL, sweep.size, TIMES * sweep.size)
        with tempfile.TemporaryDirectory() as directory:
            folder = Path(directory)
            inputs = [sized.made(sweep.what, folder / f"{n}.in", *sweep.sizes(n)) for n in sizes]
            for command in sweep.commands:
                costs = [_quickest(command.replace("{}", str(one)), folder) for one in inputs]
                powers = (
                    power(LEAST_S, [one.seconds for one in costs]),
                    power(LEAST_MB, [one.peak_mb for one in costs]),
                )
                grows |= any(one is not None and one > MOST for one in powers)
                shown = " | ".join(f"{one.seconds:.2f} s, {one.peak_mb:.0f} MB" for one in costs)
                told = ", ".join("-" if one is None else f"{one:.2f}" for one in powers)
                title = f"{sizes[1]:,} {name} | `{command.partition(' {}')[0]}`"
                print(f"| {title} | {shown} | {told} |", flush=True)
    return int(grows)


def _quickest(command: str, folder: Path) -> Cost:
    runs = [measured((*VOPD, *command.split()), folder) for _ in range(RUNS)]
    return min(runs, key=lambda one: one.seconds)


if __name__ == "__main__":
    sys.exit(main())
