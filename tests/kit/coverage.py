"""How often the truth lies in the stated intervals, and the rows of films of decks.

The configurations are the rows of the tables of docs/coverage.md. A row of films is counted with 2,
3, 4, 6 and 12 landmarks in a frame; the noise of the readings is .012 in, .005 mm on the film for
the mean of three, unless a row says otherwise.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import stdtr
from scipy.stats import norm

from tests.kit.simulated_films import (
    SPHERE_1974,
    WGS84,
    WGS84_CENTRAL,
    Errors,
    Plan,
    SimulatedFilms,
    body_to_ned,
    deck_of,
    jobs_of,
    simulate,
)
from tests.kit.wgs84_film import MM_PER_INCH
from vopd.attitude.history import History
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.uncertainty import Uncertainty, uncertainty
from vopd.errata import fixes
from vopd.estimate import Estimate
from vopd.film import film_estimate
from vopd.job import Job
from vopd.pipeline import read_deck, run
from vopd.solved import Run

Array = np.ndarray
CAMERA, VEHICLE, ATTACK, ETA = slice(0, 3), slice(3, 6), slice(6, 8), slice(8, 9)
NORMAL_95 = 1.959964


class Share(NamedTuple):
    """The share of frames inside, with limits, and how many independent frames would have them."""

    share: float
    low: float
    high: float
    effective: float


class Solved(NamedTuple):
    """The estimate of a job and its uncertainty."""

    estimate: Estimate
    uncertainty: Uncertainty


class Count(NamedTuple):
    """What of J jobs of F frames lies inside, 1 or 0; NaN where it does not count."""

    inside_68: Array  # (J, F, 9) the nine angles inside one standard deviation
    chance_68: Array  # (J, F, 9) the probability of that by Student's t: 50 to 68 in 100
    inside_95: Array  # (J, F, 9) and inside the 95 % interval
    attitude_95: Array  # (J, F, 1) vehicle attitudes inside the ellipsoid of the covariance
    mean_95: Array  # (J, 1, 1) means over the frames of a job, by the covariance's two parts
    lost: int  # frames without angles or without standard deviations
    place_95: Array = np.full((1, 1, 1), np.nan)  # (J, F, 3) places inside, of flights

    def share_68(self, angles: slice, confidence: float = 0.95) -> Share:
        """The share inside one standard deviation."""
        return share(self.inside_68[..., angles], confidence)

    def beyond_68(self, angles: slice, confidence: float = 0.95) -> Share:
        """That share minus the one that Student's t has for the degrees of freedom."""
        expected = np.nanmean(self.chance_68[..., angles])
        found = self.share_68(angles, confidence)
        return found._replace(
            **{name: getattr(found, name) - expected for name in ("share", "low", "high")}
        )

    def share_95(self, angles: slice, confidence: float = 0.95) -> Share:
        """The share inside the 95 % interval."""
        return share(self.inside_95[..., angles], confidence)


def share(inside: Array, confidence: float = 0.95) -> Share:
    """The share of true ones with Wilson's limits for clusters: frames of a job hang together.

    The variance of the share is that of the means of jobs, as far as it exceeds that of
    independent frames; frames of the effective number have it.

    Args:
        inside: (J, F, angles), 1 or 0, NaN for what does not count
        confidence: of the limits
    """
    kept = inside.reshape(len(inside), -1)
    size, hits = np.isfinite(kept).sum(axis=1), np.nansum(kept, axis=1)
    total = size.sum()
    if total == 0:
        return Share(np.nan, 0.0, 1.0, 0.0)
    p = hits.sum() / total
    jobs = len(kept)
    frames = np.isfinite(inside).any(axis=-1).sum()
    of_jobs = ((hits - p * size) ** 2).sum() / total**2 * jobs / max(jobs - 1, 1)
    middle = (hits.sum() + 2.0) / (total + 4.0)  # where all are inside, still some doubt
    variance = max(of_jobs, middle * (1.0 - middle) / frames)
    effective = middle * (1.0 - middle) / variance
    z = float(norm.ppf(0.5 + confidence / 2.0))
    centre = (p + z**2 / (2 * effective)) / (1 + z**2 / effective)
    half = z / (1 + z**2 / effective) * np.sqrt(p * (1 - p) / effective + z**2 / (4 * effective**2))
    return Share(float(p), float(centre - half), float(centre + half), float(effective))


