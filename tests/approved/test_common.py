"""Approved cases of all commands."""

from __future__ import annotations

from pathlib import Path

from tests.approved.approved import approved, assert_as_approved
from tests.approved.cases import Case


@approved("common")
def test_case(case: Case, tmp_path: Path) -> None:
    assert_as_approved("common", case, tmp_path)
