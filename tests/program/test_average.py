"""Averages of the readings, through unit 9 (A 84 to A 104, FORMAT 87)."""

from __future__ import annotations

from decimal import ROUND_HALF_EVEN, Context, Decimal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tests.tolerances import assert_close
from vopd.job import Readings
from vopd.program.average import averages, eight_digits


def readings(fiducials: np.ndarray, landmarks: np.ndarray) -> Readings:
    """A record of these inches, (F, 4, 3, 2) and (F, L, 3, 2)."""
    shape = landmarks.shape[:2]
    return Readings.of(
        frame=np.arange(shape[0]),
        fiducial_in=fiducials,
        landmark=np.ones(shape, np.int64),
        present=np.ones(shape, bool),
        landmark_in=landmarks,
    )


def test_the_first_landmark_of_case_1() -> None:
    """x (10.178 + 10.174 + 10.174)/3 = 30.526/3, y (1.655 + 1.651 + 1.649)/3 = 4.955/3."""
    three = np.array([[10.178, 1.655], [10.174, 1.651], [10.174, 1.649]])
    _, point = averages(readings(np.zeros((1, 4, 3, 2)), three[None, None]))
    assert point[0].tolist() == [10.175333, 1.6516667]
    _, full = averages(readings(np.zeros((1, 4, 3, 2)), three[None, None]), rounded=False)
    assert_close("mean reading", full[0], [30.526 / 3, 4.955 / 3])


def test_a_frame_centre() -> None:
    """Twelve readings: x sums to 36 + .003, y to -12, over 12."""
    fiducials = np.zeros((1, 4, 3, 2))
    fiducials[0, :, :, 0] = [[0.001] * 3, [3.0] * 3, [6.0, 6.0, 6.0], [3.0] * 3]
    fiducials[0, :, :, 1] = [[-1.0] * 3, [1.0] * 3, [-2.0] * 3, [-2.0] * 3]
    centre, _ = averages(readings(fiducials, np.zeros((1, 1, 3, 2))))
    assert centre.tolist() == [[3.00025, -1.0]]


INCHES = st.integers(-99999, 999999).map(lambda thousandths: thousandths / 1000)


@given(
    arrays(float, (2, 4, 3, 2), elements=INCHES),
    arrays(float, (2, 2, 3, 2), elements=INCHES),
    st.permutations(range(3)),
    st.booleans(),
)
def test_the_order_of_the_three_readings_does_not_matter(
    fiducials: np.ndarray, landmarks: np.ndarray, order: list[int], rounded: bool
) -> None:
    first = averages(readings(fiducials, landmarks), rounded)
    other = averages(readings(fiducials[:, :, order], landmarks[:, :, order]), rounded)
    for one, two in zip(first, other, strict=True):
        np.testing.assert_array_equal(one, two)


@given(arrays(float, (1, 4, 3, 2), elements=INCHES), arrays(float, (1, 2, 3, 2), elements=INCHES))
def test_arguments_are_not_changed(fiducials: np.ndarray, landmarks: np.ndarray) -> None:
    before = fiducials.tobytes(), landmarks.tobytes()
    averages(readings(fiducials, landmarks))
    assert (fiducials.tobytes(), landmarks.tobytes()) == before


EIGHT = Context(prec=8, rounding=ROUND_HALF_EVEN)


@pytest.mark.parametrize(
    ("value", "kept"),
    [
        (10.1753333333333, 10.175333),
        (1.65166666666667, 1.6516667),
        (-10.1753333333333, -10.175333),  # the sign has a column of its own
        (0.00123456785, 0.0012345679),  # 1.23456785000000007...E-3 in binary: no tie
        (9.99999995, 9.9999999),  # 9.99999994999999971... in binary
        (9.99999996, 10.0),
        (99999999.5, 100000000.0),  # a tie, exactly: to the even digit
        (0.5, 0.5),
        (0.0, 0.0),
        (1.23456789e-7, 1.2345679e-7),
        (123456789012.0, 123456790000.0),
    ],
)
def test_eight_digits_by_hand(value: float, kept: float) -> None:
    assert eight_digits(np.array([value]))[0] == kept


@given(
    st.one_of(
        st.floats(-1e12, 1e12),
        st.integers(-99999, 999999).map(lambda n: n / 3000),
        st.integers(-(10**9), 10**9).map(lambda n: n / 2**10),  # ties among them
    )
)
def test_eight_digits_are_those_of_exact_decimals(value: float) -> None:
    """Decimal(value) is the double without rounding; rounding it once is what printf does."""
    assert eight_digits(np.array([value]))[0] == float(EIGHT.create_decimal(Decimal(value)))


@pytest.mark.parametrize("size", [1e-6, 9.9e-4, 1e-3, 0.1, 1.0, 9.5, 1e4, 9.9e7, 1e8, 3e9])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_eight_digits_are_those_that_are_printed(size: float, sign: float) -> None:
    """Numbers on a tie of the eighth digit, a last bit beside one, and any others."""
    random = np.random.default_rng(8)
    power = 10.0 ** np.floor(np.log10(size))
    ties = (random.integers(10**7, 10**8, 300) + 0.5) / 1e7 * power
    numbers = sign * np.concatenate([
        [0.0, size], ties, np.nextafter(ties, 0.0), np.nextafter(ties, 1e99),
        random.uniform(1.0, 10.0, 300) * power,
    ])  # fmt: skip
    printed = [float(f"{number:.7e}") for number in numbers]
    assert eight_digits(numbers).tolist() == printed
