"""How often the truth lies inside the stated uncertainty: the tables of docs/coverage.md.

    python -m tools.coverage --write [--part P] [--cells TEXT ...] [--landmarks N ...] [--seed N]
                             [--processes N] [--results FILE]

Films and flights whose truth is known are simulated apart from the package, with random
errors, and solved; `--cells TEXT` takes the rows whose names have the text, `--part .1` a tenth
of the jobs. Each cell that is counted is added to a file, coverage.jsonl, and not counted again:
an interrupted count goes on where it was; delete the file to begin anew. `--write` puts the rows
that the file has into docs/coverage.md, the others stay; without it the tables go to standard
output. A cell is the share of frames whose truth lies inside the 95 % interval and, in brackets,
inside one standard deviation; it has an asterisk where it is outside its limits by more than chance
allows in 999 of 1,000 counts.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import sys
import time
import zlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tests.kit.coverage import (
    ATTACK,
    ETA,
    LANDMARKS,
    REST,
    ROWS,
    VEHICLE,
    Array,
    Count,
    Row,
    counted,
    share,
)
from tests.kit.flag_trials import TRIALS, Rates, Trial, rates
from tests.kit.flight_blunders import BLUNDER_ROWS, BlunderRow, blunders_named
from tests.kit.flight_coverage import FLIGHT_ROWS, FlightRow, flight_counted
from tests.kit.flight_mistakes import MISTAKE_ROWS, MistakeRow, mistakes_named
from tests.kit.flight_parameters import (
    PARAMETER_ROWS,
    PARAMETERS,
    ParameterRow,
    parameters_counted,
)
from tools.made_page import between
from vopd.findings import VopdError

PAGE = Path(__file__).parents[1] / "docs" / "coverage.md"
FILM_95, BEYOND_68 = (0.93, 0.97), (-0.013, 0.017)
PARAMETER_95 = (0.925, 0.975)
CONFIDENCE = 0.999
SEED = 12

AnyRow = Row | FlightRow | MistakeRow | BlunderRow | ParameterRow | Trial
ALL_ROWS: tuple[AnyRow, ...] = (
    *FLIGHT_ROWS, *MISTAKE_ROWS, *BLUNDER_ROWS, *PARAMETER_ROWS, *ROWS, *TRIALS
)  # fmt: skip
Cell = dict[str, Any]
"""What is kept of a counted cell: name, landmarks, seed, jobs, and its shares or rates."""

MEASURES: dict[str, Callable[[Count], Array]] = {
    "vehicle": lambda c: c.inside_95[..., VEHICLE],
    "attack": lambda c: c.inside_95[..., ATTACK],
    "eta": lambda c: c.inside_95[..., ETA],
    "ellipsoid": lambda c: c.attitude_95,
    "mean": lambda c: c.mean_95,
    "place": lambda c: c.place_95,
}
ONE_SIGMA = {"vehicle, one sigma": VEHICLE, "attack, one sigma": ATTACK}


class Table(NamedTuple):
    """A table: its mark in the page, whether it is of flights, what a cell is, and its rows."""

    mark: str
    flights: bool
    wide: str
    narrow: str = ""
    rows: Callable[[Row | FlightRow], bool] = lambda _row: True


TABLES = (
    Table("films: yaw, pitch, roll", False, "vehicle", "vehicle, one sigma"),
    Table("films: alpha, beta", False, "attack", "attack, one sigma"),
    Table("films: eta", False, "eta"),
    Table("films: ellipsoid", False, "ellipsoid"),
    Table("films: mean", False, "mean",
          rows=lambda row: isinstance(row, Row) and row.plan.jitter_deg == REST["jitter_deg"]),
    Table("flights: yaw, pitch, roll", True, "vehicle", "vehicle, one sigma"),
    Table("flights: ellipsoid", True, "ellipsoid"),
    Table("flights: place", True, "place",  # its standard deviations have no Student's factor
          rows=lambda row: isinstance(row, FlightRow) and row.plan.sigma_px),
    Table("flights: mean", True, "mean",
          rows=lambda row: isinstance(row, FlightRow) and row.mean),
    Table("flights: alpha, beta", True, "attack", "attack, one sigma",
          rows=lambda row: isinstance(row, FlightRow) and row.attack),
    Table("flights: eta", True, "eta",
          rows=lambda row: isinstance(row, FlightRow) and row.attack),
)  # fmt: skip


class Line(NamedTuple):
    """A line of a table: the name of its row, and its text; empty where it is not counted."""

    name: str
    text: str


# Counting


def _jobs(row: AnyRow, part: float) -> int:
    flights = isinstance(row, FlightRow | MistakeRow | BlunderRow | ParameterRow)
    number = row.plan.flights if flights else row.plan.jobs
    return max(8, round(number * part))


def _key(row: AnyRow, landmarks: int, seed: int, part: float) -> str:
    kind, jobs = type(row).__name__, _jobs(row, part)
    return f"{kind} {row.name}; {landmarks} landmarks; {jobs} jobs; seed {seed}"


def count(row: AnyRow, landmarks: int, seed: int, part: float) -> Cell:
    """Count a cell.

    Args:
        row: the configuration
        landmarks: in a frame
        seed: of all cells; the cell's own does not depend on which others are counted
        part: of the jobs
    """
    jobs, own = _jobs(row, part), zlib.crc32(f"{seed} {row.name} {landmarks}".encode())
    cell: Cell = {"key": _key(row, landmarks, seed, part), "jobs": jobs}
    if isinstance(row, Trial):
        return cell | {"rates": _rates(row, rates(row, landmarks, own, jobs))}
    if isinstance(row, MistakeRow):
        named = [mistakes_named(row, size, own, jobs) for size in row.sizes]
        return cell | {"named": [dict(one._asdict()) for one in named]}
    if isinstance(row, BlunderRow):
        return cell | {"named": [dict(blunders_named(row, own, jobs)._asdict())]}
    if isinstance(row, ParameterRow):
        shares = parameters_counted(row, own, jobs)
        return cell | {
            "inside": {n: [*share(one, CONFIDENCE)[:3]] for n, one in shares.items()},
            "held": {n: float(np.isfinite(one).mean()) for n, one in shares.items()},
        }
    parts = (
        flight_counted(row, landmarks, own, jobs)
        if isinstance(row, FlightRow)
        else [counted(row, landmarks, own, jobs)]
    )
    return cell | {
        "lost": sum(one.lost for one in parts) if len(parts) == 1 else 0,
        "shares": [
            {name: share(measure(one), CONFIDENCE)[:3] for name, measure in MEASURES.items()}
            | {name: _beyond(one, angles) for name, angles in ONE_SIGMA.items()}
            for one in parts
        ],
    }


def _beyond(found: Count, angles: slice) -> tuple[float, float, float]:
    """The share inside one sigma, and the limits of its difference from that of Student's t."""
    one = found.share_68(angles).share
    if one != one:
        return one, 0.0, 0.0
    beyond = found.beyond_68(angles, CONFIDENCE)
    return one, float(beyond.low), float(beyond.high)


