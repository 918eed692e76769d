"""Picks that a program has followed from frame to frame, and of which no click is known.

Their errors are those of the clicks that they began with: from one frame to the next they are
nearly the same, and many frames are not as many picks.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.findings import Finding
from vopd.flight.flight import Flight
from vopd.flight.joint import JointSolution

ALIKE = 0.5  # correlation from one frame to the next that is told
FEWEST = 30  # pairs of following frames: fewer tell nothing of it


def followed_findings(flight: Flight, joint: JointSolution) -> list[Finding]:
    """Warn of tracks of other programs whose residuals agree from frame to frame."""
    alike = correlation_of_neighbours(joint)
    if not alike > ALIKE:
        return []
    frames = joint.model.solved
    worth = max(frames * (1.0 - alike) / (1.0 + alike), 1.0)
    return [
        Finding(
            f"tracked picks: their residuals agree from one frame to the next (correlation "
            f"{alike:.2f}), as those of one click do that is carried on: in a mean over frames, or "
            f"a curve through them, {frames} frames tell no more than {worth:.0f}, and it is "
            f"{np.sqrt(frames / worth):.1f} times less certain than is stated. vopd track says "
            "which click each pick is from, and their errors are solved for",
            flight.source,
            severity="warning",
        )
    ]


def correlation_of_neighbours(joint: JointSolution) -> float:
    """Correlate residuals of followed picks with those of the same landmark in the next frame.

    Returns:
        The correlation of u and v together; NaN where there are few such picks.
    """
    model, picks = joint.model, joint.model.flight.picks
    if picks.followed is None:
        return float("nan")
    own = np.flatnonzero(picks.followed[model.pick])
    frame, landmark = picks.frame[model.pick[own]], model.landmark[own]
    order = np.lexsort((frame, landmark))
    residual: Floats = joint.normal.residual[own[order]]
    frame, landmark = frame[order], landmark[order]
    near = (np.diff(frame) == 1) & (np.diff(landmark) == 0)
    if near.sum() < FEWEST:
        return float("nan")
    before, after = residual[:-1][near], residual[1:][near]
    square = float((before**2).sum() * (after**2).sum())
    return float((before * after).sum() / np.sqrt(square)) if square > 0.0 else float("nan")
