"""Joint adjustment of a flight: what all frames know together of lens, clock and landmarks."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from html import escape
from os import PathLike
from typing import Any

import numpy as np

from vopd.arrays import Floats
from vopd.findings import Finding, VopdError, refuse_other_kind
from vopd.flight.flight import Flight
from vopd.flight.parameters import Parameter, parameters_of
from vopd.flight.project.covariance import adjusted_from
from vopd.flight.project.keys import Project, read_project
from vopd.flight.project.read import flight_or_errors
from vopd.flight.result import FlightResult, project_file, solve_flight_read
from vopd.flight.solve.free import check_free, names_of


@dataclass(frozen=True, eq=False)
class Adjustment:
    """A flight solved together with some parameters; `print` shows their table.

    Attributes:
        result: the solved flight
        parameters: the K freed parameters, in the order of `FREE`, then landmarks
        covariance: after the solve, in the units of the table, (K, K); for a parameter that is
            not held the stated variance, NaN if none is stated
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
    free: str | Iterable[str],
    tell: Callable[[], object] = lambda: None,
) -> Adjustment:
    """Solve a flight together with some parameters of its lens, clock, track or landmarks.

    Args:
        source: the path of the project file, `flight.toml`, or of its folder; or a flight as
            read, which is `read` of a result
        free: names of the parameters: `focal`, `k1`, `clock`, ... (`vopd help adjust`),
            `landmarks` or `landmark:NAME`; a list, or one text with commas
        tell: a function that is called before each solve of all frames

    Raises:
        VopdError: if a file cannot be read, a name is not known, or the flight has no such
            parameter
    """
    takes = "the path of a flight project, or the `read` of a FlightResult"
    refuse_other_kind(source, (Flight, str, PathLike), "vopd.adjust", takes)
    refuse_other_kind(tell, Callable, "vopd.adjust", "a function as tell")  # type: ignore[arg-type]
    refuse_other_kind(free, (str, Iterable), "vopd.adjust", NAMES)
    if isinstance(source, Flight):
        flight = source
    else:
        flight = flight_to_adjust(project_file(source, None, "vopd.adjust")[0])[0]
    given = names_of(free, flight.landmarks.name) if isinstance(free, str) else [*free]
    for name in given:
        refuse_other_kind(name, str, "vopd.adjust", NAMES)
    names = tuple(dict.fromkeys(given))
    freed = replace(flight, options=replace(flight.options, free=names, kept=()))
    check_free(freed)
    result = solve_flight_read(freed, tell)
    return Adjustment(result, *parameters_of(result.estimates))


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
        return flight_or_errors(project), project
    try:
        project = read_project(before)
        flight = flight_or_errors(project)
    except VopdError as error:
        raise VopdError(
            f"{name}: it is adjusted already, and its priors are in {before}, which cannot be "
            f"read: {error}"
        ) from error
    told = f"is adjusted already: it starts again from what {before} states"
    finding = Finding(told, name, severity="warning")
    return replace(flight, findings=(*flight.findings, finding)), project
