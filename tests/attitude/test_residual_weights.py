"""Weights of residuals by full matrices, and what flags, parts and columns say of frames."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.kit.estimates import ABOUT, NAMES, estimate
from tests.kit.histories import histories
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.attitude.flags import _names, model_error
from vopd.attitude.history import History, history
from vopd.attitude.long_history import HistoryParts, one_part
from vopd.attitude.residuals import ResidualEquations, ResidualWeights
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import columns_of
from vopd.geometry.linear import crossing
from vopd.geometry.rotation_fit import Sights

ANGLES = np.tile([140.0, -60.0, 20.0], (5, 1))


def equations(frames: int = 3, landmarks: int = 5, causes: int = 2) -> ResidualEquations:
    """Random ones; the last landmark of each frame takes no part, x and y differ in variance."""
    rng = np.random.default_rng(8)
    two = 2 * landmarks
    used = np.tile(np.arange(landmarks) < landmarks - 1, (frames, 2))
    return ResidualEquations(
        np.where(used, rng.normal(size=(frames, two)), 0.0),
        np.where(used[..., None], rng.normal(size=(frames, two, 3)), 0.0),
        np.where(used, rng.uniform(0.5, 4.0, (frames, two)), 0.0),
        np.where(used[..., None], rng.normal(size=(frames, two, causes)), 0.0),
        np.where(used[..., None], 0.3 * rng.normal(size=(frames, two, 3)), 0.0),
    )


def dense(one: ResidualEquations, k: int, sigma: float) -> tuple[Floats, Floats, Floats]:
    """Indices of a frame's used coordinates, W of these, and the variances in reading sigmas."""
    used = np.flatnonzero(one.variance[k] > 0.0)
    count = one.variance.shape[1] // 2
    same = np.equal.outer(used % count, used % count)
    own = one.own[k][used]
    v = sigma**2 * np.diag(one.variance[k][used]) + np.where(same, own @ own.T, 0.0)
    v += one.shared[k][used] @ one.shared[k][used].T
    b, p = one.partials[k][used], np.linalg.inv(v)
    return used, p - p @ b @ np.linalg.inv(b.T @ p @ b) @ b.T @ p, one.variance[k][used]


@pytest.mark.parametrize("causes", [0, 1, 2])
@pytest.mark.parametrize("sigmas", [0.7, (0.5, 1.0, 2.0)])
def test_weights_are_those_of_the_whole_covariance(causes: int, sigmas: Any) -> None:
    one = equations(causes=causes)
    weights = ResidualWeights(one, np.array(sigmas) if isinstance(sigmas, tuple) else sigmas)
    weighted = weights.of(one.residual[..., None])[..., 0]
    for k in range(3):
        sigma = sigmas[k] if isinstance(sigmas, tuple) else sigmas
        used, w, variance = dense(one, k, sigma)
        expected = np.zeros(10)
        expected[used] = w @ one.residual[k][used]
        assert_close("ratio", weighted[k], expected)
        assert_close("ratio", weights.trace[k] / np.trace(w @ np.diag(variance)), 1.0)
    assert one.freedom.tolist() == [5.0] * 3


def test_names_of_outliers_keep_no_semicolon() -> None:
    """Landmark 8 is called "bridge; north end"; a semicolon parts flags."""
    e = estimate(ANGLES)
    outlier = np.zeros((5, 4), bool)
    outlier[1, 1] = outlier[3, 0] = True
    assert NAMES[8] == "bridge; north end"
    assert _names(e, outlier) == ["", "bridge, north end", "", NAMES[7], ""]
    assert _names(estimate(ANGLES, landmark_names={}), outlier) == ["", "8", "", "7", ""]


def test_the_angle_that_errata_change_by_the_most_standard_deviations() -> None:
    """Of vehicle and camera; an effect of exactly one standard deviation is none."""
    sigma = np.tile([1.0, 2.0, 0.1, 1.0, 0.5, 1.0, 0.01, 0.01, 0.01], (5, 1))
    effect = np.zeros((5, 9))
    effect[0, [0, 2]] = 3.0, -0.5  # 3 and 5 times
    effect[1, [1, 4]] = 2.0, 0.5  # once
    effect[2, [3, 0]] = 2.0, 2.0  # of two alike the vehicle's
    effect[3, 6:] = 9.0  # angles of attack are not tested
    effect[4, 5] = np.nan
    found, worst = model_error(estimate(ANGLES, slip_effect_deg=effect), sigma)
    assert found.tolist() == [True, False, True, False, False]
    assert (worst[0], worst[2]) == ("camera_roll", "vehicle_yaw")
    none, empty = model_error(estimate(ANGLES), sigma)
    assert not none.any() and empty == [""] * 5


