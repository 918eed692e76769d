"""How often the truth lies inside the stated uncertainty: the table of docs/uncertainty.md.

    python -m tools.coverage [--quick] [--cells TEXT] [--landmarks N] [--seed N]

Films whose truth is known are simulated apart from the package, with random errors, and
solved; `--cells TEXT` takes the rows whose names have the text, `--quick` a tenth of the
jobs. The table is Markdown on standard output: in every cell the share of frames whose truth
lies inside the 95 % interval and, in brackets, inside one standard deviation. A cell outside
93 to 97 or 67 to 70, by more than chance allows, has an asterisk.
"""

from __future__ import annotations

import argparse
import sys
import time

from tests.kit.coverage_cells import LANDMARKS, ROWS, Row, counted
from tests.kit.coverage_count import ATTACK, ETA, VEHICLE, Count, Share
from tests.kit.flag_rates import TRIALS, Rates, rates
from tests.kit.flight_coverage import FLIGHT_ROWS, FlightRow, flight_counted

TABLES = (("Vehicle yaw, pitch, roll", VEHICLE), ("Alpha and beta", ATTACK), ("Eta", ETA))
ALLOWED_95, ALLOWED_68 = (0.93, 0.97), (0.67, 0.70)
SEED = 12


def outside(share: Share, allowed: tuple[float, float]) -> bool:
    """Whether no value that the counted share may stand for is allowed."""
    return share.high < allowed[0] or share.low > allowed[1]


def cell(found: Count, angles: slice) -> str:
    """The text of a cell."""
    wide, narrow = found.share_95(angles), found.share_68(angles)
    if not wide.effective:
        return "-"
    mark = "\\*" if outside(wide, ALLOWED_95) or outside(narrow, ALLOWED_68) else ""
    return f"{100 * wide.share:.1f} ({100 * narrow.share:.0f}){mark}"


def limits(found: list[Count], angles: slice) -> str:
    """How far chance may have moved the shares of a row, at most."""
    shares = [one.share_95(angles) for one in found]
    widths = [100 * (one.high - one.low) / 2 for one in shares if one.effective]
    return f"{max(widths):.1f}" if widths else "-"


def table(rows: dict[str, list[Count]], angles: slice, columns: tuple[int, ...]) -> list[str]:
    """One table as Markdown."""
    head = ["| errors |", *(f" {n} |" for n in columns), " ± |"]
    lines = ["".join(head), "|---" * (len(columns) + 2) + "|"]
    for name, found in rows.items():
        cells = [cell(one, angles) for one in found]
        lines.append(f"| {name} | {' | '.join(cells)} | {limits(found, angles)} |")
    return lines


def flag_table(trials: dict[str, list[Rates]], columns: tuple[int, ...]) -> list[str]:
    """The rates of the flags as Markdown, per cent of the frames that are wrong."""
    head = ["| what is wrong | flag |", *(f" {n} |" for n in columns)]
    lines = ["".join(head), "|---" * (len(columns) + 2) + "|"]
    shown = {trial.name: trial.shown for trial in TRIALS}
    for name, found in trials.items():
        for flag in shown[name]:
            shares = [one.flag.get(flag) for one in found]
            cells = ["-" if share is None else f"{100 * share:.2f}" for share in shares]
            lines.append(f"| {name} | `{flag}` | {' | '.join(cells)} |")
        cells = [f"{100 * one.none:.2f}" for one in found]
        lines.append(f"| {name} | none of an error | {' | '.join(cells)} |")
    return lines


class Progress:
    """A line on standard error that says how far the count is."""

    def __init__(self, cells: int) -> None:
        self.cells, self.done, self.began = cells, 0, time.monotonic()

    def step(self, name: str, landmarks: int) -> None:
        """One cell more is done."""
        self.done += 1
        line = (
            f"{self.done}/{self.cells}, {time.monotonic() - self.began:.0f} s: {name}, {landmarks}"
        )
        if sys.stderr.isatty():
            print(f"\r{line}\033[K", end="", file=sys.stderr, flush=True)
        else:
            print(line, file=sys.stderr, flush=True)


def _counted(row: Row | FlightRow, landmarks: int, seed: int, part: float) -> Count:
    jobs = max(8, round(row.plan.jobs * part))
    if isinstance(row, FlightRow):
        return flight_counted(row, landmarks, seed, jobs)
    return counted(row, landmarks, seed, jobs)


def main() -> None:
    """Count the asked cells and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="a tenth of the jobs")
    parser.add_argument("--cells", default="", metavar="TEXT", help="rows with this in their names")
    parser.add_argument("--landmarks", type=int, nargs="*", default=LANDMARKS, metavar="N")
    parser.add_argument("--seed", type=int, default=SEED)
    asked = parser.parse_args()
    columns, part = tuple(asked.landmarks), 0.1 if asked.quick else 1.0
    chosen = [row for row in (*ROWS, *FLIGHT_ROWS) if asked.cells in row.name]
    trials = [trial for trial in TRIALS if asked.cells in trial.name]
    progress = Progress((len(chosen) + len(trials)) * len(columns))
    rows: dict[str, list[Count]] = {row.name: [] for row in chosen}
    flags: dict[str, list[Rates]] = {trial.name: [] for trial in trials}
    for row in chosen:
        for landmarks in columns:
            rows[row.name].append(_counted(row, landmarks, asked.seed + progress.done, part))
            progress.step(row.name, landmarks)
    for trial in trials:
        for landmarks in columns:
            jobs = max(8, round(trial.plan.jobs * part))
            flags[trial.name].append(rates(trial, landmarks, asked.seed + progress.done, jobs))
            progress.step(trial.name, landmarks)
    print(f"Seed {asked.seed}{', a tenth of the jobs' if asked.quick else ''}.")
    for title, angles in TABLES:
        known = {n: f for n, f in rows.items() if any(c.share_95(angles).effective for c in f)}
        if known:
            print(f"\n{title}:\n", *table(known, angles, columns), sep="\n")
    if flags:
        print("\nFlags, per cent of the frames:\n", *flag_table(flags, columns), sep="\n")
    for name, found in rows.items():
        if lost := sum(one.lost for one in found):
            print(f"\n{name}: {lost} frames without an attitude or a standard deviation")


if __name__ == "__main__":
    main()
