"""Estimate the noise of film coordinates from the three readings of points, and fiducials."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.job import Job, Readings
from vopd.program.constants import factor

WIDEST_IN = 100.0  # no film reader is wider
RESOLUTION_IN = 0.001  # of a reading on a card
FRAMES_FOR_SHAPE = 3  # so many show how far the fiducials' rectangle keeps its shape


class ReadingNoise(NamedTuple):
    """Standard deviations of film coordinates that are the mean of three readings, mm."""

    spread_mm: float  # of a landmark's, by its three readings; NaN where there is no landmark
    resolution_mm: float  # what rounding to a card's last digit leaves
    fiducial_mm: float  # of a fiducial's; NaN where no reading is usable


def reading_noise(job: Job) -> ReadingNoise:
    """Estimate the noise of a job's readings.

    The spread of three readings says how well the reader repeats them, not how well
    the point was identified. For fiducials the change of their shape from frame to
    frame says that as well, and the larger of the two counts.

    Args:
        job: its readings; one that is farther from the others than a film reader
            is wide is left out, for it would pass for the noise of all frames
    """
    readings = job.readings
    resolution = RESOLUTION_IN / np.sqrt(12.0)
    triples = readings.fiducial_in.reshape(-1, 3, 2)
    fiducial = np.fmax(_spread_in(triples), _fiducial_shape_in(readings))
    return ReadingNoise(
        factor * _spread_in(readings.points.landmark_in),
        factor * resolution,
        factor * float(np.fmax(fiducial, resolution)),
    )


@np.errstate(all="ignore")
def _spread_in(triples: Floats) -> float:
    """Standard deviation of the mean of three readings (n, 3, 2), by their differences.

    Each spread has two degrees of freedom; the mean of three has a third of their variance.
    """
    variance = triples.var(axis=1, ddof=1)
    variance = variance[variance < WIDEST_IN**2]
    return float(np.sqrt(variance.mean() / 3.0)) if len(variance) else float("nan")


@np.errstate(all="ignore")
def _fiducial_shape_in(readings: Readings) -> float:
    """Standard deviation of a fiducial's coordinate, by the shape of the four in all frames.

    The shape is where each stands from the centre of the four. What the film's turn on
    the reader and its shrinking change, in first order, is taken out of each frame. The
    median over frames is taken, so that one misread fiducial does not count. NaN with
    fewer than `FRAMES_FOR_SHAPE` frames.
    """
    corner = readings.fiducial_in.mean(axis=2)
    shape = corner - corner.mean(axis=1, keepdims=True)
    shape = shape[np.isfinite(shape).all(axis=(1, 2))]
    frames = len(shape)
    if frames < FRAMES_FOR_SHAPE:
        return float("nan")
    mean = np.median(shape, axis=0)
    size = float((mean**2).sum())
    if size == 0.0:
        return float("nan")
    change = shape - mean
    turned = np.stack([-mean[:, 1], mean[:, 0]], axis=-1)
    for direction in (mean, turned):
        along = (change * direction).sum(axis=(1, 2)) / size
        change = change - along[:, None, None] * direction
    squares = (change**2).sum(axis=(1, 2))  # four degrees of freedom a frame
    if np.median(squares) > WIDEST_IN**2:
        return float("nan")
    return float(np.sqrt(np.median(squares) / MEDIAN_CHI2_4))


MEDIAN_CHI2_4 = 3.3566939800333224  # of chi-square with four degrees of freedom
