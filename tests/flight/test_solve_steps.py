"""The steps of the solve of rotations: blocks, damping, limits, what is written down."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.flight import solve
from vopd.flight.solve import Attitudes, PickEquations, _blocks, _step, no_attitudes


def test_blocks_are_by_the_number_of_picks_from_two_on() -> None:
    """Frames 0 to 4 have 2, 1, 3, 2 and 0 usable picks, which stand in any order."""
    frame = np.array([3, 2, 0, 2, 1, 0, 3, 2, 4])
    usable = np.array([True] * 8 + [False])
    found = [(index.tolist(), rows.tolist()) for index, rows in _blocks(5, frame, usable)]
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
    assert_close("ratio", _step(both, np.array([0.25, 0.25])), [expected, expected])
    plain = np.linalg.solve(normal + bend, gradient)
    assert_close("ratio", _step(both, np.zeros(2)), [plain, plain])


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
    found = _step(equations(normal, np.ones((2, 3)), curvature), np.zeros(2))
    assert np.isnan(found[0]).all() and found[1].tolist() == [1.0, 1.0, 1.0]


def test_the_determinant_is_that_of_all_nine_elements() -> None:
    """The off-diagonal elements .9, .9, .9 have a minimum, and -.9 among them has not."""
    matrix = np.full((3, 3), 0.9) + 0.1 * np.eye(3)
    one = equations(matrix[None], np.ones((1, 3)), np.zeros((1, 3, 3)))
    assert_close("ratio", _step(one, np.zeros(1))[0], np.full(3, 1 / 2.8))


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
    assert (solve.PASSES, solve.WORK, solve.WORK_A_PICK) == (500, 1_000_000, 12)
    assert (solve.STALE, solve.FALLEN) == (30, 1e-12)
