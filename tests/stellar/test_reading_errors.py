"""Errors of readings by columns of sigma, magnitude and elongation, worked by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.findings import InputError
from vopd.stellar.files.images import ErrorModel, reading_errors
from vopd.stellar.files.read import StarFile

ZERO = np.zeros((3, 2))
ROUND = np.broadcast_to(np.eye(2), (3, 2, 2))


def star_file(**columns: Any) -> StarFile:
    given = {name: np.array(value) for name, value in columns.items()}
    return StarFile("a.csv", (12, 13, 14), ("",) * 3, ZERO, "mm", "name", ZERO, **given)  # type: ignore[arg-type]


BRIGHT, LONG = [5.0, 7.5, 10.0], [1.0, 2.0, 3.0]
"""2.5 magnitudes are a factor of 10 in light."""

FACTORS: list[tuple[ErrorModel, list[float]]] = [
    (ErrorModel(7.5), [1.1, 2.0, 11.0]),
    (ErrorModel(5.0), [2.0, 11.0, 101.0]),
    (ErrorModel(None, by_elongation=True), [1.0, 4.0, 9.0]),
    (ErrorModel(7.5, by_elongation=True), [1.1, 8.0, 99.0]),
]


@pytest.mark.parametrize(("model", "factors"), FACTORS)
def test_variances_by_brightness_and_length(model: ErrorModel, factors: list[float]) -> None:
    """Relative to their mean; the reading sigma is not stated."""
    found = reading_errors(star_file(magnitude=BRIGHT, elongation=LONG), model, flipped=True)
    assert found.relative is not None and found.sigma is None
    expected = np.array(factors)[:, None, None] / np.mean(factors) * ROUND
    assert_close("rae element", found.relative, expected)


def test_errors_that_are_all_alike() -> None:
    same = star_file(magnitude=[6.0] * 3, elongation=[2.0] * 3)
    for model in (ErrorModel(), ErrorModel(7.5), ErrorModel(None, by_elongation=True)):
        assert tuple(reading_errors(same, model, flipped=False)) == (None, None)
    bright = star_file(magnitude=BRIGHT, elongation=LONG)
    assert tuple(reading_errors(bright, ErrorModel(), flipped=False)) == (None, None)


def test_faint_and_bright_beyond_measure() -> None:
    """Differences count up to 50 magnitudes, which are a factor of 1E20."""
    found = reading_errors(
        star_file(magnitude=[-100.0, 60.0, 100.0]), ErrorModel(10.0), flipped=False
    )
    assert found.relative is not None
    ratio = found.relative[:, 0, 0] / found.relative[2, 0, 0]
    assert_close("rae element", ratio, [1e-20, 1.0, 1.0])


SIGMAS = [[0.1, 0.2, 0.5], [0.3, 0.1, -0.25], [0.2, 0.2, 0.0]]
COVARIANCE = [
    [[0.01, 0.01], [0.01, 0.04]], [[0.09, -0.0075], [-0.0075, 0.01]], [[0.04, 0.0], [0.0, 0.04]],
]  # fmt: skip


@pytest.mark.parametrize("flipped", [False, True])
def test_stated_standard_deviations(flipped: bool) -> None:
    """The reading sigma is their root mean square: squares of .23 in six coordinates."""
    found = reading_errors(star_file(sigmas=SIGMAS), ErrorModel(), flipped=flipped)
    assert found.relative is not None and found.sigma is not None
    mean = 0.23 / 6.0
    turn = np.array([[1.0, -1.0], [-1.0, 1.0]]) if flipped else np.ones((2, 2))
    assert_close("rae element", found.relative, np.array(COVARIANCE) * turn / mean)
    assert_close("rae element", found.sigma, mean**0.5)


def test_stated_standard_deviations_of_long_images() -> None:
    """Variances times 1, 4, 9: .05 + .4 + .72."""
    file = star_file(sigmas=SIGMAS, elongation=LONG)
    found = reading_errors(file, ErrorModel(None, by_elongation=True), flipped=False)
    assert found.relative is not None and found.sigma is not None
    mean = (0.05 + 0.4 + 0.72) / 6.0
    expected = np.array(COVARIANCE) * np.array([1.0, 4.0, 9.0])[:, None, None] / mean
    assert_close("rae element", found.relative, expected)
    assert_close("rae element", found.sigma, mean**0.5)


BY_LENGTH = ErrorModel(None, by_elongation=True)
REFUSED: list[tuple[dict[str, Any], ErrorModel, str]] = [
    ({}, ErrorModel(7.0), "--magnitude-limit needs a column mag"),
    ({"elongation": LONG}, ErrorModel(7.0), "--magnitude-limit needs a column mag"),
    ({"magnitude": BRIGHT}, BY_LENGTH, "--weigh-elongation needs a column elongation"),
    ({"magnitude": [1, np.nan, np.nan]}, ErrorModel(7.0), "line 13: --magnitude-limit needs mag"),
    ({"elongation": [1, 1, np.nan]}, BY_LENGTH, "line 14: --weigh-elongation needs elongation"),
    ({"elongation": [1, 0.99, 0.5]}, BY_LENGTH, "line 13: elongation: length over width is 1 or "
     "more"),
]  # fmt: skip


@pytest.mark.parametrize(("columns", "model", "said"), REFUSED)
def test_columns_that_lack(columns: dict[str, Any], model: ErrorModel, said: str) -> None:
    with pytest.raises(InputError) as caught:
        reading_errors(star_file(**columns), model, flipped=False)
    assert str(caught.value) == f"a.csv: {said}"
    empty = star_file(magnitude=[np.nan] * 3, elongation=[0.5] * 3)
    assert tuple(reading_errors(empty, ErrorModel(), flipped=False)) == (None, None)
