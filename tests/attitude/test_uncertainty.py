"""Uncertainty of the angles: by loops, interval of eta, error components, sigmas in force."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy import stats
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation
from scipy.stats import rice

from tests.kit import estimates
from tests.kit import repeated_frame as draws
from tests.kit.estimates import estimate
from tests.tolerances import assert_close, within
from vopd.arrays import Floats
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.sigmas import Sigmas, SigmasInForce, in_force
from vopd.attitude.uncertainty import Uncertainty, eta_interval_deg, uncertainty
from vopd.estimate import Estimate, Responses, StatedSigmas
from vopd.geometry.linear import covariance_factor_95
from vopd.job import Job

ANGLES = np.array([[140.0, -60.0, 20.0], [20.0, 30.0, 330.0]])
STATED = StatedSigmas((1.0, 2.0, 3.0), (4.0, 5.0, 6.0), 0.07, 0.08, (0.09, 0.1))
GIVEN = Sigmas(reading=0.5, fiducial=0.3, velocity=0.2, wind=0.15, mount_deg=0.4)
COMMON = ("principal_point", "landmark", "focal", "time", "mount")
COUNT = 4  # landmarks, of which the third of frame 2 takes no part


def made() -> Estimate:
    """Two frames whose derivatives are any numbers; 0 for a landmark that takes no part."""
    rng = np.random.default_rng(8)
    used = np.array([[True] * 4, [True, True, False, True]])
    here = np.tile(used, 2)

    def some(*shape: int) -> Floats:
        return rng.normal(size=(2, *shape))

    of_landmarks = Responses(
        landmark=some(8, 3) * here[..., None], position=some(8, 3) * here[..., None],
        focal_length=some(8) * here, time=some(8) * here, attack_by_camera=some(3, 3),
        attack_by_time=some(3), attack_by_velocity=some(3, 3),
    )  # fmt: skip
    return estimate(
        ANGLES, used=used, vehicle_deg=ANGLES[::-1] + 7.0, vehicle_by_camera=some(3, 3),
        gain=some(3, 8) * here[:, None], body_gain=some(3, 8) * here[:, None],
        responses=of_landmarks, relative_sigma=rng.uniform(0.5, 2.0, (2, 4)), stated=STATED,
    )  # fmt: skip


def turned(angles_deg: Floats, axis: int, by_deg: float) -> Floats:
    """Yaw, pitch, roll after a small turn of a vehicle about one of its axes."""
    before = Rotation.from_euler("ZYX", angles_deg, degrees=True)
    small = Rotation.from_rotvec(by_deg * np.eye(3)[axis], degrees=True)
    return np.asarray((before * small).as_euler("ZYX", degrees=True))


def causes(e: Estimate, k: int) -> dict[str, list[tuple[Floats, Floats, Floats]]]:
    """Of frame k: for each cause the residuals (8,), further angles (9,) and turn (3,), radians."""
    r, used = e.responses, np.tile(e.used[k], 2)
    along = np.repeat(np.eye(2), COUNT, axis=1) * used
    nine, three = np.zeros(9), np.zeros(3)
    found: dict[str, list[tuple[Floats, Floats, Floats]]] = {
        "reading": [
            (0.5 * e.relative_sigma[k, i % COUNT] * np.eye(8)[i], nine, three) for i in range(8)
        ],
        "centre": [(-0.15 * one, nine, three) for one in along],
        "principal_point": [(-0.09 * along[0], nine, three), (-0.1 * along[1], nine, three)],
        "position": [(r.position[k, :, c] * (4.0, 5.0, 6.0)[c], nine, three) for c in range(3)],
        "focal": [(0.07 * r.focal_length[k], nine, three)],
        "time": [(0.08 * r.time[k], np.append(np.zeros(6), 0.08 * r.attack_by_time[k]), three)],
        "landmark": [
            (r.landmark[k, :, c] * (1.0, 2.0, 3.0)[c] * (np.arange(8) % COUNT == i), nine, three)
            for i in range(COUNT)
            for c in range(3)
        ],
        "velocity": [
            (np.zeros(8), np.append(np.zeros(6), 0.2 * r.attack_by_velocity[k, :, c]), three)
            for c in range(3)
        ],
        "wind": [
            (np.zeros(8), np.append(np.zeros(6), -0.15 * r.attack_by_velocity[k, :, c]), three)
            for c in range(2)
        ],
    }  # fmt: skip
    found["mount"] = []
    for c in range(3):
        step = 1e-3
        there, back = (turned(e.vehicle_deg[k], c, way * step) for way in (1.0, -1.0))
        by_turn = (there - back) / (2.0 * step)
        camera = np.linalg.solve(e.vehicle_by_camera[k], by_turn)  # the same turn, of the camera
        angles = np.concatenate([np.zeros(3), by_turn, r.attack_by_camera[k] @ camera])
        size = np.radians(0.4)
        found["mount"].append((np.zeros(8), size * angles, size * np.eye(3)[c]))
    return found


def or_one(values: Floats) -> Floats:
    """To divide by: 1 where a cause changes nothing."""
    return np.where(values > 0.0, values, 1.0)


def test_every_component_of_every_angle_and_the_covariances() -> None:
    e = made()
    found = uncertainty(e, GIVEN)
    assert set(found.components) == set(causes(e, 0))
    for k in range(2):
        squares, covariance, common = np.zeros(9), np.zeros((3, 3)), np.zeros((3, 3))
        alpha_beta = np.zeros((2, 2))
        for name, ones in causes(e, k).items():
            of_this = np.zeros(9)
            for residual, further, turn in ones:
                camera = e.gain[k] @ residual
                attack = e.responses.attack_by_camera[k] @ camera
                vehicle = e.vehicle_by_camera[k] @ camera
                change = np.degrees(np.concatenate([camera, vehicle, attack]) + further)
                body = np.degrees(e.body_gain[k] @ residual + turn)
                of_this += change**2
                alpha_beta += np.outer(change[6:8], change[6:8])
                covariance += np.outer(body, body)
                common += np.outer(body, body) * (name in COMMON)
            assert_close(
                "seven digits",
                found.components[name][k] ** 2 / or_one(of_this),
                of_this / or_one(of_this),
            )
            squares += of_this
        assert_close("seven digits", found.total[k] ** 2 / squares, np.ones(9))
        assert_close(
            "seven digits", found.half_width_95[k] ** 2 / squares, np.full(9, 1.9599639845**2)
        )
        assert_close("seven digits", found.covariance_deg2[k] / covariance, np.ones((3, 3)))
        assert_close("seven digits", found.covariance_common_deg2[k] / common, np.ones((3, 3)))
        (ends,) = eta_interval_deg(np.array([3.0]), np.sqrt(squares[8:]), alpha_beta[None])
        assert_close("seven digits", found.eta_interval_95_deg[k] / or_one(ends), ends > 0.0)
    assert np.isinf(found.freedom).all()


QUANTILES = {  # of Student's t for 95 %, by table G.2 of the GUM (ISO, 1995)
    0.5: 12.71, 1: 12.71, 2: 4.30, 3: 3.18, 5: 2.57, 8: 2.31, 20: 2.09, np.inf: 1.96,
}  # fmt: skip


def of(freedom: float, fiducial: float) -> Uncertainty:
    scale = JobReadingSigma(0.5, freedom, "residuals", np.full(2, 0.5), 0.5)
    return uncertainty(estimate(ANGLES), Sigmas(fiducial=fiducial), scale)


@pytest.mark.parametrize("freedom", [*QUANTILES])
def test_few_degrees_of_freedom_have_the_factors_of_student_s_t(freedom: float) -> None:
    """An interval has that of 95 %; standard deviations and covariances have none."""
    plain, found = of(np.inf, 0.0), of(freedom, 0.0)
    assert list(found.components) == ["reading"]
    assert np.array_equal(found.total, plain.total)
    assert np.array_equal(found.components["reading"], plain.components["reading"])
    assert np.array_equal(found.covariance_deg2, plain.covariance_deg2)
    upper = np.full((2, 9), QUANTILES[freedom])
    assert_close("quantile of two decimals", found.half_width_95 / plain.total, upper)
    assert (found.freedom == freedom).all()
    wider = found.half_width_95[:, 8] / 1.9599639845
    covariance = np.array([
        gain @ gain.T * (0.5 * w / plain) ** 2
        for gain, w, plain in zip(
            np.degrees(estimate(ANGLES).gain[:, :2]), wider, plain.total[:, 8], strict=True
        )
    ])  # fmt: skip
    ends = eta_interval_deg(np.full(2, 3.0), wider, covariance)
    assert_close("seven digits", found.eta_interval_95_deg / or_one(ends), ends > 0.0)


def test_degrees_of_freedom_of_several_components_are_those_of_welch_and_satterthwaite() -> None:
    """What is known well adds no degree: 2 of the reading's are 2 (whole / part) ** 2."""
    plain, found = of(np.inf, 0.7), of(2, 0.7)
    part = plain.components["reading"] ** 2
    whole = part + plain.components["centre"] ** 2
    assert_close("seven digits", found.freedom / (2.0 * (whole / part) ** 2), np.ones((2, 9)))
    assert_close("ratio", found.components["centre"], plain.components["centre"])
    assert_close("seven digits", found.total**2 / whole, np.ones((2, 9)))
    upper = stats.t.ppf(0.975, 2.0 * (whole / part) ** 2)
    assert_close("seven digits", found.half_width_95 / found.total / upper, np.ones((2, 9)))


