"""TGTCAM: direction cosines of the landmarks as seen from the camera (B 1 to B 118)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.program.constants import rad as dpr

Dircos = tuple[Floats, Floats, Floats]
"""XLAM, XMU, XNU: cosines along east, north, *geocentric* up at the camera (COMMON /DIRCOS/)."""


def camera_position(
    rz: Floats | float, phiz: Floats | float, thz: Floats | float, xyz: Floats
) -> tuple[Floats, ...]:
    """Place the camera in Earth-fixed axes: x, y, z, each (F,) km.

    Args:
        rz: distance of the origin, or of that of every frame (F,), from the Earth's centre, km.
        phiz: its geocentric latitude, radians.
        thz: its longitude, radians east.
        xyz: the vehicle (3, F), kilometres east, north, up of the origin.
    """
    cospz, costhz, sinpz, sinthz = np.cos(phiz), np.cos(thz), np.sin(phiz), np.sin(thz)
    x, y, z = xyz
    xs = rz * cospz * costhz + -sinthz * x + -sinpz * costhz * y + cospz * costhz * z
    ys = rz * cospz * sinthz + costhz * x + -sinpz * sinthz * y + sinthz * cospz * z
    zs = rz * sinpz + cospz * y + sinpz * z
    return xs, ys, zs


def tgtcam(
    rz: Floats | float,
    phiz: Floats | float,
    thz: Floats | float,
    xyz: Floats,
    thj: Floats,
    phij: Floats,
    rj: Floats,
    of: Ints | None = None,
) -> Dircos:
    """Find the direction cosines of landmarks as seen from the camera.

    Args:
        rz: distance of the origin, or of that of every frame (F,), from the Earth's centre, km.
        phiz: its geocentric latitude, radians.
        thz: its longitude, radians east.
        xyz: the vehicle (3, F), kilometres east, north, up of the origin.
        thj: longitudes of the landmarks (..., F), degrees east.
        phij: their geocentric latitudes (..., F), degrees.
        rj: their distances from the Earth's centre (..., F), kilometres.
        of: the frame of each landmark, where these are (N,) in place of (..., F).

    Returns:
        XLAM, XMU, XNU, each (..., F) or (N,).

    Source: TM X-3050, B 1 to B 118.
    """
    xs, ys, zs = camera_position(rz, phiz, thz, xyz)
    # The vertical is geocentric: azimuth and elevation of the camera's own place
    al = np.arctan2(zs, np.sqrt(xs**2 + ys**2))
    t = np.arctan2(ys, xs)
    sint, cost, sinal, cosal = np.sin(t), np.cos(t), np.sin(al), np.cos(al)
    if of is not None:
        xs, ys, zs = xs[of], ys[of], zs[of]
        sint, cost, sinal, cosal = sint[of], cost[of], sinal[of], cosal[of]

    # From the camera to each landmark, Earth-fixed; then by turns about T and AL east, north, up
    phij, thj = phij / dpr, thj / dpr
    cospj = np.cos(phij)
    delxj = rj * cospj * np.cos(thj) - xs
    delyj = rj * cospj * np.sin(thj) - ys
    delzj = rj * np.sin(phij) - zs
    delrj = np.sqrt(delxj**2 + delyj**2 + delzj**2)
    delxj, delyj, delzj = delxj / delrj, delyj / delrj, delzj / delrj  # AMV, of length 1
    xlam = -sint * delxj + cost * delyj
    xmu = -sinal * cost * delxj + -sinal * sint * delyj + cosal * delzj
    xnu = cosal * cost * delxj + sint * cosal * delyj + sinal * delzj
    return xlam, xmu, xnu
