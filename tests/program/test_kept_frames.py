"""Which frames are not solved again although their start differs in its last digits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from vopd.program.orient import Orientation
from vopd.program.vopd import to_be_solved

KEPT: dict[str, tuple[bool, dict[str, Any]]] = {  # whether a frame is kept; what it has
    "another in the last digits": (True, {}),
    "within the limit": (True, {"by_deg": 9.9e-11}),
    "beyond the limit": (False, {"by_deg": 1.01e-10}),
    "the other way": (False, {"by_deg": -1.01e-10}),
    "just converged": (True, {"correction": 1e-6}),
    "not converged": (False, {"correction": 1.001e-6}),
    "not converged, backward": (False, {"correction": -1.001e-6}),
    "a correction that is no number": (False, {"correction": np.nan}),
    "residuals that vanished": (False, {"last_pass": 1}),
    "residuals that vanished in pass 22": (False, {"last_pass": 22}),
    "a singular matrix": (False, {"singular": True}),
    "one landmark": (False, {"landmarks": 1}),
    "a start that is no number": (False, {"by_deg": np.nan}),
}


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("name", KEPT)
def test_a_frame(name: str, axis: int) -> None:
    """The second of three frames, of which the others are kept; in any of three angles."""
    kept, has = KEPT[name]
    start, correction = np.ones((3, 3)), np.zeros((3, 3))
    due = start.copy()
    due[axis, 1] += has.get("by_deg", 5e-11)
    correction[axis, 1] = has.get("correction", 0.0)
    last_pass, singular, landmarks = np.zeros(3, int), np.zeros(3, bool), np.full(3, 2)
    last_pass[1], singular[1] = has.get("last_pass", 0), has.get("singular", False)
    landmarks[1] = has.get("landmarks", 2)
    done = Orientation(start, np.zeros((0, 2)), start, correction, last_pass, singular)
    assert to_be_solved(due, start, done, landmarks).tolist() == [False, not kept, False]


@pytest.mark.parametrize("axis", range(3))
def test_a_start_that_differs_in_its_last_bit(axis: int) -> None:
    """NaN is no difference to NaN, and one to a number."""
    start = np.ones((3, 5))
    done = Orientation(start, start, start, start, np.zeros(5, int), np.zeros(5, bool))
    due = start.copy()
    due[axis, 1] = np.nextafter(1.0, 2.0)
    due[axis, 2] = np.nan
    due[axis, 3] = start[axis, 3] = np.nan
    start[axis, 4] = np.nan
    found = to_be_solved(due, start, done, np.full(5, 2))  # none has converged
    assert found.tolist() == [False, True, True, False, True]
