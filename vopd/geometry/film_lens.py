"""The factor of radial lens distortion of film, from the table of group 1."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats


def radial_factor(radius: Floats, correction: Floats) -> Floats:
    """Find the factor that removes radial distortion from image coordinates.

    It is 1 - correction / radius.

    A point at the frame's centre has the factor 1; the listing divides zero by zero there.

    Args:
        radius: distance of the image point from the frame's centre, mm, (...)
        correction: DELTA R, minus the lens table's distortion at that radius, mm, (...)

    Source: TM X-3050, DISTR, A 348.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.where(radius == 0, 1.0, 1.0 - correction / radius))
