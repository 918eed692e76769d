"""Settings and sources of a batch for tests of its parts."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from vopd.attitude.history import HistoryOptions
from vopd.batch.sources import BatchSettings, BatchSource
from vopd.pipeline import SolveOptions


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
