"""The printed numbers of Rae (1987) as a fixture."""

from __future__ import annotations

import pytest

from tests.kit.rae_listings import Golden, read_golden


@pytest.fixture
def golden() -> Golden:
    """Reads a golden file: a list of rows by column name, never empty."""
    return read_golden