def _rates(trial: Trial, found: Rates) -> dict[str, str]:
    """Write the rates of a trial's flags, per cent, by what stands in their rows."""
    texts = {}
    for flag in trial.shown:
        for which, shares in (("", found.found), (" in the other frames", found.false)):
            value = shares.get(flag, float("nan"))
            if value == value:
                texts[f"`{flag}`{which}"] = f"{100 * value:.2f}"
    if "misfit" in trial.shown and found.wrong:
        texts["right one named"] = f"{100 * found.named:.1f}"
        texts["right one named alone"] = f"{100 * found.named_alone:.1f}"
    return texts


def counted_cells(rows: Sequence[AnyRow], asked: argparse.Namespace) -> dict[str, Cell]:
    """Count the cells that the file of results does not have, and add them to it."""
    file: Path = asked.results
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    cells = {one["key"]: one for one in map(json.loads, lines)}
    todo = [
        (row, n)
        for row in rows
        for n in columns_of(row)
        if (not asked.landmarks or n in asked.landmarks)
        and _key(row, n, asked.seed, asked.part) not in cells
    ]
    began = time.monotonic()
    context = multiprocessing.get_context("spawn")  # a fork may copy a lock that is held
    with context.Pool(asked.processes) as pool, file.open("a", encoding="utf-8") as out:
        tasks = [(ALL_ROWS.index(row), n, asked.seed, asked.part) for row, n in todo]
        for done, cell in enumerate(pool.imap_unordered(_count, tasks), 1):
            spent = time.monotonic() - began
            text = cell.get("error", cell["key"])
            print(f"{done}/{len(todo)}, {spent:.0f} s: {text}", file=sys.stderr, flush=True)
            if "error" not in cell:
                cells[cell["key"]] = cell
                print(json.dumps(cell), file=out, flush=True)
    return cells


