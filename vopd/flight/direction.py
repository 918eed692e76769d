"""Direction in which a point is seen that is picked in a frame, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.uncertainty import student_factor, total_freedom
from vopd.findings import VopdError, angle_text
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import Flight, frame_label
from vopd.flight.solve.equations import parameters_of, with_parameters
from vopd.geometry.lenses import ray_of_pixel
from vopd.records import Record


@dataclass(frozen=True, eq=False, repr=False)
class Direction(Record):
    """Where a point of a picture lies, seen from the camera.

    Refraction is not taken off: a body outside the air lies lower than it is seen.

    Attributes:
        frame: its number, or the name of its image
        azimuth_deg: from true north to east, 0 to 360
        elevation_deg: above the plane across the ellipsoid's normal
        total: standard deviations of azimuth and elevation, all components together, degrees (2,)
        half_width_95: half-widths of their 95 % intervals, with Student's factor, degrees (2,)
        components: standard deviations to the right and upward on the sky, by component, degrees
            (2,) each; `pick` is that of the point's own pick
        covariance_deg2: of the same, to the right and upward (2, 2)
    """

    frame: str
    azimuth_deg: float
    elevation_deg: float
    total: Floats
    half_width_95: Floats
    components: dict[str, Floats]
    covariance_deg2: Floats

    def __str__(self) -> str:
        from vopd.attitude.summary import decimals_for

        few = decimals_for(self.half_width_95, 2)
        azimuth, elevation = (f"{half:.{few}f}" for half in self.half_width_95)
        return (
            f"{self.frame}: azimuth {angle_text(self.azimuth_deg, few)} +- {azimuth}, elevation "
            f"{self.elevation_deg:.{few}f} +- {elevation} degree (95 %)"
        )


STEP = {"focal": 0.5, "centre_u": 0.5, "centre_v": 0.5}  # px; of coefficients COEFFICIENT_STEP
COEFFICIENT_STEP = 1e-5


def direction_of(
    estimates: FlightEstimates, frame: int, pixel: Floats, sigma_px: float | None
) -> Direction:
    """Find the direction of a point in a frame.

    An error of the lens turns the frame, too, so that it moves points beside the landmarks little.

    Args:
        estimates: of the flight
        frame: its index
        pixel: u, v from the centre of the first pixel, as the picture was taken, (2,)
        sigma_px: standard deviation of u and of v; None: that of the picks, or of the clicks

    Raises:
        VopdError: where the frame has no attitude, the lens's model does not reach the pixel, or
            its row is of another time than the frame
    """
    flight = estimates.flight
    label = frame_label(flight, frame)
    where = f"{flight.source}: {label}"
    if flight.shutter is not None:
        raise VopdError(
            f"{where}: no direction of a point where [camera] has a readout_ms: its row is of "
            "another time than the frame"
        )
    to_camera = estimates.solved.attitudes.rotation[frame]
    if not np.isfinite(to_camera).all():
        raise VopdError(f"{where}: no direction of a point: the frame has no attitude")
    (u, v), size_px = pixel.tolist(), flight.lens.of(np.array([frame])).by_rows("size_px")
    if not (np.abs(pixel - (size_px.reshape(2) - 1.0) / 2.0) <= size_px.reshape(2) / 2.0).all():
        long, high = size_px.reshape(2).tolist()
        raise VopdError(f"{where}: {u:g}, {v:g} is not in the picture of {long:g} by {high:g} px")
    steps = 0.5 * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    ray, *ends = (_ray(flight, frame, pixel + step) for step in steps)
    if not np.isfinite([ray, *ends]).all():
        raise VopdError(f"{where}: the lens's model does not reach the pixel {u:g}, {v:g}")
    east, north, up = to_camera.T @ ray
    azimuth, elevation = np.arctan2(east, north), np.arcsin(np.clip(up, -1.0, 1.0))
    (sin_a, sin_e), (cos_a, cos_e) = np.sin([azimuth, elevation]), np.cos([azimuth, elevation])
    right_up = np.array([[cos_a, -sin_a, 0.0], [-sin_a * sin_e, -cos_a * sin_e, cos_e]])
    across = right_up @ to_camera.T  # along the camera's axes, (2, 3)
    weight = np.zeros((len(flight.frame), 3, 2))
    weight[frame] = np.cross(across, ray).T
    lens = parameters_of(flight.lens)
    by_parameter = {one: across @ _by_parameter(flight, frame, pixel, one) for one in lens}
    found = estimates.camera_errors(weight, by_parameter)
    assert estimates.reading is not None
    clicks = estimates.read.picks.clicks  # with what is stated of them
    as_readings = sigma_px is None and clicks is None
    if sigma_px is None:  # that of a person's pick; readings of a tracked flight are matches
        sigma_px = estimates.reading.sigma if clicks is None else float(np.median(clicks.sigma_px))
    by_pixel = across @ (np.array(ends[:2]) - ends[2:]).T
    found["pick"] = sigma_px**2 * by_pixel @ by_pixel.T
    found = {name: np.degrees(np.degrees(one)) for name, one in found.items()}
    covariance = sum(found.values(), np.zeros((2, 2)))
    sigma, by_picks = np.sqrt(np.diag(covariance)), found["reading"]
    if as_readings:
        by_picks = by_picks + found["pick"]
    freedom = total_freedom(estimates.reading.freedom, sigma**2, np.diag(by_picks))
    with np.errstate(divide="ignore"):
        total = sigma / [cos_e, 1.0]
    return Direction(
        label,
        float(np.degrees(azimuth) % 360.0 % 360.0),
        float(np.degrees(elevation)),
        total,
        total * student_factor(freedom),
        {name: np.sqrt(np.diag(one)) for name, one in found.items()},
        covariance,
    )


def _ray(flight: Flight, frame: int, pixel: Floats, name: str = "", value: float = 0.0) -> Floats:
    """Trace a pixel of a frame, with one parameter of the lens changed, to a ray (3,)."""
    lens = flight.lens
    if name:
        lens = with_parameters(lens, (name,), np.array([value]))
    return np.asarray(ray_of_pixel(lens.of(np.array([frame])), pixel[None])[0])


def _by_parameter(flight: Flight, frame: int, pixel: Floats, name: str) -> Floats:
    """Differentiate the ray of a pixel by a parameter of the lens, (3,)."""
    step = STEP.get(name, COEFFICIENT_STEP)
    ends = [_ray(flight, frame, pixel, name, side * step) for side in (1.0, -1.0)]
    return np.asarray((ends[0] - ends[1]) / (2.0 * step))
