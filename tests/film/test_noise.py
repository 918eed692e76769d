"""The noise of a job's readings: spread, last digit, and the change of the fiducials' shape.

Shapes are compared by least squares with numpy's solver, the median of chi-square is scipy's.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from tests.kit.jobs import case, film, only, reread
from tests.tolerances import assert_close
from vopd.film import reading_noises
from vopd.job import Job, Readings

SPREAD, RESOLUTION, FIDUCIAL = range(3)  # of a noise
MM_PER_IN = 0.713816400205
ROUNDING_MM = 0.001 / np.sqrt(12.0) * MM_PER_IN
CORNERS = np.array([[-7.0, -5.0], [7.0, -5.0], [7.0, 5.0], [-7.0, 5.0]])


def of_corners(corners: np.ndarray, landmark_in: np.ndarray | None = None) -> Job:
    """A film whose fiducials (F, 4, 2) are read three times alike; its landmarks too, or these."""
    job = film(len(corners))
    points = np.repeat(job.readings.landmark_in[:, :, :1], 3, axis=2)
    readings = reread(
        job.readings,
        fiducial_in=np.repeat(corners[:, :, None], 3, axis=2) + 10.0,
        landmark_in=points if landmark_in is None else landmark_in,
    )
    return replace(job, readings=readings)


def noise(job: Job) -> tuple[float, float, float]:
    (found,) = reading_noises([job])
    return found


def random_corners(frames: int) -> np.ndarray:
    return CORNERS + np.random.default_rng(frames).normal(0.0, 0.01, (frames, 4, 2))


def shape_noise_mm(corners: np.ndarray) -> float:
    """What is left of each frame after a turn and a scale; the median, by four degrees each."""
    shape = corners - corners.mean(axis=1, keepdims=True)
    mean = np.median(shape, axis=0)
    turned = np.stack([-mean[:, 1], mean[:, 0]], axis=1)
    columns = np.column_stack([mean.ravel(), turned.ravel()])
    left = []
    for one in shape:
        change = (one - mean).ravel()
        fit = np.linalg.lstsq(columns, change, rcond=None)[0]
        left.append(((change - columns @ fit) ** 2).sum())
    return float(np.sqrt(np.median(left) / chi2(4).median()) * MM_PER_IN)


@pytest.mark.parametrize("frames", [3, 4, 9])
def test_the_change_of_shape(frames: int) -> None:
    corners = random_corners(frames)
    assert_close("film length", noise(of_corners(corners))[FIDUCIAL], shape_noise_mm(corners))


@pytest.mark.parametrize("frames", [1, 2])
def test_two_frames_show_no_change_of_shape(frames: int) -> None:
    assert_close("film length", noise(of_corners(random_corners(frames)))[FIDUCIAL], ROUNDING_MM)


def test_one_misread_fiducial_does_not_count() -> None:
    corners = random_corners(9)
    before = noise(of_corners(corners))[FIDUCIAL]
    corners[4, 2] += [0.0, 2.0]
    after = noise(of_corners(corners))[FIDUCIAL]
    assert_close("film length", after, shape_noise_mm(corners))
    assert after < 2.0 * before


def test_frames_without_a_fiducial_are_left_out_of_the_shape() -> None:
    corners = random_corners(6)
    corners[2, 1] = np.nan
    known = np.delete(corners, 2, axis=0)
    assert_close("film length", noise(of_corners(corners))[FIDUCIAL], shape_noise_mm(known))


def test_fiducials_at_one_place_have_no_shape() -> None:
    assert_close("film length", noise(of_corners(np.zeros((4, 4, 2))))[FIDUCIAL], ROUNDING_MM)


@pytest.mark.parametrize(("by_in", "known"), [(99.0, True), (101.0, False)])
def test_readings_that_are_farther_apart_than_a_film_reader_is_wide(
    by_in: float, known: bool
) -> None:
    """Readings d apart have the variance d squared; that of one landmark of five counts, or not."""
    landmark = np.zeros((2, 5, 3, 2))
    landmark[:, :, :, :] = 0.002 * np.array([-1.0, 0.0, 1.0])[:, None]
    landmark[0, 3, :, 0] = by_in * np.array([-1.0, 0.0, 1.0])
    spread = noise(of_corners(CORNERS[None].repeat(2, axis=0), landmark))[SPREAD]
    count = 2 * 5 * 2
    mean = ((count - 1) * 0.002**2 + (by_in**2 if known else 0.0)) / (count if known else count - 1)
    assert_close("ratio by steps", spread / (np.sqrt(mean / 3.0) * MM_PER_IN), 1.0)


def test_the_mean_of_variances_and_none_at_all() -> None:
    """Of 1, 3 and 5 thousandths in equal numbers: (1 + 9 + 25) / 3."""
    d = np.array([0.001, 0.003, 0.005])
    landmark = d[:, None, None, None] * np.array([-1.0, 0.0, 1.0])[:, None] * np.ones((3, 5, 1, 2))
    corners = CORNERS[None].repeat(3, axis=0)
    mean_mm = 0.001 * np.sqrt(35.0 / 3.0 / 3.0) * MM_PER_IN
    assert_close("film length", noise(of_corners(corners, landmark))[SPREAD], mean_mm)
    assert np.isnan(noise(of_corners(corners, landmark * np.nan))[SPREAD])


@pytest.mark.parametrize("by_in", [0.0001, 0.01])
def test_the_noise_of_fiducials_is_the_largest_of_three(by_in: float) -> None:
    """Three readings of each fiducial d apart, beside rounding, beside no change of shape."""
    job = of_corners(CORNERS[None].repeat(4, axis=0))
    blur = by_in * np.array([-1.0, 0.0, 1.0])[:, None]
    fiducial = job.readings.fiducial_in + blur
    found = noise(replace(job, readings=reread(job.readings, fiducial_in=fiducial)))
    by_spread = by_in / np.sqrt(3.0) * MM_PER_IN
    assert_close("film length", found[FIDUCIAL], max(by_spread, ROUNDING_MM))
    assert_close("film length", found[RESOLUTION], ROUNDING_MM)


# Three readings that agree


def agreed(offsets_in: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Job:
    """Case 1 with every landmark read three times at the same place, but for these in x and y."""
    job = case(1)
    readings = job.readings
    fiducial, landmark = readings.fiducial_in.copy(), readings.landmark_in.copy()
    fiducial[:] = fiducial[:, :, :1]
    landmark[:] = landmark[:, :, :1] + np.array(offsets_in)[:, None]
    return replace(job, readings=reread(readings, fiducial_in=fiducial, landmark_in=landmark))


def reading_noise(job: Job) -> tuple[float, float, float]:
    (noise,) = reading_noises([job])
    return noise


def test_rounding_to_a_thousandth_of_an_inch_is_always_left() -> None:
    """Evenly spread between two thousandths: 1 / sqrt(12) of them, 0.000288675 in."""
    noise = reading_noise(agreed())
    assert_close("film length", noise[RESOLUTION], 0.000288675134595 * MM_PER_IN)
    assert_close("film length", noise[SPREAD], 0.0)
    assert_close("film length", noise[FIDUCIAL], 0.000288675134595 * MM_PER_IN)


def test_the_spread_is_that_of_the_mean_of_three() -> None:
    """Readings -3, 0 and 3 thousandths: variance 9, of their mean 3."""
    noise = reading_noise(agreed((-0.003, 0.0, 0.003)))
    assert_close("film length", noise[SPREAD], 0.001 * np.sqrt(3.0) * MM_PER_IN)


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
    ratio = noise[FIDUCIAL] / (noise_in * MM_PER_IN)
    assert 0.9 < ratio < 1.1 if known else noise[FIDUCIAL] == noise[RESOLUTION]


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
    assert len({one[SPREAD] for one in together}) == len(jobs)
