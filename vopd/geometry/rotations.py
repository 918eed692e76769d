"""Rotations: yaw, pitch and roll, camera axes, mounts, rotation vectors, quaternions."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Floats
from vopd.geometry.linear import pseudo_inverse

# Yaw, pitch and roll of body axes (forward, right, down) in local north, east, down

POLE = 1e-12  # cosine of pitch, at and below which roll is set to 0
STEEP = 1e-4
"""Cosine of pitch below which roll is what yaw leaves of the turn: the elements of which each comes
by itself are so small that their rounding turns them apart."""
LARGEST_DEG = 360.001
"""Angles are kept within a full circle, but for rounding; one beyond this is out of range."""


def body_angles_deg(body_to_ned: Floats) -> Floats:
    """Resolve body axes into yaw 0 to 360, pitch -90 to 90, roll 0 to 360 degrees, (..., 3).

    Yaw turns about down, pitch about the new right, roll about the new forward axis.
    Where forward is straight up or down only yaw and roll together are defined:
    roll is 0 there.

    Args:
        body_to_ned: forward, right and down as columns in north, east, down, (..., 3, 3)
    """
    m = body_to_ned
    flat = np.hypot(m[..., 0, 0], m[..., 1, 0])
    level = flat > POLE
    steep = level & (flat < STEEP)
    pitch = -np.arcsin(np.clip(m[..., 2, 0], -1.0, 1.0))
    pitch = np.where(steep, -np.arctan2(m[..., 2, 0], flat), pitch)
    straight = np.arctan2(-m[..., 0, 1], m[..., 1, 1])
    yaw = np.where(level, np.arctan2(m[..., 1, 0], m[..., 0, 0]), straight)
    s, c = np.sin(yaw), np.cos(yaw)
    left = np.arctan2(s * m[..., 0, 2] - c * m[..., 1, 2], c * m[..., 1, 1] - s * m[..., 0, 1])
    roll = np.where(steep, left, np.arctan2(m[..., 2, 1], m[..., 2, 2]))
    roll = np.where(level, roll, 0.0 * pitch)
    turn = 2.0 * np.pi
    yaw, roll = (one % turn % turn for one in (yaw, roll))  # of -1e-17 the first is a whole turn
    angles = np.stack([yaw, pitch, roll], axis=-1)
    return np.asarray(np.degrees(angles))


def body_axes(radians: Floats) -> Floats:
    """Turn yaw, pitch, roll into forward, right, down as columns in north, east, down, (F, 3, 3).

    Args:
        radians: yaw, pitch, roll, (F, 3)
    """
    (s1, s2, s3), (c1, c2, c3) = np.sin(radians).T, np.cos(radians).T
    forward = np.stack([c1 * c2, s1 * c2, -s2], axis=-1)
    right = np.stack([c1 * s2 * s3 - s1 * c3, s1 * s2 * s3 + c1 * c3, c2 * s3], axis=-1)
    down = np.stack([c1 * s2 * c3 + s1 * s3, s1 * s2 * c3 - c1 * s3, c2 * c3], axis=-1)
    return np.stack([forward, right, down], axis=-1)


def turns_by_body_angles(radians: Floats) -> Floats:
    """Differentiate rotations about forward, right, down by yaw, pitch, roll, (F, 3, 3).

    Args:
        radians: yaw, pitch, roll, (F, 3)

    Returns:
        Derivatives, (F, 3, 3): rows are the rotations, columns the angles.
    """
    (_, s2, s3), (_, c2, c3) = np.sin(radians).T, np.cos(radians).T
    zero, one = np.zeros_like(s2), np.ones_like(s2)
    yaw = np.stack([-s2, s3 * c2, c3 * c2], axis=-1)
    pitch = np.stack([zero, c3, -s3], axis=-1)
    roll = np.stack([one, zero, zero], axis=-1)
    return np.stack([yaw, pitch, roll], axis=-1)


def body_angles_by_turns(radians: Floats) -> Floats:
    """Differentiate yaw, pitch, roll by small rotations about forward, right, down.

    At a pitch of 90 degrees yaw and roll turn about the same axis: the derivatives
    are then those of least length.

    Args:
        radians: yaw, pitch, roll, (F, 3)

    Returns:
        Derivatives, (F, 3, 3): rows are the angles, columns the rotations.
    """
    return pseudo_inverse(turns_by_body_angles(radians))


# The camera's axes in local east, north, up, and its yaw, pitch and roll (Appendix A)
#
# Yaw is the direction of the optical axis clockwise from north, pitch its angle above
# the horizontal, roll the turn of the picture about it (sigma 1, 2, 3 of TM X-3050): those of a
# body whose forward axis is the optical one, and whose right and down are the picture's.


def camera_axes(radians: Floats) -> Floats:
    """Turn camera yaw, pitch, roll into image x, image y, optical axis as rows, (F, 3, 3).

    The axes are resolved in east, north, up.

    Args:
        radians: camera yaw, pitch, roll, (F, 3)
    """
    return _other_order(body_axes(radians).swapaxes(1, 2), [1, 2, 0], [-1.0, -1.0, 1.0])


def _other_order(rows: Floats, order: list[int], signs: list[float]) -> Floats:
    """Take body axes for image axes or back, as rows, and north, east, down for east, north, up."""
    return np.asarray(rows[..., order, :][..., [1, 0, 2]] * np.outer(signs, [1.0, 1.0, -1.0]))


def camera_angles_deg(axes: Floats) -> Floats:
    """Resolve camera axes into yaw 0 to 360, pitch -90 to 90, roll 0 to 360 degrees, (..., 3).

    Where the camera looks straight up or down only yaw and roll together are
    defined: roll is 0 there.

    Args:
        axes: image x, image y and optical axis as rows, (..., 3, 3), east, north, up
    """
    body = _other_order(axes, [2, 0, 1], [1.0, -1.0, -1.0])
    return body_angles_deg(body.swapaxes(-1, -2))


def turns_by_angles(radians: Floats) -> Floats:
    """Differentiate rotations about the camera's axes by yaw, pitch, roll, (F, 3, 3).

    Yaw turns about down, pitch about the level axis and roll about the optical axis.

    Args:
        radians: camera yaw, pitch, roll, (F, 3)

    Returns:
        Derivatives, (F, 3, 3): rows are the rotations, columns the angles.
    """
    return np.asarray(
        turns_by_body_angles(radians)[:, [1, 2, 0]] * np.array([[-1.0], [-1.0], [1.0]])
    )


def angles_by_turns(radians: Floats) -> Floats:
    """Differentiate yaw, pitch, roll by small rotations about the camera's axes.

    At a pitch of 90 degrees yaw and roll turn about the same axis: the derivatives
    are then those of least length.

    Args:
        radians: camera yaw, pitch, roll, (F, 3)

    Returns:
        Derivatives, (F, 3, 3): rows are the angles, columns the rotations.
    """
    return pseudo_inverse(turns_by_angles(radians))


def ahead(axes: Floats, direction: Floats) -> Floats:
    """Project landmarks on the optical axis: cosine of the angle, negative behind the camera.

    Args:
        axes: image x, image y and optical axis as rows, (..., 3, 3)
        direction: unit vectors to the landmarks in the same frame, (..., L, 3)

    Returns:
        Cosines, (..., L).
    """
    return np.asarray((axes[..., 2, None, :] * direction).sum(axis=-1))


# Axes of images by those of the camera, which are right, down in the picture and forward

IMAGE_FROM_CAMERA = np.diag([-1.0, -1.0, 1.0])
"""Left, up in the picture and forward, as `camera_axes` has them."""

PHOTOGRAPH_FROM_CAMERA = np.diag([1.0, -1.0, -1.0])
"""Right, up in the picture and backward, as photogrammetry and star photographs have them."""


# How a camera is mounted in a vehicle: rotations from camera axes to body axes
#
# Camera axes: x right, y down, z forward. Body axes: x forward, y right, z down.

FORWARD = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""The camera looks forward, its picture upright."""

