"""The inputs of trials: decks, star files, listings and flights, mostly damaged, some large."""

from __future__ import annotations

import os
from functools import cache
from importlib import import_module
from pathlib import Path
from random import Random
from typing import NamedTuple

from drawn import drawn_project
from flights import damaged_project, long_project, random_project
from mutations import mutate
from options import (
    FLIGHT_COMMANDS,
    deck_command,
    misspelt,
    options,
    other_command,
    star_command,
)
from trial import Trial

from tests.kit.command import vopd
from tests.kit.judge import deck_commands, flight_commands, star_commands

DECKS = Path(__file__).parents[2] / "decks"
SUBJECTS = {
    "deck": 350, "flight": 250, "drawn": 100, "stars": 150, "listing": 50, "options": 90,
    "large": 10,
}  # fmt: skip
"""How often each is drawn, of a thousand."""


class KnownInputs(NamedTuple):
    """Undamaged inputs."""

    decks: list[bytes]
    stars: list[bytes]
    listing: bytes


def known_inputs() -> KnownInputs:
    """The undamaged inputs, after which all that pictures need has been imported."""
    decks = [path.read_bytes() for path in sorted(DECKS.glob("*/*.dat"))]
    for seed, frames, jobs in ((1, 3, 6), (2, 40, 1), (3, 1, 2), (4, 300, 1)):
        asked = f"demo --seed {seed} --frames {frames} --jobs {jobs} --landmarks {seed + 1}"
        decks.append(vopd(*asked.split()).output)
    stars = [path.read_bytes() for path in sorted((DECKS / "stars").iterdir())]
    images = "--image 24,24 --image -15,15 --image 3,-9"
    asked = f"stars radec --focal 76 --attitude 10,20,30 --format csv {images}"
    made = vopd(*asked.split()).output
    stars += [made, made.replace(b"ra_deg", b"ra_hours"), made.replace(b",", b";")]
    hill = DECKS.parent / "examples/hill/flight.toml"
    for command in ("plot", "report"):
        vopd(command, DECKS / "appendix_h/case4.dat", hill, "-o", os.devnull + ".html")
    vopd("check", hill)
    for module in ("pyproj", "gpxpy", "yaml", "pyarrow.parquet"):
        import_module(module)
    return KnownInputs(decks, stars, vopd("run", DECKS / "appendix_h/case4.dat").output)


def make_trial(seed: int, number: int, known: KnownInputs) -> Trial:
    """The files and commands of one trial."""
    random = Random(f"{seed} {number}")
    subject = random.choices(list(SUBJECTS), list(SUBJECTS.values()))[0]
    if subject == "large":
        return large_trial(random, known)
    if subject == "deck":
        deck = mutate(random.choice(known.decks), known.decks, random)
        return deck_trial({"deck.dat": deck}, random)
    if subject == "flight":
        return flight_trial(damaged_project(random), random)
    if subject == "drawn":
        return flight_trial(drawn_project(random), random)
    if subject == "stars":
        return star_trial(mutate(random.choice(known.stars), known.stars, random), random)
    if subject == "listing":
        return listing_trial(known.listing, random)
    files = {"deck.dat": random.choice(known.decks), "stars.csv": random.choice(known.stars)}
    commands = [deck_command("deck.dat", random), star_command("stars.csv", random)]
    commands += [other_command(random), deck_command("flight.toml", random, FLIGHT_COMMANDS)]
    commands += [misspelt(command, random) for command in commands if random.random() < 0.5]
    return Trial(files | random_project(random), commands)


def deck_trial(files: dict[str, bytes], random: Random) -> Trial:
    """Commands for a deck."""
    commands = random.sample(deck_commands("deck.dat")[3:], 2)
    commands += [["check", "deck.dat"], ["run", "deck.dat"], deck_command("deck.dat", random)]
    return Trial(files, commands)


def flight_trial(files: dict[str, bytes], random: Random) -> Trial:
    """Commands for a flight project."""
    commands = flight_commands("flight.toml")[:2]
    commands += [deck_command("flight.toml", random, FLIGHT_COMMANDS)]
    return Trial(files, commands)


def star_trial(stars: bytes, random: Random) -> Trial:
    """Commands for a star file."""
    commands = [*random.sample(star_commands("stars.csv"), 2), star_command("stars.csv", random)]
    return Trial({"stars.csv": stars}, commands)


def listing_trial(listing: bytes, random: Random) -> Trial:
    """Commands for two listings."""
    files = {"one.lst": listing, "other.lst": mutate(listing, [listing], random)}
    return Trial(files, [["diff", *random.sample(list(files), 2), *options(["diff"], random)]])


def large_trial(random: Random, known: KnownInputs) -> Trial:
    """An input of two to ten million bytes, whole or damaged.

    A flight has a tenth of them: it is solved some thirty times where it does not fit.
    """
    size = random.choice((2, 2, 2, 5, 10)) * 1_000_000
    what = random.choice(("deck", "deck", "flight", "stars", "listing"))
    if what == "flight":
        return flight_trial(long_project(size // 10, random), random)
    if what == "stars":
        return star_trial(mutate(long_stars(size), known.stars, random), random)
    if what == "listing":
        return listing_trial(_repeated(known.listing, size), random)
    if random.random() < 0.3:
        return stacked_trial(random, known)
    deck = long_deck(size)
    if random.random() < 0.5:  # most damage ends the reading
        deck = mutate(deck, known.decks, random)
    return Trial({"deck.dat": deck}, [["check", "deck.dat"], deck_command("deck.dat", random)])


def stacked_trial(random: Random, known: KnownInputs) -> Trial:
    """A deck of many tiny jobs, whole or damaged, or one card many times."""
    jobs = 300
    if random.random() < 0.3:
        card = random.choice(random.choice(known.decks).splitlines() or [b""])
        deck = (random.choice((card, b"00009" * 16)) + b"\n") * 20 * jobs
    else:
        deck = stacked_deck(jobs)
    if random.random() < 0.5:
        deck = mutate(deck, known.decks, random)
    commands = [["check", "deck.dat"], ["run", "deck.dat"], deck_command("deck.dat", random)]
    return Trial({"deck.dat": deck}, commands, 2 * jobs)  # damage can make a few of one


@cache
def stacked_deck(jobs: int) -> bytes:
    """A deck of so many jobs of one frame."""
    return vopd("demo", "--frames", "1", "--jobs", str(jobs), "--landmarks", "3").output


@cache
def long_deck(size: int) -> bytes:
    """A deck of one job, of about so many bytes."""
    frame = 2000  # bytes, of three readings of four landmarks and four fiducials
    return vopd("demo", "--frames", str(size // frame), "--landmarks", "4", "--seed", "1").output


@cache
def long_stars(size: int) -> bytes:
    """A star file of about so many bytes."""
    random = Random(size)
    star = ((-60.0, 60.0), (-60.0, 60.0), (0.0, 360.0), (-90.0, 90.0))
    rows = (
        ",".join(f"{random.uniform(*limits):.5f}" for limits in star) for _ in range(size // 38)
    )
    return ("x_mm,y_mm,ra_deg,dec_deg\n" + "\n".join(rows)).encode()


def _repeated(data: bytes, size: int) -> bytes:
    return data * (size // len(data) + 1)
