"""Property tests are not timed: a busy machine is no defect. Fixtures that many rooms use."""

from __future__ import annotations

import sys

import pytest
from hypothesis import settings

settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")


@pytest.fixture
def no_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """As without matplotlib: the figures of a report take most of its time."""
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
