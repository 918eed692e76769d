"""Compute an attitude without a first estimate, from the two stars farthest apart."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.stellar.angles import omega_phi_kappa_deg, orientation_matrix
from vopd.stellar.field import StarField
from vopd.stellar.interstar_angles import widest_pair
from vopd.stellar.methods.two_star import two_star


def closed_form(field: StarField) -> Floats:
    """Rotations by the two-star Church method from the widest pair of each problem.

    Of the used stars it takes the two whose directions make the largest sine,
    solves them with unit cross products and makes a rotation of the result
    through omega, phi, kappa. The report starts the collinearity equations so.

    Args:
        field: the stars and their images; every pair is tried, so not for thousands

    Returns:
        Rotation matrices, (..., 3, 3), as accurate as the readings of that pair;
        NaN where there are not two distinct stars.
    """
    if field.used.shape[-1] < 2:
        return np.full((*field.used.shape[:-1], 3, 3), np.nan)
    index = widest_pair(field)
    pair = StarField(
        np.take_along_axis(field.directions, index[..., None], axis=-2),
        np.take_along_axis(field.image_mm, index[..., None], axis=-2),
        field.focal_length_mm,
        np.take_along_axis(field.used, index, axis=-1),
    )
    return orientation_matrix(omega_phi_kappa_deg(two_star(pair).matrix))
