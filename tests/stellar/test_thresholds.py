"""The single rotation where it ends: axes near the plane of the stars, turns near none."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.star_files import COSINES
from tests.kit.star_files import solve_text as solve

AXIS = np.array([0.3, 0.2, -1.0]) / np.sqrt(1.13)


def turned_pair(dihedral_sine: float, angle_deg: float = 30.0, first: float = 10.0) -> str:
    """Two stars that one turn about AXIS carries onto images with this sine(D1, D2).

    D1 and D2 are at right angles to the axis, turned like the stars' arms: the angle
    between them is that between the planes through the axis and each star.
    """
    side = np.cross(AXIS, [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    lines = []
    for cone_deg, about in ((first, 0.0), (25.0, np.arcsin(dihedral_sine))):
        arm = Rotation.from_rotvec(about * AXIS).apply(side)
        ray = np.cos(np.radians(cone_deg)) * AXIS + np.sin(np.radians(cone_deg)) * arm
        star = Rotation.from_rotvec(np.radians(-angle_deg) * AXIS).apply(ray)
        lines.append(",".join(f"{v:.17g}" for v in (*(ray[:2] * -76.0 / ray[2]), *star)))
    return COSINES + "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("sine", "status", "said"),
    [
        (0.5e-6, 1, "lines 2 and 3: single-rotation: the rotation axis lies in the plane"),
        (2e-6, 0, "= 0.000 is below 0.2"),
        (0.19, 0, "= 0.190 is below 0.2"),
        (0.21, 0, ""),
    ],
)
def test_the_thresholds_of_an_axis_in_the_stars_plane(sine: float, status: int, said: str) -> None:
    result = solve(turned_pair(sine), "--method", "single-rotation")
    assert result.status == status
    assert said in result.stderr
    assert result.stderr.startswith("warning: ") == (status == 0 and said != "")
    assert (result.stderr == "") == (said == "")


@pytest.mark.parametrize(("angle_deg", "first"), [(0.0, 10.0), (1e-5, 10.0), (30.0, 0.0)])
def test_no_rotation_and_a_star_on_the_axis(angle_deg: float, first: float) -> None:
    result = solve(turned_pair(0.5, angle_deg, first), "--method", "single-rotation")
    assert result.status == 1
    assert "lines 2 and 3: single-rotation: the rotation is zero, or a star" in result.stderr
    assert solve(turned_pair(0.5, angle_deg, first), "--method", "two-star").status == 0
