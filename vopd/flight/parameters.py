"""Free parameters of a solved flight, before and after, and the residuals that they change."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from vopd.arrays import Floats
from vopd.attitude.table import BODY_AXES
from vopd.findings import size_text
from vopd.flight.estimate import FlightEstimates
from vopd.flight.settled import settled, with_named_picks
from vopd.flight.solve.errors import covariance_of_common
from vopd.flight.solve.free import (
    FREE,
    LANDMARK,
    UNIT,
    decimals,
    free_landmarks,
    prior_sigma,
    shown_name,
    stated_value,
    unit_factor,
)
from vopd.flight.solve.held import MOST_LEFT, trading
from vopd.flight.solve.joint import JointSolution
from vopd.scene import Adjusted, Change


@dataclass(frozen=True)
class Parameter:
    """A parameter that was to be free, in a table's units.

    Attributes:
        name: as a table has it: `focal`, `centre_u`, `landmark:NAME east`
        unit: of all numbers; empty: a number
        before: as stated
        after: as solved; as stated if it is not held
        sigma_before: prior standard deviation; infinite: none is stated
        sigma_after: standard deviation after the solve; the prior one if it is not held
        held: whether the picks hold it. A landmark has the value as solved in any case: its
            standard deviation before holds it
        trades_with: angles and parameters that make the same images
    """

    name: str
    unit: str
    before: float
    after: float
    sigma_before: float
    sigma_after: float
    held: bool
    trades_with: tuple[str, ...] = ()

    @property
    def moved(self) -> float:
        """The move in standard deviations: prior ones, or those after if none is stated."""
        known = np.isfinite(self.sigma_before) and self.sigma_before > 0.0
        sigma = self.sigma_before if known else self.sigma_after
        return (self.after - self.before) / sigma if sigma > 0.0 else float("nan")


def parameters_of(estimates: FlightEstimates) -> tuple[tuple[Parameter, ...], Floats]:
    """Tabulate the free parameters of a solved flight.

    Returns:
        The parameters, K of them, and their covariance, (K, K), as `Adjustment` has it.
    """
    joint = estimates.joint
    assert joint is not None
    flight, names = joint.model.flight, joint.model.names
    common = covariance_of_common(joint)
    kept = {one.name: one for one in flight.options.kept}
    wanted = [name for one, own in FREE.items() if one in flight.options.free for name in own]
    found, at, factors = [], [], []
    for name in wanted:
        factor, before = unit_factor(flight, name), stated_value(flight, name)
        prior = factor * prior_sigma(flight, name)
        unit, shown = UNIT.get(name, ""), shown_name(name)
        factors.append(factor)
        if name in kept or name not in names:
            trades = kept[name].trades_with if name in kept else ()
            found.append(Parameter(shown, unit, before, before, prior, prior, False, trades))
            at.append(-1)
            continue
        at.append(names.index(name))
        after = before + factor * float(joint.state.parameter[at[-1]])
        sigma = factor * float(np.sqrt(common[at[-1], at[-1]]))
        trades = trading(joint, name)
        found.append(Parameter(shown, unit, before, after, prior, sigma, True, trades))
    marks, marks_at = _landmarks(joint, common)
    found += marks
    factors += [1.0] * len(marks)
    covariance = _covariance(common, [*at, *marks_at], factors, found)
    vehicle = estimates.flight.vehicle
    if vehicle is not None and vehicle.turned_deg is not None:
        assert vehicle.covariance_deg2 is not None
        sigmas = np.sqrt(np.diag(vehicle.covariance_deg2)).tolist()
        prior = flight.mount_sigma_deg or float("inf")
        for axis, turn, sigma in zip(BODY_AXES, vehicle.turned_deg.tolist(), sigmas, strict=True):
            found.append(Parameter(f"mount {axis}", "deg", 0.0, turn, prior, sigma, held=True))
        apart = np.zeros((len(covariance), 3))
        covariance = np.block([[covariance, apart], [apart.T, vehicle.covariance_deg2]])
    return tuple(found), covariance


def _landmarks(joint: JointSolution, common: Floats) -> tuple[list[Parameter], list[int]]:
    """Tabulate the coordinates of landmarks, and where they are among what is common."""
    model, found, at = joint.model, [], []
    flight, free = model.flight, model.free.tolist()
    for k in free_landmarks(flight):
        if k not in free:
            continue
        for axis, name in enumerate(("east", "north", "up")):
            where = len(model.names) + 3 * free.index(k) + axis
            prior = float(flight.landmarks.sigma_m[k, axis])
            if not prior > 0.0:
                continue
            sigma = float(np.sqrt(common[where, where]))
            shown = f"{LANDMARK}{flight.landmarks.name[k]} {name}"
            moved, held = float(joint.state.landmark_m[k, axis]), sigma <= MOST_LEFT * prior
            found.append(Parameter(shown, "m", 0.0, moved, prior, sigma, held))
            at.append(where)
    return found, at


def _covariance(
    common: Floats, at: list[int], factors: list[float], found: list[Parameter]
) -> Floats:
    """Take the covariance of the table's parameters from that of all that is common, (K, K)."""
    index, scale = np.array(at, dtype=np.int64), np.array(factors)
    known = index >= 0
    out = np.zeros((len(index), len(index)))
    own = common[np.ix_(index[known], index[known])]
    out[np.ix_(known, known)] = own * scale[known] * scale[known, None]
    for k in np.flatnonzero(~known):
        prior = found[k].sigma_before
        out[k, k] = prior**2 if np.isfinite(prior) else np.nan
    return out