FISHER = {  # F(.95; 3, nu) of printed tables
    1: 215.7, 2: 19.16, 3: 9.277, 5: 5.409, 10: 3.708, 20: 3.098, np.inf: 2.605,
}  # fmt: skip


@pytest.mark.parametrize("freedom", [*FISHER])
def test_the_ellipsoid_of_the_readings_has_the_factor_of_fisher_s_f(freedom: float) -> None:
    found = of(freedom, 0.0).covariance_factor_95
    assert_close("ratio of four digits", found / 3.0 / FISHER[freedom], np.ones(2))


def test_the_ellipsoid_of_several_components_has_the_harmonic_mean_of_its_axes_freedom() -> None:
    """Each axis by itself has the readings' degrees times its (whole / part) squared."""
    part, whole = (of(2, fiducial).covariance_deg2 for fiducial in (0.0, 0.7))
    for k, factor in enumerate(of(2, 0.7).covariance_factor_95):
        shares = eigh(part[k], whole[k], eigvals_only=True)
        assert 0.0 < shares.min() < 0.9 * shares.max() < 1.0
        freedom = 3.0 / sum(share**2 / 2.0 for share in shares)
        assert_close("seven digits", factor / (3.0 * stats.f.ppf(0.95, 3.0, freedom)), 1.0)


