"""Each component of the uncertainty by itself, against thousands of draws: within ten per cent.

`test_coverage.py` counts how often the truth is inside when all of them are at work. Here
one input at a time is wrong, so that a component that is small beside others is seen too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from tests.kit import repeated_frame as draws
from tests.tolerances import within
from vopd.attitude.sigmas import Sigmas
from vopd.job import Job

SLANTED = (30.0, -62.0, 200.0)
AFT = (1.0, -1.0, -1.0)
NOISE_IN = 0.003  # of a single reading
FAITHFUL_OR_FIXED = pytest.mark.parametrize("names", [(), ("first-landmark",)], ids=str)


def agree(found: np.ndarray, predicted: np.ndarray) -> None:
    ratio = predicted / found
    assert np.abs(ratio - 1.0).max() < within("counted sigma"), ratio


def drawn_apart(job: Job, given: Sigmas, cause: str, names: Sequence[str]) -> None:
    """The spread of the solved angles is the component, in the angles that have a spread."""
    one = draws.solved(job, names, given)
    spread = draws.found_deg(one)
    predicted = draws.predicted_deg(one.uncertainty.components[cause])
    moved = spread > 1e-9
    assert moved.any() and not predicted[~moved].any()
    agree(spread[moved], predicted[moved])


@FAITHFUL_OR_FIXED
@pytest.mark.parametrize("landmarks", [(0, 1, 2, 3, 4), (0, 1, 3), (1, 2)], ids=len)
def test_readings(names: Sequence[str], landmarks: Sequence[int]) -> None:
    """Their sigma is found from the residuals, with two landmarks too."""
    rng = np.random.default_rng(len(landmarks))
    job = draws.misread(draws.repeated(SLANTED, landmarks, AFT), NOISE_IN, rng)
    one = draws.solved(job, names, Sigmas())
    agree(draws.found_deg(one), draws.predicted_deg(one.uncertainty.total))


@pytest.mark.parametrize("given_ft", [0.0, 60.0])
@pytest.mark.parametrize("landmarks", [(0, 1, 2, 3, 4), (1, 2)], ids=len)
def test_the_reading_sigma_is_what_other_errors_leave(
    landmarks: Sequence[int], given_ft: float
) -> None:
    """Errors of landmarks and positions that are given are taken out of it."""
    rng = np.random.default_rng(11)
    job = draws.misread(draws.repeated(SLANTED, landmarks), NOISE_IN, rng)
    job = draws.missurveyed(draws.displaced(job, given_ft, rng), given_ft, rng)
    one = draws.solved(job, (), Sigmas(landmark=given_ft, position=given_ft))
    expected = NOISE_IN * draws.MM_PER_INCH / np.sqrt(3.0)
    assert abs(one.uncertainty.reading.sigma / expected - 1.0) < within("estimated reading sigma")


@pytest.mark.parametrize("names", [(), ("first-landmark",), ("earth",)], ids=str)
@pytest.mark.parametrize("landmarks", [(0, 1, 2, 3, 4), (1, 2)], ids=len)
@pytest.mark.parametrize("cause", ["position", "landmark"])
def test_positions(names: Sequence[str], landmarks: Sequence[int], cause: str) -> None:
    job = draws.repeated(SLANTED, landmarks, AFT)
    move = draws.displaced if cause == "position" else draws.missurveyed
    wrong = move(job, 60.0, np.random.default_rng(7))
    drawn_apart(wrong, Sigmas(0.0, **{cause: 60.0}), cause, names)


@FAITHFUL_OR_FIXED
def test_times(names: Sequence[str]) -> None:
    """The vehicle is elsewhere and flies in another direction."""
    job = draws.mistimed(draws.repeated(SLANTED), 0.2, np.random.default_rng(3))
    drawn_apart(job, Sigmas(0.0, time_s=0.2), "time", names)


def test_velocities() -> None:
    job = draws.repeated(SLANTED, multiplier=AFT)
    path = job.trajectory
    noise = np.random.default_rng(4).normal(0.0, 10.0, path.velocity_ft_s.shape)
    wrong = replace(job, trajectory=replace(path, velocity_ft_s=path.velocity_ft_s + noise))
    drawn_apart(wrong, Sigmas(0.0, velocity=10.0), "velocity", ())


@FAITHFUL_OR_FIXED
def test_focal_length(names: Sequence[str]) -> None:
    """One number for all frames of a job: longer and shorter by .01 mm."""
    job = draws.repeated(SLANTED, (0, 2, 3), draws=2)
    ends = [
        draws.angles_deg(
            draws.solved(
                replace(job, camera=replace(job.camera, focal_length_mm=focal)), names, Sigmas()
            )
        )[0]
        for focal in (10.41, 10.39)
    ]
    predicted = draws.solved(job, names, Sigmas(focal_length=0.01)).uncertainty.components["focal"]
    agree(np.abs(ends[0] - ends[1]) / 2.0, predicted[0])


def test_wind() -> None:
    """One number for all frames too: more and less by 10 ft/s, toward north and toward east."""
    job = draws.repeated(SLANTED, draws=2)
    squares = np.zeros(9)
    for change in ([10.0, 0.0], [0.0, 10.0]):
        ends = [
            draws.angles_deg(
                draws.solved(
                    replace(
                        job,
                        wind=replace(
                            job.wind, velocity_ft_s=job.wind.velocity_ft_s + side * np.array(change)
                        ),
                    ),
                    (),
                    Sigmas(),
                )
            )[0]
            for side in (1.0, -1.0)
        ]
        squares += ((ends[0] - ends[1]) / 2.0) ** 2
    predicted = draws.solved(job, (), Sigmas(wind=10.0)).uncertainty.components["wind"][0]
    assert not squares[:6].any() and not predicted[:6].any()
    agree(np.sqrt(squares[6:]), predicted[6:])