def _count(task: tuple[int, int, int, float]) -> Cell:
    """Count a cell in a process of its own; an error ends the cell, not the count."""
    row, settings = ALL_ROWS[task[0]], task[1:]
    try:
        return count(row, *settings)
    except VopdError as error:
        key = _key(row, *settings)
        return {"key": key, "error": f"{key}: {error}"}


def columns_of(row: AnyRow) -> tuple[int, ...]:
    """List the numbers of landmarks with which a row is counted."""
    if isinstance(row, FlightRow):
        return row.columns
    one = isinstance(row, MistakeRow | BlunderRow | ParameterRow)
    return (row.plan.landmarks,) if one else LANDMARKS


# Tables


def outside(found: tuple[float, float, float], allowed: tuple[float, float]) -> bool:
    """Tell whether no value that a counted share may stand for is allowed."""
    return found[2] < allowed[0] or found[1] > allowed[1]


def cell_text(shares: dict[str, Any], table: Table, row: Row | FlightRow) -> str:
    """Write a cell: the share inside 95 %, in brackets that inside one standard deviation."""
    allowed = (row.low, row.high) if isinstance(row, FlightRow) else FILM_95
    wide = shares[table.wide]
    if wide[0] != wide[0]:
        return "-"
    text, out = f"{100 * wide[0]:.1f}", outside(wide, allowed)
    if table.narrow:
        narrow = shares[table.narrow]
        text = f"{text} ({100 * narrow[0]:.0f})"
        out = out or (allowed == FILM_95 and outside(narrow, BEYOND_68))
    return text + "\\*" * out


def table_lines(table: Table, cells: dict[str, Cell], asked: argparse.Namespace) -> Iterator[Line]:
    """Write the rows of a table; the column before the last is how far chance may have gone.

    A row of which no cell is counted is given by its name, without a text; a cell that is not
    counted is empty.
    """
    heads = head(table)
    yield Line("", f"| errors | {' | '.join(map(str, heads))} | ± |{' flights |' * table.flights}")
    yield Line("", "|---" * (len(heads) + 2 + table.flights) + "|")
    for row in filter(table.rows, FLIGHT_ROWS if table.flights else ROWS):
        keys = {n: _key(row, n, asked.seed, asked.part) for n in columns_of(row)}
        for k, part in enumerate(row.parts if isinstance(row, FlightRow) else ("",)):
            name = f"{row.name}: {part}" if part else row.name
            shares = {n: cells[key]["shares"][k] for n, key in keys.items() if key in cells}
            if not shares:
                yield Line(name, "")
                continue
            if all(one[table.wide][0] != one[table.wide][0] for one in shares.values()):
                continue  # places before they were solved for
            texts = [cell_text(shares[n], table, row) if n in shares else "" for n in heads]
            width = max(one[table.wide][2] - one[table.wide][1] for one in shares.values())
            more = f" {_jobs(row, asked.part)} |" if table.flights else ""
            yield Line(name, f"| {name} | {' | '.join(texts)} | {50 * width:.1f} |{more}")


def head(table: Table) -> tuple[int, ...]:
    """List the columns of a table."""
    if not table.flights:
        return LANDMARKS
    return tuple(sorted({n for row in filter(table.rows, FLIGHT_ROWS) for n in columns_of(row)}))


def flag_lines(cells: dict[str, Cell], asked: argparse.Namespace) -> Iterator[Line]:
    """Write the rates of the flags, per cent."""
    yield Line("", f"| what is wrong | flag | {' | '.join(map(str, LANDMARKS))} |")
    yield Line("", "|---" * (len(LANDMARKS) + 2) + "|")
    for trial in TRIALS:
        keys = [_key(trial, n, asked.seed, asked.part) for n in LANDMARKS]
        if not all(key in cells for key in keys):
            yield Line(trial.name, "")
            continue
        found = [cells[key]["rates"] for key in keys]
        for label in dict.fromkeys(label for one in found for label in one):
            texts = " | ".join(one.get(label, "-") for one in found)
            yield Line(trial.name, f"| {trial.name} | {label} | {texts} |")


def mistake_lines(cells: dict[str, Cell], asked: argparse.Namespace) -> Iterator[Line]:
    """Write how often mistakes are named, per cent."""
    yield Line("", "| mistake | size | named | or misfits | another | frames | 95 % | flights |")
    yield Line("", "|---" * 8 + "|")
    for row in MISTAKE_ROWS:
        cell = cells.get(_key(row, row.plan.landmarks, asked.seed, asked.part))
        if cell is None:
            yield Line(row.name, "")
            continue
        for size, found in zip(row.sizes, cell["named"], strict=True):
            text = f"{size:.2g}" if len(row.sizes) > 1 else ""
            shares = " | ".join(f"{100 * share:.1f}" for share in found.values())
            yield Line(row.name, f"| {row.name} | {text} | {shares} | {cell['jobs']} |")


