"""Space resection: position and attitude of a camera from the images of ground points."""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Floats
from vopd.findings import VopdError, numbers
from vopd.geometry.linear import inverse
from vopd.geometry.rotations import rotation_of_directions
from vopd.stellar.field import Failure, StarField, image_directions, image_points_mm
from vopd.stellar.methods.collinearity import image_partials, turned

# Three points (Grunert's solution)

NOTHING = 1e-14
"""What is left of the terms of a quartic, relative to their sum, up to which it counts as 0."""


def three_point_resection(points: Floats, rays: Floats) -> list[tuple[Floats, Floats]]:
    """Find all positions and attitudes from which three points are seen along three rays.

    Args:
        points: coordinates of the points, (3, 3)
        rays: unit vectors to them in camera axes, (3, 3)

    Returns:
        Up to four pairs of orientation matrix (3, 3) and position (3,).

    Source: R. M. Haralick, C. Lee, K. Ottenberg and M. Noelle, Review and analysis of
    solutions of the three point perspective pose estimation problem, Int. J. Computer
    Vision 13 (1994), Grunert's solution.
    """
    a2, b2, c2 = (((points[i] - points[j]) ** 2).sum() for i, j in ((1, 2), (0, 2), (0, 1)))
    if not min(a2, b2, c2) > 0.0:
        return []
    alpha, beta, gamma = (float(rays[i] @ rays[j]) for i, j in ((1, 2), (0, 2), (0, 1)))
    seen = []
    for v in _ratios(a2 / b2, c2 / b2, alpha, beta, gamma):
        difference = (a2 - c2) / b2
        below = 2.0 * (gamma - v * alpha)
        above = (difference - 1.0) * v**2 - 2.0 * difference * beta * v + 1.0 + difference
        square = 1.0 + v**2 - 2.0 * v * beta
        if below == 0.0 or not square > 0.0 or not above / below > 0.0:
            continue
        first = np.sqrt(b2 / square)
        seen.append(rays * (first * np.array([1.0, above / below, v]))[:, None])
    return _placed(points, np.array(seen)) if seen else []


def _ratios(a: float, c: float, alpha: float, beta: float, gamma: float) -> list[float]:
    """Solve Grunert's quartic for the ratios of the third distance to the first.

    Args:
        a: square of side 2 3 over that of side 1 3
        c: square of side 1 2 over that of side 1 3
        alpha: cosine of the angle between rays 2 and 3
        beta: between 1 and 3
        gamma: between 1 and 2
    """
    d, s = a - c, a + c
    quartic = [
        (d - 1.0) ** 2 - 4.0 * c * alpha**2,
        4.0 * (d * (1.0 - d) * beta - (1.0 - s) * alpha * gamma + 2.0 * c * alpha**2 * beta),
        2.0
        * (
            d**2 - 1.0 + 2.0 * d**2 * beta**2 + 2.0 * (1.0 - c) * alpha**2
            - 4.0 * s * alpha * beta * gamma + 2.0 * (1.0 - a) * gamma**2
        ),
        4.0 * (-d * (1.0 + d) * beta + 2.0 * a * gamma**2 * beta - (1.0 - s) * alpha * gamma),
        (1.0 + d) ** 2 - 4.0 * a * gamma**2,
    ]  # fmt: skip
    if not np.isfinite(quartic).all() or not np.any(quartic):
        return []
    roots = np.roots(quartic)
    # rounding parts a double root into two complex ones, of which the real part is as good a root
    left = np.abs(np.polyval(quartic, roots.real))
    terms = np.polyval(np.abs(quartic), np.abs(roots.real))
    real = (roots.imag == 0.0) | (left <= NOTHING * terms)
    return [float(root) for root in roots.real[real] if root > 0.0]


