"""Break the lines of a figure where frames are missing and where angles wrap."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.attitude.history import History

GAP = 3.0  # a step this many times the median step between frames is a gap


def in_time(history: History) -> Ints:
    """The indices of a job's frames that have a time, in order of time."""
    time_s, _ = history.order_axis
    known = np.flatnonzero(np.isfinite(time_s))
    return np.asarray(known[np.argsort(time_s[known], kind="stable")])


def unwrapped_about(angles: Floats) -> float:
    """The direction, degrees, at which to cut the circle: opposite to the mean of the angles.

    Angles in the 360 degrees from there on do not wrap unless they go all around.

    Args:
        angles: degrees; NaN is left out
    """
    known = np.radians(angles[np.isfinite(angles)])
    mean = np.degrees(np.arctan2(np.sin(known).sum(), np.cos(known).sum()))
    return float(round(mean) - 180.0)


def from_cut(angles: Floats, cut: float) -> Floats:
    """The same directions as angles between `cut` and `cut` + 360 degrees."""
    return np.asarray((angles - cut) % 360.0 + cut)


def broken(time_s: Floats, angles: Floats) -> tuple[Floats, Ints]:
    """Insert a NaN into a line of angles wherever it must be interrupted.

    Args:
        time_s: in order, (T,)
        angles: degrees, (T,)

    Returns:
        The times, NaN at a break; and the index of each in the arrays given, -1 at a break.
    """
    step = np.diff(time_s)
    usual = np.median(step[step > 0.0]) if (step > 0.0).any() else np.inf
    after = np.flatnonzero((step > GAP * usual) | (np.abs(np.diff(angles)) > 180.0)) + 1
    index = np.insert(np.arange(len(time_s)), after, -1)
    return np.where(index < 0, np.nan, time_s[index]), index


def picked(values: Floats, index: Ints) -> Floats:
    """The values along a line with breaks; NaN at a break."""
    return np.where(index < 0, np.nan, values[index])
