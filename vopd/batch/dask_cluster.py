"""Solve the chunks of a batch on an existing cluster of dask.distributed."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from itertools import chain, islice
from typing import Any

from vopd.batch.dask import ClusterResult, cluster_task, shared_task
from vopd.batch.dask_workers import Fleet, client_of
from vopd.batch.settings import BatchSettings
from vopd.batch.sources import BatchSource
from vopd.files import OutputError
from vopd.findings import VopdError
from vopd.version import __version__

LOST = "the scheduler was lost; give --resume to go on when it is there again"
AHEAD = 2  # tasks for each thread of the cluster that are sent before others have ended
SOLVE = "__import__('vopd.batch.dask').batch.cluster_task.solve_pickled(task)"
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
            strange = error is not None or _version_of(future.result()) != __version__
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


def _version_of(result: ClusterResult) -> str:
    """The version that solved a task."""
    return result.records[0].version
