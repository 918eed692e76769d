"""Property tests are not timed: a busy machine is no defect. Fixtures that many rooms use."""

from __future__ import annotations

import gc
import sys

import pytest
from hypothesis import settings

settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
gc.disable()  # while tests are collected


def pytest_collection_finish() -> None:
    """Garbage is looked for less often, and not among the tests: an eighth of all time."""
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)
    gc.enable()


@pytest.fixture
def no_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """As without matplotlib: the figures of a report take most of its time."""
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)


@pytest.fixture
def not_laid_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures are drawn without their layout, a third of the time; tests/figures looks at it."""
    engine = "matplotlib.layout_engine.ConstrainedLayoutEngine.execute"
    monkeypatch.setattr(engine, lambda *_: None)
