"""Estimate the noise of the film reader from the three readings of every point."""

from __future__ import annotations

import numpy as np

from vopd.job import Job
from vopd.program.constants import factor

WIDEST_IN = 100.0  # no film reader is wider


def reading_sigma_mm(job: Job) -> float:
    """The standard deviation of a landmark's film coordinate, mm, from its three readings.

    The spread of three readings has two degrees of freedom; all landmarks and
    both coordinates of the job are pooled, and the mean of three has a third of
    their variance. NaN where there is no landmark.

    Args:
        job: its readings; one that is farther from the others than a film reader
            is wide is left out, for it would pass for the noise of all frames
    """
    readings = job.readings.points.landmark_in
    with np.errstate(all="ignore"):
        variance = readings.var(axis=1, ddof=1)
    variance = variance[variance < WIDEST_IN**2]
    return float(factor * np.sqrt(variance.mean() / 3.0)) if len(variance) else float("nan")