FIRST = ["flight", "job", "frame", "image", "status", "time_s", "camera_yaw_deg"]


def test_the_columns_in_their_order() -> None:
    """The image stands after the frame, the gimbal before the standard deviations."""
    one = history(estimate(ANGLES, gimbal_deg=ANGLES), sigmas=Sigmas(reading=1.0, position=1.0))
    names = [column.name for column in columns_of([one])]
    assert names[:7] == FIRST and len(set(names)) == len(names)
    at = names.index("gimbal_yaw_deg")
    assert names[at - 1 : at + 4] == [
        "flags", "gimbal_yaw_deg", "gimbal_pitch_deg", "gimbal_roll_deg", "sigma_camera_yaw_deg",
    ]  # fmt: skip
    parts = [name.removesuffix("_camera_yaw_deg") for name in names if name.startswith("sigma_")]
    assert [part for part in parts if not part.endswith("_deg")] == [
        "sigma", "sigma_reading", "sigma_position",
    ]  # fmt: skip
    plain = history(estimate(ANGLES, frame_names=()), sigmas=Sigmas(reading=1.0))
    names = [column.name for column in columns_of([plain])]
    assert names[:6] == [name for name in FIRST[:7] if name != "image"]
    assert not any("gimbal" in name or "slip_effect" in name for name in names)
    (deck,) = histories("appendix_h/case1")
    names = [column.name for column in columns_of([deck])]
    assert names[0] == "deck" and names[-9].startswith("slip_effect_camera_yaw")
    assert names[-10] == "covariance_common_down_down_deg2"
    assert {"altitude_ft", "residual_rms_mm", "vehicle_up_ft", "airspeed_ft_s"} <= set(names)


# Parts of a history


def parts_of(*parts: History) -> HistoryParts:
    return HistoryParts(parts[0], 5 * len(parts), lambda: iter(parts), lambda: parts[0])


def part(flagged: list[int], lost: list[int], misfit: dict[int, str]) -> Any:
    """Five frames with these flags."""
    e = estimate(ANGLES, about=ABOUT)
    raised = {
        "not_converged": np.isin(np.arange(5), lost),
        "misfit": np.isin(np.arange(5), [*misfit]),
        "jump": np.isin(np.arange(5), flagged),
    }
    flags = SimpleNamespace(
        raised=raised, any=lambda: np.any([*raised.values()], axis=0),
        detail={"misfit": [misfit.get(k, "") for k in range(5)]},
    )  # fmt: skip
    return SimpleNamespace(flags=flags, estimate=e, has_attitude=np.arange(5) > 5)


def test_a_summary_is_known_once_all_parts_have_been_made() -> None:
    some = part([0, 1], [1], {1: "a", 4: "b"}), part([], [2], {})
    job = parts_of(*some)
    assert not job.counted and job.frames == 10
    for _ in job:
        assert not job.counted
    assert job.counted
    summary = job.summary
    assert (summary.unconverged, summary.flagged) == (2, 4)
    assert summary.misfits == [("DJI_0001.JPG", "a"), ("DJI_0004.JPG", "b")]
    later = parts_of(*some)
    assert later.summary == summary and later.counted
    assert not later.has_attitude()
    whole = one_part(some[0])
    assert whole.counted and [*whole] == [some[0]] and whole.whole is some[0]
    told: list[int] = []
    assert len([*job.watched(told.append)]) == 2 and told == [5, 5]


@np.errstate(all="ignore")
def test_landmarks_that_take_no_part_have_no_equations() -> None:
    """Whatever stands in their columns; the others have -u / r and -v / r of their directions."""
    axes = np.array([[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]])
    direction = np.array([[[3.0, -4.0, 2.0], [np.nan, 0.0, 0.0], [1.0, -2.0, -1.0]]])
    image = np.array([[[8.0, 4.5], [np.nan, 7.0], [5.0, -5.25]]])
    sights = Sights(direction, image, np.array([[True, False, True]]), 10.0)
    residual, partials = sights.equations(axes)
    assert_close("ratio", residual, [[8.0 - 7.5, 0.0, 5.0 - 5.0, 4.5 - 5.0, 0.0, -5.25 + 5.0]])
    assert not partials[0, [1, 4]].any() and partials[0, [0, 2, 3, 5]].any(axis=1).all()
    step = 1e-5
    for axis in range(3):
        turn = step * crossing(np.eye(3)[axis])
        (there, _), (back, _) = (
            sights.equations((np.eye(3) + way) @ axes) for way in (-turn, turn)
        )
        assert_close("flight partial", (there - back) / (2.0 * step), -partials[..., axis])
