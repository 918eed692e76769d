"""Mistakes that explain a misfit: two labels exchanged, one wrong landmark, or another position.

Every pair of landmarks is exchanged, and every landmark left out, and the attitude is fitted
anew; with all landmarks it is fitted together with the position. What makes the residuals agree
with the standard deviations in force is named.
"""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import combinations
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.residuals import (
    SIGNIFICANCE,
    Pool,
    ResidualEquations,
    ResidualWeights,
    chance_of,
    equations_of,
)
from vopd.attitude.sigmas import ErrorComponent, SigmasInForce, given_components
from vopd.estimate import Estimate
from vopd.geometry.linear import pseudo_inverse
from vopd.geometry.rotation_fit import Sights, closest_axes, fit_rotations, turned
from vopd.geometry.rotations import ahead, camera_axes

PASSES = 12
PLAUSIBLE = SIGNIFICANCE  # the least chance of the residuals of a repair that is named
NEAR = 0.1  # repairs less likely than this, against the best, are not named
MOST_LANDMARKS = 24  # of a frame: of more only the worst are searched
MOST_IN_A_FRAME = 200  # landmarks: a frame with more is not searched
MOST_FRAMES = 1000  # of a job, some 4 ms each; of the others the flag says that they are not
FIRST_FRAMES = 20  # of a flight that misfits in most: if none is explained, no other is searched
MOST_NAMED = 3  # repairs of a frame
NOTHING = "neither an exchange of two labels nor one wrong landmark"
ELSEWHERE = "another position than stated"
IN_FRONT = "the solution with all landmarks in front of the camera"
NOT_SEARCHED = "not searched"
OF_THE_WHOLE = "the misfit of the whole flight"  # where nothing else explains one of most frames


class Repair(NamedTuple):
    """What would mend a frame, and the chance of residuals like those that then remain.

    With nothing to exchange or to leave out it is another position.
    """

    exchanged: tuple[int, ...]  # indices of two landmarks, or none
    without: int | None  # index of a landmark to leave out
    chance: float = 0.0
    in_front: bool = False  # all landmarks, by the attitude that fits best: nothing else is wrong


def trials(used: Bools, worst: Ints) -> tuple[list[Repair], Ints, Bools]:
    """List all exchanges of two landmarks, and all omissions of one that leave two or more.

    Args:
        used: the landmarks that take part, (L,)
        worst: indices of those to try, at most `MOST_LANDMARKS`

    Returns:
        T trials; the landmark that each image point is taken to be, and those used, (T, L) each.
    """
    swaps = list(combinations(worst.tolist(), 2)) if len(worst) > 2 else []
    drops = worst.tolist() if used.sum() > 2 else []
    count = len(swaps) + len(drops)
    label = np.tile(np.arange(len(used)), (count, 1))
    kept = np.tile(used, (count, 1))
    for k, (one, other) in enumerate(swaps):
        label[k, [one, other]] = other, one
    for k, one in enumerate(drops, len(swaps)):
        kept[k, one] = False
    repair = [Repair(pair, None) for pair in swaps] + [Repair((), one) for one in drops]
    return repair, label, kept


class FittedTrials(NamedTuple):
    """Trials of a frame with the camera axes that fit each of them best."""

    repair: list[Repair]  # T of them
    label: Ints  # (T, L) the landmark that each image point is taken to be
    sights: Sights
    axes: Floats  # (T, 3, 3)
    in_front: Bools  # (T,) every landmark that is used is in front of the camera


@np.errstate(all="ignore")
def repairs(
    estimate: Estimate, frame: int, components: list[ErrorComponent], pool: Pool
) -> list[Repair]:
    """Find the repairs of a frame, the likeliest first; empty if there is none."""
    equations = equations_of(estimate, components, np.array([frame]))
    if (in_front := _chance_in_front(estimate, frame, equations, pool)) >= PLAUSIBLE:
        return [Repair((), None, in_front, True)]
    weights = ResidualWeights(equations, pool.sigma)
    fitted = fitted_trials(estimate, frame, weights.of(equations.residual[..., None])[0, :, 0])
    if fitted is None:
        return []
    chance = chance_of(trial_equations(fitted, equations), pool)
    chance = np.where(fitted.in_front, chance, 0.0)
    found, chance = _with_position(fitted.repair, chance, equations, components, frame, pool)
    chance = np.where(np.isfinite(chance), chance, 0.0)
    good = np.flatnonzero(chance >= max(PLAUSIBLE, NEAR * chance.max()))
    order = good[np.argsort(-chance[good], kind="stable")]
    return [found[k]._replace(chance=float(chance[k])) for k in order]


