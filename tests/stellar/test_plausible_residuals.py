"""How large residuals may be beside what the interstar angles say, for few stars and for more."""

from __future__ import annotations

import numpy as np
import pytest

from vopd.stellar.field import StarField
from vopd.stellar.files.mistakes import _implausible
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm
from vopd.stellar.outlier_search import fit_attitude

FOCAL_MM = 50.0


def photograph(count: int) -> StarField:
    """Stars read to about .001 mm."""
    rng = np.random.default_rng(count)
    images = rng.uniform(-15.0, 15.0, (count, 2))
    rays = np.column_stack([images, np.full(count, -FOCAL_MM)])
    stars = rays / np.linalg.norm(rays, axis=1)[:, None]
    return StarField.of(stars, images + rng.normal(0.0, 1e-3, images.shape), FOCAL_MM)


@pytest.mark.parametrize(
    ("count", "times", "implausible"),
    [
        (3, 49.0, False), (3, 51.0, True), (4, 49.0, False), (4, 51.0, True),
        (5, 4.9, False), (5, 5.1, True), (12, 4.9, False), (12, 5.1, True),
    ],
)  # fmt: skip
def test_the_limit_is_five_times_and_of_four_stars_or_fewer_fifty(
    count: int, times: float, implausible: bool
) -> None:
    stars = photograph(count)
    interstar = interstar_reading_sigma_mm(stars)
    fit = fit_attitude(stars)._replace(variance_mm2=(times * interstar) ** 2)
    allowed = f"the interstar angles allow {interstar:.3g} mm"
    assert _implausible(fit, stars, None, "mm") == (allowed if implausible else "")
