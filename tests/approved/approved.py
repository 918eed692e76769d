"""Groups of approved cases, and the comparison of a case with what is approved."""

from __future__ import annotations

import importlib.metadata
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

import pytest

from tests.approved.cases import HERE, TRIALS, Case, read_cases, read_trials, run_case
from tests.approved.compare import compare
from tests.approved.store import Folders, OneText, Store

EXPECTED = HERE / "expected"
CLICK = "8.5"
"""Help and wrong usage are in the words and lines of this version of click."""


@dataclass(frozen=True)
class Group:
    """Cases, and where their expected outputs are."""

    cases: list[Case]
    store: Store


@cache
def _of_file(name: str) -> Group:
    return Group(read_cases(HERE / "cases" / f"{name}.toml"), Folders(EXPECTED))


@cache
def _of_trials() -> Group:
    return Group(read_trials(), OneText(TRIALS / "expected.txt"))


GROUPS: dict[str, Callable[[], Group]] = {
    path.stem: partial(_of_file, path.stem) for path in sorted((HERE / "cases").glob("*.toml"))
} | {"trials": _of_trials}


def approved(group: str) -> pytest.MarkDecorator:
    """Parametrise a test by the cases of a group."""
    return pytest.mark.parametrize("case", GROUPS[group]().cases, ids=lambda case: case.name)


def assert_as_approved(group: str, case: Case, folder: Path) -> None:
    """Fail unless a case does what is approved.

    Args:
        folder: empty; the case runs in it
    """
    if case.terminal and os.name != "posix":
        pytest.skip("no pseudo-terminals")
    expected = GROUPS[group]().store.read(case.name)
    assert expected is not None, "not approved: python -m tests.approved.update"
    outcome = run_case(case, folder)
    if case.statuses is not None:
        assert outcome.statuses == case.statuses, f"status {outcome.statuses}"
    if importlib.metadata.version("click").startswith(CLICK) or not _is_of_click(case, expected):
        found = [
            f"{name}: {difference.what}"
            for name in sorted(expected.keys() & outcome.outputs.keys())
            for difference in compare(expected[name], outcome.outputs[name])
        ]
        assert not found, "\n".join(found)
    assert outcome.outputs.keys() == expected.keys(), f"files {sorted(outcome.outputs)}"


def _is_of_click(case: Case, expected: dict[str, str]) -> bool:
    """Whether click says some of it: help, and what is wrong with a command line."""
    return "help" in case.name or "Usage: vopd" in "".join(expected.values())
