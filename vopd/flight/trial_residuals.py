"""The residuals of a flight that is solved without a usual mistake."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.estimate import Estimate
from vopd.flight.estimate import flight_estimate
from vopd.flight.flight import Flight
from vopd.flight.flight_blocks import FlightBlocks
from vopd.flight.solved_flight import solve

UNSEEN_PX = 1000.0  # what a pick counts whose landmark would have no image
FRAMES_TRIED = 500  # of more frames some are left out
MOST_PICKS = 4.0  # of a frame that is tried, in those that frames usually have
TRIAL_PASSES = 20  # which are enough where a trial explains the residuals


class MistakeTrial(NamedTuple):
    """A flight without one mistake: the residuals it would have, and what to say."""

    typical_px: float
    message: str


def some_frames(flight: Flight) -> Flight:
    """`FRAMES_TRIED` frames of the flight, evenly chosen, and none with many more picks than most.

    Arrays by frame and pick then have few empty elements.
    """
    blocks = FlightBlocks(flight)
    frames = np.arange(0, len(flight.frame), max(-(-len(flight.frame) // FRAMES_TRIED), 1))
    count = blocks.layout.count[frames]
    several = count[count >= 2]
    most = MOST_PICKS * np.median(several) if len(several) else np.inf
    return blocks.part(frames[count <= most]).flight


def solved_trial(flight: Flight) -> Estimate:
    """The estimate of a flight after few passes."""
    return flight_estimate(solve(flight, passes=TRIAL_PASSES))


def freedom(estimate: Estimate) -> int:
    """How many more residuals than angles there are."""
    used = estimate.used[np.isfinite(estimate.camera_deg[:, 0])]
    return int(2 * used.sum() - 3 * len(used))


def typical_px(flight: Flight, estimate: Estimate) -> float:
    """Root mean square of the residuals in the median frame, which one wrong pick leaves as it is.

    Picks that should take part and have no image count `UNSEEN_PX`. Frames without a
    position, or with one pick, have no attitude whatever is mistaken, and do not count.
    """
    frames = len(flight.frame)
    used = np.array(flight.landmarks.used or (True,) * len(flight.landmarks.name), dtype=bool)
    frame = flight.picks.frame
    here = used[flight.picks.landmark] & np.isfinite(flight.path.position_m[frame, 0])
    count = np.bincount(frame[here], minlength=frames)
    missing = count - estimate.used.sum(axis=1)
    squares = (estimate.residual**2).sum(axis=1) + missing * UNSEEN_PX**2
    several = count >= 2
    if not several.any():
        return UNSEEN_PX
    return float(np.median(np.sqrt(squares[several] / (2.0 * count[several]))))
