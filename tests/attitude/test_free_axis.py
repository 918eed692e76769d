"""The details of the flags of frames with weak geometry, by estimates made by hand."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved
from tests.kit import repeated_frame
from tests.kit.estimates import estimate, no_landmark, one_landmark
from tests.tolerances import assert_close
from vopd.attitude.geometry import LandmarkGeometry, free_turn_text, weak_axis_text
from vopd.attitude.history import History, history
from vopd.pipeline import run

FREE = re.compile(r"undetermined:turn about azimuth (\d+\.\d) elevation (-?\d+\.\d) is free")


def axis_of(one: History, frame: int = 0) -> np.ndarray:
    """The axis that the flag names, as a unit vector east, north, up."""
    found = FREE.search(one.flag_text[frame])
    assert found, one.flag_text[frame]
    azimuth, elevation = np.radians([float(found[1]), float(found[2])])
    level = np.cos(elevation)
    return np.array([level * np.sin(azimuth), level * np.cos(azimuth), np.sin(elevation)])


@pytest.mark.parametrize("landmark", range(4))
def test_with_one_landmark_the_turn_about_its_line_of_sight_is_free(landmark: int) -> None:
    one = history(one_landmark(landmark))
    towards = one.estimate.direction[0, landmark]
    assert_close("cosine of a printed axis", axis_of(one) @ towards, 1.0)
    assert "undetermined" not in one.flag_text[1]


def test_the_covariance_is_infinite_along_the_free_axis_only() -> None:
    """The camera looks straight at the landmark: only its roll is free, forward is the axis."""
    image = np.array([[0.0, 0.0], [3.0, 2.0], [-2.0, 3.0]])
    one = estimate([[30.0, -20.0, 0.0]], image)
    used = np.array([[True, False, False]])
    nothing = np.full_like(one.gain, np.nan)
    one = replace(one, used=used, gain=nothing, body_gain=nothing)
    covariance = history(one).uncertainty.covariance_deg2[0]
    assert covariance[0, 0] == np.inf and np.isfinite(covariance[1:, 1:]).all()
    sigma = history(one).uncertainty.total[0]
    assert np.isinf(sigma[[2, 5]]).all() and np.isfinite(sigma[[0, 1, 3, 4]]).all()


def test_without_a_landmark_nothing_is_said() -> None:
    assert history(no_landmark()).flag_text[0].split(";")[0] == "undetermined"


def test_a_deck_with_one_landmark() -> None:
    """Its body is that of the camera: the axis in the body, turned to north, east, down."""
    (one,) = run(repeated_frame.repeated(landmarks=[2], draws=1)).histories()
    towards = one.estimate.direction[0, 0]
    assert_close("cosine of a printed axis", axis_of(one) @ towards, 1.0)


def test_sigmas_about_the_weak_axis_and_the_others() -> None:
    turn = Rotation.from_euler("ZYX", [40.0, 20.0, 70.0], degrees=True).as_matrix()
    matrices = np.array([turn @ np.diag([0.01, 4.0, 0.0625]) @ turn.T, np.full((3, 3), np.inf)])
    shape = LandmarkGeometry(np.array([30.0, 30.0]), np.array([2, 0]), np.ones((2, 1)))
    told = weak_axis_text(shape, matrices, np.ones(len(matrices), bool))
    assert told == ["optical_axis sigma 2 others 0.25 0.1", "image_x_axis"]


def test_two_landmarks_close_together() -> None:
    """A turn about the line of sight moves one .1 px against the other, two readings of sigma."""
    one = history(estimate([[30.0, 0.0, 0.0]], np.array([[0.0, -0.05], [0.0, 0.05]])))
    detail = one.flags.detail["weak_geometry"][0]
    found = re.fullmatch(r"optical_axis sigma (\S+) others (\S+) (\S+)", detail)
    assert found and one.flags.raised["weak_geometry"][0]
    sigma = one.uncertainty.reading.sigma
    turn = np.degrees(sigma * np.sqrt(2.0) / 0.1)
    assert_close("ratio of three digits", float(found[1]) / turn, 1.0)


def level(turn: list[float], seen: list[list[float]], used: list[bool]) -> str:
    """What is said of a level vehicle heading north; directions are east, north, up."""
    e = estimate([[0.0, 0.0, 0.0]], np.zeros((len(seen), 2)))
    e = replace(e, direction=np.array([seen], float), used=np.array([used]))
    return free_turn_text(e, np.array([turn]))[0]


@pytest.mark.parametrize(
    ("turn", "seen", "used", "azimuth", "elevation"),
    [
        ([1.0, 0.0, 0.0], [[0.1, 1, 0]], [True], "0.0", "0.0"),
        ([1.0, 0.0, 0.0], [[0.1, -1, 0]], [True], "180.0", "0.0"),  # the landmark is behind
        ([0.0, 1.0, 0.0], [[1, 0, 0]], [True], "90.0", "0.0"),
        ([0.0, 1.0, 0.0], [[-1, 0, 0]], [True], "270.0", "0.0"),
        ([0.0, 0.0, 1.0], [[0, 0, -1]], [True], "0.0", "-90.0"),
        ([0.0, 0.0, 1.0 + 1e-15], [[0, 0, -1]], [True], "0.0", "-90.0"),  # by rounding
        ([0.6, 0.0, 0.8], [[0, 1, -1]], [True], "0.0", "-53.1"),
        ([0.6, 0.0, 0.8], [[0, -1, 1]], [True], "180.0", "53.1"),
        ([0.6, -0.8, 0.0], [[-1, 1, 0]], [True], "306.9", "0.0"),
        ([1.0, 0.0, 0.0], [[0, 1, 0], [0, -3, 0]], [True, False], "0.0", "0.0"),
        ([1.0, 0.0, 0.0], [[0, 1, 0], [0, -3, 0]], [True, True], "180.0", "0.0"),
        ([1.0, 0.0, 0.0], [[0, -1, 0], [0, np.nan, 0]], [True, True], "180.0", "0.0"),
    ],
)
def test_the_end_of_the_free_axis_on_the_landmarks_side(
    turn: list[float], seen: list[list[float]], used: list[bool], azimuth: str, elevation: str
) -> None:
    said = level(turn, seen, used)
    assert_approved(said.replace("-0.0 ", "0.0 "), parts=[azimuth, elevation])


@pytest.mark.parametrize("turn", [[0.0, 0.0, 0.0], [np.nan, 0.0, 0.0]])
def test_no_free_axis_no_words(turn: list[float]) -> None:
    assert level(turn, [[0, 1, 0]], [True]) == ""


def test_a_covariance_that_is_singular_by_rounding_has_a_sigma_of_nothing() -> None:
    shape = LandmarkGeometry(np.full(3, 30.0), np.array([0, 1, 2]), np.ones((3, 1)))
    some = np.array([np.diag([4.0, -1e-20, 1.0]), np.diag([0.0, 4.0, 9.0]), np.eye(3)])
    told = weak_axis_text(shape, some, np.array([True, True, False]))
    assert told == ["image_x_axis sigma 2 others 1 0", "image_y_axis sigma 3 others 2 0", ""]
