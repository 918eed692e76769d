"""The rotation of every frame against scipy's least squares a frame at a time."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.kit.random_flights import Sightings, lenses, random_frame
from tests.tolerances import assert_close, within
from vopd.arrays import Floats
from vopd.flight.solve import rotations as solve_module
from vopd.flight.solve.rotations import (
    CAUCHY,
    HUBER,
    LOSSES,
    Attitudes,
    PickBlock,
    PickEquations,
    blocks_by_count,
    damped_turn,
    equations_at,
    first_attitude,
    no_attitudes,
    solve_rotations,
)
from vopd.geometry.lenses import project

LENSES = lenses()
LOOKS = ("", "", "up", "down")
FRAMES = 12


def flight(
    name: str, seed: int, noise_px: float, fewest: int = 2
) -> tuple[list[Sightings], np.ndarray]:
    """Frames of two to eight landmarks, and the standard deviation of every pick."""
    rng = np.random.default_rng(seed)
    frames = [
        random_frame(rng, LENSES[name], int(rng.integers(fewest, 9)), noise_px, LOOKS[k % 4])
        for k in range(FRAMES)
    ]
    return frames, np.exp(rng.uniform(-0.5, 0.5, sum(len(f.pixel) for f in frames)))


def solved(frames: list[Sightings], sigma: np.ndarray, loss: str = "least-squares") -> Attitudes:
    return solve_rotations(
        frames[0].lens,
        len(frames),
        np.concatenate([np.full(len(f.pixel), k) for k, f in enumerate(frames)]),
        np.concatenate([f.pixel for f in frames]),
        sigma,
        np.concatenate([f.direction for f in frames]),
        np.ones(len(sigma), bool),
        loss,
    )


def residuals(frame: Sightings, sigma: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    image = project(frame.lens, frame.direction @ rotation.T).pixel
    return np.asarray((frame.pixel - image) / sigma[:, None])


def picks(frames: list[Sightings], sigma: np.ndarray) -> list[np.ndarray]:
    return np.split(sigma, np.cumsum([len(f.pixel) for f in frames])[:-1])


@pytest.mark.parametrize("name", list(LENSES))
def test_rotations_are_those_of_scipy(name: str) -> None:
    frames, sigma = flight(name, 20, 0.0)
    rng = np.random.default_rng(21)
    for frame in frames:  # noise so small that scipy's sum of squares shows a turn of 1e-9 degree
        frame.pixel[:] += rng.normal(0.0, 1e-3, frame.pixel.shape)
    found = solved(frames, sigma)
    assert found.converged.all()
    for frame, own, rotation in zip(frames, picks(frames, sigma), found.rotation, strict=True):

        def of(v: np.ndarray, frame: Sightings = frame, own: np.ndarray = own) -> np.ndarray:
            return residuals(frame, own, Rotation.from_rotvec(v).as_matrix() @ frame.rotation)

        best = least_squares(
            lambda v, of=of: of(v).ravel(), np.zeros(3),
            jac="3-point", xtol=3e-16, ftol=None, gtol=None, x_scale=1e-4,
        )  # fmt: skip
        other = Rotation.from_rotvec(best.x).as_matrix() @ frame.rotation
        turn = Rotation.from_matrix(rotation @ other.T).magnitude()
        assert np.degrees(turn) <= within("flight rotation")


def pinhole(frame: Sightings, rotation: np.ndarray) -> np.ndarray:
    """A pinhole's image in extended precision, by its own formula."""
    ray = frame.direction.astype(np.longdouble) @ rotation.T
    return np.asarray(frame.lens.focal_px * ray[:, :2] / ray[:, 2:] + frame.lens.centre_px)


def turned(rotation: np.ndarray, axis: int, step: float) -> np.ndarray:
    """A rotation turned a little in extended precision, to the third order."""
    skew = np.zeros((3, 3), np.longdouble)
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    skew[i, j], skew[j, i] = -step, step
    return (np.eye(3) + skew + skew @ skew / 2 + skew @ skew @ skew / 6) @ rotation


