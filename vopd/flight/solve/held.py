"""Positions and free parameters that the picks do not hold, and other positions that fit too."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.findings import Finding, VopdError, count_text, frames_text
from vopd.flight.flight import Flight, NotHeld, TrackFixes
from vopd.flight.solve.equations import LEAST_SIGMA_M, Model, Priors, with_parameters
from vopd.flight.solve.errors import covariance_of_common, priors_of
from vopd.flight.solve.free import LANDMARK, free_landmarks, free_parameters, joined, shown_name
from vopd.flight.solve.joint import (
    Covariance,
    JointSolution,
    solvable,
    solve_jointly,
)
from vopd.flight.solve.normal import Factored, Normal
from vopd.flight.solve.rotations import LOSSES, FlightBlocks, SolvedFlight
from vopd.geometry.earth import axes_at, geodetic, local_axes
from vopd.geometry.linear import pseudo_inverse

ROUNDING = 1e-12  # of the largest variance of a position: less is exact


def position_ratio(found: Covariance) -> Floats:
    """Compare positions after and before the solve, (F,).

    The largest ratio of their standard deviations in any direction, 1 where the picks say
    nothing of the position; 0 where it is exact, NaN without an attitude. Coordinates that are
    exact among others do not count.
    """
    prior, after = found.place_prior_m2, found.place_m2
    known: Bools = np.asarray(np.isfinite(after).all(axis=(1, 2)))
    size, axes = np.linalg.eigh(prior)
    own = size > np.maximum(4.0 * LEAST_SIGMA_M**2, ROUNDING * size[:, 2:])
    root = axes * np.where(own, 1.0 / np.sqrt(np.where(own, size, 1.0)), 0.0)[:, None]
    counted = np.where(known[:, None, None], after, 0.0)
    largest = np.linalg.eigvalsh(root.swapaxes(1, 2) @ counted @ root)[:, -1]
    return np.where(known, np.sqrt(np.maximum(largest, 0.0)), np.nan)


FEW = 3  # landmarks in a frame: with more no second solution was found in 400 frames
FAR = 0.05  # standard deviation of a position over the distance of the landmarks: below, none
STARTS = 2.0 * np.concatenate([np.eye(3), -np.eye(3)])
"""Prior standard deviations east, north, up from where another solution is looked for."""

ON_A_LINE = 0.999  # correlation of two coordinates: a clock moves positions along the flight alone
AS_WELL = 6.0  # by which the cost of picks and priors may be larger: 20 to 1
APART = 3.0  # standard deviations between positions of different solutions


def other_solutions_deg(solution: JointSolution) -> Floats:
    """Look for other positions within the priors whose picks fit as well, frame by frame.

    Frames of three landmarks are solved each by itself, from `STARTS`, if a position of their own
    is uncertain by more than `FAR` of the landmarks' distance; landmarks stay as solved.

    Returns:
        The angle between the attitudes of the first and the other solution, (F,) degrees; NaN
        where none is found.
    """
    turned = np.full(solution.model.frames, np.nan)
    frames = np.flatnonzero(_doubtful(solution))
    if not len(frames):
        return turned
    model, flight = solution.model, solution.model.flight
    moved_m = model.landmark_by_m(solution.state)
    marks = replace(flight.landmarks, position_m=flight.landmarks.position_m + moved_m)
    lens = with_parameters(flight.lens, model.names, solution.state.parameter)
    part = FlightBlocks(replace(flight, landmarks=marks, lens=lens)).part(frames)
    used = np.isin(part.picks, model.pick)
    by_covariance = pseudo_inverse(solution.covariance.place_m2[frames])
    sigma = np.sqrt(np.einsum("fii->fi", solution.covariance.place_prior_m2))[frames]
    own = Priors(TrackFixes(np.arange(len(frames)), np.ones((len(frames), 1)), sigma))
    path = part.flight.path
    axes = axes_at(geodetic(path.position_m))
    best = solve_jointly(part.flight, own, used)
    least = np.full(len(frames), AS_WELL)
    for start in STARTS:
        moved = path.position_m + np.einsum("fji,fj->fi", axes, start * sigma)
        there = replace(part.flight, path=replace(path, position_m=moved))
        first = solve_jointly(there, Priors(), used).state
        begin = best.state._replace(rotation=first.rotation, fix_m=start * sigma)
        one = solve_jointly(part.flight, own, used, start=begin)
        gap = (one.state.fix_m - best.state.fix_m)[..., None]
        apart = (gap * (by_covariance @ gap)).sum(axis=(1, 2)) > APART**2
        more = one.normal.frame_cost - best.normal.frame_cost
        good = one.solved.attitudes.converged & apart & (more < least)
        between = one.state.rotation @ best.state.rotation.swapaxes(1, 2)
        cosine = (np.einsum("fii->f", between) - 1.0) / 2.0
        angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        turned[frames[good]] = angle[good]
        least = np.where(good, more, least)
    return turned


def _doubtful(solution: JointSolution) -> Bools:
    """Mark the frames that may have another solution, at a position of their own, (F,)."""
    model, fixes = solution.model, solution.model.priors.fixes
    path, picks = model.flight.path, model.flight.picks
    known = np.isfinite(solution.solved.attitudes.rotation[:, 0, 0])
    alone = model.frames == 1
    if fixes is not None:
        alone = fixes.weight.shape[1] == 1 and len(np.unique(fixes.first)) == model.frames
    if not alone:
        return np.zeros(model.frames, bool)
    frame, landmark = picks.frame[model.pick], picks.landmark[model.pick]
    away_m = model.flight.landmarks.position_m[landmark] - path.position_m[frame]
    count = np.bincount(frame, minlength=model.frames)
    total_m = np.bincount(frame, np.linalg.norm(away_m, axis=1), model.frames)
    prior_m2 = solution.covariance.place_prior_m2
    sigma_m = np.sqrt(np.einsum("fii->fi", prior_m2))
    scale = 1.0 / np.where(sigma_m > 0.0, sigma_m, 1.0)
    between = np.abs(prior_m2 * scale[:, :, None] * scale[:, None, :])
    on_a_line = (between[:, [0, 0, 1], [1, 2, 2]] > ON_A_LINE).any(axis=1)
    unsure = sigma_m.max(axis=1) * count > FAR * total_m
    return np.asarray(known & ~on_a_line & (count == FEW) & unsure)


# Free parameters: held by the picks, or not

MOST_LEFT = 0.7  # of a stated standard deviation: of a parameter that is held less is left
HALF_WIDTH = 1.96  # of a 95 % interval, standard deviations
TRADES = 0.95  # correlation from where on two parameters make the same images
UNDETERMINED = 1e10  # times the variance that a parameter has where all others are known
ANGLES = ("pitch", "yaw", "roll")  # turns about the camera's right, down and forward axes


def least_held(joint: JointSolution | None) -> NotHeld | None:
    """Find the free parameter that the picks hold least; None where they hold all.

    One with a stated standard deviation is held if less than `MOST_LEFT` of it is left. One
    without is held if what is left of it, one standard deviation, moves no angle by more than
    the half-width that the angle has with the parameter known.
    """
    free = () if joint is None else free_parameters(joint.model.flight)
    if joint is None or not free:
        return None
    model, sigma = joint.model, np.sqrt(np.diag(joint.factored.common))
    stated, by_stated = joint.stated[0], np.abs(joint.by_stated[2])
    left = np.sqrt(np.diag(covariance_of_common(joint)))
    turn, _, _, by_common = joint.marginals
    with np.errstate(invalid="ignore", divide="ignore"):
        spread = np.sqrt(np.einsum("fii->fi", turn))[..., None] * sigma
        with_angles = np.nan_to_num(np.abs(by_common / spread)).max(axis=0)  # (3, K)
    between = np.abs(joint.factored.common / sigma / sigma[:, None])
    worst, found = 1.0, None
    for name in free:
        k = model.names.index(name)
        if np.isfinite(model.sigma[k]):
            excess = float(left[k] / model.sigma[k] / MOST_LEFT)
        else:
            part = min(float(with_angles[:, k].max()) ** 2, 1.0 - 1e-12)
            excess = float(np.sqrt(part / (1.0 - part)) / HALF_WIDTH)
        if excess > worst:
            trades = _trades(model, with_angles[:, k], between[k], k)
            if not trades and not np.isfinite(model.sigma[k]):
                trades = (ANGLES[int(with_angles[:, k].argmax())],)
            spoiled_by = ""
            alone = np.hypot(sigma[k], np.linalg.norm(by_stated[k]))  # by what is propagated
            if sigma[k] <= MOST_LEFT * model.sigma[k] < alone < np.inf:
                spoiled_by = list(stated)[int(by_stated[k].argmax())]
            worst, found = excess, NotHeld(name, float(left[k]), trades, spoiled_by)
    return found


def trading(joint: JointSolution, parameter: str) -> tuple[str, ...]:
    """Name the parameters that make the same images as one that is held."""
    k, sigma = joint.model.names.index(parameter), np.sqrt(np.diag(joint.factored.common))
    return _trades(joint.model, np.zeros(3), np.abs(joint.factored.common[k] / sigma / sigma[k]), k)


def _trades(model: Model, with_angles: Floats, between: Floats, own: int) -> tuple[str, ...]:
    """Name angles and parameters that make the same images as a parameter."""
    names = [ANGLES[k] for k in np.flatnonzero(with_angles > TRADES)]
    names += [
        shown_name(name, model.flight.path.stands)
        for k, name in enumerate(model.names)
        if k != own and between[k] > TRADES
    ]
    marks = between[model.of_landmarks].reshape(-1, 3).max(axis=1)
    labels = model.flight.landmarks.name
    names += [f"landmark:{labels[model.free[k]]}" for k in np.flatnonzero(marks > TRADES)]
    return tuple(names)


def undetermined(flight: Flight, left_out: Bools, first: SolvedFlight) -> NotHeld | None:
    """Find a free parameter that the picks do not determine at all; None if there is none.

    Args:
        flight: the flight
        left_out: picks that take no part, (P,)
        first: its rotations with everything as it is stated

    Raises:
        VopdError: where no pick depends on a parameter, or unknowns are too many
    """
    free, priors = free_parameters(flight), priors_of(flight)
    unknown = [name for name in free if not np.isfinite(priors.parameter[name])]
    if not unknown:
        return None
    rotation = first.attitudes.rotation
    solved = np.isfinite(rotation[:, 0, 0])
    used = first.used & (first.attitudes.weight > 0.0) & ~left_out
    model = Model(flight, priors, used, solved, flight.picks.sigma_px, loss=LOSSES["least-squares"])
    _check_enough(model, len(unknown))
    known = np.where(solved[:, None, None], rotation, np.eye(3))
    with solvable(flight):
        normal = Normal(model, model.start(known))
    own = np.diag(normal.common).copy()
    where = [model.names.index(name) for name in unknown]
    for name, k in zip(unknown, where, strict=True):
        if not own[k] > 0.0:
            raise VopdError(
                f"{flight.source}: free {shown_name(name)}: no pick depends on it; leave it out"
            )
    model.common_sigma[where] = np.sqrt(10.0 * UNDETERMINED / own[where])
    with solvable(flight):
        common = Factored(normal).common
    inflated = np.diag(common)[where] * own[where]
    worst = int(inflated.argmax())
    if not inflated[worst] > UNDETERMINED:
        return None
    sigma = np.sqrt(np.diag(common))
    between = np.abs(common / sigma / sigma[:, None])
    trades = _trades(model, np.zeros(3), between[where[worst]], where[worst])
    return NotHeld(unknown[worst], float("inf"), trades)


def _check_enough(model: Model, unknown: int) -> None:
    """Refuse more unknowns than observations."""
    observed, turns = 2 * len(model.pick), 3 * model.solved
    if observed - turns < unknown:
        source, left = model.flight.source, count_text(max(observed - turns, 0), "number")
        raise VopdError(
            f"{source}: {unknown} free parameters have no standard deviation, and the picks leave "
            f"{left} beside the angles ({observed} coordinates, {turns} angles): pick more "
            "landmarks a frame, or state standard deviations under [uncertainty]"
        )


# Landmarks and clocks as solved: what a table does not say of them

ONE_LINE_DEG = 5.0  # between the lines of sight of a landmark: less, and it is as if seen from one
NAMED = 5  # landmarks of a sentence


def solved_findings(joint: JointSolution | None) -> list[Finding]:
    """Warn of landmarks on one line of sight, and of a clock that moves frames far."""
    if joint is None or not joint.model.flight.options.free:
        return []
    texts = [*_landmark_texts(joint), *_clock_texts(joint)]
    return [Finding(text, joint.model.flight.source, severity="warning") for text in texts]


UNLOCATED = 0.5  # standard deviation of a landmark over its distance: two of them are all of it


def _landmark_texts(joint: JointSolution) -> list[str]:
    """Name the free landmarks whose place along the lines of sight the picks do not tell."""
    model, common = joint.model, covariance_of_common(joint)
    flight, free, loose, far = model.flight, model.free.tolist(), [], list[str]()
    for k in (k for k in free_landmarks(flight) if k in free):
        where = len(model.names) + 3 * free.index(k) + np.arange(3)
        name, position_m = flight.landmarks.name[k], flight.landmarks.position_m[k]
        prior_m = np.maximum(flight.landmarks.sigma_m[k], LEAST_SIGMA_M)
        left, axes = np.linalg.eigh(common[np.ix_(where, where)] / np.outer(prior_m, prior_m))
        camera_m = flight.path.position_m[flight.picks.frame[model.pick[model.landmark == k]]]
        away = position_m - camera_m
        away /= np.linalg.norm(away, axis=1)[:, None]
        middle = away.mean(axis=0) / np.linalg.norm(away.mean(axis=0))
        apart = float(np.degrees(np.arccos(np.clip(away @ middle, -1.0, 1.0))).max())
        if left[-1] > MOST_LEFT**2 and apart < ONE_LINE_DEG:
            loose.append((name, prior_m * axes[:, -1]))
            continue
        moved_m = joint.state.landmark_m[k] @ local_axes(position_m)
        far_m = float(np.linalg.norm(position_m + moved_m - camera_m, axis=1).min())
        sigma_m = float(np.sqrt(np.linalg.eigvalsh(common[np.ix_(where, where)])[-1]))
        if sigma_m > UNLOCATED * far_m:
            far.append(
                f"free {LANDMARK}{name}: as solved it is {far_m:.0f} m from the camera, with a "
                f"standard deviation of {sigma_m:.2g} m: the picks do not tell how far it is. Pick "
                "it in frames that look from elsewhere, or state how well it is known"
            )
    more = [f"free landmarks: of {len(far) - NAMED} more the same is true"][: len(far) > NAMED]
    return [*_one_line_texts(loose), *far[:NAMED], *more]


def _one_line_texts(loose: list[tuple[str, Floats]]) -> list[str]:
    """Name landmarks that are seen along one line, each with its sigmas along it."""
    if not loose:
        return []
    names = [name for name, _ in loose]
    shown = joined(names if len(names) <= NAMED else [*names[:3], f"{len(names) - 3} more"])
    one = len(loose) == 1
    sigma = f", {np.linalg.norm(loose[0][1]):.3g} m" if one else ""
    return [
        f"free {LANDMARK if one else 'landmarks '}{shown}: the frames see "
        f"{'it' if one else 'each'} along nearly one line, and on that line "
        f"{'it is' if one else 'they are'} as free as sigma_m states{sigma}. Pick "
        f"{'it' if one else 'them'} in frames that look from elsewhere, or state how well "
        f"{'it is' if one else 'they are'} known"
    ]


def _clock_texts(joint: JointSolution) -> list[str]:
    """Say where a clock moves frames beyond the track's rows, or past the next one."""
    model, row_s = joint.model, joint.model.flight.path.row_s
    late_s = model.late_s(joint.state)
    if row_s is None or not {"clock", "clock_rate"} & set(model.names):
        return []
    flight, known = model.flight, np.isfinite(model.flight.path.position_m[:, 0])
    at_s, texts = flight.time_s + late_s, []
    beyond = np.flatnonzero(known & ((at_s < row_s[0]) | (at_s > row_s[-1]))).tolist()
    if beyond:
        names = flight.image_name or tuple(map(str, flight.frame.tolist()))
        texts.append(
            f"free clock: as solved it puts {frames_text([names[k] for k in beyond])} beyond the "
            f"track, which has {row_s[0]:.7g} to {row_s[-1]:.7g} s: places there continue its "
            "ends. Give a longer track, or leave out what it does not cover"
        )
    far, apart = float(late_s[np.abs(late_s).argmax()]), float(np.median(np.diff(row_s)))
    if abs(far) > apart:
        texts.append(
            f"free clock: it comes out {far:+.3g} s, more than the {apart:.3g} s between two "
            "positions of the track, whose velocity does not reach so far: add "
            f"{-far:+.3g} to [track] offset_s and adjust again"
        )
    return texts
