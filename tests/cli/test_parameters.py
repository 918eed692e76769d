"""Every argument and option of every command: its names, values, limits and default."""

from __future__ import annotations

from typing import Any

import click
import pytest

from vopd.cli import COMMANDS, cli

SOLVE = """
    --fix NAME text, repeatable
    --ellipsoid wgs84|international1924|clarke1866
    --initial deck|closed-form = deck
    --compare-initial, flag
    --limits-1974, flag
"""
HISTORY = f"""{SOLVE}
    --reading-sigma SIGMA float
    --fiducial-sigma SIGMA float
    --landmark-sigma SIGMA float
    --position-sigma SIGMA float
    --focal-sigma SIGMA float
    --time-sigma SIGMA float
    --velocity-sigma SIGMA float
    --wind-sigma SIGMA float
    --mount-sigma SIGMA float
    --max-rate DEG/S float
    --vertical geodetic|geocentric
    --strict, flag
    -q --quiet, flag
"""
OUTPUT = "-o --output FILE path = -"
METHODS = "collinearity|svd|church|church-weighted|church-weighted-r|two-star|single-rotation|all"
PARAMETERS = {
    "run": f"""
        DECK..., needed
        {OUTPUT}
        --tape10 FILE path
        {SOLVE}
        --strict, flag
        -q --quiet, flag
    """,
    "new": """
        DIR, needed
        --deck DECK path
        --job N 1..
        --wind FILE path
        --images DIR path
        --track FILE path
        --landmarks FILE path
        --picks FILE path
        --lens FILE path
        --gcp FILE path
    """,
    "attitude": f"""
        SOURCE..., needed
        {OUTPUT}
        --format csv|jsonl|npz|parquet|aem|acm|czml|kml|odm|colmap|opk
        --epoch TIME text
        --aem-version 1|2
        --originator TEXT text
        --object-name TEXT text
        --object-id TEXT text
        {HISTORY}
    """,
    "plot": f"""
        SOURCE..., needed
        -o --output FILE path, needed
        --format png|svg|pdf
        --figure all|attitude|attack|residuals|image = all
        --frame N text
        --job N integer
        --size WxH text
        --dpi 20..1200
        {HISTORY}
    """,
    "report": f"""
        SOURCE..., needed
        -o --output FILE path, needed
        {HISTORY}
    """,
    "batch": f"""
        SOURCE...
        -d --directory OUTDIR path, needed
        --manifest FILE path
        --format csv|jsonl|npz|parquet|kml|odm|colmap|opk, repeatable
        --report, flag
        --jobs N 1..1024 = 1
        --shard I/N text
        --dask ADDRESS text
        --shared-filesystem, flag
        --resume, flag
        {HISTORY}
    """,
    "check": f"""
        SOURCE..., needed
        --spread INCHES 0..
        --limits-1974, flag
        --all, flag
        --format text|json = text
        {OUTPUT}
        --strict, flag
        -q --quiet, flag
    """,
    "punch": f"""
        PROJECT, needed
        {OUTPUT}
        --numbers FILE path
        -q --quiet, flag
    """,
    "cards": f"""
        DECK, needed
        --group N text, repeatable
        --card N text, repeatable
        {OUTPUT}
    """,
    "errata": f"""
        [NAME]...
        --program vopd|rae = vopd
        {OUTPUT}
        --format text|json = text
    """,
    "diff": f"""
        EXPECTED, needed
        ACTUAL, needed
        --units N text = 1
        --tolerances, flag
        --undetermined LOW HIGH path, 2 values
        {OUTPUT}
        --format text|json = text
        -q --quiet, flag
    """,
    "stars solve": f"""
        FILE..., needed
        --focal MM text
        --focal-px PX text
        --pitch-um UM text
        --centre X,Y text
        --size W,H text
        --k1 K1 text
        --y-down, flag
        --date UTC text
        --place LAT,LON,H text
        --pressure MBAR text
        --temperature C text
        --mount forward|down|Y,P,R text
        --ephemeris FILE path
        --catalogue FILE path
        --method {METHODS} = collinearity
        --pair I,J text
        --all-pairs, flag
        --reject, flag
        --edit-by-pairs, flag
        --magnitude-limit MAG text
        --weigh-elongation, flag
        --rotation nearest|as-solved = nearest
        --initial svd|two-star|O,P,K text = svd
        --weights uniform|listed|robust = uniform
        --corrections N 1..1000
        --listing, flag
        --cross-products unit|raw = unit
        --rotation-angle farther|mean = farther
        --reading-sigma SIGMA text
        --camera X,Y,Z text
        --free focal,centre,k1 text
        --resection, flag
        --format text|json|csv|jsonl|npz|parquet|aem|czml
        {OUTPUT}
        -q --quiet, flag
    """,
    "stars radec": f"""
        [FILE]
        --focal MM text
        --attitude O,P,K text
        --image X,Y text, repeatable
        --typed, flag
        --format text|json|csv = text
        {OUTPUT}
    """,
    "stars tables": OUTPUT,
    "demo": f"""
        --frames N integer = 24
        --landmarks N integer = 4
        --seed N integer = 0
        --noise IN float = 0.003
        --jobs N integer = 1
        --trajectory-rows N integer = 50
        --swing DEG float = 20.0
        --focal MM float = 10.4
        --frame-size X Y float, 2 values = 14.47 10.457
        {OUTPUT}
        --truth FILE path
    """,
}  # fmt: skip


def end(number: float | None) -> str:
    return "" if number is None else f"{number:g}"


def values(kind: click.ParamType[Any]) -> str:
    if isinstance(kind, click.Choice):
        return "|".join(kind.choices)
    if isinstance(kind, click.IntRange | click.FloatRange):
        return f"{end(kind.min)}..{end(kind.max)}{' open' * (kind.min_open or kind.max_open)}"
    return kind.name


def told(one: click.Parameter) -> str:
    """A parameter as it is written above."""
    if isinstance(one, click.Argument):
        return f"{one.metavar or one.human_readable_name}{', needed' * one.required}"
    assert isinstance(one, click.Option)
    if one.is_flag:
        return f"{' '.join(one.opts)}, flag"
    words = [*one.opts, *([one.metavar] if one.metavar else []), values(one.type)]
    text = " ".join(words)
    text += ", needed" * one.required + ", repeatable" * one.multiple
    text += f", {one.nargs} values" * (one.nargs > 1)
    default = one.to_info_dict()["default"]
    if isinstance(default, tuple):
        default = " ".join(map(str, default)) or None
    return text if default is None or one.required else f"{text} = {default}"


@pytest.mark.parametrize("name", PARAMETERS)
def test_every_argument_and_option(name: str) -> None:
    command: Any = cli
    context = click.Context(cli)
    for word in name.split():
        command = command.get_command(context, word)
    expected = [line.strip() for line in PARAMETERS[name].splitlines() if line.strip()]
    assert sorted(map(told, command.params)) == sorted(expected)


def test_every_command_is_above() -> None:
    assert [*COMMANDS] == [
        "run", "cards", "diff", "errata", "demo", "new", "punch", "check", "attitude", "plot",
        "report", "batch", "stars",
    ]  # fmt: skip
    assert {name.split()[0] for name in PARAMETERS} == {*COMMANDS}
