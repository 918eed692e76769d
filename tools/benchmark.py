"""How long `vopd run` takes, where, and against a FORTRAN program that only reads and writes.

    python tools/benchmark.py
    python tools/benchmark.py --frames 100,9000 --landmarks 6 --repeat 9 --profile

Decks are made by `vopd demo`. Everything that is compared is run in turn, A B A B,
and a ratio is the median of the ratios of neighbours, so that a busy machine disturbs
both sides alike. Times are medians; user is the processor's, wall the clock's. Peak
memory is the child's own. Where gfortran is present, tools/reader_writer.f is compiled
and held against `vopd run`; where it is not, that part is left out.
"""

from __future__ import annotations

import argparse
import json
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

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
CASE_1 = ROOT / "decks" / "appendix_h" / "case1.dat"
SOURCE = HERE / "reader_writer.f"
GFORTRAN = ("gfortran", "-std=legacy", "-O2", "-fdefault-real-8", "-fdefault-double-8")
VOPD = (sys.executable, "-m", "vopd")
GOOD = (0, 3)  # 3: some frame did not converge
TABLE_ROWS = (4, 2000)  # trajectories that are compared


class Cost(NamedTuple):
    """What one process used: seconds by the clock and of the processor, peak memory."""

    wall_s: float
    user_s: float
    system_s: float
    peak_mb: float


Command = Sequence[str]


def measure(command: Command, output: Path) -> Cost:
    """Run a command with its standard output in a file; raises RuntimeError where it fails.

    This process is kept small: a child's peak begins with that of its parent.
    """
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    # as an installed program: compiled by the run that does not count
    environment |= {"PYTHONPYCACHEPREFIX": str(output.parent / "compiled")}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    with output.open("wb") as file:
        start = time.perf_counter()
        child = subprocess.Popen(command, stdout=file, env=environment, cwd=output.parent)
        _, status, used = os.wait4(child.pid, 0)
        wall = time.perf_counter() - start
    child.returncode = os.waitstatus_to_exitcode(status)
    if child.returncode not in GOOD:
        raise RuntimeError(f"status {child.returncode}: {' '.join(command)}")
    unit = 2**20 if sys.platform == "darwin" else 2**10
    return Cost(wall, used.ru_utime, used.ru_stime, used.ru_maxrss / unit)


def in_turn(commands: dict[str, Command], repeat: int, output: Path) -> dict[str, list[Cost]]:
    """Run some commands one after the other, and all of them again, after one run of each."""
    for command in commands.values():
        measure(command, output)
    costs: dict[str, list[Cost]] = {name: [] for name in commands}
    for _ in range(repeat):
        for name, command in commands.items():
            costs[name].append(measure(command, output))
    return costs


def middle(costs: list[Cost]) -> Cost:
    """The median of each figure."""
    return Cost(*(median(figures) for figures in zip(*costs, strict=True)))


def ratio(one: list[Cost], other: list[Cost], figure: str = "wall_s") -> float:
    """The median of the ratios of neighbouring runs."""
    pairs = zip(one, other, strict=True)
    return median(getattr(a, figure) / getattr(b, figure) for a, b in pairs)


def table(title: str, header: Sequence[str], rows: list[Sequence[object]]) -> None:
    """Print a table; the first column to the left, numbers to the right."""
    text = [[f"{cell:.3f}" if isinstance(cell, float) else str(cell) for cell in r] for r in rows]
    widths = [max(map(len, column)) for column in zip(header, *text, strict=True)]
    print(f"\n{title}")
    for row in [list(header), ["-" * width for width in widths], *text]:
        first, *others = [cell.rjust(width) for cell, width in zip(row, widths, strict=True)]
        print("  " + "  ".join([first.strip().ljust(widths[0]), *others]).rstrip())


def run(deck: Path) -> Command:
    return (*VOPD, "run", str(deck))