LOSS = {
    "least-squares": lambda z: z,
    "huber": lambda z: np.where(z <= HUBER**2, z, 2 * HUBER * np.sqrt(z) - HUBER**2),
    "cauchy": lambda z: CAUCHY**2 * np.log1p(z / CAUCHY**2),
}


@pytest.mark.parametrize("loss", list(LOSS))
def test_a_frame_with_noise_ends_at_the_minimum(loss: str) -> None:
    """Newton's step from the solution, by differences of the cost in extended precision."""
    frames, sigma = flight("pinhole", 22, 1.0, fewest=3)
    rng = np.random.default_rng(23)
    if loss != "least-squares":
        for frame in frames:
            frame.pixel[0] += rng.normal(0.0, 20.0, 2)
    found = solved(frames, sigma, loss)
    assert found.converged.all()
    step = 1e-6
    for frame, own, rotation in zip(frames, picks(frames, sigma), found.rotation, strict=True):
        start = rotation.astype(np.longdouble)

        def cost(way: np.ndarray, f: Sightings = frame, s: np.ndarray = own) -> np.ndarray:
            r = (f.pixel - pinhole(f, way)) / s[:, None]
            return LOSS[loss]((r**2).sum(axis=1)).sum()

        gradient = np.zeros(3)
        hessian = np.zeros((3, 3))
        for a in range(3):
            up, down = turned(start, a, step), turned(start, a, -step)
            up2, down2 = turned(start, a, 2 * step), turned(start, a, -2 * step)
            gradient[a] = (8 * (cost(up) - cost(down)) - cost(up2) + cost(down2)) / (12 * step)
            for b in range(3):
                hessian[a, b] = (
                    cost(turned(up, b, step)) - cost(turned(up, b, -step))
                    - cost(turned(down, b, step)) + cost(turned(down, b, -step))
                ) / (4 * step**2)  # fmt: skip
        left = np.linalg.norm(np.linalg.solve(hessian, gradient))
        name = "flight Newton step" if loss == "least-squares" else "flight robust step"
        assert np.degrees(left) <= within(name)


def test_frames_without_hope_end_early(monkeypatch: pytest.MonkeyPatch) -> None:
    """With room for one pass no frame has converged, and each has the attitude so far."""
    frames, sigma = flight("pinhole", 22, 1.0, fewest=3)
    whole = solved(frames, sigma)
    monkeypatch.setattr(solve_module, "WORK", 0)
    monkeypatch.setattr(solve_module, "WORK_A_PICK", 0.5)
    found = solved(frames, sigma)
    assert not found.converged.any()
    assert np.isfinite(found.rotation).all()
    monkeypatch.setattr(solve_module, "WORK_A_PICK", 20)
    found = solved(frames, sigma)
    assert found.converged.all()
    assert np.array_equal(found.rotation, whole.rotation)


def test_weights_count_and_blunders_lose_theirs() -> None:
    frames, sigma = flight("pinhole", 24, 0.01, fewest=6)
    for frame in frames:
        frame.pixel[0] += 300.0
    truth = [f.rotation for f in frames]

    def worst(loss: str) -> float:
        found = solved(frames, np.full(len(sigma), 0.01), loss).rotation
        apart = Rotation.from_matrix(found @ np.swapaxes(truth, 1, 2)).magnitude()
        return float(np.degrees(apart).max())

    assert worst("cauchy") < within("angle beside a blunder")
    assert worst("least-squares") > 1.0


def test_one_landmark_or_landmarks_on_one_line_have_no_rotation() -> None:
    rng = np.random.default_rng(25)
    whole = random_frame(rng, LENSES["pinhole"], 5, 0.5)
    one = whole._replace(pixel=whole.pixel[:1], direction=whole.direction[:1])
    line = whole._replace(pixel=whole.pixel[[0, 0]], direction=whole.direction[[0, 0]])
    found = solved([one, whole, line], np.ones(8))
    assert np.isnan(found.rotation[[0, 2]]).all()
    alone = solved([whole], np.ones(5))
    np.testing.assert_array_equal(found.rotation[1], alone.rotation[0])


