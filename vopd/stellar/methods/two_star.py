"""The Church method for two stars through a fictitious third (section 3.3, program TESTU)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.geometry.linear import dot, unit
from vopd.stellar.angles import omega_phi_kappa_deg, orientation_matrix
from vopd.stellar.field import (
    Failure,
    StarField,
    coincide,
    first_failure,
    refuse_other_field,
    when,
)
from vopd.stellar.interstar_angles import interstar_discrepancy_arcsec, widest_pair
from vopd.stellar.solution import StarSolution, closed_form_solution


def two_star(pair: StarField, *, unit_cross_products: bool = True) -> StarSolution:
    """Solve the attitude from two stars and a fictitious third at right angles to them.

    The third star is the cross product of the two, on the sky and on the
    photograph. The matrix carries both stars onto their images exactly and is
    not quite orthogonal.

    Args:
        pair: problems of two stars, (..., 2)
        unit_cross_products: whether the third star is a unit vector, as in the
            equations, or as long as the cross product (the sine of the angle),
            as in listing TUSTAR. The two lengths differ where the readings err

    Returns:
        The solution; it fails where the two stars, or their images, are the same
        or opposite.

    Source: Rae (1987), eqs. 3.3, 3.21, 3.22.
    """
    refuse_other_field(pair, "two_star", 2)
    photo = pair.photo
    sky_triple = _with_third(pair.directions, unit_cross_products)
    photo_triple = _with_third(photo, unit_cross_products)
    matrix: Floats = photo_triple @ _inverse(sky_triple)
    failure = first_failure(pair.unfit(least=2), same_star(pair))
    return closed_form_solution(
        matrix,
        failure,
        pair,
        interstar_discrepancy_arcsec=interstar_discrepancy_arcsec(pair),
    )


def closed_form(field: StarField) -> Floats:
    """Solve the widest pair of each problem by the two-star Church method.

    Of the used stars it takes the two whose directions make the largest sine,
    solves them with unit cross products and makes a rotation of the result
    through omega, phi, kappa. The report starts the collinearity equations so.

    Args:
        field: the stars and their images; every pair is tried, so not for thousands

    Returns:
        Rotation matrices, (..., 3, 3), as accurate as the readings of that pair;
        NaN where there are not two distinct stars.
    """
    refuse_other_field(field, "closed_form")
    if field.used.shape[-1] < 2:
        return np.full((*field.used.shape[:-1], 3, 3), np.nan)
    pair = field.select_each(widest_pair(field))
    return orientation_matrix(omega_phi_kappa_deg(two_star(pair).matrix))


def same_star(pair: StarField) -> Ints:
    """Find problems of which two directions, or two images, coincide or are opposite, (...)."""
    photo = pair.photo
    same = coincide(pair.directions[..., 0, :], pair.directions[..., 1, :])
    return when(same | coincide(photo[..., 0, :], photo[..., 1, :]), Failure.SAME_STAR)


def _with_third(vectors: Floats, unit_cross_products: bool) -> Floats:
    """Join two vectors and their cross product as columns: (..., 2, 3) to (..., 3, 3)."""
    first, second = vectors[..., 0, :], vectors[..., 1, :]
    third = np.cross(first, second)
    if unit_cross_products:
        third = unit(third)
    return np.stack([first, second, third], axis=-1)


def _inverse(columns: Floats) -> Floats:
    """Invert (..., 3, 3) by cross products (INV3X3); not finite where there is no inverse."""
    a, b, c = (columns[..., :, k] for k in range(3))
    rows = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-2)
    with np.errstate(divide="ignore", invalid="ignore"):
        inverted: Floats = rows / dot(a, np.cross(b, c))[..., None, None]
    return inverted
