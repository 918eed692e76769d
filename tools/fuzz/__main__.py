"""Damaged inputs and unlikely options for every command, until time is up.

Run `python tools/fuzz --seconds 60 --seed 1` from the root of the checkout; the
exit status is 1 where a failure was found. A trial is made of the seed and its
number alone, so `--seed 1 --trial 57` repeats it; of several seeds each has its turn.
With --keep, the smallest input of every kind of failure is written to a folder; what
was mended belongs into tests/robustness/.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from pathlib import Path
from random import Random

os.environ["OPENBLAS_NUM_THREADS"] = "1"  # children are forked: no threads before that
ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT))

from inputs import known_inputs, make_trial  # noqa: E402
from minimise import minimise  # noqa: E402
from streams import process_failures  # noqa: E402
from trial import Trial, failures_of, kind, write  # noqa: E402

PROCESS_EVERY = 12  # a process takes as long as several trials


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, nargs="+", default=[1], help="taken in turn")
    parser.add_argument("--trial", type=int, help="only this one")
    parser.add_argument("--keep", type=Path, help="a folder for the inputs of failures")
    given = parser.parse_args()
    known = known_inputs()
    begun = time.monotonic()
    until = begun + given.seconds
    seen: dict[str, int] = {}
    number = given.trial or 0
    done = 0
    while time.monotonic() < until and (given.trial is None or not done):
        seed = given.seed[done % len(given.seed)]
        trial = make_trial(seed, number, known)
        failures = [(failure, "") for failure in failures_of(trial)]
        if number % PROCESS_EVERY == 0:
            said, more = process_failures(trial, Random(f"process {seed} {number}"))
            failures += [(failure, said) for failure in more]
        for failure, said in failures:
            seen[kind(failure)] = seen.get(kind(failure), 0) + 1
            if seen[kind(failure)] == 1:
                print(f"--seed {seed} --trial {number}: {failure} {said}", flush=True)
                if given.keep is not None:
                    keep(given.keep, f"{seed}-{number:06d}", trial, failure, said)
        done += 1
        number += done % len(given.seed) == 0
    found = f"{sum(seen.values())} failures of {len(seen)} kinds" if seen else "no failure"
    seeds = ", ".join(map(str, given.seed))
    print(f"seed {seeds}: {done} trials in {time.monotonic() - begun:.0f} s, {found}")
    return 1 if seen else 0


def keep(folder: Path, name: str, trial: Trial, failure: str, said: str) -> None:
    """Write a failure's input, made small where the failure is not one of a process."""
    small = trial if said else minimise(trial, kind(failure))
    place = folder / f"{name}-{len(list(folder.glob('*'))) if folder.exists() else 0}"
    place.mkdir(parents=True)
    for name, data in small.files.items():
        write(place / name, data)
    story = {"failure": failure, "process": said, "commands": small.commands}
    (place / "failure.json").write_text(json.dumps(story, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
