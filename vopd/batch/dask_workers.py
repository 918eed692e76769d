"""The scheduler of a cluster of dask.distributed, and which of its workers can be used."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

from vopd.batch.settings import BatchSettings
from vopd.batch.sources import BatchSource
from vopd.findings import VopdError
from vopd.version import __version__

ANSWER_S = 10
MOST_PORTS = 1 << 16
VERSION = "__import__('vopd.version').version.__version__"
"""Evaluated by workers, for one without the package cannot be sent functions or objects of it."""


def client_of(address: str) -> Any:
    """A client of the scheduler; dask's own messages, with tracebacks, are not shown any more."""
    try:
        from distributed import Client
        from distributed.comm.addressing import get_address_host_port
    except ImportError as error:
        raise VopdError("distributed is not installed: pip install 'vopd[dask]'") from error
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
        """The workers there are now that have this version; others are refused."""
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
        """The workers that cannot be used, and why."""
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
