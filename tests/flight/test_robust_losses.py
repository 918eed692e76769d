"""Losses by hand, on both sides of where they bend; and what they are to each other."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.flight.solve import LOSSES

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
