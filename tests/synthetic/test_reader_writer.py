"""tools/reader_writer.f, the yardstick of the benchmark, reads and writes what the program does."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from vopd.cards.writer import write_deck
from vopd.listing.pages import end_of_case, listing_text
from vopd.program.vopd import run
from vopd.synthetic.plan import Plan
from vopd.synthetic.scene import make

SOURCE = Path(__file__).parents[2] / "tools" / "reader_writer.f"


@pytest.mark.skipif(shutil.which("gfortran") is None, reason="no gfortran here")
def test_lines_columns_and_size_are_those_of_the_listing(tmp_path: Path) -> None:
    program, deck = tmp_path / "reader_writer", tmp_path / "deck.dat"
    reals = ("-fdefault-real-8", "-fdefault-double-8")
    compile_it = ("gfortran", "-std=legacy", "-O2", *reals, str(SOURCE), "-o", str(program))
    subprocess.run(compile_it, check=True)
    (job,), _ = make(Plan(frames=30, landmarks=5))
    deck.write_text(write_deck([job]), encoding="ascii")
    done = subprocess.run([str(program), str(deck)], capture_output=True, check=True)
    written = done.stdout.decode("ascii").splitlines()
    printed = (listing_text(run(job)) + end_of_case().decode("ascii")).splitlines()
    assert [len(line) for line in written] == [len(line) for line in printed]
    headings = [line for line in printed if "  " in line and not any(c.isdigit() for c in line[1:])]
    assert len(headings) > 100
    assert [line for line in written if line in headings] == headings
