"""The camera's mounting in a vehicle whose attitude is known from a file.

Every frame tells how the camera is turned against the vehicle; the mount is their weighted mean.
The vehicle's attitudes have no weight in the camera's, so that picks alone determine these.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vopd.arrays import Floats
from vopd.findings import Finding, VopdError, size_text
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import Flight
from vopd.geometry.earth import NED_FROM_ENU
from vopd.geometry.rotations import rotation_matrices, rotation_vectors
from vopd.video import find_images

PASSES = 5  # of a mean of rotations: each squares what is left
MOST_APART = 3.0  # times what is expected: more are told
LARGEST_GAP = 3.1  # usual steps of an attitude's rows: over three, as rounded, is interpolated


def mounted(estimates: FlightEstimates) -> FlightEstimates:
    """Solve for the mount of a flight, under its prior if stated, and turn its vehicle by it.

    Args:
        estimates: of a flight whose camera has been solved

    Raises:
        VopdError: where the file has the vehicle's attitude of no frame with an attitude
    """
    flight, joint = estimates.flight, estimates.joint
    assert flight.vehicle is not None and joint is not None
    vehicle, sigma_rad = _at_frames(flight, joint.model.late_s(joint.state))
    rotation = estimates.solved.attitudes.rotation
    weight = np.where(np.isfinite(rotation[:, 0, 0]), np.nan_to_num(sigma_rad**-2.0), 0.0)
    if not weight.any():
        raise VopdError(
            f"{flight.source}: free mount: {flight.vehicle.name} has the vehicle's attitude of no "
            f"frame that has one of the camera; look at its column {flight.vehicle.by}"
        )
    weight, mount, known = weight / weight.sum(), flight.mount, weight > 0.0
    body = vehicle[known].swapaxes(1, 2) @ NED_FROM_ENU @ rotation[known].swapaxes(1, 2)
    for _ in range(PASSES):
        turn = (weight[known, None] * rotation_vectors(body @ mount.T)).sum(axis=0)
        mount = rotation_matrices(turn[None])[0] @ mount
    now = replace(flight, mount=mount)
    made = FlightEstimates(replace(estimates.solved, flight=now), joint, estimates.reading)
    by_camera = made.sum_errors(weight[:, None, None] * np.eye(3))
    by_vehicle = ((weight * np.where(known, sigma_rad, 0.0)) ** 2).sum() * np.eye(3)
    of_camera = sum(by_camera.values(), np.zeros((3, 3)))
    covariance = np.degrees(np.degrees(of_camera + by_vehicle))
    # errors of the camera's attitudes as if each frame had its own, which is the most they can be
    expected = np.trace(of_camera) / 3.0 / (weight**2).sum() + (sigma_rad[known] ** 2).mean()
    found = (rotation_vectors(body @ mount.T) ** 2).mean()
    off_deg, expected_deg = np.degrees(np.sqrt([found, expected])).tolist()
    turned = np.degrees(rotation_vectors((mount @ flight.mount.T)[None])[0])
    if flight.mount_sigma_deg > 0.0:  # the stated mount is one more reading of it
        prior = flight.mount_sigma_deg**2 * np.eye(3)
        gain = prior @ np.linalg.inv(prior + covariance)
        turned, covariance = gain @ turned, gain @ covariance
        now = replace(now, mount=rotation_matrices(np.radians(turned)[None])[0] @ flight.mount)
    attitudes = flight.vehicle._replace(
        turned_deg=turned, covariance_deg2=covariance, apart=(off_deg, expected_deg)
    )
    sigma_deg = float(np.sqrt(np.trace(covariance) / 3.0))
    now = replace(now, vehicle=attitudes, mount_sigma_deg=sigma_deg)
    return FlightEstimates(replace(estimates.solved, flight=now), joint, estimates.reading)


def mount_findings(flight: Flight) -> list[Finding]:
    """Warn of a vehicle whose attitudes are not the camera's, turned by one mount, or not used.

    Args:
        flight: as it is solved, with a vehicle
    """
    assert flight.vehicle is not None
    if flight.vehicle.turned_deg is None:
        message = (
            f"[vehicle] attitude: {flight.vehicle.name} is not used, for the mount is not free: "
            'write free = ["mount"] in [solve], vopd adjust --free mount, or leave the key out'
        )
        return [Finding(message, flight.source, severity="warning")]
    off_deg, expected_deg = flight.vehicle.apart
    if not off_deg > MOST_APART * expected_deg > 0.0:
        return []
    times = off_deg / expected_deg
    message = (
        f"free mount: attitudes of {flight.vehicle.name} are {size_text(off_deg)} degrees from "
        f"those of the camera and one mount, {times:.1f} times what the standard deviations "
        "explain: are they degrees, of this vehicle and on this clock?"
    )
    return [Finding(message, flight.source, severity="warning")]


def _at_frames(flight: Flight, late_s: Floats) -> tuple[Floats, Floats]:
    """Look up the vehicle's attitudes of the frames, (F, 3, 3), and sigmas (F,); NaN: none."""
    rows, frames = flight.vehicle, len(flight.frame)
    assert rows is not None
    out, sigma = np.full((frames, 3, 3), np.nan), np.full(frames, np.nan)
    if np.isfinite(rows.time_s).any():
        at_s, step_s = flight.time_s + late_s, np.diff(rows.time_s)
        if len(step_s):
            after = np.clip(np.searchsorted(rows.time_s, at_s), 1, len(step_s))
            near = step_s[after - 1] <= LARGEST_GAP * np.median(step_s)
            inside = near & (at_s >= rows.time_s[0]) & (at_s <= rows.time_s[-1])
            here, end = rows.body_to_ned[after[inside] - 1], rows.body_to_ned[after[inside]]
            part = ((at_s - rows.time_s[after - 1]) / step_s[after - 1])[inside, None]
            out[inside] = here @ rotation_matrices(
                part * rotation_vectors(here.swapaxes(1, 2) @ end)
            )
            sigma[inside] = np.interp(at_s[inside], rows.time_s, rows.sigma_rad)
        return out, sigma
    labels = flight.image_name
    numbered = not labels or flight.frame_rate_hz is not None  # of others the numbers are our own
    if rows.by == "frame" and numbered:
        labels = tuple(map(str, flight.frame.tolist()))
    found = find_images(rows.keys, labels or ("",) * frames)
    there = found >= 0
    out[there], sigma[there] = rows.body_to_ned[found[there]], rows.sigma_rad[found[there]]
    return out, sigma
