"""The repairs of a frame: which are plausible, in which order, and with which chance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.stats import chi2

from tests.approved.texts import assert_approved
from tests.kit.estimates import FOCAL, POINTS, estimate
from tests.tolerances import assert_close
from vopd.attitude import mistakes as label_search
from vopd.attitude.mistakes import (
    MOST_FRAMES,
    MOST_IN_A_FRAME,
    MOST_LANDMARKS,
    MOST_NAMED,
    NEAR,
    NOTHING,
    PASSES,
    PLAUSIBLE,
    Repair,
    _equations,
    _fitted,
    best_exchange,
    misfit_text,
    repairs,
)
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.residuals import Pool, ResidualEquations, equations_of
from vopd.attitude.sigmas import Sigmas, in_force
from vopd.estimate import Estimate

ANGLES = np.array([[140.0, -60.0, 20.0]])
MORE = np.vstack([POINTS, [[-1.0, 3.0]]])
NONE = float("nan")


def test_limits_of_the_search() -> None:
    assert (MOST_LANDMARKS, MOST_IN_A_FRAME, MOST_FRAMES, MOST_NAMED) == (24, 200, 200, 3)
    assert (PASSES, PLAUSIBLE, NEAR) == (12, 0.001, 0.1)
    assert_approved(NOTHING)


def found(e: Estimate, sigma: float, freedom: float = np.inf) -> list[Repair]:
    return repairs(e, 0, equations_of(e, [], np.array([0])), Pool(sigma, freedom, None))


TRIALS = [((0, 1), None), ((0, 2), None), ((1, 2), None), ((), 0), ((), 1), ((), 2)]


@pytest.mark.parametrize(
    ("chances", "expected"),
    [
        ([0.5, 0.3, 0.06, 0.04, 0.051, 0.9], [5, 0, 1]),
        ([0.5, 0.3, 0.06, 0.04, 0.051, 0.05], [0, 1, 2, 4, 5]),
        ([0.0011, 0.0009, 0.0, 0.0, 0.001, 0.0], [0, 4]),
        ([0.2, 0.2, NONE, 0.2, np.inf, 0.021], [0, 1, 3, 5]),
        ([0.0, 0.0, 0.0009, NONE, 0.0, 0.0], []),
    ],
)
def test_repairs_that_are_plausible_and_not_much_less_likely_than_the_best(
    chances: list[float], expected: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A chance of a thousandth, and a tenth of the best one; alike ones in the order of trials."""
    monkeypatch.setattr(label_search, "chance_of", lambda *_: np.array(chances))
    told = found(estimate(ANGLES, POINTS[:3]), 0.1)
    assert [(one.exchanged, one.without, one.chance) for one in told] == [
        (*TRIALS[k], chances[k]) for k in expected
    ]


def test_a_repair_with_a_landmark_behind_the_camera_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(label_search, "chance_of", lambda *_: np.full(6, 0.5))
    front = np.array([True, False, True, True, False, True])
    fitted = label_search._fitted

    def some_behind(*given: Any) -> Any:
        one = fitted(*given)
        return one and one._replace(in_front=front)

    monkeypatch.setattr(label_search, "_fitted", some_behind)
    told = found(estimate(ANGLES, POINTS[:3]), 0.1)
    assert [(one.exchanged, one.without) for one in told] == [
        TRIALS[k] for k in np.flatnonzero(front)
    ]


def exchanged(a: int, b: int, noise: float) -> tuple[Estimate, np.ndarray, np.ndarray]:
    """A frame with two labels exchanged, and what is left of its noise when it is fitted."""
    rng = np.random.default_rng(6)
    errors = rng.normal(0.0, noise, 10)
    image = MORE + errors.reshape(2, 5).T
    right = estimate(ANGLES, MORE)
    fit, *_ = np.linalg.lstsq(right.partials[0], errors, rcond=None)
    left = errors - right.partials[0] @ fit
    swapped = image.copy()
    swapped[[a, b]] = image[[b, a]]
    e = estimate(ANGLES, MORE, residual=(swapped - MORE).T.reshape(1, 10))
    e.__dict__["image"] = swapped[None]
    return e, left, errors


@pytest.mark.parametrize(("a", "b"), [(0, 1), (1, 4), (2, 3)])
def test_the_exchange_that_was_made_is_found_with_its_chance(a: int, b: int) -> None:
    """That of residuals as large as those that least squares leave of the noise, chi-square with
    2 x 5 - 3 degrees; and the root mean square of these residuals over 10.
    """
    e, left, _ = exchanged(a, b, 1e-3)
    (first, *_) = found(e, 1.2e-3)
    assert (first.exchanged, first.without) == ((a, b), None)
    squares = float((left**2).sum())
    assert_close("ratio of three digits", first.chance, chi2.sf(squares / 1.2e-3**2, 7))
    pair, rms = best_exchange(e, 0)
    assert pair == (a, b)
    assert_close("ratio of three digits", rms / np.sqrt(squares / 10.0), 1.0)


