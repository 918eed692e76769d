"""Estimate the noise of film coordinates from the three readings of points, and fiducials."""

from __future__ import annotations

from collections.abc import Sequence
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


def reading_noises(jobs: Sequence[Job]) -> list[ReadingNoise]:
    """Estimate the noise of the readings of each of some jobs; those of one size together.

    The spread of three readings says how well the reader repeats them, not how well
    the point was identified. For fiducials the change of their shape from frame to
    frame says that as well, and the larger of the two counts.

    Args:
        jobs: their readings; one that is farther from the others than a film reader
            is wide is left out, for it would pass for the noise of all frames
    """
    alike: dict[tuple[int, int], list[int]] = {}
    for k, job in enumerate(jobs):
        layout = job.readings.layout
        alike.setdefault((len(layout.count), layout.total), []).append(k)
    found: dict[int, ReadingNoise] = {}
    for indices in alike.values():
        found |= zip(indices, _noises([jobs[k].readings for k in indices]), strict=True)
    return [found[k] for k in range(len(jobs))]


def _noises(several: Sequence[Readings]) -> list[ReadingNoise]:
    """The noise of readings of one number of frames and one of landmarks."""
    resolution = RESOLUTION_IN / np.sqrt(12.0)
    fiducial_in = np.stack([one.fiducial_in for one in several])
    points = _spread_in(np.stack([one.points.landmark_in for one in several]))
    spread = _spread_in(fiducial_in.reshape(len(several), -1, 3, 2))
    fiducial = np.fmax(np.fmax(spread, _fiducial_shape_in(fiducial_in)), resolution)
    return [
        ReadingNoise(factor * float(point), factor * resolution, factor * float(own))
        for point, own in zip(points, fiducial, strict=True)
    ]


@np.errstate(all="ignore")
def _spread_in(triples: Floats) -> Floats:
    """Standard deviation of the mean of three readings (J, n, 3, 2), by their differences, (J,).

    Each spread has two degrees of freedom; the mean of three has a third of their variance.
    """
    variance = triples.var(axis=2, ddof=1).reshape(len(triples), -1)
    usable = variance < WIDEST_IN**2
    each = zip(variance, usable, strict=True)
    means = [own[good].mean() if good.any() else np.nan for own, good in each]
    return np.sqrt(np.array(means) / 3.0)


@np.errstate(all="ignore")
def _fiducial_shape_in(fiducial_in: Floats) -> Floats:
    """Standard deviation of a fiducial's coordinate, by the shape of the four in all frames, (J,).

    The shape is where each stands from the centre of the four. What the film's turn on
    the reader and its shrinking change, in first order, is taken out of each frame. The
    median over frames is taken, so that one misread fiducial does not count. NaN with
    fewer than `FRAMES_FOR_SHAPE` frames.

    Args:
        fiducial_in: the readings of jobs of one number of frames (J, F, 4, 3, 2)
    """
    corner = fiducial_in.mean(axis=3)
    shape = corner - corner.mean(axis=2, keepdims=True)
    known = np.isfinite(shape).all(axis=(2, 3))
    if len(known) > 1 and not known.all():
        return np.concatenate([_fiducial_shape_in(one[None]) for one in fiducial_in])
    shape = shape[:, known[0]]  # of a single job, if any frame is left out
    if shape.shape[1] < FRAMES_FOR_SHAPE:
        return np.full(len(shape), np.nan)
    mean = np.median(shape, axis=1, keepdims=True)
    size = (mean**2).sum(axis=(2, 3))
    change = shape - mean
    turned = np.stack([-mean[..., 1], mean[..., 0]], axis=-1)
    for direction in (mean, turned):
        along = (change * direction).sum(axis=(2, 3)) / size
        change = change - along[..., None, None] * direction
    squares = np.median((change**2).sum(axis=(2, 3)), axis=1)  # four degrees of freedom a frame
    meaningless = (size[:, 0] == 0.0) | (squares > WIDEST_IN**2)
    return np.where(meaningless, np.nan, np.sqrt(squares / MEDIAN_CHI2_4))


MEDIAN_CHI2_4 = 3.3566939800333224  # of chi-square with four degrees of freedom
