"""From frame to frame: what the next one starts from (A 109 to A 111, A 449 to A 454)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kit import appendix_a
from tests.tolerances import assert_close
from vopd.program.orient import Orientation, Sight, orient
from vopd.program.vopd import orient_frames as orient_film

FOCAL = 10.4
INITIAL = np.array([10.0, -20.0, 30.0])
"""Group 8: an estimate that no angle of the frames below comes near."""


def orient_frames(
    initial: np.ndarray, seen: Sight, dropped: np.ndarray, *more: Any, **options: Any
) -> tuple[Orientation, np.ndarray]:
    """The solve of a film, of which some landmarks may take no part."""
    return orient_film(initial, appendix_a.film_sight(seen), dropped, *more, **options)


def residuals(done: Orientation, seen: Sight) -> np.ndarray:
    """The residuals (F, L, 2), zero for what takes no part."""
    found = np.zeros((*seen.used.T.shape, 2))
    found[seen.used.T] = done.eps
    return found


def starts_after(*angles: tuple[float, float, float]) -> np.ndarray:
    """The starts (F, 3) of frames at these angles, without noise, and of one more."""
    truth = np.array([*angles, angles[-1]])
    rng = np.random.default_rng(9)
    cosines, film = appendix_a.random_film(rng, truth, 4, noise_mm=0.0)
    seen = appendix_a.sight(cosines, film, FOCAL)
    done, start = orient_frames(INITIAL[:, None], seen, np.zeros(len(truth), bool))
    assert_close("solved angle", done.angles.T, truth)
    assert start[:, 0].tolist() == INITIAL.tolist()
    for f in range(len(angles)):
        carried = start[:, f + 1] != INITIAL
        assert_close("start of a kept frame", start[carried, f + 1], done.next[carried, f])
    return start.T


@pytest.mark.parametrize(
    ("angles", "restarts"),
    [
        # degrees against TWOPI = 6.2831853 and PI = 3.14159265
        ((3.0, -2.0, 5.0), (False, False, False)),
        ((7.0, 4.0, 350.0), (True, True, True)),
        ((6.28, -3.14, 6.28), (False, False, False)),
        ((6.29, 1.0, 1.0), (True, False, False)),
        ((1.0, -3.15, 1.0), (False, True, False)),
        ((1.0, 3.15, 1.0), (False, True, False)),
        ((1.0, 3.14, 6.29), (False, False, True)),
        ((0.01, 0.0, 359.99), (False, False, True)),
    ],
)
def test_each_angle_restarts_by_itself(
    angles: tuple[float, float, float], restarts: tuple[bool, ...]
) -> None:
    start = starts_after(angles)[1]
    assert tuple(start == INITIAL) == restarts


def test_the_start_is_from_the_frame_before_and_not_an_earlier_one() -> None:
    """Yaw 3 is carried into frame 2, whose 25 sends frame 3 back to group 8, not to 3."""
    start = starts_after((3.0, 1.0, 1.0), (25.0, 1.0, 1.0))
    assert start[1, 0] != INITIAL[0]
    assert start[2, 0] == INITIAL[0]


def test_the_circle_can_be_another() -> None:
    """With 360 for TWOPI all angles are carried."""
    truth = np.array([[200.0, -70.0, 300.0]] * 2)
    cosines, film = appendix_a.random_film(np.random.default_rng(9), truth, 4, noise_mm=0.0)
    near = truth[0] + 3.0
    done, start = orient_frames(
        near[:, None], appendix_a.sight(cosines, film, FOCAL), np.zeros(2, bool), 360.0
    )
    assert_close("start of a kept frame", start[:, 1], done.next[:, 0])


@pytest.mark.parametrize(("apart_deg", "kept"), [(9e-11, True), (-9e-11, True), (1.1e-10, False),
                                                  (-1.1e-10, False), (1e-7, False)])  # fmt: skip
@pytest.mark.parametrize("angle", [0, 1, 2])
def test_how_near_a_start_must_be_for_a_frame_to_be_kept(
    angle: int, apart_deg: float, kept: bool
) -> None:
    """1e-10 degree: the second frame should have started from the angles of the first."""
    truth = np.array([[200.0, -70.0, 300.0]] * 2)
    cosines, film = appendix_a.random_film(np.random.default_rng(9), truth, 4, noise_mm=0.0)
    seen = appendix_a.sight(cosines, film, FOCAL)
    done, _ = orient_frames(truth[:1].T, seen, np.zeros(2, bool), 360.0)
    near = done.next[:, :1].copy()
    near[angle] += apart_deg
    _, start = orient_frames(near, seen, np.zeros(2, bool), 360.0)
    assert (start[:, 1] == near[:, 0]).all() == kept


def zero_focal(film: np.ndarray, dropped: list[bool]) -> np.ndarray:
    """Starts (F, 3) of a film whose focal length is zero, so that angles only wrap.

    A frame that starts from group 8, 361, 1, 361, leaves 361 - TWOPI*RAD = 361 -
    359.999999569273 = 1.000000430727, and from there on nothing changes.
    """
    cosines = np.tile([0.1, 0.9, -0.4], (*film.shape[:2], 1))
    seen = appendix_a.sight(cosines, film, 0.0)
    _, start = orient_frames(np.array([[361.0], [1.0], [361.0]]), seen, np.array(dropped))
    return start.T


FIRST, LATER = (361.0, 1.0, 361.0), (1.000000430727, 1.0, 1.000000430727)


@pytest.mark.parametrize(
    ("idle", "starts"),
    [
        ((False, False, False, False), (FIRST, LATER, LATER, LATER)),
        ((True, False, False, False), (FIRST, FIRST, LATER, LATER)),
        ((True, True, False, False), (FIRST, FIRST, FIRST, LATER)),
        ((False, True, True, False), (FIRST, LATER, LATER, LATER)),
        ((True, False, True, False), (FIRST, FIRST, LATER, LATER)),
    ],
)
def test_idle_frames_pass_on_what_they_got(
    idle: tuple[bool, ...], starts: tuple[tuple[float, ...], ...]
) -> None:
    """Dropped frames, and frames whose residuals vanish: landmarks at the film's centre."""
    film = np.ones((4, 2, 2))
    assert_close("wrapped angle", zero_focal(film, list(idle)), starts)
    film[list(idle)] = 0.0
    assert_close("wrapped angle", zero_focal(film, [False] * 4), starts)


