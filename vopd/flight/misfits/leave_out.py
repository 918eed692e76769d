"""Tests of a flight by leaving out each pick, landmark, frame and fix in turn, by updating.

With H = A N^-1 A' the part of the images that the unknowns follow (A the rows of the equations, N
the normal equations with their priors), a set S of picks is predicted by all others with the errors
e = (I - H W)_SS^-1 r_S, of covariance I + H (I - W H)^-1, and without it the unknowns move by
-N^-1 A_S' W e (Cook and Weisberg, Residuals and influence in regression, 1982, 2.2 and 3.2). An
error of an input that changes the images by d a unit, and is left free, has the value
d'(I - H)r / d'(I - H)d; one of prior P, estimate x and covariance M after the solve is tested by
x'(P - M)^-1 x. Each is a test of Baarda (A testing procedure for use in geodetic networks, 1968),
or of Pope (NOAA NOS 65 NGS 1, 1976) where the reading sigma is estimated.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, fdtrc, gammaln

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.flight.solve.equations import LinearisedPicks, Model
from vopd.flight.solve.joint import JointSolution, places_by_fixes, propagated, unfollowed, weighed
from vopd.flight.solve.sizes import fix_covariances
from vopd.records import Rows

KINDS = ("landmark", "frame", "time", "position", "fix", "pick")
"""What is left out: a landmark's coordinates, all picks of a frame, the time of a frame, its
position where that is exact, a fix of the track, a pick."""
LANDMARK, FRAME, TIME, POSITION, FIX, PICK = range(len(KINDS))

MOST_LANDMARKS = 300  # that are left out: those with the most picks
LANDMARK_NUMBERS = 4_000_000  # of the changes of the images by some landmarks at once
MOST_MOVES = 20_000_000  # tests times frames whose movement is calculated
MOVES_AT_ONCE = 400_000
SHOWS = 1e-9  # of an error's squares: less is rounding, and nothing else tells of it
LEAST_LEFT = 0.5  # degrees of freedom of the reading sigma without what is tested
DETERMINED = 5.0  # standard deviations, in the worst direction, of an error that is told
SHOWN = 1e-6  # of the best direction: what is known less is not known


@dataclass(frozen=True, eq=False, repr=False)
class LeftOut(Rows):
    """The tests of a flight, T of them, each by leaving out one thing."""

    kind: Ints  # index in `KINDS`
    frame: Ints  # index of the frame, -1: it is not of one
    landmark: Ints  # index of the landmark, -1 likewise
    fix: Ints  # index of the fix, -1 likewise
    pick: Ints  # index of the pick, -1 likewise
    freedom: Ints  # degrees of freedom of the test
    gain: Floats  # decrease of the weighted sum of squares, in those of the reading sigma in force
    chance: Floats  # of a gain as large, or larger, by chance
    # that one or more of all tests of the flight have so small a chance: Sidak's
    chance_of_all: Floats
    off_px: Floats  # of a pick from its prediction, u, v; NaN elsewhere, (T, 2)
    # of a landmark, a position and a fix east, north, up, m, of a time, s: what is to be added to
    # it; NaN elsewhere, and where that is not determined, (T, 3)
    error: Floats
    rms_px: Floats  # of all other picks then, of landmarks; NaN elsewhere
    moved_rad: Floats  # the turn of the frame that moves most, about its camera's axes, (T, 3)
    moved_frame: Ints  # that frame; -1: none was looked for
    mean_moved_rad: Floats  # the mean of the turns of all frames, (T, 3)

    @property
    def normalised(self) -> Floats:
        """Root mean square of what was tested over its standard deviation (T,); 1 is usual."""
        return np.asarray(np.sqrt(self.gain / self.freedom))

    @property
    def evidence(self) -> Floats:
        """Minus twice the logarithm of the chance (T,), where that is below all numbers, too."""
        half, gain = self.freedom / 2.0, np.maximum(self.gain, 1.0)
        with np.errstate(divide="ignore"):
            tail = gain - 2.0 * (half - 1.0) * np.log(gain / 2.0) + 2.0 * gammaln(half)
            return np.where(self.chance > 1e-200, -2.0 * np.log(self.chance), tail)


def _tests(kind: int, count: int, **known: Floats | Ints) -> LeftOut:
    """Begin the record of some tests of one kind; chances and movements are filled in later."""
    values: dict[str, Floats | Ints] = {"kind": np.full(count, kind)}
    values |= {n: np.full(count, -1) for n in ("frame", "landmark", "fix", "pick", "moved_frame")}
    values |= {n: np.full(count, np.nan) for n in ("chance", "chance_of_all", "rms_px")}
    blank = {"off_px": 2, "error": 3, "moved_rad": 3, "mean_moved_rad": 3}
    values |= {n: np.full((count, width), np.nan) for n, width in blank.items()}
    return LeftOut(**{**values, **known})  # type: ignore[arg-type]


class _Step(NamedTuple):
    """What is left out of B frames, as a change of the right side of the equations."""

    test: Ints  # (B,) index of the test
    frame: Ints  # (B,)
    turn: Floats  # (B, 3) of the frame itself, if nothing else moved
    place: Floats  # (B, 3) right sides, the turns eliminated
    column: Ints  # (B, q)
    common: Floats  # (B, q) likewise


class _Collected:
    """Tests and their steps as they come, and the variance of the readings, in that stated."""

    def __init__(
        self, variance: float, reading: JobReadingSigma | None = None, least_px: float = 0.0
    ) -> None:
        self.variance = variance
        self.reading = reading  # None: the variance is stated
        self.least_px = least_px
        self.tests: list[LeftOut] = []
        self.steps: list[_Step] = []
        self.count = 0

    def add(self, tests: LeftOut) -> Ints:
        """Add tests: their indices among all."""
        self.tests.append(tests)
        self.count += len(tests.kind)
        return np.arange(self.count - len(tests.kind), self.count)

    def variance_without(self, gain: Floats, freedom: Ints) -> Floats:
        """Estimate the variance of the readings without what each test leaves out, (T,).

        Args:
            gain: of the tests, (T,)
            freedom: likewise
        """
        if self.reading is None:
            return np.full(len(gain), self.variance)
        part = _part_without(gain / self.variance, freedom, self.reading, self.least_px)
        return self.variance * part


@np.errstate(all="ignore")
def leave_out(
    joint: JointSolution, reading: JobReadingSigma, beside: Bools | None = None
) -> LeftOut:
    """Leave out each landmark, frame, fix and pick in turn, by updating.

    Args:
        joint: the solution of a flight
        reading: the reading sigma in force
        beside: picks that took no part and are predicted by those that did, (P,)

    Returns:
        The tests; a thing of which nothing else tells has none.
    """
    flight = joint.model.flight
    variance = (reading.test_sigma / flight.picks.one_sigma_px) ** 2
    to = _Collected(variance, reading, flight.picks.least_sigma_px)
    _add_landmarks(joint, to)
    _add_frames_and_picks(joint, beside, to)
    fix_steps = _add_fixes(joint, to)
    tests = LeftOut.concat(to.tests)
    possible = reading.freedom - tests.freedom > LEAST_LEFT
    tests.gain[:] /= to.variance
    judge(tests, reading, flight.picks.least_sigma_px, int(possible.sum()))
    _move(joint, tests, to.steps, fix_steps)
    return tests.take(possible)


@np.errstate(all="ignore")
def leave_out_picks(joint: JointSolution) -> LeftOut:
    """Leave out each pick and each frame, by the standard deviations that are stated.

    Args:
        joint: the solution of a flight

    Returns:
        The tests, without their chances, and without movements of frames.
    """
    to = _Collected(1.0)
    _add_frames_and_picks(joint, None, to)
    return LeftOut.concat(to.tests)


@np.errstate(divide="ignore")  # a chance of 1 is 1 of all
def judge(tests: LeftOut, reading: JobReadingSigma, least_px: float, every: int) -> None:
    """Calculate the chances of tests; gains become those in the variance without each.

    Args:
        tests: with their gains
        reading: the reading sigma in force
        least_px: reading sigma that is believed
        every: how many tests there are
    """
    gain, count, left = tests.gain, tests.freedom, reading.freedom - tests.freedom
    gain /= _part_without(gain, count, reading, least_px)
    if np.isinf(reading.freedom):
        tests.chance[:] = chdtrc(count, gain)
    else:
        tests.chance[:] = np.where(left > LEAST_LEFT, fdtrc(count, left, gain / count), 1.0)
    tests.chance_of_all[:] = -np.expm1(every * np.log1p(-tests.chance))


def _part_without(gain: Floats, count: Ints, reading: JobReadingSigma, least_px: float) -> Floats:
    """Calculate which part of the variance is left without what each test leaves out, (T,).

    Args:
        gain: of the tests, in the variance with all, (T,)
        count: their degrees of freedom, (T,)
        reading: the reading sigma in force
        least_px: reading sigma that is believed
    """
    if np.isinf(reading.freedom):
        return np.ones(len(gain))
    left, least = reading.freedom - count, (least_px / reading.test_sigma) ** 2
    return np.maximum((reading.freedom - gain) / left, least)


def _freed(
    square: Floats, right: Floats, power: Floats, to: _Collected
) -> tuple[Floats, Floats, Ints, Bools]:
    """Free errors that k columns make: their values (B, k), gains and degrees of freedom (B,).

    Args:
        square: X'WX, (B, k, k)
        right: X'Wr, (B, k)
        power: X'X, of which less than `SHOWS` is rounding, (B, k)
        to: where all tests are

    Returns:
        Besides these marks of the values that are determined, (B,).
    """
    scale = np.sqrt(power.max(axis=1))
    scale = np.where(scale > 0.0, scale, 1.0)[:, None]
    size, axes = np.linalg.eigh(np.nan_to_num(square / scale[..., None] ** 2))
    along = np.einsum("bij,bi->bj", axes, right / scale)
    shown = size > np.maximum(SHOWN * size[:, -1:], SHOWS)
    along = np.where(shown, along / np.where(shown, size, 1.0), 0.0)
    value = np.einsum("bij,bj->bi", axes, along)
    least = np.where(shown.all(axis=1), size[:, 0], 0.0)
    gain, freedom = (along**2 * size).sum(axis=1), shown.sum(axis=1)
    variance = to.variance_without(gain, freedom)
    determined = (value**2).sum(axis=1) * least > DETERMINED**2 * variance
    return value / scale, gain, freedom, determined


# Landmarks


def _add_landmarks(joint: JointSolution, to: _Collected) -> None:
    """Leave out the coordinates of each landmark."""
    model = joint.model
    picks = np.bincount(model.landmark, minlength=len(model.flight.landmarks.name))
    flight_frame = model.flight.picks.frame
    marks = np.argsort(-picks, kind="stable")[: min((picks > 0).sum(), MOST_LANDMARKS)]
    step = max(LANDMARK_NUMBERS // (6 * len(model.pick)), 1)
    for start in range(0, len(marks), step):
        some = np.sort(marks[start : start + step])
        change = _by_landmarks(joint, some)
        square, right = weighed(joint, change)
        at = np.arange(len(some))
        blocks = square.reshape(len(some), 3, len(some), 3)[at, :, at]
        power = (change**2).sum(axis=(0, 1)).reshape(-1, 3)
        value, gain, freedom, known = _freed(blocks, right.reshape(-1, 3), power, to)
        tested = freedom > 0
        if not tested.any():
            continue
        some, value = some[tested], value[tested]
        change = change.reshape(*change.shape[:2], -1, 3)[:, :, tested]
        error = np.einsum("pink,nk->pin", change, value)
        left = (
            joint.normal.residual[..., None]
            - unfollowed(joint, error) / (joint.normal.weight[:, None, None])
        )
        others = model.landmark[:, None] != some
        squared = ((left / model.scale[:, None, None]) ** 2).sum(axis=1)
        rms_px = np.sqrt((squared * others).sum(axis=0) / (2.0 * others.sum(axis=0)))
        turn, _, _ = propagated(joint, error)
        tests = _tests(
            LANDMARK, len(some), landmark=some, freedom=freedom[tested], gain=gain[tested],
            error=np.where(known[tested, None], value, np.nan), rms_px=rms_px,
        )  # fmt: skip
        for k in np.flatnonzero(picks[some] == 1):  # of a single pick: it is predicted
            row = int(np.flatnonzero(model.landmark == some[k])[0])
            tests.pick[k], tests.frame[k] = model.pick[row], flight_frame[model.pick[row]]
            tests.off_px[k] = error[row, :, k] / model.scale[row]
        _moved(tests, np.arange(len(some)), turn, joint)
        to.add(tests)


def _by_landmarks(joint: JointSolution, marks: Ints) -> Floats:
    """Differentiate images by metres east, north, up of some landmarks, (P, 2, 3N)."""
    model = joint.model
    out = np.zeros((len(model.pick), 2, 3 * len(marks)))
    slot = np.full(len(model.flight.landmarks.name), -1)
    slot[marks] = np.arange(len(marks))
    for rows in model.rows(joint.state):
        own, flat = slot[model.landmark[rows.picks]].ravel(), rows.picks.ravel()
        here = own >= 0
        values = rows.by_landmark.reshape(-1, 2, 3)
        for axis in range(3):
            out[flat[here], :, 3 * own[here] + axis] = values[here, :, axis]
    return out


# What is known of a frame


class _Frame(NamedTuple):
    """B frames with n picks each, and their equations by the unknowns and their covariance."""

    rows: LinearisedPicks
    residual: Floats  # (B, 2n) in standard deviations
    weight: Floats  # (B, 2n) 0 of picks that took no part
    part: Floats  # (B, 2n, 2n) H: of the images that all unknowns follow
    turn: Floats  # (B, 3, 2n) covariance of the turns with the images
    alone: Floats  # (B, 3, 2n) the same where the further unknowns are exact
    left: Floats  # (B, 2n, q) images by the further unknowns, that no turn follows
    column: Ints  # where these are in what is common


def _every(joint: JointSolution, beside: Bools | None) -> Model:
    """Take the picks of a solution, and those beside it of landmarks that are exact or free."""
    model = joint.model
    if beside is None or not beside.any():
        return model
    flight, priors = model.flight, model.priors
    known = np.ones(len(flight.landmarks.name), bool)
    if priors.landmark_m is not None:
        known[(priors.landmark_m > 0.0).any(axis=1)] = False
    known[model.free] = True
    used = beside & known[flight.picks.landmark]
    clicks = flight.picks.clicks
    if clicks is not None:
        used[clicks.pick[~np.isin(clicks.click, model.clicked)]] = False
    used[model.pick] = True
    solved = np.bincount(flight.picks.frame[model.pick], minlength=model.frames) > 1

    def of_those() -> Model:
        return Model(flight, priors, used, solved, flight.picks.sigma_px, model.readout, model.loss)

    every = of_those()
    for rows in every.rows(joint.state):  # a landmark behind the camera has no image
        used[every.pick[rows.picks]] = np.isfinite(rows.residual).all(axis=-1)
    return every if used[every.pick].all() else of_those()


def _known_frames(joint: JointSolution, every: Model) -> Iterator[_Frame]:
    """Iterate over blocks of frames with the covariances of their unknowns.

    With x the place by the fixes and c what is common, a turn is u - G (x, c), u by the frame's
    picks alone; so images T u + F (x, c) are T u + (F - T G)(x, c), of independent parts.
    """
    model, factored = joint.model, joint.factored
    weight = np.zeros(len(model.flight.picks.frame))
    weight[model.pick] = joint.normal.weight
    size, fixes = len(model.common_sigma), factored.fixes
    common = np.zeros((size + 3, size + 3))  # landmarks that are exact are in the last three
    common[:size, :size] = factored.common
    if fixes is not None:
        through, own = fixes.at_frames(factored.back), places_by_fixes(factored)
        mixed = np.zeros((model.frames, 3, size + 3))
        mixed[..., :size] = -through @ factored.common
    for rows in every.rows(joint.state):
        count, n = rows.picks.shape
        turn = rows.by_turn.reshape(count, 2 * n, 3)
        further, column = every.further(rows)
        w = np.repeat(weight[every.pick[rows.picks]], 2, axis=1)
        across = turn.swapaxes(1, 2) * w[:, None]
        inverse = np.linalg.inv(across @ turn)
        gains = inverse @ (across @ further)
        left = further - turn @ gains  # what no turn follows
        covariance = common[column[:, :, None], column[:, None]]
        if fixes is not None:
            some = rows.frames
            beside = np.take_along_axis(mixed[some], column[:, None], axis=2)
            places = own[some] - mixed[some, :, :size] @ through[some].swapaxes(1, 2)
            top = np.concatenate([places, beside], axis=2)
            covariance = np.concatenate([beside.swapaxes(1, 2), covariance], axis=2)
            covariance = np.concatenate([top, covariance], axis=1)
        followed = covariance @ left.swapaxes(1, 2)
        by_turn = inverse @ turn.swapaxes(1, 2)
        part = turn @ by_turn + left @ followed
        residual = rows.residual.reshape(count, 2 * n)
        yield _Frame(
            rows, residual, w, part, by_turn - gains @ followed, by_turn, left, column
        )  # fmt: skip


# Picks, and frames: whole, their time, their position


def _add_frames_and_picks(joint: JointSolution, beside: Bools | None, to: _Collected) -> None:
    """Leave out picks, and frames: all of each, its time, its position."""
    every, model = _every(joint, beside), joint.model
    path = model.flight.path
    timed = path.velocity_m_s is not None and path.acceleration_m_s2 is not None
    alone = np.bincount(every.landmark, minlength=len(model.flight.landmarks.name)) == 1
    for frame in _known_frames(joint, every):
        count, n = frame.rows.picks.shape
        for k in range(n):
            _add_pick(joint, every, frame, k, alone, to)
        several = (frame.weight > 0.0).sum(axis=1) > 2
        root = np.sqrt(frame.weight)
        matrix = np.eye(2 * n) - root[:, :, None] * frame.part * root[:, None]
        if model.solved > 1:
            size, axes = np.linalg.eigh(matrix)
            # three are the turn's own, of which nothing is left
            shown = size > SHOWS
            along = np.einsum("bij,bi->bj", axes, root * frame.residual)
            along = np.where(shown, along / np.where(shown, size, 1.0), 0.0)
            gain, freedom = (along**2 * size).sum(axis=1), shown.sum(axis=1)
            freedom = freedom - (root == 0.0).sum(axis=1)
            moved = root * np.einsum("bij,bj->bi", axes, along)
            _add_of_frames(FRAME, frame, several, gain, freedom, None, moved, to)
        ways = frame.rows.by_place.reshape(count, 2 * n, 3)
        if timed:
            speed = model.velocity_m_s[frame.rows.frames]
            _add_freed(TIME, frame, several, matrix, ways @ speed[..., None], to)
        if model.priors.fixes is None and not path.stands:
            _add_freed(POSITION, frame, several, matrix, ways, to)


def _add_pick(
    joint: JointSolution, every: Model, frame: _Frame, k: int, alone: Bools, to: _Collected
) -> None:
    """Leave out the k-th pick of each frame; that of a landmark with one is its landmark's test."""
    own = slice(2 * k, 2 * k + 2)
    w, part = frame.weight[:, own.start], frame.part[:, own, own]
    left = np.eye(2) - w[:, None, None] * part
    size = np.linalg.eigvalsh(left)[:, 0]
    others = (frame.weight > 0.0).sum(axis=1) // 2 - (w > 0.0)
    landmark = every.landmark[frame.rows.picks[:, k]]
    tested = (size > SHOWS) & (others > 1) & ~(alone[landmark] & (w > 0.0))
    inverse = np.linalg.inv(np.where(tested[:, None, None], left, np.eye(2)))
    error = (inverse @ frame.residual[:, own, None])[..., 0]
    weights = np.linalg.inv(np.eye(2) + part @ inverse)
    weighted = (weights @ error[..., None])[..., 0]
    gain = (error * weighted).sum(axis=1)
    values = np.where((w > 0.0)[:, None], w[:, None] * error, weighted)
    turn = -(frame.turn[..., own] @ values[..., None])[..., 0]
    pick = frame.rows.picks[tested, k]
    to.add(_tests(
        PICK, int(tested.sum()), frame=frame.rows.frames[tested], landmark=landmark[tested],
        pick=every.pick[pick], freedom=np.full(len(pick), 2), gain=gain[tested],
        off_px=error[tested] / every.scale[pick, None],
        moved_rad=turn[tested], moved_frame=frame.rows.frames[tested],
    ))  # fmt: skip


