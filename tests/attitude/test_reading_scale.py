"""The reading sigma of a job, and the test of its frames, against dense linear algebra."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import linalg, optimize, stats

from tests.kit import estimates
from tests.tolerances import assert_close
from vopd.attitude.history import history
from vopd.attitude.reading_sigma import JobReadingSigma, reading_scales
from vopd.attitude.sigmas import Sigmas, given_components, in_force
from vopd.estimate import Estimate, StatedSigmas

TRUTH = np.array([[140.0, -70.0 + k, 60.0] for k in range(6)])
SOME = np.array([[3.0, 2.0], [-4.0, 1.0], [1.0, -4.0]])


def noisy(count: int = 6, image: np.ndarray = SOME, seed: int = 5, **changes: object) -> Estimate:
    """Frames with normal residuals of .02, landmarks that matter as much, and a tiny floor."""
    rng = np.random.default_rng(seed)
    one = estimates.estimate(TRUTH[:count], image, reading_spread=np.nan, reading_floor=1e-6)
    responses = replace(one.responses, landmark=rng.normal(0.0, 0.01, one.responses.landmark.shape))
    residual = rng.normal(0.0, 0.02, one.residual.shape)
    return replace(one, residual=residual, responses=responses, **changes)  # type: ignore[arg-type]


ESTIMATED = Sigmas()


def scale(one: Estimate, sigmas: Sigmas = ESTIMATED) -> JobReadingSigma:
    force = in_force(one, sigmas)
    return reading_scales([one], [given_components(one, force)], force.reading)[0]


def left(one: Estimate, frame: int) -> np.ndarray:
    """A basis of what the three angles of a frame cannot fit, as columns."""
    return linalg.null_space(one.partials[frame].T)


def covariance(
    one: Estimate, frame: int, sigma: float, landmark: float, centre: float
) -> np.ndarray:
    """Of the residuals of one frame, all landmarks moving by themselves."""
    count = one.used.shape[1]
    total = sigma**2 * np.eye(2 * count)
    for k in range(count):
        own = np.zeros((2 * count, 3))
        own[[k, count + k]] = one.responses.landmark[frame][[k, count + k]] * landmark
        total += own @ own.T
    for rows in (slice(0, count), slice(count, None)):
        shift = np.zeros(2 * count)
        shift[rows] = centre
        total += np.outer(shift, shift)
    return total


def test_alone_it_is_the_root_mean_square_of_all_residuals() -> None:
    """Six frames of three landmarks have eighteen degrees of freedom."""
    one = noisy()
    squares = sum(((left(one, k).T @ one.residual[k]) ** 2).sum() for k in range(6))
    found = scale(one)
    assert_close("dense algebra", found.sigma, np.sqrt(squares / 18.0))
    assert_close("dense algebra", found.freedom, 18.0)
    assert found.source == "residuals"


def test_two_landmarks_have_a_degree_of_freedom() -> None:
    one = noisy(1, SOME[:2])
    (part,) = left(one, 0).T @ one.residual[0]
    found = scale(one)
    assert_close("dense algebra", found.sigma, abs(part))
    assert_close("dense algebra", found.freedom, 1.0)
    assert np.isnan(found.chance[0])  # no other frame says how large residuals are
    u = history(one).uncertainty
    plain = np.degrees(np.linalg.norm(one.gain[0], axis=1)) * found.sigma
    assert_close("dense algebra", u.total[0, :3] / plain, stats.t.ppf(stats.norm.cdf(1.0), 1))
    assert_close("dense algebra", u.half_width_95[0, :3] / plain, stats.t.ppf(0.975, 1))


@pytest.mark.parametrize(
    ("spread", "floor", "source"), [(0.5, 0.1, "repeated"), (0.1, 0.4, "resolution")]
)
def test_it_is_never_below_what_readings_can_be(spread: float, floor: float, source: str) -> None:
    found = scale(replace(noisy(), reading_spread=spread, reading_floor=floor))
    assert found.sigma == max(spread, floor) and found.source == source
    assert np.isinf(found.freedom)


def test_a_given_one_is_taken_and_frames_are_tested_against_it() -> None:
    """With errors of landmarks and of the centre, given or stated: chi-square of dense matrices."""
    one = replace(noisy(fiducial_sigma=0.06), stated=StatedSigmas(landmark=(2.0, 2.0, 2.0)))
    found = scale(one, Sigmas(reading=0.05))
    assert (found.sigma, found.source, found.freedom) == (0.05, "given", np.inf)
    for k in range(6):
        n = left(one, k)
        inverse = np.linalg.inv(n.T @ covariance(one, k, 0.05, 2.0, 0.03) @ n)
        part = n.T @ one.residual[k]
        assert_close("dense algebra", found.chance[k], stats.chi2.sf(part @ inverse @ part, 3))


def test_an_estimated_one_tests_each_frame_against_the_others() -> None:
    one = noisy()
    squares = np.array([((left(one, k).T @ one.residual[k]) ** 2).sum() for k in range(6)])
    others = (squares.sum() - squares) / 15.0
    assert_close("dense algebra", scale(one).chance, stats.f.sf(squares / 3.0 / others, 3, 15))


def test_a_frame_that_does_not_agree_is_left_out() -> None:
    one = noisy()
    spoilt = one.residual.copy()
    spoilt[2] += 30.0 * left(one, 2)[:, 0]
    found = scale(replace(one, residual=spoilt))
    assert found.misfit.tolist() == [k == 2 for k in range(6)]
    without = np.delete(np.arange(6), 2)
    squares = sum(((left(one, k).T @ one.residual[k]) ** 2).sum() for k in without)
    assert_close("dense algebra", found.sigma, np.sqrt(squares / 15.0))


def test_given_errors_are_not_counted_again() -> None:
    """Restricted likelihood of all frames at once; landmarks' errors are the same in all."""
    one = noisy(reading_floor=1e-9)
    count, sigma_landmark, centre = 3, 1.5, 0.02
    basis = linalg.block_diag(*(left(one, k) for k in range(6)))
    part = basis.T @ one.residual.ravel()
    common = np.zeros((36, 9))
    for frame in range(6):
        for k in range(count):
            rows = [6 * frame + k, 6 * frame + count + k]
            change = one.responses.landmark[frame][[k, count + k]]
            common[rows, 3 * k : 3 * k + 3] = change * sigma_landmark
    shift = np.kron(np.eye(12), np.ones((3, 1))) * centre

    def cost(log_sigma: float) -> float:
        v = np.exp(2.0 * log_sigma) * np.eye(36) + common @ common.T + shift @ shift.T
        inside = basis.T @ v @ basis
        return float(np.linalg.slogdet(inside)[1] + part @ np.linalg.solve(inside, part))

    best = optimize.minimize_scalar(
        cost, bounds=(-8.0, 0.0), method="bounded", options={"xatol": 1e-10}
    )
    found = scale(replace(one, fiducial_sigma=2.0 * centre), Sigmas(landmark=sigma_landmark))
    assert_close("likelihood", found.sigma / np.exp(best.x), 1.0)
    assert found.sigma < scale(one).sigma


def test_blocks_of_a_job_have_one_sigma() -> None:
    """The same as the job in one piece, also where the landmarks' errors are common."""
    one = noisy()
    sigmas = Sigmas(landmark=1.5)
    parts = [one.take(slice(0, 2)), one.take(slice(2, 6))]
    forces = [in_force(part, sigmas) for part in parts]
    given = [given_components(part, force) for part, force in zip(parts, forces, strict=True)]
    found, whole = reading_scales(parts, given, None), scale(one, sigmas)
    for part in found:
        assert_close("dense algebra", part.sigma, whole.sigma)
        assert_close("dense algebra", part.freedom, whole.freedom)
    assert_close("dense algebra", np.concatenate([part.chance for part in found]), whole.chance)
