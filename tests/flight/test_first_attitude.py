"""The attitude to start from: what takes part, how much it counts, and what determines it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.flight.solve import first_attitude

TRUTH = Rotation.from_euler("ZYX", [40.0, -20.0, 170.0], degrees=True)
DIRECTION = np.array([[0.8, 0.6, 0.0], [0.0, 0.6, 0.8], [0.48, -0.6, 0.64], [0.6, 0.0, -0.8]])
RAY = np.asarray(TRUTH.apply(DIRECTION))
EVEN = np.full(4, 0.25)


def start(ray: Floats, direction: Floats, weight: Floats) -> tuple[Floats, bool]:
    found = first_attitude(ray[None], direction[None], weight[None])
    return found.rotation[0], bool(found.determined[0])


def test_the_rotation_takes_directions_to_rays() -> None:
    rotation, determined = start(RAY, DIRECTION, EVEN)
    assert determined
    assert_close("unit rotation", rotation, TRUTH.as_matrix())


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_weights_count_against_each_other_and_in_no_unit(scale: float) -> None:
    """Against scipy's solution of the same problem, with one direction that does not fit."""
    weight = np.array([1.0, 2.0, 5.0, 0.5])
    ray = RAY.copy()
    ray[1] = [0.6, 0.8, 0.0]
    expected = Rotation.align_vectors(ray, DIRECTION, weights=weight)[0].as_matrix()
    rotation, determined = start(ray, DIRECTION, weight * scale)
    assert determined
    assert_close("unit rotation", rotation, expected)


@pytest.mark.parametrize("what", ["ray", "direction", "weight"])
def test_a_pick_without_ray_direction_or_weight_takes_no_part(what: str) -> None:
    ray, direction, weight = RAY.copy(), DIRECTION.copy(), EVEN.copy()
    ray[2] = [0.0, 1.0, 0.0]  # wrong, so that it would be seen
    if what == "weight":
        weight[2] = 0.0
    else:
        (ray if what == "ray" else direction)[2, 1] = np.nan
    rotation, determined = start(ray, direction, weight)
    assert determined
    assert_close("unit rotation", rotation, TRUTH.as_matrix())


@pytest.mark.parametrize(("apart_rad", "determined"), [(2.2e-5, True), (1.8e-5, False)])
def test_two_directions_determine_it_from_twenty_microradians_on(
    apart_rad: float, determined: bool
) -> None:
    """Their matrix has the singular values cos2 and sin2 of half the angle: 1e-10 at 2e-5."""
    direction = np.array([[1.0, 0.0, 0.0], [np.cos(apart_rad), np.sin(apart_rad), 0.0]])
    for weight in (1e-6, 1e6):
        assert start(TRUTH.apply(direction), direction, np.full(2, weight))[1] == determined


def test_the_weight_of_what_is_not_known_is_no_part_of_the_sum() -> None:
    direction = np.array([[1.0, 0.0, 0.0], [np.cos(2.2e-5), np.sin(2.2e-5), 0.0], [np.nan] * 3])
    assert start(TRUTH.apply(direction), direction, np.array([1.0, 1.0, 1e6]))[1]


def test_nothing_that_takes_part_determines_nothing() -> None:
    assert not start(RAY, DIRECTION, np.zeros(4))[1]
    assert not start(RAY * np.nan, DIRECTION, EVEN)[1]
    assert not start(RAY[[0, 0]], DIRECTION[[0, 0]], EVEN[:2])[1]


def test_frames_do_not_affect_each_other() -> None:
    other = Rotation.from_rotvec([0.1, 0.2, -0.3])
    rays = np.stack([RAY, other.apply(DIRECTION), RAY * np.nan])
    found = first_attitude(rays, np.stack([DIRECTION] * 3), np.stack([EVEN, 7.0 * EVEN, EVEN]))
    assert found.determined.tolist() == [True, True, False]
    assert_close("unit rotation", found.rotation[:2], [TRUTH.as_matrix(), other.as_matrix()])
