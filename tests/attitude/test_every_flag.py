"""Every flag: its words for any source, and the condition that raises it, from both sides."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.approved.texts import assert_approved
from tests.kit.estimates import POINTS, WORDS, estimate
from vopd.attitude.flags import MEANING, Flags, flags, meanings
from vopd.attitude.geometry import LandmarkGeometry
from vopd.attitude.history import History, history
from vopd.attitude.long_history import frame_landmarks
from vopd.attitude.sigmas import Sigmas

GENERAL = {
    "not_converged": (
        "the last correction exceeds 1e-6 rad or is not a number",
        "look at the measured coordinates and at the first estimate",
    ),
    "undetermined": (
        "fewer than two landmarks, or equations without a solution: the angles are one of many "
        "attitudes that fit; what is not known is named",
        "measure more landmarks",
    ),
    "out_of_range": (
        "an angle of camera or vehicle is beyond a full circle: the solve diverged",
        "look at the measured coordinates and at the first estimate",
    ),
    "behind_camera": (
        "a landmark lies behind the camera: the solve ended at the other solution",
        "give a first estimate that looks at the landmarks",
    ),
    "two_landmarks": (
        "two landmarks only: one degree of freedom, and an exchanged pair cannot be seen",
        "measure a third landmark",
    ),
    "weak_geometry": (
        "one rotation axis is determined 20 times worse than the best one (condition number); it "
        "is named",
        "measure landmarks farther apart in the image",
    ),
    "second_solution": (
        "an attitude with the landmarks on the camera's other side fits as well, its residuals at "
        "most 3 times these or 3 times the reading sigma (root mean square)",
        "make sure that the first estimate looks at the ground",
    ),
    "pitch_near_90": (
        "camera or vehicle pitch within 5 degrees of 90: yaw and roll are not separate",
        "use the quaternion",
    ),
    "outlier": (
        "a landmark does not fit the others (F test, .001 a frame, four landmarks or more); it is "
        "named",
        "measure it again, or leave it out",
    ),
    "misfit": (
        "the residuals do not agree with the standard deviations in force (chi-square or F test, "
        ".001 a frame, two landmarks or more); an exchange of two labels or one landmark that "
        "explains it is named, with the chance of the residuals that then remain",
        "look at the landmarks that are named",
    ),
    "model_error": (
        "correcting all errata of the original program changes an angle of vehicle or camera by "
        "more than its standard deviation, which does not include them; the angle is named",
        "correct the errata: --fix all",
    ),
    "jump": (
        "turns faster than --max-rate against a neighbour",
        "look at the frame's landmarks and time",
    ),
}


def test_the_words_of_every_flag_for_any_source() -> None:
    assert_approved(MEANING)
    assert [*MEANING] == [*GENERAL]
    assert_approved(meanings(WORDS))
    other = ("what", "do")
    assert_approved(meanings(replace(WORDS, flags={"misfit": other})))


FRAMES = 3
ANGLES = np.tile([140.0, -60.0, 20.0], (FRAMES, 1))
NOTHING = np.full((FRAMES, 3), np.nan)


def made(
    shape: dict[str, Any] | None = None, second: float = np.nan, **changes: Any
) -> tuple[Flags, History]:
    """The flags of three alike frames, of which the landmark geometry may be another."""
    e = estimate(ANGLES, **({"frame_names": ()} | changes))
    one = history(e, sigmas=Sigmas(reading=0.5))
    geometry = LandmarkGeometry(
        **({"condition": np.full(FRAMES, 5.0), "weak_axis": np.zeros(FRAMES, np.int64),
            "behind": np.zeros(FRAMES, bool)} | (shape or {}))
    )  # fmt: skip
    every = np.ones(FRAMES)
    found = flags(
        e, geometry, one.quaternion, 0.1 * every, one.uncertainty, 0.5 * every, [""] * FRAMES,
        second * every,
    )  # fmt: skip
    return found, one


def raised(found: Flags) -> dict[str, list[int]]:
    return {name: np.flatnonzero(on).tolist() for name, on in found.raised.items() if on.any()}


def pitched(which: str, pitch: float) -> dict[str, Any]:
    angles = ANGLES.copy()
    angles[1, 1] = pitch
    return {which: angles}


def turned(which: str, angle: int, value: float) -> dict[str, Any]:
    angles = ANGLES.copy()
    angles[2, angle] = value
    return {which: angles}


def of_frame(frame: int, **values: Any) -> dict[str, Any]:
    """Arrays in which one frame has another value than usual."""
    usual = {"condition": np.full(FRAMES, 5.0), "behind": np.zeros(FRAMES, bool),
             "converged": np.ones(FRAMES, bool), "used": np.ones((FRAMES, 4), bool)}  # fmt: skip
    for name, value in values.items():
        usual[name] = usual[name].copy()
        usual[name][frame] = value
    return {name: usual[name] for name in values}


OUT = {"out_of_range": [2]}


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, {}),
        (of_frame(1, converged=False), {"not_converged": [1]}),
        (of_frame(1, used=[True, True, True, False]), {}),
        (of_frame(1, used=[True, True, False, False]), {"two_landmarks": [1]}),
        (of_frame(1, used=[False, True, False, False]), {"undetermined": [1]}),
        (of_frame(1, used=False), {"undetermined": [1]}),
        ({"shape": of_frame(2, condition=20.0)}, {}),
        ({"shape": of_frame(2, condition=20.001)}, {"weak_geometry": [2]}),
        ({"shape": of_frame(2, condition=np.inf)}, {"weak_geometry": [2]}),
        ({"shape": of_frame(2, condition=np.nan)}, {"weak_geometry": [2]}),
        ({"shape": of_frame(0, behind=True)}, {"behind_camera": [0]}),
        ({"second": 1.5}, {"second_solution": [0, 1, 2]}), ({"second": 1.5001}, {}),
        (turned("camera_deg", 0, 360.0009), {}), (turned("camera_deg", 0, 360.0011), OUT),
        (turned("camera_deg", 2, -361.0), OUT), (turned("vehicle_deg", 2, 361.0), OUT),
        (turned("vehicle_deg", 2, -359.0), {}),
        (pitched("camera_deg", -84.99), {}),
        (pitched("camera_deg", -85.01), {"pitch_near_90": [1]}),
        (pitched("camera_deg", 94.99), {"pitch_near_90": [1]}),
        (pitched("camera_deg", 95.01), {}), (pitched("camera_deg", 180.0), {}),
        (pitched("vehicle_deg", 85.01), {"pitch_near_90": [1]}),
        (pitched("vehicle_deg", 84.99), {}),
        (turned("vehicle_deg", 2, 90.0), {}), (turned("vehicle_deg", 0, 90.0), {}),
        (turned("camera_deg", 2, 90.0), {}), (turned("camera_deg", 0, 270.0), {}),
    ],
)  # fmt: skip
def test_what_raises_a_flag_and_what_does_not(
    changes: dict[str, Any], expected: dict[str, list[int]]
) -> None:
    """One frame of three is changed, to a value at each side of a limit."""
    found, _ = made(**changes)
    assert raised(found) == expected
    assert found.any().tolist() == [
        any(k in frames for frames in expected.values()) for k in range(FRAMES)
    ]


def test_frames_without_an_attitude_have_no_flag_but_that_they_are_undetermined() -> None:
    """Nothing is said of geometry, pitch or landmarks behind a camera that looks nowhere."""
    none = np.full((FRAMES, 3, 8), np.nan)
    lost: dict[str, Any] = {
        "camera_deg": NOTHING, "vehicle_deg": NOTHING, "gain": none, "body_gain": none,
        "shape": {"condition": np.full(FRAMES, np.nan), "behind": np.ones(FRAMES, bool)},
        "second": 0.1,
    }  # fmt: skip
    assert raised(made(**lost)[0]) == {"undetermined": [0, 1, 2]}
    left_out = {"solved": np.zeros(FRAMES, bool), "used": np.zeros((FRAMES, 4), bool)}
    assert raised(made(**lost, **left_out)[0]) == {}
    pair = np.tile([True, True, False, False], (FRAMES, 1))
    unsolved = {"solved": np.zeros(FRAMES, bool), "used": pair}
    assert raised(made(**lost, **unsolved)[0]) == {}


def test_what_is_said_of_frames_of_which_only_something_is_known() -> None:
    """A correction that is not a number has not converged; what a source has tested stands; and
    the vehicle's angles are not needed for what is said of the camera.
    """
    none = np.full((FRAMES, 3, 8), np.nan)
    outlier = np.zeros((FRAMES, 4), bool)
    outlier[1, 2] = True
    lost, _ = made(
        camera_deg=NOTHING, vehicle_deg=NOTHING, gain=none, body_gain=none, outlier=outlier,
        **of_frame(0, converged=False),
    )  # fmt: skip
    assert raised(lost) == {"not_converged": [0], "undetermined": [0, 1, 2], "outlier": [1]}
    weak = {"condition": np.full(FRAMES, 30.0), "behind": np.ones(FRAMES, bool)}
    level, _ = made(shape=weak, vehicle_deg=NOTHING, second=0.1)
    assert [*raised(level)] == ["behind_camera", "weak_geometry", "second_solution"]


def test_equations_without_a_solution_are_undetermined_and_not_weak() -> None:
    gain = np.tile(np.linalg.pinv(estimate(ANGLES[:1]).partials[0]), (FRAMES, 1, 1))
    gain[1, 2, 5] = np.nan
    found, _ = made(gain=gain, body_gain=gain, shape=of_frame(1, condition=1e9))
    assert raised(found) == {"undetermined": [1]}


def test_details_stand_behind_a_colon_and_flags_between_semicolons() -> None:
    outlier = np.zeros((FRAMES, 4), bool)
    outlier[1, 2] = True
    found, _ = made(
        **pitched("camera_deg", -87.0), vehicle_deg=np.tile([140.0, -88.0, 20.0], (FRAMES, 1)),
        outlier=outlier, shape=of_frame(1, condition=30.0), **of_frame(0, converged=False),
    )  # fmt: skip
    text = found.text()
    assert text[0] == "not_converged;pitch_near_90:vehicle_pitch"
    assert text[1].startswith("weak_geometry:image_x_axis sigma ")
    assert text[1].endswith(";pitch_near_90:camera_pitch+vehicle_pitch;outlier:=A1")
    assert text[2] == "pitch_near_90:vehicle_pitch"
    some = found.take(slice(1, 3))
    assert some.text() == text[1:]


def test_the_landmark_that_a_source_has_tested_already_counts() -> None:
    """And not the test made anew, by which the first one would be named here."""
    residual = np.zeros((FRAMES, 10))
    residual[:, 0] = 30.0
    residual += np.random.default_rng(2).normal(0.0, 0.01, residual.shape)
    points = np.vstack([POINTS, [[-1.0, 3.0]]])
    marked = np.zeros((FRAMES, 5), bool)
    marked[1, 3] = True
    ours = history(estimate(ANGLES, points, residual=residual))
    assert frame_landmarks(ours).outlier.tolist() == [True, False, False, False, False] * FRAMES
    assert ours.flags.raised["outlier"].all()
    theirs = history(estimate(ANGLES, points, residual=residual, outlier=marked))
    assert frame_landmarks(theirs).outlier.tolist() == marked.ravel().tolist()
    assert theirs.flags.detail["outlier"] == ["", "<crossing>", ""]
