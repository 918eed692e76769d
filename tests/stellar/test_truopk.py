"""TRUOPK against the listing, statement for statement, where it finds and where it does not."""

from __future__ import annotations

from math import atan2, cos, degrees, nan, radians, sin

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tests.kit import rae_listings as listings
from tests.tolerances import assert_close
from vopd.stellar.listed import truopk

SMALL = 0.00001
angle = st.floats(-179.0, 179.0).map(lambda a: round(a, 3))
near_one = st.floats(0.99, 1.01)


def listed(angles_deg: list[float], m12: float, m13: float, m22: float, m23: float) -> list[float]:
    """The loops of the listing, T12 for T22 among them; NaN where they end without an answer."""
    o, p, k = (radians(a) for a in angles_deg)
    om = (atan2(sin(o), cos(o)), atan2(-sin(o), -cos(o)))
    ph = (atan2(sin(p), cos(p)), atan2(sin(p), -cos(p)))
    ka = (atan2(sin(k), cos(k)), atan2(-sin(k), -cos(k)))
    for o in om:
        for p in ph:
            for k in ka:
                t12 = sin(o) * sin(p) * cos(k) + cos(o) * sin(k)
                t13 = -cos(o) * sin(p) * cos(k) + sin(o) * sin(k)
                t22 = -sin(o) * sin(p) * sin(k) + cos(o) * cos(k)
                t23 = cos(o) * sin(p) * sin(k) + sin(o) * cos(k)
                if (
                    (t12 - m12) * (t12 - m12) / m12 / m12 <= SMALL
                    and (t13 - m13) * (t13 - m13) / m13 / m13 <= SMALL
                    and (t22 - m22) * (t12 - m22) / m22 / m22 <= SMALL
                    and (t23 - m23) * (t23 - m23) / m23 / m23 <= SMALL
                ):
                    return [degrees(o), degrees(p), degrees(k)]
    return [nan, nan, nan]


def both(angles: list[float], elements: list[float]) -> tuple[np.ndarray, list[float]]:
    mine = truopk(np.array(angles), *(np.array(e) for e in elements))
    return mine, listed(angles, *elements)


@given(st.tuples(angle, st.floats(-89.0, 89.0), angle), st.tuples(*[near_one] * 4))
def test_truopk_is_the_listing(true: tuple[float, ...], errors: tuple[float, ...]) -> None:
    """From the wrong quadrants of omega and kappa, of elements up to a percent wrong."""
    m = listings.jnkmat(*true)
    elements = [m[0][1], m[0][2], m[1][1], m[1][2]]
    raw = [degrees(np.arctan(np.tan(radians(a)))) for a in true]
    for factors in ([1.0] * 4, errors):
        given_elements = [e * factor for e, factor in zip(elements, factors, strict=True)]
        if min(map(abs, given_elements)) > 1e-6:
            mine, theirs = both(raw, given_elements)
            assert_close("rae angle", mine, theirs)


def test_the_slip_lets_a_wrong_element_pass() -> None:
    """m22 too large: (T22 - m22)(T12 - m22) is negative where m22 lies between them, and passes."""
    true = [40.0, 20.0, 30.0]
    m = listings.jnkmat(*true)
    t12, t22 = m[0][1], m[1][1]
    assert t12 > t22  # .573 and .554: .56 lies between, 1.2 percent off
    mine, theirs = both(true, [t12, m[0][2], 0.56, m[1][2]])
    assert_close("rae angle", mine, true)
    assert_close("rae angle", theirs, true)
    mine, theirs = both(true, [t12, m[0][2], 0.54, m[1][2]])
    assert np.isnan(mine).all() and np.isnan(theirs).all()


def test_phi_of_the_wrong_sign_is_not_found() -> None:
    """Its second angle has the same sine, so that neither passes."""
    m = listings.jnkmat(40.0, 20.0, 30.0)
    mine, theirs = both([40.0, -20.0, 30.0], [m[0][1], m[0][2], m[1][1], m[1][2]])
    assert np.isnan(mine).all() and np.isnan(theirs).all()
