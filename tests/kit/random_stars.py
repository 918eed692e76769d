"""Stars of one photograph, drawn at random, with reading errors."""

from __future__ import annotations

import numpy as np

from vopd.stellar.field import StarField

FOCAL = 50.0


def stars(count: int, sigma: float = 0.01) -> StarField:
    """So many within 15 mm of the centre, seen along the camera's own axes."""
    rng = np.random.default_rng(count)
    images = rng.uniform(-15.0, 15.0, (count, 2))
    rays = np.column_stack([images, np.full(count, -FOCAL)])
    noisy = images + rng.normal(0.0, sigma, images.shape) if sigma else images
    return StarField.of(rays / np.linalg.norm(rays, axis=1)[:, None], noisy, FOCAL)