class Bench:
    """The measurements, one method a table; `make` makes the decks."""

    def __init__(self, arguments: argparse.Namespace, directory: Path) -> None:
        self.arguments = arguments
        self.directory = directory
        self.output = directory / "output"

    def make(self, frames: int, **options: int) -> Path:
        """A deck in the directory, made once."""
        asked = {"frames": frames, "landmarks": self.arguments.landmarks} | options
        deck = self.directory / ("_".join(f"{k}_{v}" for k, v in asked.items()) + ".dat")
        if not deck.exists():
            flags = [f"--{key.replace('_', '-')}={value}" for key, value in asked.items()]
            measure((*VOPD, "demo", *flags, "-o", str(deck)), self.output)
        return deck

    def start_up(self) -> None:
        """Case 1 against what any program in Python and numpy takes."""
        commands: dict[str, Command] = {
            "python -c 'import numpy'": (sys.executable, "-c", "import numpy"),
            "python -c pass": (sys.executable, "-c", "pass"),
            "vopd --version": (*VOPD, "--version"),
            "import what vopd run needs": (sys.executable, str(HERE / "benchmark_parts.py")),
            "vopd run case1.dat": run(CASE_1),
        }
        costs = in_turn(commands, 3 * self.arguments.repeat, self.output)
        base = costs["python -c 'import numpy'"]
        rows = [
            (name, middle(c).wall_s, middle(c).user_s, ratio(c, base)) for name, c in costs.items()
        ]
        table("Start-up", ("", "wall s", "user s", "wall to numpy's"), rows)

    def growth(self) -> None:
        """Parts in one process, the whole process, memory, for each number of frames."""
        rows: list[Sequence[object]] = []
        first: tuple[int, float] | None = None
        for frames in self.arguments.frames:
            deck = self.make(frames)
            part = self.parts(deck)
            cost = middle(in_turn({"": run(deck)}, self.arguments.repeat, self.output)[""])
            each = ""
            if first is not None:
                each = f"{1e6 * (cost.wall_s - first[1]) / (frames - first[0]):.1f}"
            first = first or (frames, cost.wall_s)
            rows.append(
                (
                    frames, part["parse"], part["solve"], part["print"], sum(part.values()),
                    cost.wall_s, cost.user_s, cost.system_s, f"{frames / cost.wall_s:.0f}", each,
                    f"{cost.peak_mb:.0f}",
                )
            )  # fmt: skip
        header = (
            "frames", "parse s", "solve s", "print s", "sum s",
            "whole wall s", "user s", "system s", "frames/s", "us a further frame", "peak MB",
        )  # fmt: skip
        table(
            "Parts in one process, and the whole process (the parts, start-up, writing)",
            header,
            rows,
        )

    def parts(self, deck: Path) -> dict[str, float]:
        """Medians of parse, solve and print in a process of their own."""
        command = (sys.executable, str(HERE / "benchmark_parts.py"), str(deck))
        measure((*command, str(self.arguments.repeat)), self.output)
        times: dict[str, list[float]] = json.loads(self.output.read_text(encoding="ascii"))
        return {name: median(seconds) for name, seconds in times.items()}

    def trajectory(self) -> None:
        """A long trajectory table against a short one."""
        frames = self.arguments.frames[-1]
        decks = [self.make(frames, trajectory_rows=rows) for rows in TABLE_ROWS]
        commands = {str(n): run(deck) for n, deck in zip(TABLE_ROWS, decks, strict=True)}
        costs = in_turn(commands, self.arguments.repeat, self.output)
        base = costs[str(TABLE_ROWS[0])]
        rows = [
            (n, middle(c).wall_s, middle(c).user_s, ratio(c, base), ratio(c, base, "user_s"))
            for n, c in costs.items()
        ]
        header = "rows", "wall s", "user s", "wall ratio", "user ratio"
        table(f"Rows of the trajectory table, {frames} frames", header, rows)

    def memory(self) -> None:
        """Peak memory of the largest deck, and of one with twice its frames."""
        once = self.arguments.frames[-1]
        peaks = [measure(run(self.make(n)), self.output).peak_mb for n in (once, 2 * once)]
        rows: list[Sequence[object]] = [
            (once, f"{peaks[0]:.0f}", ""),
            (2 * once, f"{peaks[1]:.0f}", f"{1024 * (peaks[1] - peaks[0]) / once:.1f}"),
        ]
        table("Peak memory", ("frames", "MB", "kB a further frame"), rows)

    def fortran(self) -> None:
        """The whole process against the FORTRAN reader and writer."""
        if shutil.which(GFORTRAN[0]) is None:
            print("\nNo gfortran here: the FORTRAN reader and writer is left out.")
            return
        program = self.directory / "reader_writer"
        subprocess.run([*GFORTRAN, str(SOURCE), "-o", str(program)], check=True)
        deck = self.make(self.arguments.frames[-1])
        commands: dict[str, Command] = {
            "reader_writer.f": (str(program), str(deck)),
            "vopd run": run(deck),
        }
        sizes = []
        for command in commands.values():
            measure(command, self.output)
            sizes.append(self.output.stat().st_size)
        costs = in_turn(commands, self.arguments.repeat, self.output)
        base = costs["reader_writer.f"]
        rows = [
            (
                name, middle(c).wall_s, middle(c).user_s, middle(c).system_s, f"{size / 1e6:.2f}",
                ratio(c, base),
            )
            for (name, c), size in zip(costs.items(), sizes, strict=True)
        ]  # fmt: skip
        cards = deck.read_bytes().count(b"\n")
        title = f"Against FORTRAN that reads and writes only: {cards} cards, run in turn"
        table(title, ("", "wall s", "user s", "system s", "listing MB", "wall ratio"), rows)

    def profile(self) -> None:
        """Where one run spends its time."""
        deck = self.make(self.arguments.frames[-1])
        program = (
            "import cProfile, sys; from vopd.cli import main; "
            f"sys.argv = ['vopd', 'run', {str(deck)!r}, '-o', {os.devnull!r}]; "
            "cProfile.run('main()', sort='tottime')"
        )
        measure((sys.executable, "-c", program), self.output)
        print(f"\nProfile of {self.arguments.frames[-1]} frames, by own time (of the first half)")
        for line in self.output.read_text(encoding="utf-8").splitlines()[:40]:
            print("  " + line.replace(f"{ROOT}{os.sep}", ""))


def counts(text: str) -> list[int]:
    """Numbers with commas between, in ascending order."""
    numbers = sorted({int(part) for part in text.split(",")})
    if numbers[0] < 1:
        raise ValueError(text)
    return numbers


def main() -> None:
    """Run the measurements that the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--frames",
        type=counts,
        default="100,300,1000,3000,9000",
        metavar="N,N",
        help="frames of the decks; the comparisons take the largest (%(default)s)",
    )
    parser.add_argument(
        "--landmarks", type=int, default=4, metavar="N", help="a frame (%(default)s)"
    )
    parser.add_argument("--repeat", type=int, default=5, metavar="N", help="runs (%(default)s)")
    parser.add_argument("--profile", action="store_true", help="also profile the largest deck")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        bench = Bench(arguments, Path(name))
        steps: list[Callable[[], None]] = [
            bench.start_up, bench.growth, bench.trajectory, bench.memory, bench.fortran,
        ]  # fmt: skip
        for step in [*steps, bench.profile] if arguments.profile else steps:
            step()


if __name__ == "__main__":
    main()
