"""Errors of a flight's inputs: which are solved for, and how they move its rotations.

Errors of positions and landmarks are solved for under the standard deviations that are stated,
and what is left of them is in the solution's covariance. Those of the lens, the clock and the
refraction are not, unless `[solve] free` names them: one standard deviation of each is propagated.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.sigmas import Sigmas
from vopd.estimate import COMMON_PART
from vopd.findings import VopdError
from vopd.flight.flight import CameraPath, Flight, TrackFixes
from vopd.flight.solve.equations import COMPONENT, LEAST_SIGMA_M, SHIFT, Priors
from vopd.flight.solve.free import free_parameters, prior_sigma
from vopd.flight.solve.joint import (
    NO_PARAMETERS,
    JointSolution,
    covariance_of_sums,
    propagated,
    right_of_sums,
)


def priors_of(flight: Flight) -> Priors:
    """Collect the unknowns of a flight besides its rotations, as its files state them."""
    free = {name: prior_sigma(flight, name) for name in free_parameters(flight)}
    free |= {name: max(free[name], LEAST_SIGMA_M) for name in SHIFT if name in free}
    clicks = flight.picks.clicks
    click_px = None if clicks is None else clicks.sigma_px
    if not flight.options.solve_position:
        return Priors(parameter=free, click_px=click_px)
    path, landmark_m = flight.path, flight.landmarks.sigma_m
    place = np.maximum(path.bias_sigma_m, LEAST_SIGMA_M) if path.bias_sigma_m.any() else ()
    return Priors(
        path.fixes,
        landmark_m if landmark_m.any() else None,
        {**free, **dict(zip(SHIFT, place, strict=False))},
        click_px,
    )


def with_places_solved_for(flight: Flight) -> Flight | None:
    """Solve for the positions and landmarks that a flight holds; None where it holds no errors."""
    path, options = flight.path, flight.options
    fixes_err = path.fixes is not None and not path.fixes.exact
    uncertain = fixes_err or path.bias_sigma_m.any() or flight.landmarks.sigma_m.any()
    if options.solve_position or options.held is not None or not uncertain:
        return None
    return replace(flight, options=replace(options, solve_position=True))


def every_prior(flight: Flight) -> Priors:
    """Collect the unknowns of a solve, and the parameters that are stated and not solved for."""
    priors = priors_of(flight)
    stated = {name: one for name, one in flight.options.parameter_sigma.items() if one > 0.0}
    return replace(priors, parameter={**stated, **priors.parameter})


SOLVED_WITH = ("landmark", "position", "focal_length", "time_s")
"""The fields of `Sigmas` besides `reading` with which a flight is solved."""


def with_sigmas(flight: Flight, sigmas: Sigmas) -> Flight:
    """Replace standard deviations of a flight by those that the user gives.

    Args:
        flight: the flight
        sigmas: the user's; 0 leaves what was given before, or what the project states, and None
            of the readings. No picture of a flight has fiducials

    Returns:
        The flight itself where none of them is another.
    """
    path, marks, options = flight.path, flight.landmarks, flight.options
    if sigmas.reading == 0.0:
        raise VopdError(
            f"{flight.source}: reading sigma: no pick is exact: give pixels, as 0.5 of a click, or "
            "leave it out"
        )
    before, given = options.given, {name: one for name, one in vars(sigmas).items() if one}
    options = replace(options, given=replace(before, **given | {"fiducial": None}))
    if not is_solved_again(before, options.given):
        return flight if options.given == before else replace(flight, options=options)
    if options.held is not None:
        raise VopdError(
            f"{flight.source}: standard deviations in the place of stated ones are for the project "
            f"that was adjusted: what {options.held.file} names is held, with its own covariance"
        )
    if sigmas.landmark > 0.0:
        marks = replace(marks, sigma_m=np.full_like(marks.sigma_m, sigmas.landmark))
    if sigmas.position > 0.0:
        path = _with_position_sigma(path, sigmas.position)
    common = dict(options.parameter_sigma)
    common |= {"focal": sigmas.focal_length} if sigmas.focal_length > 0.0 else {}
    common |= {"clock": sigmas.time_s} if sigmas.time_s > 0.0 else {}
    options = replace(options, parameter_sigma=common)
    picks = flight.picks
    if sigmas.reading:
        picks = picks.with_sigma(sigmas.reading)
    return replace(flight, path=path, landmarks=marks, options=options, picks=picks)


def is_solved_again(before: Sigmas, given: Sigmas) -> bool:
    """Tell whether a flight is solved with others of the standard deviations that a user gives."""
    names = ("reading", *SOLVED_WITH)
    return any(getattr(before, name) != getattr(given, name) for name in names)


def _with_position_sigma(path: CameraPath, sigma_m: float) -> CameraPath:
    """State the standard deviation of a standing camera's place, or of all fixes of a track."""
    frames, fixes = len(path.position_m), path.fixes
    if path.stands:
        return replace(path, bias_sigma_m=np.full(3, sigma_m))
    if fixes is None:
        fixes = TrackFixes(np.arange(frames), np.ones((frames, 1)), np.zeros((frames, 3)))
    own_m = np.full_like(fixes.sigma_m, sigma_m)
    if fixes.between is not None:
        own_m[fixes.between] = fixes.sigma_m[fixes.between]
    return replace(path, fixes=replace(fixes, sigma_m=own_m))


