"""What is still known of frames whose landmarks determine the attitude badly or not at all."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.landmark_geometry import AXES, LandmarkGeometry
from vopd.estimate import Estimate
from vopd.geometry.body_angles import body_axes
from vopd.geometry.local_axes import NED_FROM_ENU


@np.errstate(all="ignore")
def free_turn_text(estimate: Estimate, free_turn: Floats) -> list[str]:
    """The axis about which the attitude is free, as text, for each frame; empty where none is.

    Turns about every axis at right angles to it are still known. Its azimuth is clockwise
    from north, its elevation above the horizontal; of its two ends the one on the landmarks'
    side is named.

    Args:
        estimate: the job
        free_turn: the axis along forward, right and down, (F, 3), unit vectors; 0 where none
    """
    axis = (body_axes(np.radians(estimate.vehicle_deg)) @ free_turn[..., None])[..., 0]
    used = estimate.used & np.isfinite(estimate.direction).all(axis=2)
    seen = np.where(used[..., None], estimate.direction, 0.0).sum(axis=1) @ NED_FROM_ENU
    axis = np.where((axis * seen).sum(axis=1)[:, None] < 0.0, -axis, axis)
    north, east, down = axis.T
    azimuth = np.degrees(np.arctan2(east, north)) % 360.0
    elevation = np.degrees(np.arcsin(np.clip(-down, -1.0, 1.0)))
    free = np.asarray(np.isfinite(axis).all(axis=1) & (np.abs(axis).max(axis=1) > 0.0))
    text = [""] * len(free)
    for k in np.flatnonzero(free):
        text[k] = f"turn about azimuth {azimuth[k]:.1f} elevation {elevation[k]:.1f} is free"
    return text


@np.errstate(all="ignore")
def weak_axis_text(shape: LandmarkGeometry, covariance_deg2: Floats, weak: Bools) -> list[str]:
    """The axis that is determined worst, with the sigma about it and about the two others, (F,).

    The sigmas are those about the principal axes of the covariance, degrees.

    Args:
        shape: the landmark geometry
        covariance_deg2: of small turns, (F, 3, 3)
        weak: the frames that it is told of, (F,); it is empty for the others
    """
    text = [""] * len(weak)
    frames = np.flatnonzero(weak)
    known = np.asarray(np.isfinite(covariance_deg2[frames]).all(axis=(1, 2)))
    safe = np.where(known[:, None, None], covariance_deg2[frames], 0.0)
    sigma = np.sqrt(np.maximum(np.linalg.eigvalsh(safe), 0.0))
    for k, told, s in zip(frames.tolist(), known, sigma, strict=True):
        text[k] = AXES[shape.weak_axis[k]].replace(" ", "_")
        if told:
            text[k] += f" sigma {s[2]:.3g} others {s[1]:.3g} {s[0]:.3g}"
    return text
