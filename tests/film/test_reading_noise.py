"""The noise of a job's readings: what is left where the three readings of all points agree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.kit.jobs import case
from tests.tolerances import assert_close
from vopd.film.reading_noise import reading_noise
from vopd.job import Job

MM_PER_IN = 0.713816400205


def agreed(offsets_in: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Job:
    """Case 1 with every landmark read three times at the same place, but for these in x and y."""
    job = case(1)
    readings = job.readings
    fiducial, landmark = readings.fiducial_in.copy(), readings.landmark_in.copy()
    fiducial[:] = fiducial[:, :, :1]
    landmark[:] = landmark[:, :, :1] + np.array(offsets_in)[:, None]
    return replace(job, readings=replace(readings, fiducial_in=fiducial, landmark_in=landmark))


def test_rounding_to_a_thousandth_of_an_inch_is_always_left() -> None:
    """Evenly spread between two thousandths: 1 / sqrt(12) of them, 0.000288675 in."""
    noise = reading_noise(agreed())
    assert_close("film length", noise.resolution_mm, 0.000288675134595 * MM_PER_IN)
    assert_close("film length", noise.spread_mm, 0.0)
    assert_close("film length", noise.fiducial_mm, 0.000288675134595 * MM_PER_IN)


def test_the_spread_is_that_of_the_mean_of_three() -> None:
    """Readings -3, 0 and 3 thousandths: variance 9, of their mean 3."""
    noise = reading_noise(agreed((-0.003, 0.0, 0.003)))
    assert_close("film length", noise.spread_mm, 0.001 * np.sqrt(3.0) * MM_PER_IN)
