"""Which angles a frame leaves to the next one, and when a frame keeps its solve: rule by rule."""

from __future__ import annotations

import numpy as np
import pytest

from vopd.program.orient import Orientation
from vopd.program.vopd import _starts, to_be_solved

TWOPI, PI = 6.2831853, 3.14159265  # as the listing has them, and here in degrees
FIRST = [10.0, -20.0, 30.0]
"""Group 8."""


def ended(*left: tuple[float, float, float]) -> Orientation:
    """Frames that converged and leave these angles."""
    frames = len(left)
    return Orientation(
        angles=np.full((3, frames), 55.0),
        eps=np.zeros((4 * frames, 2)),
        next=np.array(left).T,
        correction=np.zeros((3, frames)),
        last_pass=np.zeros(frames, np.int64),
        singular=np.zeros(frames, bool),
    )


def starts(
    done: Orientation,
    dropped: tuple[int, ...] = (),
    turn: float = TWOPI,
    first: np.ndarray | int = 0,
) -> list[list[float]]:
    """The start of each frame (F, 3), where these frames are dropped."""
    frames = len(done.last_pass)
    which = np.isin(np.arange(frames), dropped)
    initial = np.tile(np.array(FIRST)[:, None], (1, frames))
    return np.asarray(_starts(initial, done, which, turn, first).T).tolist()


@pytest.mark.parametrize(
    ("angle", "carried", "outside"),
    [
        (0, [0.0, 1e-9, 6.28, TWOPI], [-1e-9, np.nextafter(TWOPI, 9.0), 6.2832, 359.0]),
        (1, [-PI, 0.0, PI], [np.nextafter(-PI, -9.0), np.nextafter(PI, 9.0), 4.0, -80.0]),
        (2, [0.0, 1e-9, 6.28, TWOPI], [-1e-9, np.nextafter(TWOPI, 9.0), 6.2832, 359.0]),
    ],
)
def test_the_limits_themselves_are_carried(
    angle: int, carried: list[float], outside: list[float]
) -> None:
    """An angle beyond them starts from group 8, and the two others are carried all the same."""
    for value in [*carried, *outside]:
        left, due = [1.0, 2.0, 3.0], [1.0, 2.0, 3.0]
        left[angle] = value
        due[angle] = value if value in carried else FIRST[angle]
        assert starts(ended((left[0], left[1], left[2]), (0.0, 0.0, 0.0))) == [FIRST, due]


@pytest.mark.parametrize(
    ("left", "due"),
    [
        ((0.0, -180.0, 360.0), [0.0, -180.0, 360.0]),
        ((360.0, 180.0, 0.0), [360.0, 180.0, 0.0]),
        ((360.1, 180.1, -0.1), FIRST),
        ((-0.1, -180.1, 360.1), FIRST),
    ],
)
def test_the_limits_of_a_circle_of_360(left: tuple[float, float, float], due: list[float]) -> None:
    assert starts(ended(left, (0.0, 0.0, 0.0)), turn=360.0) == [FIRST, due]


A, B, C, D = (1.0, 0.1, 2.0), (3.0, 0.2, 4.0), (5.0, 0.3, 6.0), (0.5, 0.4, 0.6)


@pytest.mark.parametrize(
    ("dropped", "exact", "due"),
    [
        ((), (), [FIRST, [*A], [*B], [*C]]),
        ((1,), (), [FIRST, [*A], [*A], [*C]]),
        ((), (1,), [FIRST, [*A], [*A], [*C]]),
        ((0,), (), [FIRST, FIRST, [*B], [*C]]),
        ((), (0,), [FIRST, FIRST, [*B], [*C]]),
        ((0,), (1,), [FIRST, FIRST, FIRST, [*C]]),
        ((1,), (2,), [FIRST, [*A], [*A], [*A]]),
        ((0, 1, 2), (), [FIRST] * 4),
        ((), (0, 1, 2), [FIRST] * 4),
        ((3,), (3,), [FIRST, [*A], [*B], [*C]]),
    ],
)
@pytest.mark.parametrize("last_pass", [1, 22])
def test_which_frames_leave_no_angles(
    dropped: tuple[int, ...], exact: tuple[int, ...], due: list[list[float]], last_pass: int
) -> None:
    """Those that are dropped, and those whose residuals vanished, in whichever pass."""
    done = ended(A, B, C, D)
    done.last_pass[list(exact)] = last_pass
    assert starts(done, dropped) == due


@pytest.mark.parametrize("angle", [0, 1, 2])
def test_no_angle_is_carried_beside_one_that_is_nan(angle: int) -> None:
    done = ended(A, B, C)
    done.next[angle, 0] = np.nan
    assert starts(done) == [FIRST, FIRST, [*B]]


def test_a_film_does_not_begin_with_the_angles_of_another() -> None:
    """Films of two frames each; the first frame of the second film leaves no angles."""
    first = np.array([0, 0, 2, 2])
    assert starts(ended(A, B, C, D), first=first) == [FIRST, [*A], FIRST, [*C]]
    assert starts(ended(A, B, C, D), (2,), first=first) == [FIRST, [*A], FIRST, FIRST]
    assert starts(ended(A, B, C, D), first=np.arange(4)) == [FIRST] * 4


def kept(done: Orientation, apart_deg: tuple[float, ...] = (5e-11, 0.0, 0.0)) -> bool:
    start = np.array([[200.0], [-70.0], [300.0]])
    due = start + np.array(apart_deg)[:, None]
    return not to_be_solved(due, start, done, np.array([2]))[0]


@pytest.mark.parametrize("angle", [0, 1, 2])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_when_a_solve_is_kept(angle: int, sign: float) -> None:
    """If all corrections are at most 1E-6 rad and all starts within 1E-10 degree."""
    for size, stands in ((1e-6, True), (np.nextafter(1e-6, 1.0), False), (np.nan, False)):
        done = ended(A)
        done.correction[angle] = sign * size
        assert kept(done) == stands
    for apart, stands in ((0.9e-10, True), (1.1e-10, False), (1.0, False), (np.nan, False)):
        away = [0.0, 0.0, 0.0]
        away[angle] = sign * apart
        assert kept(ended(A), tuple(away)) == stands


def test_a_solve_without_an_answer_is_not_kept() -> None:
    """One that ended early, in a singular matrix, or has fewer than two landmarks."""
    assert kept(ended(A))
    for last_pass in (1, 21, 22):
        assert not kept(ended(A)._replace(last_pass=np.array([last_pass])))
    assert not kept(ended(A)._replace(singular=np.array([True])))
    start = np.zeros((3, 2))
    found = to_be_solved(start + 5e-11, start, ended(A, B), np.array([1, 2]))
    assert found.tolist() == [True, False]
