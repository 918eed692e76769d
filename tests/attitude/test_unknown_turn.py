"""What an undetermined frame leaves open, and that the rest of its attitude is known."""

from __future__ import annotations

import re

import numpy as np
from scipy.spatial.transform import Rotation

from tests.kit import estimates
from tests.kit.jobs import case, only, turned
from tests.kit.wgs84_film import camera_matrix
from tests.tolerances import within
from vopd.attitude.unknown_turn import unknown_turns
from vopd.pipeline import run

ANGLES = np.array([140.0, -70.0, 60.0])
TURN = re.compile(r"turn_about_landmark_(.+)_azimuth_([\d.]+)_elevation_(-?[\d.]+)$")


def test_one_landmark_of_case_1() -> None:
    """Direction cosines as printed: -.3354096, -.5099642, -.7921091 east, north, up."""
    (one,) = run(only(case(1), 0)).histories()
    assert one.flag_text == ["undetermined:turn_about_landmark_65_azimuth_213.33_elevation_-52.38"]
    azimuth = np.degrees(np.arctan2(-0.3354096, -0.5099642)) % 360.0
    assert f"{azimuth:.2f}" == "213.33" and f"{np.degrees(np.arcsin(-0.7921091)):.2f}" == "-52.38"


def test_the_truth_is_the_solution_turned_about_the_line_that_is_named() -> None:
    """From a start 40 degrees off the solve ends elsewhere, by a turn about this line alone."""
    job = turned(np.array([ANGLES]), ANGLES + np.array([25.0, 5.0, -30.0]))
    (one,) = run(only(job, 2)).histories()
    found = TURN.search(one.flag_text[0].split(";")[0])
    assert found is not None
    azimuth, elevation = np.radians([float(found[2]), float(found[3])])
    line = [
        np.sin(azimuth) * np.cos(elevation),
        np.cos(azimuth) * np.cos(elevation),
        np.sin(elevation),
    ]
    solved, truth = camera_matrix(*one.estimate.camera_deg[0]), camera_matrix(*ANGLES)
    between = Rotation.from_matrix(truth.T @ solved).as_rotvec(degrees=True)
    assert np.linalg.norm(between) > 3.0
    aside = np.linalg.norm(np.cross(between, line))
    assert aside < within("line of two decimals") * np.linalg.norm(between)


def test_a_landmark_read_twice_is_named_once() -> None:
    (one,) = run(only(turned(np.array([ANGLES]), ANGLES), 2, 2)).histories()
    assert "undetermined:turn_about_landmark_13_azimuth" in one.flag_text[0]


def test_what_else_can_be_open() -> None:
    """Straight down; no landmark; no angles; named landmarks on one line; a frame not asked for."""
    down = np.tile([10.0, -90.0, 0.0], (5, 1))
    one = estimates.estimate(np.zeros((5, 3)), camera_deg=down)
    used, direction = one.used.copy(), one.direction.copy()
    used[1] = False
    direction[2] = np.nan
    used[3] = [True, True, False, False]
    direction[3] = [0.0, 1.0, 0.0]
    bent = estimates.estimate(np.zeros((5, 3)), camera_deg=down, used=used, direction=direction)
    bent.camera_deg[2] = np.nan
    assert unknown_turns(bent, np.array([True] * 4 + [False])) == [
        "yaw_and_roll_apart",
        "all_angles",
        "all_angles",
        "turn_about_landmark_church tower+bridge, north end_azimuth_0.00_elevation_0.00",
        "",
    ]