def test_a_pick_whose_landmark_has_no_image_is_set_aside() -> None:
    rng = np.random.default_rng(26)
    frame = random_frame(rng, LENSES["pinhole"], 6, 0.5)
    frame.direction[2] *= -1.0
    found = solved([frame], np.ones(6))
    assert found.set_aside.tolist() == [0, 0, 1, 0, 0, 0]
    assert found.weight[2] == 0.0
    turn = Rotation.from_matrix(found.rotation[0] @ frame.rotation.T).magnitude()
    assert np.degrees(turn) < 0.3


# The steps of the solve of rotations: blocks, damping, limits, what is written down


def test_blocks_are_by_the_number_of_picks_from_two_on() -> None:
    """Frames 0 to 4 have 2, 1, 3, 2 and 0 usable picks, which stand in any order."""
    frame = np.array([3, 2, 0, 2, 1, 0, 3, 2, 4])
    usable = np.array([True] * 8 + [False])
    found = [(index.tolist(), rows.tolist()) for index, rows in blocks_by_count(5, frame, usable)]
    assert found == [([0, 3], [[2, 5], [0, 6]]), ([2], [[1, 3, 7]])]


def equations(normal: Floats, gradient: Floats, curvature: Floats) -> PickEquations:
    none: Any = None
    return PickEquations(none, none, gradient, normal, curvature, none, none)


def test_a_step_is_newton_s_with_a_damped_diagonal() -> None:
    normal = np.array([[4.0, 1.0, 0.5], [1.0, 3.0, -0.2], [0.5, -0.2, 2.0]])
    bend = -0.5 * np.eye(3)
    gradient = np.array([1.0, -2.0, 3.0])
    both = equations(*(np.array([a, 7.0 * a]) for a in (normal, gradient, bend)))
    damped = normal + bend + 0.25 * np.diag([4.0, 3.0, 2.0])
    expected = np.linalg.solve(damped, gradient)
    assert_close("ratio", damped_turn(both, np.array([0.25, 0.25])), [expected, expected])
    plain = np.linalg.solve(normal + bend, gradient)
    assert_close("ratio", damped_turn(both, np.zeros(2)), [plain, plain])


@pytest.mark.parametrize(
    "matrix",
    [np.diag([-1.0, 1.0, 1.0]), np.diag([1.0, -1.0, 1.0]), np.diag([1.0, 1.0, -1.0]),
     np.zeros((3, 3)), np.array([[1, 0.9, 0.9], [0.9, 1, -0.9], [0.9, -0.9, 1.0]])],
    ids=["first", "second", "third", "nothing", "only the determinant"],
)  # fmt: skip
def test_equations_without_a_minimum_have_no_step(matrix: Floats) -> None:
    """That is so for each leading minor; a good frame beside it has its step."""
    normal = np.array([np.eye(3), np.eye(3)])
    curvature = np.array([matrix - np.eye(3), np.zeros((3, 3))])
    found = damped_turn(equations(normal, np.ones((2, 3)), curvature), np.zeros(2))
    assert np.isnan(found[0]).all() and found[1].tolist() == [1.0, 1.0, 1.0]


def test_the_determinant_is_that_of_all_nine_elements() -> None:
    """The off-diagonal elements .9, .9, .9 have a minimum, and -.9 among them has not."""
    matrix = np.full((3, 3), 0.9) + 0.1 * np.eye(3)
    one = equations(matrix[None], np.ones((1, 3)), np.zeros((1, 3, 3)))
    assert_close("ratio", damped_turn(one, np.zeros(1))[0], np.full(3, 1 / 2.8))


