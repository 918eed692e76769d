"""Alpha, beta, eta of every frame, and how they change with attitude and time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.cross_product import crossing


class AttackAngles(NamedTuple):
    """Angles of attack of F frames; NaN where the velocity is not known."""

    angle_deg: Floats  # (F, 3) alpha, beta, eta
    airspeed_m_s: Floats  # (F,)
    by_turns: Floats  # (F, 3, 3) by small turns about forward, right, down
    by_time: Floats  # (F, 3) radians a second, by the change of the velocity
    by_velocity: Floats  # (F, 3, 3) radians by north, east, down of the velocity, m/s


@np.errstate(all="ignore")
def angles_of_attack(
    body_to_ned: Floats, velocity_m_s: Floats, acceleration_m_s2: Floats
) -> AttackAngles:
    """Alpha = atan2(w, u), beta = atan2(v, u), eta = atan2(sqrt(v2 + w2), u).

    u, v, w are forward, right and down components of the velocity relative to the air.

    Args:
        body_to_ned: forward, right, down as columns in north, east, down, (F, 3, 3)
        velocity_m_s: north, east, down relative to the air, (F, 3)
        acceleration_m_s2: its change a second, (F, 3)
    """
    to_body = body_to_ned.swapaxes(1, 2)
    inside = (to_body @ velocity_m_s[..., None])[..., 0]
    u, v, w = inside.T
    across = np.hypot(v, w)
    angles = np.stack([np.arctan2(w, u), np.arctan2(v, u), np.arctan2(across, u)], axis=1)
    zero = np.zeros_like(u)
    wu, vu, all2 = u**2 + w**2, u**2 + v**2, u**2 + across**2
    rows = [
        np.stack([-w / wu, zero, u / wu], axis=1),
        np.stack([-v / vu, u / vu, zero], axis=1),
        np.stack([-across / all2, u * v / (across * all2), u * w / (across * all2)], axis=1),
    ]
    by_velocity = np.stack(rows, axis=1)
    return AttackAngles(
        np.degrees(angles),
        np.sqrt(all2),
        by_velocity @ crossing(inside),
        (by_velocity @ to_body @ acceleration_m_s2[..., None])[..., 0],
        by_velocity @ to_body,
    )
