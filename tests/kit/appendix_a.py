"""Appendix A's camera, written from the report; derivatives by a complex step, not by formulas.

Cosines (L, 3) are east, north, up; film coordinates (L, 2) mm; angles (3,) yaw,
pitch, roll in radians unless a name says degrees.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vopd.arrays import Floats
from vopd.errata import NO_FIXES, Fixes
from vopd.job import Job
from vopd.program.orient import FilmSight, Sight
from vopd.program.vopd import run_jobs

Array = np.ndarray
RAD = 57.29577951  # the program's degrees in a radian
TWO_PI = 6.2831853  # and its full circle
STEP = 1e-200  # a complex step has no difference to lose digits in


def matrix(angles: Array) -> Array:
    """The rows lambda, mu, nu of the image axes 1, 2, 3 (transformation before equation A5)."""
    (s1, s2, s3), (c1, c2, c3) = np.sin(angles), np.cos(angles)
    return np.array(
        [
            [-c1 * c3 - s1 * s2 * s3, s1 * c3 - c1 * s2 * s3, c2 * s3],
            [c1 * s3 - s1 * s2 * c3, -s1 * s3 - c1 * s2 * c3, c2 * c3],
            [s1 * c2, c1 * c2, s2],
        ]
    )


def project(angles: Array, cosines: Array, focal_mm: float) -> Array:
    """Equations A4."""
    p, q, r = matrix(angles) @ cosines.T
    return focal_mm * np.stack([p / r, q / r], axis=1)


def partials(angles: Array, cosines: Array, focal_mm: float, erratum: bool) -> Array:
    """Derivatives (L, 2, 3) of the residuals, measured less computed: those of A5 with a minus.

    The `erratum` is the listing's: in the derivative of the matrix by sigma 2, Y is
    the first landmark's for all (A 394).
    """
    found = np.empty((len(cosines), 2, 3))
    p, q, r = matrix(angles) @ cosines.T
    for k in range(3):
        turned = matrix(angles + np.where(np.arange(3) == k, STEP * 1j, 0.0))
        moving = cosines.copy()
        if erratum and k == 1:
            moving[:, 1] = cosines[0, 1]
        dp, dq, dr = (turned.imag / STEP) @ moving.T
        found[:, 0, k] = -focal_mm * (dp * r - dr * p) / r**2
        found[:, 1, k] = -focal_mm * (dq * r - dr * q) / r**2
    return found


def correction(
    angles: Array, cosines: Array, film: Array, focal_mm: float, erratum: bool = True
) -> Array:
    """Least squares (A13), by QR and not by normal equations."""
    b = partials(angles, cosines, focal_mm, erratum).reshape(-1, 3)
    residual = (film - project(angles, cosines, focal_mm)).ravel()
    return np.linalg.lstsq(b, -residual, rcond=None)[0]


def wrapped(angles: Array) -> Array:
    """A 432 to A 437, one angle at a time."""
    yaw, pitch, roll = angles
    if roll < 0:
        roll += TWO_PI
    if yaw < 0:
        yaw += TWO_PI
    if pitch < -TWO_PI / 2:
        pitch += TWO_PI
    if roll > TWO_PI:
        roll -= TWO_PI
    if yaw > TWO_PI:
        yaw -= TWO_PI
    if pitch > TWO_PI / 2:
        pitch -= TWO_PI
    return np.array([yaw, pitch, roll])


def solve(start_deg: Array, cosines: Array, film: Array, focal_mm: float) -> Array:
    """Degrees in pass 22, after 21 corrections."""
    angles = np.asarray(start_deg) / RAD
    for _ in range(21):
        angles = wrapped(angles + correction(angles, cosines, film, focal_mm))
    return angles * RAD


def ahead(angles: Array, film: Array, focal_mm: float) -> Array:
    """The cosines of what a camera sees at these places of the film."""
    rays = np.column_stack([film, np.full(len(film), focal_mm)]) @ matrix(angles)
    return rays / np.linalg.norm(rays, axis=1, keepdims=True)


def sight(cosines: Array, film: Array, focal_mm: float, used: Array | None = None) -> Sight:
    """What `orient` is given, for cosines (F, L, 3), film (F, L, 2) and which are used (F, L)."""
    cosines, film = np.asarray(cosines, float), np.asarray(film, float)
    used = np.ones(cosines.shape[:2], bool) if used is None else used
    first = used.argmax(axis=1)
    mu1 = cosines[np.arange(len(first)), first, 1]
    xlam, xmu, xnu = (np.ascontiguousarray(cosines[..., k].T) for k in range(3))
    return Sight(
        dircos=(xlam, xmu, xnu),
        x=np.ascontiguousarray(film[..., 0].T),
        y=np.ascontiguousarray(film[..., 1].T),
        xmu1=np.tile(mu1, (cosines.shape[1], 1)),
        used=np.ascontiguousarray(used.T),
        cc=np.full(len(cosines), float(focal_mm)),
    )


def film_sight(seen: Sight) -> FilmSight:
    """The same for all frames of a film, as `orient_frames` is given it."""
    used = seen.used.T
    return FilmSight(
        nj=used.sum(axis=1),
        direction=np.stack([part.T[used] for part in seen.dircos], axis=1),
        point=np.stack([seen.x.T[used], seen.y.T[used]], axis=1),
        xmu1=seen.xmu1.T[used],
        cc=seen.cc,
    )


def random_film(
    rng: np.random.Generator, truth_deg: Array, marks: int, noise_mm: float
) -> tuple[Array, Array]:
    """Cosines (F, L, 3) and film (F, L, 2) of frames at these angles (F, 3), focal length 10.4."""
    film = rng.uniform(-5.0, 5.0, (len(truth_deg), marks, 2))
    pairs = zip(truth_deg, film, strict=True)
    cosines = np.array([ahead(np.asarray(angles) / RAD, seen, 10.4) for angles, seen in pairs])
    return cosines, film + rng.normal(0.0, noise_mm, film.shape) if noise_mm else film


# The input of the program's solve


def solve_input(jobs: Sequence[Job], fixes: Fixes = NO_FIXES) -> FilmSight:
    """The input of the solve of jobs that are solved together."""
    found: list[FilmSight] = []

    def no_estimate(seen: FilmSight) -> Floats:
        found.append(seen)
        return np.full((len(seen.nj), 3), np.nan)

    run_jobs(jobs, fixes, None, no_estimate)
    (seen,) = found
    return seen
