"""How far a file's positions are from where the source's own coordinates put the vehicle."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vopd.attitude.history import History
from vopd.findings import Finding, Report

WORTH_SAYING_M = 1.0


def report_own_position(histories: Sequence[History], report: Report) -> None:
    """Warn of every job whose positions are not where its own coordinates put the vehicle.

    Args:
        histories: the jobs
        report: is given the warnings
    """
    for one in histories:
        text = farthest_from_own_text([one])
        if text:
            about = one.about
            message = f"in this file {text.removeprefix('; ')}"
            report(Finding(message, about.source, job=about.job, severity="warning"))


def farthest_from_own_text(histories: Sequence[History]) -> str:
    """How far off the farthest position is, as the end of a sentence about positions.

    Empty where no position is off by `WORTH_SAYING_M`.

    Args:
        histories: one or more jobs, of one kind of source
    """
    given = [h.estimate.position.to_own_m for h in histories]
    known = [off for off in given if off is not None]
    if not known:
        return ""
    east_north = np.concatenate(known)
    metres = np.hypot(*east_north.T)
    metres = np.where(np.isfinite(metres), metres, 0.0)
    k = int(metres.argmax()) if len(metres) else -1
    if k < 0 or metres[k] < WORTH_SAYING_M:
        return ""
    east, north = -east_north[k]  # from there to the file's position
    parts = [(north, "north", "south"), (east, "east", "west")]
    off = [
        f"{abs(by):.0f} m {one if by > 0.0 else other}" for by, one, other in parts if abs(by) > 0.5
    ]
    words = histories[0].about.words.own_position
    return f"; the vehicle is up to {' and '.join(off)} of {words}"
