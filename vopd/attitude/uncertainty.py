"""Standard deviations and 95 % intervals of the angles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy.special import chndtrinc, ndtri, stdtrit

from vopd.arrays import Floats
from vopd.attitude.reading_sigma import (
    JobReadingSigma,
    reading_sigmas,
    reading_sigmas_of_jobs,
)
from vopd.attitude.residuals import Pool, chance_of, equations_of, testable
from vopd.attitude.sigmas import (
    AngleGains,
    Effect,
    ErrorComponent,
    Sigmas,
    SigmasInForce,
    angle_gains,
    given_components,
    in_force,
    input_effect,
)
from vopd.estimate import COMMON_PART, Estimate
from vopd.geometry.linear import covariance_factor_95, inverse
from vopd.records import Rows

# 95 % interval of eta, which cannot be below zero.

HALF_WIDTH = 1.959963984540054  # of a 95 % interval, standard deviations
FAR = 8.0  # standard deviations from zero beyond which a formula serves
ONE_SIDED = 2.7162  # standard deviations: below, no length is too small for the measured one
STEP = 0.05  # of the table up to there; interpolated, its error is below 1e-3


@np.errstate(all="ignore")
def eta_interval_deg(eta_deg: Floats, sigma_deg: Floats, alpha_beta_deg2: Floats) -> Floats:
    """Estimate the 95 % interval of eta: lower and upper end, (F, 2) degrees.

    Near zero eta is the length of a vector of two components, alpha and beta. If both have
    the standard deviation s, the square of a measured length over s squared has the
    noncentral chi-square distribution with two degrees of freedom. The ends are the lengths
    for which a measured one this large, or this small, has the probability .025. The
    lower end is 0 where eta is within 2.7 s of zero. Where the standard
    deviations of alpha and beta differ the larger one is taken near zero, which makes the interval
    too wide rather than too narrow.

    Args:
        eta_deg: eta, 0 to 180, (F,)
        sigma_deg: standard deviation of eta away from zero, (F,)
        alpha_beta_deg2: covariance of alpha and beta, (F, 2, 2)
    """
    half_trace = np.trace(alpha_beta_deg2, axis1=1, axis2=2) / 2.0
    xx, xy = alpha_beta_deg2[:, 0, 0], alpha_beta_deg2[:, 0, 1]
    largest = np.sqrt(half_trace + np.hypot(xx - half_trace, xy))
    near = np.exp(-((eta_deg / largest) ** 2) / 8.0)
    along = np.where(np.isfinite(sigma_deg), sigma_deg, largest)
    s = np.sqrt(along**2 + near * (largest**2 - along**2))
    length = eta_deg / s
    lower, upper = (
        np.where(
            length < FAR,
            np.interp(length, *_ends(chance)),
            length - 0.5 / length + side * HALF_WIDTH,
        )
        for chance, side in ((0.975, -1.0), (0.025, 1.0))
    )
    lower, upper = s * np.where(length < ONE_SIDED, 0.0, lower), s * np.maximum(upper, 1.0)
    ends = np.stack([lower, np.minimum(upper, 180.0)], axis=1)
    return np.where(np.isfinite(s)[:, None], ends, np.nan)


@cache
def _ends(chance: float) -> tuple[Floats, Floats]:
    """Tabulate measured lengths, and the true ones that exceed them with this probability."""
    length = np.arange(0.0, FAR + STEP, STEP)
    return length, np.nan_to_num(np.sqrt(chndtrinc(length**2, 2.0, chance)))


# Uncertainty of the nine angles, by component.

ANGLES = (
    "camera_yaw", "camera_pitch", "camera_roll",
    "vehicle_yaw", "vehicle_pitch", "vehicle_roll",
    "alpha", "beta", "eta",
)  # fmt: skip
"""The nine angles of a frame in the order of every array here."""

UPPER = 0.975  # the probability below the upper end of a 95 % interval


@dataclass(frozen=True, eq=False, repr=False)
class Uncertainty(Rows):
    """Standard deviations of the nine `ANGLES`, degrees; the frame axis comes first.

    `total` is the root of the sum of squares of the `components`, which are those of
    `COMPONENTS` that are not left out. `half_width_95` are half-widths of 95 %
    intervals: `total` times the factor of Student's t for `freedom` degrees of freedom.
    Covariances are those of small turns about the vehicle's forward, right and down
    axes, from all components and from those whose errors are the same in all frames;
    `covariance_factor_95` times `covariance_deg2` is the ellipsoid that contains the
    true attitude with 95 %. Standard deviations and covariances have no factor of
    Student's t. Angles that the landmarks do not determine have the standard deviation infinity.
    """

    total: Floats  # (F, 9)
    half_width_95: Floats  # (F, 9)
    freedom: Floats  # (F, 9) infinite where no sigma was estimated
    eta_interval_95_deg: Floats  # (F, 2) lower and upper end
    components: dict[str, Floats]  # (F, 9) each
    covariance_deg2: Floats  # (F, 3, 3)
    covariance_common_deg2: Floats  # (F, 3, 3)
    covariance_factor_95: Floats  # (F,) NaN where the covariance is not finite
    free_turn: Floats  # (F, 3) axis along forward, right, down that nothing determines; 0: none
    reading: JobReadingSigma
    sigmas: SigmasInForce  # from which all this is
    common: tuple[str, ...] = ()  # components whose errors, or part of them, all frames have alike

    @property
    def covariance_independent_deg2(self) -> Floats:
        """The part of the covariance whose errors differ from frame to frame, (F, 3, 3)."""
        infinite = np.isinf(self.covariance_deg2)
        common = np.where(infinite, 0.0, self.covariance_common_deg2)
        return np.asarray(self.covariance_deg2 - common)


def uncertainty(
    estimate: Estimate, sigmas: Sigmas, scale: JobReadingSigma | None = None
) -> Uncertainty:
    """Estimate standard deviations, intervals and covariances of a job's angles.

    A standard deviation that `sigmas` does not give is the one that the source itself
    states, if it states one; that of the readings is estimated from the residuals.

    Args:
        estimate: the job
        sigmas: standard deviations of the inputs
        scale: the reading sigma, where the estimate is a block of a job
    """
    return uncertainties([estimate], estimate, sigmas, scale)[1][0]


def uncertainties(
    jobs: Sequence[Estimate],
    together: Estimate,
    sigmas: Sigmas,
    scale: JobReadingSigma | None = None,
) -> tuple[Uncertainty, list[Uncertainty]]:
    """Estimate the uncertainties of several jobs together.

    Args:
        jobs: the jobs
        together: the frames of all jobs, one job after the other
        sigmas: standard deviations of the inputs
        scale: the reading sigma, where there is one job, which is a block of another

    Returns:
        The uncertainty of the frames of all jobs, with the sigmas of the first, and of each job.
    """
    counts = [len(one.frame) for one in jobs]
    forces = [in_force(one, sigmas) for one in jobs]
    centre = np.repeat([one.centre for one in forces], counts)
    given = given_components(together, forces[0], centre)
    scales = [scale] if scale is not None else _reading_sigmas(jobs, together, forces, given)
    found = _uncertainty(
        together,
        given,
        np.repeat([one.sigma for one in scales], counts),
        np.repeat([one.freedom for one in scales], counts),
        JobReadingSigma.concat(scales),
        forces[0],
    )
    ends = np.cumsum(counts).tolist()
    return found, [
        replace(found.take(slice(end - count, end)), reading=own, sigmas=force)
        for count, end, own, force in zip(counts, ends, scales, forces, strict=True)
    ]


def _reading_sigmas(
    jobs: Sequence[Estimate],
    together: Estimate,
    forces: list[SigmasInForce],
    given: list[ErrorComponent],
) -> list[JobReadingSigma]:
    """Estimate the reading sigma of each job; with common errors, of each job by itself."""
    if any(one.common for one in given):
        return [
            reading_sigmas([one], [given_components(one, force)], force.reading)[0]
            for one, force in zip(jobs, forces, strict=True)
        ]
    return reading_sigmas_of_jobs(together, given, forces[0].reading, jobs)


@np.errstate(all="ignore")
def _uncertainty(
    estimate: Estimate,
    given: list[ErrorComponent],
    reading_sigma: Floats,
    reading_freedom: Floats,
    reading: JobReadingSigma,
    force: SigmasInForce,
) -> Uncertainty:
    """Propagate the errors of all components, with the reading sigma of each frame (F,)."""
    gains = angle_gains(estimate)
    effects = _effects(estimate, gains, given, reading_sigma)
    of_component: dict[str, Floats] = {}
    for part, one in effects.items():
        name = part.removesuffix(COMMON_PART)
        of_component[name] = of_component.get(name, 0.0) + (one.angles_deg**2).sum(axis=2)
    components = {name: np.sqrt(one) for name, one in of_component.items()}
    squares = np.asarray(sum(of_component.values()))
    of_readings = of_component["reading"]
    freedom = total_freedom(reading_freedom[:, None], squares, of_readings)
    student = student_factor(freedom)
    total, half_width = (
        np.where(gains.free, np.inf, np.sqrt(squares) * one) for one in (1.0, student)
    )
    wider = student[:, 8] / float(ndtri(UPPER))
    alpha_beta = [one.angles_deg[:, 6:8] * wider[:, None, None] for one in effects.values()]
    covariance = gains.covariance_deg2(effects.values())
    return Uncertainty(
        total=total,
        half_width_95=half_width,
        freedom=freedom,
        eta_interval_95_deg=eta_interval_deg(
            estimate.attack_deg[:, 2],
            half_width[:, 8] / float(ndtri(UPPER)),
            np.asarray(sum(one @ one.swapaxes(1, 2) for one in alpha_beta)),
        ),
        components={n: np.where(gains.free, np.nan, one) for n, one in components.items()},
        covariance_deg2=covariance,
        covariance_common_deg2=gains.covariance_deg2(
            one for part, one in effects.items() if part.endswith(COMMON_PART)
        ),
        covariance_factor_95=_region_factor(
            covariance,
            gains.covariance_deg2(
                one for part, one in effects.items() if part.removesuffix(COMMON_PART) == "reading"
            ),
            reading_freedom,
        ),
        free_turn=gains.free_turn,
        reading=reading,
        sigmas=force,
        common=tuple(
            part.removesuffix(COMMON_PART) for part in effects if part.endswith(COMMON_PART)
        ),
    )


def _effects(
    estimate: Estimate, gains: AngleGains, given: list[ErrorComponent], reading_sigma: Floats
) -> dict[str, Effect]:
    """Propagate the errors of all components: by each frame's gains, or as the solve found it."""
    found = {}
    if estimate.errors is None:
        sigma = np.tile(estimate.relative_sigma, 2) * reading_sigma[:, None]
        found["reading"] = gains.readings(sigma)
    else:
        found |= {name: input_effect(estimate, one) for name, one in estimate.errors.items()}
    known = {name.removesuffix(COMMON_PART) for name in found}
    for one in given:
        if one.name not in known:
            found[one.name + COMMON_PART * one.common] = gains.effect(one)
    return found