@np.errstate(all="ignore")
def _chance_in_front(estimate: Estimate, frame: int, given: ResidualEquations, pool: Pool) -> float:
    """Find the chance of a frame solved with landmarks behind it, by the attitude that fits best.

    The solve of 1974 begins at the attitude before, and may end where the camera looks away.

    Returns:
        The chance; 0 if no landmark is behind the camera, or one is by that attitude, too.
    """
    used = estimate.used[frame] & np.isfinite(estimate.direction[frame]).all(axis=1)
    looks = camera_axes(np.radians(estimate.camera_deg[[frame]]))
    if not (used & (ahead(looks, estimate.direction[[frame]])[0] < 0.0)).any():
        return 0.0
    sights = _sights(estimate, frame, estimate.direction[frame][None], used[None])
    axes, _ = fit_rotations(sights, closest_axes(sights), PASSES)
    fitted = FittedTrials([], np.arange(len(used))[None], sights, axes, sights.in_front(axes))
    chance = float(chance_of(trial_equations(fitted, given), pool)[0])
    return chance if fitted.in_front[0] and np.isfinite(chance) else 0.0


def fitted_trials(estimate: Estimate, frame: int, weighted: Floats) -> FittedTrials | None:
    """Fit all trials of a frame's worst landmarks; None if there is none, or they are too many.

    Args:
        estimate: the job
        frame: index of the frame
        weighted: residuals by which landmarks are the worst, (2L,)
    """
    used = estimate.used[frame] & np.isfinite(estimate.direction[frame]).all(axis=1)
    size = np.where(used, np.hypot(*np.split(weighted, 2)), -1.0)
    worst = np.argsort(-size, kind="stable")[: min(int(used.sum()), MOST_LANDMARKS)]
    repair, label, kept = trials(used, np.sort(worst))
    if not repair or used.sum() > MOST_IN_A_FRAME:
        return None
    sights = _sights(estimate, frame, stated_directions(estimate, frame)[label], kept)
    axes, _ = fit_rotations(sights, closest_axes(sights), PASSES)
    return FittedTrials(repair, label, sights, axes, sights.in_front(axes))


def _sights(estimate: Estimate, frame: int, direction: Floats, used: Bools) -> Sights:
    """Take the image points of a frame for T trials, as landmarks in these directions."""
    by_ray = None
    if estimate.image_by_ray is not None:
        by_ray = np.broadcast_to(estimate.image_by_ray[frame], (*used.shape, 2, 3))
    image = np.broadcast_to(estimate.image[frame], (*used.shape, 2))
    return Sights(direction, image, used, estimate.focal_length, by_ray)


def stated_directions(estimate: Estimate, frame: int) -> Floats:
    """Turn the directions of a frame to those between the stated places, (L, 3).

    A mistake that is searched for has moved the places that were solved for.
    """
    direction = estimate.direction[frame]
    if estimate.test_residual is None:
        return np.asarray(direction)
    sights = _sights(estimate, frame, direction[None], estimate.used[frame][None])
    axes, _ = fit_rotations(sights, closest_axes(sights), PASSES)
    by_turns = np.stack(np.split(sights.equations(axes)[1][0], 2), axis=1)
    moved = np.stack(np.split(estimate.residual[frame] - estimate.test_residual[frame], 2), axis=1)
    turn = (pseudo_inverse(by_turns) @ moved[..., None])[..., 0]
    seen = turned(np.repeat(axes, len(turn), axis=0), turn) @ direction[..., None]
    return np.asarray((axes[0].T @ seen)[..., 0])


def trial_equations(fitted: FittedTrials, given: ResidualEquations) -> ResidualEquations:
    """Form the equations of all trials; errors of landmarks go with the landmark, others stay."""
    sights, label = fitted.sights, fitted.label
    residual, partials = sights.equations(fitted.axes)
    used = np.tile(sights.used, 2)
    both = np.hstack([label, label + label.shape[1]])
    return ResidualEquations(
        np.where(used, residual, 0.0),
        np.where(used[..., None], partials, 0.0),
        np.where(used, given.variance, 0.0),
        np.where(used[..., None], given.shared, 0.0),
        np.where(used[..., None], given.own[0][both], 0.0),
    )