def stated_components(solution: JointSolution) -> dict[str, Bools]:
    """Mark which of the errors that are stated and not solved for are of each component, (C,)."""
    component = np.array([COMPONENT[name] for name in solution.stated[0]])
    return {name: component == name for name in dict.fromkeys(component.tolist())}


def places_by_stated(solution: JointSolution) -> Floats:
    """Estimate the covariances of the solved places by errors that are stated and not solved for.

    A clock moves the cameras besides, as it does where it is solved for.

    Returns:
        East, north, up of every frame, m^2, (F, 3, 3).
    """
    model, sigma, (_, fix, common) = solution.model, solution.stated[0], solution.by_stated
    place = model.place_by_common(np.arange(model.frames)) @ common
    if solution.normal.fixes is not None:
        place = place + solution.normal.fixes.at_frames(fix)
    for column, (name, one) in enumerate(sigma.items()):
        if name in ("clock", "clock_rate"):
            since_s = model.since_s[:, None] if name == "clock_rate" else 1.0
            place[:, :, column] += model.velocity_m_s * since_s * one
    found = np.asarray(place @ place.swapaxes(1, 2))
    if solution.holds_places and solution.normal.size:
        found = found + solution.by_held_places.of_frames[1]
    return found


class HeldEffects(NamedTuple):
    """What the errors of held parameters do in F frames: C columns of one standard deviation."""

    turn: Floats  # (F, 3, C) about the camera's axes, radians
    place: Floats  # (F, 3, C) east, north, up, m
    late_s: Floats  # (F, C) of the frames' times
    component: dict[str, slice]  # the columns of each
    parameter: dict[str, Floats]  # (C,) of each that is solved for or held, by its name
    change: Floats  # (P, 2, C) of the computed images, in standard deviations of the picks


ADJUSTED = "adjusted"
"""The component of errors of held parameters, but for those by the picks that they came from."""


def held_effects(solution: JointSolution) -> HeldEffects | None:
    """Propagate the errors of held parameters; None where none is held.

    With their errors c the turns are u + du/dc c: their covariance is the one with c known and
    du/dc Cov(c, c) (du/dc)', which is that of the solve in which c was found by the same picks.
    """
    model, held = solution.model, solution.model.flight.options.held
    if held is None:
        return None
    own_m = np.zeros((len(model.flight.landmarks.name), 3))
    own_m[held.landmark] = 1.0
    parameter = {**model.priors.parameter, **dict.fromkeys(held.parameter, 1.0)}
    full = model.with_priors(replace(model.priors, parameter=parameter, landmark_m=own_m))
    first, count, causes = len(model.names), len(held.parameter), held.root.shape[1]
    start = np.concatenate([solution.state.parameter, np.zeros(count)])
    by_mark = np.zeros((len(own_m), 3, causes))
    by_mark[held.landmark] = held.root[count:].reshape(len(held.landmark), 3, causes)
    change = np.zeros((len(model.pick), 2, causes))
    for rows in full.rows(solution.state._replace(parameter=start)):
        own = rows.by_parameter[..., first:] @ held.root[:count]
        if len(held.landmark):
            own = own + rows.by_landmark @ by_mark[model.landmark[rows.picks]]
        change[rows.picks] = own
    turn, fix, moved = propagated(solution, change)
    by_common = full.place_by_common(np.arange(model.frames))
    place = by_common[:, :, first : first + count] @ held.root[:count]
    if solution.normal.fixes is not None:
        place = place + solution.normal.fixes.at_frames(fix)
    late_s = model.late_by(held.parameter) @ held.root[:count]
    late_s += model.late_by(model.names) @ moved[: len(model.names)]
    component = {"reading": slice(held.by_picks), ADJUSTED: slice(held.by_picks, None)}
    each = np.concatenate([moved[: len(model.names)], held.root[:count]])
    by_name = dict(zip((*model.names, *held.parameter), each, strict=True))
    return HeldEffects(turn, place, late_s, component, by_name, change)


