"""Random command lines: options of every command with likely and unlikely values."""

from __future__ import annotations

from random import Random

NUMBERS = ["0", "1", "-1", "0.5", "30", "1e-9", "1e9", "1e308", "-1e308", "nan", "inf", "", "x"]
FIXES = ["all", "restart", "earth", "no-such", ""]
TEXTS = ["", "UNKNOWN", "=1+1", "<b>&\"'", "é" * 3, "\udcff", "a\nb", "x" * 300]
TIMES = ["1974-08-27T17:30:00Z", "0001-01-01", "9999-12-31T23:59:59Z", "now", "1974-02-30", ""]
TRIPLES = ["10,20,30", "0,0,0", "nan,0,0", "1e12,1,1", "1e13,0,0", "1,2", "90,90,90", ",,", ""]
PAIRS = ["1,2", "2,1", "1,1", "0,1", "1,99", "1.5,2", "24,24", "0,0", "1e12,-1e12", ""]

FLAG: list[str] = []
SOLVE = {
    "--fix": FIXES, "--ellipsoid": ["wgs84", "clarke1866", "no"], "--initial": ["closed-form"],
    "--compare-initial": FLAG, "--limits-1974": FLAG, "--strict": FLAG, "-q": FLAG,
}  # fmt: skip
SIGMAS = ("reading", "landmark", "position", "focal", "time")
HISTORY = SOLVE | {f"--{name}-sigma": NUMBERS for name in SIGMAS} | {"--max-rate": NUMBERS}
SUFFIXES = ["csv", "jsonl", "npz", "parquet", "aem", "czml", "kml"]
ATTITUDE = HISTORY | {
    "--format": SUFFIXES, "-o": [f"out.{suffix}" for suffix in SUFFIXES], "--epoch": TIMES,
    "--aem-version": ["1", "2"], "--originator": TEXTS, "--object-name": TEXTS,
    "--object-id": TEXTS,
}  # fmt: skip
PLOT = HISTORY | {
    "--plot": ["all", "attitude", "attack", "residuals", "image"], "--frame": NUMBERS,
    "--job": NUMBERS, "--size": ["3x2", "9x6", "0x0", "1x1e9", "x", "nanxnan"],
    "--dpi": ["20", "150", "1200", "0"],
}  # fmt: skip
STARS = {
    "--focal": NUMBERS, "--pair": PAIRS, "--all-pairs": FLAG, "--initial": TRIPLES,
    "--method": ["collinearity", "church", "church-weighted", "two-star", "single-rotation", "all"],
    "--weights": ["uniform", "listed", "robust"], "--corrections": ["0", "1", "4", "1000", "x"],
    "--cross-products": ["unit", "raw"], "--reading-sigma": NUMBERS, "--camera": TRIPLES,
    "--format": ["text", "json", "csv"], "-o": ["out.txt"],
}  # fmt: skip
RADEC = {
    "--focal": NUMBERS, "--attitude": TRIPLES, "--image": PAIRS, "--typed": FLAG,
    "--format": ["text", "json", "csv"], "-o": ["out.txt"],
}  # fmt: skip
DEMO = {
    "--frames": ["1", "2", "0", "40", "x"], "--landmarks": ["1", "2", "3", "99", "100"],
    "--seed": ["0", "7", "999999999", "-1"], "--noise": NUMBERS, "--jobs": ["1", "2", "9", "0"],
    "--trajectory-rows": ["2", "3", "9999", "1"], "--swing": NUMBERS, "--focal": NUMBERS,
    "--truth": ["truth.csv", "-", "out.dat"], "-o": ["out.dat", "", "no/out", "."],
}  # fmt: skip
RUN = SOLVE | {"-o": ["listing", "", "no/listing", "."], "--tape10": ["tape", "listing", "-"]}
CHECK = {"--spread": NUMBERS, "--limits-1974": FLAG, "--format": ["text", "json", "x"]}
CARDS = {"--group": ["1", "12", "13", "basic", "", "x"], "--card": ["1", "2-1", "1-999999", "0"]}
DIFF = {"--units": [*NUMBERS, "1/3", "1e999999"], "--format": ["text", "json"], "-q": FLAG}
ERRATA = {"--program": ["vopd", "rae", "x"], "--format": ["text", "json"], "-o": ["out.txt"]}


def options(table: dict[str, list[str]], random: Random, most: int = 4) -> list[str]:
    """Some options of a table, each with one of its values."""
    chosen: list[str] = []
    for name in random.sample(list(table), random.randint(0, min(most, len(table)))):
        chosen += [name, random.choice(table[name])] if table[name] else [name]
    return chosen


def deck_command(deck: str, random: Random) -> list[str]:
    """Any command that takes a deck; pictures seldom, because they take seconds."""
    kind = random.choices(
        ["attitude", "run", "check", "cards", "plot", "report"], [8, 6, 3, 2, 1, 1]
    )[0]
    if kind == "plot":
        return [
            "plot",
            deck,
            "-o",
            random.choice(["p.png", "p.svg", "p.pdf"]),
            *options(PLOT, random),
        ]
    if kind == "report":
        return ["report", deck, "-o", "report.html", *options(HISTORY, random)]
    tables = {"attitude": ATTITUDE, "run": RUN, "check": CHECK, "cards": CARDS}
    return [kind, deck, *options(tables[kind], random)]


def star_command(file: str, random: Random) -> list[str]:
    """A command that takes a star file."""
    if random.random() < 0.3:
        return ["stars", "radec", file, *options(RADEC, random)]
    return ["stars", "solve", file, "--focal", "76", *options(STARS, random)]


def other_command(random: Random) -> list[str]:
    """A command that takes no input."""
    if random.random() < 0.7:
        return ["demo", "--frames", "3", *options(DEMO, random)]
    return ["errata", *random.choice(([], ["restart"], ["x"])), *options(ERRATA, random)]
