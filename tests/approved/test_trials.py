"""Approved cases of frozen trials of tools/fuzz."""

from __future__ import annotations

from pathlib import Path

from tests.approved.approved import approved, assert_as_approved
from tests.approved.cases import Case


@approved("trials")
def test_case(case: Case, tmp_path: Path) -> None:
    assert_as_approved("trials", case, tmp_path)
