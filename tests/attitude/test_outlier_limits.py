"""The limit of an outlier from both sides, by leaving landmarks out with another solver."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import f

from tests.kit.estimates import FOCAL, POINTS, estimate
from vopd.arrays import Bools, Floats
from vopd.attitude.residuals import outliers
from vopd.estimate import Estimate

MORE = np.vstack([POINTS, [[-1.0, 3.0], [-3.0, -2.0]]])


def left(e: Estimate, residual: Floats, keep: Bools) -> float:
    """The sum of squares of these landmarks when the attitude is fitted to them alone."""
    rows = np.tile(keep, 2)
    b = e.partials[0][rows]
    fit, *_ = np.linalg.lstsq(b, residual[rows], rcond=None)
    return float(((residual[rows] - b @ fit) ** 2).sum())


def worst(e: Estimate, residual: Floats, used: Bools) -> tuple[int, float]:
    """The landmark without which the others fit best, and the chance of that by itself."""
    count = int(used.sum())
    total = left(e, residual, used)
    without = {
        k: left(e, residual, used & (np.arange(len(used)) != k)) for k in np.flatnonzero(used)
    }
    k = min(without, key=lambda one: without[one])
    ratio = ((total - without[k]) / 2.0) / (without[k] / (2 * count - 5))
    return int(k), float(f.sf(ratio, 2, 2 * count - 5))


@pytest.mark.parametrize(
    ("count", "which", "unused"),
    [(4, 1, None), (4, 2, 0), (4, 1, 4), (5, 2, 3), (5, 3, None), (6, 5, None)],
)
def test_a_landmark_is_an_outlier_below_a_chance_of_a_thousandth(
    count: int, which: int, unused: int | None
) -> None:
    """A thousandth of a frame, and so less by as many landmarks as there are."""
    total = count + (unused is not None)
    used = np.arange(total) != (-1 if unused is None else unused)
    noise = np.random.default_rng(10 * count + which).normal(0.0, 0.01, 2 * total)
    noise *= np.tile(used, 2)
    e = estimate([[140.0, -60.0, 20.0]], MORE[:total])
    partials = e.partials * np.tile(used, 2)[:, None]
    bump = np.zeros(2 * total)
    bump[[which, total + which]] = 0.6, -0.8
    limit = 0.001 / used.sum()
    low, high = 1e-3, 1e3
    for _ in range(24):
        middle = np.sqrt(low * high)
        k, chance = worst(e, noise + middle * bump, used)
        low, high = (low, middle) if k == which and chance < limit else (middle, high)
    for size, found in ((high * 1.002, [which]), (low * 0.998, [])):
        residual = (noise + size * bump)[None]
        one = estimate(
            e.camera_deg, MORE[:total], residual=residual, used=used[None], partials=partials
        )
        assert np.flatnonzero(outliers(one)[0]).tolist() == found


def test_three_landmarks_have_none_and_four_may() -> None:
    bump = np.zeros(6)
    bump[[0, 3]] = 5.0, -3.0
    three = estimate([[140.0, -60.0, 20.0]], POINTS[:3], residual=bump[None])
    assert not outliers(three).any()
    used = np.array([[True, True, True, False]])
    bump = np.zeros(8)
    bump[[0, 4]] = 5.0, -3.0
    bump += np.tile(used[0], 2) * np.random.default_rng(1).normal(0.0, 1e-6, 8)
    unused = estimate([[140.0, -60.0, 20.0]], residual=bump[None], used=used)
    assert not outliers(unused).any()
    assert outliers(estimate([[140.0, -60.0, 20.0]], residual=bump[None]))[0].tolist() == [
        True, False, False, False,
    ]  # fmt: skip


@pytest.mark.parametrize(("size", "found"), [(1.3e-9, True), (0.7e-9, False)])
def test_rounding_is_no_misfit(size: float, found: bool) -> None:
    """Residuals of less than a thousand-millionth of the focal length, all together."""
    e = estimate([[140.0, -60.0, 20.0]], MORE)
    rng = np.random.default_rng(3)
    residual = rng.normal(0.0, 1e-3, 12)
    residual[2] += 1.0
    fit, *_ = np.linalg.lstsq(e.partials[0], residual, rcond=None)
    residual = residual - e.partials[0] @ fit
    residual *= size * FOCAL / np.sqrt((residual**2).sum())
    one = estimate([[140.0, -60.0, 20.0]], MORE, residual=residual[None])
    assert outliers(one).any() == found


def test_frames_without_equations_have_no_outlier_and_disturb_no_other() -> None:
    residual = np.random.default_rng(4).normal(0.0, 1e-3, (2, 12))
    residual[:, 1] += 3.0
    e = estimate(np.tile([140.0, -60.0, 20.0], (2, 1)), MORE, residual=residual)
    partials = e.partials.copy()
    partials[0] = np.nan
    residual[0] = np.nan
    lost = estimate(e.camera_deg, MORE, residual=residual, partials=partials)
    assert outliers(lost).sum(axis=1).tolist() == [0, 1]
