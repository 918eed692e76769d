"""How long `vopd run`, `vopd batch` and flights take, against the compiled original and others.

    python tools/benchmark.py
    python tools/benchmark.py --repeat 9 --profile

The compiled original is tools/oracle/vopd.f, the whole program, by gfortran -O2. Each
program is one process on one and the same processor; both read the same decks, which
`vopd demo` makes, and write the listing and tape 10. They are run in turn, A B A B, and
a ratio is the median of the ratios of neighbours. Times are those of the processor, user
and system, which are the clock's on a quiet machine and mean something on a busy one.
A flight of 10,000 frames is compared with 1.5 s, and its solve with scipy's `least_squares`
called for each frame. The table is Markdown, as docs/performance.md has it.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
CASE_1 = ROOT / "decks" / "appendix_h" / "case1.dat"
ORACLE = ROOT / "tools" / "oracle" / "vopd.f"
GFORTRAN = ("gfortran", "-std=legacy", "-O2", "-fdefault-real-8", "-fdefault-double-8")
VOPD = (sys.executable, "-m", "vopd")
TIMING = (sys.executable, "-m", "tools.flight_timing")
CONVERGED_OR_NOT = (0, 3)  # exit statuses of a run that went well
LONG, JOBS = 9000, 10  # frames of a job, and how many such jobs are stacked
LONGER = LONG * JOBS
DECKS, SHORT = 500, 20  # small decks, and the frames of each
FLIGHT, WANTED_S, WANTED_MB = 10_000, 1.5, 300.0  # frames of a project, and what it may take
SOLVED = 2000  # frames that scipy solves too
COPIES = 4  # of each of these decks in a batch
FLIGHTS, BATCH_FRAMES = 200, 1000  # flights of a batch, and the frames of each


class Cost(NamedTuple):
    """What a measurement used: the processor's seconds, and the largest process's memory."""

    seconds: float
    peak_mb: float


class Row(NamedTuple):
    """One line of the table: two programs on the same task, and their ratio."""

    task: str
    ours: Cost
    other: Cost
    ratio: float
    goal: float
    floor: float


Command = Sequence[str]


class Bench:
    """The measurements, one method a row, in a directory of their own."""

    def __init__(self, directory: Path, repeat: int, processors: set[int]) -> None:
        self.directory = directory
        self.repeat = repeat
        self.processors = processors
        self.compiled = directory / "vopd-compiled"
        subprocess.run([*GFORTRAN, str(ORACLE), "-o", str(self.compiled)], check=True)

    def rows(self) -> list[Row]:
        """All measurements."""
        decks = [self.start_up(), self.long_film(), self.further_frame(), self.small_decks()]
        batches = [self.batch(), self.two_processes(), *self.flights()]
        return [*decks, *batches, self.long_flight(), self.flight_solve()]

    def start_up(self) -> Row:
        """Case 1 against what any program in Python and numpy takes."""
        ours = self._vopd([CASE_1])
        numpy = self._command((sys.executable, "-c", "import numpy"))
        return self._row("`vopd run case1.dat` / an import of numpy", ours, numpy, 1.3, 1.5)

    def long_film(self) -> Row:
        """One film of many frames."""
        deck = self._deck(LONG)
        ours, other = self._vopd([deck]), self._original([deck])
        return self._row(f"{LONG:,} frames", ours, other, 0.75, 1.0)

    def further_frame(self) -> Row:
        """What a frame more costs, microseconds for seconds."""
        decks = self._deck(LONG), self._stacked()

        def slope(run: Callable[[list[Path]], Callable[[], Cost]]) -> Callable[[], Cost]:
            short, long = (run([deck]) for deck in decks)

            def further() -> Cost:
                one, other = short(), long()
                micro = 1e6 * (other.seconds - one.seconds) / (LONGER - LONG)
                return Cost(micro, other.peak_mb)

            return further

        title = f"a further frame, microseconds, from {LONG:,} to {LONGER:,} in stacked jobs"
        return self._row(title, slope(self._vopd), slope(self._original), 0.6, 0.8)

    def small_decks(self) -> Row:
        """Many small decks: one process for all of ours, one for each of the original's."""
        decks = [self._deck(SHORT, seed) for seed in range(DECKS)]

        def each(run: Callable[[], Cost]) -> Callable[[], Cost]:
            return lambda: Cost((cost := run()).seconds / DECKS, cost.peak_mb)

        title = f"a deck of {SHORT} frames, one of {DECKS}"
        ours, other = each(self._vopd(decks)), each(self._original(decks))
        return self._row(title, ours, other, 4.0, 6.0)

    def long_flight(self) -> Row:
        """A flight project to its table, against the time and the memory that are wanted."""
        folder = self.directory / "flight"
        self._run((*TIMING, "project", str(folder), str(FLIGHT)), None)
        project, table = str(folder / "flight.toml"), str(folder / "table.csv")
        ours = self._command((*VOPD, "attitude", project, "-o", table))
        title = f"`vopd attitude`, a flight of {FLIGHT:,} frames / {WANTED_S} s, {WANTED_MB:.0f} MB"
        return self._row(title, ours, lambda: Cost(WANTED_S, WANTED_MB), 1.0, 2.0)

    def flight_solve(self) -> Row:
        """The solve of a flight alone, against scipy's least squares a frame at a time."""
        times: list[float] = []

        def ours() -> Cost:
            cost = self._run((*TIMING, "solve", str(SOLVED)), None)
            text = (self.directory / "output").read_text(encoding="utf-8")
            times[:] = [float(word) for word in text.split()]
            return Cost(times[0], cost.peak_mb)

        title = f"the solve of {SOLVED:,} frames / scipy's `least_squares`, frame by frame"
        return self._row(title, ours, lambda: Cost(times[1], 0.0), 1 / 40, 1 / 20)

    def batch(self) -> Row:
        """The same decks with their attitude tables, into a folder."""
        decks = self._many_decks()
        ours, original = self._batch(decks), self._original(decks)

        def other() -> Cost:
            cost = original()
            return Cost(cost.seconds / len(decks), cost.peak_mb)

        title = f"`vopd batch`, a deck of {SHORT} frames, one of {len(decks):,}"
        return self._row(title, ours, other, 0.8, 4.0)

    def two_processes(self) -> Row:
        """The same by two processes and by one, by the clock: it needs two quiet processors."""
        decks = self._many_decks()

        def by_the_clock(jobs: int) -> Callable[[], Cost]:
            run = self._batch(decks, "--jobs", str(jobs))

            def timed() -> Cost:
                one = _processors()
                _set_processors(self.processors)
                begun = time.perf_counter()
                peak_mb = run().peak_mb
                seconds = time.perf_counter() - begun
                _set_processors(one)
                return Cost(seconds / len(decks), peak_mb)

            return timed

        title = f"`vopd batch`, a deck of {SHORT} frames, two processes / one, by the clock"
        return self._row(title, by_the_clock(2), by_the_clock(1), 1 / 1.8, 1 / 1.5)

    def flights(self) -> list[Row]:
        """Flights to their tables, against their equations alone, and against the library."""
        first = self.directory / "flights" / "0"
        first.parent.mkdir(exist_ok=True)
        self._run((*TIMING, "project", str(first), str(BATCH_FRAMES)), None)
        for k in range(1, FLIGHTS):
            shutil.copytree(first, first.with_name(str(k)), dirs_exist_ok=True)
        projects = sorted(first.parent.glob("*/*.toml"))

        def alone(*what: str) -> Callable[[], Cost]:
            def run() -> Cost:
                cost = self._run((*TIMING, *what, str(FLIGHTS)), None)
                text = (self.directory / "output").read_text(encoding="utf-8")
                return Cost(float(text), cost.peak_mb)

            return run

        title = f"`vopd batch`, a flight of {BATCH_FRAMES:,} frames, one of {FLIGHTS} /"
        batch = self._batch([first.parent], count=len(projects))
        equations, library = alone("alone", str(BATCH_FRAMES)), alone("library", str(projects[0]))
        return [
            self._row(f"{title} the equations alone", batch, equations, 1.2, 4.0),
            self._row(f"{title} `solve_flight` and `history`", batch, library, 1.2, 1.5),
        ]

    def _batch(self, sources: list[Path], *options: str, count: int = 0) -> Callable[[], Cost]:
        """What `vopd batch` costs for each of the sources."""
        folder = self.directory / "batch"

        def run() -> Cost:
            shutil.rmtree(folder, ignore_errors=True)
            given = (*map(str, sources), "-q", "-d", str(folder), *options)
            cost = self._run((*VOPD, "batch", *given), None)
            return Cost(cost.seconds / (count or len(sources)), cost.peak_mb)

        return run

    def _row(
        self,
        task: str,
        ours: Callable[[], Cost],
        other: Callable[[], Cost],
        goal: float,
        floor: float,
    ) -> Row:
        """Run two measurements in turn, after one run of each that does not count."""
        ours(), other()
        pairs = [(ours(), other()) for _ in range(self.repeat)]
        ratio = median(one.seconds / two.seconds for one, two in pairs)
        one, two = (_middle(costs) for costs in zip(*pairs, strict=True))
        print(f"{task}: {ratio:.2f}", file=sys.stderr)
        return Row(task, one, two, ratio, goal, floor)

    def _deck(self, frames: int, seed: int = 0) -> Path:
        """A deck in the directory, made once."""
        deck = self.directory / f"{frames}_{seed}.dat"
        if not deck.exists():
            options = (f"--frames={frames}", f"--seed={seed}", "-o", str(deck))
            self._run((*VOPD, "demo", *options), None)
        return deck

    def _many_decks(self) -> list[Path]:
        """The small decks, several times under other names."""
        folder = self.directory / "decks"
        folder.mkdir(exist_ok=True)
        decks = []
        for k in range(COPIES):
            for seed in range(DECKS):
                decks.append(folder / f"{k}_{seed}.dat")
                if not decks[-1].exists():
                    decks[-1].hardlink_to(self._deck(SHORT, seed))
        return decks

    def _stacked(self) -> Path:
        """The long film as several jobs of one deck, each read anew."""
        deck = self.directory / "stacked.dat"
        if not deck.exists():
            program = (
                "import sys, dataclasses, vopd; (job,) = vopd.read_deck(sys.argv[1]); "
                "again = dataclasses.replace(job, return_group=1); "
                f"jobs = [again] * {JOBS - 1} + [job]; "
                "open(sys.argv[2], 'w', encoding='ascii').write(vopd.write_deck(jobs))"
            )
            self._run((sys.executable, "-c", program, str(self._deck(LONG)), str(deck)), None)
        return deck

    def _vopd(self, decks: list[Path]) -> Callable[[], Cost]:
        tape = ("-q", "--tape10", str(self.directory / "tape"))
        return self._command((*VOPD, "run", *map(str, decks), *tape))

    def _original(self, decks: list[Path]) -> Callable[[], Cost]:
        """The compiled program reads its deck from standard input."""

        def run() -> Cost:
            costs = [self._run((str(self.compiled),), deck) for deck in decks]
            return Cost(sum(c.seconds for c in costs), max(c.peak_mb for c in costs))

        return run

    def _command(self, command: Command) -> Callable[[], Cost]:
        return lambda: self._run(command, None)

    def _run(self, command: Command, deck: Path | None) -> Cost:
        """Run one process with its standard output in a file; RuntimeError where it fails."""
        environment = os.environ | {"PYTHONPATH": str(ROOT)}
        # as an installed program: compiled by the run that does not count
        environment |= {"PYTHONPYCACHEPREFIX": str(self.directory / "compiled")}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        with (
            (self.directory / "output").open("wb") as output,
            Path(deck or os.devnull).open("rb") as cards,
        ):
            child = subprocess.Popen(
                command, stdin=cards, stdout=output, env=environment, cwd=self.directory
            )
            _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode not in CONVERGED_OR_NOT:
            raise RuntimeError(f"status {child.returncode}: {' '.join(command)[:200]}")
        seconds = used.ru_utime + used.ru_stime
        return Cost(seconds, used.ru_maxrss / (2**20 if sys.platform == "darwin" else 2**10))

    def profile(self) -> None:
        """Where a run of the long film spends its time."""
        program = (
            "import cProfile, sys; from vopd.cli import cli; "
            f"sys.argv = ['vopd', 'run', {str(self._deck(LONG))!r}, '-q', '-o', {os.devnull!r}]; "
            "cProfile.run('cli()', sort='tottime')"
        )
        self._run((sys.executable, "-c", program), None)
        for line in (self.directory / "output").read_text(encoding="utf-8").splitlines()[:40]:
            print(line.replace(f"{ROOT}{os.sep}", ""))


