"""Angles relative to local axes with another vertical."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vopd.arrays import Floats
from vopd.estimate import Estimate, Position, Vertical
from vopd.findings import VopdError
from vopd.geometry.earth import NED_FROM_ENU, east_north_up
from vopd.geometry.linear import pseudo_inverse
from vopd.geometry.rotations import (
    angles_by_turns,
    body_angles_by_turns,
    body_angles_deg,
    body_axes,
    camera_angles_deg,
    camera_axes,
    turns_by_angles,
)

DOWN = {
    Vertical.GEODETIC: "along the ellipsoid's normal",
    Vertical.GEOCENTRIC: "toward the Earth's centre",
}


def lean_deg(position: Position) -> Floats:
    """Measure the angle between geodetic and geocentric vertical at each position, (F,) degrees."""
    return np.asarray(np.abs(position.latitude_deg - position.geocentric_latitude_deg))


@np.errstate(all="ignore")
def with_vertical(estimate: Estimate, vertical: str | None) -> Estimate:
    """Express all angles relative to north, east and down with a certain vertical.

    The attitude in space stays what it is: the estimate's own vertical is taken at its
    word. What does not depend on the local axes is unchanged: residuals, angles of
    attack, positions, and the components of the standard deviations of the inputs.

    Args:
        estimate: the job
        vertical: geodetic, geocentric, or None for that which the solve used

    Returns:
        The estimate itself where it already has that vertical.

    Raises:
        VopdError: where there is no such vertical
    """
    if vertical is None:
        return estimate
    try:
        wanted = Vertical(vertical)
    except ValueError:
        raise VopdError(
            f"no vertical is called {vertical!r}; there are: {', '.join(Vertical)}"
        ) from None
    if wanted is estimate.position.vertical:
        return estimate
    position = _position(estimate.position, wanted)
    turn = position.north_east_down @ estimate.position.north_east_down.swapaxes(1, 2)
    e, old = estimate, np.radians(estimate.camera_deg)
    camera_deg, vehicle_deg = _camera(e.camera_deg, turn), _vehicle(e.vehicle_deg, turn)
    new = np.radians(camera_deg)
    by_old = angles_by_turns(new) @ turns_by_angles(old)  # the new camera angles
    by_new = angles_by_turns(old) @ turns_by_angles(new)  # the old ones
    vehicle_by_old = body_angles_by_turns(np.radians(vehicle_deg)) @ pseudo_inverse(
        body_angles_by_turns(np.radians(e.vehicle_deg))
    )
    return replace(
        e,
        about=e.about._replace(down=f"{DOWN[wanted]}; the solve had down {e.about.down}"),
        position=position,
        camera_deg=camera_deg,
        vehicle_deg=vehicle_deg,
        vehicle_by_camera=vehicle_by_old @ e.vehicle_by_camera @ by_new,
        direction=_turned(e.direction, turn),
        partials=e.partials @ by_new,
        gain=by_old @ e.gain,
        responses=replace(
            e.responses,
            attack_by_camera=e.responses.attack_by_camera @ by_new,
            attack_by_velocity=e.responses.attack_by_velocity @ turn.swapaxes(1, 2),
        ),
        errors=None
        if e.errors is None
        else {name: replace(one, camera=by_old @ one.camera) for name, one in e.errors.items()},
        slip_effect_deg=_slip_effect(e, turn, camera_deg, vehicle_deg),
    )


def _position(position: Position, vertical: Vertical) -> Position:
    """Turn the local axes of a position to this vertical."""
    geodetic = vertical is Vertical.GEODETIC
    latitude = position.latitude_deg if geodetic else position.geocentric_latitude_deg
    axes = east_north_up(np.radians(latitude), np.radians(position.longitude_deg))
    east, north, up = np.moveaxis(axes, 1, -1)
    north_east_down = np.stack([north, east, -up], axis=-2)
    return replace(position, north_east_down=north_east_down, vertical=vertical)


def _camera(angles_deg: Floats, turn: Floats) -> Floats:
    """Turn the local axes of camera yaw, pitch, roll, (F, 3).

    A pitch beyond 90 degrees stays beyond it.
    """
    axes = camera_axes(np.radians(angles_deg))
    return _same_side(camera_angles_deg(_turned(axes, turn)), angles_deg)


def _turned(enu: Floats, turn: Floats) -> Floats:
    """Turn the local axes of vectors, rows in east, north, up."""
    return np.asarray(enu @ (NED_FROM_ENU @ turn @ NED_FROM_ENU).swapaxes(1, 2))


def _vehicle(angles_deg: Floats, turn: Floats) -> Floats:
    """Turn the local axes of vehicle yaw, pitch, roll, (F, 3)."""
    return _same_side(body_angles_deg(turn @ body_axes(np.radians(angles_deg))), angles_deg)


def _same_side(angles_deg: Floats, before_deg: Floats) -> Floats:
    """Keep the pitch on the side of 90 degrees it was on: angles of the same attitude."""
    yaw, pitch, roll = angles_deg.T
    beyond = np.stack(
        [(yaw + 180.0) % 360.0, (360.0 - pitch) % 360.0 - 180.0, (roll + 180.0) % 360.0], axis=1
    )
    was_beyond = np.cos(np.radians(before_deg[:, 1:2])) < 0.0
    return np.where(was_beyond, beyond, angles_deg)


def _slip_effect(
    estimate: Estimate, turn: Floats, camera_deg: Floats, vehicle_deg: Floats
) -> Floats | None:
    """Express the effect of the errata on the angles relative to the new axes, (F, 9) degrees."""
    effect = estimate.slip_effect_deg
    if effect is None:
        return None
    camera = _camera(estimate.camera_deg + effect[:, :3], turn) - camera_deg
    vehicle = _vehicle(estimate.vehicle_deg + effect[:, 3:6], turn) - vehicle_deg
    change = (np.hstack([camera, vehicle]) + 180.0) % 360.0 - 180.0
    return np.hstack([change, effect[:, 6:]])