def _placed(points: Floats, seen: Floats) -> list[tuple[Floats, Floats]]:
    """Find attitudes and positions that bring points (3, 3) to camera coordinates (n, 3, 3)."""
    middle, centre = points.mean(axis=0), seen.mean(axis=1, keepdims=True)
    matrices, _ = rotation_of_directions(seen - centre, points - middle)
    return [(one, middle - one.T @ place[0]) for one, place in zip(matrices, centre, strict=True)]


# Four points or more, by least squares

LEAST = 4  # fewest points: three have up to four solutions
SPREAD = 6  # number of points, far from each other, whose triples give the first estimates
TRIED = 4  # how many first estimates are corrected to convergence
LIMIT = 50
SETTLED = 1e-11  # converged when no image moves by more than this many principal distances
DISTINCT = 1e-3
"""Distance of two positions, in distances to the points, above which they are two solutions."""

AS_GOOD = 4.0  # ratio of sums of squares up to which a second solution fits as well as the best


class Resection(NamedTuple):
    """Position and attitude of a camera.

    Attributes:
        failure: `Failure.NONE`, or why there is no solution
        matrix: orientation matrix, (3, 3)
        position: of the camera, (3,), in the unit of the points
        residuals: observed minus computed, (n, 2), image units
        covariance: of turns about the camera's axes and of the position, (6, 6), for
            readings good to 1 image unit
        iterations: corrections made
        second: another position from which the points look nearly the same; None: there is none
    """

    failure: Failure
    matrix: Floats
    position: Floats
    residuals: Floats
    covariance: Floats
    iterations: int
    second: Floats | None = None


def resection(
    points: ArrayLike, image: ArrayLike, focal: float, errors: Floats | None = None
) -> Resection:
    """Solve the collinearity equations for position and attitude together.

    The first estimates are the three-point solutions of points far apart; those
    that fit best are corrected by least squares, and the best of them is taken.

    Args:
        points: their coordinates, (n, 3), n 4 or more
        image: x, y from the principal point, (n, 2)
        focal: principal distance, in the same unit
        errors: covariance matrices of x and y for a reading sigma of 1, (n, 2, 2); None: alike

    Raises:
        VopdError: where points or images are no numbers, or not as many, the principal distance
            is not positive, or errors are no covariance matrices

    Source: Rae (1987), eq. 2.1, recommendation 5.
    """
    place, seen = numbers(points, "points"), numbers(image, "image")
    if place.shape[1:] != (3,) or seen.shape != (len(place), 2):
        raise VopdError(
            f"points must be (n, 3) and images (n, 2), not {place.shape} and {seen.shape}"
        )
    errors = StarField.of(place, seen, focal, errors=errors).errors
    whiten = np.broadcast_to(np.eye(2), (len(place), 2, 2))
    if errors is not None:
        whiten = np.linalg.inv(np.linalg.cholesky(errors))
    corrected = [
        _corrected(start, place, seen, focal, whiten)
        for start in _first_estimates(place, seen, focal, whiten)
    ]
    solved = sorted(
        (one for one in corrected if one.failure == Failure.NONE),
        key=lambda one: _square(one, whiten),
    )
    if not solved:
        return corrected[0] if corrected else _unsolved(len(place), Failure.SINGULAR)
    best = solved[0]
    reach = DISTINCT * float(np.linalg.norm(place - best.position, axis=1).mean())
    for other in solved[1:]:
        apart = np.linalg.norm(other.position - best.position) > reach
        if apart and _square(other, whiten) <= AS_GOOD * _square(best, whiten):
            return best._replace(second=other.position)
    return best


def _first_estimates(
    points: Floats, image: Floats, focal: float, whiten: Floats
) -> list[tuple[Floats, Floats]]:
    """Find three-point solutions with all points in front, those that fit best first."""
    rays = image_directions(image, focal)
    triples = [list(triple) for triple in combinations(_far_apart(image), 3)]
    found = [one for index in triples for one in three_point_resection(points[index], rays[index])]
    if not found:
        return []
    matrices, positions = (np.array(column) for column in zip(*found, strict=True))
    camera = (points - positions[:, None]) @ matrices.swapaxes(1, 2)
    in_front = (np.isfinite(camera).all(axis=2) & (camera[..., 2] < 0.0)).all(axis=1)
    off = np.einsum("nij,knj->kni", whiten, image - image_points_mm(camera[in_front], focal))
    best_first = np.argsort((off**2).sum(axis=(1, 2)), kind="stable")
    return _distinct([found[k] for k in np.flatnonzero(in_front)[best_first]], points)


