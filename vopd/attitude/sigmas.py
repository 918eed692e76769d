"""Standard deviations of the inputs, and how their errors move the angles."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from numbers import Real
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, distinct_in_rows
from vopd.estimate import Estimate, InputErrors
from vopd.findings import VopdError
from vopd.geometry.linear import pseudo_inverse, singular_values
from vopd.geometry.rotations import angles_by_turns, body_angles_by_turns, turns_by_body_angles
from vopd.inputs import MOST_SIGMA, beyond_sigmas

# Standard deviations of the inputs: the user's, or those the source states.


HALF_A_TURN_DEG = 180.0
AS_SIGMAS = "standard deviations as vopd.Sigmas has them"


@dataclass(frozen=True)
class Sigmas:
    """Standard deviations of the inputs of a job or flight.

    0 leaves a component out; in a flight the value that the project states stays in force.

    Lengths are in feet for a card deck and in metres for a flight project; image
    coordinates in millimetres on the film for a deck and in pixels for a flight.

    Args:
        reading: of each image coordinate of a landmark (on film, the mean of its three
            readings), above 0 for a flight; None estimates it from the residuals of all
            frames of the job
        fiducial: of each film coordinate of a fiducial, the mean of its three readings;
            None estimates it from the fiducials of the job
        landmark: of each landmark's position, along east, north and up; the same error
            in all frames
        position: of the camera's position, along east, north and up, frame by frame
        focal_length: of the focal length, the same error in all frames
        time_s: of the times of the frames, the same error in all frames, seconds
        velocity: of the velocity along north, east and down, length units a second,
            frame by frame
        wind: of the wind along north and east, length units a second, frame by frame
        mount_deg: of the camera's mounting in the vehicle, a turn about each of the
            vehicle's axes, the same in all frames, degrees

    Raises:
        VopdError: if one is negative, not a number, too large, or too small to be meant
    """

    reading: float | None = None
    fiducial: float | None = None
    landmark: float = 0.0
    position: float = 0.0
    focal_length: float = 0.0
    time_s: float = 0.0
    velocity: float = 0.0
    wind: float = 0.0
    mount_deg: float = 0.0

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            most = HALF_A_TURN_DEG if field.name.endswith("_deg") else MOST_SIGMA
            is_number = isinstance(value, Real) and not isinstance(value, bool | np.bool_)
            may_lack = field.default is None and value is None
            name = field.name.removesuffix("_s").removesuffix("_deg").replace("_", " ")
            if not may_lack and not (is_number and 0.0 <= value <= most):
                shown = f"{value:g}" if is_number and value < 2.0 * most else repr(value)[:80]
                raise VopdError(f"{name} sigma: {shown} is not a standard deviation: 0 to {most:g}")
            if value is not None and (beyond := beyond_sigmas([float(value)])):
                raise VopdError(f"{name} sigma: {beyond}, or 0")
            if value is not None:  # numpy's scalars bring their own precision and comparisons
                object.__setattr__(self, field.name, float(value))


class SigmasInForce(NamedTuple):
    """The standard deviations of one job, in the units of its estimate; 0: left out."""

    reading: float | None  # None: to be estimated from the residuals
    centre: float  # of x and y of the centre of each frame, by its fiducials
    principal_point: tuple[float, float]
    landmark: Floats  # east, north, up: (3,), or (F, L, 3) of each by itself
    position: Floats  # east, north, up of every frame by itself: (3,), or (F, 3)
    place: Floats  # (3,) east, north, up, the same error in all frames
    focal_length: float
    time_s: float
    velocity: Floats  # north, east, down of every frame by itself: (3,), or (F, 3)
    wind: float
    mount_deg: float


FIDUCIALS = 4.0  # of a frame; their mean is its centre


def in_force(estimate: Estimate, given: Sigmas) -> SigmasInForce:
    """Select the standard deviations of a job: the user's, else those its source states.

    Args:
        estimate: the job
        given: the user's
    """
    stated = estimate.stated
    landmark = stated.landmark if estimate.landmark_sigma is None else estimate.landmark_sigma
    position = stated.position if estimate.fix_sigma is None else estimate.fix_sigma
    velocity = np.zeros(3) if estimate.velocity_sigma is None else estimate.velocity_sigma
    fiducial = estimate.fiducial_sigma if given.fiducial is None else given.fiducial
    return SigmasInForce(
        reading=given.reading,
        centre=float(np.nan_to_num(fiducial)) / np.sqrt(FIDUCIALS),
        principal_point=stated.principal_point,
        landmark=np.array([given.landmark] * 3 if given.landmark > 0.0 else landmark),
        position=np.array([given.position] * 3 if given.position > 0.0 else position),
        place=np.array(stated.place),
        focal_length=given.focal_length or stated.focal_length,
        time_s=given.time_s or stated.time_s,
        velocity=np.nan_to_num([given.velocity] * 3 if given.velocity > 0.0 else velocity),
        wind=given.wind or stated.wind,
        mount_deg=given.mount_deg or stated.mount_deg,
    )


# Components of the uncertainty: effect of each input on residuals and angles.

COMPONENTS = (
    "reading",  # of every image coordinate of a landmark by itself
    "centre",  # of each frame's centre by its fiducials, which moves all its landmarks together
    "principal_point",  # of the principal point
    "distortion",  # of the lens's coefficients
    "refraction",  # of the coefficient of refraction
    "click",  # of a person's clicks, which their tracks carry through the frames
    "landmark",  # of the positions of the landmarks
    "position",  # of the camera's position
    "interpolation",  # of the camera's position between two that are given
    "focal",  # of the focal length
    "time",  # of the times of the frames
    "readout",  # of the readout of a rolling shutter
    "adjusted",  # of what was solved for before, with one covariance
    "mount",  # of the camera's mounting in the vehicle
    "velocity",  # of the velocity, in the angles of attack
    "wind",  # of the wind, in the angles of attack
)
"""The components of the uncertainty of an angle, one for each cause."""

INPUTS = (
    "position", "landmark", "focal", "principal_point", "distortion", "refraction", "time",
    "readout", "mount", "velocity", "wind", "click",
)  # fmt: skip
"""Components that only the user or the source can state; the others are estimated."""

COMMON = (
    "principal_point", "distortion", "landmark", "focal", "time", "readout", "mount", "refraction",
    "adjusted", "click",
)  # fmt: skip
"""Components whose error is the same in all frames; a mean over frames does not reduce it."""


OF_FRAMES = ("click",)  # components whose columns of residuals are other errors in each frame


class ErrorComponent(NamedTuple):
    """What an error of one standard deviation in each of C causes does in F frames.

    With `each_landmark` the causes are those of every landmark by itself: the C = 3
    columns of `residual` are its own east, north, up.
    """

    name: str
    residual: Floats  # (F, 2L, C) change of the residuals, image units
    angles: Floats  # (F, 9, C) further change of the nine angles, not by the residuals, radians
    body: Floats  # (F, 3, C) further turn about forward, right, down, radians
    each_landmark: bool = False
    common: bool = False  # the same error in all frames


def given_components(
    estimate: Estimate, sigmas: SigmasInForce, centre: Floats | None = None
) -> list[ErrorComponent]:
    """List the error components, except that of the readings, which is estimated after them.

    Args:
        estimate: the job
        sigmas: standard deviations of its inputs
        centre: that of the centre of each frame (F,), where it is not one for all
    """
    r = estimate.responses
    found = []
    if sigmas.centre > 0.0:
        by_frame = np.reshape(sigmas.centre if centre is None else centre, (-1, 1, 1))
        found.append(_by_residuals("centre", _centre(estimate) * by_frame))
    if np.any(sigmas.principal_point):
        shift = _centre(estimate) * sigmas.principal_point
        found.append(_by_residuals("principal_point", shift))
    if estimate.landmark_sigma is not None or np.any(sigmas.landmark):
        moved = sigmas.landmark if sigmas.landmark.ndim == 1 else np.tile(sigmas.landmark, (2, 1))
        found.append(_by_residuals("landmark", r.landmark * moved, each_landmark=True))
    if estimate.fix_sigma is not None or np.any(sigmas.position):
        by_frame = np.reshape(sigmas.position, (-1, 1, 3))
        found.append(_by_residuals("position", r.position * by_frame))
    if np.any(sigmas.place):
        of_all = _by_residuals("position", r.position * sigmas.place)
        found.append(of_all._replace(common=True))
    if sigmas.focal_length > 0.0:
        found.append(_by_residuals("focal", r.focal_length[..., None] * sigmas.focal_length))
    late_s = np.full((len(estimate.frame), 1), sigmas.time_s)
    if estimate.late_s is not None:
        late_s = np.hstack([late_s, estimate.late_s])
    if late_s.any():
        found.append(_time(estimate, late_s))
    for name, change in estimate.further.items():
        one = _by_residuals(name, change)
        found.append(one._replace(common=one.common and name not in OF_FRAMES))
    if sigmas.mount_deg > 0.0:
        found.append(_mount(estimate, sigmas.mount_deg))
    if estimate.velocity_sigma is not None or np.any(sigmas.velocity):
        by_frame = np.reshape(sigmas.velocity, (-1, 1, 3))
        found.append(_velocity("velocity", r.attack_by_velocity * by_frame, estimate))
    if sigmas.wind > 0.0:
        horizontal = -r.attack_by_velocity[..., :2] * sigmas.wind
        in_common = sigmas.wind == estimate.stated.wind
        found.append(_velocity("wind", horizontal, estimate)._replace(common=in_common))
    return found


def _by_residuals(name: str, residual: Floats, each_landmark: bool = False) -> ErrorComponent:
    frames, causes = len(residual), residual.shape[2]
    nine, three = np.zeros((frames, 9, causes)), np.zeros((frames, 3, causes))
    return ErrorComponent(name, residual, nine, three, each_landmark, name in COMMON)


def _centre(estimate: Estimate) -> Floats:
    """Differentiate the residuals by x and y of the centre, (F, 2L, 2)."""
    used = estimate.used.astype(np.float64)
    zero = np.zeros_like(used)
    along_x, along_y = np.hstack([used, zero]), np.hstack([zero, used])
    return -np.stack([along_x, along_y], axis=2)


def _time(estimate: Estimate, late_s: Floats) -> ErrorComponent:
    one = _by_residuals("time", estimate.responses.time[..., None] * late_s[:, None])
    one.angles[:, 6:9] = estimate.responses.attack_by_time[..., None] * late_s[:, None]
    return one


def _mount(estimate: Estimate, sigma_deg: float) -> ErrorComponent:
    radians = np.radians(estimate.vehicle_deg)
    turn = np.radians(sigma_deg)
    one = _no_residual("mount", estimate, 3)
    one.angles[:, 3:6] = body_angles_by_turns(radians) * turn
    body_by_camera = turns_by_body_angles(radians) @ estimate.vehicle_by_camera
    one.angles[:, 6:9] = estimate.responses.attack_by_camera @ pseudo_inverse(body_by_camera) * turn
    one.body[:] = np.eye(3) * turn
    return one


def _velocity(name: str, attack: Floats, estimate: Estimate) -> ErrorComponent:
    one = _no_residual(name, estimate, attack.shape[2])
    one.angles[:, 6:9] = attack
    return one


def _no_residual(name: str, estimate: Estimate, causes: int) -> ErrorComponent:
    return _by_residuals(name, np.zeros((*estimate.residual.shape, causes)))


# Gains of the angles by the residuals.

NO_EFFECT = 1e-6  # of a turn on an angle: less is rounding


class Effect(NamedTuple):
    """What errors of one standard deviation in each of C causes change, degrees."""

    angles_deg: Floats  # (F, 9, C) the nine angles
    body_deg: Floats  # (F, 3, C) small turns about forward, right, down


class AngleGains(NamedTuple):
    """Derivatives of angles by residuals, and what the landmarks leave undetermined.

    Where the landmarks leave a turn of the camera free, the gains are without that turn.
    """

    angles: Floats  # (F, 9, 2L) the nine angles, radians by image units
    body: Floats  # (F, 3, 2L) small turns about forward, right, down
    free: Bools  # (F, 9) angles that a free turn changes
    free_turn: Floats  # (F, 3) its axis along forward, right, down, a unit vector; 0 where none

    def effect(self, component: ErrorComponent) -> Effect:
        """Propagate a component to angles and attitude."""
        if component.each_landmark:
            return Effect(
                _each_landmark(self.angles, component.residual),
                _each_landmark(self.body, component.residual),
            )
        return Effect(
            np.degrees(self.angles @ component.residual + component.angles),
            np.degrees(self.body @ component.residual + component.body),
        )

    def readings(self, sigma: Floats) -> Effect:
        """Propagate every image coordinate by itself, with these sigmas (F, 2L)."""
        scale = sigma[:, None]
        return Effect(np.degrees(self.angles * scale), np.degrees(self.body * scale))

    def covariance_deg2(self, effects: Iterable[Effect]) -> Floats:
        """Add up the covariance of small turns about forward, right, down (F, 3, 3).

        Infinite where a free turn has a part in both axes.
        """
        total = np.where(np.isfinite(self.body[:, :, :1]), 0.0, np.nan) * np.ones((1, 1, 3))
        for one in effects:
            total = total + one.body_deg @ one.body_deg.swapaxes(1, 2)
        both = self.free_turn[:, :, None] * self.free_turn[:, None, :]
        return np.where(np.abs(both) > NO_EFFECT, np.copysign(np.inf, both), total)


def input_effect(estimate: Estimate, errors: InputErrors) -> Effect:
    """Convert changes of the camera's angles to those of all nine angles, degrees."""
    vehicle = estimate.vehicle_by_camera @ errors.camera
    attack = estimate.responses.attack_by_camera @ errors.camera + errors.attack
    angles = np.concatenate([errors.camera, vehicle, attack], axis=1)
    return Effect(np.degrees(angles), np.degrees(errors.body))


