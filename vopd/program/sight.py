"""Prepare the input of the solve from film, lens and landmarks."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.errata import Fix, Fixes
from vopd.program.average import FilmCoordinates
from vopd.program.lens_correction import LensCorrection, corrected
from vopd.program.orient import Sight
from vopd.program.tgtcam import Dircos
from vopd.results import Results


def sight(
    film: FilmCoordinates,
    lens: LensCorrection,
    direction: Floats,
    used: Bools,
    focal_length_mm: Floats,
    fixes: Fixes,
) -> Sight:
    """Prepare the input of the solve.

    Args:
        film: centres and landmarks on the film.
        lens: distance and distortion of the landmarks.
        direction: cosines of the landmarks (F, L, 3) along east, north, up.
        used: which landmarks take part (F, L).
        focal_length_mm: the focal length for every frame (F,).
        fixes: which errata are corrected.
    """
    point = corrected(film, lens)
    x, y = (np.ascontiguousarray(point[..., k].T) for k in (0, 1))
    dircos = Dircos(*(np.ascontiguousarray(direction[..., k].T) for k in range(3)))
    first = used.argmax(axis=1)
    xmu1 = np.broadcast_to(dircos.xmu[first, np.arange(len(first))], dircos.xmu.shape)
    return Sight(
        dircos=dircos,
        x=x,
        y=y,
        xmu1=dircos.xmu if Fix.FIRST_LANDMARK in fixes else xmu1,
        used=np.ascontiguousarray(used.T),
        cc=focal_length_mm,
    )


@np.errstate(all="ignore")
def sight_of(results: Results) -> Sight:
    """The input of the solve that gave some results.

    Args:
        results: one job.
    """
    r = results
    return sight(
        FilmCoordinates(r.centre_in, r.point_in, r.centre_mm, r.point_mm),
        LensCorrection(r.radius_mm, r.distortion_mm, r.at_centre),
        r.direction,
        r.used,
        r.focal_length_mm,
        r.fixes,
    )
