"""Angles between stars, which do not depend on the attitude: pairs, disagreement, reading error.

The angle between two stars and the angle between their images are the same,
wherever the camera points. Their difference therefore tests the readings and
the identification of the stars before any attitude is known.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.geometry.linear import ARCSEC_PER_RADIAN, angle_between, dot, norm
from vopd.stellar.field import StarField, refuse_other_field

MOST_PARTNERS = 40  # with how many others a star is compared to estimate the reading error
NORMAL_MEDIAN = 0.6744897501960817  # median size of a normal error of standard deviation 1


def star_pairs(count: int) -> Ints:
    """List all pairs of stars, counted from 0, in the report's order.

    Args:
        count: the number of stars

    Returns:
        1,2 1,3 ... 2,3 ... less 1, (p, 2).
    """
    pairs: Ints = np.stack(np.triu_indices(count, k=1), axis=-1)
    return pairs


def widest_pair(field: StarField) -> Ints:
    """Choose the two stars of each problem with the largest sine between their directions.

    Of all pairs this one turns reading errors into the least error of attitude.

    Returns:
        The numbers of the two stars, counted from 0, (..., 2); 0, 1 where there is no pair.
    """
    pairs = star_pairs(field.used.shape[-1])
    both = field.select(pairs)
    sine = norm(np.cross(both.directions[..., 0, :], both.directions[..., 1, :]))
    sine = np.where(both.used.all(axis=-1), np.nan_to_num(sine), -1.0)
    widest: Ints = pairs[np.argmax(sine, axis=-1)]
    return widest


def interstar_discrepancy_arcsec(pair: StarField) -> Floats:
    """Subtract the angle between two images from the angle between their stars.

    Args:
        pair: problems of two stars, (..., 2)

    Returns:
        The discrepancies, (...), seconds of arc.
    """
    first, second = (pair.directions[..., k, :] for k in range(2))
    photo = pair.photo
    on_photo = angle_between(photo[..., 0, :], photo[..., 1, :])
    return (angle_between(first, second) - on_photo) * ARCSEC_PER_RADIAN


def star_disagreement_arcsec(field: StarField) -> tuple[Floats, Floats]:
    """Add up each star's interstar discrepancies with all the others.

    A misidentified star disagrees with every other, a good one only with the
    misidentified: sum and median are large for that star alone.

    Args:
        field: the stars and their images

    Returns:
        Sum and median of the sizes, each (..., n), seconds of arc; NaN for a star that is not used.

    Source: Rae (1987), recommendation 4 (data editing by pairwise solutions).
    """
    refuse_other_field(field, "star_disagreement_arcsec")
    count = field.used.shape[-1]
    pairs = star_pairs(count)
    size = np.abs(interstar_discrepancy_arcsec(field.select(pairs)))
    size = np.where(field.select(pairs).used.all(axis=-1), size, np.nan)
    table = np.full((*field.used.shape, count), np.nan)
    table[..., pairs[:, 0], pairs[:, 1]] = size
    table[..., pairs[:, 1], pairs[:, 0]] = size
    alone = np.isnan(table).all(axis=-1, keepdims=True)
    filled = np.where(alone, 0.0, table)
    total = np.nansum(filled, axis=-1, keepdims=True)
    median = np.nanmedian(filled, axis=-1, keepdims=True)
    both = np.where(alone, np.nan, np.concatenate([total, median], axis=-1))
    return both[..., 0], both[..., 1]


def interstar_reading_sigma_mm(field: StarField, discrepancies_mm: Floats | None = None) -> Floats:
    """Estimate the reading sigma from interstar angles alone.

    Every discrepancy is divided by the standard deviation that it has for
    readings good to 1 mm; the estimate is the median size of these ratios. Each
    star is compared with 40 others at most, so that many stars cost little.

    Args:
        field: one problem, or a stack of them
        discrepancies_mm: `sampled_discrepancies_mm`, if they are known

    Returns:
        The standard deviation, (...), mm; NaN for fewer than three stars.

    Half of the ratios may be wrong (misidentified stars) without spoiling it.
    """
    if field.used.shape[-1] < 3:
        return np.full(field.used.shape[:-1], np.nan)
    off = sampled_discrepancies_mm(field) if discrepancies_mm is None else discrepancies_mm
    return np.asarray(_median(off, (-2, -1)) / NORMAL_MEDIAN)


def median_disagreement_mm(field: StarField, discrepancies_mm: Floats | None = None) -> Floats:
    """Estimate each star's image error from its median disagreement with up to 40 others.

    Args:
        field: one problem of two or more stars, or a stack of them
        discrepancies_mm: `sampled_discrepancies_mm`, if they are known

    Returns:
        (..., n), mm, in the measure of `interstar_reading_sigma_mm`.
    """
    off = sampled_discrepancies_mm(field) if discrepancies_mm is None else discrepancies_mm
    return _median(off, -2)


def _median(values: Floats, axis: int | tuple[int, ...]) -> Floats:
    """Take the median without NaN, for which numpy has a slow function of its own."""
    return np.asarray((np.nanmedian if np.isnan(values).any() else np.median)(values, axis=axis))


STARS_TOGETHER = 3000
"""Stars, of all problems, whose partners are compared at once: more take memory, not less time."""


def sampled_discrepancies_mm(field: StarField) -> Floats:
    """Compare each star with partners spread over the list, (..., partners, n), mm."""
    count = field.used.shape[-1]
    steps = np.unique(np.linspace(1, count - 1, MOST_PARTNERS).round().astype(int))
    some = max(1, STARS_TOGETHER // max(field.used.size, 1))
    parts = [_discrepancies(field, steps[k : k + some]) for k in range(0, len(steps), some)]
    return np.concatenate(parts, axis=-2)


def _discrepancies(field: StarField, steps: Ints) -> Floats:
    """Compare each star with those that follow it by some steps, (..., steps, n), mm."""
    count = field.used.shape[-1]
    star = np.tile(np.arange(count), len(steps))
    pairs = np.stack([star, (star + np.repeat(steps, count)) % count], axis=-1)
    pair = field.select(pairs)
    angle = interstar_discrepancy_arcsec(pair) / ARCSEC_PER_RADIAN
    size = np.abs(angle) / np.sqrt((_angle_gain(pair) ** 2).sum(axis=-1))
    return np.asarray(size.reshape(*size.shape[:-1], len(steps), count))


def _angle_gain(pair: StarField) -> Floats:
    """Differentiate the angle between two images by errors along their line, (..., 2)."""
    photo, f = pair.photo, pair.focal_length_mm
    distance = f / -photo[..., 2]  # from the lens to the image
    other = photo[..., ::-1, :]
    toward = other - dot(photo, other)[..., None] * photo
    with np.errstate(invalid="ignore"):
        toward = toward / norm(toward)[..., None]  # on the unit sphere, towards the other star
    # A shift (dx, dy, 0) of the image turns its ray by its part along `toward`, over the distance.
    along = toward[..., :2]
    if pair.errors is None:
        return np.asarray(np.hypot(along[..., 0], along[..., 1]) / distance)
    variance = np.einsum("...i,...ij,...j->...", along, pair.errors, along)
    return np.asarray(np.sqrt(variance) / distance)