def test_attitudes_of_a_part_are_put_in_their_rows() -> None:
    whole = no_attitudes(3, 4)
    part = Attitudes(
        np.arange(18.0).reshape(2, 3, 3), np.arange(6.0).reshape(2, 3), np.array([True, False]),
        np.array([5.0, 6.0]), np.array([2, 1], np.int8),
    )  # fmt: skip
    whole.put(np.array([2, 0]), np.array([3, 1]), part)
    assert whole.rotation[[2, 0]].tolist() == part.rotation.tolist()
    assert whole.correction_rad[[2, 0]].tolist() == part.correction_rad.tolist()
    assert np.isnan(whole.rotation[1]).all() and np.isnan(whole.correction_rad[1]).all()
    assert whole.converged.tolist() == [False, False, True]
    assert whole.weight.tolist() == [0.0, 6.0, 0.0, 5.0]
    assert whole.set_aside.tolist() == [0, 1, 0, 2]


def test_limits_of_the_passes_and_of_their_work() -> None:
    """They were measured on many flights: another one is to be measured again."""
    assert (solve_module.PASSES, solve_module.WORK, solve_module.WORK_A_PICK) == (
        500,
        1_000_000,
        12,
    )
    assert (solve_module.STALE, solve_module.FALLEN) == (30, 1e-12)


# Which picks take part in the solve of rotations, and what each frame is given for it


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
        ("direction", np.nan, 3),  # the landmark is where the camera is
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
    monkeypatch.setattr(solve_module, "WORK", 100)
    monkeypatch.setattr(solve_module, "WORK_A_PICK", 0)
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
    real, starts = solve_module.equations_at, [1, 2]

    def seen(block: Any, rotation: Any) -> Any:
        state = real(block, rotation)
        if starts:
            state.cost[:], state.unseen[0, 0] = np.inf, starts.pop(0)
        return state

    monkeypatch.setattr(solve_module, "equations_at", seen)
    pixel, direction = project(LENS, RAY).pixel, RAY @ TRUTH[0]
    found = solve_rotations(
        LENS, 1, np.zeros(5, np.int64), pixel, np.ones(5), direction, np.ones(5, bool)
    )
    assert found.set_aside.tolist() == [1, 2, 0, 0, 0]
    assert_close("flight direction", found.rotation[0], TRUTH[0])


# The equations of picks, by sums over picks written out and by differences of the cost


SKEW = lenses()["skew"]
ROTATION = Rotation.from_euler("ZYX", [[10, 20, 30], [-50, 5, 80]], degrees=True).as_matrix()
RAYS = np.array([[-0.3, 0.1, 1.0], [0.2, 0.2, 1.0], [0.4, -0.2, 1.0]])
OFF_PX = np.array([[0.5, -0.3], [4.0, 3.0], [-9.0, 2.0]])
SIGMA = np.array([[0.5, 1.0, 2.0], [1.5, 0.8, 3.0]])


def block(loss: str) -> PickBlock:
    direction = RAYS / np.linalg.norm(RAYS, axis=1, keepdims=True) @ ROTATION
    pixel = np.stack(
        [
            project(SKEW, RAYS).pixel + OFF_PX,
            project(SKEW, RAYS).pixel - OFF_PX,
        ]
    )
    return PickBlock(SKEW, pixel, direction, SIGMA, LOSSES[loss])


def cost(one: PickBlock, turn: Floats) -> Floats:
    """The sum of the loss over the picks of each frame, after a small turn of the camera axes."""
    rotation = Rotation.from_rotvec(turn).as_matrix() @ ROTATION
    off = one.pixel - project(SKEW, one.direction @ rotation.swapaxes(1, 2)).pixel
    return one.loss.value((off**2).sum(axis=2) / SIGMA**2).sum(axis=1)


@pytest.mark.parametrize("loss", list(LOSSES))
def test_cost_and_gradient(loss: str) -> None:
    """The gradient is minus half of the cost's slope."""
    one, step = block(loss), 1e-6
    found = equations_at(one, ROTATION)
    assert_close("table value", found.cost, cost(one, np.zeros(3)))
    slope = [(cost(one, w) - cost(one, -w)) / (2 * step) for w in step * np.eye(3)]
    assert_close("derivative by steps", found.gradient / 1e4, -np.transpose(slope) / 2 / 1e4)
    assert np.array_equal(found.rotation, ROTATION) and not found.unseen.any()


