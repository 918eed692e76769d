"""Convert geodetic to geocentric latitude by the series of the listing (A 56, A 195)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.errata import Fix, Fixes
from vopd.program.constants import eradkm, ftpkm, rad

ORIGIN_FOUR_PHI = 0.0003258611111111  # group 8's latitude, A 56
LANDMARK_FOUR_PHI = 0.0000325861111111  # group 9's, A 195: one zero too many, as it ran
SIX_PHI = 7.2222222222e-07  # of the wrong sign, as it ran


def geocentric(phi: Floats | float, four_phi: float, six_phi: float = SIX_PHI) -> Floats:
    """Convert geodetic to geocentric latitude by the program's series.

    Args:
        phi: geodetic latitude, degrees.
        four_phi: factor of sin 4PHI, degrees: `ORIGIN_FOUR_PHI` or `LANDMARK_FOUR_PHI`.
        six_phi: factor of sin 6PHI, degrees.

    Returns:
        Geocentric latitude, degrees.

    Source: TM X-3050, A 49 to A 57 and A 187 to A 196.
    """
    twophi = (2.0 * np.asarray(phi)) / rad
    sintpd, sinfpd, sinspd = np.sin(twophi), np.sin(2.0 * twophi), np.sin(3.0 * twophi)
    return np.asarray(phi - 0.1932398611111 * sintpd + four_phi * sinfpd + six_phi * sinspd)


def six_phi(fixes: Fixes) -> float:
    """Choose the factor of sin 6PHI in the series, degrees; its sign is wrong unless fixed."""
    return -SIX_PHI if Fix.SIN_6PHI in fixes else SIX_PHI


def spherical(latitude_deg: Floats, altitude_ft: Floats, fixes: Fixes) -> tuple[Floats, Floats]:
    """Place landmarks on the program's spherical Earth.

    Args:
        latitude_deg: geodetic, (...), degrees.
        altitude_ft: above the sphere, (...), feet.
        fixes: the errata to correct.

    Returns:
        PHIJ, geocentric latitude, degrees; and RJ, distance from the Earth's centre, km.

    Source: TM X-3050, A 186 to A 199.
    """
    four_phi = ORIGIN_FOUR_PHI if Fix.LATITUDE_SERIES in fixes else LANDMARK_FOUR_PHI
    return geocentric(latitude_deg, four_phi, six_phi(fixes)), altitude_ft / ftpkm + eradkm