def _add_freed(
    kind: int, frame: _Frame, several: Bools, matrix: Floats, way: Floats, to: _Collected
) -> None:
    """Free what moves the images of each frame by columns (B, 2n, k)."""
    root = np.sqrt(frame.weight)[..., None]
    own = way * root
    square = own.swapaxes(1, 2) @ matrix @ own
    right = (own * root * frame.residual[..., None]).sum(axis=1)
    value, gain, freedom, known = _freed(square, right, (own**2).sum(axis=1), to)
    moved = (way @ value[..., None])[..., 0] * frame.weight
    error = np.full((len(value), 3), np.nan)
    error[:, : value.shape[1]] = np.where(known[:, None], value, np.nan)
    _add_of_frames(kind, frame, several, gain, freedom, error, moved, to)


def _add_of_frames(
    kind: int, frame: _Frame, several: Bools, gain: Floats, freedom: Ints, error: Floats | None,
    moved: Floats, to: _Collected,
) -> None:  # fmt: skip
    """Add the tests of frames, and the step of each.

    Args:
        kind: of the tests
        frame: the frames
        several: those that are tested, (B,)
        gain: (B,)
        freedom: (B,)
        error: (B, 3)
        moved: what is taken from the images, weighted, (B, 2n)
        to: where all tests are
    """
    tested = several & (freedom > 0)
    known = {} if error is None else {"error": error[tested]}
    index = to.add(_tests(
        kind, int(tested.sum()), frame=frame.rows.frames[tested], freedom=freedom[tested],
        gain=gain[tested], **known,
    ))  # fmt: skip
    values = -moved[..., None]
    further, turn = frame.left.swapaxes(1, 2) @ values, frame.alone @ values
    width = frame.column.shape[1]
    split = further.shape[1] - width  # before it is the place
    to.steps.append(_Step(
        index, frame.rows.frames[tested], turn[tested, :, 0], further[tested, :split, 0],
        frame.column[tested], further[tested, split:, 0],
    ))  # fmt: skip


