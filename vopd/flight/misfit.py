"""Misfits of a flight, and errors of its inputs that its residuals speak for.

A flight misfits where its residuals, on the covariance of all that is stated, are larger than the
stated standard deviation of the picks by chance once in `SIGNIFICANCE` and by more than a ratio.
An error of an input that changes the images by d a unit has the estimate d'Wr / d'Wd with the
variance 1 / d'Wd: W weighs the residuals r as all that is stated does, once everything else is
fitted. Neither takes another solve.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc, chdtri, fdtrc

from vopd.arrays import Bools, Floats
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.residuals import SIGNIFICANCE
from vopd.findings import Finding, VopdError
from vopd.flight.equations import LENS_COEFFICIENTS, SHIFT, Readout
from vopd.flight.errors import priors_of, stated_changes
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import Flight, Shutter
from vopd.flight.joint import JointSolution, covariance_of_sums, propagated, solve_jointly
from vopd.flight.readout import row_parts, turning_rates
from vopd.flight.sizes import cost_of_frames, explained, residual_freedom, size_of_residuals
from vopd.flight.solve import FlightBlocks, FlightPart

REJECTED = 1.5  # times the stated standard deviation of a pick
FEW = 0.1  # of the frames: more of them that misfit are the flight's misfit
USUAL_PX = 3.0  # of a pick whose standard deviation is not stated
ALIKE = 6.0  # in chi-square: errors that explain the residuals as well
MOST_PICKS = 20_000  # of a longer flight frames are drawn
MOST_LANDMARKS = 40  # that are tried one by one
LEAST_FREEDOM = 4.0  # beside what is tried
PLAIN = 4.0  # times the least gain: an error is named whatever it does to angles
MOST_LEFT = 0.1  # of the residuals' squares, where an error is named that leaves a misfit
WIDE_95 = 1.96  # half of a 95 % interval, standard deviations
NOTHING_SHOWS = 1e-9  # of an error's squares in the image: less is rounding


SPEAK_FOR = "the residuals speak for"
UNTRIED = "what explains them is not known: with the errors that were tried there is no solution"


# A flight that misfits


def misfit_text(joint: JointSolution, reading: JobReadingSigma, stated_px: float | None) -> str:
    """Say that the residuals of a flight are larger than what is stated explains; or nothing.

    Args:
        joint: its solution
        reading: the reading sigma in force
        stated_px: standard deviation of a pick, as stated; None: it is not
    """
    if reading.source == "stated":
        ratio, chance = size_of_residuals(joint, ordinary_frames(joint))
        if ratio > REJECTED and chance < SIGNIFICANCE:
            return (
                f"the flight misfits: its residuals are {ratio:.1f} times what the stated standard "
                f"deviations explain (chance below {SIGNIFICANCE:g})"
            )
        return ""
    picks, sigma_px = joint.model.flight.picks, reading.sigma
    expected_px, of = USUAL_PX, f"{USUAL_PX:g} px, which is usual"
    if stated_px is not None:
        expected_px, of = stated_px, f"the stated sigma_px = {stated_px:g}"
    else:  # a point that is picked several times is not identified better for it
        sigma_px *= float(np.median(picks.sigma_px)) / picks.one_sigma_px
        if picks.repeatability_px > 1.0:
            expected_px *= picks.repeatability_px
            of = f"{expected_px:.2g} px, {USUAL_PX:g} times the spread of repeated picks"
        of += ", as sigma_px is not stated"
    ratio, freedom = sigma_px / expected_px, reading.freedom
    if not np.isfinite(freedom) or not ratio > REJECTED:
        return ""
    if not chdtrc(freedom, freedom * ratio**2) < SIGNIFICANCE:
        return ""
    return (
        f"the flight misfits: its residuals speak for picks of {sigma_px:.2g} px, "
        f"{ratio:.1f} times {of} (chance below {SIGNIFICANCE:g})"
    )


def ordinary_frames(joint: JointSolution) -> Bools:
    """Leave out frames that misfit by themselves, which are flagged, where these are few, (F,)."""
    model = joint.model
    picks = np.bincount(model.flight.picks.frame[model.pick], minlength=model.frames)
    chance = chdtrc(np.maximum(2.0 * picks - 3.0, 1.0), cost_of_frames(joint))
    odd = (picks >= 2) & (chance < SIGNIFICANCE)
    if odd.sum() > FEW * (picks >= 2).sum():
        return np.ones(model.frames, bool)
    return np.asarray(~odd)


def too_wide_text(joint: JointSolution, reading: JobReadingSigma) -> str:
    """Say that the stated sigma of the picks is larger than they show; or nothing.

    Args:
        joint: the solution of a flight
        reading: the reading sigma in force
    """
    if reading.source != "stated":
        return ""
    ratio, chance = size_of_residuals(joint, np.ones(joint.model.frames, bool))
    if ratio * REJECTED < 1.0 and chance > 1.0 - SIGNIFICANCE:
        return (
            f"sigma_px = {reading.sigma:g} is stated larger than the picks show: residuals are "
            f"{ratio:.2f} times what is stated"
        )
    return ""


# Errors of the inputs


class TriedError(NamedTuple):
    """An error of the inputs that a flight may have: where its columns are, and its words."""

    columns: tuple[int, ...]
    text: Callable[[Floats], str]  # by its values
    landmark: int = -1  # index of the one that it is of


class Significant(NamedTuple):
    """An error of the inputs that the residuals speak for."""

    error: TriedError
    value: Floats  # of its columns
    gain: float  # in chi-square, over the variance of the residuals
    chance: float


def significant_errors(joint: JointSolution, known: bool, larger: float = 1.0) -> list[Significant]:
    """Find the errors of the inputs that explain the residuals best; empty if there is none.

    All trials together find one where there is none in `SIGNIFICANCE` of flights. Those that
    explain the residuals as well as the best are named with it. None is named where none of
    these moves an angle, or its mean over the frames, by more than the half-width, unless it is
    `PLAIN`; nor where the flight misfits and still would.

    Args:
        joint: the solution of a flight
        known: whether the standard deviation of the picks is stated, and believed
        larger: the residuals, in those of a flight that does not misfit
    """
    errors, trial = input_errors(joint)
    stated = np.concatenate([np.zeros((len(trial), 2, 0)), *stated_changes(joint).values()], axis=2)
    change = np.concatenate([stated, trial], axis=2)
    square, right = weighed(joint, change)
    fixed, cost = stated.shape[2], joint.normal.cost
    if fixed:  # what is stated and not solved for is a part of the residuals' covariance
        by_stated = np.linalg.solve(
            np.eye(fixed) + square[:fixed, :fixed],
            np.column_stack([square[:fixed, fixed:], right[:fixed]]),
        )
        cost -= float(right[:fixed] @ by_stated[:, -1])
        right = right[fixed:] - square[fixed:, :fixed] @ by_stated[:, -1]
        square = square[fixed:, fixed:] - square[fixed:, :fixed] @ by_stated[:, :-1]
    model = joint.model
    free = (~np.isfinite(model.common_sigma)).sum()
    freedom = 2.0 * len(model.pick) - 3.0 * model.solved - free
    power = (trial**2).sum(axis=(0, 1))
    picks, found = model.flight.picks, []
    least = (picks.least_sigma_px / picks.one_sigma_px) ** 2  # less is rounding of the picks
    for one in errors:
        index = list(one.columns)
        count, own = len(index), square[np.ix_(index, index)]
        scale = np.sqrt(power[index])
        seen = np.diag(own) > NOTHING_SHOWS * power[index]
        left = freedom - count
        if not seen.all() or left < LEAST_FREEDOM:
            continue
        scaled = own / scale[:, None] / scale
        if np.linalg.cond(scaled) > 1.0 / NOTHING_SHOWS:
            continue
        value = np.linalg.solve(scaled, right[index] / scale) / scale
        gain = float(right[index] @ value)
        rest = max((cost - gain) / left, least)
        if known and rest < REJECTED**2:
            chance, rest = float(chdtrc(count, gain)), 1.0
        else:
            chance = float(fdtrc(count, left, gain / count / rest))
        explains = rest * larger**2 < REJECTED**2 or rest < MOST_LEFT
        found.append(Significant(one, value, gain / rest, chance if explains else 1.0))
    limit = SIGNIFICANCE / max(len(found), 1)
    if not found or min(one.chance for one in found) > limit:
        return []
    named = [one for one in found if one.chance <= limit]
    worth = {id(one): one.gain - 2.0 * (len(one.value) - 1) for one in named}
    best = max(worth.values())
    alike = sorted((o for o in named if worth[id(o)] > best - ALIKE), key=lambda o: -worth[id(o)])
    least = float(chdtri(len(alike[0].value), limit))
    if alike[0].gain > PLAIN * least:
        return alike
    moving = any(_moves_an_angle(joint, trial, stated, one) for one in alike)
    return alike if moving else []


def weighed(joint: JointSolution, change: Floats) -> tuple[Floats, Floats]:
    """Weigh changes of the images as the residuals are: their products, and those with residuals.

    Args:
        joint: the solution of a flight
        change: of the computed images, in standard deviations of the picks, (P, 2, k)

    Returns:
        X'WX (k, k) and X'Wr (k,).
    """
    left, normal, k = unfollowed(joint, change), joint.normal, change.shape[2]
    square = change.reshape(-1, k).T @ left.reshape(-1, k)
    right = np.einsum("pik,pi->k", change * normal.weight[:, None, None], normal.residual)
    return (square + square.T) / 2.0, right


def unfollowed(joint: JointSolution, change: Floats) -> Floats:
    """Take from changes of the images what the unknowns follow of them, weighted, (P, 2, k).

    Args:
        joint: the solution of a flight
        change: of the computed images, in standard deviations of the picks, (P, 2, k)
    """
    normal = joint.normal
    weighted = change * normal.weight[:, None, None]
    turn, fix, common = joint.factored.solve(normal.right_side(weighted))
    place = np.zeros_like(turn)
    if normal.fixes is not None:
        place = normal.fixes.at_frames(fix)
    followed = normal.seen(turn, place, common) * normal.weight[:, None, None]
    return np.asarray(weighted - followed)


def _moves_an_angle(joint: JointSolution, trial: Floats, stated: Floats, one: Significant) -> bool:
    """Tell whether an error turns a frame, or all in the mean, by more than the half-width."""
    columns = trial[..., list(one.error.columns)] @ one.value[:, None]
    turn, _ = propagated(joint, np.concatenate([columns, stated], axis=2))
    variance = np.einsum("fii->fi", joint.covariance.turn) + (turn[..., 1:] ** 2).sum(axis=2)
    with np.errstate(invalid="ignore"):
        if (np.abs(turn[..., 0]) > WIDE_95 * np.sqrt(variance)).any():
            return True
    weight = np.tile(np.eye(3) / joint.model.solved, (joint.model.frames, 1, 1))
    mean = turn.sum(axis=0) / joint.model.solved
    own, _ = covariance_of_sums(joint, weight)
    variance = np.diag(own) + (mean[:, 1:] ** 2).sum(axis=1)
    return bool((np.abs(mean[:, 0]) > WIDE_95 * np.sqrt(variance)).any())


def input_errors(joint: JointSolution) -> tuple[list[TriedError], Floats]:
    """List the errors that are tried, and differentiate the images by them.

    Args:
        joint: the solution of a flight

    Returns:
        The errors, and the changes of the computed images by a unit of each of their columns, in
        standard deviations of the picks, (P, 2, K).
    """
    model, flight = joint.model, joint.model.flight
    timed = flight.path.velocity_m_s is not None and flight.path.acceleration_m_s2 is not None
    names = [*SHIFT, "focal"]
    names += ["k1"] if "k1" in LENS_COEFFICIENTS[flight.lens.kind] else []
    names += ["refraction"] if flight.refraction.k else []
    names += ["clock", "clock_rate"] if timed else []
    readout = _readout(joint) if timed else None
    names += ["readout"] if readout is not None else []
    more = {name: 1.0 for name in names if name not in model.names}
    full = model.with_priors(replace(model.priors, parameter={**model.priors.parameter, **more}))
    full.readout = readout
    start = joint.state._replace(
        parameter=np.concatenate([joint.state.parameter, np.zeros(len(more))])
    )
    marks = np.unique(model.landmark)
    marks = marks[: len(marks) * (len(marks) <= MOST_LANDMARKS)]
    out = np.zeros((len(model.pick), 2, len(names) + 3 * len(marks)))
    where = [full.names.index(name) for name in names]
    slot = np.full(len(flight.landmarks.name), -1)
    slot[marks] = np.arange(len(marks))
    velocity = _even_velocity(joint) if timed else np.zeros((model.frames, 3))
    for rows in full.rows(start):
        out[rows.picks, :, : len(names)] = rows.by_parameter[..., where]
        if timed:
            moved = (rows.by_place @ velocity[rows.frames, None, :, None])[..., 0]
            since_s = (flight.time_s - np.nanmin(flight.time_s))[rows.frames, None, None]
            out[rows.picks, :, names.index("clock")] = moved
            out[rows.picks, :, names.index("clock_rate")] = moved * np.nan_to_num(since_s)
        own = slot[model.landmark[rows.picks]]
        if len(marks):
            for axis in range(3):
                flat = rows.picks.ravel()
                column = len(names) + 3 * own.ravel() + axis
                out[flat, :, column] = rows.by_landmark[..., axis].reshape(-1, 2)
    errors = [*_common_errors(flight, names)]
    for k, mark in enumerate(marks):
        first = len(names) + 3 * k
        columns = (first, first + 1, first + 2)
        errors.append(TriedError(columns, _landmark_text(flight, int(mark)), int(mark)))
    return errors, out


def _even_velocity(joint: JointSolution) -> Floats:
    """Take the noise of the fixes out of the velocity, east, north, up (F, 3).

    Where the positions are as near to an even motion, or to one that changes evenly, as their
    standard deviations allow, it is that motion's; else it stays what it is.
    """
    flight, velocity = joint.model.flight, joint.model.velocity_m_s
    fixes, time_s = flight.path.fixes, flight.time_s
    known = np.isfinite(time_s) & velocity.any(axis=1)
    if fixes is None or known.sum() < 4:
        return velocity
    away_m = flight.path.position_m - flight.path.position_m[known][0]
    place_m = np.einsum("fij,fj->fi", joint.model.axes, away_m)[known]
    since_s = time_s[known] - time_s[known].mean()
    noise = float((fixes.sigma_m**2).mean())
    for degree in (1, 2):
        powers = since_s[:, None] ** np.arange(degree + 1)
        fit, *_ = np.linalg.lstsq(powers, place_m, rcond=None)
        if ((place_m - powers @ fit) ** 2).mean() < 2.0 * noise:
            even = velocity.copy()
            rate = np.arange(1, degree + 1)
            even[known] = (powers[:, :-1] * rate) @ fit[1:]
            return even
    return velocity


def _common_errors(flight: Flight, names: list[str]) -> Iterator[TriedError]:
    """List the errors of inputs that are one for the flight, the simplest first."""
    lens = flight.lens

    def at(*some: str) -> tuple[int, ...]:
        return tuple(names.index(name) for name in some)

    if "clock" in names:
        yield TriedError(
            at("clock"),
            lambda v: f"the track {-v[0]:+.3g} s: do the clocks differ ([track] offset_s)?",
        )
        yield TriedError(
            at("clock_rate"),
            lambda v: f"[picks] frame_rate_hz {1.0 / (1.0 + v[0]):.5g} times as large",
        )
    focal = float(lens.focal_px.mean())
    yield TriedError(
        at("focal"),
        lambda v: f"a focal length of {focal + v[0]:.5g} px in the place of {focal:.5g}",
    )
    if "k1" in names:
        k1 = float(lens.k[0])
        yield TriedError(at("k1"), lambda v: f"k1 = {k1 + v[0]:.4g} in the place of {k1:.4g}")
    if "refraction" in names:
        k = flight.refraction.k
        yield TriedError(
            at("refraction"),
            lambda v: f"a coefficient of refraction of {k + v[0]:.3g} in the place of {k:.3g}",
        )
    yield TriedError(
        at("up"),
        lambda v: (
            f"all landmarks {-v[0]:+.3g} m: are the heights of camera and landmarks counted "
            "from the same level?"
        ),
    )
    yield TriedError(
        at(*SHIFT),
        lambda v: "the camera's position {:+.3g} m east, {:+.3g} m north, {:+.3g} m up".format(*v),
    )
    if "readout" in names:
        yield TriedError(at("readout"), lambda v: _readout_text(flight, 1000.0 * float(v[0])))


def _readout_text(flight: Flight, more_ms: float) -> str:
    if flight.shutter is not None:
        stated_ms = 1000.0 * flight.shutter.readout_s
        return f"[camera] readout_ms = {stated_ms + more_ms:.3g} in the place of {stated_ms:.3g}"
    way = "down" if more_ms > 0.0 else "up"
    return f'a rolling shutter, [camera] readout_ms = {abs(more_ms):.3g} and readout = "{way}"'


def _readout(joint: JointSolution) -> Readout | None:
    """Take the readout of the flight, or of rows downward; None if no turning rate is known."""
    model, flight = joint.model, joint.model.flight
    turning = np.nan_to_num(turning_rates(flight, joint.state.rotation))
    if not turning.any():
        return None
    rows = flight.shutter or Shutter(0.0, "down", False)
    part = row_parts(replace(flight, shutter=rows))
    return Readout(0.0 if model.readout is None else model.readout.seconds, part, turning)


def _landmark_text(flight: Flight, mark: int) -> Callable[[Floats], str]:
    name = flight.landmarks.name[mark]
    return lambda v: "{} {:+.3g} m east, {:+.3g} m north, {:+.3g} m up".format(name, *v)


# Sizes of errors that the picks speak for

LEAST_GAIN = 10.8  # in twice the log likelihood: .001
SIZE_ROUNDS, SIZE_SETTLED = 6, 0.03
SIZES = {"reading": "picks", "position": "positions", "landmark": "landmarks"}


def sizes_text(flight: Flight, left_out: Bools | None = None) -> str:
    """Say which errors are larger than stated, where those of one component explain a misfit.

    Variance components by restricted maximum likelihood: the one whose size, changed by itself,
    makes the residuals the likeliest by `ALIKE` more than any other, or those that do alike.

    Args:
        flight: with the standard deviations that are stated
        left_out: picks that take no part, (P,)
    """
    priors = priors_of(flight)
    used = None if left_out is None else ~left_out
    first = solve_jointly(flight, priors, used)
    model = first.model
    known = np.isfinite(model.common_sigma).tolist()
    there = {"reading", *(c for c, one in zip(model.component, known, strict=True) if one)}
    there |= {"position"} if priors.fixes is not None and not priors.fixes.exact else set()
    found = {name: size_spoken_for(first, name) for name in SIZES if name in there}
    best = max(gain for _, gain in found.values())
    alike = [name for name, (_, gain) in found.items() if gain > best - ALIKE]
    if not best > LEAST_GAIN or alike == ["reading"]:
        return ""
    parts = [f"{SIZES[name]} {found[name][0]:.2g} times as uncertain as stated" for name in alike]
    return f"the picks speak for {' or '.join(parts)}{_metres(first, alike, found)}"


def _metres(joint: JointSolution, alike: list[str], found: dict[str, tuple[float, float]]) -> str:
    """Say the size in metres of positions or landmarks, where they alone are spoken for."""
    priors = joint.model.priors
    if alike == ["position"] and priors.fixes is not None:
        own = priors.fixes.sigma_m
        own = own if priors.fixes.between is None else own[~priors.fixes.between]
    elif alike == ["position"]:
        place = [priors.parameter.get(name, np.inf) for name in SHIFT]
        own = np.array([[one for one in place if np.isfinite(one)]])
    elif alike == ["landmark"] and priors.landmark_m is not None:
        own = priors.landmark_m[joint.model.free]
    else:
        return ""
    stated_m = float(np.median(own))
    spoken_m = stated_m * found[alike[0]][0]
    return f": for {spoken_m:.2g} m where {stated_m:.2g} m is stated (sigma_m)"


def size_spoken_for(first: JointSolution, component: str) -> tuple[float, float]:
    """Estimate by which factor the errors of a component are larger than stated.

    By restricted maximum likelihood: the errors found, squared in stated sigmas, are as many as
    the picks say of them. "reading" is the picks' own.

    Args:
        first: the solution with what is stated
        component: of the uncertainty

    Returns:
        The factor, and the gain in twice the log likelihood.
    """
    flight, priors, used = first.model.flight, first.model.priors, first.solved.used
    solution, factor = first, 1.0
    for _ in range(SIZE_ROUNDS):
        squares, left = _squares(solution, component)
        step = float(np.clip(np.sqrt(squares / left), 0.3, 3.0)) if left > 0.0 else 1.0
        factor *= step
        scaled, own = priors.scaled(component, factor), flight
        if component == "reading":
            own = replace(flight, picks=flight.picks.with_sigma(flight.picks.one_sigma_px * factor))
        start = solution.state if solution.passes else None
        solution = solve_jointly(own, scaled, used, start=start)
        if abs(np.log(step)) < SIZE_SETTLED:
            break
    return factor, log_likelihood(solution) - log_likelihood(first)


def _squares(solution: JointSolution, component: str) -> tuple[float, float]:
    """Add up squares of the errors of a component, and count their degrees of freedom."""
    model, state = solution.model, solution.state
    if component == "reading":
        return float((solution.normal.residual**2).sum()), residual_freedom(solution)[0]
    common = np.concatenate([state.parameter, state.landmark_m[model.free].ravel()])
    own = [one == component for one in model.component]
    squares = float(((common / model.common_sigma)[own] ** 2).sum())
    free = int((~np.isfinite(model.common_sigma))[own].sum())
    if component == "position":
        squares += float(((state.fix_m / model.fix_sigma_m) ** 2).sum())
    return squares, explained(solution).get(component, 0.0) - free


def log_likelihood(solution: JointSolution) -> float:
    """Evaluate twice the restricted log likelihood, but for a constant of the flight.

    Args:
        solution: of the flight
    """
    model = solution.model
    stated = np.isfinite(model.common_sigma)
    logs = np.log(model.common_sigma[stated]).sum() + np.log(model.fix_sigma_m).sum()
    readings = -4.0 * np.log(model.scale).sum()
    cost = solution.normal.cost + solution.factored.log_determinant
    return -float(cost + 2.0 * logs + readings)


# What is said


def sampled(flight: Flight) -> FlightPart:
    """Draw frames over a whole flight, those with many landmarks first, up to `MOST_PICKS`."""
    blocks = FlightBlocks(flight)
    if len(flight.picks.frame) <= MOST_PICKS:
        return blocks.part(np.arange(len(flight.frame)))
    count, runs = blocks.layout.count, 50
    stretch = np.arange(len(count)) * runs // len(count)
    order = np.lexsort((-count, stretch))
    rank = np.arange(len(count)) - np.searchsorted(stretch[order], stretch[order])
    order = order[np.lexsort((stretch[order], rank))]  # the best of each stretch, then the next
    chosen = order[np.cumsum(count[order]) <= MOST_PICKS]
    return blocks.part(np.sort(chosen))


def flight_findings(
    flight: Flight, estimates: FlightEstimates, left_out: Bools, wrong: Bools
) -> tuple[list[Finding], bool]:
    """Warn of a flight that misfits, and name errors of its inputs that explain it.

    Args:
        flight: as it was read
        estimates: its solution, with the reading sigma in force
        left_out: picks that take no part in it, as they are named, (P,)
        wrong: landmarks that are named, which are not named again, (N,)

    Returns:
        The warnings, and whether the flight misfits.
    """
    joint, reading = estimates.joint, estimates.reading
    if joint is None or reading is None:
        return [], False
    stated = flight.picks.one_sigma_px if flight.picks.stated else None
    misfit = misfit_text(joint, reading, stated) if flight.options.may_misfit else ""
    texts = [misfit, too_wide_text(joint, reading)]
    try:
        texts += _explanations(flight, estimates, left_out, wrong, bool(misfit))
    except (VopdError, np.linalg.LinAlgError):  # the angles stand without
        texts += [UNTRIED] * bool(misfit)
    where = flight.source
    return [Finding(text, where, severity="warning") for text in texts if text], bool(misfit)


def _explanations(
    flight: Flight, estimates: FlightEstimates, left_out: Bools, wrong: Bools, misfits: bool
) -> list[str]:
    """Name errors of a flight's inputs that explain its residuals.

    Raises:
        VopdError: if the flight has no solution with one of them
    """
    joint, reading = estimates.joint, estimates.reading
    assert joint is not None and reading is not None
    stated = flight.picks.one_sigma_px if flight.picks.stated else None
    exact = not joint.passes
    if len(joint.model.pick) > MOST_PICKS:
        some = sampled(joint.model.flight)
        joint = solve_jointly(some.flight, priors_of(some.flight), ~left_out[some.picks])
    expected_px = USUAL_PX if stated is None else stated
    if misfits:
        from vopd.flight.mistakes import exchanges  # which takes results

        text = exchanges(flight, expected_px)
        if text:
            return [text]
    larger = reading.sigma / expected_px if misfits and reading.source != "stated" else 1.0
    found = significant_errors(joint, reading.source == "stated", larger)
    named = np.append(wrong, False)[[one.error.landmark for one in found]]
    if found and not named.any():
        names = " or ".join(one.error.text(one.value) for one in found)
        chance = max(one.chance for one in found)
        return [f"{SPEAK_FOR} {names} (chance {chance:.1g})"]
    if not found and misfits and stated is not None and not exact:
        some = sampled(flight)
        return [sizes_text(some.flight, left_out[some.picks])]
    return []
