"""Calibration by stars: principal distance, principal point and k1 with the attitude."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.geometry.lenses import distort_brown, field_radius_brown, undistort_brown
from vopd.geometry.linear import angle_between, inverse, transform
from vopd.stellar.field import Failure, StarField, image_points_mm, refuse_other_field
from vopd.stellar.methods.collinearity import image_partials, turned
from vopd.stellar.methods.wahba import wahba_rotation

PARAMETERS = {"focal": ("focal",), "centre": ("centre_x", "centre_y"), "k1": ("k1",)}
"""What can be solved, and the unknowns of each."""

UNKNOWNS = ("focal", "centre_x", "centre_y", "k1")
LIMIT = 50
SETTLED = 1e-11  # converged when no image moves by more than this many principal distances
SINGULAR = 1e-9
"""Ratio of singular values of the design, its columns of length 1, below which it is singular."""


class LensOfStars(NamedTuple):
    """A lens: principal distance, principal point and radial distortion, in image units.

    The image of a direction whose tangents from the axis are u, v (radius r) is
    centre + focal (1 + k1 r**2) (u, v).
    """

    focal: float
    centre_x: float = 0.0
    centre_y: float = 0.0
    k1: float = 0.0


class Calibration(NamedTuple):
    """Attitude and lens of one photograph.

    Attributes:
        failure: `Failure.NONE`, or why there is no solution
        matrix: orientation matrix, (3, 3)
        lens: the lens
        free: the unknowns that were solved
        covariance: of turns about the camera's axes and of the free unknowns, for
            readings good to 1 image unit, (3 + k, 3 + k)
        growth: how many times the free unknowns make the standard deviation of the
            attitude larger
        variance: sum of squares of the residuals over the degrees of freedom
        freedom: degrees of freedom
        iterations: corrections made
    """

    failure: Failure
    matrix: Floats
    lens: LensOfStars
    free: tuple[str, ...]
    covariance: Floats
    growth: float
    variance: float
    freedom: int
    iterations: int


def calibrate(
    field: StarField, start: Floats, free: tuple[str, ...], lens: LensOfStars | None = None
) -> Calibration:
    """Solve attitude and lens by least squares.

    Args:
        field: one problem, its images as they were read, from about the principal point
        start: rotation to start from, (3, 3)
        free: names of UNKNOWNS to solve; the others keep their values
        lens: lens to start from, and values of what is not solved; None: the
            principal distance of the field, no distortion

    Raises:
        VopdError: where it is no field, or there is no such unknown
    """
    refuse_other_field(field, "calibrate")
    if other := [name for name in free if name not in UNKNOWNS]:
        raise VopdError(f"calibrate solves {', '.join(UNKNOWNS)}, and not {other[0]!r}")
    field = field.select(field.used)
    index = [UNKNOWNS.index(name) for name in free]
    values = np.array(lens or LensOfStars(float(field.focal_length_mm[0])))
    matrix = start
    freedom = max(2 * int(field.count) - 3 - len(index), 1)
    for step in range(1, LIMIT + 1):
        computed, design = _computed(field, matrix, values)
        rows = field.whitened(design[..., [0, 1, 2, *(3 + k for k in index)]])
        rows = rows.reshape(-1, 3 + len(index))
        side = field.whitened(field.image_mm - computed).ravel()
        length = np.sqrt((rows**2).sum(axis=0))
        if not np.isfinite(rows).all() or not (length > 0.0).all():
            break
        change, _, rank, _ = np.linalg.lstsq(rows / length, side, rcond=SINGULAR)
        if rank < len(length):
            return _failed(Failure.SINGULAR, matrix, values, free, freedom, step)
        change = change / length
        if np.abs(rows @ change).max() < SETTLED * values[0]:
            if not (transform(matrix, field.directions)[:, 2] < 0.0).all():
                return _failed(Failure.BEHIND_CAMERA, matrix, values, free, freedom, step)
            covariance = inverse(rows.T @ rows)
            fixed = inverse(rows[:, :3].T @ rows[:, :3])
            growth = float(np.sqrt(np.trace(covariance[:3, :3]) / np.trace(fixed)))
            variance = float(side @ side) / freedom
            return Calibration(
                Failure.NONE, matrix, LensOfStars(*values.tolist()), free, covariance,
                growth, variance, freedom, step,
            )  # fmt: skip
        matrix = turned(matrix[None], change[None, :3])[0]
        values = values.copy()
        values[index] += change[3:]
        if not values[0] > 0.0:
            break
    return _failed(Failure.NO_CONVERGENCE, matrix, values, free, freedom, LIMIT)


def calibrate_together(
    fields: Sequence[StarField], starts: Sequence[Calibration], spread: Sequence[float] = ()
) -> list[Calibration] | None:
    """Solve the attitudes of several photographs, and the one lens that took them.

    The attitude of each photograph is eliminated; what is left is a problem of the lens alone.

    Args:
        fields: a problem each, its images as they were read, from about the principal point
        starts: each with a lens of its own; the lens that its photograph holds best begins
        spread: how the reading sigmas of the photographs are to each other; none: alike

    Returns:
        A solution for each photograph, with the same lens; None where it does not converge. Its
        covariance is for readings of the photograph good to 1 image unit.
    """
    free = starts[0].free
    sigmas = np.array(spread or [1.0] * len(fields)) / max(spread, default=1.0)
    index, k = [UNKNOWNS.index(name) for name in free], len(free)
    best = min(starts, key=lambda one: float(np.trace(one.covariance[3:, 3:])))
    values, matrices = np.array(best.lens), [one.matrix for one in starts]
    freedom = max(2 * sum(int(one.count) for one in fields) - 3 * len(fields) - k, 1)
    steps = 0
    while steps < LIMIT:
        steps += 1
        parts, squares = [], 0.0
        for field, matrix, sigma in zip(fields, matrices, sigmas, strict=True):
            computed, design = _computed(field, matrix, values)
            rows = field.whitened(design[..., [0, 1, 2, *(3 + n for n in index)]])
            rows = rows.reshape(-1, 3 + k) / sigma
            side = field.whitened(field.image_mm - computed).ravel() / sigma
            if not np.isfinite(rows).all():
                return None
            q, r = np.linalg.qr(rows[:, :3])
            parts.append((q, r, rows[:, 3:], side))
            squares += float(side @ side)
        reduced = np.concatenate([by_lens - q @ (q.T @ by_lens) for q, _, by_lens, _ in parts])
        left = np.concatenate([side - q @ (q.T @ side) for q, _, _, side in parts])
        length = np.sqrt((reduced**2).sum(axis=0))
        if not (length > 0.0).all():
            return None
        scaled, _, rank, _ = np.linalg.lstsq(reduced / length, left, rcond=SINGULAR)
        if rank < k:
            return None
        change = scaled / length
        turns = [np.linalg.solve(r, q.T @ (s - by @ change)) for q, r, by, s in parts]
        moved = max(
            float(np.abs(q @ (r @ turn) + by @ change).max())
            for (q, r, by, _), turn in zip(parts, turns, strict=True)
        )
        if moved < SETTLED * values[0]:
            break
        matrices = [turned(m[None], t[None])[0] for m, t in zip(matrices, turns, strict=True)]
        values = values.copy()
        values[index] += change
        if not values[0] > 0.0:
            return None
    else:
        return None
    of_lens, found = inverse(reduced.T @ reduced), []
    for (q, r, by, _), field, matrix, sigma in zip(parts, fields, matrices, sigmas, strict=True):
        if not (transform(matrix, field.directions)[:, 2] < 0.0).all():
            return None
        alone, gain = inverse(r.T @ r), np.linalg.solve(r, q.T @ by)
        turn = alone + gain @ of_lens @ gain.T
        covariance = np.block([[turn, -gain @ of_lens], [-of_lens @ gain.T, of_lens]])
        growth = float(np.sqrt(np.trace(turn) / np.trace(alone)))
        found.append(
            Calibration(
                Failure.NONE, matrix, LensOfStars(*values.tolist()), free, covariance / sigma**2,
                growth, squares / freedom * sigma**2, freedom, steps,
            )
        )  # fmt: skip
    return found


@np.errstate(all="ignore")
def least_square(field: StarField, matrix: Floats) -> Floats:
    """Estimate how small attitude and lens together can make the sum of squares of the residuals.

    It is linear: from the derivatives at the stated lens, for residuals that are small.

    Args:
        field: the problems, stack (...)
        matrix: their attitudes with the stated lens, (..., 3, 3)

    Returns:
        (...); 0 where attitude and lens have as many unknowns as there are coordinates.
    """
    stack, count = field.used.shape[:-1], field.used.shape[-1]
    focal = field.focal_length_mm[..., None, None]
    tangents = image_points_mm(transform(matrix, field.directions), np.ones(1))
    square = (tangents**2).sum(axis=-1)[..., None, None]
    by_centre = np.broadcast_to(np.eye(2), (*tangents.shape, 2))
    by_turns = focal * image_partials(tangents, np.ones(1))
    by_lens = tangents[..., None], by_centre, focal * square * tangents[..., None]
    design = np.concatenate([by_turns, *by_lens], axis=-1)
    rows = field.whitened(design).reshape(*stack, 2 * count, -1)
    side = field.whitened(field.image_mm - focal[..., 0] * tangents).reshape(*stack, 2 * count)
    length = np.sqrt((rows**2).sum(axis=-2))
    unknown = ~(np.isfinite(rows).all(axis=(-2, -1)) & (length > 0.0).all(axis=-1))
    if rows.shape[-2] <= rows.shape[-1]:
        return np.zeros(stack)
    columns, _ = np.linalg.qr(np.where(unknown[..., None, None], 0.0, rows / length[..., None, :]))
    explained = np.einsum("...r,...rk->...k", side, columns)
    left = (side**2).sum(axis=-1) - (explained**2).sum(axis=-1)
    return np.where(unknown, 0.0, left)


@np.errstate(all="ignore")
def without_lens(image: Floats, lens: LensOfStars) -> Floats:
    """Remove the lens from images, (n, 2); NaN outside the lens's field."""
    x, y = ((image - [lens.centre_x, lens.centre_y]) / lens.focal).T
    if lens.k1:
        x, y = undistort_brown(_brown(lens.k1), x, y)
    return np.asarray(lens.focal * np.column_stack([x, y]))


