"""From frame to frame: what the next one starts from (A 109 to A 111, A 449 to A 454)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.kit import appendix_a
from tests.kit.jobs import film, without
from tests.tolerances import assert_close
from vopd.errata import fixes
from vopd.program.orient import Orientation, Sight, orient
from vopd.program.vopd import orient_frames as orient_film
from vopd.program.vopd import run_jobs, starts_due, to_be_solved
from vopd.results import Results

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


# The limits of the restart rule
#
# Without a focal length angles stay what they are but for the circle that is taken off, so the
# angle that is carried is another than that of group 8 (A 432 to A 437, A 449 to A 454).


CIRCLE = 359.999999569273  # 2 * 3.14159265 * 57.29577951


def starts(angles: list[list[float]], *names: str, dropped: tuple[int, ...] = ()) -> list[Results]:
    """Three frames that start from these angles, and as many from each of the others."""
    job = without(film(3), *dropped)
    cameras = [
        replace(job.camera, focal_length_mm=0.0, initial_deg=np.array(one)) for one in angles
    ]
    found = run_jobs([replace(job, camera=camera) for camera in cameras], fixes(*names))
    return [one for one in found if isinstance(one, Results)]


def about(axis: int, angle: float) -> list[float]:
    """One degree in two angles, and this one in the third."""
    return [angle if k == axis else 1.0 for k in range(3)]


LIMITS = {  # an angle of group 8; whether it is carried, with one circle taken off
    "yaw": (0, [(361.0, True), (366.28, True), (366.29, False), (380.0, False), (-10.0, False)]),
    "pitch": (1, [
        (361.0, True), (363.14, True), (363.15, False), (366.2, False), (190.0, False),
        (-361.0, True), (-363.14, True), (-363.15, False), (-190.0, False),
    ]),
    "roll": (2, [(361.0, True), (366.28, True), (366.29, False), (380.0, False), (-10.0, False)]),
}  # fmt: skip


@pytest.mark.parametrize("name", LIMITS)
def test_which_angles_are_carried(name: str) -> None:
    """From 0 to 2 pi degrees, 6.2832, or of pitch -3.1416 to 3.1416; others begin at group 8."""
    axis, cases = LIMITS[name]
    found = starts([about(axis, angle) for angle, _ in cases])
    for (angle, carried), one in zip(cases, found, strict=True):
        expected = angle - CIRCLE * np.sign(angle) if carried else angle
        assert_close("wrapped angle", one.start_deg[0], about(axis, angle))
        assert_close("wrapped angle", one.start_deg[1], about(axis, expected))


@pytest.mark.parametrize("name", LIMITS)
def test_all_angles_are_carried_where_that_is_corrected(name: str) -> None:
    """The limits are 0 to 360 degrees, or of pitch -180 to 180."""
    axis, cases = LIMITS[name]
    found = starts([about(axis, angle) for angle, _ in cases], "restart")
    for (angle, _), one in zip(cases, found, strict=True):
        assert_close("wrapped angle", one.start_deg[1, axis], angle - CIRCLE * np.sign(angle))


def test_a_dropped_frame_hands_nothing_on() -> None:
    """Frame 3 starts where frame 1 ended, and frame 1 at group 8."""
    (found,) = starts([[361.0, 1.0, 1.0]], dropped=(2,))
    assert_close("wrapped angle", found.start_deg[[0, 2], 0], [361.0, 361.0 - CIRCLE])
    (found,) = starts([[361.0, 1.0, 1.0]], dropped=(1,))
    assert_close("wrapped angle", found.start_deg[1:, 0], [361.0, 361.0 - CIRCLE])


def test_what_is_carried_is_what_the_22nd_correction_leaves() -> None:
    """A circle is taken off in each pass: 21 in pass 22, whose angle is printed, and then 22."""
    more, less = starts([[7925.0, 1.0, 1.0], [7565.0, 1.0, 1.0]])
    assert_close("wrapped angle", more.camera_deg[0, 0], 7925.0 - 21 * CIRCLE)
    assert_close("wrapped angle", more.start_deg[1, 0], 7925.0 - 22 * CIRCLE)
    assert_close("wrapped angle", less.camera_deg[0, 0], 7565.0 - 21 * CIRCLE)
    assert_close("wrapped angle", less.start_deg[1, 0], 7565.0 - 21 * CIRCLE)


# Rule by rule


TWOPI, PI = 6.2831853, 3.14159265  # as the listing has them, and here in degrees
ESTIMATE = [10.0, -20.0, 30.0]
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


def next_starts(
    done: Orientation,
    dropped: tuple[int, ...] = (),
    turn: float = TWOPI,
    first: np.ndarray | int = 0,
) -> list[list[float]]:
    """The start of each frame (F, 3), where these frames are dropped."""
    frames = len(done.last_pass)
    which = np.isin(np.arange(frames), dropped)
    initial = np.tile(np.array(ESTIMATE)[:, None], (1, frames))
    return np.asarray(starts_due(initial, done, which, turn, first).T).tolist()


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
        due[angle] = value if value in carried else ESTIMATE[angle]
        assert next_starts(ended((left[0], left[1], left[2]), (0.0, 0.0, 0.0))) == [
            ESTIMATE,
            due,
        ]


@pytest.mark.parametrize(
    ("left", "due"),
    [
        ((0.0, -180.0, 360.0), [0.0, -180.0, 360.0]),
        ((360.0, 180.0, 0.0), [360.0, 180.0, 0.0]),
        ((360.1, 180.1, -0.1), ESTIMATE),
        ((-0.1, -180.1, 360.1), ESTIMATE),
    ],
)
def test_the_limits_of_a_circle_of_360(left: tuple[float, float, float], due: list[float]) -> None:
    assert next_starts(ended(left, (0.0, 0.0, 0.0)), turn=360.0) == [ESTIMATE, due]


A, B, C, D = (1.0, 0.1, 2.0), (3.0, 0.2, 4.0), (5.0, 0.3, 6.0), (0.5, 0.4, 0.6)


@pytest.mark.parametrize(
    ("dropped", "exact", "due"),
    [
        ((), (), [ESTIMATE, [*A], [*B], [*C]]),
        ((1,), (), [ESTIMATE, [*A], [*A], [*C]]),
        ((), (1,), [ESTIMATE, [*A], [*A], [*C]]),
        ((0,), (), [ESTIMATE, ESTIMATE, [*B], [*C]]),
        ((), (0,), [ESTIMATE, ESTIMATE, [*B], [*C]]),
        ((0,), (1,), [ESTIMATE, ESTIMATE, ESTIMATE, [*C]]),
        ((1,), (2,), [ESTIMATE, [*A], [*A], [*A]]),
        ((0, 1, 2), (), [ESTIMATE] * 4),
        ((), (0, 1, 2), [ESTIMATE] * 4),
        ((3,), (3,), [ESTIMATE, [*A], [*B], [*C]]),
    ],
)
@pytest.mark.parametrize("last_pass", [1, 22])
def test_which_frames_leave_no_angles(
    dropped: tuple[int, ...], exact: tuple[int, ...], due: list[list[float]], last_pass: int
) -> None:
    """Those that are dropped, and those whose residuals vanished, in whichever pass."""
    done = ended(A, B, C, D)
    done.last_pass[list(exact)] = last_pass
    assert next_starts(done, dropped) == due


@pytest.mark.parametrize("angle", [0, 1, 2])
def test_no_angle_is_carried_beside_one_that_is_nan(angle: int) -> None:
    done = ended(A, B, C)
    done.next[angle, 0] = np.nan
    assert next_starts(done) == [ESTIMATE, ESTIMATE, [*B]]


def test_a_film_does_not_begin_with_the_angles_of_another() -> None:
    """Films of two frames each; the first frame of the second film leaves no angles."""
    first = np.array([0, 0, 2, 2])
    assert next_starts(ended(A, B, C, D), first=first) == [
        ESTIMATE,
        [*A],
        ESTIMATE,
        [*C],
    ]
    assert next_starts(ended(A, B, C, D), (2,), first=first) == [
        ESTIMATE,
        [*A],
        ESTIMATE,
        ESTIMATE,
    ]
    assert next_starts(ended(A, B, C, D), first=np.arange(4)) == [ESTIMATE] * 4


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


# Starts that differ in their last digits


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
