"""Digits of a printed number: those of C's printf, which rounds the exact value of the double."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from tests.kit.jobs import film
from tests.kit.result_arrays import with_arrays
from vopd.listing.pages import listing_text
from vopd.program.vopd import run

RESULTS = run(film(1))


def printf(value: float, width: int, decimals: int) -> str:
    """The field without a zero before the point, asterisks where it does not fit."""
    text = f"{value:.{decimals}f}"
    text = text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text
    return text.rjust(width) if len(text) <= width else "*" * width


def half_way(decimals: int) -> st.SearchStrategy[float]:
    """Numbers at, or a few last bits off, the middle between two printed ones."""
    middle = st.integers(-(10**8), 10**8).map(lambda n: (n + 0.5) / 10**decimals)
    return st.tuples(middle, st.integers(-3, 3)).map(
        lambda pair: float(pair[0] + pair[1] * np.spacing(pair[0]))
    )


def numbers(decimals: int) -> st.SearchStrategy[float]:
    binary = st.integers(-(2**30), 2**30).map(lambda n: n / 2**12)  # exact ties among them
    return st.one_of(half_way(decimals), binary, st.floats(-1e7, 1e7), st.floats(-1.0, 1.0))


@given(numbers(2), numbers(5), numbers(8))
def test_as_printf(hundredths: float, five: float, eight: float) -> None:
    """F10.2 and F10.5 of group 2, F15.8 of group 3."""
    points = RESULTS.point_in.copy()
    points[0, 0, 0] = eight
    results = with_arrays(
        RESULTS,
        vehicle_ft=np.array([[hundredths, 0.0, 0.0]]),
        centre_in=np.array([[five, 0.0]]),
        point_in=points,
    )
    found = listing_text(results).split("\n")
    assert found[9][7:17] == printf(hundredths, 10, 2)
    assert found[9][37:47] == printf(five, 10, 5)
    assert found[11][4:19] == printf(eight, 15, 8)
