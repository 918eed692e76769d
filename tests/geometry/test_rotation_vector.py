"""Rotations by their vector against scipy's `Rotation`."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.geometry.rotations import rotation_matrices


@pytest.mark.parametrize("size_rad", [0.0, 1e-12, 1e-6, 9e-4, 1.1e-3, 0.1, 1.0, 3.0, 30.0])
def test_matrices_as_scipy_has_them(size_rad: float) -> None:
    vector = size_rad * np.random.default_rng(5).uniform(-1.0, 1.0, (200, 3))
    assert_close("rae element", rotation_matrices(vector), Rotation.from_rotvec(vector).as_matrix())
