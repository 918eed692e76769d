"""Labels of two landmarks, or more, that are exchanged in a frame.

Each two labels of a frame that does not fit are exchanged, and all of them are dealt anew by what
the angles between its picks show; the frame's rotation and place are solved anew, its place under
its own standard deviations; landmarks, lens and all else that frames have in common are held. In a
frame of four landmarks two picks that do not fit cannot be named one by one: no three others would
be left that agree.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations, permutations
from math import comb, e, factorial
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, fdtrc

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.residuals import SIGNIFICANCE
from vopd.findings import VopdError
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import Flight, TrackFixes
from vopd.flight.misfits.blunders import NO_EXCHANGE, Exchanges
from vopd.flight.solve.equations import LEAST_SIGMA_M, Priors
from vopd.flight.solve.free import as_solved
from vopd.flight.solve.joint import solve_jointly, widened_by
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.flight.solve.rotations import (
    FlightBlocks,
    SolvedFlight,
    path_part,
    pick_distances_px,
    pick_errors_px,
    solve,
)
from vopd.geometry.lenses import ray_of_pixel
from vopd.geometry.linear import norm

LEAST_IN_FRAME = 3  # landmarks
LEAST_DEALT, MOST_DEALT = 4, 12  # of a frame whose labels are dealt anew
FRAMES_DEALT = 50  # of a flight, the first
FRAMES_ASKED = 20  # of a flight, spread over it, how all its labels are dealt
ROTATIONS_TRIED = 2_000  # of a frame: two picks and two landmarks that are as far apart
DEALINGS = 6  # of a frame: what the picks of all these rotations say, the nearest first
APART_RAD = 0.02  # between two picks that give a rotation
MOST_LANDMARKS = 24  # of a frame, the worst, that are exchanged in twos
MOST_IN_A_FRAME = 200  # landmarks: a frame with more is not searched
SEARCHED_PICKS = 100_000  # of all exchanges together: frames beyond are not searched
KEPT = 4  # exchanges of a frame, the best by its rotation alone, whose place is solved for
RANKING_PASSES = 2  # from Wahba's rotation: of one that fits the cost is known to a thousandth
TRIAL_PASSES = 20  # which are enough for a rotation that fits
ALIKE = 6.0  # in twice the log likelihood: what explains the residuals as well
OF_ONE_PICK = 4.0  # in the same: two numbers that one gross pick has, and an exchange has not
REJECTED = 2.0  # times the standard deviations in force: residuals that are none of an exchange
FAR = 10.0  # times the usual ones, where none is in force
IN_MOST = 0.5  # of the frames with both landmarks: their labels are exchanged in the whole flight
FEWEST_FRAMES = 3  # of those


def gross_exchanges(solved: SolvedFlight, suspected: Bools, out: Bools) -> Exchanges:
    """Find exchanged labels in frames that tell nothing of the others, each by itself.

    Args:
        solved: the flight, solved with all picks at its stated places
        suspected: frames with residuals far larger than most have, (F,)
        out: gross picks, (P,)
    """
    flight = solved.flight
    place_m = np.tile(flight.path.bias_sigma_m, (len(flight.frame), 1))
    if flight.path.fixes is not None:
        place_m = np.hypot(place_m, flight.path.fixes.frame_sigma_m)
    wide = widened_by(flight, (flight.landmarks.sigma_m**2).mean(axis=1))
    error_px = pick_errors_px(solved)
    return _exchanges(wide, place_m, suspected, out, error_px, np.zeros(len(flight.frame)))


def exchanges(estimates: FlightEstimates, frames: Bools, out: Bools) -> Exchanges:
    """Find exchanged labels in some frames of a flight that was solved without blunders.

    Args:
        estimates: of the flight, with the reading sigma in force
        frames: those that do not fit, (F,)
        out: picks that do not fit, (P,)
    """
    joint, reading = estimates.joint, estimates.reading
    if joint is None or reading is None:
        return NO_EXCHANGE
    model = joint.model
    flight, marks = model.flight, model.flight.landmarks
    # what is common is held; the error of its own fixes is each frame's to solve for
    common = joint.state._replace(fix_m=np.zeros_like(joint.state.fix_m))
    moved_m = np.einsum("fji,fj->fi", model.axes, model.moved_m(common))
    path = replace(flight.path, position_m=flight.path.position_m + moved_m)
    if estimates.solved.landmark_m is not None:
        marks = replace(marks, position_m=estimates.solved.landmark_m)
    variance = np.zeros(len(marks.name))
    try:
        known = np.diag(joint.factored.common)[model.of_landmarks] if joint.passes else np.zeros(0)
    except VopdError:  # nothing is known of what is common
        return NO_EXCHANGE
    variance[model.free] = known.reshape(-1, 3).mean(axis=1)
    own = replace(as_solved(flight, joint), path=path, landmarks=marks)
    wide = widened_by(replace(own, picks=own.picks.with_sigma(reading.test_sigma)), variance)
    fixes = model.priors.fixes
    place_m = np.zeros_like(path.position_m) if fixes is None else fixes.frame_sigma_m
    part = np.bincount(flight.picks.frame[model.pick], minlength=model.frames)
    others = np.maximum(reading.freedom - np.maximum(2.0 * part - 3.0, 0.0), 0.0)
    error_px = pick_errors_px(estimates.solved)
    return _exchanges(wide, place_m, frames, out, error_px, others)


def exchanged_places(
    frame: Ints, seen: Floats, expected: Floats, limit_px: Floats
) -> list[tuple[int, int]]:
    """Find pairs of picks of one frame of which each lies where the other should be.

    Args:
        frame: of each pick that is not where it should be, (n,)
        seen: where it is, (n, 2)
        expected: where it should be, (n, 2)
        limit_px: how near it must be to the other's place, (n,)
    """
    found: list[tuple[int, int]] = []
    for i, j in combinations(range(len(frame)), 2):
        apart = np.hypot(*(seen[[i, j]] - expected[[j, i]]).T)
        used = {k for pair in found for k in pair}
        if frame[i] == frame[j] and (apart < limit_px[[i, j]]).all() and not {i, j} & used:
            found.append((i, j))
    return found


class _Trial(NamedTuple):
    """A frame with labels that may be exchanged."""

    frame: int
    picks: Ints  # (n,) of the flight
    label: Ints  # (n,) their landmarks
    used: Bools  # (n,)
    moved: tuple[int, ...] = ()  # the picks whose labels are exchanged

    def exchanged(self, one: int, other: int) -> _Trial:
        """Exchange the labels of two picks, by their places in the frame."""
        label = self.label.copy()
        label[[one, other]] = label[[other, one]]
        return self.dealt(label)

    def dealt(self, label: Ints) -> _Trial:
        """Give the picks other labels of theirs, (n,)."""
        moved = self.picks[label != self.label]
        return self._replace(label=label, moved=tuple(moved.tolist()))

    @property
    def ways(self) -> float:
        """In how many ways as many of the frame's labels are exchanged."""
        count = len(self.moved)
        return comb(int(self.used.sum()), count) * round(factorial(count) / e)

    def without(self, pick: int) -> _Trial:
        """Leave out a pick."""
        return self._replace(used=self.used & (self.picks != pick))


