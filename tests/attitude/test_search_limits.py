"""How much of a job is searched for repairs and second solutions, and what is taken for granted."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kit.estimates import POINTS, estimate
from vopd.attitude.geometry import second_solution_rms
from vopd.attitude.history import History, histories_without_jumps, history
from vopd.attitude.mistakes import MOST_FRAMES, NOTHING
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.sigmas import Sigmas

ANGLES = np.tile([140.0, -60.0, 20.0], (4, 1))
GIVEN = Sigmas(reading=0.01)


def misfits(most: int = MOST_FRAMES) -> History:
    """Four frames of which the last three misfit, and nothing explains them."""
    residual = 5.0 * np.array([1.0, -1, 1, -1, 1, 1, -1, -1]) * np.array([[0.0], [1], [1], [1]])
    image = POINTS + residual.reshape(4, 2, 4).swapaxes(1, 2)
    e = estimate(ANGLES, residual=residual)
    e.__dict__["image"] = image
    return histories_without_jumps([e], GIVEN, most_searched=most)[0]


@pytest.mark.parametrize("most", [0, 1, 2, 3])
def test_no_more_frames_are_searched_than_are_asked_for(most: int) -> None:
    found = misfits(most)
    assert found.flags.raised["misfit"].tolist() == [False, True, True, True]
    expected = ["", *[NOTHING] * most, *[""] * (3 - most)]
    assert found.flags.detail["misfit"] == expected


def test_usually_all_are_searched() -> None:
    assert misfits().flags.detail["misfit"] == ["", NOTHING, NOTHING, NOTHING]


def test_a_reading_sigma_that_is_handed_on_is_the_one_in_force() -> None:
    """Frames are not tested anew, and the degrees of freedom are those of the job."""
    chance = np.array([0.5, 0.0001, np.nan, 0.0011])
    scale = JobReadingSigma(0.125, 7.0, "sample", chance, 0.25)
    (made,) = histories_without_jumps([estimate(ANGLES)], Sigmas(), scale)
    assert made.uncertainty.reading is scale
    assert made.flags.raised["misfit"].tolist() == [False, True, False, False]
    assert made.reading_sigma.tolist() == [0.125] * 4
    assert made.reading_freedom.tolist() == [7.0] * 4
    assert (made.uncertainty.freedom == 7.0).all()


FLAT = np.array([[3.0, 0.05], [-4.0, -0.04], [1.0, -0.05], [2.0, 0.03]])


@pytest.mark.parametrize(("sigma", "flagged"), [(0.5, True), (1e-4, False)])
def test_second_solutions_are_searched_as_far_as_they_are_flagged(
    sigma: float, flagged: bool
) -> None:
    """Landmarks nearly in a plane with the camera: the other side fits to some hundredths, which
    is more than the residuals of nothing, and less than three reading sigmas of .5.
    """
    e = estimate(ANGLES, FLAT)
    (worse, *_) = second_solution_rms(e)
    assert 3e-4 < worse < 1.5
    raised = history(e, sigmas=Sigmas(reading=sigma)).flags.raised["second_solution"]
    assert raised.tolist() == [flagged] * 4


def test_a_second_solution_that_fits_far_better_is_flagged() -> None:
    """Residuals of 1 here, and of some hundredths on the other side."""
    e = estimate(ANGLES, FLAT, residual=np.ones((4, 8)))
    raised = history(e, sigmas=Sigmas(reading=1e-4)).flags.raised["second_solution"]
    assert raised.tolist() == [True] * 4