@pytest.mark.parametrize("loss", list(LOSSES))
def test_normal_curvature_and_weight_pick_by_pick(loss: str) -> None:
    one = block(loss)
    found = equations_at(one, ROTATION)
    for frame in range(2):
        normal, curved = np.zeros((3, 3)), np.zeros((3, 3))
        for k in range(3):
            by = project(SKEW, ROTATION[frame] @ one.direction[frame, k]).by_turns
            sigma, off = SIGMA[frame, k], OFF_PX[k] * (1 - 2 * frame)
            z = np.array([off @ off / sigma**2])
            weight, bend = one.loss.weight(z)[0], one.loss.curvature(z)[0]
            way = by.T @ off / sigma**2
            normal += weight * by.T @ by / sigma**2
            curved += 2.0 * bend * np.outer(way, way)
            assert_close("table value", found.weight[frame, k], weight / sigma**2)
        assert_close("ten digits", found.normal[frame] / 1e7, normal / 1e7)
        assert_close("ten digits", found.curvature[frame] / 1e7, curved / 1e7)


def test_a_pick_without_an_image_makes_the_cost_of_its_frame_infinite() -> None:
    one = block("least-squares")
    direction = one.direction.copy()
    direction[1, 2] *= -1.0
    found = equations_at(one._replace(direction=direction), ROTATION)
    assert np.isfinite(found.cost).tolist() == [True, False] and found.cost[1] == np.inf
    assert found.unseen.tolist() == [[0, 0, 0], [0, 0, 1]]


def test_some_of_the_frames() -> None:
    one = block("huber")
    second = np.array([False, True])
    part, found = one.of(second), equations_at(one, ROTATION)
    assert part.lens is SKEW and part.loss is LOSSES["huber"]
    alone: PickEquations = equations_at(part, ROTATION[1:])
    for ours, theirs in zip(found.of(second), alone, strict=True):
        np.testing.assert_array_equal(ours, theirs)


# Losses by hand, on both sides of where they bend; and what they are to each other


C2 = 2.385**2  # Cauchy's constant squared; Huber's is 1.345, its square 1.809025
BY_HAND = {  # loss: z, its value, weight and curvature
    "least-squares": ((0.0, 0.0, 1.0, 0.0), (9.0, 9.0, 1.0, 0.0)),
    "huber": (
        (0.0, 0.0, 1.0, 0.0),
        (1.0, 1.0, 1.0, 0.0),
        (1.809024, 1.809024, 1.0, 0.0),
        (4.0, 2 * 1.345 * 2 - 1.809025, 1.345 / 2, -0.5 * 1.345 / 8),
        (100.0, 2 * 1.345 * 10 - 1.809025, 1.345 / 10, -0.5 * 1.345 / 1000),
    ),
    "cauchy": (
        (0.0, 0.0, 1.0, -1 / C2),
        (C2, C2 * math.log(2), 1 / 2, -1 / (4 * C2)),
        (3 * C2, C2 * math.log(4), 1 / 4, -1 / (16 * C2)),
    ),
}


def test_every_loss_is_worked_by_hand() -> None:
    assert list(LOSSES) == list(BY_HAND)


@pytest.mark.parametrize("name", list(BY_HAND))
def test_value_weight_and_curvature_by_hand(name: str) -> None:
    z, value, weight, curvature = np.array(BY_HAND[name]).T
    loss = LOSSES[name]
    assert_close("table value", loss.value(z), value)
    assert_close("table value", loss.weight(z), weight)
    assert_close("table value", loss.curvature(z), curvature)


@pytest.mark.parametrize("name", list(BY_HAND))
def test_the_weight_is_the_slope_and_the_curvature_that_of_the_weight(name: str) -> None:
    z, step = np.array([0.5, 1.7, 1.9, 5.0, 30.0]), 1e-4
    loss = LOSSES[name]
    slope = (loss.value(z + step) - loss.value(z - step)) / (2 * step)
    assert_close("derivative by steps", loss.weight(z), slope)
    bend = (loss.weight(z + step) - loss.weight(z - step)) / (2 * step)
    assert_close("derivative by steps", loss.curvature(z), bend)


