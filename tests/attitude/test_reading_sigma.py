"""The reading sigma of a job: in force, estimated, by restricted maximum likelihood."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import linalg, optimize, stats
from scipy.optimize import brentq
from scipy.stats import f

from tests.approved.texts import assert_approved
from tests.kit import estimates
from tests.kit.estimates import estimate
from tests.tolerances import assert_close
from vopd.attitude.history import HistoryOptions, histories, history
from vopd.attitude.reading_sigma import (
    SOURCES,
    CommonErrors,
    JobFrames,
    JobReadingSigma,
    most_likely,
    reading_sigmas,
    reading_sigmas_of_jobs,
)
from vopd.attitude.residuals import ResidualEquations
from vopd.attitude.sigmas import Sigmas, given_components, in_force
from vopd.attitude.uncertainty import block_reading_sigma, job_reading_sigmas
from vopd.errata import fixes
from vopd.estimate import Estimate, StatedSigmas
from vopd.pipeline import run
from vopd.synthetic import Plan
from vopd.synthetic.flight import make

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
    return reading_sigmas([one], [given_components(one, force)], force.reading)[0]


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
    assert_close("dense algebra", u.total[0, :3] / plain, np.ones(3))
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
    found, whole = reading_sigmas(parts, given, None), scale(one, sigmas)
    for part in found:
        assert_close("dense algebra", part.sigma, whole.sigma)
        assert_close("dense algebra", part.freedom, whole.freedom)
    assert_close("dense algebra", np.concatenate([part.chance for part in found]), whole.chance)


# Which reading sigma is in force, and which one the test of the frames takes


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
        (found,) = reading_sigmas([e], [[]], given)
    else:
        (found,) = reading_sigmas_of_jobs(e, [], given, [e])
    sigma, freedom, source, test_sigma = expected
    if sigma is None:
        left = [e.residual[k] - e.partials[k] @ (e.gain[k] @ e.residual[k]) for k in range(3)]
        sigma = test_sigma = float(np.sqrt((np.array(left) ** 2).sum() / 15.0))
    assert_close("sigma by a search", [found.sigma, found.test_sigma], [sigma, test_sigma])
    assert_close("sigma by a search", 1.0 / found.freedom, 1.0 / freedom)
    assert found.source == source


def test_the_blocks_of_a_job_have_the_given_sigma() -> None:
    both = job_reading_sigmas([job(2.0), job(1.0)], Sigmas(reading=0.125))
    assert [(one.sigma, one.source) for one in both] == [(0.125, "given")] * 2
    free = job_reading_sigmas([job(2.0), job(1.0)], Sigmas())
    assert free[0].sigma == free[1].sigma > 0.3 and free[0].source == "residuals"


def test_frames_are_tested_by_the_sigma_of_others() -> None:
    """The test's sigma, not that in force, which may be 0, with its degrees of freedom; a frame
    without a solution is not tested.
    """
    e = job(0.3, solved=np.array([True, False, True]))
    scale = JobReadingSigma(0.0, 7.0, "sample", np.zeros(99), 0.25)
    found = block_reading_sigma(e, Sigmas(), scale)
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


def test_a_job_that_settles_before_another_keeps_its_chances() -> None:
    """Readings of the second have long tails: its outliers are found in more rounds."""
    (one,), _ = make(Plan(landmarks=5, earth="wgs84"))
    points, rng = one.readings.points, np.random.default_rng(0)
    first, jobs = points.landmark_in[:, :1], []
    for noise in (rng.normal(size=first.shape), rng.standard_t(1.5, first.shape)):
        read = replace(points, landmark_in=np.repeat(first + 0.003 * noise, 3, axis=1))
        jobs.append(replace(one, readings=replace(one.readings, points=read)))
    chances = [h.uncertainty.reading.chance for h in run(jobs, fixes("all")).histories()]
    for job, chance in zip(jobs, chances, strict=True):
        (alone,) = run(job, fixes("all")).histories()
        np.testing.assert_array_equal(chance, alone.uncertainty.reading.chance)
    assert np.isfinite(chances).all()


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
        (found,) = reading_sigmas([e], [given_components(e, in_force(e, Sigmas()))], None)
    else:
        (found,) = reading_sigmas_of_jobs(e, [], None, [e])
    left = e.residual[1] - e.partials[1] @ (e.gain[1] @ e.residual[1])
    assert_close("sigma by a search", found.sigma, np.sqrt((left**2).sum() / 5.0))
    assert_close("sigma by a search", found.freedom, 5.0)
    assert np.isfinite(found.chance).tolist() == [True, False, False]


# The reading sigma where other errors are far larger than the readings


LEAST = 0.01  # the least reading sigma that is believed


def frame(seed: int, landmarks: int, common: float) -> JobFrames:
    """A frame; the first landmark's position has three errors that all frames of its job share.

    Args:
        seed: of residuals and derivatives
        landmarks: how many there are
        common: what a position that is wrong by a sigma changes in the image, in residuals
    """
    rng = np.random.default_rng(seed)
    two = 2 * landmarks
    columns = np.zeros((1, two, 3))
    columns[0, [0, landmarks]] = common * rng.normal(size=(2, 3))
    equations = ResidualEquations(
        rng.normal(size=(1, two)),
        1500.0 * rng.normal(size=(1, two, 3)),
        np.ones((1, two)),
        np.zeros((1, two, 0)),
        np.zeros((1, two, 0)),
    )
    return JobFrames(np.zeros(1, np.int64), equations, CommonErrors(columns, np.arange(3)[None], 3))


def sigma_of(one: JobFrames) -> tuple[float, float]:
    """The reading sigma of a job of one frame and its degrees of freedom, as in a solve."""
    with np.errstate(all="ignore"):
        sigma, freedom = most_likely([one], np.ones(1), np.full(1, LEAST))
    return float(sigma[0]), float(freedom[0])


@pytest.mark.parametrize("common", [1e5, 1e9, 1e14])
def test_an_error_without_limit_is_one_more_number_that_is_fitted(common: float) -> None:
    """Then sigma is that of a fit of the three turns without the landmark that is not known."""
    one = frame(3, 8, common)
    others = np.delete(np.arange(16), [0, 8])
    partials, residual = one.equations.partials[0, others], one.equations.residual[0, others]
    left = float(np.linalg.lstsq(partials, residual, rcond=None)[1][0])
    sigma, freedom = sigma_of(one)
    assert_close("sigma by a search", sigma, np.sqrt(left / 11.0))
    assert_close("sigma by a search", freedom * 13.0 / 11.0**2, 1.0)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("common", [1e5, 1e9, 1e14])
def test_errors_that_explain_all_residuals_say_nothing_about_the_readings(
    common: float, seed: int
) -> None:
    """Of four coordinates three go to the turns and the other to the errors: rounding is left.

    A sigma of the least or more would be believed. That of the readings is 6E-5 of a residual of
    one at the limit of what an error may explain, and rounding is not taken for one.
    """
    sigma, _ = sigma_of(frame(seed, 2, common))
    assert sigma < LEAST


def job_of(seed: int) -> ResidualEquations:
    """Two frames of three landmarks, whose shared errors are ten times those of the readings."""
    rng = np.random.default_rng(seed)
    shared = rng.normal(size=(2, 6, 2))
    residual = (shared @ rng.normal(size=(2, 2, 1)))[..., 0] + 0.1 * rng.normal(size=(2, 6))
    partials = rng.normal(size=(2, 6, 3))
    return ResidualEquations(residual, partials, np.ones((2, 6)), shared, np.zeros((2, 6, 0)))


def score(one: ResidualEquations, sigma: float) -> tuple[float, float]:
    """r' W W r and the trace of W by whole matrices."""
    squares = trace = 0.0
    for r, b, shared in zip(one.residual, one.partials, one.shared, strict=True):
        inverse = np.linalg.inv(sigma**2 * np.eye(6) + shared @ shared.T)
        w = inverse - inverse @ b @ np.linalg.inv(b.T @ inverse @ b) @ b.T @ inverse
        squares, trace = squares + float(r @ w @ w @ r), trace + float(np.trace(w))
    return squares, trace


