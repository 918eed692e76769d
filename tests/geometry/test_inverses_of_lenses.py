"""Distortion and its inverse where they are delicate: at the axis, at the ends, with one row."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.geometry import lenses

BROWN = np.array([-0.28, 0.09, 1e-3, -8e-4, -0.02, 0.01, 2e-3, 1e-3, 5e-4, 1e-4, -3e-4, 2e-4])
FISHEYE = np.array([0.03, 0.01, -0.02, 0.004])
TABLE = np.array([[0.0, 0.0], [0.2, 0.21], [0.4, 0.43], [0.5, 0.52]])  # measured, ideal
POINTS = np.array([[0.0, 0.0], [0.3, 0.0], [0.0, -0.3], [0.25, -0.31], [1e-9, 2e-9]])
X, Y = POINTS.T


@pytest.mark.parametrize(
    ("kind", "k"), [("brown", BROWN), ("fisheye", FISHEYE), ("radial_table", TABLE)]
)
def test_distortion_is_undone_also_on_the_axis(kind: str, k: np.ndarray) -> None:
    """Without a warning of numpy's, and the derivatives are those of differences."""
    distort, undistort = getattr(lenses, f"distort_{kind}"), getattr(lenses, f"undistort_{kind}")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        moved, by = distort(k, X, Y)
        assert_close("flight ray", undistort(k, *moved), [X, Y])
    step = 1e-7
    for axis, way in enumerate(([step, 0.0], [0.0, step])):
        there, back = (distort(k, X + s * way[0], Y + s * way[1])[0] for s in (1.0, -1.0))
        slope = (np.array(there) - np.array(back)).T / (2 * step)
        assert_close("derivative by steps", by[..., axis][:4], slope[:4])


@pytest.mark.parametrize("index", range(12))
def test_each_coefficient_of_brown_by_its_own_term(index: int) -> None:
    """k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, at x = .3, y = -.2, r2 = .13; OpenCV's formulas."""
    k, x, y, r2 = np.zeros(12), 0.3, -0.2, 0.13
    k[index] = 0.1
    radial = {0: r2, 1: r2**2, 4: r2**3}
    under = {5: r2, 6: r2**2, 7: r2**3}
    across = {
        2: (2 * x * y, r2 + 2 * y * y), 3: (r2 + 2 * x * x, 2 * x * y),
        8: (r2, 0.0), 9: (r2**2, 0.0), 10: (0.0, r2), 11: (0.0, r2**2),
    }  # fmt: skip
    factor = (1 + 0.1 * radial.get(index, 0.0)) / (1 + 0.1 * under.get(index, 0.0))
    dx, dy = across.get(index, (0.0, 0.0))
    (xd, yd), _ = lenses.distort_brown(k, np.array(x), np.array(y))
    assert_close("ratio", [xd, yd], [x * factor + 0.1 * dx, y * factor + 0.1 * dy])


def test_a_field_ends_at_the_first_of_several_ends() -> None:
    """(1 - r2)(1 - r2 / 4) is the growth of r - (5 / 12) r3 + r5 / 20: ends at 1 and at 2."""
    k = np.zeros(12)
    k[:2] = -5 / 12, 1 / 20
    assert_close("ratio", lenses.field_radius_brown(k), 1.0)
    radius = np.linspace(0.64, 3.0, 40)  # it grows to 19 / 30, and from .27 at 2 on again
    with np.errstate(all="ignore"):
        found = lenses.undistort_brown(k, np.append(0.6, radius), np.zeros(41))[0]
    assert 0.6 < found[0] < 1.0 and np.isnan(found[1:]).all()


def test_a_field_ends_at_a_pole_before_a_fold() -> None:
    """1 / (1 - r2 / 4) has a pole at 2, and grows all the way."""
    k = np.zeros(12)
    k[5] = -0.25
    assert_close("ratio", lenses.field_radius_brown(k), 2.0)
    radius = np.array([0.5, 1.9])
    moved = radius / (1 - radius**2 / 4)
    assert_close("flight ray", lenses.undistort_brown(k, moved, 0.0 * moved)[0], radius)
    assert np.isnan(lenses.undistort_brown(k, -moved[1:], np.array([np.nan]))[0]).all()


@pytest.mark.parametrize("radius", [0.0, 0.1, 0.2, 0.3, 0.4, 0.45, 0.5])
def test_a_table_is_linear_between_its_rows_and_their_slopes(radius: float) -> None:
    """On a row the slope is that of what follows, and on the last one of what is before it."""
    ideal = np.interp(radius, TABLE[:, 0], TABLE[:, 1])
    (xd, yd), by = lenses.distort_radial_table(TABLE, np.array(ideal), np.array(0.0))
    slope = 0.2 / 0.21 if ideal < 0.21 else 0.2 / 0.22 if ideal < 0.43 else 0.1 / 0.09
    assert_close("ratio", [xd, yd], [radius, 0.0])
    factor = radius / ideal if radius else slope
    assert_close("ratio", by, [[slope, 0.0], [0.0, factor]])
    assert_close("ratio", lenses.undistort_radial_table(TABLE, xd, yd), [ideal, 0.0])


def test_a_table_ends_with_its_last_row() -> None:
    assert lenses.field_radius_radial_table(TABLE) == 0.52
    found = lenses.undistort_radial_table(TABLE, np.array([0.5, 0.500001, 0.0]), np.zeros(3))[0]
    assert_close("ratio", found, [0.52, np.nan, 0.0])
