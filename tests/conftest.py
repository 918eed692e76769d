"""Property tests are not timed: a busy machine is no defect. Fixtures that many rooms use.

A wrong writer that root runs can replace /dev/null by a file: it is made a device again.
"""

from __future__ import annotations

import gc
import os
import pickle
import stat
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from tests.approved import texts

settings.register_profile("suite", deadline=None, max_examples=50)
settings.load_profile("suite")
gc.disable()  # while tests are collected


def pytest_collection_finish() -> None:
    """Garbage is looked for less often, and not among the tests: an eighth of all time."""
    gc.freeze()
    gc.set_threshold(50_000, 20, 20)
    gc.enable()


@pytest.fixture(scope="module", autouse=True)
def devices() -> Iterator[None]:
    """The devices that tests write to stay devices, also where a test fails."""
    minor = {Path("/dev/null"): 3, Path("/dev/full"): 7}
    there = [path for path in minor if path.is_char_device()]
    yield
    for path in there:
        if not path.is_char_device():
            path.unlink(missing_ok=True)
            os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, minor[path]))
            path.chmod(0o666)
            pytest.fail(f"{path} was replaced by a file; it is a device again")


@pytest.fixture
def no_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """As without matplotlib: the figures of a report take most of its time."""
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)


@pytest.fixture
def not_laid_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures are drawn without their layout, a third of the time; tests/figures looks at it."""
    engine = "matplotlib.layout_engine.ConstrainedLayoutEngine.execute"
    monkeypatch.setattr(engine, lambda *_: None)


@pytest.fixture
def saved_empty(monkeypatch: pytest.MonkeyPatch, not_laid_out: None) -> None:
    """Figures are made and not drawn, three quarters of the time; an empty one is saved."""
    from matplotlib.figure import Figure

    save = Figure.savefig

    def saved(figure: Figure, *args: Any, **options: Any) -> None:
        save(Figure(figure.get_size_inches()), *args, **options)

    monkeypatch.setattr(Figure, "savefig", saved)


@pytest.fixture
def solved_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What one command has solved others take, where all that they have read is the same."""
    from vopd.flight import result

    solve, known = result.solve_flight_read, dict[tuple[bytes, bool], result.FlightResult]()

    def solved(
        read: Any, tell: Any = lambda: None, project: Any = None, doubted: bool = True
    ) -> Any:
        key = pickle.dumps((read, doubted)), project is None
        if key not in known:
            known[key] = solve(read, tell, project, doubted)
        return known[key]

    for room in ("result", "check", "adjust.adjustment"):
        monkeypatch.setattr(f"vopd.flight.{room}.solve_flight_read", solved)


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Any]:
    """One browser for the pages of all tests, each of which takes back what it has emulated."""
    from tests.kit.browser import open_browser

    yield from open_browser(tmp_path_factory.mktemp("browser"))


@pytest.fixture(scope="session", autouse=True)
def temporary(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> None:
    """Paths of temporary folders are not among the approved texts."""
    request.config.stash[texts.TEMPORARY] = str(tmp_path_factory.getbasetemp())


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Function) -> Iterator[None]:
    """A test comes to each text that is approved for it."""
    updated = item.config.stash.get(texts.COLLECTED, None)
    test = texts.of_item(item, updated is not None)
    texts.RUNNING.append(test)
    try:
        yield
    finally:
        texts.RUNNING.pop()
    test.finish()
    if updated is not None:
        updated.append(test)
