"""Run decks through the FORTRAN oracle and through `vopd run`, and name the first difference.

    python tools/oracle/compare.py decks/appendix_h/*.dat

The oracle is compiled into a temporary directory. Of each deck the two listings must be the
same text, both programs must end well or neither, and the two attitude tapes (TI, PSI, THETA,
PHI, ALPHA, BETA, ETA in seconds and degrees) must agree within a relative 1e-9. Exit status:
0 no difference, 1 some difference, 2 the oracle could not be compiled.
"""

from __future__ import annotations

import argparse
import itertools
import math
import os
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SOURCE = HERE / "vopd.f"
COMPILE = (
    "gfortran",
    "-std=legacy",
    "-O1",
    "-ffp-contract=off",
    "-fdefault-real-8",
    "-fdefault-double-8",
)
RELATIVE_TOLERANCE = 1e-9  # of a tape value; the two programs add up in a different order
PORT_ENDED_WELL = (0, 3)  # 3: some frame did not converge
RECORD = struct.Struct("<i7di")  # byte count, seven doubles, byte count again
NAMES = ("TI", "PSI", "THETA", "PHI", "ALPHA", "BETA", "ETA")


class Run(NamedTuple):
    """What one program made of one deck."""

    listing: list[str]
    tape: list[tuple[float, ...]]
    ended_well: bool
    message: str


def compile_oracle(directory: Path) -> Path:
    """Compile the oracle into `directory`; raises CalledProcessError or FileNotFoundError."""
    program = directory / "vopd-oracle"
    subprocess.run([*COMPILE, str(SOURCE), "-o", str(program)], check=True)
    return program


def read_tape(path: Path) -> list[tuple[float, ...]]:
    """Read the records of seven numbers each; an absent tape has none.

    Raises ValueError when the file is not made of such records.
    """
    data = path.read_bytes() if path.exists() else b""
    if len(data) % RECORD.size:
        raise ValueError(f"{path}: {len(data)} bytes are not records of {RECORD.size}")
    records = list(RECORD.iter_unpack(data))
    if any(record[0] != 56 or record[-1] != 56 for record in records):
        raise ValueError(f"{path}: a record does not hold seven double precision numbers")
    return [record[1:-1] for record in records]


def run_oracle(program: Path, deck: Path, directory: Path) -> Run:
    """Run the oracle on `deck`; it ended well if it printed END OF CASE."""
    tape = directory / "oracle.tape"
    tape.unlink(missing_ok=True)
    with deck.open("rb") as cards:
        done = subprocess.run(
            [str(program)],
            stdin=cards,
            capture_output=True,
            env={**os.environ, "VOPD_TAPE10": str(tape)},
            check=False,
        )
    listing = done.stdout.decode("latin-1").split("\n")
    ended_well = done.returncode == 0 and " END OF CASE" in listing
    return Run(listing, read_tape(tape), ended_well, done.stderr.decode("latin-1"))


def run_port(deck: Path, directory: Path, tape_option: str) -> Run:
    """Run `vopd run` of this checkout on `deck`, with `tape_option` naming the tape if given."""
    tape = directory / "port.tape"
    tape.unlink(missing_ok=True)
    options = [tape_option, str(tape)] if tape_option else []
    done = subprocess.run(
        [sys.executable, "-m", "vopd", "run", str(deck.resolve()), *options],
        cwd=ROOT,
        capture_output=True,
        check=False,
    )
    listing = done.stdout.decode("latin-1").split("\n")
    ended_well = done.returncode in PORT_ENDED_WELL
    return Run(listing, read_tape(tape), ended_well, done.stderr.decode("latin-1"))


def listing_difference(oracle: list[str], port: list[str]) -> Iterator[str]:
    """Name the first line at which the two listings differ, if there is one."""
    pairs = itertools.zip_longest(oracle, port, fillvalue="(no line)")
    for number, (wanted, got) in enumerate(pairs, 1):
        if wanted != got:
            yield f"line {number}\n  oracle: {wanted!r}\n  vopd:   {got!r}"
            return


def tape_difference(
    oracle: list[tuple[float, ...]], port: list[tuple[float, ...]]
) -> Iterator[str]:
    """Name the number of records if it differs, and each value beyond the tolerance."""
    if len(oracle) != len(port):
        yield f"tape: {len(oracle)} records in the oracle's, {len(port)} in vopd's"
    for number, records in enumerate(zip(oracle, port, strict=False), 1):
        for name, wanted, got in zip(NAMES, *records, strict=True):
            both_nan = math.isnan(wanted) and math.isnan(got)
            if not both_nan and not math.isclose(wanted, got, rel_tol=RELATIVE_TOLERANCE):
                yield f"tape record {number}, {name}: oracle {wanted!r}, vopd {got!r}"


def compare(program: Path, deck: Path, directory: Path, tape_option: str) -> list[str]:
    """Return every difference found for one deck, none if the two programs agree."""
    oracle = run_oracle(program, deck, directory)
    port = run_port(deck, directory, tape_option)
    found = list(listing_difference(oracle.listing, port.listing))
    if tape_option:
        found += tape_difference(oracle.tape, port.tape)
    if oracle.ended_well != port.ended_well:
        which, run = ("vopd", port) if oracle.ended_well else ("the oracle", oracle)
        found.append(f"only {which} failed: {run.message.strip()}")
    return found


def main() -> int:
    """Compare the decks on the command line; the exit status is the module docstring's."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("decks", nargs="+", type=Path, metavar="DECK")
    parser.add_argument("--oracle", type=Path, help="a compiled oracle, instead of compiling it")
    parser.add_argument(
        "--tape-option",
        default="--tape10",
        help="option of `vopd run` that names the tape file; empty: leave tapes out (%(default)s)",
    )
    arguments = parser.parse_args()
    status = 0
    with tempfile.TemporaryDirectory() as name:
        directory = Path(name)
        try:
            program = arguments.oracle or compile_oracle(directory)
        except (OSError, subprocess.CalledProcessError) as error:
            print(f"cannot compile {SOURCE}: {error}", file=sys.stderr)
            return 2
        for deck in arguments.decks:
            for difference in compare(program.resolve(), deck, directory, arguments.tape_option):
                print(f"{deck}: {difference}")
                status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