def _processors() -> set[int]:
    """The processors that this process and its children run on; empty where there is no say."""
    return set(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else set()


def _set_processors(some: set[int]) -> None:
    if some:
        os.sched_setaffinity(0, some)


def _middle(costs: Sequence[Cost]) -> Cost:
    """The median of each figure."""
    return Cost(*(median(figures) for figures in zip(*costs, strict=True)))


def table(rows: list[Row]) -> str:
    """The table in Markdown."""
    lines = [
        "| task | `vopd run` | the other | ratio | goal | floor | |",
        "|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        times = []
        for seconds, peak_mb in (row.ours, row.other):
            text = f"{seconds:.1f}" if seconds >= 5 else f"{seconds:.4f} s"
            times.append(f"{text}, {peak_mb:.0f} MB")
        met = row.ratio <= row.goal, row.ratio <= row.floor
        said = "goal met" if met[0] else "floor met" if met[1] else "**not met**"
        figures = f"{row.ratio:.3g} | {row.goal:.3g} | {row.floor:.3g}"
        lines.append(f"| {row.task} | {times[0]} | {times[1]} | {figures} | {said} |")
    return "\n".join(lines)


def main() -> None:
    """Run all measurements and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--repeat", type=int, default=5, metavar="N", help="runs (%(default)s)")
    parser.add_argument("--profile", action="store_true", help="also profile the long film")
    arguments = parser.parse_args()
    if shutil.which(GFORTRAN[0]) is None:
        parser.error("gfortran is needed: the compiled original is what vopd is compared with")
    processors = _processors()
    _set_processors({max(processors)} if processors else set())  # children inherit it
    with tempfile.TemporaryDirectory() as name:
        bench = Bench(Path(name), arguments.repeat, processors)
        print(table(bench.rows()))
        if arguments.profile:
            bench.profile()


if __name__ == "__main__":
    main()
