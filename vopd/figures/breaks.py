"""Where a line is to break: frames that are missing, and angles that wrap."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.attitude.history import History

GAP = 3.0  # so many times the usual step between frames is a gap


def in_time(history: History) -> Ints:
    """The places of a job's frames that have a time, in order of time."""
    time_s = history.estimate.time_s
    known = np.flatnonzero(np.isfinite(time_s))
    return np.asarray(known[np.argsort(time_s[known], kind="stable")])


def unwrapped_about(angles: Floats) -> float:
    """Where a circle of 360 degrees is best cut open: opposite to the mean direction.

    Angles from that cut on, 360 degrees of them, do not wrap unless they go all around.
    """
    known = np.radians(angles[np.isfinite(angles)])
    mean = np.degrees(np.arctan2(np.sin(known).sum(), np.cos(known).sum()))
    return float(round(mean) - 180.0)


def from_cut(angles: Floats, cut: float) -> Floats:
    """The same directions in the 360 degrees from a cut on."""
    return np.asarray((angles - cut) % 360.0 + cut)


def broken(time_s: Floats, angles: Floats) -> tuple[Floats, Ints]:
    """Times with a NaN where a line through `angles` (T,) breaks, and where each comes from.

    Angles that are NaN break it themselves. Returns the times, and the index of
    each in the arrays given, -1 at a break.
    """
    step = np.diff(time_s)
    usual = np.median(step[step > 0.0]) if (step > 0.0).any() else np.inf
    after = np.flatnonzero((step > GAP * usual) | (np.abs(np.diff(angles)) > 180.0)) + 1
    index = np.insert(np.arange(len(time_s)), after, -1)
    return np.where(index < 0, np.nan, time_s[index]), index


def picked(values: Floats, index: Ints) -> Floats:
    """The values along a broken line, NaN at a break."""
    return np.where(index < 0, np.nan, values[index])
