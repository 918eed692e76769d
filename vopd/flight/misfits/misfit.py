"""Misfits of a flight: whether its residuals are larger than what is stated, and what explains it.

A flight misfits where its residuals, on the covariance of all that is stated, are larger than the
stated standard deviation of the picks by chance once in `SIGNIFICANCE` and by more than a ratio.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc

from vopd.arrays import Bools
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.residuals import SIGNIFICANCE
from vopd.findings import Finding, VopdError, size_text
from vopd.flight.estimate import FlightEstimates
from vopd.flight.flight import Flight
from vopd.flight.misfits.input_errors import (
    ALIKE,
    OF_LANDMARK,
    REJECTED,
    SHIFTED,
    SPEAK_FOR,
    TYPICAL,
    UNEXPLAINED,
    Significant,
    named_text,
    of_sampled,
    sampled,
    significant_errors,
    times_as_far,
    with_stated_exact,
)
from vopd.flight.solve.equations import SHIFT
from vopd.flight.solve.errors import every_prior, priors_of, with_places_solved_for
from vopd.flight.solve.joint import PASSES, JointSolution, solve_jointly
from vopd.flight.solve.sizes import (
    cost_of_frames,
    residual_freedom,
    size_of_residuals,
    squares_of_errors,
)

MOST_BLUNDERS = 0.25  # of the picks: more of them are the flight's misfit
FEW = 0.1  # of the frames: more of them that misfit are the flight's misfit
MOST_FRAMES = 0.5  # more of them that misfit by themselves are the flight's misfit in any case
USUAL_PX = 3.0  # of a pick whose standard deviation is not stated

MISFITS = "the flight misfits"
UNTRIED = "what explains them is not known: with the errors that were tried there is no solution"


KNOWN = ("stated", "given")  # reading sigmas that residuals are measured by


def misfit_text(joint: JointSolution, reading: JobReadingSigma, stated_px: float | None) -> str:
    """Say that the residuals of a flight are larger than what is stated explains; or nothing.

    Args:
        joint: its solution
        reading: the reading sigma in force
        stated_px: standard deviation of a pick, as stated; None: it is not
    """
    if reading.source in KNOWN and reading.sigma > 0.0:
        ratio, chance = size_of_residuals(joint, ordinary_frames(joint))
        if ratio > REJECTED and chance < SIGNIFICANCE:
            if reading.source == "given":
                return (
                    f"{MISFITS}: the given reading sigma of {reading.sigma:g} px is smaller than "
                    f"its residuals show, {size_text(ratio * reading.sigma)} px: "
                    f"{ratio:.1f} times what it and the stated standard deviations explain "
                    f"(chance below {SIGNIFICANCE:g})"
                )
            return (
                f"{MISFITS}: its residuals are {ratio:.1f} times what the stated standard "
                f"deviations explain (chance below {SIGNIFICANCE:g})"
            )
        return far_text(joint)
    picks, sigma_px = joint.model.flight.picks, reading.sigma
    expected_px, of = USUAL_PX, f"the usual {USUAL_PX:g} px"
    if picks.clicks is not None:
        assert stated_px is not None
        expected_px = stated_px
        of = f"what tracks of such a sigma_px should have, {size_text(stated_px)}"
    elif stated_px is not None:
        expected_px, of = stated_px, f"the stated sigma_px = {stated_px:g}"
    else:  # a point that is picked several times is not identified better for it
        sigma_px *= float(np.median(picks.sigma_px)) / picks.one_sigma_px
        if picks.repeatability_px > 1.0:
            expected_px *= picks.repeatability_px
            of = f"{size_text(expected_px)} px, {USUAL_PX:g} times the spread of repeated picks"
        of += ", as sigma_px is not stated"
    ratio, freedom = sigma_px / expected_px, reading.freedom
    large = np.isfinite(freedom) and ratio > REJECTED
    if large and chdtrc(freedom, freedom * ratio**2) < SIGNIFICANCE:
        shown_px = float(f"{sigma_px:.2g}")
        return (
            f"{MISFITS}: its residuals speak for picks of {shown_px:g} px, "
            f"{ratio:.1f} times {of} (chance below {SIGNIFICANCE:g})"
        )
    return far_text(joint) or (frames_text(reading) if picks.clicks is not None else "")


def frames_text(reading: JobReadingSigma) -> str:
    """Say that most frames of a tracked flight misfit by themselves; or nothing.

    The places of a tracked landmark agree from frame to frame, whatever is wrong with the clock
    or the lens: what the frames leave is then small, and larger than in any frame by chance.
    """
    tested = np.isfinite(reading.chance)
    odd = reading.chance[tested] < SIGNIFICANCE
    if not len(odd) or odd.mean() <= MOST_FRAMES:
        return ""
    return (
        f"{MISFITS}: {odd.sum()} of {len(odd)} frames have residuals with a chance below "
        f"{SIGNIFICANCE:g}"
    )


def far_text(joint: JointSolution) -> str:
    """Say that what was solved for comes out far from what is stated of it; or nothing.

    The picks may then fit each other, whatever is wrong.
    """
    times = times_as_far(joint)
    if not times:
        return ""
    moved_m = np.linalg.norm(joint.moved_m, axis=1)
    away_m = float(np.median(moved_m[np.isfinite(moved_m)]))
    return (
        f"{MISFITS}: positions, landmarks and parameters come out {times:.0f} times as far from "
        f"what is stated as their standard deviations explain, the camera by {size_text(away_m)} m"
    )


def many_blunders_text(count: int, picks: int) -> str:
    """Say that so many picks do not fit the others that no solution with the rest is believed."""
    return (
        f"{MISFITS}: {count} of its {picks} picks do not fit the others of their frames, "
        "and nothing says that the others are right"
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
    """Say that the stated sigma of the picks is larger than they show; or nothing."""
    if reading.source != "stated":
        return ""
    ratio, chance = size_of_residuals(joint, np.ones(joint.model.frames, bool))
    if ratio * REJECTED < 1.0 and chance > 1.0 - SIGNIFICANCE:
        return (
            f"sigma_px = {reading.sigma:g} is stated larger than the picks show: residuals are "
            f"{ratio:.2f} times what is stated"
        )
    return ""


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
    priors = every_prior(flight)
    used = None if left_out is None else ~left_out
    first = solve_jointly(flight, priors, used)
    if first.passes >= PASSES:  # away from the least cost nothing is likelier than another
        return ""
    model = first.model
    known = np.isfinite(model.common_sigma).tolist()
    there = {"reading", *(c for c, one in zip(model.component, known, strict=True) if one)}
    there |= {"position"} if priors.fixes is not None and not priors.fixes.exact else set()
    found = {name: size_spoken_for(first, name) for name in SIZES if name in there}
    best = max(gain for _, gain in found.values())
    alike = [name for name, (_, gain) in found.items() if gain > best - ALIKE]
    if not best > LEAST_GAIN or alike == ["reading"]:
        return ""
    times = {name: size_text(found[name][0]) for name in alike}
    parts = [f"{SIZES[name]} {times[name]} times as uncertain as stated" for name in alike]
    return f"the picks speak for {' or '.join(parts)}{_metres(first, alike, found)}"


def _metres(joint: JointSolution, alike: list[str], found: dict[str, tuple[float, float]]) -> str:
    """Say the size in metres of positions or landmarks, where they alone are spoken for."""
    priors, key = joint.model.priors, "sigma_m"
    if alike == ["position"] and priors.fixes is not None:
        own = priors.fixes.of_positions_m
    elif alike == ["position"]:
        place = [priors.parameter.get(name, np.inf) for name in SHIFT]
        own = np.array([[one for one in place if np.isfinite(one)]])
        key = "sigma_m" if joint.model.flight.path.stands else "sigma_bias_m"
    elif alike == ["landmark"] and priors.landmark_m is not None:
        own = priors.landmark_m[joint.model.free]
    else:
        return ""
    stated_m = float(np.median(own))
    spoken_m = stated_m * found[alike[0]][0]
    return f": for {size_text(spoken_m)} m where {size_text(stated_m)} m is stated ({key})"


def size_spoken_for(first: JointSolution, component: str) -> tuple[float, float]:
    """Estimate by which factor the errors of a component are larger than stated.

    By restricted maximum likelihood: the errors found, squared in stated sigmas, are as many as
    the picks say of them. "reading" is the picks' own.

    Returns:
        The factor, and the gain in twice the log likelihood.
    """
    flight, priors, used = first.model.flight, first.model.priors, first.solved.used
    solution, factor, settles = first, 1.0, first.settles
    for _ in range(SIZE_ROUNDS):
        squares, left = _squares(solution, component)
        step = float(np.clip(np.sqrt(squares / left), 0.3, 3.0)) if left > 0.0 else 1.0
        factor *= step
        scaled, own = priors.scaled(component, factor), flight
        if component == "reading":
            own = replace(flight, picks=flight.picks.with_sigma(flight.picks.one_sigma_px * factor))
        start = solution.state if solution.passes else None
        solution = solve_jointly(own, scaled, used, start=start)
        if not (settles or solution.settles):  # nor will it with a third size
            return factor, 0.0
        settles = solution.settles
        if abs(np.log(step)) < SIZE_SETTLED:
            break
    return factor, log_likelihood(solution) - log_likelihood(first)


def _squares(solution: JointSolution, component: str) -> tuple[float, float]:
    """Add up squares of the errors of a component, and count their degrees of freedom."""
    if component == "reading":
        return float((solution.normal.residual**2).sum()), residual_freedom(solution)[0]
    return squares_of_errors(solution).get(component, (0.0, 0.0))


def log_likelihood(solution: JointSolution) -> float:
    """Evaluate twice the restricted log likelihood, but for a constant of the flight."""
    model = solution.model
    stated = np.isfinite(model.common_sigma)
    logs = np.log(model.common_sigma[stated]).sum() + np.log(model.fix_sigma_m).sum()
    readings = -4.0 * np.log(model.scale).sum()
    cost = solution.normal.cost + solution.factored.log_determinant
    return -float(cost + 2.0 * logs + readings)


MATCHED = 2.0  # times what a tracked file states: its sigma of a match is an estimate


def stated_sigma_px(flight: Flight) -> float | None:
    """Look up the standard deviation that picks should have; None where nothing states it."""
    picks = flight.picks
    if picks.clicks is not None:
        return MATCHED * picks.one_sigma_px
    return picks.one_sigma_px if picks.stated else None


class Doubts(NamedTuple):
    """Warnings of a whole flight."""

    findings: list[Finding]
    misfits: bool  # or its video is stabilised
    explained: bool  # by an error that is no single landmark's

    @property
    def sentence(self) -> str:
        """Say in one sentence that the flight misfits, and by what; empty: it does not."""
        if not self.misfits:
            return ""
        texts = [one.message for one in self.findings]
        causes = [one for one in texts if not one.startswith(MISFITS)]
        return f"{MISFITS}: {causes[0]}" if causes else texts[0]


def flight_findings(
    flight: Flight,
    estimates: FlightEstimates,
    left_out: Bools,
    wrong: Bools,
    usual: Callable[[bool, bool], list[str]] = lambda *_: [],
    blunders: Bools | None = None,
) -> Doubts:
    """Warn of a flight that misfits, and name errors of its inputs that explain it.

    Args:
        flight: as it was read
        estimates: its solution, with the reading sigma in force
        left_out: picks that take no part in it, as they are named, (P,)
        wrong: landmarks that are named, which are not named again, (N,)
        usual: names mistakes that take another reading of the files, if the flight misfits; is
            given whether an error is named already, and whether exchanges have been tried
        blunders: picks that do not fit the others of their frames, (P,); None: none
    """
    joint, reading = estimates.joint, estimates.reading
    if joint is None or reading is None:
        return Doubts([], False, False)
    flight, joint = with_places(flight, joint)
    stated, misfit = stated_sigma_px(flight), ""
    if flight.options.may_misfit:
        misfit = misfit_text(joint, reading, stated)
        if blunders is not None and blunders.mean() > MOST_BLUNDERS:
            misfit = misfit or many_blunders_text(int(blunders.sum()), len(blunders))
    texts = [misfit, too_wide_text(joint, reading)]
    try:
        causes, explained = _explanations(
            flight, joint, reading, left_out, wrong, usual, bool(misfit)
        )
    except (VopdError, np.linalg.LinAlgError):  # the angles stand without
        causes, explained = [UNTRIED] * bool(misfit), False
    findings = [
        Finding(text, flight.source, severity="warning") for text in [*texts, *causes] if text
    ]
    shifted = any(one.startswith(SHIFTED) for one in causes)
    return Doubts(findings, bool(misfit) or shifted, explained)


def with_places(flight: Flight, joint: JointSolution) -> tuple[Flight, JointSolution]:
    """Count positions and landmarks that are held as uncertain as they are stated.

    Errors within what is stated of them are no misfit, whether they are solved for or not.

    Args:
        flight: as it was read
        joint: its solution

    Returns:
        The flight and its solution with them; as they are where nothing is held, or where the
        flight has no such solution, as with a landmark far from its place.
    """
    own, read = (with_places_solved_for(one) for one in (joint.model.flight, flight))
    if own is None or read is None:
        return flight, joint
    try:
        found = solve_jointly(own, priors_of(own), joint.model.used, first=joint.solved)
    except (VopdError, np.linalg.LinAlgError):
        return flight, joint
    return (read, found) if found.settles else (flight, joint)


def _explanations(
    flight: Flight,
    joint: JointSolution,
    reading: JobReadingSigma,
    left_out: Bools,
    wrong: Bools,
    usual: Callable[[bool, bool], list[str]],
    misfit: bool,
) -> tuple[list[str], bool]:
    """Name errors of a flight's inputs that explain its residuals.

    Returns:
        The sentences, and whether an error is named that is no single landmark's.

    Raises:
        VopdError: if the flight has no solution with one of them
    """
    stated = stated_sigma_px(flight)
    causes, exchanged = list[str](), False
    own = False  # whether it is a landmark's or a pick's own error
    exact = not joint.passes
    joint = of_sampled(joint)
    if flight.picks.clicks is not None:
        from vopd.flight.misfits.stabilised import shifts_text  # of few flights

        if shifts := shifts_text(joint):
            return [shifts], True
    expected_px = USUAL_PX if stated is None else stated
    if misfit:
        from vopd.flight.misfits.mistakes import exchanges  # of few flights

        tried = exchanges(flight, expected_px)
        causes, exchanged = tried or [], tried is not None
    if not causes:
        without_px = expected_px if misfit and reading.source not in KNOWN else None
        if misfit:
            joint = with_stated_exact(joint, expected_px)
        found = significant_errors(joint, reading.source in KNOWN, without_px)
        again = ""
        if misfit and flight.picks.clicks is not None:
            found, again = _rather_by_clicks(flight, found)
        marks = [one.error.landmark for one in found]
        own = max(marks, default=-1 if not wrong.any() else 0) >= 0
        if found and not np.append(wrong, False)[marks].any():
            causes = [named_text(found) + again]
        if misfit:  # units and clocks explain all residuals, which one landmark may seem to
            whole = bool(causes) and min(one.rest for one in found) < REJECTED**2
            more = usual(own or whole, exchanged)
            if more and not (causes and UNEXPLAINED in more[0]):
                causes, own = more, False
    left = [one for one in causes if UNEXPLAINED not in one]
    if misfit and not left and not own and stated is not None and not exact:
        some = sampled(flight)
        causes = [sizes_text(some.flight, left_out[some.picks]) or "".join(causes)]
    own |= any(OF_LANDMARK in one for one in left)
    explained = any(words in one for one in left for words in (SPEAK_FOR, TYPICAL))
    return causes, explained and not own


def _rather_by_clicks(flight: Flight, found: list[Significant]) -> tuple[list[Significant], str]:
    """Take the errors that the clicks alone speak for where they are others.

    Places that were tracked with a wrong clock, lens or position are off by themselves, and seem
    to speak for another error.

    Args:
        flight: of clicks and tracks, which misfits
        found: what all picks together speak for

    Returns:
        The errors, and what to do beyond mending them.
    """
    from vopd.flight.misfits.click_tests import solve_clicks_alone  # of few flights

    alone = significant_errors(solve_clicks_alone(flight), True)
    named = {one.error.parameters for one in found}
    if not alone or alone[0].error.landmark >= 0 or alone[0].rest >= REJECTED**2:
        return found, ""
    if named & {one.error.parameters for one in alone}:
        return found, ""
    return alone, ", by the clicks alone: the others were tracked with it, run vopd track again"