def _each_landmark(gain: Floats, change: Floats) -> Floats:
    """Propagate a move of each landmark along each of its axes: degrees, (F, A, 3L)."""
    count = change.shape[1] // 2
    own = gain[..., None] * change[:, None]  # (F, A, 2L, 3)
    return np.degrees((own[:, :, :count] + own[:, :, count:]).reshape(*own.shape[:2], -1))


@np.errstate(all="ignore")
def angle_gains(estimate: Estimate) -> AngleGains:
    """Differentiate the angles of all frames by their residuals."""
    e = estimate
    frames = len(e.frame)
    chain = np.zeros((frames, 9, 3))
    chain[:, 0:3] = np.eye(3)
    chain[:, 3:6] = e.vehicle_by_camera
    chain[:, 6:9] = e.responses.attack_by_camera
    gains = AngleGains(
        chain @ e.gain, e.body_gain.copy(), np.zeros((frames, 9), bool), np.zeros((frames, 3))
    )
    some = np.flatnonzero(~np.isfinite(e.gain).all(axis=(1, 2)) & _seen(e))
    if not len(some):
        return gains
    by_turns = angles_by_turns(np.radians(e.camera_deg[some]))
    body = turns_by_body_angles(np.radians(e.vehicle_deg[some])) @ e.vehicle_by_camera[some]
    rows = np.where(np.tile(e.used[some], 2)[..., None], e.partials[some], 0.0) @ by_turns
    sizes, axes = singular_values(np.pad(rows, ((0, 0), (0, 1), (0, 0))))
    rank = np.stack([axes[:, k, :, None] / sizes[:, k, None, None] ** 2 for k in (0, 1)])
    limited = (rank @ axes[:, :2].swapaxes(0, 1)[..., None, :]).sum(axis=0) @ rows.swapaxes(1, 2)
    gains.angles[some] = chain[some] @ by_turns @ limited
    gains.body[some] = body @ by_turns @ limited
    turn = axes[:, 2, :, None]
    gains.free[some] = np.abs((chain[some] @ by_turns @ turn)[..., 0]) > NO_EFFECT
    axis = (body @ by_turns @ turn)[..., 0]
    gains.free_turn[some] = axis / np.linalg.norm(axis, axis=1, keepdims=True)
    return gains


def _seen(estimate: Estimate) -> Bools:
    """Mark frames with angles and at least one landmark (F,)."""
    has = np.isfinite(estimate.camera_deg).all(axis=1)
    return np.asarray(has & (distinct_in_rows(estimate.landmark, estimate.used) >= 1))