def _with_position(
    found: list[Repair], chance: Floats, given: ResidualEquations,
    components: list[ErrorComponent], frame: int, pool: Pool,
) -> tuple[list[Repair], Floats]:  # fmt: skip
    """Add another position, where it has a standard deviation and the picks can judge it."""
    columns = next((one.residual[frame] for one in components if one.name == "position"), None)
    if columns is None:
        return found, chance
    free = replace(given, partials=np.concatenate([given.partials, columns[None]], axis=2))
    if free.freedom[0] < 1.0:
        return found, chance
    return [*found, Repair((), None)], np.append(chance, chance_of(free, pool))


def misfit_text(
    estimate: Estimate, scale: JobReadingSigma, sigmas: SigmasInForce, most: int = MOST_FRAMES
) -> list[str]:
    """Describe the repairs of frames that misfit, such as `exchange 3+7 (chance 0.42)`, (F,).

    Args:
        estimate: the job
        scale: its reading sigma, and which frames misfit
        sigmas: the standard deviations in force
        most: how many of these frames are searched
    """
    text = [""] * len(estimate.frame)
    misfits = np.flatnonzero(scale.misfit)
    whole = bool(estimate.about.doubt) and 2 * len(misfits) > len(text)
    for frame in misfits:
        text[frame] = OF_THE_WHOLE if whole else NOT_SEARCHED
    misfits = misfits[:most]
    misfits = misfits[estimate.used[misfits].sum(axis=1) <= MOST_IN_A_FRAME]
    if not len(misfits):
        return text
    components = given_components(estimate, sigmas)
    pool = Pool(scale.test_sigma, scale.freedom, None)

    def explained(frame: int) -> str:
        found, word = _exchanges(estimate, frame), " and "
        if not found:
            found, word = repairs(estimate, frame, components, pool)[:MOST_NAMED], " or "
        return word.join(_repair_text(estimate, frame, one) for one in found)

    named = np.zeros(0) if estimate.exchanged is None else estimate.exchanged
    first = misfits[:: len(misfits) // FIRST_FRAMES + 1].tolist()
    if whole and not named.any() and not any(map(explained, first)):
        return text
    for frame in misfits.tolist():
        text[frame] = explained(frame) or (OF_THE_WHOLE if whole else NOTHING)
    return text


def _exchanges(estimate: Estimate, frame: int) -> list[Repair]:
    """List the exchanges of labels that the source has found in a frame."""
    if estimate.exchanged is None:
        return []
    chance = estimate.exchanged[frame]
    found = []
    for one in np.unique(chance[chance != 0.0]).tolist():
        found.append(Repair(tuple(np.flatnonzero(chance == one).tolist()), None, one))
    return found


def _repair_text(estimate: Estimate, frame: int, repair: Repair) -> str:
    def name(index: int) -> str:
        return estimate.landmark_label(estimate.landmark[frame, index]).replace(";", ",")

    chance = f" (chance {repair_chance(repair.chance)})" if repair.chance >= 0.0 else ""
    if repair.without is not None:
        return f"without {name(repair.without)}{chance}"
    if repair.in_front:
        return IN_FRONT + chance
    if not repair.exchanged:
        return ELSEWHERE + chance
    return "exchange " + "+".join(name(index) for index in repair.exchanged) + chance


def repair_chance(chance: float) -> str:
    """Write the chance of what remains after a repair: `0.42`, `0.002`."""
    return f"{chance:.2f}" if chance >= 0.01 else f"{chance:.3f}"


def landmarks_of(text: str) -> list[str]:
    """List the landmarks that a frame's repair names; none where several are as likely.

    Args:
        text: of `misfit_text`
    """
    if " or " in text:
        return []
    parts = (re.fullmatch(REPAIR, one) for one in text.split(" and "))
    return [name for one in parts if one for name in one[1].split("+")]


REPAIR = r"(?:without|exchange) (.*?)(?: \(chance \d\.\d+\))?"