def sigmas_of(errors: Errors, reading: bool) -> Sigmas:
    """What a user who knows the errors states; the readings' only if asked, else estimated.

    The sigma of the readings is that of the mean of three, with what is common to them, and
    with the rounding to thousandths of an inch.
    """
    single = np.hypot(errors.reading_in, 0.001 / np.sqrt(12.0)) * MM_PER_INCH
    given: dict[str, float] = {}
    if reading:
        noise = np.hypot(errors.reading_in * errors.fiducial_factor, 0.001 / np.sqrt(12.0))
        given["reading"] = float(np.hypot(single / np.sqrt(3.0), errors.identification_mm))
        given["fiducial"] = float(noise * MM_PER_INCH / np.sqrt(3.0))
    return Sigmas(
        landmark=errors.landmark_ft,
        position=errors.position_ft,
        focal_length=errors.focal_mm,
        time_s=errors.time_s,
        velocity=errors.velocity_ft_s,
        wind=errors.wind_ft_s,
        mount_deg=errors.mount_deg,
        **given,
    )


def _run(
    films: SimulatedFilms,
    names: tuple[str, ...],
    cards: bool = False,
    start_deg: Array | None = None,
) -> Run:
    jobs: list[Job] | Any = jobs_of(films)
    if cards:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "films.dat"
            path.write_text(deck_of(films), encoding="ascii")
            jobs = read_deck(path)
    start = films.truth_deg[..., CAMERA] if start_deg is None else start_deg
    return run(jobs, fixes(*names), start_deg=start.reshape(-1, 3))


def histories_of(
    films: SimulatedFilms,
    names: tuple[str, ...] = ("all",),
    reading: bool = False,
    max_rate_deg_s: float | None = None,
    start_deg: Array | None = None,
) -> list[History]:
    """The histories of all jobs, with flags.

    Args:
        films: the jobs
        names: of the fixes
        reading: whether the sigma of the readings is stated
        max_rate_deg_s: as `Run.histories` takes it
        start_deg: camera angles to start each frame from, (J, F, 3); None: the true ones
    """
    given = sigmas_of(films.plan.errors, reading)
    return _run(films, names, start_deg=start_deg).histories(given, max_rate_deg_s)


def solved(
    films: SimulatedFilms,
    names: tuple[str, ...] = ("all",),
    reading: bool = False,
    cards: bool = False,
) -> list[Solved]:
    """The estimates and uncertainties of all jobs.

    Args:
        films: the jobs
        names: of the fixes
        reading: whether the sigma of the readings is stated
        cards: whether the jobs go through cards
    """
    given = sigmas_of(films.plan.errors, reading)
    estimates = [film_estimate(job.results) for job in _run(films, names, cards).jobs]
    return [Solved(one, uncertainty(one, given)) for one in estimates]


