"""How often the truth lies inside the stated uncertainty: the tables of docs/coverage.md.

    python -m tools.coverage [--part P] [--cells TEXT ...] [--landmarks N ...] [--seed N]

Films and flights whose truth is known are simulated apart from the package, with random
errors, and solved; `--cells TEXT` takes the rows whose names have the text, `--part .1` a tenth
of the jobs. The tables are Markdown on standard output. A cell is the share of frames whose
truth lies inside the 95 % interval and, in brackets, inside one standard deviation; it has an
asterisk where it is outside 93 to 97 or 67 to 70 by more than chance allows. An interrupt
prints the rows that are complete.
"""

from __future__ import annotations

import argparse
import sys
import time
import zlib
from collections.abc import Callable, Iterator
from typing import NamedTuple

from tests.kit.coverage import (
    ATTACK,
    ETA,
    FLIGHT_ROWS,
    LANDMARKS,
    REST,
    ROWS,
    VEHICLE,
    Count,
    FlightRow,
    Row,
    Share,
    counted,
    flight_counted,
)
from tests.kit.flag_trials import TRIALS, Rates, Trial, rates

ALLOWED_95, ALLOWED_68 = (0.93, 0.97), (0.67, 0.70)
SEED = 12


class Table(NamedTuple):
    """A table: its title, the share of 95 % of a cell, that of one sigma, and its rows."""

    title: str
    wide: Callable[[Count], Share]
    narrow: Callable[[Count], Share] | None = None
    rows: Callable[[Row | FlightRow], bool] = lambda _row: True


def _film(row: Row | FlightRow) -> bool:
    return isinstance(row, Row)


def _at_rest(row: Row | FlightRow) -> bool:
    return isinstance(row, Row) and row.plan.jitter_deg == REST["jitter_deg"]


TABLES = (
    Table("Vehicle yaw, pitch, roll", lambda c: c.share_95(VEHICLE), lambda c: c.share_68(VEHICLE)),
    Table("Alpha and beta", lambda c: c.share_95(ATTACK), lambda c: c.share_68(ATTACK), _film),
    Table("Eta", lambda c: c.share_95(ETA), None, _film),
    Table("The attitude inside the ellipsoid of its covariance", lambda c: c.share_of_attitudes),
    Table("The mean attitude of a job", lambda c: c.share_of_means, None, _at_rest),
)


def outside(share: Share, allowed: tuple[float, float]) -> bool:
    """Whether no value that the counted share may stand for is allowed."""
    return share.high < allowed[0] or share.low > allowed[1]


def cell(found: Count, table: Table) -> str:
    """The text of a cell."""
    wide = table.wide(found)
    text, out = f"{100 * wide.share:.1f}", outside(wide, ALLOWED_95)
    if table.narrow:
        narrow = table.narrow(found)
        text, out = f"{text} ({100 * narrow.share:.0f})", out or outside(narrow, ALLOWED_68)
    return text + "\\*" * out


def table_lines(
    table: Table, counts: dict[Row | FlightRow, list[Count]], columns: tuple[int, ...]
) -> Iterator[str]:
    """One table as Markdown; its last column is how far chance may have moved a share."""
    yield "".join(["| errors |", *(f" {n} |" for n in columns), " ± |"])
    yield "|---" * (len(columns) + 2) + "|"
    for row, found in counts.items():
        widths = [100 * (s.high - s.low) / 2 for s in map(table.wide, found)]
        cells = " | ".join(cell(one, table) for one in found)
        yield f"| {row.name} | {cells} | {max(widths):.1f} |"


def flag_lines(trials: dict[Trial, list[Rates]], columns: tuple[int, ...]) -> Iterator[str]:
    """The rates of the flags as Markdown, per cent."""
    yield "".join(["| what is wrong | flag |", *(f" {n} |" for n in columns)])
    yield "|---" * (len(columns) + 2) + "|"
    for trial, found in trials.items():
        for flag in trial.shown:
            for which, shares in (("", "found"), (" in the other frames", "false")):
                values = [getattr(one, shares).get(flag) for one in found]
                if any(value == value for value in values):
                    cells = " | ".join("-" if v != v else f"{100 * v:.2f}" for v in values)
                    yield f"| {trial.name} | `{flag}`{which} | {cells} |"
        if "misfit" in trial.shown and found[0].wrong:
            for text, name in (("named", "named"), ("named alone", "named_alone")):
                cells = " | ".join(f"{100 * getattr(one, name):.1f}" for one in found)
                yield f"| {trial.name} | {text} | {cells} |"


class Progress:
    """A line on standard error that says how far the count is."""

    def __init__(self, cells: int) -> None:
        self.cells, self.done, self.began = cells, 0, time.monotonic()

    def step(self, name: str, landmarks: int) -> None:
        """One cell more is done."""
        self.done += 1
        spent = time.monotonic() - self.began
        line = f"{self.done}/{self.cells}, {spent:.0f} s: {name}, {landmarks}"
        if sys.stderr.isatty():
            print(f"\r{line}\033[K", end="", file=sys.stderr, flush=True)
        else:
            print(line, file=sys.stderr, flush=True)


def _seed(seed: int, name: str, landmarks: int) -> int:
    """A seed for a cell that does not depend on which other cells are counted."""
    return zlib.crc32(f"{seed} {name} {landmarks}".encode())


def _counted(row: Row | FlightRow, landmarks: int, seed: int, part: float) -> Count:
    jobs = max(8, round(row.plan.jobs * part))
    if isinstance(row, FlightRow):
        return flight_counted(row, landmarks, seed, jobs)
    return counted(row, landmarks, seed, jobs)


def main() -> None:
    """Count the asked cells and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--part", type=float, default=1.0, metavar="P", help="of the jobs")
    parser.add_argument(
        "--cells",
        nargs="*",
        default=[""],
        metavar="TEXT",
        help="rows with one of these in their names",
    )
    parser.add_argument("--landmarks", type=int, nargs="*", default=LANDMARKS, metavar="N")
    parser.add_argument("--seed", type=int, default=SEED)
    asked = parser.parse_args()
    columns, part = tuple(asked.landmarks), asked.part
    rows = [row for row in (*ROWS, *FLIGHT_ROWS) if any(c in row.name for c in asked.cells)]
    trials = [trial for trial in TRIALS if any(c in trial.name for c in asked.cells)]
    progress = Progress((len(rows) + len(trials)) * len(columns))
    counts: dict[Row | FlightRow, list[Count]] = {}
    flags: dict[Trial, list[Rates]] = {}
    try:
        for trial in trials:
            jobs = max(8, round(trial.plan.jobs * part))
            found = []
            for n in columns:
                found.append(rates(trial, n, _seed(asked.seed, trial.name, n), jobs))
                progress.step(trial.name, n)
            flags[trial] = found
        for row in rows:
            cells = []
            for n in columns:
                cells.append(_counted(row, n, _seed(asked.seed, row.name, n), part))
                progress.step(row.name, n)
            counts[row] = cells
    except KeyboardInterrupt:
        print("Interrupted.")
    print(f"Seed {asked.seed}; {part:g} of the jobs.")
    for table in TABLES:
        if chosen := {row: found for row, found in counts.items() if table.rows(row)}:
            print(f"\n{table.title}:\n", *table_lines(table, chosen, columns), sep="\n")
    if flags:
        print("\nFlags, per cent of the frames:\n", *flag_lines(flags, columns), sep="\n")
    for row, found in counts.items():
        if lost := sum(one.lost for one in found):
            print(f"\n{row.name}: {lost} frames without an attitude or a standard deviation")


if __name__ == "__main__":
    main()
