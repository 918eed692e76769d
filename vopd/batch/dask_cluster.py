"""Solve the chunks of a batch on an existing cluster of dask.distributed."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Iterator
from contextlib import closing
from itertools import islice
from typing import Any

from vopd.batch.cluster_task import ClusterResult, ClusterTask, cluster_task, solve_task
from vopd.batch.settings import BatchSettings
from vopd.batch.sources import BatchSource
from vopd.findings import VopdError
from vopd.version import __version__

ANSWER_S = 10
LOST = "the scheduler was lost; give --resume to go on when it is there again"
AHEAD = 2  # tasks for each thread of the cluster that are sent before others have ended
Answer = tuple[list[BatchSource], ClusterResult | str]
"""The sources of a task, and what was made of them, or why they could not be solved."""


def in_cluster(
    address: str, chunks: Iterable[list[BatchSource]], settings: BatchSettings
) -> Iterator[Answer]:
    """Solve chunks on a cluster, and give the results as they come.

    A task whose worker is lost is solved again by another, three times by the rule of
    dask (`distributed.scheduler.allowed-failures`). What is then still lost is taken apart.

    Args:
        address: of the scheduler, such as tcp://10.0.0.1:8786
        chunks: sources that can travel
        settings: how to solve them, and what to write

    Raises:
        VopdError: where no scheduler answers, it has no workers, or they lack this version
    """
    with closing(_client(address)) as client:
        from distributed import as_completed

        most = AHEAD * _threads(client, address)
        waiting = iter(chunks)
        sources: dict[Any, list[BatchSource]] = {}

        def send(chunk: list[BatchSource]) -> Any:
            task: ClusterTask = cluster_task(chunk, settings)
            future = client.submit(solve_task, task, pure=False)
            sources[future.key] = chunk
            return future

        first = [send(chunk) for chunk in islice(waiting, most)]
        running = as_completed(first, loop=client.loop)
        for future in running:
            if future.cancelled():
                raise VopdError(f"--dask {address}: {LOST}")
            chunk = sources.pop(future.key)
            error = future.exception()
            if error is not None and len(chunk) > 1:
                for one in chunk:
                    running.add(send([one]))
                continue
            yield chunk, future.result() if error is None else f"{type(error).__name__}: {error}"
            for more in islice(waiting, 1):
                running.add(send(more))


def _client(address: str) -> Any:
    """A client of the scheduler; dask's own messages, with tracebacks, are not shown any more."""
    try:
        from distributed import Client
    except ImportError as error:
        raise VopdError("distributed is not installed: pip install 'vopd[dask]'") from error
    logging.disable(logging.CRITICAL)
    try:
        return Client(address, timeout=ANSWER_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise VopdError(f"--dask {address}: no scheduler answers at this address") from error


def _threads(client: Any, address: str) -> int:
    """How many tasks the cluster works on at once, after a look at its workers."""
    threads = sum(client.nthreads().values())
    if not threads:
        raise VopdError(f"--dask {address}: the cluster has no workers; start some first")
    try:
        versions = client.run(_version)
    except Exception as error:  # whatever a worker without the package raises
        raise VopdError(
            f"--dask {address}: a worker cannot import vopd: {error}; install vopd {__version__} "
            "on all workers"
        ) from error
    for worker, version in versions.items():
        if version != __version__:
            raise VopdError(
                f"--dask {address}: the worker {worker} has vopd {version}, and this is "
                f"{__version__}; install the same on all"
            )
    return int(threads)


def _version() -> str:
    """The version of the package, where this runs."""
    from vopd.version import __version__ as there

    return there
