"""Standard deviations of the angles, component by component, from the correct partials."""

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
"""The components of the uncertainty of an angle: what it comes from.

The readings of the landmarks, the centre of the frame (its fiducials), the positions of
the landmarks, that of the vehicle, the focal length, the time.
"""


@dataclass(frozen=True)
class Uncertainty:
    """Standard deviations of the nine `ANGLES`, degrees, frame axis first.

    `total` is the root of the sum of squares of the components, which are those
    of `COMPONENTS` that are not left out. `camera_covariance_deg2` is that of
    camera yaw, pitch, roll, all components together. `by_residuals`: the reading
    component has the scale of the frame's own residuals, else of `reading_sigma`.
    """

    total: Floats  # (F, 9)
    components: dict[str, Floats]  # (F, 9) each
    camera_covariance_deg2: Floats  # (F, 3, 3)
    by_residuals: Bools  # (F,)
    reading_sigma: float  # of an image coordinate, image units


@np.errstate(all="ignore")
def uncertainty(estimate: Estimate, sigmas: Sigmas) -> Uncertainty:
    """Standard deviations and covariances of a job's angles.

    Where `sigmas` has none, what the source itself states holds.

    Each component is a set of independent causes, each with what one standard
    deviation of it does to the nine angles: `effects` (F, 9, causes), radians.

    Args:
        estimate: the job
        sigmas: standard deviations of what the job was given

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
    """Standard deviation of an image coordinate by the frame's residuals: three angles are fitted.

    (F,), image units.
    """
    freedom = 2.0 * estimate.used.sum(axis=1) - 3.0
    return np.asarray(np.sqrt((estimate.residual**2).sum(axis=1) / freedom))


def _angles_by_camera(estimate: Estimate) -> Floats:
    """Derivatives of the nine angles by the camera's three, (F, 9, 3)."""
    chain = np.zeros((len(estimate.frame), 9, 3))
    chain[:, 0:3] = np.eye(3)
    chain[:, 3:6] = estimate.vehicle_by_camera
    chain[:, 6:9] = estimate.responses.attack_by_camera
    return chain


def _centre_shifts(estimate: Estimate) -> Floats:
    """Residuals by the frame's centre moved along x and along y, (F, 2L, 2): all move together."""
    used = estimate.used.astype(np.float64)
    zero = np.zeros_like(used)
    along_x, along_y = np.hstack([used, zero]), np.hstack([zero, used])
    return -np.stack([along_x, along_y], axis=2)


def _each_landmark(through: Floats, change: Floats) -> Floats:
    """Each landmark moved by itself east, north, up: (F, 9, 3L) a unit of length."""
    count = change.shape[1] // 2
    own = through[..., None] * change[:, None]  # (F, 9, 2L, 3)
    return np.reshape(own[:, :, :count] + own[:, :, count:], (*own.shape[:2], -1))
