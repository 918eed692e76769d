"""Angles of a solved flight: the camera's, the vehicle's, and the angles of attack."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.flight.flight import Flight
from vopd.flight.solve.rotations import SolvedFlight
from vopd.geometry.earth import NED_FROM_ENU
from vopd.geometry.linear import crossing
from vopd.geometry.rotations import (
    FORWARD,
    IMAGE_FROM_CAMERA,
    body_angles_by_turns,
    body_angles_deg,
    camera_angles_deg,
)


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
    """Find the angles of attack and their derivatives.

    Alpha = atan2(w, u), beta = atan2(v, u), eta = atan2(sqrt(v2 + w2), u), with forward, right
    and down components u, v, w of the velocity relative to the air.

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
    angles[all2 == 0.0] = np.nan  # what does not move through the air has no direction in it
    return AttackAngles(
        np.degrees(angles),
        np.sqrt(all2),
        by_velocity @ crossing(inside),
        (by_velocity @ to_body @ acceleration_m_s2[..., None])[..., 0],
        by_velocity @ to_body,
    )


@np.errstate(all="ignore")
def camera_angles(solved: SolvedFlight) -> Floats:
    """Convert the rotations of all frames to camera yaw, pitch, roll (F, 3), degrees."""
    return camera_angles_deg(IMAGE_FROM_CAMERA @ solved.attitudes.rotation)


@np.errstate(all="ignore")
def vehicle_angles(solved: SolvedFlight) -> Floats:
    """Convert the rotations of all frames to vehicle yaw, pitch, roll (F, 3), degrees."""
    return body_angles_deg(_body_to_ned(solved))


@np.errstate(all="ignore")
def turned_vehicle_deg(solved: SolvedFlight, frames: Ints, turn_rad: Floats) -> Floats:
    """Convert small turns of frames to changes of vehicle yaw, pitch, roll (T, 3), degrees.

    Args:
        solved: the flight
        frames: index of the frame of each, (T,); negative: NaN
        turn_rad: about the camera's axes, (T, 3)
    """
    angles = vehicle_angles(solved)[frames]
    by_turns = body_angles_by_turns(np.radians(angles))
    changed = -np.einsum("tij,jk,tk->ti", by_turns, solved.flight.mount, turn_rad)
    return np.where(frames[:, None] >= 0, np.degrees(changed), np.nan)


def _body_to_ned(solved: SolvedFlight) -> Floats:
    rotation = solved.attitudes.rotation.swapaxes(1, 2)
    return np.asarray(NED_FROM_ENU @ rotation @ solved.flight.mount.T)


@np.errstate(all="ignore")
def attack_angles(solved: SolvedFlight) -> AttackAngles:
    """Find the angles of attack of all frames; NaN if the velocity is not known."""
    path, body_to_ned = solved.flight.path, _body_to_ned(solved)
    if path.velocity_m_s is None:
        unknown = np.full((len(body_to_ned), 3), np.nan)
        return angles_of_attack(body_to_ned, unknown, unknown)
    still = np.zeros((len(body_to_ned), 3))
    wind = still.copy()
    if path.wind_m_s is not None:
        wind[:, :2] = path.wind_m_s
    change = still if path.acceleration_m_s2 is None else path.acceleration_m_s2
    return angles_of_attack(body_to_ned, path.velocity_m_s - wind, change)


# Angles that pictures turned by half a turn have

LEAST_FRAMES = 3  # of a camera that moves: one frame may be of a vehicle that turns over
ABOUT_DEG = 30.0  # from upside down, or from backward
LEVEL_DEG = 60.0  # of pitch: beyond it roll is no more than yaw
LEAST_SPEED_M_S = 3.0  # level, from which on a vehicle is said to fly


def doubted_angles(flight: Flight, vehicle_deg: Floats) -> list[str]:
    """Tell that a vehicle is upside down in all frames, or flies backward in all of them.

    No residual tells that pictures are turned by half a turn, or a mount.

    Args:
        flight: as it is solved
        vehicle_deg: yaw, pitch, roll of the vehicle in each frame, (F, 3); NaN where not known
    """
    known = np.isfinite(vehicle_deg).all(axis=1)
    yaw_deg, pitch_deg, roll_deg = vehicle_deg[known].T
    least = 1 if flight.path.stands else LEAST_FRAMES
    if known.sum() < least or (np.abs(pitch_deg) > LEVEL_DEG).any():
        return []
    told = list[str]()
    mounted_otherwise = not np.array_equal(flight.mount, FORWARD)
    if _all_about(180.0, roll_deg):
        who = "vehicle" if mounted_otherwise else "camera"
        told.append(
            f"the {who} is upside down in all frames: are the pictures turned by half a turn, or "
            "is the mount another? Of a camera that hangs so [vehicle] mount = "
            "{ ypr_deg = [0, 0, 180] } gives the angles of what carries it"
        )
    velocity_m_s = flight.path.velocity_m_s
    if velocity_m_s is not None and mounted_otherwise:
        north, east = velocity_m_s[known, 0], velocity_m_s[known, 1]
        course_deg = np.degrees(np.arctan2(east, north))
        slow = not (np.hypot(north, east) > LEAST_SPEED_M_S).all()  # nor where it is not known
        if not slow and _all_about(180.0, yaw_deg - course_deg):
            told.append(
                "the vehicle flies backward in all frames: are the pictures turned by half a turn, "
                "or is [vehicle] mount turned?"
            )
    return told


def _all_about(middle_deg: float, angle_deg: Floats) -> bool:
    """Tell whether all angles are near one, at whatever turn they count."""
    away_deg = np.abs((angle_deg - middle_deg + 180.0) % 360.0 - 180.0)
    return bool((away_deg < ABOUT_DEG).all())