NOT_STATED = "none"


def text_row(one: Parameter) -> list[str]:
    """Write the cells of a row, by `COLUMNS`."""
    digits = decimals(one.sigma_after)
    before, after = (f"{value:.{digits}f}" if digits is not None else f"{value:.7g}"
                     for value in (one.before, one.after))  # fmt: skip
    sigmas = [
        size_text(sigma) if isfinite(sigma) else NOT_STATED
        for sigma in (one.sigma_before, one.sigma_after)
    ]
    kept = not one.held and one.after == one.before
    moved = f"{one.moved:+.1f}" if isfinite(one.moved) and not kept else "-"
    held = "held" if one.held else "not held" + ": kept" * kept
    return [
        one.name, one.unit or "-", before, after, *sigmas, moved, held,
        ", ".join(one.trades_with) or "-",
    ]  # fmt: skip


# Parameters and residuals before and after, for a figure


def before_and_after(estimates: FlightEstimates) -> Adjusted:
    """List the free parameters and the sizes of residuals before and after, for a figure.

    Args:
        estimates: of a flight that is solved with free parameters; it is solved as stated, too
    """
    parameters, _ = parameters_of(estimates)
    names = estimates.flight.landmarks.name
    return changes(parameters), names, residual_sizes(estimates, parameters)


def changes(parameters: Iterable[Parameter]) -> list[Change]:
    """List parameters before and after, in the standard deviations that were stated.

    Args:
        parameters: of one without a stated sigma, in that after the solve
    """
    found = []
    for one in parameters:
        _, _, before, after, _, sigma, _, held, trades = text_row(one)
        unit = one.unit and f" {one.unit}"
        told = f"{before} → {after} ± {sigma}{unit}"
        if held.endswith("kept"):
            told = f"{before}{unit}" + f", trades with {trades}" * (trades != "-")
        stated = isfinite(one.sigma_before) and one.sigma_before > 0.0
        unit_sigma = one.sigma_before if stated else one.sigma_after
        moved = float("nan") if held.endswith("kept") else one.moved
        name = one.name.removeprefix("landmark:")
        found.append(Change(name, told, moved, one.sigma_after / unit_sigma, stated))
    return found


def residual_sizes(estimates: FlightEstimates, parameters: Iterable[Parameter]) -> Floats:
    """Measure the residuals with all parameters as stated, and as solved.

    Returns:
        The root mean square of a residual's coordinates before and after, of each landmark and of
        all, pixels, (M + 1, 2); NaN: it has none.
    """
    stated, joint = estimates, estimates.joint
    if any(one.after != one.before for one in parameters):
        assert joint is not None
        read = estimates.read
        read = replace(read, options=replace(read.options, free=(), kept=()))
        stated = settled(read, ~joint.model.used)
        if not read.options.drop_blunders:
            stated = with_named_picks(read, stated, stated)
    return np.stack([_sizes(one) for one in (stated, estimates)], axis=1)


def _sizes(estimates: FlightEstimates) -> Floats:
    """Find the root mean square of the residuals of picks that are used, (M + 1,)."""
    scene = estimates.scene()
    views = scene.views(np.arange(len(scene.camera_m))) if scene.views is not None else None
    assert views is not None
    square = ((views.pixel - views.fitted) ** 2).sum(axis=1) / 2.0
    here = views.used & np.isfinite(square)
    marks = len(scene.names)
    count = np.bincount(views.landmark[here], minlength=marks)
    total = np.bincount(views.landmark[here], square[here], minlength=marks)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.sqrt(np.append(total, total.sum()) / np.append(count, count.sum())))
