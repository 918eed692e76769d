"""How well the film reader repeats, by the three readings of every point."""

from __future__ import annotations

import numpy as np

from vopd.job import Job
from vopd.program.constants import factor


def reading_sigma_mm(job: Job) -> float:
    """The standard deviation of a landmark's film coordinate, mm, by its three readings.

    The spread of three readings has two degrees of freedom; all landmarks and
    both coordinates of the job are pooled, and the mean of three has a third of
    their variance. NaN where there is no landmark.
    """
    readings = job.readings.landmark_in[job.readings.present]
    if not len(readings):
        return float("nan")
    variance = readings.var(axis=1, ddof=1).mean()
    return float(factor * np.sqrt(variance / 3.0))