def test_the_landmark_that_is_off_is_found() -> None:
    e, _, errors = exchanged(0, 0, 1e-3)
    wrong = e.image.copy()
    wrong[0, 3] += 0.4, -0.7
    e.__dict__["image"] = wrong
    (first, *others) = found(e, 1.2e-3)
    assert (first.exchanged, first.without) == ((), 3) and not others
    keep = np.tile(np.arange(5) != 3, 2)
    b = estimate(ANGLES, MORE).partials[0][keep]
    fit, *_ = np.linalg.lstsq(b, errors[keep], rcond=None)
    squares = float(((errors[keep] - b @ fit) ** 2).sum())
    assert_close("ratio of three digits", first.chance, chi2.sf(squares / 1.2e-3**2, 5))


def test_where_nothing_is_exchanged_the_best_exchange_is_a_bad_one() -> None:
    e = estimate(ANGLES, MORE)
    pair, rms = best_exchange(e, 0)
    assert len(pair) == 2 and 0.01 * FOCAL < rms < FOCAL
    assert best_exchange(estimate(ANGLES, POINTS[:2]), 0) == ((), np.inf)
    assert found(estimate(ANGLES, POINTS[:2]), 0.1) == []


def test_landmarks_that_take_no_part_are_neither_tried_nor_in_the_way() -> None:
    """One is left out by the user, behind the camera, and one has no direction."""
    e = estimate(ANGLES, np.vstack([MORE, [[2.0, -3.0]]]))
    direction = e.direction.copy()
    direction[0, 1] *= -1.0
    direction[0, 4] = np.nan
    used = np.array([[True, False, True, True, True, True]])
    one = estimate(ANGLES, np.vstack([MORE, [[2.0, -3.0]]]), direction=direction, used=used)
    with np.errstate(all="ignore"):
        fitted = _fitted(one, 0, np.zeros(12))
    assert fitted is not None
    pairs = [(0, 2), (0, 3), (0, 5), (2, 3), (2, 5), (3, 5)]
    assert [repair.exchanged for repair in fitted.tried.repair] == [*pairs, *[()] * 4]
    assert [repair.without for repair in fitted.tried.repair][6:] == [0, 2, 3, 5]
    assert fitted.in_front[6:].all()


@np.errstate(all="ignore")
def test_errors_of_landmarks_go_with_the_landmark_and_others_stay() -> None:
    """x and y of what stands in column 0 have the errors of landmark 2 where they are exchanged."""
    e = estimate(ANGLES, POINTS[:3])
    fitted = _fitted(e, 0, np.zeros(6))
    assert fitted is not None
    own = np.arange(18.0).reshape(1, 6, 3) + 1.0
    shared = -np.arange(12.0).reshape(1, 6, 2) - 1.0
    variance = np.arange(1.0, 7.0)[None]
    given = ResidualEquations(np.zeros((1, 6)), np.zeros((1, 6, 3)), variance, shared, own)
    made = _equations(fitted.sights, fitted.axes, fitted.tried.label, given)
    x, y = own[0, :3], own[0, 3:]
    assert made.own[1].tolist() == [*x[[2, 1, 0]].tolist(), *y[[2, 1, 0]].tolist()]
    assert made.shared[1].tolist() == shared[0].tolist()
    assert made.variance[1].tolist() == variance[0].tolist()
    assert made.own[3].tolist() == [[0.0] * 3, *x[1:].tolist(), [0.0] * 3, *y[1:].tolist()]
    for part in (made.residual, made.partials, made.variance, made.shared):
        assert not part[3, [0, 3]].any()


def test_the_search_takes_the_sigmas_in_force(monkeypatch: pytest.MonkeyPatch) -> None:
    """The test's reading sigma with its degrees of freedom, and the errors that are given."""
    asked: list[tuple[Pool, ResidualEquations]] = []

    def search(_: object, frame: int, equations: ResidualEquations, pool: Pool) -> list[Repair]:
        asked.append((pool, equations))
        return [Repair((), frame, 0.123)]

    monkeypatch.setattr(label_search, "repairs", search)
    e = estimate(np.repeat(ANGLES, 3, axis=0))
    chance = np.array([0.5, 0.0009, 0.0011])
    scale = JobReadingSigma(0.0, 7.0, "sample", chance, 0.25)
    text = misfit_text(e, scale, in_force(e, Sigmas(position=3.0, landmark=5.0)))
    assert text == ["", "without bridge, north end (chance 0.12)", ""]
    ((pool, equations),) = asked
    assert pool == (0.25, 7.0, None)
    assert equations.shared.tolist() == np.full((1, 8, 3), -0.03).tolist()
    assert equations.own.tolist() == np.full((1, 8, 3), 0.05).tolist()
