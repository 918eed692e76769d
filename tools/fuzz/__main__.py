"""Damaged inputs and unlikely options for every command, until time is up.

Run `python tools/fuzz --seconds 60 --seed 1` from the root of the checkout; the
exit status is 1 where a fault was found. A trial is made of the seed and its
number alone, so `--seed 1 --trial 57` repeats it. With --keep, the smallest input
of every kind of fault is written to a folder; what was mended belongs into
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

from minimise import minimise  # noqa: E402
from mutations import mutate  # noqa: E402
from options import deck_command, options, other_command, star_command  # noqa: E402
from streams import process_faults  # noqa: E402
from trial import Trial, faults_of, kind  # noqa: E402

from tests.kit.command import vopd  # noqa: E402
from tests.kit.judge import deck_commands, star_commands  # noqa: E402

PROCESS_EVERY = 12  # a process takes as long as several trials


def make_trial(
    seed: int, number: int, decks: list[bytes], stars: list[bytes], listing: bytes
) -> Trial:
    """The files and commands of one trial."""
    random = Random(f"{seed} {number}")
    subject = random.choices(["deck", "stars", "listing", "options"], [70, 15, 5, 10])[0]
    deck, star = random.choice(decks), random.choice(stars)
    if subject == "deck":
        commands = random.sample(deck_commands("deck.dat")[3:], 2)
        commands += [["check", "deck.dat"], ["run", "deck.dat"], deck_command("deck.dat", random)]
        return Trial({"deck.dat": mutate(deck, decks, random)}, commands)
    if subject == "stars":
        commands = [
            *random.sample(star_commands("stars.csv"), 2),
            star_command("stars.csv", random),
        ]
        return Trial({"stars.csv": mutate(star, stars, random)}, commands)
    if subject == "listing":
        files = {"one.lst": listing, "other.lst": mutate(listing, [listing], random)}
        command = ["diff", *random.sample(list(files), 2), *options(["diff"], random)]
        return Trial(files, [command])
    files = {"deck.dat": deck, "stars.csv": star}
    commands = [deck_command("deck.dat", random), star_command("stars.csv", random)]
    return Trial(files, [*commands, other_command(random)])


def inputs() -> tuple[list[bytes], list[bytes], bytes]:
    """The undamaged inputs: decks, star files and a listing."""
    decks = [path.read_bytes() for path in sorted((ROOT / "decks").glob("*/*.dat"))]
    for seed, frames, jobs in ((1, 3, 6), (2, 40, 1), (3, 1, 2), (4, 300, 1)):
        asked = f"demo --seed {seed} --frames {frames} --jobs {jobs} --landmarks {seed + 1}"
        decks.append(vopd(*asked.split()).output)
    stars = [path.read_bytes() for path in sorted((ROOT / "decks" / "stars").iterdir())]
    pictures = ["plot", "report"]  # what they import is imported once, for all children
    for command in pictures:
        vopd(command, ROOT / "decks/appendix_h/case4.dat", "-o", os.devnull + ".html")
    return decks, stars, vopd("run", ROOT / "decks/appendix_h/case4.dat").output


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--trial", type=int, help="only this one")
    parser.add_argument("--keep", type=Path, help="a folder for the inputs of faults")
    given = parser.parse_args()
    known = inputs()
    until = time.monotonic() + given.seconds
    seen: dict[str, int] = {}
    number = given.trial or 0
    while time.monotonic() < until:
        trial = make_trial(given.seed, number, *known)
        faults = [(fault, "") for fault in faults_of(trial)]
        if number % PROCESS_EVERY == 0:
            said, more = process_faults(trial, Random(f"process {given.seed} {number}"))
            faults += [(fault, said) for fault in more]
        for fault, said in faults:
            seen[kind(fault)] = seen.get(kind(fault), 0) + 1
            if seen[kind(fault)] == 1:
                print(f"--seed {given.seed} --trial {number}: {fault} {said}", flush=True)
                if given.keep is not None:
                    keep(given.keep, number, trial, fault, said)
        number += 1
        if given.trial is not None:
            break
    done = 1 if given.trial is not None else number
    print(f"seed {given.seed}: {done} trials, {sum(seen.values())} faults of {len(seen)} kinds")
    return 1 if seen else 0


def keep(folder: Path, number: int, trial: Trial, fault: str, said: str) -> None:
    """Write a fault's input, made small where the fault is not one of a process."""
    small = trial if said else minimise(trial, kind(fault))
    place = folder / f"{number:06d}-{len(list(folder.glob('*'))) if folder.exists() else 0}"
    place.mkdir(parents=True)
    for name, data in small.files.items():
        (place / name).write_bytes(data)
    story = {"fault": fault, "process": said, "commands": small.commands}
    (place / "fault.json").write_text(json.dumps(story, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
