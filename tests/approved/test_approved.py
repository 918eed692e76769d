"""Approved cases: exit status, both streams and all files of command lines, as they are kept.

`python -m tests.approved.update` rewrites what only changed its words; CONTRIBUTING.md has more.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.approved.cases import EXPECTED, Case, read_cases, run_case
from tests.approved.compare import compare
from tests.approved.store import read_expected

CASES = read_cases()


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_case(case: Case, tmp_path: Path) -> None:
    """A command does what it did."""
    if case.terminal and os.name != "posix":
        pytest.skip("no pseudo-terminals")
    expected = read_expected(case.name)
    assert expected is not None, "not approved: python -m tests.approved.update"
    outcome = run_case(case, tmp_path)
    found = [
        f"{name}: {difference.what}"
        for name in sorted(expected.keys() & outcome.outputs.keys())
        for difference in compare(expected[name], outcome.outputs[name])
    ]
    assert found == []
    assert outcome.statuses == case.statuses
    assert sorted(outcome.outputs) == sorted(expected)


def test_every_expected_output_has_a_case() -> None:
    assert {path.name for path in EXPECTED.iterdir()} == {case.name for case in CASES}