@pytest.mark.parametrize("marks", [2, 8, 9, 12])
@pytest.mark.parametrize("frames", [1, 40])
def test_no_correction_is_minus_zero(frames: int, marks: int) -> None:
    """A sum that begins at zero and adds -0 is +0, however many landmarks and frames there are."""
    cosines = np.tile([0.1, 0.9, -0.4], (frames, marks, 1))
    seen = appendix_a.sight(cosines, np.zeros((frames, marks, 2)), 0.0)
    done, _ = orient_frames(np.array([[1.0], [1.0], [1.0]]), seen, np.zeros(frames, bool))
    assert (done.correction == 0.0).all() and not np.signbit(done.correction).any()
    assert (done.last_pass == 1).all()


def test_an_angle_below_zero_restarts() -> None:
    """-7923 gains 359.999999569273 in each of 22 passes and leaves -3.0000095, not 0 to 6.28."""
    film, initial = np.ones((2, 1, 2)), np.array([-7923.0, 0.0, -7923.0])
    cosines = np.tile([0.1, 0.9, -0.4], (2, 1, 1))
    done, start = orient_frames(
        initial[:, None], appendix_a.sight(cosines, film, 0.0), np.zeros(2, bool)
    )
    assert_close("angle wrapped 22 times", done.next[:, 0], (-3.000009475994, 0.0, -3.000009475994))
    np.testing.assert_array_equal(start[:, 1], initial)


