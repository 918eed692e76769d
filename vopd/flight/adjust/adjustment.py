"""Joint adjustment of a flight: what all frames know together of lens, clock and landmarks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from html import escape
from os import PathLike
from typing import Any

import numpy as np

from vopd.arrays import Floats
from vopd.findings import Finding, VopdError, refuse_other_kind
from vopd.flight.flight import Flight
from vopd.flight.mounting import AXES
from vopd.flight.project.covariance import adjusted_from
from vopd.flight.project.keys import Project, read_project
from vopd.flight.project.read import flight_of
from vopd.flight.result import FlightResult, solve_flight_read
from vopd.flight.solve.errors import covariance_of_common
from vopd.flight.solve.free import (
    FREE,
    LANDMARK,
    UNIT,
    check_free,
    free_landmarks,
    names_of,
    prior_sigma,
    shown_name,
    stated_value,
    unit_factor,
)
from vopd.flight.solve.held import MOST_LEFT, trading
from vopd.flight.solve.joint import JointSolution


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


@dataclass(frozen=True, eq=False)
class Adjustment:
    """A flight solved with some of its parameters free.

    Attributes:
        result: the solved flight
        parameters: that were to be free, in the order of `FREE`, then landmarks, K of them
        covariance: after the solve, in the units of the table, (K, K); of one that is not held
            the stated variance, NaN where none is stated
    """

    result: FlightResult
    parameters: tuple[Parameter, ...]
    covariance: Floats

    @property
    def correlation(self) -> Floats:
        """Correlations after the solve, (K, K); NaN with a parameter that is not known."""
        with np.errstate(invalid="ignore", divide="ignore"):
            sigma = np.sqrt(np.diag(self.covariance))
            found = self.covariance / sigma / sigma[:, None]
        known = np.isfinite(np.diag(found))
        found[known, known] = 1.0  # whatever the rounding
        return np.asarray(found)

    def __str__(self) -> str:
        from vopd.flight.adjust.table import as_text

        return as_text(self, correlations=False)

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"

    def plot(self, name: str = "attitude", frame: int | str | None = None) -> Any:
        """Draw a figure of the flight as it is solved: see `FlightResult.plot`."""
        return self.result.plot(name, frame)


NAMES = 'names of free parameters, such as "focal" or ["focal", "k1"]'


def adjust(
    source: Flight | str | PathLike[str],
    free: str | Sequence[str],
    tell: Callable[[], object] = lambda: None,
) -> Adjustment:
    """Solve a flight with some of its parameters free.

    Args:
        source: the path of the project file, `flight.toml`, or the flight as it was read
        free: names of parameters: `focal`, `k1`, `clock`, ... (`vopd help adjust`), `landmarks` or
            `landmark:NAME`; a sequence, or one text with commas between them
        tell: is called before each solve of all frames

    Raises:
        VopdError: where a file cannot be read, a name is not known, or the flight has no such
            parameter
    """
    kinds = (Flight, str, PathLike)
    refuse_other_kind(source, kinds, "vopd.adjust", "the path of a flight project, or a flight")
    refuse_other_kind(tell, Callable, "vopd.adjust", "a function as tell")  # type: ignore[arg-type]
    flight = source if isinstance(source, Flight) else flight_to_adjust(str(source))[0]
    refuse_other_kind(free, (str, Iterable), "vopd.adjust", NAMES)
    given = names_of(free) if isinstance(free, str) else free
    for name in given:
        refuse_other_kind(name, str, "vopd.adjust", NAMES)
    names = tuple(dict.fromkeys(given))
    freed = replace(flight, options=replace(flight.options, free=names, kept=()))
    check_free(freed)
    return adjustment_of(solve_flight_read(freed, tell))


def flight_to_adjust(name: str) -> tuple[Flight, Project]:
    """Read a flight; of a project that is adjusted already, that of the one it came from.

    Returns:
        The flight, and the project that it is of.

    Raises:
        VopdError: where a file cannot be read
    """
    project = read_project(name)
    before = adjusted_from(project)
    if before is None:
        return flight_of(project), project
    try:
        project = read_project(before)
        flight = flight_of(project)
    except VopdError as error:
        raise VopdError(
            f"{name}: it is adjusted already, and its priors are in {before}, which cannot be "
            f"read: {error}"
        ) from error
    told = f"is adjusted already: it starts again from what {before} states"
    finding = Finding(told, name, severity="warning")
    return replace(flight, findings=(*flight.findings, finding)), project


def adjustment_of(result: FlightResult) -> Adjustment:
    """Tabulate the free parameters of a solved flight."""
    joint = result.estimates.joint
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
    vehicle = result.flight.vehicle
    if vehicle is not None and vehicle.turned_deg is not None:
        assert vehicle.covariance_deg2 is not None
        sigmas = np.sqrt(np.diag(vehicle.covariance_deg2)).tolist()
        prior = flight.mount_sigma_deg or float("inf")
        for axis, turn, sigma in zip(AXES, vehicle.turned_deg.tolist(), sigmas, strict=True):
            found.append(Parameter(f"mount {axis}", "deg", 0.0, turn, prior, sigma, held=True))
        apart = np.zeros((len(covariance), 3))
        covariance = np.block([[covariance, apart], [apart.T, vehicle.covariance_deg2]])
    return Adjustment(result, tuple(found), covariance)


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
