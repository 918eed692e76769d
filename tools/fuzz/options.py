"""Random command lines: the options that a command declares, with likely and unlikely values."""

from __future__ import annotations

from random import Random

import click

from vopd.cli import cli

NUMBERS = [
    "0",
    "1",
    "2",
    "-1",
    "0.5",
    "30",
    "1e-9",
    "1e9",
    "1e308",
    "-1e308",
    "nan",
    "inf",
    "",
    "x",
]
TRIPLES = ["10,20,30", "0,0,0", "nan,0,0", "1e12,1,1", "1e13,0,0", "1,2", "90,90,90", ",,", ""]
PAIRS = ["1,2", "2,1", "1,1", "0,1", "1,99", "1.5,2", "24,24", "0,0", "1e12,-1e12", ""]
FILES = ["out", "out.csv", "out.html", "", "no/out", ".", "-"]
VALUES = {  # by the metavar of an option; the others take NUMBERS
    "NAME": ["all", "restart", "earth", "no-such", ""],
    "TEXT": ["", "UNKNOWN", "=1+1", "<b>&\"'", "ééé", "\udcff", "a\nb", "x" * 300],
    "TIME": ["1974-08-27T17:30:00Z", "0001-01-01", "9999-12-31T23:59:59Z", "now", "1974-02-30", ""],
    "WxH": ["3x2", "9x6", "0x0", "1x1e9", "x", "nanxnan"],
    "O,P,K": TRIPLES,
    "X,Y,Z": TRIPLES,
    "I,J": PAIRS,
    "X,Y": PAIRS,
    "FILE": FILES,
}
FORMATS = ["csv", "jsonl", "npz", "parquet", "aem", "czml", "kml"]
OUTPUTS = {  # names of output files whose suffix says the format
    "attitude": [f"out.{suffix}" for suffix in FORMATS],
    "plot": ["out.png", "out.svg", "out.pdf"],
    "report": ["out.html"],
}
DECK_COMMANDS = {"attitude": 8, "run": 6, "check": 3, "cards": 2, "plot": 1, "report": 1}
"""How often each is drawn; pictures seldom, because they take seconds."""
FLIGHT_COMMANDS = {
    "attitude": 24, "check": 8, "adjust": 8, "punch": 4, "plot": 2, "report": 2, "run": 1,
    "cards": 1,
}  # fmt: skip
WORDS = ["-", "--", "-o", "-x", "--no-such", "--help", "--format", "=", "", ".", "no-such", "ééé"]


def deck_command(deck: str, random: Random, commands: dict[str, int] = DECK_COMMANDS) -> list[str]:
    """Any command that takes a deck or a flight; now and then it is given twice."""
    name = random.choices(list(commands), list(commands.values()))[0]
    return [name, *[deck] * random.choice([1] * 19 + [2]), *options([name], random)]


def misspelt(command: list[str], random: Random) -> list[str]:
    """A command line with a word left out, doubled, moved, cut short or exchanged for another."""
    k = random.randrange(len(command))
    word = command[k]
    new = random.choice((
        [], [word, word], [word[:-1]], [word + "x"], [random.choice(WORDS)], [word, *WORDS[:1]],
        [f"{word}=1"], [random.choice(command)],
    ))  # fmt: skip
    return [*command[:k], *new, *command[k + 1 :]] or ["--version"]


def star_command(file: str, random: Random) -> list[str]:
    """A command that takes a star file."""
    path = ["stars", random.choice(["solve", "solve", "radec"])]
    return [*path, file, "--focal", "76", *options(path, random)]


def other_command(random: Random) -> list[str]:
    """A command that takes no input."""
    if random.random() < 0.7:
        return ["demo", "--frames", "3", *options(["demo"], random)]
    return ["errata", *random.choice(([], ["restart"], ["x"])), *options(["errata"], random)]


def options(path: list[str], random: Random, most: int = 4) -> list[str]:
    """Some options of the command of this name, each with one of its values."""
    command: click.Command = cli
    for name in path:
        assert isinstance(command, click.Group)
        found = command.get_command(click.Context(command), name)
        assert found is not None
        command = found
    declared = [param for param in command.params if isinstance(param, click.Option)]
    chosen = random.sample(declared, random.randint(0, min(most, len(declared))))
    words: list[str] = []
    for option in [*chosen, *(one for one in declared if one.required and one not in chosen)]:
        words.append(random.choice(option.opts))
        if not option.is_flag:
            values = _values(option, path[0])
            words += [random.choice(values) for _ in range(option.nargs)]
    return words


def _values(option: click.Option, command: str) -> list[str]:
    if isinstance(option.type, click.Choice):
        return [*map(str, option.type.choices), "no-such"]
    if option.name == "output" and command in OUTPUTS:
        return OUTPUTS[command]
    return VALUES.get(option.metavar or "", NUMBERS)
