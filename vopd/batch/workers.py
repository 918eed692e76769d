"""Solve the chunks of a batch: in this process, in several, or on a cluster of dask.distributed."""

from __future__ import annotations

import logging
import multiprocessing
import os
import pickle
import signal
import sys
import tempfile
import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from dataclasses import replace
from functools import partial
from itertools import chain, islice
from math import ceil
from multiprocessing.context import BaseContext
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, Any, TypeVar

from vopd.files import OutputError, optional_package
from vopd.findings import VopdError
from vopd.flight.project.named import named_files
from vopd.version import __version__

if TYPE_CHECKING:  # what solves is loaded by other processes while this one finds its sources
    from vopd.batch.folder import BatchFolder, Records, SourceRecord
    from vopd.batch.sources import BatchSettings, BatchSource

C = TypeVar("C")
R = TypeVar("R")

KILLED = "its process was killed each time that it was solved; is there enough memory?"


def run_batch(
    sources: Sequence[BatchSource],
    settings: BatchSettings,
    folder: BatchFolder,
    earlier: Records,
    done: Callable[[int], object],
    *,
    jobs: int = 1,
    dask: str | None = None,
    shared: bool = False,
    warn: Callable[[str], object] = lambda _: None,
) -> list[SourceRecord]:
    """Solve sources and write their outputs.

    Args:
        sources: the sources of this shard
        settings: how to solve them, and what to write
        folder: the output folder, begun
        earlier: the records of an earlier run
        done: is called with the number of sources that have been finished
        jobs: the number of processes; 1 is this one
        dask: the address of a scheduler whose cluster solves, in the place of this machine
        shared: its machines read the sources and write the outputs themselves
        warn: is given messages about workers that are refused

    Returns:
        The record of every source, in order.

    Raises:
        OutputError: where an output cannot be written
    """
    from vopd.batch.folder import remove_others, unchanged

    kept = unchanged(sources, settings, earlier)
    records = {one.source: one for one in kept}
    left = [one for one in sources if one.name not in records]
    solved = (
        _solved_here(left, settings, jobs)
        if dask is None
        else _solved_in_cluster(left, settings, dask, shared, warn)
    )
    for some in chain([kept], solved):
        for one in some:
            remove_others(earlier.get(one.source), one, settings)
        if some:
            folder.keep(some)
        records.update((one.source, one) for one in some)
        done(len(some))
    return [records[one.name] for one in sources]


def _solved_here(
    sources: Sequence[BatchSource], settings: BatchSettings, jobs: int
) -> Iterator[list[SourceRecord]]:
    from vopd.batch.folder import failed_record
    from vopd.batch.solve import solve_chunk

    work = partial(solve_chunk, settings=settings)
    if jobs == 1:
        yield from map(work, chunks(sources, most=most_sources(settings)))
        return

    def split(chunk: list[BatchSource]) -> list[list[BatchSource]]:
        return [[one] for one in chunk]

    def given_up(chunk: list[BatchSource]) -> list[SourceRecord]:
        return [failed_record(one, settings, f"{one.path}: {KILLED}") for one in chunk]

    plan = chunks(sources, even_chunk_bytes(sources, jobs), most_sources(settings))
    yield from in_processes(work, plan, jobs, split, given_up)


# Chunks: small decks are solved together, a large one by itself

CHUNK_BYTES = 4_000_000  # about 2,000 frames of four landmarks
CHUNK_SOURCES = 200
CHUNK_PAGES = 8  # with reports: a page takes a second, and a chunk that is not done is lost
LEAST_CHUNKS = 4  # for each process, so that all have work to the end


def even_chunk_bytes(sources: Sequence[BatchSource], processes: int) -> float:
    """Choose the bytes of a chunk so that all processes have as many chunks of about one size."""
    sizes = [one.size for one in sources if not one.flight]
    for_each = max(sum(sizes) / CHUNK_BYTES, len(sizes) / CHUNK_SOURCES) / processes
    return max(sum(sizes), 1) / (processes * max(LEAST_CHUNKS, ceil(for_each)))


