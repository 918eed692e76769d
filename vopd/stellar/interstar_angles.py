"""All pairs of stars: who with whom, and who disagrees with the rest."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.geometry.vectors import ARCSEC_PER_RADIAN, angle_between, norm
from vopd.stellar.star_field import StarField

OUTLIER_RATIO = 5.0
"""A star stands out when its median disagreement passes the others' by this factor."""

NOTICEABLE_ARCSEC = 1.0
"""Disagreement below which no star stands out, whatever the others'."""


def star_pairs(count: int) -> Ints:
    """The pairs of `count` stars, counted from 0, in the report's order 1,2 1,3 ... : (p, 2)."""
    pairs: Ints = np.stack(np.triu_indices(count, k=1), axis=-1)
    return pairs


def widest_pair(field: StarField) -> Ints:
    """The two used stars whose directions make the largest sine: (..., 2).

    The pair that a closed form turns its reading errors into the least
    attitude error; 0, 1 where there is none.
    """
    pairs = star_pairs(field.used.shape[-1])
    both = field.select(pairs)
    sine = norm(np.cross(both.directions[..., 0, :], both.directions[..., 1, :]))
    sine = np.where(both.used.all(axis=-1), np.nan_to_num(sine), -1.0)
    widest: Ints = pairs[np.argmax(sine, axis=-1)]
    return widest


def interstar_discrepancy_arcsec(pair: StarField) -> Floats:
    """Celestial minus photographed angle of fields of two stars, seconds of arc: (...).

    No attitude changes it: it measures the readings, and the identification.
    """
    first, second = (pair.directions[..., k, :] for k in range(2))
    photo = pair.photo
    on_photo = angle_between(photo[..., 0, :], photo[..., 1, :])
    return (angle_between(first, second) - on_photo) * ARCSEC_PER_RADIAN


def star_disagreement_arcsec(field: StarField) -> tuple[Floats, Floats]:
    """Each star's discrepancies with all the others, sizes added up, and their median.

    Both (..., n), seconds of arc, NaN for a star that is not used. A
    misidentified star disagrees with every other, a good one only with the
    misidentified: so sum and median are large for that star alone. Report,
    recommendation 4 (data editing by pairwise solutions).
    """
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


def outliers(field: StarField) -> Bools:
    """Stars whose disagreement stands out from the others': (..., n).

    Needs four stars: of three, two agree or disagree with the third alike.
    """
    _, median = star_disagreement_arcsec(field)
    known = np.where(np.isnan(median).all(axis=-1, keepdims=True), 0.0, median)
    typical = np.nanmedian(known, axis=-1, keepdims=True)
    bar = np.maximum(OUTLIER_RATIO * typical, NOTICEABLE_ARCSEC)
    enough = field.used.sum(axis=-1, keepdims=True) >= 4
    return np.asarray(enough & (np.nan_to_num(median) > bar))