# Fixes


def _add_fixes(joint: JointSolution, to: _Collected) -> tuple[Ints, Ints, Floats]:
    """Leave out each fix of the track: tests, fixes, and right sides of these, (T, 3)."""
    model, none = joint.model, np.zeros(0, np.int64)
    if model.priors.fixes is None:
        return none, none, np.zeros((0, 3))
    scale = model.fix_sigma_m
    after = fix_covariances(joint.factored) / (scale[:, :, None] * scale[:, None])
    error = joint.state.fix_m / scale
    size, axes = np.linalg.eigh(np.eye(3) - after)
    along = np.einsum("jik,ji->jk", axes, error)
    shown = size > SHOWN
    along = np.where(shown, along / np.where(shown, size, 1.0), 0.0)
    gain, freedom = (along**2 * size).sum(axis=1), shown.sum(axis=1)
    weighted = np.einsum("jik,jk->ji", axes, along)
    least = np.where(shown.all(axis=1), size[:, 0] / (1.0 - size[:, 0]), 0.0)
    known = (weighted**2).sum(axis=1) * least > DETERMINED**2
    fix = freedom > 0
    if model.priors.fixes.between is not None:
        fix &= ~model.priors.fixes.between
    index = to.add(_tests(
        FIX, int(fix.sum()), fix=np.flatnonzero(fix), freedom=freedom[fix], gain=gain[fix],
        error=np.where(known[:, None], weighted * scale, np.nan)[fix],
    ))  # fmt: skip
    return index, np.flatnonzero(fix), (weighted / scale)[fix]