class _Likely(NamedTuple):
    """An exchange that the picks speak for."""

    trial: _Trial
    gain: float  # in twice the log likelihood, less that of as many ways
    cost: float  # with the labels exchanged
    freedom: float
    before_px: float
    after_px: float
    chance: float


def _exchanges(
    flight: Flight, place_m: Floats, frames: Bools, out: Bools, error_px: Floats, others: Floats
) -> Exchanges:
    """Find exchanged labels.

    An exchange has no free number. It is named where it is likelier than the labels as they are
    by more than chance has it once in `SIGNIFICANCE` of flights, whatever pair it is; where no
    other exchange, and no gross pick in the place of the two, is nearly as likely; and where its
    residuals are none of a misfit.

    Args:
        flight: everything but rotations and the frames' own places as it is held; standard
            deviations of picks with those of landmarks
        place_m: standard deviations of those places, east, north, up, (F, 3)
        frames: those that are searched, (F,)
        out: picks that do not fit, (P,)
        error_px: each pick less its landmark's image, (P, 2)
        others: degrees of freedom of the reading sigma by other frames, (F,); 0: it is not known
    """
    flight = replace(flight, options=replace(flight.options, loss="least-squares", free=()))
    blocks, searched, total, dealt = FlightBlocks(flight), ~frames, 0, 0
    groups: list[list[_Trial]] = []
    for frame in np.flatnonzero(frames).tolist():
        plain = _plain(blocks, frame)
        more = _picks_of_trials(plain, out)
        if total + more <= SEARCHED_PICKS:
            searched[frame], total = True, total + more
            own = _groups_of_frame(plain, out, error_px) if more else []
            if own and dealt < FRAMES_DEALT:
                own[0] += _dealt_anew(flight, plain)
                dealt += 1
            groups += own
    costs_alone = _costs_of_rotations(flight, groups)
    groups = [_best(group, cost) for group, cost in zip(groups, costs_alone, strict=True)]
    groups = [group for group in groups if len(group) > 1]
    likely, alone = [], []
    fits = _fitted(flight, place_m, groups)
    for (plain, *rest), (costs, rms_px) in zip(groups, fits, strict=True):
        freedom, known = 2.0 * float(plain.used.sum()) - 3.0, float(others[plain.frame])
        gain = _gain(flight, costs[0], costs[1:], freedom, known)
        gain -= 2.0 * np.log([one.ways for one in rest])
        best = int(gain.argmax())
        if not gain[best] > 2.0 * np.log(len(flight.frame) / SIGNIFICANCE):
            continue
        cost = float(costs[1 + best])
        chance = _chance(cost, freedom, known)
        misfits = chance < SIGNIFICANCE and cost > REJECTED**2 * freedom
        misfits |= np.isnan(chance) and cost > FAR**2 * freedom
        if misfits or (gain > gain[best] - ALIKE).sum() > 1:
            continue
        sizes = float(rms_px[0]), float(rms_px[1 + best])
        likely.append(_Likely(rest[best], float(gain[best]), cost, freedom, *sizes, chance))
        alone.append([plain.without(pick) for pick in rest[best].moved])
    found = [
        one
        for one, (costs, _) in zip(likely, _fitted(flight, place_m, alone), strict=True)
        if _gain(flight, one.cost, costs, one.freedom, float(others[one.trial.frame])).max()
        < ALIKE + OF_ONE_PICK
    ]
    few = _in_few_frames(flight, _disjoint(found), searched)
    return few._replace(not_searched=int((~searched).sum()))


