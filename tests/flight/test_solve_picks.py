"""Which picks take part in the solve of rotations, and what each frame is given for it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.random_flights import lenses
from tests.tolerances import assert_close, within
from vopd.flight import solve
from vopd.flight.solve import Attitudes, solve_rotations
from vopd.geometry.lenses import project

LENS = lenses()["fisheye"]
TRUTH = Rotation.from_euler("ZYX", [[10, 20, 30], [-50, 5, 80]], degrees=True).as_matrix()
RAY = np.array([[-0.3, 0.1, 1], [0.2, 0.2, 1], [0.4, -0.2, 1], [-0.1, -0.4, 1], [0.1, 0.3, 1.0]])
RAY /= np.linalg.norm(RAY, axis=1, keepdims=True)
FRAME = np.repeat([0, 1], 5)


def attitudes(**changes: Any) -> Attitudes:
    """Two frames of five picks without noise, and what is changed of them."""
    given = {
        "frame": FRAME,
        "pixel": np.tile(project(LENS, RAY).pixel, (2, 1)),
        "sigma_px": np.tile([0.5, 1.0, 2.0, 1.0, 1.0], 2),
        "direction": np.concatenate([RAY @ one for one in TRUTH]),
        "used": np.ones(10, bool),
    } | changes
    return solve_rotations(LENS, 2, **given)


def changed(name: str, row: int, value: Any) -> Attitudes:
    usual: Any = {
        "pixel": np.tile(project(LENS, RAY).pixel, (2, 1)),
        "direction": np.concatenate([RAY @ one for one in TRUTH]),
        "used": np.ones(10, bool),
    }
    usual[name][row] = value
    return attitudes(**{name: usual[name]})


def test_frames_without_noise_have_the_truth() -> None:
    found = attitudes()
    assert_close("flight direction", found.rotation, TRUTH)
    assert found.converged.all() and not found.set_aside.any()
    assert_close("ratio", found.weight, np.tile([4.0, 1.0, 0.25, 1.0, 1.0], 2))
    assert (np.abs(found.correction_rad) < within("flight turn")).all()


@pytest.mark.parametrize(
    ("name", "value", "aside"),
    [
        ("used", False, 0),
        ("direction", np.nan, 0),
        ("pixel", np.nan, 0),
        ("pixel", [9000.0, 0.0], 2),  # farther out than the lens has any ray
        ("direction", -RAY[2] @ TRUTH[1], 1),  # behind the camera that the others give
    ],
)
def test_a_pick_takes_no_part(name: str, value: Any, aside: int) -> None:
    """The eighth, of the second frame; both frames have their attitudes all the same."""
    found = changed(name, 7, value)
    assert found.set_aside.tolist() == [0] * 7 + [aside, 0, 0]
    assert found.weight[7] == 0.0 and (np.delete(found.weight, 7) > 0.0).all()
    assert_close("flight direction", found.rotation, TRUTH)


def test_a_pick_that_takes_no_part_is_not_told_to_be_outside() -> None:
    used = np.ones(10, bool)
    used[7] = False
    pixel = np.tile(project(LENS, RAY).pixel, (2, 1))
    pixel[7] = 9000.0, 0.0
    assert not attitudes(used=used, pixel=pixel).set_aside.any()


@pytest.mark.parametrize(("left", "solved"), [(3, True), (2, True), (1, False), (0, False)])
def test_two_picks_are_an_attitude_and_one_is_none(left: int, solved: bool) -> None:
    used = np.ones(10, bool)
    used[left:5] = False
    found = attitudes(used=used)
    assert np.isfinite(found.rotation[0]).all() == solved == bool(found.converged[0])
    assert_close("flight direction", found.rotation[1], TRUTH[1])
    assert (found.weight[:5] > 0.0).tolist() == [solved and k < left for k in range(5)]
    assert np.isfinite(found.correction_rad[0]).all() == solved


def test_a_frame_has_converged_only_where_its_last_step_was_small() -> None:
    given = {"pixel": np.tile(project(LENS, RAY).pixel, (2, 1))}
    given["pixel"][:5] += np.array([[3.0, -2.0], [-5.0, 1.0], [2.0, 2.0], [0.0, 4.0], [1.0, -6.0]])
    found = attitudes(**given, passes=1)
    assert found.converged.tolist() == [False, True]
    assert np.isfinite(found.rotation).all()
    assert (np.abs(found.correction_rad[0]) > within("flight turn")).any()
    assert attitudes(**given).converged.all()


@pytest.mark.parametrize(("picks", "converged"), [(None, True), (10, True), (1000, False)])
def test_the_work_of_a_pick_is_by_all_picks_of_the_flight(
    picks: int | None, converged: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A hundred passes of a pick are ten of these ten, and less than one of a thousand."""
    monkeypatch.setattr(solve, "WORK", 100)
    monkeypatch.setattr(solve, "WORK_A_PICK", 0)
    pixel = np.tile(project(LENS, RAY).pixel, (2, 1)) + np.arange(20.0).reshape(10, 2) ** 2 / 50.0
    assert (attitudes(pixel=pixel, picks=picks).converged == converged).all()


@pytest.mark.parametrize("loss", ["huber", "cauchy"])
def test_a_pick_that_is_far_off_loses_weight_by_its_loss(loss: str) -> None:
    """30 px of 1 px: 1.345 over it, or 2.385 squared over its square and that."""
    pixel = np.tile(project(LENS, RAY).pixel, (2, 1))
    pixel[3] += 18.0, -24.0
    plain, found = attitudes(pixel=pixel), attitudes(pixel=pixel, loss=loss)
    assert_close("ratio", plain.weight[3], 1.0)
    off = pixel[3] - project(LENS, found.rotation[0] @ (RAY[3] @ TRUTH[0])).pixel
    z = off @ off
    weight = {"huber": 1.345 / np.sqrt(z), "cauchy": 1 / (1 + z / 2.385**2)}[loss]
    assert_close("rae weight by differences", found.weight[3], weight)


def test_picks_are_set_aside_in_two_rounds_before_the_third(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of one frame the first pick has no image at the first start, and the second at the next."""
    real, starts = solve.equations_at, [1, 2]

    def seen(block: Any, rotation: Any) -> Any:
        state = real(block, rotation)
        if starts:
            state.cost[:], state.unseen[0, 0] = np.inf, starts.pop(0)
        return state

    monkeypatch.setattr(solve, "equations_at", seen)
    pixel, direction = project(LENS, RAY).pixel, RAY @ TRUTH[0]
    found = solve_rotations(
        LENS, 1, np.zeros(5, np.int64), pixel, np.ones(5), direction, np.ones(5, bool)
    )
    assert found.set_aside.tolist() == [1, 2, 0, 0, 0]
    assert_close("flight direction", found.rotation[0], TRUTH[0])