def turns_by_errors(solution: JointSolution, held: HeldEffects | None = None) -> dict[str, Floats]:
    """Estimate how errors of one standard deviation turn the cameras, by component.

    Returns:
        Turns about the camera's axes, radians, and errors of the frames' times, seconds,
        (F, 4, C); those of errors that are common to the frames have `COMMON_PART` in their
        names.
    """
    model, sigma = solution.model, solution.stated[0]
    found = {name: _roots(one) for name, one in solution.covariance.component.items()}
    if solution.holds_places and solution.normal.size:
        turn_by, _ = solution.by_held_places.of_frames
        found |= {name: _roots(one) for name, one in turn_by.items()}
    own_s = model.late_by([*sigma]) * np.array([*sigma.values()])
    turn, _, common = solution.by_stated
    late_s = model.late_by(model.names) @ common[: len(model.names)] + own_s
    for name, own in stated_components(solution).items():
        part = name + COMMON_PART
        solved_for = [found[part]] if part in found else []
        moved = _with_late(turn[..., own], late_s[:, own])
        found[part] = np.concatenate([*solved_for, moved], axis=2)
    if held is not None:
        every = _with_late(held.turn, held.late_s)
        found |= {name + COMMON_PART: every[..., own] for name, own in held.component.items()}
    return found


def _with_late(turn: Floats, late_s: Floats) -> Floats:
    """Join turns (F, 3, C) and errors of times (F, C) to (F, 4, C)."""
    return np.concatenate([turn, late_s[:, None]], axis=1)


def covariance_of_common(solution: JointSolution) -> Floats:
    """Estimate the covariance of what is common to the flight, (K, K).

    That of the joint solution, and what errors that are stated and not solved for add to it.
    """
    moved = solution.by_stated[2]
    found = solution.factored.common + moved @ moved.T
    if solution.holds_places and len(found):
        found = found + solution.by_held_places.of_common
    return np.asarray(found)


def errors_of_sums(
    solution: JointSolution,
    weight: Floats,
    held: HeldEffects | None = None,
    by_parameter: Mapping[str, Floats] = NO_PARAMETERS,
) -> dict[str, Floats]:
    """Estimate the covariances of k sums over frames, by component, radians squared, (k, k).

    Args:
        solution: of the flight
        weight: what a turn of each frame about the camera's axes adds to the sums, (F, 3, k)
        held: effects of held parameters
        by_parameter: what parameters, by their names, add to the sums besides, (k,) each
    """
    found: dict[str, Floats] = {}
    parts = covariance_of_sums(solution, weight, by_parameter)[1]
    if solution.holds_places:
        right = right_of_sums(solution, weight, by_parameter)
        parts |= solution.by_held_places.of_sums(right)
    for part, own in parts.items():
        name = part.removesuffix(COMMON_PART)
        found[name] = found.get(name, 0.0) + own
    (turn, _, common), sigma = solution.by_stated, solution.stated[0]
    names = solution.model.names
    each = np.concatenate([common[: len(names)], np.diag([*sigma.values()])])
    stated = dict(zip((*names, *sigma), each, strict=True))
    effects: list[tuple[Mapping[str, Bools | slice], Floats, dict[str, Floats]]]
    effects = [(stated_components(solution), turn, stated)]
    if held is not None:
        effects.append((held.component, held.turn, held.parameter))
    for component, turns, parameter in effects:
        moved = np.einsum("fik,fic->kc", weight, turns)
        for name in {*parameter} & {*by_parameter}:
            moved += np.outer(by_parameter[name], parameter[name])
        for name, columns in component.items():
            found[name] = found.get(name, 0.0) + moved[:, columns] @ moved[:, columns].T
    return found


def _roots(covariances: Floats) -> Floats:
    """Take symmetric roots of covariances (F, 4, 4); NaN where there is none."""
    out = np.full_like(covariances, np.nan)
    known = np.isfinite(covariances).all(axis=(1, 2))
    unit = np.sqrt(np.diagonal(covariances[known], axis1=1, axis2=2).clip(0.0))
    unit[:, :3] = 1.0  # of radians and seconds only the time is scaled, against rounding
    unit = np.where(unit > 0.0, unit, 1.0)[..., None]
    size = np.sqrt(np.trace(covariances[known, :3, :3], axis1=1, axis2=2).clip(0.0) / 3.0)
    unit[:, 3, 0] /= np.where(size > 0.0, size, 1.0)
    sizes, axes = np.linalg.eigh(covariances[known] / unit / unit.swapaxes(1, 2))
    out[known] = unit * axes * np.sqrt(np.maximum(sizes, 0.0))[:, None]
    return out
