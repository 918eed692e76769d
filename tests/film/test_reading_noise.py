"""The noise of a job's readings: what is left where the three readings of all points agree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.jobs import case, film, only, reread
from tests.tolerances import assert_close
from vopd.film import ReadingNoise, reading_noises
from vopd.job import Job, Readings

MM_PER_IN = 0.713816400205


def agreed(offsets_in: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Job:
    """Case 1 with every landmark read three times at the same place, but for these in x and y."""
    job = case(1)
    readings = job.readings
    fiducial, landmark = readings.fiducial_in.copy(), readings.landmark_in.copy()
    fiducial[:] = fiducial[:, :, :1]
    landmark[:] = landmark[:, :, :1] + np.array(offsets_in)[:, None]
    return replace(job, readings=reread(readings, fiducial_in=fiducial, landmark_in=landmark))


def reading_noise(job: Job) -> ReadingNoise:
    (noise,) = reading_noises([job])
    return noise


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


@pytest.mark.parametrize(("noise_in", "known"), [(0.01, True), (1e4, False)])
def test_fiducials_whose_shape_changes_from_frame_to_frame(noise_in: float, known: bool) -> None:
    """The change is the noise of a fiducial, unless it is wider than any film reader."""
    job, frames = agreed(), 300
    readings = job.readings
    fiducial, landmark, number, present = (
        np.repeat(getattr(readings, name), frames, axis=0)
        for name in ("fiducial_in", "landmark_in", "landmark", "present")
    )
    fiducial += np.random.default_rng(3).normal(0.0, noise_in, (frames, 4, 1, 2))
    many = Readings.of(np.arange(frames) + 1, fiducial, number, present, landmark)
    noise = reading_noise(replace(job, readings=many))
    ratio = noise.fiducial_mm / (noise_in * MM_PER_IN)
    assert 0.9 < ratio < 1.1 if known else noise.fiducial_mm == noise.resolution_mm


def noisy(frames: int, seed: int) -> Job:
    """A film whose readings all differ."""
    job, random = film(frames), np.random.default_rng(seed)
    readings = {
        name: getattr(job.readings, name)
        + random.normal(0.0, 0.01, getattr(job.readings, name).shape)
        for name in ("fiducial_in", "landmark_in")
    }
    return replace(job, readings=reread(job.readings, **readings))


def test_jobs_together_have_the_noise_that_each_has_alone() -> None:
    """To the last bit; one has a frame without a fiducial, one a landmark a mile away."""
    jobs = [noisy(frames, seed) for seed, frames in enumerate((20, 20, 4, 20, 20, 2, 4, 20, 2))]
    jobs[1].readings.fiducial_in[3, 2, 1] = np.nan
    jobs[4].readings.points.landmark_in[7, 2] = 6e4
    together = reading_noises(jobs)
    assert [repr(one) for one in together] == [repr(reading_noise(job)) for job in jobs]
    assert len({repr(one) for one in together}) == len(jobs)


def test_jobs_that_are_alike_in_one_number_only() -> None:
    """As many landmarks in all in more frames, as many frames with more landmarks."""
    sizes = ((2, 3), (3, 2), (2, 2), (6, 1), (3, 3), (2, 3), (3, 2))
    jobs = [only(noisy(frames, 7 + k), *range(marks)) for k, (frames, marks) in enumerate(sizes)]
    together = reading_noises(jobs)
    assert [repr(one) for one in together] == [repr(reading_noise(job)) for job in jobs]
    assert len({one.spread_mm for one in together}) == len(jobs)