def test_a_turn_that_is_not_determined_has_no_ellipsoid() -> None:
    found = uncertainty(estimate(ANGLES, gain=np.full((2, 3, 8), np.nan)), GIVEN)
    assert np.isnan(found.covariance_factor_95).all()


def test_a_position_s_error_alone_has_the_factor_of_chi_square() -> None:
    scale = JobReadingSigma(0.0, 1.0, "given", np.full(2, 0.5), 0.5)
    found = uncertainty(estimate(ANGLES), Sigmas(fiducial=0.3), scale)
    assert_close("ratio of four digits", found.covariance_factor_95 / 7.815, np.ones(2))


@pytest.mark.parametrize(("landmarks", "frames"), [(2, 3), (4, 1), (3, 2)])
def test_the_ellipsoid_holds_the_truth_in_95_of_100_jobs(landmarks: int, frames: int) -> None:
    """Jobs of few residuals, by a linear model with random partials, whose sigma is known."""
    rng = np.random.default_rng(11)
    jobs, freedom = 4000, frames * (2 * landmarks - 3)
    inside = 0
    for _ in range(jobs):
        rows = rng.normal(size=(frames, 2 * landmarks, 3))
        noise = rng.normal(size=(frames, 2 * landmarks))
        turn = np.einsum("fij,fj->fi", np.linalg.pinv(rows), noise)
        left = noise - np.einsum("fij,fj->fi", rows, turn)
        scale = (left**2).sum() / freedom
        square = np.linalg.norm(rows[0] @ turn[0]) ** 2 / scale  # t' C^-1 t of the first frame
        inside += square <= covariance_factor_95(np.array([float(freedom)]))[0]
    assert abs(inside / jobs - 0.95) < 3.29 * np.sqrt(0.95 * 0.05 / jobs)  # of 999 in 1,000