def _plain(blocks: FlightBlocks, frame: int) -> _Trial:
    """Take a frame with its labels as they are."""
    picks = blocks.picks(np.array([frame]))
    label = blocks.flight.picks.landmark[picks]
    return _Trial(frame, picks, label, blocks.flight.landmarks.takes_part[label])


def _picks_of_trials(plain: _Trial, out: Bools) -> int:
    """Count the picks of all that `_groups_of_frame` lists; 0: the frame has too few or too many.

    Args:
        plain: the frame
        out: picks that do not fit, (P,)
    """
    used, gross = int(plain.used.sum()), int((plain.used & out[plain.picks]).sum())
    if not LEAST_IN_FRAME <= used <= MOST_IN_A_FRAME:
        return 0
    alone = comb(gross, 2) if gross > 2 and used - gross + 2 >= LEAST_IN_FRAME else 0
    return len(plain.picks) * (1 + comb(min(used, MOST_LANDMARKS), 2) + 2 * alone)


def _groups_of_frame(plain: _Trial, out: Bools, error_px: Floats) -> list[list[_Trial]]:
    """List what is tried of a frame, in groups of the same picks: first their own labels.

    All exchanges of its worst landmarks, with all picks; and where more than two picks do not fit,
    the exchanges of any two of these without the others of them.
    """
    picks, used = plain.picks, plain.used
    size = np.where(used, np.nan_to_num(np.hypot(*error_px[picks].T), nan=np.inf), -1.0)
    worst = np.sort(np.argsort(-size, kind="stable")[: min(int(used.sum()), MOST_LANDMARKS)])
    groups = [[plain, *(plain.exchanged(*pair) for pair in combinations(worst.tolist(), 2))]]
    gross = np.flatnonzero(used & out[picks])
    for pair in combinations(gross.tolist(), 2) if len(gross) > 2 else ():
        rest = used.copy()
        rest[np.setdiff1d(gross, pair)] = False
        if rest.sum() >= LEAST_IN_FRAME:
            alone = plain._replace(used=rest)
            groups.append([alone, alone.exchanged(*pair)])
    return groups


