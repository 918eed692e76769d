"""The report's sample data: four fictitious stars (tables 6.1 to 6.3, program CHURCH)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.stellar.field import StarField

FOCAL_LENGTH_MM = 76.0

TRUTH_DEG = np.array([156.1413452, -18.7472372, 46.0052148])
"""omega, phi, kappa the stars were made with: alpha 50, delta 60, swing 10."""

EXACT_MM = np.array([[24.0, 24.0], [-15.0, 15.0], [-24.0, -24.0], [20.0, -10.0]])
"""Images without errors (table 6.1)."""

PERTURBED_MM = np.array([[24.1, 23.8], [-15.2, 15.3], [-23.7, -24.0], [19.8, -10.0]])
"""Images with the errors that tables 6.4, 6.5 and figures 6.1 to 6.3 are about (table 6.3)."""

DIRECTIONS = np.array(
    [
        [0.286684559, -0.022212524, 0.957767491],
        [0.055018946, 0.408177992, 0.911242911],
        [0.300233062, 0.721673709, 0.623736456],
        [0.560369112, 0.246933809, 0.790575836],
    ]
)
"""U, V, W to nine digits, as CHURCH and TESTU hold them in DATA."""


def sample_field(image_mm: Floats = PERTURBED_MM) -> StarField:
    """The four stars with the perturbed images, or with other images."""
    return StarField.of(DIRECTIONS, image_mm, FOCAL_LENGTH_MM)
