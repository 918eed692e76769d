"""What is said of a job's frames together: how many are flagged, and what explains misfits."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from vopd.attitude.history import History


@dataclass
class HistorySummary:
    """Counts of a job's frames, and its misfits."""

    unconverged: int = 0
    flagged: int = 0
    misfits: list[tuple[str, str]] = field(default_factory=list)
    """The label of each frame that misfits, and what explains it."""

    def add(self, part: History) -> None:
        """Count some more frames.

        Args:
            part: the history of these frames
        """
        flags, estimate = part.flags, part.estimate
        self.unconverged += int(flags.raised["not_converged"].sum())
        self.flagged += int(flags.any().sum())
        told = flags.detail["misfit"]
        frames = np.flatnonzero(flags.raised["misfit"]).tolist()
        self.misfits += [(estimate.frame_label(k), told[k]) for k in frames]


def summary_of(parts: Iterable[History]) -> HistorySummary:
    """The summary of a job.

    Args:
        parts: its history, in parts
    """
    summary = HistorySummary()
    for part in parts:
        summary.add(part)
    return summary