def test_a_frame_that_is_no_number_restarts_all_angles() -> None:
    """Frame 1 would leave 1, 1, 1; frame 2 is abeam and NaN; frame 3 starts from group 8."""
    truth = np.ones((4, 3))
    cosines, film = appendix_a.random_film(np.random.default_rng(9), truth, 4, noise_mm=0.0)
    cosines[1], film[1] = np.nan, 1.0
    done, start = orient_frames(
        INITIAL[:, None], appendix_a.sight(cosines, film, FOCAL), np.zeros(4, bool)
    )
    assert np.isnan(done.angles[:, 1]).all()
    assert start[:, 2].tolist() == INITIAL.tolist()
    assert_close("solved angle", done.angles[:, 2:], 1.0)
    assert_close("start of a kept frame", start[:, 3], done.next[:, 2])


def chain(seed: int, frames: int) -> tuple[np.ndarray, ...]:
    """A film that wanders about the range in which angles are carried on, with every accident."""
    rng = np.random.default_rng(seed)
    centre, size = rng.choice([(3.0, 2.0), (3.0, 6.0), (180.0, 170.0)])
    truth = rng.uniform(centre - size, centre + size, (frames, 3))
    truth[:, 1] = rng.uniform(-4.0, 4.0, frames)
    cosines, film = appendix_a.random_film(rng, truth, 4, noise_mm=rng.choice([0.0, 0.3]))
    used = rng.random((frames, 4)) < 0.8
    used[:, 0] |= ~used.any(axis=1)
    kind = rng.integers(0, 12, frames)
    cosines[kind == 0] = np.nan
    cosines[kind == 1] = (1.0, 0.0, 0.0)  # abeam of a camera that looks north
    cosines[kind == 2], film[kind == 2] = (0.0, 1.0, 0.0), 0.0  # exact, if it looks just there
    return cosines, film, used, kind == 3


def start_due(
    initial: np.ndarray, done: Orientation, dropped: np.ndarray
) -> list[tuple[float, ...]]:
    """A 109 to A 111 and A 449 to A 454 as they read: the start that is due to each frame."""
    alphap, xomegp, xkapp = initial
    due = []
    for f in range(len(dropped)):
        due.append((alphap, xomegp, xkapp))
        if dropped[f] or done.last_pass[f]:
            continue
        alphap, xomegp, xkapp = done.next[:, f]
        if np.isnan(done.next[:, f]).any():
            alphap, xomegp, xkapp = initial
        if alphap < 0.0 or alphap > 6.2831853:
            alphap = initial[0]
        if xkapp < 0.0 or xkapp > 6.2831853:
            xkapp = initial[2]
        if xomegp < -3.14159265 or xomegp > 3.14159265:
            xomegp = initial[1]
    return due


def hold_the_rule(
    initial: np.ndarray, seen: Sight, dropped: np.ndarray, done: Orientation, start: np.ndarray
) -> int:
    """Every frame is what its start alone gives, and its start is the one due; how many were kept.

    The start may differ from the one due, by 1E-10 degree, only where the frame has an answer.
    """
    kept = 0
    for f, due in enumerate(start_due(initial, done, dropped)):
        alone = orient(start[:, f : f + 1], seen.only(slice(f, f + 1)))
        for name, ours, theirs in zip(done._fields, done, alone, strict=True):
            if name == "eps":
                np.testing.assert_array_equal(residuals(done, seen)[f], theirs[:, :, 0].T)
            else:
                np.testing.assert_array_equal(ours[..., f : f + 1], theirs, err_msg=name)
        if start[:, f].tolist() == list(due):
            continue
        kept += 1
        assert_close("start of a kept frame", start[:, f], due)
        assert np.abs(done.correction[:, f]).max() <= 1e-6
        assert done.last_pass[f] == 0 and not done.singular[f]
        assert seen.used[:, f].sum() >= 2
    return kept


