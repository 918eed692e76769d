"""Warnings about the frames of a job that do not agree with the standard deviations in force."""

from __future__ import annotations

import re

from vopd.attitude.history import History
from vopd.attitude.residual_test import SIGNIFICANCE
from vopd.findings import Finding, frames_text

MOST = 3  # different repairs that are told of a job
CHANCE = re.compile(r" \(chance ([\d.]+)\)")


def misfit_findings(history: History) -> list[Finding]:
    """Make the warnings of one job: frames with the same repair together, the most frames first.

    Args:
        history: the job
    """
    frames: dict[str, list[int]] = {}
    for k, told in enumerate(history.flags.detail["misfit"]):
        if history.flags.raised["misfit"][k]:
            frames.setdefault(CHANCE.sub("", told), []).append(k)
    groups = sorted(frames.values(), key=len, reverse=True)
    found = [_finding(history, group) for group in groups[:MOST]]
    left = [k for group in groups[MOST:] for k in group]
    if left:
        message = f"{len(left)} more frames misfit; the column flags says what explains them"
        found.append(_warning(history, message))
    return found


def _finding(history: History, group: list[int]) -> Finding:
    """The warning about frames with the same repair."""
    told = [history.flags.detail["misfit"][k] for k in group]
    chances = [[float(chance) for chance in CHANCE.findall(one)] for one in told]
    least = iter([min(ones) for ones in zip(*chances, strict=True)])
    more = " or more" if len(group) > 1 else ""
    repair = CHANCE.sub(lambda _: f" (chance {next(least):.2f}{more})", told[0])
    labels = frames_text([history.estimate.frame_label(k) for k in group])
    return _warning(
        history,
        f"{labels}: misfit, the residuals have a chance below {SIGNIFICANCE:g}; what explains "
        f"them: {repair or 'not searched'}",
    )


def _warning(history: History, message: str) -> Finding:
    return Finding(message, history.about.source, job=history.about.job, severity="warning")
