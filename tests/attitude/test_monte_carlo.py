"""The formulas of uncertainty against thousands of draws: within ten per cent, as promised."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from vopd.film.reading_sigma import reading_sigma_mm

from tests.kit import repeated_frame as draws
from tests.tolerances import assert_close, within
from vopd.attitude.input_sigmas import Sigmas

STEEP = (140.0, -80.0, 60.0)
SLANTED = (30.0, -62.0, 200.0)
AFT = (1.0, -1.0, -1.0)


def agree(found: np.ndarray, predicted: np.ndarray) -> None:
    ratio = predicted / found
    assert np.abs(ratio - 1.0).max() < within("counted sigma"), ratio


@pytest.mark.parametrize("names", [(), ("first-landmark",)], ids=str)
@pytest.mark.parametrize("landmarks", [(0, 1, 2, 3, 4), (0, 2, 3, 4), (0, 1, 3), (1, 2)], ids=len)
@pytest.mark.parametrize(("truth", "multiplier"), [(STEEP, AFT), (SLANTED, (1.0, 1.0, 1.0))])
def test_readings(
    names: Sequence[str],
    landmarks: Sequence[int],
    truth: Sequence[float],
    multiplier: Sequence[float],
) -> None:
    """By residuals from three landmarks on, of two by the spread of the readings themselves.

    The scene is on the Earth of 1974: with the fix `earth` its residuals would be the Earth's.
    """
    rng = np.random.default_rng(len(landmarks))
    job = draws.misread(draws.repeated(truth, landmarks, multiplier), 0.003, rng)
    one = draws.solved(job, names, Sigmas())
    assert one.uncertainty.by_residuals.all() == (len(landmarks) > 2)
    agree(draws.found_deg(one), draws.predicted_deg(one.uncertainty.total))


def test_the_readings_tell_their_own_sigma() -> None:
    """Of the mean of three, .003 in on the reader each: 24,000 spreads, .5 per cent."""
    job = draws.misread(draws.repeated(landmarks=(0, 1, 2)), 0.003, np.random.default_rng(1))
    expected = 0.003 * draws.MM_PER_INCH / np.sqrt(3.0)
    assert abs(reading_sigma_mm(job) / expected - 1.0) < within("counted reading sigma")


@pytest.mark.parametrize("names", [(), ("first-landmark",), ("earth",)], ids=str)
@pytest.mark.parametrize("landmarks", [(0, 1, 2, 3, 4), (1, 2)], ids=len)
@pytest.mark.parametrize("cause", ["position", "landmark"])
def test_positions(names: Sequence[str], landmarks: Sequence[int], cause: str) -> None:
    rng = np.random.default_rng(7)
    job = draws.repeated(SLANTED, landmarks, AFT)
    move = draws.displaced if cause == "position" else draws.missurveyed
    given = Sigmas(0.0, **{f"{cause}_ft": 60.0})
    one = draws.solved(move(job, 60.0, rng), names, given)
    agree(draws.found_deg(one), draws.predicted_deg(one.uncertainty.components[cause]))


@pytest.mark.parametrize("names", [(), ("first-landmark",)], ids=str)
def test_times(names: Sequence[str]) -> None:
    """The vehicle is elsewhere and flies in another direction."""
    job = draws.mistimed(draws.repeated(SLANTED), 0.2, np.random.default_rng(3))
    one = draws.solved(job, names, Sigmas(0.0, time_s=0.2))
    agree(draws.found_deg(one), draws.predicted_deg(one.uncertainty.components["time"]))


@pytest.mark.parametrize("names", [(), ("first-landmark",)], ids=str)
def test_focal_length(names: Sequence[str]) -> None:
    """One number for all frames of a job: longer and shorter by .01 mm."""
    job = draws.repeated(SLANTED, (0, 2, 3), draws=2)
    ends = []
    for focal in (10.41, 10.39):
        camera = replace(job.camera, focal_length_mm=focal)
        e = draws.solved(replace(job, camera=camera), names, Sigmas()).estimate
        ends.append(np.concatenate([e.camera_deg[0], e.vehicle_deg[0], e.attack_deg[0]]))
    predicted = draws.solved(job, names, Sigmas(focal_mm=0.01)).uncertainty.components["focal"][0]
    agree(np.abs(ends[0] - ends[1]) / 2.0, predicted)


def test_all_together() -> None:
    """Readings, positions and landmarks at once; residuals hold the landmarks' errors already."""
    rng = np.random.default_rng(11)
    job = draws.repeated(SLANTED, (1, 2))
    job = draws.missurveyed(draws.displaced(draws.misread(job, 0.003, rng), 60.0, rng), 30.0, rng)
    one = draws.solved(job, (), Sigmas(landmark_ft=30.0, position_ft=60.0))
    total = one.uncertainty.total
    agree(draws.found_deg(one), draws.predicted_deg(total))
    squares = sum(one_of**2 for one_of in one.uncertainty.components.values())
    assert_close("ratio", total / np.sqrt(squares), 1.0)
    covariance = one.uncertainty.camera_covariance_deg2
    deviation = np.sqrt(np.diagonal(covariance, axis1=1, axis2=2))
    assert_close("ratio", deviation / total[:, :3], 1.0)
    angles = one.estimate.camera_deg
    expected = np.corrcoef(angles.T)
    mean = covariance.mean(axis=0)
    found = mean / np.sqrt(np.outer(np.diag(mean), np.diag(mean)))
    assert_close("counted correlation", found, expected)
