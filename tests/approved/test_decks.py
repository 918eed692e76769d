"""Approved cases of decks."""

from __future__ import annotations

from pathlib import Path

from tests.approved.approved import approved, assert_as_approved
from tests.approved.cases import Case


@approved("decks")
def test_case(case: Case, tmp_path: Path) -> None:
    assert_as_approved("decks", case, tmp_path)
