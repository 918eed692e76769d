"""Work on chunks in several processes; a process that dies costs no chunk but its own."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing.context import BaseContext
from typing import TypeVar

C = TypeVar("C")
R = TypeVar("R")

ATTEMPTS = 2  # by itself in a process; a chunk that ends that process each time is given up
COPIES = "forkserver"  # a way in which Python starts processes
LOADED = ["vopd.batch.run", "vopd.film", "vopd.cards.read"]
STARTING = ("SIGINT", "SIGHUP")  # not SIGTERM, by which a pool ends its processes


def in_processes(
    work: Callable[[C], R],
    chunks: Iterable[C],
    jobs: int,
    split: Callable[[C], list[C]],
    given_up: Callable[[C], R],
) -> Iterator[R]:
    """Work on chunks in processes, and give the results as they are made.

    Where a process dies, all chunks that were being worked on are split and worked on
    again, one at a time, so that the one at fault is by itself.

    Args:
        work: what to do with a chunk; it is pickled
        chunks: the chunks
        jobs: the number of processes
        split: takes a chunk apart; one that cannot be is returned by itself
        given_up: makes the result of a chunk that has ended its process `ATTEMPTS` times
    """
    waiting = iter(chunks)
    suspects: deque[tuple[C, int]] = deque()  # with the attempts that each has had
    while True:
        lost: list[C] = []
        if suspects:
            yield from _one_at_a_time(work, suspects, given_up)
        with _pool(jobs) as pool:
            running: dict[Future[R], C] = {}
            while not lost:
                for chunk in _some(waiting, jobs + 1 - len(running)):
                    try:
                        running[_submit(pool, work, chunk)] = chunk
                    except BrokenProcessPool:
                        lost.append(chunk)
                        break
                if not running:
                    break
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    chunk = running.pop(future)
                    try:
                        yield future.result()
                    except BrokenProcessPool:
                        lost.append(chunk)
            if lost:  # all others that were begun are lost with it, or done
                for future, chunk in running.items():
                    try:
                        yield future.result()
                    except BrokenProcessPool:
                        lost.append(chunk)
        if not lost:
            return
        suspects.extend((one, 0) for chunk in lost for one in split(chunk))


def _one_at_a_time(
    work: Callable[[C], R], suspects: deque[tuple[C, int]], given_up: Callable[[C], R]
) -> Iterator[R]:
    """Work on chunks one at a time in a process of their own, until none is left."""
    while suspects:
        with _pool(1) as pool:
            while suspects:
                chunk, attempts = suspects.popleft()
                try:
                    yield _submit(pool, work, chunk).result()
                except BrokenProcessPool:
                    if attempts + 1 < ATTEMPTS:
                        suspects.append((chunk, attempts + 1))
                    else:
                        yield given_up(chunk)
                    break


def _some(waiting: Iterator[C], count: int) -> Iterator[C]:
    for _ in range(count):
        try:
            yield next(waiting)
        except StopIteration:
            return


def _submit(pool: ProcessPoolExecutor, work: Callable[[C], R], chunk: C) -> Future[R]:
    with _signals_wait():
        return pool.submit(work, chunk)


@contextmanager
def _pool(jobs: int) -> Iterator[ProcessPoolExecutor]:
    """Start processes, and end them; at an error work that has not begun is dropped."""
    pool = ProcessPoolExecutor(jobs, mp_context=_context(), initializer=_begin)
    try:
        yield pool
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def load_ahead() -> None:
    """Begin to load what processes need, while this one goes on to find out what they are to do.

    A process of its own loads it once, and the processes that work are copies of that one.
    Windows has no such copies.
    """
    if _context().get_start_method() == COPIES:
        from multiprocessing import forkserver, resource_tracker

        # Control-C leaves semaphores behind, which the tracker removes; nobody needs to read of it.
        sys.warnoptions.append("ignore:resource_tracker:UserWarning")
        resource_tracker.ensure_running()  # which would let the signals through
        with _signals_wait():
            forkserver.ensure_running()


def _context() -> BaseContext:
    """Choose copies of a process that has loaded the package, if the system has them."""
    if COPIES not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context(COPIES)
    context.set_forkserver_preload(LOADED)
    return context


@contextmanager
def _signals_wait() -> Iterator[None]:
    """Hold signals back while processes start, which inherit this: only their parent acts on them.

    Windows has no such mask.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    numbers = [getattr(signal, name) for name in STARTING]
    before = signal.pthread_sigmask(signal.SIG_BLOCK, numbers)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin() -> None:
    """Prepare a process: it ends when its parent has ended, however that ended."""
    parent = multiprocessing.parent_process()
    assert parent is not None

    def end_with_parent() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=end_with_parent, daemon=True).start()
