"""The command line as a function, and functions that a command is watched by."""

from __future__ import annotations

import os
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import patch

import click.testing
import pytest
from click.testing import CliRunner

from vopd.cli import cli

ROOT = Path(__file__).parents[2]
DECKS = ROOT / "decks"
CASE_1 = DECKS / "appendix_h" / "case1.dat"
CASE_4 = DECKS / "appendix_h" / "case4.dat"
"""A deck of one job without a doubtful card."""
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


def vopd(
    *arguments: str | os.PathLike[str], stdin: str | bytes | None = None, terminal: bool = False
) -> Ran:
    """Run `vopd` with these arguments in this process, through its own error boundary.

    An exception that the boundary does not turn into a message is raised here. With `terminal`
    standard output says that it is one.
    """
    stream, plain = click.testing._NamedTextIOWrapper, click.testing._NamedTextIOWrapper.isatty
    shown = patch.object(
        stream, "isatty", lambda own: own.name == "<stdout>" if terminal else plain(own)
    )
    with shown:
        done = CliRunner().invoke(cli, [os.fspath(one) for one in arguments], input=stdin)
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return Ran(done.exit_code, done.stdout, done.stderr, done.stdout_bytes, done.output)


# What a command hands to the function that does its work


class Told(Exception):
    """The work is not done: what was asked for is known."""


def telling(told: list[Any]) -> Callable[..., Any]:
    """A function that notes its arguments and ends the command."""

    def work(*arguments: Any, **named: Any) -> Any:
        told.append((*arguments, *named.values()))
        raise Told

    return work


def handed(monkeypatch: pytest.MonkeyPatch, module: Any, name: str, *words: Any) -> Any:
    """What `name` is given when the command runs."""
    told: list[Any] = []
    monkeypatch.setattr(module, name, telling(told))
    with pytest.raises(Told):
        vopd(*words)
    return told[0]


# Memory


def peak(work: Callable[[], object], begun: bool = False) -> int:
    """The most memory that some work has at a time, bytes.

    Args:
        work: what is done
        begun: whether tables that are made once are there already, by the same work before
    """
    if not begun:
        work()
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
