"""Standard deviations of a resection in the command's output, against numerical derivatives."""

from __future__ import annotations

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.command import DECKS, vopd
from tests.tolerances import assert_close

GROUND = DECKS / "stars" / "ground_points.csv"
FOCAL, SIGMA, STEP = 152.4, 0.01, 1e-6


def test_they_are_those_of_the_normal_equations() -> None:
    """The example, and the images' derivatives by small turns about camera axes and by metres."""
    options = ("--focal", FOCAL, "--resection", "--reading-sigma", SIGMA, "--format", "json")
    result = vopd("stars", "solve", GROUND, *map(str, options))
    assert result.status in (0, 3), result.stderr
    (row,) = json.loads(result.stdout)
    lines = [line for line in GROUND.read_text().splitlines() if not line.startswith("#")]
    points = np.array([line.split(",")[2:5] for line in lines[1:]], float)

    def seen(change: np.ndarray) -> np.ndarray:
        turned = Rotation.from_rotvec(change[:3]).as_matrix() @ np.array(row["matrix"])
        x, y, z = turned @ (points - np.array(row["camera_m"]) - 1000.0 * change[3:]).T
        return np.concatenate([-FOCAL * x / z, -FOCAL * y / z])

    design = np.column_stack([(seen(one) - seen(-one)) / (2.0 * STEP) for one in STEP * np.eye(6)])
    sigmas = SIGMA * np.sqrt(np.diag(np.linalg.inv(design.T @ design)))
    found = [*row["rotation_sigma_arcsec"], *row["camera_sigma_m"]]
    expected = [*np.degrees(sigmas[:3]) * 3600.0, *1000.0 * sigmas[3:]]
    assert_close("rae sigma by differences", np.divide(found, expected), np.ones(6))


@pytest.mark.parametrize("count", [4, 5])
def test_the_reading_sigma_by_the_residuals(count: int) -> None:
    """Two coordinates a point, less six unknowns; one that is given has no degrees of freedom."""
    lines = [line for line in GROUND.read_text().splitlines() if not line.startswith("#")]
    text = "\n".join(lines[: 1 + count]) + "\n"
    options = ("--focal", str(FOCAL), "--resection", "--format", "json")
    (row,) = json.loads(vopd("stars", "solve", "-", *options, stdin=text).stdout)
    squares = (np.array(row["residuals_mm"]) ** 2).sum()
    assert row["reading_freedom"] == 2 * count - 6
    assert_close(
        "rae sigma by differences", row["reading_sigma_mm"], np.sqrt(squares / (2 * count - 6))
    )
    given = vopd("stars", "solve", "-", *options, "--reading-sigma", "0.02", stdin=text)
    (stated,) = json.loads(given.stdout)
    assert stated["reading_sigma_mm"] == 0.02 and "reading_freedom" not in stated
    for name in ("rotation_sigma_arcsec", "camera_sigma_m"):
        ratio = np.divide(stated[name], row[name]) * row["reading_sigma_mm"]
        assert_close("rae sigma by differences", ratio, 0.02 * np.ones(3))