DOWN = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""The camera looks down, the top of its picture forward."""


def mount_by_angles(yaw_pitch_roll_deg: ArrayLike) -> Floats:
    """Turn a camera from FORWARD by yaw, pitch and roll: its mount, (3, 3).

    Args:
        yaw_pitch_roll_deg: about down, the new right and the new forward axis, (3,), degrees
    """
    return np.asarray(body_axes(np.radians(np.asarray(yaw_pitch_roll_deg))[None])[0] @ FORWARD)


# Rotations by their vector: the axis times the angle in radians

SMALL_RAD = 1e-3  # below it the series of the sine is exact to the last bit


@np.errstate(all="ignore")
def rotation_matrices(vector: Floats) -> Floats:
    """Convert rotation vectors to matrices, (B, 3, 3), right-handed, as scipy's `Rotation` does.

    They go through the quaternion. To import scipy's takes a tenth of a second.

    Args:
        vector: axis times angle, radians, (B, 3)
    """
    square = vector[:, 0] * vector[:, 0] + vector[:, 1] * vector[:, 1] + vector[:, 2] * vector[:, 2]
    angle = np.sqrt(square)
    series = 0.5 - square / 48.0 + square * square / 3840.0
    x, y, z = (
        vector * np.where(angle <= SMALL_RAD, series, np.sin(angle / 2.0) / angle)[:, None]
    ).T
    w = np.cos(angle / 2.0)
    x2, y2, z2, w2 = x * x, y * y, z * z, w * w
    xy, xz, yz, xw, yw, zw = x * y, x * z, y * z, x * w, y * w, z * w
    matrix = np.empty((len(vector), 3, 3))
    matrix[:, 0, 0], matrix[:, 1, 1] = x2 - y2 - z2 + w2, -x2 + y2 - z2 + w2
    matrix[:, 2, 2] = -x2 - y2 + z2 + w2
    matrix[:, 1, 0], matrix[:, 0, 1] = 2.0 * (xy + zw), 2.0 * (xy - zw)
    matrix[:, 2, 0], matrix[:, 0, 2] = 2.0 * (xz - yw), 2.0 * (xz + yw)
    matrix[:, 2, 1], matrix[:, 1, 2] = 2.0 * (yz + xw), 2.0 * (yz - xw)
    return matrix


def rotation_vectors(matrices: Floats) -> Floats:
    """Convert rotations to vectors, axis times angle, (B, 3) radians, up to half a turn.

    Args:
        matrices: (B, 3, 3)
    """
    return _vectors(from_axes(matrices.swapaxes(1, 2)))


@np.errstate(all="ignore")
def _vectors(quaternion: Floats) -> Floats:
    """Convert quaternions to rotation vectors, (B, 3) radians."""
    vector = quaternion[:, 1:]
    size = np.linalg.norm(vector, axis=1)
    angle = 2.0 * np.arctan2(size, quaternion[:, 0])
    return np.asarray(np.where(size > 0.0, angle / size, 0.0)[:, None] * vector)


# Rotations by singular values


def nearest_rotation(matrix: Floats) -> tuple[Floats, Floats]:
    """Find the rotations whose elements differ least from those of matrices in sum of squares.

    Args:
        matrix: (..., 3, 3)

    Returns:
        The rotations, (..., 3, 3), NaN where a matrix is not finite; and the singular
        values, (..., 3), largest first, the third with the sign of the determinant. If
        the second and the third cancel, the rotation about one axis is not determined.

    Source: F. L. Markley, Attitude determination using vector observations and
    the singular value decomposition, J. Astronautical Sciences 36 (1988).
    """
    finite = np.isfinite(matrix).all(axis=(-2, -1), keepdims=True)
    left, sizes, right = np.linalg.svd(np.where(finite, matrix, 0.0))
    sign = np.sign(np.linalg.det(left) * np.linalg.det(right))
    signs = np.stack([np.ones_like(sign), np.ones_like(sign), sign], axis=-1)
    return np.where(finite, left * signs[..., None, :] @ right, np.nan), signs * sizes


def rotation_of_directions(
    ray: Floats, direction: Floats, weight: Floats | None = None
) -> tuple[Floats, Floats]:
    """Find the rotations that bring directions closest to rays (Wahba's problem).

    They make the sum of weight ``|ray - R direction|**2`` least. No estimate is needed.

    Args:
        ray: unit vectors, (..., n, 3)
        direction: unit vectors in other axes, (..., n, 3)
        weight: of each, (..., n); None: all alike

    Returns:
        Rotations and singular values of the sum of weight ray direction', as
        `nearest_rotation` gives them.
    """
    weighted = ray if weight is None else weight[..., None] * ray
    return nearest_rotation(weighted.swapaxes(-1, -2) @ direction)


# Derivatives of image coordinates with respect to small rotations of the directions seen


def partials_by_turns(x: Floats, y: Floats, distance: ArrayLike) -> Floats:
    """Differentiate image x and y by small right-handed rotations of the direction.

    The image of a direction p, q, r in camera axes is distance * (p/r, q/r). Turning
    the camera instead of the direction changes the sign.

    Args:
        x: p/r, (...)
        y: q/r, (...)
        distance: principal distance in image units, broadcast to (...); negative
            where the image lies behind the lens

    Returns:
        (..., 2, 3): image x and y, by turns in radians about the camera's x, y, z axes
    """
    rows = np.empty((*np.shape(x), 2, 3))
    rows[..., 0, 0], rows[..., 0, 1], rows[..., 0, 2] = -x * y, 1.0 + x * x, -y
    rows[..., 1, 0], rows[..., 1, 1], rows[..., 1, 2] = -(1.0 + y * y), x * y, x
    return np.asarray(np.asarray(distance)[..., None, None] * rows)


# Quaternions of attitudes: scalar first, Hamilton's product, scalar part 0 or more
#
# The quaternion of frame A to frame B is that of the rotation which carries A's axes
# into B's: cosine of half the angle, and the sine times the axis. A vector's
# components in A are q (0, components in B) q*. An attitude that is not known is NaN.


@np.errstate(all="ignore")
def from_yaw_pitch_roll(angles_deg: Floats) -> Floats:
    """Convert yaw, pitch, roll to quaternions of north-east-down to body, (F, 4) w x y z.

    Args:
        angles_deg: yaw, pitch, roll, (F, 3): first about down, then about the new
            right, then about the new forward axis
    """
    half = np.radians(angles_deg) / 2.0
    (sy, sp, sr), (cy, cp, cr) = np.sin(half).T, np.cos(half).T
    return _normal(
        [
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        ]
    )


def from_axes(axes: Floats) -> Floats:
    """Convert axes to quaternions of frame A to frame B, (F, 4) w x y z.

    The largest of its four parts is found first, and the others by it.

    Args:
        axes: B's axes in components of A, as rows, (F, 3, 3)
    """
    (a, b, c), (d, e, f), (g, h, i) = np.moveaxis(axes.swapaxes(1, 2), 0, -1)
    trace = a + e + i
    by_each = np.array(
        [
            [1.0 + trace, h - f, c - g, d - b],
            [h - f, 1.0 + 2.0 * a - trace, b + d, c + g],
            [c - g, b + d, 1.0 + 2.0 * e - trace, f + h],
            [d - b, c + g, f + h, 1.0 + 2.0 * i - trace],
        ]
    )
    largest = np.argmax([trace, a, e, i], axis=0)
    return _normal(by_each[largest, :, np.arange(len(axes))].T)


def product(one: Floats, other: Floats) -> Floats:
    """Multiply two quaternions: from A to B, then from B to C, (F, 4) w x y z.

    Args:
        one: A to B, (F, 4)
        other: B to C, (F, 4)
    """
    (a, b, c, d), (w, x, y, z) = one.T, other.T
    return _normal(
        [
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ]
    )


def angle_between_deg(one: Floats, other: Floats) -> Floats:
    """Measure the angle of rotation from one attitude to another, 0 to 180 degrees, (F,).

    Args:
        one: quaternions, (F, 4)
        other: quaternions of the same two frames, (F, 4)
    """
    return np.asarray(np.linalg.norm(rotation_vectors_deg(one, other), axis=1))


def rotation_vectors_deg(one: Floats, other: Floats) -> Floats:
    """Find the rotations from one attitude to another, about the axes of either, (F, 3) degrees.

    Args:
        one: quaternions, (F, 4)
        other: quaternions of the same two frames, (F, 4)
    """
    return np.degrees(_vectors(product(one * [1.0, -1.0, -1.0, -1.0], other)))


@np.errstate(all="ignore")
def _normal(parts: Sequence[Floats] | Floats) -> Floats:
    """Scale four parts to unit quaternions (F, 4), scalar part not negative; NaN if not known."""
    found = np.stack(list(parts), axis=-1)
    found = found / np.linalg.norm(found, axis=1, keepdims=True)
    known = np.isfinite(found).all(axis=1, keepdims=True)
    return np.where(known, np.where(found[:, :1] < 0.0, -found, found) + 0.0, np.nan)
