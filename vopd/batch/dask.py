"""A chunk of a batch as it travels to a machine of a cluster and back.

Bytes travel, not paths, unless all machines share a file system.
"""

from __future__ import annotations

import pickle
import tempfile
import threading
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath

from vopd.batch.input_hash import named_files
from vopd.batch.settings import BatchSettings
from vopd.batch.solve_chunk import solve_chunk
from vopd.batch.source_record import SourceRecord
from vopd.batch.sources import BatchSource

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
    """Whether all files of a source lie in the source's own folder or below it.

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
    """The files that a project names; a deck names none."""
    if not source.flight:
        return []
    path = Path(source.path)
    try:
        return list(named_files(path.read_bytes(), path.parent))
    except OSError:
        return []
