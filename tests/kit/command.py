"""The command line as a function: what a process would print, and its exit status."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

from click.testing import CliRunner

from vopd.cli import cli

ROOT = Path(__file__).parents[2]
DECKS = ROOT / "decks"
CASE_1 = DECKS / "appendix_h" / "case1.dat"
KERNELS = ("NPY_DISABLE_CPU_FEATURES", "OPENBLAS_CORETYPE")
PROCESSOR = {name: os.environ[name] for name in KERNELS if name in os.environ}
"""What makes this process compute as another processor would; processes that it compares itself
with need the same, also those with an environment of their own."""


class Ran(NamedTuple):
    """How a command ended. `output` is standard output as it was written, byte for byte.

    `terminal` is both streams as they came, where that is known.
    """

    status: int
    stdout: str
    stderr: str
    output: bytes
    terminal: str = ""


def vopd(*arguments: str | os.PathLike[str], stdin: str | bytes | None = None) -> Ran:
    """Run `vopd` with these arguments in this process, through its own error boundary.

    An exception that the boundary does not turn into a message is raised here.
    """
    done = CliRunner().invoke(cli, [os.fspath(one) for one in arguments], input=stdin)
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return Ran(done.exit_code, done.stdout, done.stderr, done.stdout_bytes, done.output)
