"""Approved cases of flights."""

from __future__ import annotations

from pathlib import Path

from tests.approved.approved import approved, assert_as_approved
from tests.approved.cases import Case


@approved("flights")
def test_case(case: Case, tmp_path: Path) -> None:
    assert_as_approved("flights", case, tmp_path)
