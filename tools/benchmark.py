"""Measure `vopd` against the compiled original, start-up against numpy, flights against a script.

    python tools/benchmark.py
    python tools/benchmark.py --repeat 9 --only deck

The original is the plain version of tools/oracle/vopd.f, by gfortran -O2: it reads the deck
itself, of padded cards, and prints lines directly. Its decks are uneven (tools/uneven_deck.py).
All programs are processes on one and the same processor, run in turn, A B A B, after a run of
each that does not count. A ratio is the median of the ratios of neighbours, once of processor
time (user and system) and once of the clock. Only the first means something on a busy
machine; how busy it was is printed. The table is Markdown, as docs/performance.md has it.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from functools import cached_property
from pathlib import Path
from statistics import median
from typing import NamedTuple

import sized
from oracle.plain import compile_plain, padded

ROOT = Path(__file__).resolve().parent.parent
CASE_1 = ROOT / "decks" / "appendix_h" / "case1.dat"
UNEVEN = ROOT / "tools" / "uneven_deck.py"
PANDAS = ROOT / "tools" / "flight_by_pandas.py"
SCIPY = ROOT / "tools" / "stars_by_scipy.py"
VOPD = (sys.executable, "-m", "vopd")
ENDED_WELL = (0, 3)  # exit statuses; 3: some frame did not converge
LONG, JOBS = 9000, 10  # frames of a deck, and how many such decks are stacked
LISTS = {40: ("--swing=33",), 6: ("--swing=2", "--focal=6")}  # options that need so many landmarks
KINDS = ("start", "deck", "small", "flight", "stars", "refused", "check", "camera")
IGNORED = ("nothing", "frames", "everywhere")
DECKS, SHORT = 500, 20  # small decks, and the frames of each
FLIGHT, LONG_FLIGHT = 1000, 10_000  # frames of six picks
REFUSED = 1  # the exit status of what cannot be read


class Cost(NamedTuple):
    """Seconds of the processor and of the clock, and the memory of the largest process."""

    seconds: float
    clock_s: float
    peak_mb: float


class Row(NamedTuple):
    """One line of the table."""

    what: str
    ours: Cost
    rival: Cost
    ratio: float  # of processor time
    by_the_clock: float
    goal: float


class Bench:
    """The measurements, in a directory of their own."""

    def __init__(self, directory: Path, repeat: int) -> None:
        self.directory = directory
        self.repeat = repeat

    @cached_property
    def original(self) -> Path:
        """The compiled original: only decks and small decks need gfortran."""
        compiled = self.directory / "original"
        compile_plain(compiled)
        return compiled

    def rows(self, only: str) -> Iterator[Row]:
        """All measurements, or those of one kind."""
        kinds = {"start": self.start_up, "deck": self.decks, "small": self.small_decks}
        kinds |= {"flight": self.flights, "stars": self.stars, "refused": self.refused}
        kinds |= {"check": self.checks, "camera": self.cameras}
        for kind, measure in kinds.items():
            if only in ("", kind):
                yield from measure()

    def start_up(self) -> Iterator[Row]:
        """Case 1, and what nobody can go below, in imports of numpy."""
        numpy = self._python("import numpy")
        ours = self._vopd([CASE_1])
        yield self._row("`vopd run case1.dat` / `import numpy`", ours, numpy, 1.65, times=4)
        floor = self._python("import numpy, click")
        yield self._row("`import numpy, click` / `import numpy`", floor, numpy, 1.55, times=4)

    def decks(self) -> Iterator[Row]:
        """Six uneven decks, their median, and ten of them stacked as jobs of one."""
        jobs: list[str] = []
        rows: list[Row] = []
        for landmarks, options in LISTS.items():
            for ignored in IGNORED:
                deck = self._demo(LONG, len(jobs), "--landmarks=6", *options)
                jobs.append(f"{ignored}:{deck}")
                title = f"{LONG:,} frames, some {landmarks} landmarks, ignored {ignored}"
                rows.append(self._deck_row(title, jobs[-1:]))
        yield from rows
        ratios = median(row.ratio for row in rows), median(row.by_the_clock for row in rows)
        costs = _middle([row.ours for row in rows]), _middle([row.rival for row in rows])
        yield Row("median of these six", *costs, *ratios, 0.85)
        some = [jobs[k % len(jobs)] for k in range(JOBS)]
        yield self._deck_row(f"{LONG * JOBS:,} frames, {JOBS} jobs stacked", some)

    def small_decks(self) -> Iterator[Row]:
        """Many small decks: one process for all of ours, a start for each of the original's."""
        decks = [self._demo(SHORT, seed) for seed in range(DECKS)]
        for deck in decks:
            deck.write_bytes(padded(deck.read_bytes()))
        title = f"{DECKS} decks of {SHORT} frames / a start for each"
        yield self._row(title, self._vopd(decks), self._compiled(decks), 1.0)

    def flights(self) -> Iterator[Row]:
        """A flight against a script, and a long one against what it may take."""
        table = str(self.directory / "table.csv")
        for frames in (FLIGHT, LONG_FLIGHT):
            folder = str(self.directory / f"flight{frames}")
            self._run((sys.executable, "-m", "tools.long_flight", folder, str(frames)))
            ours = self._command((*VOPD, "attitude", f"{folder}/flight.toml", "-o", table))
            title = f"`vopd attitude`, {frames:,} frames"
            if frames == FLIGHT:
                script = self._command((sys.executable, str(PANDAS), folder, table))
                yield self._row(f"{title} / numpy and pandas", ours, script, 1.0)
            else:
                yield self._row(f"{title} / 1.2 s, 200 MB", ours, lambda: Cost(1.2, 1.2, 200), 1.0)

    def stars(self) -> Iterator[Row]:
        """Photographs of stars against a loop of scipy's align_vectors."""
        file = sized.made("photographs", self.directory / "stars.csv", 1000, 30)
        focal, table = str(sized.FOCAL_MM), str(self.directory / "stars_table.csv")
        solve = ("stars", "solve", str(file), "--focal", focal, "-q", "-o", table)
        rival = self._command((sys.executable, str(SCIPY), str(file), focal, table))
        title = "`vopd stars solve`, 1,000 photographs of 30 / a loop of align_vectors"
        yield self._row(title, self._command((*VOPD, *solve)), rival, 2.4)

    def refused(self) -> Iterator[Row]:
        """Large files that are not what they should be, and a large one that is."""
        stars = sized.made("photographs", self.directory / "alone.csv", 1, 1_000_000)
        solve = self._command((*VOPD, "stars", "solve", str(stars), "--focal", "76"), REFUSED)
        title = "`vopd stars solve`, 1,000,000 stars in one photograph / 1 s"
        yield self._row(title, solve, lambda: Cost(1.0, 1.0, 200), 1.0)
        text = str(sized.made("numbers", self.directory / "numbers", 10_600_000))
        title = "`vopd diff` of two files of 95 MB that are no listings / 5 s"
        diff = self._command((*VOPD, "diff", text, text), REFUSED)
        yield self._row(title, diff, lambda: Cost(5.0, 5.0, 100), 1.0)
        flight = sized.made("flight", self.directory / "landmarks", 100, 50_000)
        title = "`vopd check`, landmarks.csv of 50,000 rows / .75 s"
        check = self._command((*VOPD, "check", str(flight)))
        yield self._row(title, check, lambda: Cost(0.75, 0.75, 100), 1.0)

    def checks(self) -> Iterator[Row]:
        """`check` against the command that solves."""
        for title, file in (
            ("999 jobs", sized.made("jobs", self.directory / "jobs.dat", 999)),
            ("64,000 frames", sized.made("deck", self.directory / "frames.dat", 64_000)),
        ):
            check = self._command((*VOPD, "check", str(file)))
            yield self._row(f"`vopd check` / `run`, {title}", check, self._vopd([file]), 1.0)
        flight = str(sized.made("flight", self.directory / "picks", 66_667))
        check = self._command((*VOPD, "check", flight))
        table = str(self.directory / "table.csv")
        solve = self._command((*VOPD, "attitude", flight, "-q", "-o", table))
        yield self._row("`vopd check` / `attitude`, 400,000 picks", check, solve, 1.0)

    def cameras(self) -> Iterator[Row]:
        """A batch of decks of different cameras against one of equal ones."""
        folders = [self.directory / name for name in ("different", "equal")]
        for folder in folders:
            folder.mkdir()
        decks = [self._demo(3, seed, "--landmarks=4").read_text() for seed in range(20)]
        for k in range(DECKS):
            deck = decks[k % 20]
            (folders[0] / f"{k}.dat").write_text(sized.with_focal(deck, 10.4 + 0.001 * k))
            (folders[1] / f"{k}.dat").write_text(deck)

        def batch(folder: Path) -> Callable[[], Cost]:
            def run() -> Cost:
                outputs = tempfile.mkdtemp(dir=self.directory)
                return self._run((*VOPD, "batch", "-q", str(folder), "-d", outputs))

            return run

        title = f"`vopd batch`, {DECKS} decks of different cameras / of equal ones"
        yield self._row(title, *map(batch, folders), 1.1)

    def _deck_row(self, title: str, jobs: Sequence[str]) -> Row:
        deck = self.directory / "uneven.dat"
        # a process of its own: what this one needs would count as its children's memory
        self._run((sys.executable, str(UNEVEN), str(deck), *jobs))
        return self._row(title, self._vopd([deck]), self._compiled([deck]), 1.0)

    def _row(
        self,
        what: str,
        ours: Callable[[], Cost],
        rival: Callable[[], Cost],
        goal: float,
        times: int = 1,
    ) -> Row:
        """Run two programs in turn, `times` as often as asked for where they are short."""
        ours(), rival()
        pairs = [(ours(), rival()) for _ in range(times * self.repeat)]
        ratio, by_the_clock = (median(a[k] / b[k] for a, b in pairs) for k in (0, 1))
        one, two = (_middle(costs) for costs in zip(*pairs, strict=True))
        print(f"{what}: {ratio:.2f}", file=sys.stderr)
        return Row(what, one, two, ratio, by_the_clock, goal)

    def _demo(self, frames: int, seed: int, *options: str) -> Path:
        deck = self.directory / f"{frames}_{seed}.dat"
        self._run(
            (*VOPD, "demo", f"--frames={frames}", f"--seed={seed}", *options, "-o", str(deck))
        )
        return deck

    def _vopd(self, decks: Sequence[Path]) -> Callable[[], Cost]:
        tape = ("-q", "--tape10", str(self.directory / "tape"))
        return self._command((*VOPD, "run", *map(str, decks), *tape))

    def _compiled(self, decks: Sequence[Path]) -> Callable[[], Cost]:
        """Run the original, which reads its deck from standard input."""

        def run() -> Cost:
            costs = [self._run((str(self.original),), deck) for deck in decks]
            seconds, clock_s, peaks = zip(*costs, strict=True)
            return Cost(sum(seconds), sum(clock_s), max(peaks))

        return run

    def _python(self, program: str) -> Callable[[], Cost]:
        return self._command((sys.executable, "-c", program))

    def _command(self, command: Sequence[str], *ended: int) -> Callable[[], Cost]:
        return lambda: self._run(command, ended=ended or ENDED_WELL)

    def _run(
        self, command: Sequence[str], deck: Path | None = None, ended: Sequence[int] = ENDED_WELL
    ) -> Cost:
        return measured(command, self.directory, deck, ended)


