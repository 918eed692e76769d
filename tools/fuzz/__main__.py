"""Damaged inputs and unlikely options for every command, until time is up.

Run `python tools/fuzz --seconds 60 --seed 1` from the root of the checkout; the
exit status is 1 where a failure was found. A trial is made of the seed and its
number alone, so `--seed 1 --trial 57` repeats it. With --keep, the smallest input
of every kind of failure is written to a folder; what was mended belongs into
tests/robustness/.
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
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--trial", type=int, help="only this one")
    parser.add_argument("--keep", type=Path, help="a folder for the inputs of failures")
    given = parser.parse_args()
    known = known_inputs()
    until = time.monotonic() + given.seconds
    seen: dict[str, int] = {}
    number = given.trial or 0
    while time.monotonic() < until:
        trial = make_trial(given.seed, number, known)
        failures = [(failure, "") for failure in failures_of(trial)]
        if number % PROCESS_EVERY == 0:
            said, more = process_failures(trial, Random(f"process {given.seed} {number}"))
            failures += [(failure, said) for failure in more]
        for failure, said in failures:
            seen[kind(failure)] = seen.get(kind(failure), 0) + 1
            if seen[kind(failure)] == 1:
                print(f"--seed {given.seed} --trial {number}: {failure} {said}", flush=True)
                if given.keep is not None:
                    keep(given.keep, number, trial, failure, said)
        number += 1
        if given.trial is not None:
            break
    done = 1 if given.trial is not None else number
    print(f"seed {given.seed}: {done} trials, {sum(seen.values())} failures of {len(seen)} kinds")
    return 1 if seen else 0


def keep(folder: Path, number: int, trial: Trial, failure: str, said: str) -> None:
    """Write a failure's input, made small where the failure is not one of a process."""
    small = trial if said else minimise(trial, kind(failure))
    place = folder / f"{number:06d}-{len(list(folder.glob('*'))) if folder.exists() else 0}"
    place.mkdir(parents=True)
    for name, data in small.files.items():
        write(place / name, data)
    story = {"failure": failure, "process": said, "commands": small.commands}
    (place / "failure.json").write_text(json.dumps(story, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