def _dealt_anew(flight: Flight, plain: _Trial) -> list[_Trial]:
    """Deal all labels of a frame anew: the best ways, but for those that exchange two alone."""
    trials = [plain.dealt(label) for label in _dealings(flight, plain)]
    return [one for one in trials if len(one.moved) > 2]


def labels_of_all_frames(flight: Flight) -> Ints:
    """Deal all labels of a flight anew, as most frames show: the landmark of each label, (N,)."""
    blocks = FlightBlocks(flight)
    count = blocks.layout.count
    frames = np.flatnonzero((count >= LEAST_DEALT) & (count <= MOST_DEALT))
    asked = [_plain(blocks, frame) for frame in frames[:: len(frames) // FRAMES_ASKED + 1].tolist()]
    rather = np.arange(len(flight.landmarks.name))
    if not asked:
        return rather
    seen = np.unique(np.concatenate([plain.label for plain in asked]))
    votes = np.zeros((len(seen),) * 2)  # of few: each frame may have landmarks of its own
    for plain in asked:
        for label in _dealings(flight, plain)[:1]:
            np.add.at(votes, tuple(np.searchsorted(seen, [plain.label, label])), 1.0)
    votes += 0.5 * np.eye(len(votes))  # as they are, where nothing speaks against it
    to = votes.argmax(axis=1)
    if (np.bincount(to, minlength=len(to)) == 1).all():
        rather[seen] = seen[to]
    return rather


def _dealings(flight: Flight, plain: _Trial) -> list[Ints]:
    """List ways to deal the labels of a frame, (n,), the best first; none of too few or many.

    Two picks that look at two landmarks give a rotation, by which each pick is nearest to one
    landmark: these are all labels of the frame, or the rotation is none.
    """
    used = np.flatnonzero(plain.used)
    count = len(used)
    if not LEAST_DEALT <= count <= MOST_DEALT:
        return []
    frame, label = np.full(count, plain.frame), plain.label[used]
    ray = ray_of_pixel(flight.lens.of(frame), flight.picks.pixel[plain.picks[used]])
    camera_m = flight.path.position_m[[plain.frame]]
    lines = sight_lines(camera_m, flight.landmarks.position_m, frame * 0, label, flight.refraction)
    if not np.isfinite(ray).all() or not np.isfinite(lines.direction).all():
        return []
    marks = np.array(list(permutations(range(count), 2)))
    picked = marks[marks[:, 0] < marks[:, 1]]
    axes_of_picks, apart = _axes_of_two(ray[picked])
    axes_of_marks, own = _axes_of_two(lines.direction[marks])
    alike = np.abs(apart[:, None] - own)
    alike[np.minimum(apart[:, None], own) < APART_RAD] = np.inf
    best = np.argsort(alike, axis=None, kind="stable")[:ROTATIONS_TRIED]
    of_picks, of_marks = np.divmod(best, len(marks))
    rotation = axes_of_picks[of_picks].swapaxes(1, 2) @ axes_of_marks[of_marks]
    cosine = np.einsum("ki,hij,lj->hkl", ray, rotation, lines.direction)
    order = cosine.argmax(axis=2)[np.argsort(-cosine.max(axis=2).sum(axis=1), kind="stable")]
    order = order[(np.sort(order, axis=1) == np.arange(count)).all(axis=1)]
    dealt = []
    for one in [*dict.fromkeys(map(tuple, order.tolist()))][:DEALINGS]:
        dealt.append(plain.label.copy())
        dealt[-1][used] = label[list(one)]
    return dealt


def _axes_of_two(direction: Floats) -> tuple[Floats, Floats]:
    """Make axes of two directions each, (n, 2, 3): rows (n, 3, 3), and the angle between them."""
    first, second = direction[:, 0], direction[:, 1]
    across = np.cross(first, second)
    size = norm(across)
    across = across / np.maximum(size, np.finfo(float).tiny)[:, None]
    axes = np.stack([first, across, np.cross(first, across)], axis=1)
    return axes, np.arctan2(size, (first * second).sum(axis=1))


def _best(group: list[_Trial], cost: Floats) -> list[_Trial]:
    """Keep the labels as they are, and of the exchanges that fit better the best."""
    size = cost[1:] + 2.0 * np.log([one.ways for one in group[1:]])
    better = [1 + k for k in np.argsort(size, kind="stable")[:KEPT]]
    return [group[0], *(group[k] for k in better if cost[k] < cost[0])]


def _costs_of_rotations(flight: Flight, groups: list[list[_Trial]]) -> list[Floats]:
    """Solve each trial for its rotation alone: the weighted squares of each group's trials.

    They are infinite where a pick has no image. An antenna's place, which turns with the camera,
    is the camera's.
    """
    trials = [one for group in groups for one in group]
    if not trials:
        return []
    copies, used = _copies(replace(flight, path=replace(flight.path, lever_arm_m=None)), trials)
    found = solve(copies, ~used, RANKING_PASSES)
    squares = (pick_distances_px(found) / copies.picks.sigma_px) ** 2
    cost = np.bincount(copies.picks.frame[used], squares[used], len(trials))
    cost = np.where(np.isfinite(cost), cost, np.inf)
    return np.split(cost, np.cumsum([len(group) for group in groups])[:-1])


def _fitted(
    flight: Flight, place_m: Floats, groups: list[list[_Trial]]
) -> list[tuple[Floats, Floats]]:
    """Solve each trial for its rotation, and its place.

    Args:
        flight: the flight
        place_m: standard deviations of places, (F, 3)
        groups: the trials

    Returns:
        Of each group its trials' weighted squares, infinite where a pick has no image, and root
        mean squares of the residuals in pixels, NaN likewise.
    """
    trials = [one for group in groups for one in group]
    if not trials:
        return []
    copies, used = _copies(flight, trials)
    frames = len(trials)
    own_m = place_m[[one.frame for one in trials]]
    fixes = TrackFixes(np.arange(frames), np.ones((frames, 1)), own_m)
    priors = Priors(fixes if (own_m > LEAST_SIGMA_M).any() else None)
    try:
        first = solve(copies, ~used, TRIAL_PASSES)
        found = solve_jointly(copies, priors, used, first=first)
        normal = found.normal
    except VopdError:  # nothing is known of these frames
        cost, rms_px = np.full(frames, np.inf), np.full(frames, np.nan)
    else:
        model, frame = found.model, copies.picks.frame
        taken = np.bincount(frame[model.pick], minlength=frames)
        whole = (taken == np.bincount(frame[used], minlength=frames)) & (taken > 1)
        squares = np.zeros(frames)
        residual_px = normal.residual / model.scale[:, None]
        np.add.at(squares, frame[model.pick], (residual_px**2).sum(axis=1))
        cost = np.where(whole, normal.frame_cost, np.inf)
        rms_px = np.where(whole, np.sqrt(squares / np.maximum(2.0 * taken, 1.0)), np.nan)
    ends = np.cumsum([len(group) for group in groups])[:-1]
    return list(zip(np.split(cost, ends), np.split(rms_px, ends), strict=True))


def _copies(flight: Flight, trials: list[_Trial]) -> tuple[Flight, Bools]:
    """Form a flight of which each frame is a trial, and mark the picks that take part."""
    frames = np.array([one.frame for one in trials])
    picks = np.concatenate([one.picks for one in trials])
    own = replace(
        flight.picks,
        frame=np.repeat(np.arange(len(trials)), [len(one.picks) for one in trials]),
        landmark=np.concatenate([one.label for one in trials]),
        pixel=flight.picks.pixel[picks],
        sigma_px=flight.picks.sigma_px[picks],
        part=None if flight.picks.part is None else flight.picks.part[picks],
    )
    copies = replace(
        flight, lens=flight.lens.of(frames), frame=np.arange(len(trials)), image_name=(),
        time_s=flight.time_s[frames], picks=own,
        path=replace(path_part(flight.path, frames), fixes=None), grid=None,
    )  # fmt: skip
    return copies, np.concatenate([one.used for one in trials])


@np.errstate(all="ignore")
def _gain(flight: Flight, before: float, after: Floats, freedom: float, others: float) -> Floats:
    """Calculate by how much a frame becomes likelier, in twice the log likelihood.

    The reading sigma is known by so many degrees of freedom of other frames, and the frame's own.

    Args:
        flight: the flight
        before: weighted squares
        after: weighted squares of some trials
        freedom: of the frame
        others: infinite where the reading sigma is stated
    """
    gain = before - after
    if np.isfinite(others):
        least = freedom * flight.picks.least_variance
        ratio = (others + max(before, least)) / (others + np.maximum(after, least))
        gain = (others + freedom) * np.log(ratio)
    return np.where(np.isfinite(after), gain, -np.inf)


def _chance(cost: float, freedom: float, others: float) -> float:
    """Calculate the chance of a frame's residuals; NaN where the reading sigma is not known."""
    if np.isfinite(others):
        return float(fdtrc(freedom, others, cost / freedom)) if others > 0.0 else np.nan
    return float(chdtrc(freedom, cost))


def _disjoint(found: list[_Likely]) -> list[_Likely]:
    """Keep the likeliest of exchanges that have a pick in common, in the order of the picks."""
    kept: dict[tuple[int, ...], _Likely] = {}
    for one in sorted(found, key=lambda one: -one.gain):
        if not {pick for moved in kept for pick in moved} & set(one.trial.moved):
            kept[one.trial.moved] = one
    return [kept[moved] for moved in sorted(kept)]


def _in_few_frames(flight: Flight, found: list[_Likely], searched: Bools) -> Exchanges:
    """Leave out exchanges of the same labels in most frames: the whole flight has them."""
    picks, frames = flight.picks, len(flight.frame)
    labels = [frozenset(picks.landmark[list(one.trial.moved)].tolist()) for one in found]
    kept = []
    for one, some in zip(found, labels, strict=True):
        every = searched.copy()
        for mark in some:
            every &= np.bincount(picks.frame[picks.landmark == mark], minlength=frames) > 0
        count = labels.count(some)
        if count < FEWEST_FRAMES or count <= IN_MOST * every.sum():
            kept.append(one)
    if not kept:
        return NO_EXCHANGE
    sizes = np.array([(one.before_px, one.after_px, one.chance) for one in kept])
    moved = [np.isin(one.trial.picks, one.trial.moved) for one in kept]
    return Exchanges(
        tuple(one.trial.picks[some] for one, some in zip(kept, moved, strict=True)),
        tuple(one.trial.label[some] for one, some in zip(kept, moved, strict=True)),
        *sizes.T,
    )