# The attitude to start from: what takes part, how much it counts, and what determines it


TURNED = Rotation.from_euler("ZYX", [40.0, -20.0, 170.0], degrees=True)
DIRECTION = np.array([[0.8, 0.6, 0.0], [0.0, 0.6, 0.8], [0.48, -0.6, 0.64], [0.6, 0.0, -0.8]])
TURNED_RAYS = np.asarray(TURNED.apply(DIRECTION))
EVEN = np.full(4, 0.25)


def start(ray: Floats, direction: Floats, weight: Floats) -> tuple[Floats, bool]:
    rotation, determined = first_attitude(ray[None], direction[None], weight[None])
    return rotation[0], bool(determined[0])


def test_the_rotation_takes_directions_to_rays() -> None:
    rotation, determined = start(TURNED_RAYS, DIRECTION, EVEN)
    assert determined
    assert_close("unit rotation", rotation, TURNED.as_matrix())


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_weights_count_against_each_other_and_in_no_unit(scale: float) -> None:
    """Against scipy's solution of the same problem, with one direction that does not fit."""
    weight = np.array([1.0, 2.0, 5.0, 0.5])
    ray = TURNED_RAYS.copy()
    ray[1] = [0.6, 0.8, 0.0]
    expected = Rotation.align_vectors(ray, DIRECTION, weights=weight)[0].as_matrix()
    rotation, determined = start(ray, DIRECTION, weight * scale)
    assert determined
    assert_close("unit rotation", rotation, expected)


@pytest.mark.parametrize("what", ["ray", "direction", "weight"])
def test_a_pick_without_ray_direction_or_weight_takes_no_part(what: str) -> None:
    ray, direction, weight = TURNED_RAYS.copy(), DIRECTION.copy(), EVEN.copy()
    ray[2] = [0.0, 1.0, 0.0]  # wrong, so that it would be seen
    if what == "weight":
        weight[2] = 0.0
    else:
        (ray if what == "ray" else direction)[2, 1] = np.nan
    rotation, determined = start(ray, direction, weight)
    assert determined
    assert_close("unit rotation", rotation, TURNED.as_matrix())


@pytest.mark.parametrize(("apart_rad", "determined"), [(2.2e-5, True), (1.8e-5, False)])
def test_two_directions_determine_it_from_twenty_microradians_on(
    apart_rad: float, determined: bool
) -> None:
    """Their matrix has the singular values cos2 and sin2 of half the angle: 1e-10 at 2e-5."""
    direction = np.array([[1.0, 0.0, 0.0], [np.cos(apart_rad), np.sin(apart_rad), 0.0]])
    for weight in (1e-6, 1e6):
        assert start(TURNED.apply(direction), direction, np.full(2, weight))[1] == determined


def test_the_weight_of_what_is_not_known_is_no_part_of_the_sum() -> None:
    direction = np.array([[1.0, 0.0, 0.0], [np.cos(2.2e-5), np.sin(2.2e-5), 0.0], [np.nan] * 3])
    assert start(TURNED.apply(direction), direction, np.array([1.0, 1.0, 1e6]))[1]


def test_nothing_that_takes_part_determines_nothing() -> None:
    assert not start(TURNED_RAYS, DIRECTION, np.zeros(4))[1]
    assert not start(TURNED_RAYS * np.nan, DIRECTION, EVEN)[1]
    assert not start(TURNED_RAYS[[0, 0]], DIRECTION[[0, 0]], EVEN[:2])[1]


def test_frames_do_not_affect_each_other() -> None:
    other = Rotation.from_rotvec([0.1, 0.2, -0.3])
    rays = np.stack([TURNED_RAYS, other.apply(DIRECTION), TURNED_RAYS * np.nan])
    weights = np.stack([EVEN, 7.0 * EVEN, EVEN])
    rotation, determined = first_attitude(rays, np.stack([DIRECTION] * 3), weights)
    assert determined.tolist() == [True, True, False]
    assert_close("unit rotation", rotation[:2], [TURNED.as_matrix(), other.as_matrix()])
