"""Solve the chunks of a batch on a cluster of dask.distributed."""

from __future__ import annotations

import logging
import pickle
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from itertools import chain, islice
from pathlib import Path, PurePosixPath
from typing import Any

from vopd.batch.folder import SourceRecord, named_files
from vopd.batch.run import solve_chunk
from vopd.batch.sources import BatchSettings, BatchSource
from vopd.files import OutputError, optional_package
from vopd.findings import VopdError
from vopd.version import __version__

# A chunk of a batch as it travels to a machine of a cluster and back.
#
# Bytes travel, not paths, unless all machines share a file system.

_ONE_AT_A_TIME = threading.Lock()  # matplotlib, for reports, is not made for several threads

Files = dict[str, bytes]
"""Contents by names relative to a folder."""


@dataclass(frozen=True)
class ClusterTask:
    """Sources with all their files, and how to solve them."""

    sources: tuple[BatchSource, ...]
    settings: BatchSettings
    files: tuple[Files, ...] = ()
    """Of each source; the first is the source itself, if it can be read."""
    locations: dict[str, str] | None = None
    """Where the sources are in a file system that all machines share, by their paths."""


@dataclass(frozen=True)
class ClusterResult:
    """The records of a task and the contents of all outputs, unless they are written already."""

    records: list[SourceRecord]
    outputs: Files


def can_travel(source: BatchSource) -> bool:
    """Check that all files of a source lie in the source's own folder or below it.

    Args:
        source: a deck, which always can, or a project
    """
    if not source.flight:
        return True
    names = [PurePosixPath(name) for name, _ in _files_of(source)]
    return not any(name.is_absolute() or ".." in name.parts for name in names)


def cluster_task(sources: Sequence[BatchSource], settings: BatchSettings) -> ClusterTask:
    """Read all files of sources that can travel.

    Args:
        sources: the sources
        settings: how to solve them, and what to write
    """
    contents = []
    for source in sources:
        path = Path(source.path)
        try:
            files = {path.name: path.read_bytes()}
            files |= {name: file.read_bytes() for name, file in _files_of(source)}
        except OSError:  # the path leads nowhere on the other machine either, and that says it
            files = {}
        contents.append(files)
    return ClusterTask(tuple(sources), settings, tuple(contents))


def shared_task(sources: Sequence[BatchSource], settings: BatchSettings) -> ClusterTask:
    """Name sources that a machine of the cluster reads itself, and the folder it writes into.

    Args:
        sources: the sources
        settings: how to solve them, and what to write
    """
    folder, working = (str(Path(one).absolute()) for one in (settings.folder, settings.working))
    there = replace(settings, folder=folder, working=working)
    locations = {one.path: str(Path(one.path).absolute()) for one in sources}
    return ClusterTask(tuple(sources), there, locations=locations)


def solve_task(task: ClusterTask) -> ClusterResult:
    """Solve the sources of a task; runs on a machine of the cluster.

    Args:
        task: the sources with their files, or where they are

    Raises:
        OutputError: where an output cannot be written
    """
    with _ONE_AT_A_TIME:
        if task.locations is None:
            return _solve_in_temporary_folder(task)
        folders = [
            (str(Path(task.locations[one.path]).parent), str(Path(one.path).parent))
            for one in task.sources
        ]
        records = solve_chunk(task.sources, task.settings, {}, task.locations)
        return ClusterResult(_as_named(records, folders), {})


def solve_pickled(task: bytes) -> ClusterResult:
    """Solve the sources of a task that was pickled, as `solve_task` does.

    Args:
        task: pickled, so that a worker without the package can receive it
    """
    return solve_task(pickle.loads(task))


def _as_named(
    records: Sequence[SourceRecord], folders: Sequence[tuple[str, str]]
) -> list[SourceRecord]:
    """Records whose errors name the folder that was given in the place of the one read from."""
    return [
        replace(record, error=record.error.replace(here, there))
        for record, (here, there) in zip(records, folders, strict=True)
    ]


def _solve_in_temporary_folder(task: ClusterTask) -> ClusterResult:
    with tempfile.TemporaryDirectory(prefix="vopd-") as name:
        home = Path(name)
        out, working = home / "out", home / "working"
        out.mkdir()
        working.mkdir()
        locations = {}
        folders = []
        for k, (source, files) in enumerate(zip(task.sources, task.files, strict=True)):
            folder = home / str(k)
            folders.append((str(folder), str(Path(source.path).parent)))
            for relative, content in files.items():
                (folder / relative).parent.mkdir(parents=True, exist_ok=True)
                (folder / relative).write_bytes(content)
            if files:
                locations[source.path] = str(folder / Path(source.path).name)
        settings = replace(task.settings, folder=str(out), working=str(working))
        records = _as_named(solve_chunk(task.sources, settings, {}, locations), folders)
        outputs = {one: (out / one).read_bytes() for record in records for one in record.outputs}
        return ClusterResult(records, outputs)


def _files_of(source: BatchSource) -> list[tuple[str, Path]]:
    """List the files that a project names; a deck names none."""
    if not source.flight:
        return []
    path = Path(source.path)
    try:
        return list(named_files(path.read_bytes(), path.parent))
    except OSError:
        return []


# The scheduler of a cluster of dask.distributed, and which of its workers can be used.

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
    except (OSError, ValueError) as error:
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


# Solve the chunks of a batch on an existing cluster of dask.distributed.

LOST = "the scheduler was lost; give --resume to go on when it is there again"
AHEAD = 2  # tasks for each thread of the cluster that are sent before others have ended
SOLVE = "__import__('vopd.batch.dask').batch.dask.solve_pickled(task)"
"""Evaluated by workers, for one without the package cannot be sent functions or objects of it."""
Answer = tuple[list[BatchSource], ClusterResult | str]
"""The sources of a task, and what was made of them, or why they could not be solved."""


def in_cluster(
    address: str,
    chunks: Iterable[list[BatchSource]],
    settings: BatchSettings,
    shared: bool,
    warn: Callable[[str], object],
) -> Iterator[Answer]:
    """Solve chunks on a cluster, and give the results as they come.

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
            given = {"task": pickle.dumps(task)}
            future = client.submit(eval, SOLVE, given, pure=False, workers=workers)
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
            strange = error is not None or future.result().records[0].version != __version__
            if strange and not to_fit_ones:
                fleet.fit()
                if fleet.refused:
                    running.add(send(chunk))
                    continue
            if error is not None and len(chunk) > 1:
                for one in chunk:
                    running.add(send([one]))
                continue
            yield chunk, future.result() if error is None else f"{type(error).__name__}: {error}"
            for more in islice(waiting, 1):
                running.add(send(more))