@settings(max_examples=12)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.0, 3.0, 40.0]), st.integers(1, 50))
def test_a_film_is_its_frames_one_after_the_other(seed: int, guess: float, frames: int) -> None:
    """With frames that do not converge, are NaN, vanish or are dropped, which are solved too."""
    cosines, film, used, dropped = chain(seed, frames)
    initial = np.array([guess, 0.0, guess])
    seen = appendix_a.sight(cosines, film, FOCAL, used)
    done, start = orient_frames(initial[:, None], seen, dropped)
    hold_the_rule(initial, seen, dropped, done, start)


def test_chains_of_fifty_are_among_them() -> None:
    """Here all three angles are carried through 50 frames: the property above is not empty."""
    rng = np.random.default_rng(3)
    truth = rng.uniform([1.0, -2.0, 1.0], [5.0, 2.0, 5.0], (50, 3))
    cosines, film = appendix_a.random_film(rng, truth, 4, noise_mm=0.001)
    seen, dropped = appendix_a.sight(cosines, film, FOCAL), np.zeros(50, bool)
    done, start = orient_frames(np.zeros((3, 1)), seen, dropped)
    assert_close("start of a kept frame", start[:, 1:], done.next[:, :-1])
    assert hold_the_rule(np.zeros(3), seen, dropped, done, start) > 0


@pytest.mark.parametrize("accident", ["far off", "one landmark", "singular", "exact"])
def test_a_frame_without_an_answer_starts_where_the_last_one_ended(accident: str) -> None:
    """To the last bit, however often the frame before it is solved."""
    rng = np.random.default_rng(8)
    truth = rng.uniform([1.0, -2.0, 1.0], [5.0, 2.0, 5.0], (40, 3))
    cosines, film = appendix_a.random_film(rng, truth, 4, noise_mm=0.001)
    used, odd = np.ones((40, 4), bool), np.arange(1, 40, 2)
    if accident == "far off":  # landmarks abeam and behind
        cosines[odd] = -cosines[odd][:, ::-1]
        film[odd] += 3.0
    elif accident == "one landmark":
        used[odd, 1:] = False
    elif accident == "singular":  # a landmark that no turn moves
        cosines[odd] = np.nan
    else:  # looked at from just there, or nearly
        cosines[odd], film[odd] = (0.0, 1.0, 0.0), 0.0
    seen, dropped = appendix_a.sight(cosines, film, FOCAL, used), np.zeros(40, bool)
    done, start = orient_frames(np.zeros((3, 1)), seen, dropped)
    hold_the_rule(np.zeros(3), seen, dropped, done, start)
    due = np.array(start_due(np.zeros(3), done, dropped))
    answered = (np.abs(done.correction) <= 1e-6).all(axis=0) & (done.last_pass == 0)
    answered &= ~done.singular & (used.sum(axis=1) >= 2)
    assert not answered[odd].all()
    np.testing.assert_array_equal(start.T[~answered], due[~answered])


def test_films_side_by_side_do_not_know_each_other() -> None:
    """Two films of which the second has its own initial angles, and frames that stand alone."""
    cosines, film, used, dropped = chain(5, 30)
    seen = appendix_a.sight(cosines, film, FOCAL, used)
    one, other = np.array([3.0, 0.0, 3.0]), np.array([2.0, 1.0, 4.0])
    initial = np.concatenate([np.tile(one, (12, 1)), np.tile(other, (18, 1))]).T
    first = np.array([0] * 12 + [12] * 8 + [*range(20, 30)])
    done, start = orient_frames(initial, seen, dropped, first=first)
    spans = [slice(0, 12), slice(12, 20), *(slice(f, f + 1) for f in range(20, 30))]
    for span in spans:
        alone, begun = orient_frames(initial[:, span], seen.only(span), dropped[span])
        np.testing.assert_array_equal(start[:, span], begun)
        for name, ours, theirs in zip(done._fields, done, alone, strict=True):
            every = residuals(done, seen)[span]
            mine = every[seen.used.T[span]] if name == "eps" else ours[..., span]
            np.testing.assert_array_equal(mine, theirs)
