"""How a flight's residuals change with landmarks, position, focal length and time."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.estimate import Responses
from vopd.flight.angles_of_attack import AttackAngles
from vopd.flight.frame_slots import FrameSlots
from vopd.flight.sight_lines import EARTH_RADIUS_M
from vopd.flight.solved_flight import SolvedFlight
from vopd.geometry.cross_product import crossing
from vopd.geometry.lenses import Projection
from vopd.geometry.local_axes import NED_FROM_ENU


def pick_responses(
    solved: SolvedFlight,
    slots: FrameSlots,
    used: Bools,
    seen: Projection,
    attack: AttackAngles,
    body_turns: Floats,
) -> Responses:
    """The responses of a flight, the camera's angles against its local axes held fixed.

    A residual is measured minus computed of image coordinates -u and -v, and so it
    changes as the computed u and v do.

    Args:
        solved: the flight, its rotations and lines of sight
        slots: where each pick stands in arrays of frames
        used: picks that take part, (P,)
        seen: the images of the lines of sight
        attack: the angles of attack
        body_turns: small turns about the body's axes by camera yaw, pitch, roll, (F, 3, 3)
    """
    flight, lines = solved.flight, solved.lines
    picks = flight.picks
    rotation = solved.attitudes.rotation[picks.frame]
    ray = np.einsum("pij,pj->pi", rotation, lines.direction)
    # moved across its line of sight by a length, a landmark turns by that over the distance
    moved = seen.by_turns @ crossing(ray) @ rotation / lines.distance_m[:, None, None]
    at_landmark = flight.landmarks.axes[picks.landmark]
    to_camera = lines.axes[picks.frame] @ at_landmark.swapaxes(1, 2)
    vertical = seen.by_turns @ rotation @ _vertical_by_position(solved)[picks.frame]
    position = -moved - vertical
    velocity = np.zeros((len(flight.frame), 3))
    if flight.path.velocity_m_s is not None:
        velocity = flight.path.velocity_m_s @ NED_FROM_ENU
    focal = (seen.pixel - flight.lens.centre_px) / flight.lens.focal_px.mean()

    def of_frames(values: Floats) -> Floats:
        return slots.coordinates(np.where(used.reshape(-1, *[1] * (values.ndim - 1)), values, 0.0))

    return Responses(
        landmark=of_frames(moved @ to_camera),
        position=of_frames(position),
        focal_length=of_frames(focal),
        time=of_frames(np.einsum("pki,pi->pk", position, velocity[picks.frame])),
        attack_by_camera=attack.by_turns @ body_turns,
        attack_by_time=attack.by_time,
        attack_by_velocity=attack.by_velocity,
    )


def _vertical_by_position(solved: SolvedFlight) -> Floats:
    """How east, north, up turn, radians about themselves, a metre east, north, up: (F, 3, 3)."""
    latitude = np.radians(solved.lines.camera.latitude_deg)
    turn = np.zeros((len(latitude), 3, 3))
    turn[:, 0, 1] = -1.0 / EARTH_RADIUS_M
    turn[:, 1, 0] = 1.0 / EARTH_RADIUS_M
    turn[:, 2, 0] = np.tan(latitude) / EARTH_RADIUS_M
    return turn