def count(jobs: list[Solved], truth_deg: Array) -> Count:
    """Compare the stated uncertainty with the truth.

    Args:
        jobs: J jobs of F frames
        truth_deg: (J, F, 9), NaN where it is not known
    """
    found, half, sigma, eta, freedom = (
        np.stack(part) for part in zip(*map(_stated, jobs), strict=True)
    )
    error = np.abs((found - truth_deg + 180.0) % 360.0 - 180.0)
    inside = [np.where(np.isnan(limit + error), np.nan, error <= limit) for limit in (sigma, half)]
    true_eta = truth_deg[..., 8]
    within = (eta[..., 0] <= true_eta) & (true_eta <= eta[..., 1])
    inside[1][..., 8] = np.where(np.isnan(eta.sum(axis=-1) + true_eta), np.nan, within)
    lost = int(np.isnan(sigma[..., VEHICLE]).any(axis=-1).sum())
    turns = [
        _turns_inside(one, true[:, VEHICLE]) for one, true in zip(jobs, truth_deg, strict=True)
    ]
    frames, means = (np.stack(part)[..., None] for part in zip(*turns, strict=True))
    chance = np.where(np.isnan(inside[0]), np.nan, 2.0 * stdtr(np.minimum(freedom, 1e9), 1.0) - 1.0)
    return Count(inside[0], chance, inside[1], frames, means, lost)


def _turns_inside(solved: Solved, truth_deg: Array) -> tuple[Array, Array]:
    """Whether the small turns to the truth lie inside their ellipsoids: (F,), and their mean (1,).

    The errors that are the same in all frames turn each body by another vector where
    the attitudes differ; their covariance in the mean is that of a frame only if they do not.
    """
    e, u = solved
    turn = body_to_ned(e.vehicle_deg).swapaxes(-1, -2) @ body_to_ned(truth_deg)
    error = Rotation.from_matrix(turn).as_rotvec(degrees=True)
    limit = u.covariance_factor_95
    own, common = u.covariance_independent_deg2, u.covariance_common_deg2
    of_mean = common.mean(axis=0) + own.mean(axis=0) / len(own)
    squares = (error * np.linalg.solve(u.covariance_deg2, error[..., None])[..., 0]).sum(axis=1)
    mean = error.mean(axis=0)
    square = mean @ np.linalg.solve(of_mean, mean)
    return (squares <= limit).astype(float), np.array([square <= limit.mean()], float)


def _stated(solved: Solved) -> tuple[Array, Array, Array, Array, Array]:
    """Angles (F, 9), half-widths of 95 %, sigmas, the interval of eta (F, 2), and the freedom."""
    e, u = solved
    found = np.concatenate([e.camera_deg, e.vehicle_deg, e.attack_deg], axis=1)
    return found, u.half_width_95, u.total, u.eta_interval_95_deg, u.freedom


# Films of decks


LANDMARKS = (2, 3, 4, 6, 12)
READINGS = Errors(reading_in=0.012)
ALL = Errors(0.012, 0.02, 3.0, 60.0, 60.0, 0.02, 0.1, 5.0, 5.0)


class Row(NamedTuple):
    """A configuration: the films, and how they are solved."""

    name: str
    plan: Plan
    fixes: tuple[str, ...] = ("all",)
    reading: bool = False  # whether the sigma of the readings is stated, or estimated
    cards: bool = False  # whether the jobs go through cards


def _plan(errors: Errors, **changes: object) -> Plan:
    """Few jobs of many frames, or many of few where an error is common to a job."""
    e = errors
    common = any((e.landmark_ft, e.focal_mm, e.time_s, e.wind_ft_s, e.mount_deg))
    size = {"jobs": 150, "frames": 12} if common else {"jobs": 40, "frames": 50}
    return Plan(errors)._replace(**(size | changes))


POLE = {"pitch_deg": (-92.0, -88.0)}
WRAPS = {"yaw_deg": (-0.05, 0.05), "roll_deg": (-0.05, 0.05), "jitter_deg": (0.01, 2.0, 0.01)}
REST = {"jitter_deg": (0.1, 0.1, 0.1)}
ONE_FRAME = {"jobs": 500, "frames": 1}
IDENTIFIED = READINGS._replace(identification_mm=0.05)

