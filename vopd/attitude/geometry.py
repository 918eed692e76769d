"""Geometry of the landmarks in a frame: condition, weak or free axis, second solution."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.estimate import Estimate
from vopd.findings import angle_text
from vopd.geometry.earth import NED_FROM_ENU
from vopd.geometry.linear import eigenvectors, singular_values
from vopd.geometry.rotation_fit import Sights, fit_rotations
from vopd.geometry.rotations import ahead, angles_by_turns, body_axes, camera_axes
from vopd.records import Rows

# Condition number and weakest axis.

AXES = ("image x axis", "image y axis", "optical axis")


@dataclass(frozen=True, eq=False, repr=False)
class LandmarkGeometry(Rows):
    """How well the landmarks determine the rotation of each of F frames.

    `condition` is the ratio of the largest to the smallest singular value of the
    image coordinates' partials by small turns about the camera's own three axes;
    unlike yaw and roll these turns stay separate where the camera looks straight
    down. `weak_axis` is the index in `AXES` of the axis nearest to the turn that
    is determined worst. `behind` marks frames with a landmark behind the camera that takes part.
    """

    condition: Floats
    weak_axis: Ints
    behind: Bools


@np.errstate(all="ignore")
def landmark_geometry(estimate: Estimate) -> LandmarkGeometry:
    """Measure the landmark geometry of every frame; NaN, and axis 0, if there is no solution."""
    radians = np.radians(estimate.camera_deg)
    turns = estimate.partials @ angles_by_turns(radians)
    # one landmark has two rows, and three singular values are needed
    sizes, axes = singular_values(np.pad(turns, ((0, 0), (0, 1), (0, 0))))
    behind = estimate.used & (ahead(camera_axes(radians), estimate.direction) < 0.0)
    return LandmarkGeometry(
        condition=sizes[:, 0] / sizes[:, 2],
        weak_axis=np.abs(axes[:, 2]).argmax(axis=1),
        behind=np.asarray(behind.any(axis=1)),
    )


# The weak or free rotation axis of a frame, as text.


@np.errstate(all="ignore")
def free_turn_text(estimate: Estimate, free_turn: Floats) -> list[str]:
    """Describe the free rotation axis of each frame as text; empty if none is free.

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
    azimuth = np.degrees(np.arctan2(east, north))
    elevation = np.degrees(np.arcsin(np.clip(-down, -1.0, 1.0)))
    free = np.asarray(np.isfinite(axis).all(axis=1) & (np.abs(axis).max(axis=1) > 0.0))
    text = [""] * len(free)
    for k in np.flatnonzero(free):
        toward = angle_text(float(azimuth[k]), 1)
        text[k] = f"turn about azimuth {toward} elevation {elevation[k]:.1f} is free"
    return text


@np.errstate(all="ignore")
def weak_axis_text(shape: LandmarkGeometry, covariance_deg2: Floats, weak: Bools) -> list[str]:
    """Describe the weakest axis of each frame, with the sigmas about it and the two others, (F,).

    The sigmas are those about the principal axes of the covariance, degrees.

    Args:
        shape: the landmark geometry
        covariance_deg2: of small turns, (F, 3, 3)
        weak: the frames to describe, (F,); the text of others is empty
    """
    text = [""] * len(weak)
    frames = np.flatnonzero(weak)
    known = np.asarray(np.isfinite(covariance_deg2[frames]).all(axis=(1, 2)))
    safe = np.where(known[:, None, None], covariance_deg2[frames], 0.0)
    sigma = np.sqrt(np.maximum(np.linalg.eigvalsh(safe), 0.0))
    for k, is_known, s in zip(frames.tolist(), known, sigma, strict=True):
        text[k] = AXES[shape.weak_axis[k]].replace(" ", "_")
        if is_known:
            text[k] += f" sigma {s[2]:.3g} others {s[1]:.3g} {s[0]:.3g}"
    return text


# Second solution, with the landmarks behind the camera.
#
# The collinearity equations do not tell front from back. If all landmarks lay in
# one plane through the camera, the attitude mirrored at that plane and turned to
# look the other way would show the same image. Where they nearly do, there is a
# second attitude with small residuals, and from a poor first estimate the solve
# may end there.
#
# Most frames need no search. Let R turn the unit vectors d of N landmarks to the front of the
# camera, and the second attitude S to its back. The sum of the squared lengths of R d + S d is
# at least four times the smallest eigenvalue of the sum of d d', which is at least
# 4 det / N squared. The residuals of both attitudes together are at least the
# focal length times the root of that.

PASSES = 20
SETTLED = 1e-5  # radians: the residuals are least there, and change by the square of it
ROUNDING = 1e-12  # of the smallest eigenvalue, by the largest


@np.errstate(all="ignore")
def second_solution_rms(estimate: Estimate, at_most: Floats | float = np.inf) -> Floats:
    """Solve for second solutions: root mean square residuals, image units (F,); NaN if none.

    Args:
        estimate: the frames
        at_most: second solutions whose residuals are larger need not be found, (F,) or one
            for all frames
    """
    e = estimate
    known = e.solved & (e.used.sum(axis=1) >= 2)
    first = camera_axes(np.radians(e.camera_deg))
    directions = np.where(e.used[..., None] & known[:, None, None], e.direction, 0.0)
    focal = np.broadcast_to(e.focal_length, known.shape)[:, None]
    sights = Sights(directions, e.image, e.used, focal)
    searched = known & ~(_least_rms(sights, first) > at_most)
    found = np.full(len(known), np.nan)
    found[searched] = _searched(sights.of(searched), first[searched])
    return found


def _least_rms(sights: Sights, first: Floats) -> Floats:
    """Bound the residuals of second solutions from below, (F,); 0 if a landmark is behind."""
    count = sights.used.sum(axis=1)
    product = sights.direction.swapaxes(1, 2) @ sights.direction
    smallest = 4.0 * np.linalg.det(product) / count**2 - ROUNDING * count
    both = np.ravel(sights.focal_length) * np.sqrt(2.0 * np.maximum(smallest, 0.0) / count)
    in_front = ((ahead(first, sights.direction) > 0.0) | ~sights.used).all(axis=1)
    return np.where(in_front, both - _rms(sights, first), 0.0)


def _rms(sights: Sights, axes: Floats) -> Floats:
    residual, _ = sights.equations(axes)
    return np.asarray(np.sqrt((residual**2).sum(axis=1) / (2.0 * sights.used.sum(axis=1))))


def _searched(sights: Sights, first: Floats) -> Floats:
    """Fit second solutions from the attitude mirrored at the landmarks' plane: residuals, (F,)."""
    directions = sights.direction
    normal = eigenvectors(directions.swapaxes(1, 2) @ directions)[:, :, 0]
    mirror = np.eye(3) - 2.0 * normal[:, :, None] * normal[:, None, :]
    axes, turn = fit_rotations(sights, -first @ mirror, PASSES, SETTLED)
    other_side = (ahead(axes, directions) < 0.0) != (ahead(first, directions) < 0.0)
    found = (other_side | ~sights.used).all(axis=1) & (np.abs(turn).max(axis=1) < 1e-3)
    return np.where(found, _rms(sights, axes), np.nan)
