"""A process that dies while others are at work: every chunk has one result, in a made-up pool."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager

import pytest

from vopd.batch import processes
from vopd.batch.processes import in_processes


class Late(Future[str]):
    """A future that is not done when another one is, and has its result when asked for it."""

    def __init__(self, text: str | None) -> None:
        super().__init__()
        self.text = text

    def result(self, timeout: float | None = None) -> str:
        if self.text is None:
            raise BrokenProcessPool
        return self.text


class MadeUpPool:
    """A pool that works at once, but for the chunks whose end is given."""

    def __init__(self, ends: dict[str, Future[str]]) -> None:
        self.ends = ends

    def submit(self, work: Callable[[str], str], chunk: str) -> Future[str]:
        if chunk in self.ends:
            return self.ends.pop(chunk)
        done: Future[str] = Future()
        done.set_result(work(chunk))
        return done


def broken() -> Future[str]:
    future: Future[str] = Future()
    future.set_exception(BrokenProcessPool())
    return future


def shout(chunk: str) -> str:
    return chunk.upper()


@pytest.mark.parametrize("others", [("late", "late"), ("late", "lost"), ("lost", "lost")])
@pytest.mark.parametrize("count", [3, 7])
def test_every_chunk_has_one_result(
    monkeypatch: pytest.MonkeyPatch, others: tuple[str, str], count: int
) -> None:
    """The first of three that are at work is lost; of the others some end well after that."""
    chunks = [f"{letter}{letter.upper()}" for letter in "abcdefg"[:count]]
    ends = {chunks[0]: broken()}
    for chunk, end in zip(chunks[1:3], others, strict=True):
        ends[chunk] = Late(shout(chunk) if end == "late" else None)
    pools: list[int] = []

    @contextmanager
    def pool(jobs: int) -> Iterator[MadeUpPool]:
        pools.append(jobs)
        yield MadeUpPool(ends)

    monkeypatch.setattr(processes, "_pool", pool)
    found = list(in_processes(shout, chunks, 2, lambda one: [one], lambda one: f"no {one}"))
    assert sorted(found) == sorted(map(shout, chunks)) and pools == [2, 1, 2]


def test_a_chunk_that_ends_its_process_twice_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """And a chunk of two is split: the one at fault is given up alone."""

    class Deadly(MadeUpPool):
        def submit(self, work: Callable[[str], str], chunk: str) -> Future[str]:
            if "x" in chunk:
                tried.append(chunk)
                return broken()
            return super().submit(work, chunk)

    @contextmanager
    def pool(_: int) -> Iterator[MadeUpPool]:
        yield Deadly({})

    tried: list[str] = []
    monkeypatch.setattr(processes, "_pool", pool)
    found = list(in_processes(shout, ["a", "bx", "c"], 2, list, lambda one: f"no {one}"))
    assert sorted(found) == ["A", "B", "C", "no x"]
    assert tried == ["bx", "x", "x"]
