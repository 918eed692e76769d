"""Which frames are not solved again although their start differs in its last digits."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from vopd.program.frames import FilmOrientation, _differs, _kept

KEPT: dict[str, tuple[bool, dict[str, Any]]] = {  # whether a frame is kept; what it has
    "as it was": (True, {}),
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
    "one landmark": (False, {"enough": False}),
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
    last_pass, singular, enough = np.zeros(3, int), np.zeros(3, bool), np.ones(3, bool)
    last_pass[1], singular[1] = has.get("last_pass", 0), has.get("singular", False)
    enough[1] = has.get("enough", True)
    done = FilmOrientation(start, np.zeros((0, 2)), start, correction, last_pass, singular)
    assert _kept(due, start, done, enough).tolist() == [True, kept, True]


@pytest.mark.parametrize("axis", range(3))
def test_a_start_that_differs_in_its_last_bit(axis: int) -> None:
    """NaN is no difference to NaN, and one to a number."""
    start = np.ones((3, 5))
    due = start.copy()
    due[axis, 1] = np.nextafter(1.0, 2.0)
    due[axis, 2] = np.nan
    due[axis, 3] = start[axis, 3] = np.nan
    start[axis, 4] = np.nan
    assert _differs(due, start).tolist() == [False, True, True, False, True]


def test_some_frames_of_a_film() -> None:
    """Frames 1 and 2 of four, with 2, 1, 3, 1 landmarks: each array has its own axis."""
    arrays = [np.arange(12.0).reshape(3, 4) + 100.0 * k for k in range(3)]
    eps = np.arange(14.0).reshape(7, 2)
    done = FilmOrientation(
        arrays[0], eps, arrays[1], arrays[2], np.arange(4), np.array([True, False, False, True])
    )
    some = done.only(slice(1, 3), slice(2, 6))
    assert some.angles.tolist() == [[1.0, 2.0], [5.0, 6.0], [9.0, 10.0]]
    assert some.next.tolist() == (some.angles + 100.0).tolist()
    assert some.correction.tolist() == (some.angles + 200.0).tolist()
    assert some.eps.tolist() == eps[2:6].tolist()
    assert some.last_pass.tolist() == [1, 2] and some.singular.tolist() == [False, False]
