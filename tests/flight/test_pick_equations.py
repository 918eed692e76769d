"""The equations of picks, by sums over picks written out and by differences of the cost."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.random_flights import lenses
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.flight.solve import LOSSES, PickBlock, PickEquations, equations_at
from vopd.geometry.lenses import project

LENS = lenses()["skew"]
ROTATION = Rotation.from_euler("ZYX", [[10, 20, 30], [-50, 5, 80]], degrees=True).as_matrix()
RAY = np.array([[-0.3, 0.1, 1.0], [0.2, 0.2, 1.0], [0.4, -0.2, 1.0]])
OFF_PX = np.array([[0.5, -0.3], [4.0, 3.0], [-9.0, 2.0]])
SIGMA = np.array([[0.5, 1.0, 2.0], [1.5, 0.8, 3.0]])


def block(loss: str) -> PickBlock:
    direction = RAY / np.linalg.norm(RAY, axis=1, keepdims=True) @ ROTATION
    pixel = np.stack([project(LENS, RAY).pixel + OFF_PX, project(LENS, RAY).pixel - OFF_PX])
    return PickBlock(LENS, pixel, direction, SIGMA, LOSSES[loss])


def cost(one: PickBlock, turn: Floats) -> Floats:
    """The sum of the loss over the picks of each frame, after a small turn of the camera axes."""
    rotation = Rotation.from_rotvec(turn).as_matrix() @ ROTATION
    off = one.pixel - project(LENS, one.direction @ rotation.swapaxes(1, 2)).pixel
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
            by = project(LENS, ROTATION[frame] @ one.direction[frame, k]).by_turns
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
    assert part.lens is LENS and part.loss is LOSSES["huber"]
    alone: PickEquations = equations_at(part, ROTATION[1:])
    for ours, theirs in zip(found.of(second), alone, strict=True):
        np.testing.assert_array_equal(ours, theirs)