def total_freedom(reading_freedom: Floats | float, squares: Floats, of_readings: Floats) -> Floats:
    """Count the degrees of freedom of variances whose part by readings is estimated.

    By Welch and Satterthwaite; infinite where readings have no part.

    Args:
        reading_freedom: of the reading sigma, broadcast against (...)
        squares: the whole variances, (...)
        of_readings: their parts by readings, (...)
    """
    with np.errstate(all="ignore"):
        freedom = reading_freedom * (squares / of_readings) ** 2
    return np.where(of_readings > 0.0, freedom, np.inf)


def student_factor(freedom: Floats) -> Floats:
    """Evaluate Student's factors of 95 % intervals; the normal one for infinite degrees.

    Args:
        freedom: degrees of freedom, (...)
    """
    # with one component all frames have the same number
    different, which = np.unique(np.clip(freedom, 1.0, 1e9), return_inverse=True)
    quantile = stdtrit(different, UPPER)[which].reshape(np.shape(freedom))
    return np.asarray(np.where(np.isinf(freedom), ndtri(UPPER), quantile))


def _region_factor(covariance: Floats, of_readings: Floats, freedom: Floats) -> Floats:
    """Calculate the factors of covariances (F, 3, 3) for 95 % ellipsoids, (F,).

    Along three axes of the turn, its errors by the readings and by all else are uncorrelated. Let m
    be the readings' shares of the variance along them, the eigenvalues of R C^-1. By Welch and
    Satterthwaite the axes have freedom / m^2 degrees of freedom; their harmonic mean,
    3 freedom / trace((R C^-1)^2), gives the squared distance e' C^-1 e its mean, 3 + 6 / nu,
    to first order.

    Args:
        covariance: C, of turns by all components
        of_readings: R, its part by the readings
        freedom: of the reading sigma, (F,)

    Source: F. E. Satterthwaite, Biometrics Bulletin 2 (1946), 110-114.
    """
    share = of_readings @ inverse(covariance)
    own = 3.0 * freedom / (share @ share).trace(axis1=1, axis2=2)
    determined = np.isfinite(covariance).all(axis=(1, 2))
    known = np.isinf(freedom) | ~of_readings.any(axis=(1, 2))
    return np.where(determined, covariance_factor_95(np.where(known, np.inf, own)), np.nan)


def job_reading_sigmas(estimates: Sequence[Estimate], sigmas: Sigmas) -> list[JobReadingSigma]:
    """Estimate the reading sigma of a job whose frames are in several blocks."""
    forces = [in_force(estimate, sigmas) for estimate in estimates]
    given = [given_components(e, force) for e, force in zip(estimates, forces, strict=True)]
    return reading_sigmas(estimates, given, sigmas.reading)


@np.errstate(all="ignore")
def block_reading_sigma(
    estimate: Estimate, sigmas: Sigmas, job: JobReadingSigma
) -> JobReadingSigma:
    """Test frames of a job against the reading sigma estimated from other frames.

    Args:
        estimate: some frames of the job
        sigmas: standard deviations of the inputs
        job: the reading sigma
    """
    frames = np.flatnonzero(testable(estimate))
    given = given_components(estimate, in_force(estimate, sigmas))
    chance = np.full(len(estimate.frame), np.nan)
    pool = Pool(job.test_sigma, job.freedom, None)
    chance[frames] = chance_of(equations_of(estimate, given, frames), pool)
    return replace(job, chance=chance)
