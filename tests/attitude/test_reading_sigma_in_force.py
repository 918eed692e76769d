"""Which reading sigma is in force, and which one the test of the frames takes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.stats import f

from tests.approved.texts import assert_approved
from tests.kit.estimates import estimate
from tests.tolerances import assert_close
from vopd.attitude.history import HistoryOptions, histories, history
from vopd.attitude.reading_sigma import (
    SOURCES,
    JobReadingSigma,
    reading_scales,
    reading_scales_of_jobs,
)
from vopd.attitude.sigmas import Sigmas, given_components, in_force
from vopd.attitude.uncertainty import block_reading_scale, job_reading_scales
from vopd.estimate import Estimate

ANGLES = np.tile([140.0, -60.0, 20.0], (3, 1))


def job(noise: float, **changes: Any) -> Estimate:
    return estimate(ANGLES, noise=noise, landmark_names={}, frame_names=(), **changes)


def test_every_source_in_words() -> None:
    assert_approved(SOURCES)


@pytest.mark.parametrize("way", ["alone", "jobs"])
@pytest.mark.parametrize(
    ("given", "spread", "noise", "expected"),
    [
        (0.7, 0.3, 0.0, (0.7, np.inf, "given", 0.7)), (0.2, 0.3, 0.0, (0.2, np.inf, "given", 0.2)),
        (0.0, 0.3, 0.0, (0.0, np.inf, "given", 0.3)),
        (0.0, 0.05, 0.0, (0.0, np.inf, "given", 0.1)),
        (None, 0.3, 0.0, (0.3, np.inf, "repeated", 0.3)),
        (None, 0.05, 0.0, (0.1, np.inf, "resolution", 0.1)),
        (None, 0.1, 0.0, (0.1, np.inf, "resolution", 0.1)),
        (None, 0.3, 2.0, (None, 15.0, "residuals", None)),
    ],
)  # fmt: skip
def test_a_given_sigma_counts_and_an_estimate_where_it_is_more_than_the_least(
    way: str, given: float | None, spread: float, noise: float,
    expected: tuple[float | None, float, str, float | None],
) -> None:  # fmt: skip
    """The floor is .1. A given 0 leaves the readings out, and frames are tested by the least.
    Three frames of four landmarks have 3 (8 - 3) degrees of freedom.
    """
    e = job(noise, reading_spread=spread)
    if way == "alone":
        (found,) = reading_scales([e], [[]], given)
    else:
        (found,) = reading_scales_of_jobs(e, [], given, [e])
    sigma, freedom, source, test_sigma = expected
    if sigma is None:
        left = [e.residual[k] - e.partials[k] @ (e.gain[k] @ e.residual[k]) for k in range(3)]
        sigma = test_sigma = float(np.sqrt((np.array(left) ** 2).sum() / 15.0))
    assert_close("sigma by a search", [found.sigma, found.test_sigma], [sigma, test_sigma])
    assert_close("sigma by a search", 1.0 / found.freedom, 1.0 / freedom)
    assert found.source == source


def test_the_blocks_of_a_job_have_the_given_sigma() -> None:
    both = job_reading_scales([job(2.0), job(1.0)], Sigmas(reading=0.125))
    assert [(one.sigma, one.source) for one in both] == [(0.125, "given")] * 2
    free = job_reading_scales([job(2.0), job(1.0)], Sigmas())
    assert free[0].sigma == free[1].sigma > 0.3 and free[0].source == "residuals"


def test_frames_are_tested_by_the_sigma_of_others() -> None:
    """The test's sigma, not that in force, which may be 0, with its degrees of freedom; a frame
    without a solution is not tested.
    """
    e = job(0.3, solved=np.array([True, False, True]))
    scale = JobReadingSigma(0.0, 7.0, "sample", np.zeros(99), 0.25)
    found = block_reading_scale(e, Sigmas(), scale)
    assert found == replace(scale, chance=found.chance)
    left = np.array(
        [r - b @ (g @ r) for r, b, g in zip(e.residual, e.partials, e.gain, strict=True)]
    )
    expected = f.sf((left**2).sum(axis=1) / 0.25**2 / 5.0, 5, 7.0)
    expected[1] = np.nan
    assert_close("dense algebra", found.chance[[0, 2]], expected[[0, 2]])
    assert np.isnan(found.chance[1])


def test_a_chance_below_a_thousandth_is_a_misfit() -> None:
    chance = np.array([0.0, 0.00099, 0.001, 0.0011, np.nan, 1.0])
    found = JobReadingSigma(1.0, 2.0, "given", chance, 1.0).misfit
    assert found.tolist() == [True, True, False, False, False, False]


@pytest.mark.parametrize("sigmas", [Sigmas(), Sigmas(0.4, position=5.0), Sigmas(time_s=0.2)])
def test_each_of_several_jobs_has_its_own(sigmas: Sigmas) -> None:
    """Jobs of other residuals, spreads and fiducials, made together and each by itself."""
    jobs = [
        job(0.5, reading_spread=0.01), job(4.0, reading_spread=0.2, fiducial_sigma=0.5),
        job(0.0, reading_spread=0.7), job(2.0, fiducial_sigma=0.1),
    ]  # fmt: skip
    jobs[1].residual[1] *= 30.0
    made = histories(jobs, HistoryOptions(sigmas))
    for one, e in zip(made, jobs, strict=True):
        alone = history(e, sigmas=sigmas)
        ours, theirs = one.uncertainty.reading, alone.uncertainty.reading
        assert ours == theirs
        np.testing.assert_array_equal(one.uncertainty.total, alone.uncertainty.total)
        assert one.reading_sigma.tolist() == [ours.sigma] * 3
    assert len({one.uncertainty.reading.sigma for one in made}) == (1 if sigmas.reading else 4)


@pytest.mark.parametrize("way", ["alone", "jobs"])
def test_a_frame_with_an_absurd_residual_tells_nothing(way: str) -> None:
    """A residual above the focal length, 10.4, is no reading error: the sigma is that of others,
    which here is one that cannot be tested against itself, nor can one without a solution.
    """
    e = job(1.0, solved=np.array([True, True, False]))
    plain = np.abs(e.residual).max()
    assert plain < 10.4
    e.residual[0, 5] = 10.5
    if way == "alone":
        (found,) = reading_scales([e], [given_components(e, in_force(e, Sigmas()))], None)
    else:
        (found,) = reading_scales_of_jobs(e, [], None, [e])
    left = e.residual[1] - e.partials[1] @ (e.gain[1] @ e.residual[1])
    assert_close("sigma by a search", found.sigma, np.sqrt((left**2).sum() / 5.0))
    assert_close("sigma by a search", found.freedom, 5.0)
    assert np.isfinite(found.chance).tolist() == [True, False, False]