def most_sources(settings: BatchSettings) -> int:
    """Choose the number of sources of a chunk, so that a kill costs seconds of work."""
    return CHUNK_PAGES if settings.report else CHUNK_SOURCES


def chunks(
    sources: Iterable[BatchSource],
    chunk_bytes: float = CHUNK_BYTES,
    most: int = CHUNK_SOURCES,
) -> Iterator[list[BatchSource]]:
    """Divide sources into chunks, in order; a flight is a chunk by itself.

    Args:
        sources: the sources
        chunk_bytes: of the decks in a chunk; each begins with the deck whose middle lies
            behind the next multiple of it
        most: sources of a chunk
    """
    chunk: list[BatchSource] = []
    before, number = 0, 0.0
    for source in sources:
        now = (before + source.size / 2.0) // chunk_bytes
        full = len(chunk) == most or now != number
        if chunk and (full or source.flight or chunk[-1].flight):
            yield chunk
            chunk = []
        chunk.append(source)
        number = now
        before += 0 if source.flight else source.size
    if chunk:
        yield chunk


# Processes of this machine: one that dies costs no chunk but its own

ATTEMPTS = 2  # by itself in a process; a chunk that ends that process each time is given up
COPIES = "forkserver"  # a way in which Python starts processes
LOADED = ["vopd.batch.solve", "vopd.film", "vopd.cards.read"]
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


# A cluster: an existing one of dask.distributed


def _solved_in_cluster(
    sources: Sequence[BatchSource],
    settings: BatchSettings,
    address: str,
    shared: bool,
    warn: Callable[[str], object],
) -> Iterator[list[SourceRecord]]:
    """Solve on a cluster; a project with files that cannot travel there is solved here."""
    from vopd.batch.solve import solve_chunk

    travelling: list[BatchSource] = []
    staying: list[BatchSource] = []
    for one in sources:
        (travelling if shared or can_travel(one) else staying).append(one)
    yield from in_cluster(
        address, chunks(travelling, most=most_sources(settings)), settings, shared, warn
    )
    for one in staying:
        yield solve_chunk([one], settings)


LOST = "the scheduler was lost; give --resume to go on when it is there again"
AHEAD = 2  # tasks for each thread of the cluster that are sent before others have ended
SOLVE = "__import__('vopd.batch.workers').batch.workers.solve_pickled(task)"
"""Evaluated by workers, for one without the package cannot be sent functions or objects of it."""


def in_cluster(
    address: str,
    chunks: Iterable[list[BatchSource]],
    settings: BatchSettings,
    shared: bool,
    warn: Callable[[str], object],
) -> Iterator[list[SourceRecord]]:
    """Solve chunks on a cluster, write the outputs that come back, and give records as they come.

    A task whose worker is lost is solved again by another, three times by the rule of
    dask (`distributed.scheduler.allowed-failures`). What is then still lost is taken apart.
    A worker that joins later and lacks this version is refused: what it was sent is sent
    again, and from then on tasks are sent to the others alone.

    Args:
        address: of the scheduler, such as tcp://10.0.0.1:8786
        chunks: sources that can travel, or any where the file system is shared
        settings: how to solve them, and what to write
        shared: whether the workers read the sources and write the outputs themselves
        warn: is given a message about each worker that is refused

    Raises:
        VopdError: where no scheduler answers, it has no workers, they lack this version,
            or they do not see the output folder although it should be shared
        OutputError: where a worker cannot write an output
    """
    from vopd.batch.folder import failed_record, write_output

    with closing(client_of(address)) as client:
        from distributed import as_completed

        fleet = Fleet(client, address, warn)
        waiting = iter(chunks)
        if shared:
            begin = list(islice(waiting, 1))
            fleet.check_folders(settings, [one for chunk in begin for one in chunk])
            waiting = chain(begin, waiting)
        sent: dict[Any, tuple[list[BatchSource], bool]] = {}

        def send(chunk: list[BatchSource]) -> Any:
            task = shared_task(chunk, settings) if shared else cluster_task(chunk, settings)
            workers = sorted(fleet.fit()) if fleet.refused else None
            future = client.submit(eval, SOLVE, {"task": task}, pure=False, workers=workers)
            sent[future.key] = chunk, workers is not None
            return future

        first = [send(chunk) for chunk in islice(waiting, AHEAD * fleet.threads)]
        running = as_completed(first, loop=client.loop)
        for future in running:
            if future.cancelled():
                raise VopdError(f"--dask {address}: {LOST}")
            chunk, to_fit_ones = sent.pop(future.key)
            error = future.exception()
            if isinstance(error, OutputError):
                raise error
            strange = error is not None or future.result()[0][0].version != __version__
            if strange and not to_fit_ones:
                fleet.fit()
                if fleet.refused:
                    running.add(send(chunk))
                    continue
            if error is not None and len(chunk) > 1:
                for one in chunk:
                    running.add(send([one]))
                continue
            if error is None:
                records, outputs = future.result()
                for name, content in outputs.items():
                    write_output(settings, name, content)
                yield records
            else:
                why = f"{type(error).__name__}: {error}"
                yield [failed_record(one, settings, f"{one.path}: {why}") for one in chunk]
            for more in islice(waiting, 1):
                running.add(send(more))


