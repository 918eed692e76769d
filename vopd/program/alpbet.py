"""ALPBET, angles of attack from attitude, velocity and wind (C 13 to C 38)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.program.constants import dr
from vopd.program.constants import rad as rd


def alpbet(
    v1: Floats, v0: Floats, theta: Floats, psi: Floats, phi: Floats
) -> tuple[Floats, Floats, Floats, Floats]:
    """Compute the angles of attack from attitude, velocity and wind.

    Args:
        v1: the vehicle's velocity (F, 3), ft/s toward north, east and down.
        v0: the wind's velocity (F, 2), ft/s toward north and east; it has no vertical part.
        theta: pitch of the vehicle (F,), degrees.
        psi: its yaw (F,), degrees.
        phi: its roll (F,), degrees.

    Returns:
        ALPHAD, BETAD, ETAD (F,), the angles of attack in pitch, in yaw and in total, degrees;
        and CVP (F,), the airspeed, ft/s.

    Source: TM X-3050, C 13 to C 38. `vopd.program.vopd` looks up velocity and wind (C 6 to C 12).
    """
    # The scan shows X5*X1 where b1 (C 22, C 25) has X6*X1; the printed angles prove X6
    psir, phir, thetar = psi * dr, phi * dr, theta * dr
    x1, x2 = np.sin(psir), np.cos(psir)
    x3, x4 = np.sin(phir), np.cos(phir)
    x5, x6 = np.sin(thetar), np.cos(thetar)

    def body(vx: Floats, vy: Floats, vz: Floats | float) -> tuple[Floats, Floats, Floats]:
        b1 = x6 * x2 * vx + x6 * x1 * vy - x5 * vz
        b2 = (x2 * x5 * x3 - x1 * x4) * vx + (x2 * x4 + x1 * x5 * x3) * vy + x6 * x3 * vz
        b3 = (x2 * x5 * x4 + x1 * x3) * vx + (x1 * x5 * x4 - x2 * x3) * vy + x6 * x4 * vz
        return b1, b2, b3

    b1, b2, b3 = body(v1[:, 0], v1[:, 1], v1[:, 2])
    b4, b5, b6 = body(v0[:, 0], v0[:, 1], 0.0)
    up, vp, wp = b1 - b4, b2 - b5, b3 - b6
    alphad, betad = np.arctan2(wp, up) * rd, np.arctan2(vp, up) * rd
    etad = np.arctan2(np.sqrt(vp**2 + wp**2), up) * rd
    return alphad, betad, etad, np.sqrt(up * up + vp * vp + wp * wp)
