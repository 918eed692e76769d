"""Decks, settings and sources of batches, and what an output folder holds."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from tests.kit.command import CASE_1, DECKS, PROCESSOR, ROOT, vopd
from vopd.attitude.history import HistoryOptions
from vopd.batch.sources import BatchSettings, BatchSource
from vopd.pipeline import SolveOptions

EXAMPLES = ROOT / "examples"


def small_decks(folder: Path, count: int, frames: int = 3) -> Path:
    """A new folder with decks of synthetic flights."""
    folder.mkdir()
    for seed in range(count):
        ran = vopd(
            *("demo", "--frames", str(frames), "--seed", str(seed)),
            *("-o", folder / f"deck{seed:03d}.dat"),
        )
        assert ran.status == 0, ran.stderr
    return folder


def mixed_sources(folder: Path) -> Path:
    """A new folder with decks, one of which breaks off and one of which stops, and two flights."""
    small_decks(folder, 5)
    for name in ("lens_out_of_order", "ignored", "restart"):
        shutil.copy(DECKS / "regression" / f"{name}.dat", folder)
    for name in ("hill", "summits"):
        shutil.copytree(EXAMPLES / name, folder / name)
    (folder / "broken.dat").write_text("\n".join(CASE_1.read_text().splitlines()[:30]))
    return folder


def contents(folder: Path) -> dict[str, bytes]:
    """Every file of an output folder but the times, hidden files too."""
    files = (path for path in folder.rglob("*") if path.is_file())
    held = {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}
    assert held.pop("times.jsonl")
    return held


def start_batch(*arguments: str | Path, place: Path) -> subprocess.Popen[str]:
    """`vopd batch` as a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "vopd", "batch", *map(str, arguments)],
        cwd=place, env={"PATH": "", "PYTHONPATH": str(ROOT), "LANG": "C.UTF-8"} | PROCESSOR,
        text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    )  # fmt: skip


def loading(pid: int) -> list[int]:
    """The process that a batch has started to load the package, of which others are copies."""
    return [one for one, parent in _copies().items() if parent == pid]


def workers(pid: int) -> list[int]:
    """The processes that a batch has started to solve in, on Linux."""
    copies = _copies()
    return [one for one, parent in copies.items() if copies.get(parent) == pid]


def _copies() -> dict[int, int]:
    """The parents of all processes that load the package for others, or are their copies."""
    parents: dict[int, int] = {}
    for status in Path("/proc").glob("[0-9]*/status"):
        try:
            parent = status.read_text().partition("\nPPid:\t")[2].partition("\n")[0]
            if b"multiprocessing.forkserver" in (status.parent / "cmdline").read_bytes():
                parents[int(status.parent.name)] = int(parent)
        except OSError:  # it has ended
            continue
    return parents


def end_process_at(chunk: int) -> int:
    """What a process is killed by in the middle of its work: any chunk that is 13."""
    if chunk == 13:
        os.kill(os.getpid(), signal.SIGKILL)
    return chunk * chunk


# Settings and sources


def settings(folder: Path, **more: Any) -> BatchSettings:
    """Those of a batch into a folder; CSV and npz unless others are asked for."""
    (folder / "w").mkdir(parents=True, exist_ok=True)
    given = {"history": HistoryOptions(), "formats": ("csv", "npz"), **more}
    return BatchSettings(str(folder), str(folder / "w"), SolveOptions(), **given)


def sources(*sizes: int | str) -> list[BatchSource]:
    """Decks of these sizes; a text is the size of a flight."""
    return [
        BatchSource(f"{k}.{'toml' if isinstance(one, str) else 'dat'}", str(k), int(one))
        for k, one in enumerate(sizes)
    ]


def history(frames: int = 3, attitudes: int = 3, **flags: list[int]) -> Any:
    """What a batch counts in a history: frames, attitudes, and the frames of each flag."""
    raised = {name: np.isin(np.arange(frames), at) for name, at in flags.items()}
    some = np.any([*raised.values(), np.zeros(frames, bool)], axis=0)
    return SimpleNamespace(
        flags=SimpleNamespace(raised=raised, any=lambda: some),
        has_attitude=np.arange(frames) < attitudes,
        estimate=SimpleNamespace(frame=np.arange(frames)),
    )