ANSWER_S = 10
MOST_PORTS = 1 << 16
VERSION = "__import__('vopd.version').version.__version__"
"""Evaluated by workers, for one without the package cannot be sent functions or objects of it."""


def client_of(address: str) -> Any:
    """Connect to the scheduler; dask's own messages, with tracebacks, are silenced."""
    optional_package("distributed", "dask")
    from distributed import Client
    from distributed.comm.addressing import get_address_host_port

    logging.disable(logging.CRITICAL)
    whole = address if "://" in address else f"tcp://{address}"
    try:
        _, port = get_address_host_port(whole, strict=True)
    except (ValueError, NotImplementedError):
        port = -1
    if not 0 < port < MOST_PORTS:  # a client that is given another prints tracebacks
        raise VopdError(f"--dask {address}: not an address such as tcp://10.0.0.1:8786")
    try:
        return Client(address, timeout=ANSWER_S, set_as_default=False)
    except (OSError, ValueError, MemoryError) as error:  # the last by another server's first words
        raise VopdError(f"--dask {address}: no scheduler answers at this address") from error


class Fleet:
    """The workers of a cluster: those that have this version, and those that are refused."""

    def __init__(self, client: Any, address: str, warn: Callable[[str], object]) -> None:
        self._client = client
        self._address = address
        self._warn = warn
        self.refused: dict[str, str] = {}
        threads = client.nthreads()
        if not threads:
            raise VopdError(f"--dask {address}: the cluster has no workers; start some first")
        for reason in self._look().values():
            raise VopdError(f"--dask {address}: {reason}")
        self.threads = int(sum(threads.values()))

    def fit(self) -> set[str]:
        """Find the workers that now have this version, and refuse the others."""
        found = self._look()
        for worker, reason in found.items():
            if worker not in self.refused:
                self._warn(f"--dask {self._address}: {reason}; it is sent nothing more")
        self.refused |= found
        fit = set(self._client.nthreads()) - set(self.refused)
        if not fit:
            raise VopdError(f"--dask {self._address}: no worker with vopd {__version__} is left")
        return fit

    def _look(self) -> dict[str, str]:
        """Find the workers that cannot be used, and why."""
        found = self._client.run(eval, VERSION, on_error="return")
        return {
            worker: f"the worker {worker} has vopd {version}, and this is {__version__}; "
            "install the same on all"
            if isinstance(version, str)
            else f"the worker {worker} cannot import vopd: {version}; "
            f"install vopd {__version__} on all workers"
            for worker, version in found.items()
            if version != __version__
        }

    def check_folders(self, settings: BatchSettings, sources: list[BatchSource]) -> None:
        """Make sure that all workers see the output folder and the folder of a source.

        Args:
            settings: of the batch
            sources: some sources; the first that is there is looked for

        Raises:
            VopdError: where a worker does not see one of them
        """
        there = [path for one in sources if (path := Path(one.path).absolute()).exists()]
        out = Path(settings.folder).absolute()
        looked_for = [(Path(settings.working).absolute(), f"the folder {out}")]
        looked_for += [(path, f"the source {path}") for path in there[:1]]
        for path, name in looked_for:
            for worker, seen in self._client.run(Path.exists, path, on_error="return").items():
                if seen is not True:
                    raise VopdError(
                        f"--shared-filesystem: the worker {worker} does not see {name}; leave "
                        "the option out, or name folders that all machines have under these paths"
                    )