ROWS = (
    Row("readings", _plan(READINGS)),
    Row("readings, sigma given", _plan(READINGS), reading=True),
    Row("readings, poor geometry", _plan(READINGS, poor=True)),
    Row("readings, poor geometry, sigma given", _plan(READINGS, poor=True), reading=True),
    Row("readings, through cards", _plan(READINGS), cards=True),
    Row("readings of .001 in, not rounded", _plan(Errors(reading_in=0.001), decimals=None)),
    Row("readings, one frame a job", _plan(READINGS, **ONE_FRAME)),
    Row("readings, camera pitch within 2 degrees of -90", _plan(READINGS, **POLE)),
    Row("readings, yaw and roll across 0", _plan(READINGS, **WRAPS)),
    Row("readings, faithful run, truth on the sphere of 1974",
        _plan(READINGS, earth=SPHERE_1974), ()),
    Row("identification .05 mm", _plan(IDENTIFIED)),
    Row("identification .05 mm, sigma given", _plan(IDENTIFIED), reading=True),
    Row("identification .05 mm, poor geometry", _plan(IDENTIFIED, poor=True)),
    Row("identification .05 mm, readings of .003 in",
        _plan(IDENTIFIED._replace(reading_in=0.003))),
    Row("identification .05 mm, one frame a job", _plan(IDENTIFIED, **ONE_FRAME)),
    Row("fiducials three times noisier", _plan(READINGS._replace(fiducial_factor=3.0))),
    Row("fiducials three times noisier, sigmas given",
        _plan(READINGS._replace(fiducial_factor=3.0)), reading=True),
    Row("landmarks 100 ft", _plan(READINGS._replace(landmark_ft=100.0))),
    Row("landmarks 100 ft, reading sigma given",
        _plan(READINGS._replace(landmark_ft=100.0)), reading=True),
    Row("landmarks 100 ft, camera at rest",
        _plan(READINGS._replace(landmark_ft=100.0), **REST)),
    Row("positions 100 ft", _plan(READINGS._replace(position_ft=100.0))),
    Row("focal length .05 mm", _plan(READINGS._replace(focal_mm=0.05))),
    Row("time .2 s", _plan(READINGS._replace(time_s=0.2))),
    Row("velocity 10 ft/s", _plan(READINGS._replace(velocity_ft_s=10.0))),
    Row("wind 10 ft/s", _plan(READINGS._replace(wind_ft_s=10.0))),
    Row("velocity 10 ft/s, eta below .2 degree",
        _plan(READINGS._replace(velocity_ft_s=10.0), eta_deg=(0.0, 0.1),
              jitter_deg=(0.05, 0.05, 0.05), acceleration_ft_s2=0.0)),
    Row("mounting .1 degree", _plan(READINGS._replace(mount_deg=0.1))),
    Row("all together", _plan(ALL)),
    Row("all together, camera at rest", _plan(ALL, **REST)),
    Row("all together, reading sigma given", _plan(ALL), reading=True),
    Row("all together, poor geometry", _plan(ALL, poor=True)),
    Row("all together, through cards", _plan(ALL), cards=True),
    Row("all together, camera pitch within 2 degrees of -90", _plan(ALL, **POLE)),
    Row("all together, yaw and roll across 0", _plan(ALL, **WRAPS)),
    Row("all together, faithful run, truth on the sphere of 1974",
        _plan(ALL, earth=SPHERE_1974), ()),
    Row("faithful run, truth on WGS 84", _plan(READINGS, earth=WGS84), ()),
    Row("faithful run, truth on WGS 84, geocentric vertical",
        _plan(READINGS, earth=WGS84_CENTRAL), ()),
)  # fmt: skip


def counted(row: Row, landmarks: int, seed: int, jobs: int | None = None) -> Count:
    """Count a cell of the table.

    Args:
        row: the configuration
        landmarks: in a frame
        seed: of the random numbers
        jobs: how many, in the place of the row's
    """
    plan = row.plan._replace(landmarks=landmarks, jobs=jobs or row.plan.jobs)
    films = simulate(plan, seed)
    return count(solved(films, row.fixes, row.reading, row.cards), films.truth_deg)
