"""Routine TRUOPK as listed (appendix C): angles by trying all eight combinations.

It shows what the listing does, errors included; use
`vopd.stellar.omega_phi_kappa_deg` for angles. T12 stands where T22 should, the
tests divide by the elements, and their tolerance of .3 percent is less than the
errors of a Church solution's elements. M12 to M23 are taken as real numbers
here; the listing makes them integers by the implicit rule.
"""

from __future__ import annotations

import itertools

import numpy as np

from vopd.arrays import Floats

SMALL = 0.00001
COMBINATIONS = np.array(list(itertools.product((0, 1), repeat=3)))  # I, J, K, K fastest


def truopk(angles_deg: Floats, m12: Floats, m13: Floats, m22: Floats, m23: Floats) -> Floats:
    """The first of eight combinations of angles that passes the listing's tests.

    Args:
        angles_deg: arc tangents and arc sine of eq. 3.5, (..., 3), degrees
        m12: element of M, (...)
        m13: element of M, (...)
        m22: element of M, (...)
        m23: element of M, (...)

    Returns:
        omega, phi, kappa, (..., 3), degrees; NaN where no combination passes.

    Source: Rae (1987), appendix C.
    """
    sine, cosine = np.sin(np.radians(angles_deg)), np.cos(np.radians(angles_deg))
    first = np.arctan2(sine, cosine)
    second = np.arctan2(sine * [-1.0, 1.0, -1.0], -cosine)  # phi keeps its sine
    candidates = np.where(COMBINATIONS == 0, first[..., None, :], second[..., None, :])
    so, sp, sk = np.moveaxis(np.sin(candidates), -1, 0)
    co, _, ck = np.moveaxis(np.cos(candidates), -1, 0)
    t12 = so * sp * ck + co * sk
    t13 = -co * sp * ck + so * sk
    t22 = -so * sp * sk + co * ck
    t23 = co * sp * sk + so * ck
    e12, e13, e22, e23 = (np.asarray(e, dtype=float)[..., None] for e in (m12, m13, m22, m23))
    with np.errstate(divide="ignore", invalid="ignore"):
        missed = (
            ((t12 - e12) * (t12 - e12) / e12 / e12 > SMALL)
            | ((t13 - e13) * (t13 - e13) / e13 / e13 > SMALL)
            | ((t22 - e22) * (t12 - e22) / e22 / e22 > SMALL)  # T12, as listed
            | ((t23 - e23) * (t23 - e23) / e23 / e23 > SMALL)
        )
    chosen = np.argmin(missed, axis=-1)[..., None]
    angles = np.degrees(np.take_along_axis(candidates, chosen[..., None], axis=-2)[..., 0, :])
    found = ~np.take_along_axis(missed, chosen, axis=-1)
    return np.where(found, angles, np.nan)
