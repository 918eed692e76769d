"""A chunk of a batch as it travels to a machine of a cluster and back: bytes, not paths."""

from __future__ import annotations

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
    files: tuple[Files, ...]  # of each source; the first is the source itself, if it can be read
    settings: BatchSettings


@dataclass(frozen=True)
class ClusterResult:
    """The records of a task and the contents of all outputs."""

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
    return ClusterTask(tuple(sources), tuple(contents), settings)


def solve_task(task: ClusterTask) -> ClusterResult:
    """Solve the sources of a task; runs on a machine of the cluster, in a temporary folder.

    Args:
        task: the sources with their files
    """
    with _ONE_AT_A_TIME, tempfile.TemporaryDirectory(prefix="vopd-") as name:
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
        records = [
            replace(record, error=record.error.replace(here, there))
            for record, (here, there) in zip(
                solve_chunk(task.sources, settings, {}, locations), folders, strict=True
            )
        ]
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