def blunder_lines(cells: dict[str, Cell], asked: argparse.Namespace) -> Iterator[Line]:
    """Write how often leaving out names blunders, per cent."""
    yield Line("", "| blunder | named | alone | another | flights |")
    yield Line("", "|---" * 5 + "|")
    for row in BLUNDER_ROWS:
        cell = cells.get(_key(row, row.plan.landmarks, asked.seed, asked.part))
        if cell is None:
            yield Line(row.name, "")
            continue
        shares = " | ".join(f"{100 * share:.1f}" for share in cell["named"][0].values())
        yield Line(row.name, f"| {row.name} | {shares} | {cell['jobs']} |")


def parameter_lines(cells: dict[str, Cell], asked: argparse.Namespace) -> Iterator[Line]:
    """Write how often parameters of adjusted flights are inside, and how often they are held."""
    yield Line("", f"| flights | {' | '.join(PARAMETERS)} | ± | flights |")
    yield Line("", "|---" * (len(PARAMETERS) + 3) + "|")
    for row in PARAMETER_ROWS:
        cell = cells.get(_key(row, row.plan.landmarks, asked.seed, asked.part))
        if cell is None:
            yield Line(row.name, "")
            continue
        inside, held = cell["inside"], cell["held"]
        texts = [_held_text(inside[n], held[n]) if n in inside else "" for n in PARAMETERS]
        known = [one for one in inside.values() if one[0] == one[0]]
        width = 50 * max(one[2] - one[1] for one in known)
        text = f"| {row.name} | {' | '.join(texts)} | {width:.1f} | {cell['jobs']} |"
        yield Line(row.name, text)


def _held_text(inside: Sequence[float], held: float) -> str:
    """Write the share inside, and in brackets how often a parameter is held at all."""
    if inside[0] != inside[0]:
        return "(0)"
    outer = "\\*" * outside((inside[0], inside[1], inside[2]), PARAMETER_95)
    return f"{100 * inside[0]:.1f}{outer}" + (f" ({100 * held:.0f})" if held < 1.0 else "")


def page_with(page: str, mark: str, lines: Iterator[Line]) -> str:
    """Write a table where a page has its mark; rows that are not counted stay as they are.

    Args:
        page: the text of the page
        mark: of the table
        lines: of the table
    """
    begin, end = f"<!-- table of {mark} -->\n", f"<!-- end of {mark} -->"
    old = page.split(begin)[1].split(end)[0].splitlines()
    made = []
    for name, text in lines:
        made += [text] if text else [one for one in old if one.startswith(f"| {name} |")]
    return between(page, begin, end, "\n".join([*made, ""]))


def main() -> None:
    """Count the asked cells, and write or print the tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--write", action="store_true", help="into docs/coverage.md")
    parser.add_argument("--part", type=float, default=1.0, metavar="P", help="of the jobs")
    parser.add_argument(
        "--cells",
        nargs="*",
        default=[""],
        metavar="TEXT",
        help="rows with one of these in their names",
    )
    parser.add_argument("--landmarks", type=int, nargs="*", metavar="N")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--processes", type=int, default=1, metavar="N")
    parser.add_argument("--results", type=Path, default=Path("coverage.jsonl"), metavar="FILE")
    asked = parser.parse_args()
    rows = [row for row in ALL_ROWS if any(c in row.name for c in asked.cells)]
    cells = counted_cells(rows, asked)
    made = {table.mark: table_lines(table, cells, asked) for table in TABLES}
    made["mistakes"] = mistake_lines(cells, asked)
    made["blunders"] = blunder_lines(cells, asked)
    made["parameters"] = parameter_lines(cells, asked)
    made["flags"] = flag_lines(cells, asked)
    page = PAGE.read_text(encoding="utf-8")
    for mark, lines in made.items():
        if asked.write and f"<!-- table of {mark} -->" in page:
            page = page_with(page, mark, lines)
        elif not asked.write and len(texts := [text for _, text in lines if text]) > 2:
            print(f"\n{mark}\n", *texts, sep="\n")
    if asked.write:
        PAGE.write_text(page, encoding="utf-8", newline="\n")
    for key, cell in cells.items():
        if cell.get("lost"):
            print(f"{key}: {cell['lost']} frames without an attitude", file=sys.stderr)


if __name__ == "__main__":
    main()