# The ends of the interval of eta against Rice's distribution, and which deviation counts where


CHANCE = 0.025
LENGTHS = (0.0, 0.3, 1.02, 2.0, 2.7, 2.73, 3.337, 5.0, 7.9, 7.99, 8.01, 8.5, 12.0, 20.0)
"""Eta in standard deviations: on and between the points of a table, and beyond it."""


def interval(eta: float, sigma: float, covariance: list[list[float]]) -> list[float]:
    (ends,) = eta_interval_deg(np.array([eta]), np.array([sigma]), np.array([covariance]))
    return [float(end) for end in ends]


@pytest.mark.parametrize("length", LENGTHS)
@pytest.mark.parametrize("s", [1.0, 0.25])
def test_the_ends_are_the_lengths_that_make_the_measured_one_unlikely(
    length: float, s: float
) -> None:
    """Of the lower end .025 are measured longer, of the upper end .025 shorter."""
    lower, upper = interval(length * s, s, [[s * s, 0.0], [0.0, s * s]])
    if upper > s:  # the least upper end is one standard deviation
        assert_close("chance of an end", rice.cdf(length, upper / s), CHANCE)
    else:
        assert upper == s and rice.cdf(length, 1.0) < CHANCE
    if length < 2.7162:
        assert lower == 0.0
    else:
        assert_close("chance of an end", rice.sf(length, lower / s), CHANCE)


NEAR, HALF = 0.0, np.sqrt(8.0 * np.log(2.0))  # where the larger one counts wholly, and half


@pytest.mark.parametrize(
    ("eta", "sigma", "covariance", "s"),
    [
        (NEAR, 1.0, [[4.0, 0.0], [0.0, 1.0]], 2.0), (NEAR, 1.0, [[1.0, 0.0], [0.0, 4.0]], 2.0),
        (NEAR, 1.0, [[2.5, 1.5], [1.5, 2.5]], 2.0), (NEAR, 1.0, [[2.5, -1.5], [-1.5, 2.5]], 2.0),
        (2.0 * HALF, 1.0, [[4.0, 0.0], [0.0, 1.0]], np.sqrt(2.5)),
        (2.0 * HALF, 3.0, [[4.0, 0.0], [0.0, 1.0]], np.sqrt(6.5)),
        (60.0, 1.0, [[4.0, 0.0], [0.0, 1.0]], 1.0), (60.0, 0.5, [[4.0, 0.0], [0.0, 9.0]], 0.5),
        (2.0, np.inf, [[4.0, 0.0], [0.0, 1.0]], 2.0), (2.0, np.nan, [[4.0, 0.0], [0.0, 1.0]], 2.0),
    ],
)  # fmt: skip
def test_near_zero_the_larger_deviation_of_alpha_and_beta_counts(
    eta: float, sigma: float, covariance: list[list[float]], s: float
) -> None:
    """Far away that of eta; between them their squares are weighted by exp(-(eta/largest)**2/8)."""
    expected = interval(eta, s, [[s * s, 0.0], [0.0, s * s]])
    assert_close("table value", interval(eta, sigma, covariance), expected)


def test_eta_is_an_angle_from_0_to_180() -> None:
    equal = [[1.0, 0.0], [0.0, 1.0]]
    assert interval(179.5, 1.0, equal)[1] == 180.0
    assert interval(177.0, 1.0, equal)[1] < 180.0
    assert interval(1.0, 400.0, [[1.6e5, 0.0], [0.0, 1.6e5]]) == [0.0, 180.0]
    for eta, sigma, of_alpha in ((np.nan, 1.0, 1.0), (3.0, np.nan, np.nan), (3.0, np.inf, np.inf)):
        found = interval(eta, sigma, [[of_alpha, 0.0], [0.0, of_alpha]])
        assert np.isnan(found).all()


# Each component of the uncertainty by itself, against thousands of draws: within ten per cent


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