def _distinct(found: list[tuple[Floats, Floats]], points: Floats) -> list[tuple[Floats, Floats]]:
    """Keep the first of all estimates that are near to each other, until there are enough."""
    kept: list[tuple[Floats, Floats]] = []
    for one in found:
        reach = 0.1 * np.linalg.norm(points - one[1], axis=1).mean()
        if all(np.linalg.norm(one[1] - other[1]) > reach for other in kept):
            kept.append(one)
        if len(kept) == TRIED:
            break
    return kept


def _far_apart(image: Floats) -> list[int]:
    """Choose some images far from each other: each the farthest from those before."""
    chosen = [int(np.argmax(((image - image.mean(axis=0)) ** 2).sum(axis=1)))]
    distance = np.full(len(image), np.inf)
    while len(chosen) < min(SPREAD, len(image)):
        distance = np.minimum(distance, ((image - image[chosen[-1]]) ** 2).sum(axis=1))
        chosen.append(int(np.argmax(distance)))
    return chosen


@np.errstate(all="ignore")
def _corrected(
    start: tuple[Floats, Floats], points: Floats, image: Floats, focal: float, whiten: Floats
) -> Resection:
    """Correct a first estimate by least squares until no image moves."""
    matrix, position = start
    for step in range(1, LIMIT + 1):
        camera = (points - position) @ matrix.T
        scale = float(np.linalg.norm(camera, axis=1).mean())
        computed = image_points_mm(camera, focal)
        residuals = image - computed
        design = np.concatenate(
            [
                image_partials(computed, np.array([focal])),
                -_by_vector(camera, focal) @ matrix * scale,
            ],
            axis=-1,
        )
        rows = (whiten @ design).reshape(-1, 6)
        if not np.isfinite(rows).all():
            break
        side = np.einsum("nij,nj->ni", whiten, residuals).ravel()
        change, _, rank, _ = np.linalg.lstsq(rows, side, rcond=1e-10)
        if rank < 6:
            return _unsolved(len(points), Failure.SINGULAR)
        if np.abs(design @ change).max() < SETTLED * focal:
            if (camera[:, 2] >= 0.0).any():
                return _unsolved(len(points), Failure.BEHIND_CAMERA)
            units = np.diag([1.0] * 3 + [scale] * 3)
            covariance = units @ inverse(rows.T @ rows) @ units
            return Resection(Failure.NONE, matrix, position, residuals, covariance, step)
        matrix = turned(matrix[None], change[None, :3])[0]
        position = position + scale * change[3:]
    return _unsolved(len(points), Failure.NO_CONVERGENCE)


def _by_vector(camera: Floats, focal: float) -> Floats:
    """Differentiate image x and y by a vector in camera axes, (n, 2, 3)."""
    x, y, z = camera.T
    by = np.zeros((len(camera), 2, 3))
    by[:, 0, 0], by[:, 0, 2] = 1.0 / z, -x / z**2
    by[:, 1, 1], by[:, 1, 2] = 1.0 / z, -y / z**2
    return -focal * by


def _square(one: Resection, whiten: Floats) -> float:
    return float((np.einsum("nij,nj->ni", whiten, one.residuals) ** 2).sum())


def _unsolved(count: int, failure: Failure) -> Resection:
    nan = np.nan
    return Resection(
        failure,
        np.full((3, 3), nan),
        np.full(3, nan),
        np.full((count, 2), nan),
        np.full((6, 6), nan),
        0,
    )
