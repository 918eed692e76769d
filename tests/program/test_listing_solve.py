"""The solve against the listing's cards, operation by operation: the same bits."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kit import appendix_a, listing_a314
from vopd.program.orient import Orientation, orient

FOCAL = 10.4


def film(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Starts, cosines, film of 30 frames: near and far starts, good and bad readings."""
    rng = np.random.default_rng(seed)
    truth = rng.uniform([0.0, -90.0, 0.0], [360.0, 90.0, 360.0], (30, 3))
    noise_mm = rng.choice([0.0, 0.3])
    cosines, seen = appendix_a.random_film(rng, truth, int(rng.integers(1, 6)), noise_mm)
    start = truth + rng.uniform(-1.0, 1.0, truth.shape) * rng.choice([0.0, 5.0, 90.0])
    start[:2], cosines[0], seen[0] = 0.0, (0.0, 1.0, 0.0), 0.0  # exact, and
    cosines[1, 0] = (1.0, 0.0, 0.0)  # abeam: NaN
    return start, cosines, seen


def both(seed: int) -> tuple[Orientation, list[listing_a314.Left]]:
    start, cosines, seen = film(seed)
    frames = zip(start, cosines, seen, strict=True)
    done = orient(start.T.copy(), appendix_a.sight(cosines, seen, FOCAL))
    return done, [listing_a314.solve(*frame, FOCAL) for frame in frames]


@pytest.mark.parametrize("seed", range(14))
def test_bit_for_bit(seed: int) -> None:
    """Angles and residuals of pass 22 and what follows from it, or the pass that was exact."""
    done, wanted = both(seed)
    for f, left in enumerate(wanted):
        assert done.last_pass[f] == left.last_pass
        np.testing.assert_array_equal(done.angles[:, f], left.angles)
        np.testing.assert_array_equal(done.eps[:, :, f].T, left.eps)
        if not left.last_pass:
            np.testing.assert_array_equal(done.next[:, f], left.after)
            np.testing.assert_array_equal(done.correction[:, f], left.correction)


def test_the_films_are_of_every_kind() -> None:
    """Exact, NaN, at rest, still on the way; in a cycle of two or exact later by chance."""
    kinds = set()
    for seed in range(14):
        for left in both(seed)[1]:
            step = np.abs(left.correction).max(initial=0.0)
            if left.last_pass:
                kinds.add("exact")
            elif np.isnan(step):
                kinds.add("NaN")
            elif left.after == left.angles:
                kinds.add("at rest")
            else:
                kinds.add("on the way" if step > 1e-6 else "trembling")
    assert kinds >= {"exact", "NaN", "at rest", "on the way"}
