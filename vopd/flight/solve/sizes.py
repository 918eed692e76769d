"""Degrees of freedom of a joint solution: of its residuals, and of a reading sigma from them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import chdtrc

from vopd.arrays import Array, Bools, Floats
from vopd.flight.solve.joint import DERIVATIVE, JointSolution
from vopd.flight.solve.normal import Factored

if TYPE_CHECKING:
    from vopd.flight.solve.clicks import ClickEquations


def explained(solution: JointSolution) -> dict[str, float]:
    """Count what the picks say of the errors of each component: the sum of 1 - after / before."""
    model, factored = solution.model, solution.factored
    parts = 1.0 - np.diag(factored.common) / model.common_sigma**2
    found: dict[str, float] = {}
    for name, part in zip(model.component, parts.tolist(), strict=True):
        found[name] = found.get(name, 0.0) + part
    if model.priors.fixes is not None:
        part = float((1.0 - fix_variances(factored) / model.fix_sigma_m**2).sum())
        found["position"] = found.get("position", 0.0) + part
    return found


def squares_of_errors(solution: JointSolution) -> dict[str, tuple[float, float]]:
    """Add up squares of the errors of each component, in stated standard deviations.

    Returns:
        By component, the squares, and how many there are in the mean: what the picks say of
        them, but for errors that are free.
    """
    model, state = solution.model, solution.state
    common, told = model.common_of(state), explained(solution)
    found: dict[str, tuple[float, float]] = {}
    for component in dict.fromkeys((*model.component, *told)):
        own = [one == component for one in model.component]
        squares = float(((common / model.common_sigma)[own] ** 2).sum())
        free = int((~np.isfinite(model.common_sigma))[own].sum())
        if component == "position":
            squares += float(((state.fix_m / model.fix_sigma_m) ** 2).sum())
        found[component] = squares, told.get(component, 0.0) - free
    return found


def fix_variances(factored: Factored) -> Array:
    """Calculate variances of the fixes' errors after the solve (J, 3)."""
    return np.asarray(np.einsum("jii->ji", fix_covariances(factored)))


def fix_covariances(factored: Factored) -> Array:
    """Calculate covariances of each fix's errors after the solve, east, north, up, (J, 3, 3)."""
    assert factored.chain is not None and factored.fixes is not None
    diagonal, _ = factored.chain.selected_inverse()
    together = factored.fixes.together
    blocks = diagonal.reshape(-1, together, 3, together, 3)
    own = np.einsum("bkikj->bkij", blocks).reshape(-1, 3, 3)
    through = (factored.back @ factored.common) @ factored.back.swapaxes(1, 2)
    return np.asarray((own + through)[: len(factored.model.fix_sigma_m)])


def residual_freedom(solution: JointSolution) -> tuple[float, float]:
    """Count the degrees of freedom that the picks keep, and those if all priors were exact."""
    model = solution.model
    exact = 2.0 * len(model.pick) - 3.0 * model.solved
    spent = sum(explained(solution).values())
    if model.clicks is not None:  # readings of one pick have said that by their differences
        own = model.of_clicks
        spent -= float((solution.factored.common[own, own] * model.clicks.normal).sum())
    return exact - spent, exact


def sigma_freedom(solution: JointSolution) -> float:
    """Count the degrees of freedom of a reading sigma that is estimated from a solution.

    Twice the square of the variance over the variance of its estimate: the trace of (W R)^2,
    R the covariance of the readings, W the marginal weights less what the turns fit. With the
    covariance M after the solve and the prior P it is 2N - 3F - q + trace (P^-1 M)^2, q errors,
    and that trace the derivative of P^-1 M by a factor of P.
    """
    model, scale = solution.model, 1.0 + 1j * DERIVATIVE
    if not solution.passes:
        return 2.0 * len(model.pick) - 3.0 * model.solved
    varied = Factored(solution.normal, fix_scale=scale, common_scale=scale)
    total = (np.diag(varied.common) / model.common_sigma**2).sum()
    if model.priors.fixes is not None:
        total = total + (fix_variances(varied) / model.fix_sigma_m**2).sum()
    errors = np.isfinite(model.common_sigma).sum() + model.fix_sigma_m.size
    free = (~np.isfinite(model.common_sigma)).sum()
    exact = 2.0 * len(model.pick) - 3.0 * model.solved - free
    return float(exact - errors - total.imag / DERIVATIVE)


def lasting(solution: JointSolution) -> float:
    """Estimate how much of the residuals lasts from frame to frame, 1 or more.

    The variance of their means over short runs of frames, a landmark by itself, is as many times
    that of as many independent ones (batch means). What is common to the frames is known as much
    less well.
    """
    model, residual = solution.model, solution.normal.residual
    run = model.flight.picks.frame[model.pick] // max(int(np.sqrt(model.frames)), 1)
    _, own, count = np.unique(
        np.stack([model.landmark, run]), axis=1, return_inverse=True, return_counts=True
    )
    total = np.zeros((len(count), 2))
    np.add.at(total, own, residual)
    square = float((residual**2).sum()) / max(len(residual), 1)
    return max(float(((total**2).sum(axis=1) / count).mean()) / square, 1.0) if square else 1.0


