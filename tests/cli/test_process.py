"""The command line as a process: what it does where its output cannot go."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

FULL = Path("/dev/full")
CASE_1 = Path(__file__).parents[2] / "decks" / "appendix_h" / "case1.dat"
VOPD = [sys.executable, "-m", "vopd"]


@pytest.mark.skipif(not FULL.exists(), reason="no device that is always full")
@pytest.mark.parametrize("arguments", [["errata"], ["run", str(CASE_1)], ["--help"]])
def test_a_full_disk_is_a_message_and_status_1(arguments: list[str]) -> None:
    """Whether the output is written as it comes or at the very end."""
    with FULL.open("wb") as full:
        run = subprocess.run([*VOPD, *arguments], stdout=full, stderr=subprocess.PIPE, text=True)
    assert (run.returncode, run.stderr) == (1, "standard output: No space left on device\n")


def test_all_is_written_before_the_process_ends() -> None:
    run = subprocess.run([*VOPD, "run", str(CASE_1)], capture_output=True, text=True)
    assert run.returncode == 0 and run.stdout.endswith("END OF CASE\n")


def test_a_status_reaches_the_shell() -> None:
    assert subprocess.run([*VOPD, "run", "--no-such"], capture_output=True).returncode == 2
    assert subprocess.run([*VOPD, "run", "no-such.dat"], capture_output=True).returncode == 1
