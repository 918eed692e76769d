"""The command line as a process: what it does where its output cannot go.

The environment is empty but for what a process needs, so that no variable of a
developer's machine (PYTHONUNBUFFERED above all) can hide a failure.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.kit.command import CASE_1, ROOT

FULL = Path("/dev/full")
VOPD = [sys.executable, "-m", "vopd"]
ENVIRONMENT = {
    "PATH": os.defpath,
    "PYTHONPATH": str(ROOT),
    "LANG": "C.UTF-8",
    **{name: os.environ[name] for name in ("SYSTEMROOT",) if name in os.environ},
}
BUFFERED = [ENVIRONMENT, ENVIRONMENT | {"PYTHONUNBUFFERED": "1"}]


def process(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*VOPD, *arguments],
        text=True,
        **({"env": ENVIRONMENT} | options),  # type: ignore[call-overload]
    )


@pytest.mark.skipif(not FULL.exists(), reason="no device that is always full")
@pytest.mark.parametrize("environment", BUFFERED, ids=["buffered", "unbuffered"])
@pytest.mark.parametrize(
    "arguments", [["errata"], ["run", str(CASE_1)], ["--help"], ["run", "--help"]], ids=str
)
def test_a_full_disk_is_one_message_and_status_1(
    arguments: list[str], environment: dict[str, str]
) -> None:
    """Whether the output is written as it comes or at the very end."""
    with FULL.open("wb") as full:
        run = process(*arguments, stdout=full, stderr=subprocess.PIPE, env=environment)
    assert (run.returncode, run.stderr) == (1, "standard output: No space left on device\n")


@pytest.mark.parametrize("environment", BUFFERED, ids=["buffered", "unbuffered"])
def test_a_reader_that_has_seen_enough_is_no_failure(environment: dict[str, str]) -> None:
    pages = str(ROOT / "decks" / "appendix_h" / "cases_1_2_3.dat")
    command = f'"{sys.executable}" -m vopd run "{pages}" "{pages}" 2>&1 1>&3 | cat >&2'
    script = f'{{ {command}; echo "${{PIPESTATUS[0]}}" >&2; }} 3>&1 | head -n 1'
    run = subprocess.run(
        ["bash", "-c", script], capture_output=True, text=True, env=environment, check=False
    )
    assert run.stdout.startswith("1   VIKING") and run.stderr == "0\n"


def test_all_is_written_before_the_process_ends() -> None:
    run = process("run", str(CASE_1), capture_output=True)
    assert run.returncode == 0 and run.stdout.endswith("END OF CASE\n")


def test_a_status_reaches_the_shell() -> None:
    assert process("run", "--no-such", capture_output=True).returncode == 2
    assert process("run", "no-such.dat", capture_output=True).returncode == 1
