"""The lens correction: how far each landmark was displaced on the film (A 343 to A 348)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.geometry.lens import radial_factor
from vopd.job import Camera
from vopd.program.average import FilmCoordinates
from vopd.program.ftlup import TableName, ftlup

LENS_RADII = TableName(1, "radial distances")


class LensCorrection(NamedTuple):
    """Distance of each landmark from the frame's centre and its distortion: fields of `Results`."""

    radius_mm: Floats
    distortion_mm: Floats
    at_centre: Bools


def lens_correction(camera: Camera, film: FilmCoordinates, used: Bools) -> LensCorrection:
    """Look up the lens distortion of every landmark (A 343 to A 348)."""
    away = film.point_mm - film.centre_mm[:, None]
    r = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2)
    delr = -ftlup(r, 1, camera.lens_radius_mm, camera.lens_distortion_um, LENS_RADII) / 1000.0
    return LensCorrection(
        radius_mm=np.where(used, r, np.nan),
        distortion_mm=np.where(used, delr, np.nan),
        at_centre=(r == 0) & used,
    )


def corrected(film: FilmCoordinates, lens: LensCorrection) -> Floats:
    """Landmarks on the film from the frame's centre, freed of distortion, mm (F, L, 2).

    A landmark exactly at the centre is not corrected, where the original divided zero by zero.
    """
    distr = radial_factor(lens.radius_mm, lens.distortion_mm)
    return np.asarray(distr[..., None] * (film.point_mm - film.centre_mm[:, None]))
