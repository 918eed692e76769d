"""Routine TUSTAR as listed (appendix D): the two-star solution and its angles.

It shows what the listing prints; use `vopd.stellar.two_star` for attitudes. Its
phi and delta come from the cosine of an angle that is already in degrees, so
that they are wrong even for data without errors, and its fictitious star is not
a unit vector.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.vectors import ARCSEC_PER_RADIAN, dot
from vopd.stellar.field import StarField
from vopd.stellar.methods.two_star import two_star


@dataclass(frozen=True)
class TustarAnswers:
    """The results of TUSTAR for a stack of pairs (...).

    Attributes:
        matrix: the orientation matrix, (..., 3, 3)
        omega_phi_kappa_deg: its angles, phi wrong, (..., 3), degrees
        alpha_delta_swing_deg: its angles, delta wrong, (..., 3), degrees
        interstar_rad: angle between the two stars, (...), radians
        discrepancy_arcsec: that minus the angle between the images, (...), seconds of arc
    """

    matrix: Floats
    omega_phi_kappa_deg: Floats
    alpha_delta_swing_deg: Floats
    interstar_rad: Floats
    discrepancy_arcsec: Floats


def tustar(pair: StarField) -> TustarAnswers:
    """Solve pairs of stars exactly as routine TUSTAR does.

    Args:
        pair: problems of two stars, (..., 2)

    Returns:
        What it prints; NaN where its arc cosines fail.

    Source: Rae (1987), appendix D.
    """
    m = two_star(pair, unit_cross_products=False).matrix
    omega = np.degrees(np.arctan2(-m[..., 2, 1], m[..., 2, 2]))
    cos_phi = np.minimum(m[..., 2, 2] / np.cos(omega), 1.0)  # omega is in degrees: as listed
    phi = np.degrees(np.arctan2(m[..., 2, 0], cos_phi))
    kappa = np.degrees(np.arctan2(-m[..., 1, 0], m[..., 0, 0]))
    alpha = np.degrees(np.arctan2(-m[..., 2, 1], -m[..., 2, 0]))
    cos_delta = np.minimum(-m[..., 2, 0] / np.cos(alpha), 1.0)  # so is alpha
    delta = np.degrees(np.arctan2(-m[..., 2, 2], cos_delta))
    swing = np.degrees(np.arctan2(m[..., 0, 2], m[..., 1, 2]))
    stars, photo = pair.directions, pair.photo
    with np.errstate(invalid="ignore"):
        on_sky = np.arccos(dot(stars[..., 0, :], stars[..., 1, :]))
        on_photo = np.arccos(dot(photo[..., 0, :], photo[..., 1, :]))
    return TustarAnswers(
        m,
        np.stack([omega, phi, kappa], axis=-1),
        np.stack([alpha, delta, swing], axis=-1),
        on_sky,
        (on_sky - on_photo) * ARCSEC_PER_RADIAN,
    )