def excess(log_sigma: float, one: ResidualEquations) -> float:
    squares, trace = score(one, float(np.exp(log_sigma)))
    return float(np.log(squares / trace))


@pytest.mark.parametrize("start", [0.03, 0.1, 3.0])
def test_jobs_together_have_the_sigma_of_each_by_a_search(start: float) -> None:
    """Where few steps do not lead to it, a search does; degrees of freedom are those of the part
    of the residuals that the readings have. Of residuals below the least it is half of that.
    """
    jobs = [job_of(seed) for seed in range(8)]
    together = ResidualEquations.concat(jobs)
    none = CommonErrors(np.zeros((16, 6, 0)), np.zeros((16, 0), np.int64), 0)
    part = JobFrames(np.repeat(np.arange(8), 2), together, none)
    with np.errstate(all="ignore"):
        sigma, freedom = most_likely([part], np.full(8, start), np.full(8, LEAST))
    low, high = np.log(LEAST), np.log(100.0)
    for k, one in enumerate(jobs):
        if excess(low, one) <= 0.0:
            assert sigma[k] <= LEAST
            continue
        expected = float(np.exp(brentq(excess, low, high, args=(one,))))
        assert_close("sigma by a search", sigma[k] / expected, 1.0)
        of_readings = expected**2 * score(one, expected)[1]
        assert_close("sigma by a search", freedom[k] * 6.0 / of_readings**2, 1.0)
