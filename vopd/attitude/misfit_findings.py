"""Warnings about the frames of a job that do not agree with the standard deviations in force."""

from __future__ import annotations

import re
from typing import NamedTuple

from vopd.attitude.history import History
from vopd.attitude.residual_test import SIGNIFICANCE
from vopd.findings import Finding, frames_text

MOST = 3  # different repairs that are told of a job
CHANCE = re.compile(r" \(chance ([\d.]+)\)")


class Misfits(NamedTuple):
    """The frames of a job that misfit, those with the same repair together."""

    repairs: list[tuple[str, str]]  # frames and what explains them, the most frames first
    left: int  # frames that are in none of these


def misfits(history: History) -> Misfits:
    """Sort the frames of a job that misfit by what explains them, at most `MOST` repairs.

    Args:
        history: the job
    """
    frames: dict[str, list[int]] = {}
    for k, told in enumerate(history.flags.detail["misfit"]):
        if history.flags.raised["misfit"][k]:
            frames.setdefault(CHANCE.sub("", told), []).append(k)
    groups = sorted(frames.values(), key=len, reverse=True)
    repairs = [
        (frames_text([history.estimate.frame_label(k) for k in group]), _repair(history, group))
        for group in groups[:MOST]
    ]
    return Misfits(repairs, sum(map(len, groups[MOST:])))


def _repair(history: History, group: list[int]) -> str:
    """What explains some frames, with the least of their chances."""
    told = [history.flags.detail["misfit"][k] for k in group]
    chances = [[float(chance) for chance in CHANCE.findall(one)] for one in told]
    least = iter([min(ones) for ones in zip(*chances, strict=True)])
    more = " or more" if len(group) > 1 else ""
    return CHANCE.sub(lambda _: f" (chance {next(least):.2f}{more})", told[0]) or "not searched"


def misfit_findings(history: History) -> list[Finding]:
    """Make the warnings about the frames of one job that misfit: few, whatever their number.

    Args:
        history: the job
    """
    found = misfits(history)
    messages = [
        f"{frames}: misfit, the residuals have a chance below {SIGNIFICANCE:g}; what explains "
        f"them: {repair}"
        for frames, repair in found.repairs
    ]
    if found.left:
        messages.append(f"{found.left} more frames misfit; the flags say what explains them")
    about = history.about
    return [Finding(one, about.source, job=about.job, severity="warning") for one in messages]