# What travels to a machine of a cluster and back: bytes, or paths if all machines share their files

_ONE_AT_A_TIME = threading.Lock()  # matplotlib, for reports, is not made for several threads

Files = dict[str, bytes]  # contents by names relative to a folder
Result = tuple[list["SourceRecord"], Files]
"""The records of a task and the contents of all outputs, unless they are written already."""


def can_travel(source: BatchSource) -> bool:
    """Check that all files of a source lie in the source's own folder or below it."""
    names = [PurePosixPath(name) for name, _ in _files_of(source)]
    return not any(name.is_absolute() or ".." in name.parts for name in names)


def cluster_task(chunk: Sequence[BatchSource], settings: BatchSettings) -> bytes:
    """Pickle sources with all their files, for `solve_pickled`."""
    contents: list[Files] = []
    for source in chunk:
        path = Path(source.path)
        try:
            files = {path.name: path.read_bytes()}
            files |= {name: file.read_bytes() for name, file in _files_of(source)}
        except OSError:  # the path leads nowhere on the other machine either, and that says it
            files = {}
        contents.append(files)
    return pickle.dumps((list(chunk), settings, contents))


def shared_task(chunk: Sequence[BatchSource], settings: BatchSettings) -> bytes:
    """Pickle the paths of sources that a machine of the cluster reads itself, as `cluster_task`.

    Args:
        chunk: the sources
        settings: how to solve them, and what to write; that machine writes the outputs
    """
    folder, working = (str(Path(one).absolute()) for one in (settings.folder, settings.working))
    locations = {one.path: str(Path(one.path).absolute()) for one in chunk}
    return pickle.dumps((list(chunk), replace(settings, folder=folder, working=working), locations))


def solve_pickled(task: bytes) -> Result:
    """Solve the sources of a task; runs on a machine of the cluster.

    Args:
        task: pickled, so that a worker without the package can receive it

    Raises:
        OutputError: where an output cannot be written
    """
    chunk, settings, files = pickle.loads(task)
    with _ONE_AT_A_TIME:
        if isinstance(files, dict):
            return _solved_as_named(chunk, settings, files), {}
        with tempfile.TemporaryDirectory(prefix="vopd-") as name:
            home = Path(name)
            out, working = home / "out", home / "working"
            out.mkdir()
            working.mkdir()
            locations = {}
            for k, (source, contents) in enumerate(zip(chunk, files, strict=True)):
                for relative, content in contents.items():
                    path = home / str(k) / relative
                    path.parent.mkdir(parents=True, exist_ok=True)
                    path.write_bytes(content)
                if contents:
                    locations[source.path] = str(home / str(k) / Path(source.path).name)
            there = replace(settings, folder=str(out), working=str(working))
            records = _solved_as_named(chunk, there, locations)
            names = [one for record in records for one in record.outputs]
            return records, {one: (out / one).read_bytes() for one in names}


def _solved_as_named(
    chunk: Sequence[BatchSource], settings: BatchSettings, locations: dict[str, str]
) -> list[SourceRecord]:
    """Solve sources; their errors name the folders that were given, not those read from."""
    from vopd.batch.solve import solve_chunk

    records = []
    for record in solve_chunk(chunk, settings, locations):
        here = Path(locations.get(record.path, record.path)).parent
        error = record.error.replace(str(here), str(Path(record.path).parent))
        records.append(replace(record, error=error))
    return records


def _files_of(source: BatchSource) -> list[tuple[str, Path]]:
    """List the files that a project names; a deck names none."""
    if not source.flight:
        return []
    path = Path(source.path)
    try:
        return list(named_files(path.read_bytes(), path.parent))
    except OSError:
        return []