def cost_of_frames(solution: JointSolution) -> Floats:
    """Share the cost of a joint solution among its frames, (F,).

    The squares of errors over their prior standard deviations are shared evenly by the picks that
    depend on them: those of a landmark by its own, those of parameters by all. What several
    readings of one pick differ by from each other is no frame's.
    """
    model, state = solution.model, solution.state
    landmark = np.zeros(len(model.flight.landmarks.name))
    error_m = state.landmark_m[model.free].ravel()
    squares = (error_m / model.common_sigma[model.of_landmarks]) ** 2
    landmark[model.free] = squares.reshape(-1, 3).sum(axis=1)
    landmark /= np.maximum(np.bincount(model.landmark, minlength=len(landmark)), 1)
    parameters = float(((state.parameter / model.sigma) ** 2).sum())
    share = landmark[model.landmark] + parameters / max(len(model.pick), 1)
    if model.clicks is not None:
        share = share + _squares_of_clicks(solution, model.clicks)
    frame = model.flight.picks.frame[model.pick]
    return np.asarray(solution.normal.frame_cost + np.bincount(frame, share, model.frames))


def _squares_of_clicks(solution: JointSolution, clicks: ClickEquations) -> Floats:
    """Share the squares of the clicks' errors evenly by the picks that carry them, (P,)."""
    model, carried = solution.model, clicks.column < len(clicks.seen)
    error_px = solution.state.click_px[model.clicked]
    sigma_px = model.common_sigma[model.of_clicks].reshape(-1, 2)
    times = np.bincount(clicks.column[carried], minlength=len(error_px))
    each = ((error_px / sigma_px) ** 2).sum(axis=1) / np.maximum(times, 1)
    return np.asarray(np.append(each, 0.0)[clicks.column].sum(axis=1))


def size_of_residuals(solution: JointSolution, frames: Bools) -> tuple[float, float]:
    """Compare the residuals of some frames together with what is stated of all errors.

    The cost of the joint solution, of picks and priors, is chi-square with as many degrees of
    freedom as the picks have more coordinates than the frames have angles. Errors that are stated
    and not solved for take their part of it, as if they were.

    Args:
        solution: of the flight
        frames: those that count, (F,)

    Returns:
        The size of the residuals over that which is to be expected, and the chance of such large
        ones, or larger.
    """
    model = solution.model
    picks = np.bincount(model.flight.picks.frame[model.pick], minlength=model.frames)
    count = frames & (picks >= 2)
    free, held = float((~np.isfinite(model.common_sigma)).sum()), model.flight.options.held
    free += 0.0 if held is None else held.unknowns
    freedom = float((2.0 * picks - 3.0)[count].sum()) - free
    if not freedom > 0.0:
        return 1.0, 1.0
    cost = float(cost_of_frames(solution)[count].sum())
    if solution.settles:  # else the straight line of stated errors explains nearly anything
        cost = max(cost - _by_stated(solution, count), 0.0)
    return float(np.sqrt(cost / freedom)), float(chdtrc(freedom, cost))


def size_of_errors(solution: JointSolution) -> tuple[float, float]:
    """Compare the errors of positions, landmarks and parameters with what is stated of them.

    Their squares in standard deviations are as many, in the mean, as the picks say of them: few
    beside the residuals of thousands of frames, and little of `size_of_residuals` there.

    Args:
        solution: of the flight

    Returns:
        The size of the errors over that which is to be expected, and the chance of such large
        ones, or larger.
    """
    found = [one for name, one in squares_of_errors(solution).items() if name != "click"]
    squares, expected = (sum(parts) for parts in zip((0.0, 0.0), *found, strict=True))
    if not expected > 0.0:
        return 1.0, 1.0
    return float(np.sqrt(squares / expected)), float(chdtrc(expected, squares))


def _by_stated(solution: JointSolution, frames: Bools) -> float:
    """Find how much of the cost of some frames errors explain that are stated and not solved for.

    Args:
        solution: of the flight
        frames: those that count, (F,)
    """
    change, model, normal = solution.stated[1], solution.model, solution.normal
    if not change.size:
        return 0.0
    own = frames[model.flight.picks.frame[model.pick]]
    left = solution.unfollowed_stated
    square = np.einsum("pik,pil->kl", change[own], left[own])
    residual = normal.residual * normal.weight[:, None]
    right = np.einsum("pik,pi->k", change[own], residual[own])
    return float(right @ np.linalg.solve(np.eye(len(square)) + square, right))