LAUNCH = """
import os, sys
child = os.posix_spawnp(sys.argv[1], sys.argv[1:], os.environ)
_, status, used = os.wait4(child, 0)
print(used.ru_utime + used.ru_stime, used.ru_maxrss, file=sys.stderr)
sys.exit(os.waitstatus_to_exitcode(status))
"""
"""A small process that begins another: a peak of memory is never below that of its parent."""


def measured(
    command: Sequence[str],
    directory: Path,
    deck: Path | None = None,
    ended: Sequence[int] = ENDED_WELL,
) -> Cost:
    """Run one process with its standard output in a file; RuntimeError where it fails.

    Args:
        command: its words
        directory: for its output, and what it compiles
        deck: its standard input
        ended: exit statuses that are expected
    """
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    environment |= {"VOPD_TAPE10": str(directory / "tape_of_original")}
    # as an installed program: compiled by the run that does not count
    environment |= {"PYTHONPYCACHEPREFIX": str(directory / "compiled")}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    with (
        (directory / "output").open("wb") as output,
        Path(deck or os.devnull).open("rb") as cards,
    ):
        begun = time.perf_counter()
        done = subprocess.run(
            (sys.executable, "-S", "-E", "-c", LAUNCH, *command),
            stdin=cards, stdout=output, stderr=subprocess.PIPE, env=environment, cwd=directory,
        )  # fmt: skip
        clock_s = time.perf_counter() - begun
    *heard, figures = done.stderr.decode().rstrip("\n").split("\n")
    sys.stderr.writelines(f"{line}\n" for line in heard)
    if done.returncode not in ended:
        raise RuntimeError(f"status {done.returncode}: {' '.join(command)[:200]}")
    seconds, peak = (float(one) for one in figures.split())
    return Cost(seconds, clock_s, peak / (2**20 if sys.platform == "darwin" else 2**10))


