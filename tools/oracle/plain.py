"""The oracle without its filters, as fast as the program of 1974 itself would be.

    python tools/oracle/plain.py PROGRAM
    python tools/oracle/plain.py PROGRAM --check decks/appendix_h/*.dat

Compile vopd.f into PROGRAM after two changes: unit 5 is the deck itself, whose cards must
have 80 columns (`padded`), and numbers are printed at once, with the zero before the point
that gfortran gives them. So it does what the filtered program does and no more, which makes
it the one to measure against. With `--check` decks are run by both: listings must be
the same text once the zeros are taken away, and tapes the same bytes. Exit status: 0 no
difference, 1 some difference.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parent / "vopd.f"
COMPILE = ("gfortran", "-std=legacy", "-O2", "-fdefault-real-8", "-fdefault-double-8")
COPY_OF_DECK = re.compile(r"      CLOSE \(5\)\n.*?      REWIND 5\n", re.DOTALL)
DECK_ITSELF = "      OPEN (5,FILE='/dev/stdin',STATUS='OLD',ACTION='READ',BLANK='ZERO')\n"
ZERO_BEFORE_POINT = re.compile(rb"([ -])0(?=\.\d*+(?!E))")  # FORMAT 102 keeps its own


def plain_source(source: str) -> str:
    """Take the filters out of the oracle's source; columns 73 to 80 stay in their places."""
    source, decks = COPY_OF_DECK.subn(DECK_ITSELF, source)
    source, lines = re.subn(r"WRITE \(LINE,", "WRITE (   6,", source)
    source, calls = re.subn(r"CALL PRT \(.*\)$", "CONTINUE", source, flags=re.MULTILINE)
    if decks != 1 or lines != calls or not lines:
        raise ValueError(f"{SOURCE}: {decks} copies of the deck, {lines} lines, {calls} calls")
    return source


def compile_plain(program: Path) -> None:
    """Compile the plain program; raises CalledProcessError or FileNotFoundError."""
    with tempfile.TemporaryDirectory() as name:
        source = Path(name) / "plain.f"
        source.write_text(plain_source(SOURCE.read_text(encoding="ascii")), encoding="ascii")
        subprocess.run([*COMPILE, str(source), "-o", str(program)], check=True)


def padded(deck: bytes) -> bytes:
    """Pad or cut each card to 80 columns."""
    return b"".join(card[:80].ljust(80) + b"\n" for card in deck.splitlines())


def without_zeros(listing: bytes) -> bytes:
    """Take away the zeros before points, the sign moving to the right, as PRT of vopd.f does."""
    return ZERO_BEFORE_POINT.sub(rb" \1", listing)


def differences(plain: Path, filtered: Path, deck: Path, directory: Path) -> list[str]:
    """Name what differs between the two programs on one deck."""
    made = []
    for program, cards in ((plain, padded(deck.read_bytes())), (filtered, deck.read_bytes())):
        given, tape = directory / "deck", directory / "tape"
        given.write_bytes(cards)
        with given.open("rb") as opened:
            done = subprocess.run(
                [str(program)],
                stdin=opened,
                capture_output=True,
                env={**os.environ, "VOPD_TAPE10": str(tape)},
                check=False,
            )
        listing = done.stdout if program is filtered else without_zeros(done.stdout)
        made.append((listing, tape.read_bytes(), done.returncode))
    names = ("listing", "tape", "exit status")
    return [name for name, one, two in zip(names, *made, strict=True) if one != two]


def main() -> int:
    """Compile the plain program, and check it if asked to."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program", type=Path, help="where to put it")
    parser.add_argument("--check", nargs="+", type=Path, default=[], metavar="DECK")
    arguments = parser.parse_args()
    compile_plain(arguments.program)
    status = 0
    with tempfile.TemporaryDirectory() as name:
        filtered = Path(name) / "filtered"
        if arguments.check:
            subprocess.run([*COMPILE, str(SOURCE), "-o", str(filtered)], check=True)
        for deck in arguments.check:
            for what in differences(arguments.program.resolve(), filtered, deck, Path(name)):
                print(f"{deck}: another {what}")
                status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