# Standard deviations in force: what is given, else what the source states, each in its place


FORCE_STATED = StatedSigmas(
    (1.0, 2.0, 3.0), (4.0, 5.0, 6.0), 7.0, 8.0, (9.0, 10.0), (11.0, 12.0, 13.0)
)
NOTHING = {
    "reading": None,
    "centre": 0.0,
    "principal_point": [0.0, 0.0],
    "landmark": [0.0, 0.0, 0.0],
    "position": [0.0, 0.0, 0.0],
    "place": [0.0, 0.0, 0.0],
    "focal_length": 0.0,
    "time_s": 0.0,
    "velocity": [0.0, 0.0, 0.0],
    "wind": 0.0,
    "mount_deg": 0.0,
}
OF_STATED = NOTHING | {
    "principal_point": [9.0, 10.0],
    "landmark": [1.0, 2.0, 3.0],
    "position": [4.0, 5.0, 6.0],
    "place": [11.0, 12.0, 13.0],
    "focal_length": 7.0,
    "time_s": 8.0,
}
FORCE_GIVEN = [
    ("reading", 0.5, 0.5),
    ("landmark", 20.0, [20.0, 20.0, 20.0]),
    ("position", 20.0, [20.0, 20.0, 20.0]),
    ("focal_length", 20.0, 20.0),
    ("time_s", 20.0, 20.0),
    ("velocity", 20.0, [20.0, 20.0, 20.0]),
    ("wind", 20.0, 20.0),
    ("mount_deg", 20.0, 20.0),
]


def one(**changes: Any) -> Estimate:
    return replace(estimates.estimate(np.array([[140.0, -70.0, 60.0]])), **changes)


def values(force: SigmasInForce) -> dict[str, Any]:
    return {
        name: value.tolist() if isinstance(value, np.ndarray) else np.array(value).tolist()
        for name, value in force._asdict().items()
    }


def test_a_source_that_states_nothing_has_none() -> None:
    assert StatedSigmas() == (
        *((0.0, 0.0, 0.0),) * 2, 0.0, 0.0, (0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0
    )  # fmt: skip
    unstated = one(stated=StatedSigmas(), fiducial_sigma=np.nan)
    assert values(in_force(unstated, Sigmas())) == NOTHING


def test_what_is_stated_counts() -> None:
    stated = one(stated=FORCE_STATED, fiducial_sigma=np.nan)
    assert values(in_force(stated, Sigmas())) == OF_STATED


def test_velocities_that_are_not_known_are_a_component_of_0() -> None:
    """As of frames beyond the track, in a part of a long flight that has no others."""
    two = estimates.estimate(np.array([[140.0, -70.0, 60.0]] * 2))
    for known in (np.nan, 0.5):
        own = replace(two, velocity_sigma=np.array([[known] * 3, [np.nan] * 3]))
        expected = [np.nan_to_num([known] * 3).tolist(), [0.0] * 3]
        assert values(in_force(own, Sigmas()))["velocity"] == expected
        assert "velocity" in uncertainty(own, Sigmas()).components
        assert values(in_force(own, Sigmas(velocity=2.0)))["velocity"] == [2.0] * 3


@pytest.mark.parametrize(("name", "given", "expected"), FORCE_GIVEN)
@pytest.mark.parametrize(
    ("source", "before"), [(StatedSigmas(), NOTHING), (FORCE_STATED, OF_STATED)]
)
def test_what_is_given_counts_before_what_is_stated_and_changes_nothing_else(
    source: StatedSigmas, before: dict[str, Any], name: str, given: float, expected: object
) -> None:
    found = in_force(one(stated=source, fiducial_sigma=np.nan), Sigmas(**{name: given}))
    assert values(found) == before | {name: expected}


def test_the_centre_is_the_mean_of_four_fiducials() -> None:
    film = one(stated=StatedSigmas(), fiducial_sigma=0.06)
    assert values(in_force(film, Sigmas())) == NOTHING | {"centre": 0.03}
    assert values(in_force(film, Sigmas(fiducial=0.1))) == NOTHING | {"centre": 0.05}
    assert values(in_force(film, Sigmas(fiducial=0.0))) == NOTHING