# How rotations move


def _move(
    joint: JointSolution, tests: LeftOut, steps: list[_Step], fixes: tuple[Ints, Ints, Floats]
) -> None:
    """Calculate how all frames turn without a frame, its time, its position, or a fix.

    Args:
        joint: the solution
        tests: of which the movements are filled in
        steps: of frames
        fixes: indices of their tests, their own, and right sides
    """
    frames, size = joint.model.frames, joint.normal.size
    most = max(MOST_MOVES // frames, 1)
    every = np.concatenate([*(one.test for one in steps), fixes[0]])
    chosen = np.zeros(len(tests.kind), bool)
    chosen[every[np.argsort(-tests.evidence[every], kind="stable")[:most]]] = True
    together = max(MOVES_AT_ONCE // (3 * frames), 1)
    factored, track = joint.factored, joint.factored.fixes
    for one in steps:
        rows = np.flatnonzero(chosen[one.test])
        for start in range(0, len(rows), together):
            some = rows[start : start + together]
            frame, at = one.frame[some], np.arange(len(some))
            fix, common = _no_right_side(joint, len(some))
            inside = one.column[some] < size
            np.add.at(
                common, (one.column[some][inside], np.nonzero(inside)[0]), one.common[some][inside]
            )
            if track is not None:
                for slot, weight in enumerate(track.weight[frame].T):
                    where = np.minimum(track.first[frame] + slot, len(fix) - 1)
                    fix[where, :, at] += weight[:, None] * one.place[some]
            turn = factored.turns(None, *factored.solve_further(fix, common))
            turn[frame, :, at] += one.turn[some]
            if len(some) and tests.kind[one.test[0]] == FRAME:
                turn[frame, :, at] = 0.0  # it has no attitude then
            _moved(tests, one.test[some], turn, joint)
    test, fix_index, values = fixes
    rows = np.flatnonzero(chosen[test])
    for start in range(0, len(rows), together):
        some = rows[start : start + together]
        fix, common = _no_right_side(joint, len(some))
        fix[fix_index[some], :, np.arange(len(some))] = values[some]
        turn = factored.turns(None, *factored.solve_further(fix, common))
        _moved(tests, test[some], turn, joint)


def _no_right_side(joint: JointSolution, count: int) -> tuple[Floats, Floats]:
    fix = np.zeros((*joint.model.fix_sigma_m.shape, count))
    return fix, np.zeros((joint.normal.size, count))


def _moved(tests: LeftOut, index: Ints, turn: Floats, joint: JointSolution) -> None:
    """Fill in the largest turn (F, 3, T) of each test, and the mean of all."""
    if not len(index):
        return
    size = (turn**2).sum(axis=1)
    largest = size.argmax(axis=0)
    tests.moved_frame[index] = np.where(size.max(axis=0) > 0.0, largest, -1)
    tests.moved_rad[index] = turn[largest, :, np.arange(len(index))]
    tests.mean_moved_rad[index] = (turn.sum(axis=0) / joint.model.solved).T
