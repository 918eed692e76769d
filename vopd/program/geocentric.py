"""Geodetic latitude to geocentric, the series as the listing has it twice (A 55, A 195)."""

from __future__ import annotations

import numpy as np

from vopd.job import Floats
from vopd.program.constants import rad

ORIGIN_FOUR_PHI = 0.0003258611111111  # group 8's latitude, A 55
LANDMARK_FOUR_PHI = 0.0000325861111111  # group 9's, A 195: one zero too many, as it ran


def geocentric(phi: Floats | float, four_phi: float) -> Floats:
    """Geocentric latitude of a geodetic one, both degrees; `four_phi` is sin 4PHI's factor."""
    twophi = (2.0 * np.asarray(phi)) / rad
    sintpd, sinfpd, sinspd = np.sin(twophi), np.sin(2.0 * twophi), np.sin(3.0 * twophi)
    return np.asarray(
        phi - 0.1932398611111 * sintpd + four_phi * sinfpd + 7.2222222222e-07 * sinspd
    )
