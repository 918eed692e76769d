"""The lens correction: look up the distortion of each landmark and remove it (A 343 to A 348)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.geometry.lens import radial_factor
from vopd.landmark_layout import LandmarkLayout
from vopd.program.average import FilmCoordinates
from vopd.program.film_jobs import FilmJobs
from vopd.program.ftlup import TableName, ftlup_each

LENS_RADII = TableName(1, "radial distances")


class LensCorrection(NamedTuple):
    """Each landmark's distance from the frame's centre and its distortion, (N,)."""

    radius_mm: Floats
    distortion_mm: Floats
    at_centre: Bools


def lens_correction(jobs: FilmJobs, film: FilmCoordinates, used: Bools) -> LensCorrection:
    """Look up the lens distortion of every landmark.

    Args:
        jobs: give the lens tables of group 1.
        film: centres and landmarks on the film, mm.
        used: which landmarks take part (N,); the numbers of the others are NaN.

    Raises:
        TableOutOfOrder: if a lens table is not in order.

    Source: TM X-3050, A 343 to A 347.
    """
    away = film.point_mm - film.centre_mm[jobs.readings.layout.frame]
    r = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2)
    tables = [(job.camera.lens_radius_mm, job.camera.lens_distortion_um) for job in jobs.jobs]
    delr = -ftlup_each(r, jobs.points, tables, LENS_RADII) / 1000.0
    return LensCorrection(
        radius_mm=np.where(used, r, np.nan),
        distortion_mm=np.where(used, delr, np.nan),
        at_centre=(r == 0) & used,
    )


def corrected(film: FilmCoordinates, lens: LensCorrection, layout: LandmarkLayout) -> Floats:
    """Film coordinates of the landmarks with the lens distortion removed.

    A landmark exactly at the centre is not corrected; the original divided zero by zero there.

    Args:
        film: centres and landmarks on the film, mm.
        lens: distance and distortion of each landmark.
        layout: which landmarks each frame has.

    Returns:
        x and y from the frame's centre (N, 2), mm.

    Source: TM X-3050, A 348.
    """
    distr = radial_factor(lens.radius_mm, lens.distortion_mm)
    return np.asarray(distr[:, None] * (film.point_mm - film.centre_mm[layout.frame]))