def with_lens(image: Floats, lens: LensOfStars) -> Floats:
    """Put images without the lens, (n, 2), where it shows them; NaN outside the lens's field."""
    k, tangents = _brown(lens.k1), image / lens.focal
    shown = lens.focal * np.column_stack(distort_brown(k, *tangents.T)[0])
    inside = np.hypot(*tangents.T) <= field_radius_brown(k)
    return np.where(inside[:, None], np.array([lens.centre_x, lens.centre_y]) + shown, np.nan)


@np.errstate(all="ignore")
def _computed(field: StarField, matrix: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Project a problem's stars, (n, 2), and differentiate their images, (n, 2, 7)."""
    tangents = image_points_mm(transform(matrix, field.directions), 1.0)
    return differentiated_images(tangents, values)


def differentiated_images(tangents: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Project directions to images, and differentiate these by turns, focal, centre and k1.

    Args:
        tangents: of the directions from the optical axis, (n, 2)
        values: of UNKNOWNS

    Returns:
        Images, (n, 2), and derivatives, (n, 2, 7), in image units.
    """
    focal, centre, k1 = values[0], values[1:3], values[3]
    (x, y), by_tangents = distort_brown(_brown(k1), *tangents.T)
    distorted = np.column_stack([x, y])
    square = (tangents**2).sum(axis=1, keepdims=True)
    count = len(tangents)
    design = np.concatenate(
        [
            focal * by_tangents @ image_partials(tangents, np.ones(1)),
            distorted[..., None],
            np.broadcast_to(np.eye(2), (count, 2, 2)),
            (focal * square * tangents)[..., None],
        ],
        axis=-1,
    )
    return centre + focal * distorted, design


def _brown(k1: float) -> Floats:
    """List the coefficients of Brown's lens with k1 alone."""
    return np.array([k1, *[0.0] * 11])


def _failed(
    failure: Failure, matrix: Floats, values: Floats, free: tuple[str, ...], freedom: int, step: int
) -> Calibration:
    unknown = np.full((3 + len(free),) * 2, np.nan)
    lens = LensOfStars(*values.tolist())
    return Calibration(failure, matrix, lens, free, unknown, np.nan, np.nan, freedom, step)


# Starts far from the stated camera

FARTHEST_COSINE = 0.1
"""Cosine of the largest angle from the stars' mean direction from which a start is estimated."""


def calibrate_from_both_starts(
    field: StarField, free: tuple[str, ...], k1: float = 0.0
) -> Calibration:
    """Solve attitude and lens, from the stated lens and from one estimated from the images.

    Args:
        field: one problem, its images as they were read
        free: names of UNKNOWNS to solve; the others keep their values
        k1: of the lens to start from

    Returns:
        The solution with the smaller residuals; where there is none, that from the
        stated lens with its failure.
    """
    lens = LensOfStars(float(field.focal_length_mm[0]), k1=k1)
    stated = calibrate(field, wahba_rotation(field)[0], free, lens)
    estimated = estimated_start(field, free)
    tried = [stated]
    if estimated is not None:
        matrix, lens = estimated
        tried.append(calibrate(field, matrix, free, lens._replace(k1=k1)))
    solved = [one for one in tried if one.failure == Failure.NONE]
    return min(solved, key=lambda one: one.variance, default=stated)


def estimated_start(field: StarField, free: tuple[str, ...]) -> tuple[Floats, LensOfStars] | None:
    """Estimate principal point and distance from the images: their mean and their spread.

    Args:
        field: one problem
        free: names of UNKNOWNS; only these are estimated

    Returns:
        A rotation, (3, 3), and a lens; None if the stars lie too far apart for an estimate.
    """
    focal = float(field.focal_length_mm[0])
    centre = field.image_mm.mean(axis=0) if "centre_x" in free else np.zeros(2)
    if "focal" in free:
        mean = field.directions.mean(axis=0)
        along = field.directions @ (mean / np.linalg.norm(mean))
        if along.min() < FARTHEST_COSINE:
            return None
        tangents = field.directions / along[:, None]
        focal = _spread(field.image_mm) / _spread(tangents)
    moved = replace(
        field,
        image_mm=field.image_mm - centre,
        focal_length_mm=np.full_like(field.focal_length_mm, focal),
    )
    matrix, _ = wahba_rotation(moved)
    return matrix, LensOfStars(focal, *centre.tolist())


def _spread(points: Floats) -> float:
    """Measure the root mean square distance of points from their mean."""
    return float(np.sqrt(points.var(axis=0).sum()))


# A principal distance to begin with, where none is stated

PAIRED_STARS = 60  # of a photograph: more pairs tell no more
TRIED = 0.05, 200.0, 400  # radii of the outermost star, least and largest, and how many between


def focal_by_pairs(points: Floats, directions: Floats) -> float:
    """Estimate the principal distance from the angles between the stars, without an attitude.

    Of many principal distances the one is taken with which the median pair of images is
    nearest to its stars' angle: it begins a solve, in which it is free.

    Args:
        points: images from the principal point, (n, 2), without distortion
        directions: unit vectors to the stars, (n, 3)
    """
    points, directions = points[:PAIRED_STARS], directions[:PAIRED_STARS]
    low, high, count = TRIED
    first, second = np.triu_indices(len(points), 1)
    true = angle_between(directions[first], directions[second])
    tried = np.geomspace(low, high, count) * max(float(np.linalg.norm(points, axis=1).max()), 1e-9)
    off = []
    for focal in tried:
        rays = np.column_stack([points, np.full(len(points), -focal)])
        off.append(np.median(np.abs(angle_between(rays[first], rays[second]) - true)))
    return float(tried[int(np.argmin(off))])