def _middle(costs: Sequence[Cost]) -> Cost:
    """The median of each figure."""
    return Cost(*(median(figures) for figures in zip(*costs, strict=True)))


def table(rows: Sequence[Row]) -> str:
    """The table in Markdown."""
    lines = [
        "| what | ours | rival | ratio | by the clock | goal |",
        "|---|---|---|---|---|---|",
    ]
    for row in rows:
        ours, rival = (
            f"{one.seconds:.3g} s, {one.peak_mb:.0f} MB" for one in (row.ours, row.rival)
        )
        met = "" if row.ratio <= row.goal else ", not met"
        ratios = f"{row.ratio:.2f} | {row.by_the_clock:.2f} | {row.goal:.2f}{met}"
        lines.append(f"| {row.what} | {ours} | {rival} | {ratios} |")
    return "\n".join(lines)


def main() -> None:
    """Run the measurements and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--repeat", type=int, default=5, metavar="N", help="pairs (%(default)s)")
    parser.add_argument("--only", default="", choices=KINDS)
    arguments = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    before = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as directory:
        rows = list(Bench(Path(directory), arguments.repeat).rows(arguments.only))
    print(table(rows))
    after = os.getloadavg()[0]
    print(f"\nLoad average {before:.1f} before, {after:.1f} after, {os.cpu_count()} processors.")


if __name__ == "__main__":
    main()
