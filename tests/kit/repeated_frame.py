"""One frame repeated thousands of times, each time with other random errors.

The spread of the solved angles is to be compared with the predicted standard
deviations. Frames stand a second apart in tables of their own, so that every frame
can have its own position, time and landmarks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tests.kit import spherical_film
from tests.kit.coverage import Solved
from tests.kit.jobs import reread
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.uncertainty import ANGLES, uncertainty
from vopd.errata import fixes
from vopd.film import film_estimate
from vopd.job import Clock, Job, Landmarks, Readings
from vopd.pipeline import run

DRAWS = 2000  # the deviation of a deviation is 1.6 per cent
FT_PER_KM = 3280.8336
MM_PER_INCH = spherical_film.MM_PER_INCH
TRUTH = (140.0, -80.0, 60.0)
LANDMARKS = (0, 1, 2, 3, 4)


def repeated(
    truth: Sequence[float] = TRUTH,
    landmarks: Sequence[int] = LANDMARKS,
    multiplier: Sequence[float] = (1.0, 1.0, 1.0),
    draws: int = DRAWS,
) -> Job:
    """The frame so many times, without errors; the vehicle flies 500 ft/s east, 300 south."""
    one = spherical_film.job(np.array([truth]), np.array(truth), tuple(multiplier))
    chosen = list(landmarks)
    r = _without_blur(one.readings)
    t = np.arange(draws, dtype=np.float64)
    path = one.trajectory
    return replace(
        one,
        clock=Clock(np.arange(draws) + 1, t),
        trajectory=replace(
            path,
            time_s=t,
            position_ft=np.repeat(path.position_ft, draws, axis=0),
            velocity_ft_s=np.repeat([[-300.0, 500.0, 50.0]], draws, axis=0),
            altitude_ft=np.repeat(path.altitude_ft, draws),
        ),
        readings=reread(
            r,
            frame=np.arange(draws) + 1,
            fiducial_in=np.repeat(r.fiducial_in, draws, axis=0),
            landmark=np.repeat(r.landmark[:, chosen], draws, axis=0),
            present=np.ones((draws, len(chosen)), bool),
            landmark_in=np.repeat(r.landmark_in[:, chosen], draws, axis=0),
        ),
    )


def _without_blur(r: Readings) -> Readings:
    """Three times the same reading: the spread is to be that of the draws alone."""
    same = [
        np.repeat(a.mean(axis=2, keepdims=True), 3, axis=2) for a in (r.fiducial_in, r.landmark_in)
    ]
    return reread(r, fiducial_in=same[0], landmark_in=same[1])


def misread(job: Job, sigma_in: float, rng: np.random.Generator) -> Job:
    """Every single reading with an error of its own, landmarks' and fiducials'."""
    r = job.readings
    blurred = [a + rng.normal(0.0, sigma_in, a.shape) for a in (r.fiducial_in, r.landmark_in)]
    return replace(job, readings=reread(r, fiducial_in=blurred[0], landmark_in=blurred[1]))


def displaced(job: Job, sigma_ft: float, rng: np.random.Generator) -> Job:
    """The vehicle elsewhere in every frame, east, north and up."""
    path = job.trajectory
    moved = path.position_ft + rng.normal(0.0, sigma_ft, path.position_ft.shape)
    return replace(job, trajectory=replace(path, position_ft=moved))


def missurveyed(job: Job, sigma_ft: float, rng: np.random.Generator) -> Job:
    """Every landmark of every frame elsewhere: each has a number of its own."""
    frames, count = job.readings.landmark.shape
    row = {int(n): k for k, n in enumerate(job.landmarks.number)}
    old = np.array([row[int(n)] for n in job.readings.landmark.ravel()])
    marks = job.landmarks
    latitude = marks.latitude_deg[old] + marks.latitude_min[old] / 60.0
    km = rng.normal(0.0, sigma_ft, (len(old), 3)) / FT_PER_KM
    east = np.degrees(km[:, 0] / (6378.165 * np.cos(np.radians(latitude))))
    number = 100 + np.arange(len(old))
    moved = Landmarks(
        number,
        marks.longitude_deg[old],
        marks.longitude_min[old] + 60.0 * east,
        marks.latitude_deg[old],
        marks.latitude_min[old] + 60.0 * np.degrees(km[:, 1] / 6378.165),
        marks.altitude_ft[old] + km[:, 2] * FT_PER_KM,
    )
    readings = reread(job.readings, landmark=number.reshape(frames, count))
    ignored = replace(job.ignored, everywhere=np.zeros(len(number), np.int64))
    return replace(job, landmarks=moved, readings=readings, ignored=ignored)


def mistimed(job: Job, sigma_s: float, rng: np.random.Generator) -> Job:
    """Every frame at another time of a flight along a straight line, its tables two rows."""
    t = rng.normal(0.0, sigma_s, len(job.readings.frame))
    path = job.trajectory
    far = np.array([-1000.0, 1000.0])
    speed = np.array([500.0, -300.0, -50.0])
    trajectory = replace(
        path,
        time_s=far,
        position_ft=path.position_ft[0] + far[:, None] * speed,
        velocity_ft_s=np.array([-300.0, 500.0, 50.0]) + far[:, None] * [4.0, 3.0, -5.0],
        altitude_ft=np.full(2, path.altitude_ft[0]),
    )
    return replace(job, trajectory=trajectory, clock=replace(job.clock, time_s=t))


def solved(job: Job, names: Sequence[str], sigmas: Sigmas) -> Solved:
    """The estimate of the job and its uncertainty."""
    estimate = film_estimate(run(job, fixes(*names))[0])
    return Solved(estimate, uncertainty(estimate, sigmas))


def angles_deg(one: Solved) -> np.ndarray:
    """The nine angles of every frame."""
    e = one.estimate
    angles = np.concatenate([e.camera_deg, e.vehicle_deg, e.attack_deg], axis=1)
    assert angles.shape[1] == len(ANGLES) and np.isfinite(angles).all()
    return angles


def found_deg(one: Solved) -> np.ndarray:
    """The deviations of the nine angles as they came out."""
    angles = angles_deg(one)
    away = (angles - angles[0] + 180.0) % 360.0 - 180.0
    return np.asarray(away.std(axis=0))


def predicted_deg(sigma: np.ndarray) -> np.ndarray:
    """What is said of all frames together: roots of mean variances."""
    return np.asarray(np.sqrt((sigma**2).mean(axis=0)))
