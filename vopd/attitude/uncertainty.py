"""Standard deviations of the angles, and the components that the inputs contribute to them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.input_sigmas import Sigmas
from vopd.estimate import Estimate

ANGLES = (
    "camera_yaw", "camera_pitch", "camera_roll",
    "vehicle_yaw", "vehicle_pitch", "vehicle_roll",
    "alpha", "beta", "eta",
)  # fmt: skip
"""The nine angles of a frame in the order of every array here."""

COMPONENTS = ("reading", "centre", "landmark", "position", "focal", "time")
"""The components of the uncertainty of an angle, one for each cause.

The readings of the landmarks, the centre of the frame (its fiducials), the positions of
the landmarks, that of the vehicle, the focal length, the time.
"""


@dataclass(frozen=True)
class Uncertainty:
    """Standard deviations of the nine `ANGLES`, degrees; the frame axis comes first.

    `total` is the root of the sum of squares of the `components`, which are those of
    `COMPONENTS` that are not left out. `camera_covariance_deg2` is the covariance of
    camera yaw, pitch, roll from all components together. `by_residuals` marks frames
    whose reading component is scaled by their own residuals; the others use
    `reading_sigma`.
    """

    total: Floats  # (F, 9)
    components: dict[str, Floats]  # (F, 9) each
    camera_covariance_deg2: Floats  # (F, 3, 3)
    by_residuals: Bools  # (F,)
    reading_sigma: float  # of an image coordinate, image units


@np.errstate(all="ignore")
def uncertainty(estimate: Estimate, sigmas: Sigmas) -> Uncertainty:
    """Standard deviations and covariances of a job's angles.

    A standard deviation that `sigmas` does not give is the one that the source itself
    states, if it states one.

    Each component comes from independent causes: `effects` (F, 9, causes), radians, is
    the change of the nine angles when a cause is off by one standard deviation.

    Args:
        estimate: the job
        sigmas: standard deviations of the inputs

    Raises:
        VopdError: where a standard deviation is not in a unit of the estimate
    """
    given, stated = sigmas.of(estimate.units), estimate.stated
    reading = estimate.reading_sigma if given.reading is None else given.reading
    by_residuals = estimate.used.sum(axis=1) >= 3
    scale = np.where(by_residuals, _residual_scale(estimate), reading)
    through = _angles_by_camera(estimate) @ estimate.gain
    responses = estimate.responses
    effects = {
        "reading": through * scale[:, None, None],
        "centre": through @ _centre_shifts(estimate) * (stated.centre or reading / 2.0),
    }
    landmark = np.array([given.landmark] * 3 if given.landmark > 0.0 else stated.landmark)
    if landmark.any():
        effects["landmark"] = _each_landmark(through, responses.landmark * landmark)
    position = np.array([given.position] * 3 if given.position > 0.0 else stated.position)
    if position.any():
        effects["position"] = through @ (responses.position * position)
    focal_length = given.focal_length or stated.focal_length
    if focal_length > 0.0:
        effects["focal"] = through @ responses.focal_length[..., None] * focal_length
    time_s = given.time_s or stated.time_s
    if time_s > 0.0:
        effect = through @ responses.time[..., None]
        effect[:, 6:9, 0] += responses.attack_by_time
        effects["time"] = effect * time_s
    return _uncertainty(effects, by_residuals, reading)


def _uncertainty(effects: dict[str, Floats], by_residuals: Bools, reading: float) -> Uncertainty:
    degrees = {name: np.degrees(effect) for name, effect in effects.items()}
    components = {name: np.sqrt((effect**2).sum(axis=2)) for name, effect in degrees.items()}
    camera = [effect[:, :3] for effect in degrees.values()]
    return Uncertainty(
        total=np.sqrt(sum(component**2 for component in components.values())),
        components=components,
        camera_covariance_deg2=np.asarray(sum(e @ e.swapaxes(1, 2) for e in camera)),
        by_residuals=by_residuals,
        reading_sigma=reading,
    )


def _residual_scale(estimate: Estimate) -> Floats:
    """Standard deviation of an image coordinate, from the frame's residuals, (F,) image units.

    The degrees of freedom are three fewer than the residuals, for the three angles.
    """
    freedom = 2.0 * estimate.used.sum(axis=1) - 3.0
    return np.asarray(np.sqrt((estimate.residual**2).sum(axis=1) / freedom))


def _angles_by_camera(estimate: Estimate) -> Floats:
    """Derivatives of the nine angles with respect to the camera's three, (F, 9, 3)."""
    chain = np.zeros((len(estimate.frame), 9, 3))
    chain[:, 0:3] = np.eye(3)
    chain[:, 3:6] = estimate.vehicle_by_camera
    chain[:, 6:9] = estimate.responses.attack_by_camera
    return chain


def _centre_shifts(estimate: Estimate) -> Floats:
    """Derivatives of the residuals with respect to x and y of the frame's centre, (F, 2L, 2)."""
    used = estimate.used.astype(np.float64)
    zero = np.zeros_like(used)
    along_x, along_y = np.hstack([used, zero]), np.hstack([zero, used])
    return -np.stack([along_x, along_y], axis=2)


def _each_landmark(through: Floats, change: Floats) -> Floats:
    """Change of the nine angles when one landmark moves east, north or up, (F, 9, 3L)."""
    count = change.shape[1] // 2
    own = through[..., None] * change[:, None]  # (F, 9, 2L, 3)
    return np.reshape(own[:, :, :count] + own[:, :, count:], (*own.shape[:2], -1))
