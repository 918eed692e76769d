"""What a history says of each frame besides the angles, and what long jobs are searched for."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.estimates import ABOUT, POINTS, estimate
from tests.tolerances import assert_close
from vopd.attitude import long_history
from vopd.attitude.history import History, HistoryOptions, history
from vopd.attitude.long_history import history_of_long_job, with_about
from vopd.attitude.mistakes import MOST_FRAMES
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import table
from vopd.attitude.vertical import with_vertical
from vopd.estimate import FrameStatus
from vopd.landmark_layout import LandmarkLayout

ANGLES = np.tile([140.0, -60.0, 20.0], (5, 1))


def made(**changes: Any) -> History:
    """Five frames: solved, ignored, exact, stopped and unsolved; only two have angles."""
    known = np.array([True, False, True, False, False])
    e = estimate(ANGLES)
    angles = np.where(known[:, None], ANGLES, np.nan)
    gain = np.where(known[:, None, None], e.gain, np.nan)
    correction = np.array([[1e-9, -3e-7, 2e-8], [0, 0, 0], [0, 0, 4e-8], [0, 0, 0], [0, 0, 0.0]])
    status = np.array([*FrameStatus])
    return history(
        estimate(
            ANGLES, about=ABOUT._replace(job=7), camera_deg=angles, vehicle_deg=angles, gain=gain,
            body_gain=gain, solved=known, correction_rad=correction, status=status,
            used=np.tile(np.arange(4) < 3, (5, 1)), **changes,
        ),
        sigmas=Sigmas(reading=0.25),
    )  # fmt: skip


def test_values_of_frames_that_are_solved_and_that_are_not() -> None:
    one = made()
    assert one.status == ["solved", "ignored", "exact", "stopped", "unsolved"]
    assert one.has_attitude.tolist() == [True, False, True, False, False]
    assert np.array_equal(
        one.last_correction_rad, [3e-7, np.nan, 4e-8, np.nan, np.nan], equal_nan=True
    )
    assert one.job_number.tolist() == [7] * 5
    assert one.landmarks.tolist() == [3] * 5
    assert one.reading_sigma.tolist() == [0.25] * 5
    assert one.reading_freedom.tolist() == [np.inf] * 5
    assert one.source_name == ["hand.toml"] * 5
    assert one.image_name == [f"DJI_{k:04}.JPG" for k in range(5)]
    assert made(frame_names=()).image_name == [""] * 5
    assert np.isnan(one.quaternion[[1, 3, 4]]).all() and np.isfinite(one.quaternion[[0, 2]]).all()
    assert np.isnan(one.residual_rms[[1, 3, 4]]).all() and not one.residual_rms[[0, 2]].any()


def test_the_last_correction_is_that_of_frames_that_were_solved() -> None:
    """Of three the largest by its size, also where that is 0; whatever stands in other frames."""
    correction = np.array([[0.0, 0.0, 0.0], [1e-3, 0.0, 0.0], [1e-9, -5e-9, 3e-9]])
    one = history(
        estimate(ANGLES[:3], correction_rad=correction, solved=np.array([True, False, True])),
        sigmas=Sigmas(reading=0.25),
    )
    assert np.array_equal(one.last_correction_rad, [0.0, np.nan, 5e-9], equal_nan=True)


def test_columns_of_these_values() -> None:
    """Infinite degrees of freedom are a missing number: they are no part of the uncertainty."""
    found = table([made(), made()])
    assert found["job"].tolist() == [7] * 10
    assert found["status"].tolist() == ["solved", "ignored", "exact", "stopped", "unsolved"] * 2
    assert np.isnan(found["degrees_of_freedom"]).all()
    assert np.isnan(found["last_correction_rad"][[1, 3, 4]]).all()
    assert found["landmarks"].tolist() == [3] * 10


def test_columns_of_jobs_of_which_one_lacks_a_component() -> None:
    """NaN for the job without; the others keep their values."""
    plain = history(estimate(ANGLES), sigmas=Sigmas(reading=0.25))
    moved = history(estimate(ANGLES), sigmas=Sigmas(reading=0.25, position=2.0))
    found = table([plain, moved])["sigma_position_camera_pitch_deg"]
    assert np.isnan(found[:5]).all()
    assert_close("ratio", found[5:], moved.uncertainty.components["position"][:, 1])
    effect = np.arange(45.0).reshape(5, 9)
    slips = history(estimate(ANGLES, slip_effect_deg=effect), sigmas=Sigmas(reading=0.25))
    found = table([plain, slips])["slip_effect_vehicle_roll_deg"]
    assert np.isnan(found[:5]).all() and found[5:].tolist() == effect[:, 5].tolist()


def test_the_axis_of_figures_is_the_time_where_any_frame_has_one() -> None:
    times = np.array([np.nan, 1.0, np.nan, np.nan, 2.0])
    values, label = made(time_s=times).order_axis
    assert label == "time, s" and np.array_equal(values, times, equal_nan=True)
    values, label = made(time_s=np.full(5, np.nan)).order_axis
    assert (label, values.tolist()) == ("frame", [1.0, 2.0, 3.0, 4.0, 5.0])


def test_other_words_about_a_history_leave_it_as_it_was() -> None:
    one = made()
    other = with_about(one, ABOUT._replace(source="b.toml"))
    assert other.about.source == other.estimate.about.source == "b.toml"
    assert one.about.source == one.estimate.about.source == "hand.toml"
    assert other.estimate.camera_deg is one.estimate.camera_deg


def test_the_effect_of_the_velocity_goes_with_the_axes() -> None:
    """A change of the velocity in space has the same effect by either vertical."""
    rng = np.random.default_rng(3)
    e = estimate(ANGLES)
    by_velocity = rng.normal(size=(5, 3, 3))
    e = estimate(ANGLES, responses=replace(e.responses, attack_by_velocity=by_velocity))
    other = with_vertical(e, "geocentric")
    push = rng.normal(size=3)
    for one in (e, other):
        by_axes = one.position.north_east_down @ push
        effect = np.einsum("fij,fj->fi", one.responses.attack_by_velocity, by_axes)
        expected = np.einsum("fij,fj->fi", by_velocity, e.position.north_east_down @ push)
        assert_close("ratio", effect, expected)
    turn = other.position.north_east_down @ e.position.north_east_down.swapaxes(1, 2)
    assert_close("ratio", np.abs(turn[:, 0, 2]), np.sin(np.radians(0.19)))
    assert other.responses.attack_by_time is e.responses.attack_by_time


@pytest.mark.parametrize("most", [0, 1, 4, 5, 6, 11])
def test_so_many_frames_of_a_long_job_are_searched(
    most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ten frames that all misfit, in runs of two blocks of two: the first ones are searched."""
    assert MOST_FRAMES == 200
    monkeypatch.setattr(long_history, "MOST_FRAMES", most)
    monkeypatch.setattr(long_history, "TOGETHER", 20)
    monkeypatch.setattr(long_history, "AT_ONCE", 8)
    e = estimate(np.repeat(ANGLES, 2, axis=0), noise=1.0)
    layout, options = LandmarkLayout(np.full(10, 4)), HistoryOptions(Sigmas(reading=1e-3))
    job = history_of_long_job(layout, e.take, options)
    for histories in ([*job], [job.whole]):
        assert all(one.flags.raised["misfit"].all() for one in histories)
        told = [text != "" for one in histories for text in one.flags.detail["misfit"]]
        assert told == [k < most for k in range(10)]


def test_an_estimate_without_landmarks_has_the_same_frames() -> None:
    one = estimate(ANGLES, POINTS)
    bare = one.without_landmarks()
    assert bare.camera_deg is one.camera_deg and bare.frame_names is one.frame_names
    assert {*vars(one)} - {*vars(bare)} == {
        "landmark", "used", "ignored", "direction", "image", "residual", "partials", "gain",
        "body_gain", "vehicle_by_camera", "responses", "relative_sigma", "outlier",
    }  # fmt: skip
