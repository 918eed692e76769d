"""Findings about all frames of a job: counts of flags, and repairs of misfits."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from vopd.attitude.history import History
from vopd.attitude.residuals import SIGNIFICANCE
from vopd.estimate import About
from vopd.findings import Finding, count_text, frames_text

# Summary of a job's frames.


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
        texts = flags.detail["misfit"]
        frames = np.flatnonzero(flags.raised["misfit"]).tolist()
        self.misfits += [(estimate.frame_label(k), texts[k]) for k in frames]


def summary_of(parts: Iterable[History]) -> HistorySummary:
    """Summarise the frames of a job.

    Args:
        parts: its history, in parts
    """
    summary = HistorySummary()
    for part in parts:
        summary.add(part)
    return summary


# Warnings about misfits.

MOST = 3  # different repairs that are named for a job
CHANCE = re.compile(r" \(chance ([\d.]+)\)")


def misfits(summary: HistorySummary) -> tuple[list[tuple[str, str]], int]:
    """Sort the frames of a job that misfit by what explains them.

    Args:
        summary: the frames of the job

    Returns:
        Frames and what explains them, at most `MOST` repairs, that of the most frames first;
        and how many frames are in none of these.
    """
    alike: dict[str, list[tuple[str, str]]] = {}
    for label, text in summary.misfits:
        alike.setdefault(CHANCE.sub("", text), []).append((label, text))
    groups = sorted(alike.values(), key=len, reverse=True)
    repairs = [
        (frames_text([label for label, _ in group]), _repair([text for _, text in group]))
        for group in groups[:MOST]
    ]
    return repairs, sum(map(len, groups[MOST:]))


def _repair(texts: list[str]) -> str:
    """Describe the repair of some frames, with the least of their chances."""
    chances = [[float(chance) for chance in CHANCE.findall(one)] for one in texts]
    least = iter([min(ones) for ones in zip(*chances, strict=True)])
    more = " or more" if len(texts) > 1 else ""
    return CHANCE.sub(lambda _: f" (chance {next(least):.2f}{more})", texts[0]) or "not searched"


def misfit_findings(history: History) -> list[Finding]:
    """Warn of the frames of one job that misfit, in a few lines.

    Args:
        history: the job
    """
    return findings_of(history.about, summary_of([history]))


def findings_of(about: About, summary: HistorySummary) -> list[Finding]:
    """Warn of misfits from the summary of a job.

    Args:
        about: the job
        summary: its frames
    """
    repairs, left = misfits(summary)
    messages = [
        f"{frames}: misfit, the residuals have a chance below {SIGNIFICANCE:g}; what explains "
        f"them: {repair}"
        for frames, repair in repairs
    ]
    if left:
        messages.append(
            f"{count_text(left, 'more frame misfits', 'more frames misfit')}; the flags say what "
            f"explains {'it' if left == 1 else 'them'}"
        )
    return [
        Finding(one, about.source, job=about.finding_job, severity="warning") for one in messages
    ]
