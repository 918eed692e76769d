"""The components of the uncertainty: what an error of each input does to residuals and angles."""

from __future__ import annotations

from collections.abc import Collection
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.input_sigmas import SigmasInForce
from vopd.estimate import Estimate
from vopd.geometry.body_angles import body_angles_by_turns, turns_by_body_angles
from vopd.geometry.linear import pseudo_inverse

COMPONENTS = (
    "reading",  # of every image coordinate of a landmark by itself
    "centre",  # of each frame's centre by its fiducials, which moves all its landmarks together
    "principal_point",  # of the principal point
    "landmark",  # of the positions of the landmarks
    "position",  # of the camera's position
    "focal",  # of the focal length
    "time",  # of the times of the frames
    "mount",  # of the camera's mounting in the vehicle
    "velocity",  # of the velocity, in the angles of attack
    "wind",  # of the wind, in the angles of attack
)
"""The components of the uncertainty of an angle, one for each cause."""

INPUTS = (
    "position", "landmark", "focal", "principal_point", "time", "mount", "velocity", "wind",
)  # fmt: skip
"""Components that only the user or the source can state; the others are estimated."""

COMMON = ("principal_point", "landmark", "focal", "time", "mount")
"""Components whose error is the same in all frames; a mean over frames does not reduce it."""


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

    @property
    def common(self) -> bool:
        """Whether the error is the same in all frames."""
        return self.name in COMMON


def given_components(
    estimate: Estimate, sigmas: SigmasInForce, centre: Floats | None = None
) -> list[ErrorComponent]:
    """The components but for that of the readings, which is estimated after them.

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
    if np.any(sigmas.landmark):
        found.append(_by_residuals("landmark", r.landmark * sigmas.landmark, each_landmark=True))
    if np.any(sigmas.position):
        found.append(_by_residuals("position", r.position * sigmas.position))
    if sigmas.focal_length > 0.0:
        found.append(_by_residuals("focal", r.focal_length[..., None] * sigmas.focal_length))
    if sigmas.time_s > 0.0:
        found.append(_time(estimate, sigmas.time_s))
    if sigmas.mount_deg > 0.0:
        found.append(_mount(estimate, sigmas.mount_deg))
    if sigmas.velocity > 0.0:
        found.append(_velocity("velocity", r.attack_by_velocity * sigmas.velocity, estimate))
    if sigmas.wind > 0.0:
        horizontal = -r.attack_by_velocity[..., :2]
        found.append(_velocity("wind", horizontal * sigmas.wind, estimate))
    return found


def left_out(estimate: Estimate, components: Collection[str]) -> list[str]:
    """List the causes of errors that the standard deviations of a job do not contain.

    Those that cannot change its angles are not listed: times of a camera that stands still,
    and velocity and wind where no angle of attack is known.

    Args:
        estimate: the job
        components: the components of its uncertainty
    """
    attack = bool(np.isfinite(estimate.attack_deg).any())
    moves = bool(np.nan_to_num(estimate.responses.time).any())
    without_effect = {"time": not moves, "velocity": not attack, "wind": not attack}
    return [
        name for name in INPUTS if name not in components and not without_effect.get(name, False)
    ]


def _by_residuals(name: str, residual: Floats, each_landmark: bool = False) -> ErrorComponent:
    frames, causes = len(residual), residual.shape[2]
    nine, three = np.zeros((frames, 9, causes)), np.zeros((frames, 3, causes))
    return ErrorComponent(name, residual, nine, three, each_landmark)


def _centre(estimate: Estimate) -> Floats:
    """Derivatives of the residuals with respect to x and y of the centre, (F, 2L, 2)."""
    used = estimate.used.astype(np.float64)
    zero = np.zeros_like(used)
    along_x, along_y = np.hstack([used, zero]), np.hstack([zero, used])
    return -np.stack([along_x, along_y], axis=2)


def _time(estimate: Estimate, sigma_s: float) -> ErrorComponent:
    one = _by_residuals("time", estimate.responses.time[..., None] * sigma_s)
    one.angles[:, 6:9, 0] = estimate.responses.attack_by_time * sigma_s
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
