"""Findings about all frames of a job: counts of flags, repairs of misfits, effect of errata."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.attitude.mistakes import repair_chance
from vopd.attitude.residuals import SIGNIFICANCE
from vopd.attitude.uncertainty import ANGLES
from vopd.estimate import About
from vopd.findings import Finding, count_text, frames_text, size_text

# Summary of a job's frames.

TESTED = (3, 4, 5, 0, 1, 2)  # indices in ANGLES: the vehicle's angles, then the camera's


@dataclass
class HistorySummary:
    """Counts of a job's frames, its misfits, and the effect of the errata of the program."""

    unconverged: int = 0
    flagged: int = 0
    misfits: list[tuple[str, str]] = field(default_factory=list)
    """The label of each frame that misfits, and what explains it."""
    without_outlier: set[str] = field(default_factory=set)
    """The labels of those that are explained without the landmark that does not fit the others."""
    frames: int = 0
    errata: int = 0
    """Frames of which the errata change an angle by more than its standard deviation."""
    errata_deg: tuple[float, ...] = (0.0,) * len(TESTED)
    errata_sigmas: tuple[float, ...] = (0.0,) * len(TESTED)
    """The largest effect on each of the angles `TESTED`: degrees, and standard deviations."""

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
        odd, name = flags.raised["outlier"], flags.detail["outlier"]
        alone = [k for k in frames if odd[k] and f"without {name[k]} " in texts[k]]
        self.without_outlier |= {estimate.frame_label(k) for k in alone}
        self.frames += len(estimate.frame)
        if estimate.slip_effect_deg is not None:
            self._add_errata(estimate.slip_effect_deg, part.uncertainty.total)

    def _add_errata(self, effect_deg: Floats, sigma_deg: Floats) -> None:
        """Count the frames of which errata change an angle by more than a standard deviation.

        Args:
            effect_deg: of all errata on the nine angles, (F, 9)
            sigma_deg: standard deviations of these, (F, 9)
        """
        size, sigma = np.abs(effect_deg[:, TESTED]), sigma_deg[:, TESTED]
        with np.errstate(all="ignore"):
            times = np.where(size > sigma, size / sigma, 0.0)
        beyond = times > 0.0
        self.errata += int(beyond.any(axis=1).sum())
        most_deg = np.where(beyond, size, 0.0).max(axis=0, initial=0.0)
        self.errata_deg = tuple(np.maximum(self.errata_deg, most_deg).tolist())
        most = times.max(axis=0, initial=0.0)
        self.errata_sigmas = tuple(np.maximum(self.errata_sigmas, most).tolist())


def summary_of(parts: Iterable[History]) -> HistorySummary:
    """Summarise the frames of a job."""
    summary = HistorySummary()
    for part in parts:
        summary.add(part)
    return summary


# Warnings about misfits.

MOST = 3  # different repairs that are named for a job
CHANCE = re.compile(r" \(chance ([\d.]+)\)")


def misfits(summary: HistorySummary) -> tuple[list[tuple[str, str]], int]:
    """Sort the frames of a job that misfit by what explains them.

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

    def shown(_: object) -> str:
        one = next(least)
        more = " or more" if len(texts) > 1 and one < 1.0 else ""
        return f" (chance {repair_chance(one)}{more})"

    return CHANCE.sub(shown, texts[0]) or "not searched"


def errata_text(summary: HistorySummary) -> str:
    """Say how far the errata of the original program change a job; empty if within the sigmas.

    The angle that is named is the one that they change by the most standard deviations.
    """
    if not summary.errata:
        return ""
    worst = int(np.argmax(np.round(summary.errata_sigmas, 6)))  # of two alike the first
    angle = ANGLES[TESTED[worst]].replace("_", " ")
    sigmas = size_text(summary.errata_sigmas[worst])
    some = f"{summary.errata} of {count_text(summary.frames, 'frame')}"
    return (
        f"errata of the original program, in no sigma, change {angle} by up to "
        f"{summary.errata_deg[worst]:.3g} degree ({sigmas} sigmas), some "
        f"angle by more than a sigma in {some}: --fix all corrects them"
    )


def findings_of(about: About, summary: HistorySummary) -> list[Finding]:
    """Warn of misfits, and of the errata's effect, from the summary of a job."""
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
    messages += filter(None, [errata_text(summary)])
    return [about.warning(one) for one in messages]
