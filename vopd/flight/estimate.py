"""The estimate of a flight: what its solve hands to `vopd.attitude`, in metres and pixels.

An estimate's image axes are those of 1974, seen from behind the camera: x to the
left, y up. Pixels have u to the right and v down, and so image x is -u, and y -v.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.estimate import About, Estimate, FrameStatus, Position, StatedSigmas, Units, Words
from vopd.flight.angles_of_attack import AttackAngles, angles_of_attack
from vopd.flight.flight import Flight
from vopd.flight.frame_slots import FrameSlots
from vopd.flight.responses import pick_responses
from vopd.flight.solved_flight import IMAGE_FROM_CAMERA, SolvedFlight
from vopd.flight.words import flight_words
from vopd.geometry.body_angles import body_angles_by_turns, body_angles_deg
from vopd.geometry.camera_axes import angles_by_turns, camera_angles_deg, turns_by_angles
from vopd.geometry.earth import geodetic, local_axes
from vopd.geometry.lenses import project, ray_of_pixel
from vopd.geometry.linear import FAR_FROM_SINGULAR, inverse
from vopd.geometry.local_axes import NED_FROM_ENU

FLIGHT_UNITS = Units("m", "px", 1.0, "px", 1.0)


class WholeFlight(NamedTuple):
    """What the estimates of all blocks of a flight have in common."""

    words: Words
    landmark_names: Mapping[int, str]
    origin_m: Floats  # (3,) the first position that is known, Earth-centred; NaN: there is none
    origin_axes: Floats  # (3, 3) east, north, up there as rows
    largest_lean_deg: float  # between the geodetic and the geocentric vertical


def whole_flight(solved: SolvedFlight) -> WholeFlight:
    """What is said of all frames of a flight.

    Args:
        solved: the flight
    """
    marks, camera_m = solved.flight.landmarks, solved.camera_m
    known = np.isfinite(camera_m[:, 0])
    origin_m = camera_m[known.argmax()] if known.any() else np.full(3, np.nan)
    names = dict(zip(marks.number.tolist(), marks.name, strict=True))
    return WholeFlight(
        flight_words(solved),
        names,
        origin_m,
        local_axes(origin_m[None])[0],
        _largest_lean(camera_m),
    )


def _largest_lean(camera_m: Floats) -> float:
    """The largest angle between the two verticals, degrees; 0 where no position is known."""
    lean = np.abs(geodetic(camera_m).latitude_deg - _geocentric_latitude_deg(camera_m))
    return float(np.fmax.reduce(lean, initial=0.0))


def _geocentric_latitude_deg(camera_m: Floats) -> Floats:
    x, y, z = camera_m.T
    return np.asarray(np.degrees(np.arctan2(z, np.hypot(x, y))))


class FrameAngles(NamedTuple):
    """The angles of F frames."""

    camera_deg: Floats  # (F, 3) yaw, pitch, roll
    vehicle_deg: Floats  # (F, 3) yaw, pitch, roll
    attack: AttackAngles


@np.errstate(all="ignore")
def frame_angles(solved: SolvedFlight) -> FrameAngles:
    """The angles of the frames of a flight.

    Args:
        solved: its rotations
    """
    rotation, flight = solved.attitudes.rotation, solved.flight
    body_to_ned = NED_FROM_ENU @ rotation.swapaxes(1, 2) @ flight.mount.T
    return FrameAngles(
        camera_angles_deg(IMAGE_FROM_CAMERA @ rotation),
        body_angles_deg(body_to_ned),
        _attack(flight, body_to_ned),
    )


@np.errstate(all="ignore")
def flight_estimate(solved: SolvedFlight, whole: WholeFlight | None = None) -> Estimate:
    """The estimate of a flight, for `vopd.attitude`.

    Args:
        solved: the flight and its rotations, or some of its frames
        whole: what is said of all frames, where these are some of them
    """
    whole = whole or whole_flight(solved)
    flight, attitudes, picks = solved.flight, solved.attitudes, solved.flight.picks
    rotation = attitudes.rotation
    known: Bools = np.isfinite(rotation[:, 0, 0])
    slots = FrameSlots.of(picks.frame, len(flight.frame))
    used: Bools = solved.used & (attitudes.weight > 0.0) & known[picks.frame]
    left_out = ~np.array(flight.landmarks.used or (True,) * len(flight.landmarks.name))
    weight = np.where(used, attitudes.weight, 0.0)

    angles = frame_angles(solved)
    radians = np.radians(angles.camera_deg)
    seen = project(flight.lens, _of_frames(rotation[picks.frame], solved.lines.direction))
    residual = -(picks.pixel - seen.pixel)
    by_turns = _part(used, seen.by_turns) @ IMAGE_FROM_CAMERA  # of the image, by turns of the axes
    partials = slots.coordinates(by_turns)
    turn_gain = _gain(partials, slots.coordinates(_twice(weight)))
    body_turns = flight.mount @ IMAGE_FROM_CAMERA @ turns_by_angles(radians)
    return Estimate(
        about=About(
            flight.source,
            title=flight.name,
            words=whole.words,
            epoch=flight.epoch,
        ),
        units=FLIGHT_UNITS,
        frame=flight.frame,
        status=np.where(known, FrameStatus.SOLVED, FrameStatus.UNSOLVED).astype(np.int64),
        solved=np.ones_like(known),
        converged=attitudes.converged | ~known,
        correction_rad=attitudes.correction_rad,
        time_s=flight.time_s,
        position=_position(solved, whole.largest_lean_deg),
        displacement=(solved.camera_m - whole.origin_m) @ whole.origin_axes.T,
        camera_deg=angles.camera_deg,
        vehicle_deg=angles.vehicle_deg,
        vehicle_by_camera=body_angles_by_turns(np.radians(angles.vehicle_deg)) @ body_turns,
        attack_deg=angles.attack.angle_deg,
        airspeed=angles.attack.airspeed_m_s,
        landmark=slots.spread(flight.landmarks.number[picks.landmark]),
        used=slots.spread(used),
        ignored=slots.spread(left_out[picks.landmark]),
        direction=slots.spread(_part(used, solved.lines.direction)),
        image=slots.spread(_part(used, _ideal(flight))),
        focal_length=float(flight.lens.focal_px.mean()),
        residual=slots.coordinates(_part(used, residual)),
        partials=partials @ turns_by_angles(radians),
        gain=angles_by_turns(radians) @ turn_gain,
        body_gain=flight.mount @ IMAGE_FROM_CAMERA @ turn_gain,
        responses=pick_responses(solved, slots, used, seen, angles.attack, body_turns),
        reading_spread=picks.repeatability_px,
        reading_floor=picks.least_sigma_px,
        relative_sigma=slots.spread(picks.sigma_px / picks.one_sigma_px),
        landmark_names=whole.landmark_names,
        frame_names=flight.image_name,
        stated=_stated(flight),
        grid=flight.grid,
        gimbal_deg=flight.path.gimbal_deg,
    )


def _of_frames(rotation: Floats, direction: Floats) -> Floats:
    return np.asarray(np.einsum("pij,pj->pi", rotation, direction))


def _twice(values: Floats) -> Floats:
    return np.stack([values, values], axis=1)


def _part(used: Bools, values: Floats) -> Floats:
    """The values of picks that take part, 0 for the others."""
    return np.where(used.reshape(-1, *[1] * (values.ndim - 1)), values, 0.0)


def _ideal(flight: Flight) -> Floats:
    """Image coordinates (P, 2) that a lens without distortion would show."""
    ray = ray_of_pixel(flight.lens, flight.picks.pixel)
    return np.asarray(-flight.lens.focal_px.mean() * ray[:, :2] / ray[:, 2:])


def _gain(partials: Floats, weight: Floats) -> Floats:
    """Small turns by the residuals, (F, 3, 2L); NaN where the turns are not determined."""
    weighted = partials.swapaxes(1, 2) * weight[:, None]
    normal = weighted @ partials
    plain = inverse(normal)
    condition = np.linalg.norm(normal, axis=(1, 2)) * np.linalg.norm(plain, axis=(1, 2))
    doubtful = ~(condition < FAR_FROM_SINGULAR)
    sizes = np.linalg.eigvalsh(np.nan_to_num(normal[doubtful]))
    singular = np.zeros_like(doubtful)
    singular[doubtful] = ~(sizes[:, 0] > 1e-14 * sizes[:, 2])
    return np.where(singular[:, None, None], np.nan, plain) @ weighted


def _position(solved: SolvedFlight, largest_lean_deg: float) -> Position:
    where = solved.lines.camera
    return Position(
        where.latitude_deg,
        where.longitude_deg,
        where.height_m,
        NED_FROM_ENU @ solved.lines.axes,
        _geocentric_latitude_deg(solved.camera_m),
        largest_lean_deg=largest_lean_deg,
    )


def _attack(flight: Flight, body_to_ned: Floats) -> AttackAngles:
    frames = len(flight.frame)
    velocity = flight.path.velocity_m_s
    if velocity is None:
        unknown = np.full((frames, 3), np.nan)
        return angles_of_attack(body_to_ned, unknown, unknown)
    acceleration = flight.path.acceleration_m_s2
    wind = np.zeros((frames, 3))
    if flight.path.wind_m_s is not None:
        wind[:, :2] = flight.path.wind_m_s
    return angles_of_attack(
        body_to_ned,
        velocity - wind,
        np.zeros((frames, 3)) if acceleration is None else acceleration,
    )


def _stated(flight: Flight) -> StatedSigmas:
    """What the project says is uncertain; of landmarks that differ the root mean square."""
    own = np.nan_to_num(flight.landmarks.sigma_m)
    landmark = np.sqrt((own**2).mean(axis=0)) if len(own) else np.zeros(3)
    position = np.nan_to_num(flight.path.sigma_m)
    return StatedSigmas(
        (float(landmark[0]), float(landmark[1]), float(landmark[2])),
        (float(position[0]), float(position[1]), float(position[2])),
        float(flight.options.focal_relative_sigma * flight.lens.focal_px.mean()),
        flight.path.sigma_time_s,
        flight.options.principal_point_sigma_px,
    )
