"""Which columns the attitude table of some jobs has, under which names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

from vopd.attitude.history import History
from vopd.attitude.sigmas import COMPONENTS
from vopd.attitude.table import (
    COVARIANCES,
    FIXED,
    GIMBAL,
    IMAGE_NAME,
    INTERVALS,
    SLIP_EFFECTS,
    TableColumn,
)
from vopd.attitude.uncertainty import ANGLES
from vopd.estimate import Estimate, Units
from vopd.findings import VopdError


@cache
def _fixed(source: str, units: Units, meanings: tuple[tuple[str, str], ...]) -> list[TableColumn]:
    """`FIXED` with units in the names, and the meanings of one kind of source."""
    columns = []
    for one in FIXED:
        name, unit = (
            text.format(source=source, **units._asdict()) for text in (one.name, one.unit)
        )
        meaning = dict(meanings).get(name, one.meaning)
        columns.append(replace(one, name=name, unit=unit, meaning=meaning))
    return columns


def column_name(template: str, estimate: Estimate) -> str:
    """A column's name from one of `FIXED`: `{length}`, `{image}` and `{source}` are replaced."""
    return template.format(source=estimate.about.words.source, **estimate.units._asdict())


def columns_of(histories: Sequence[History]) -> tuple[TableColumn, ...]:
    """The columns of a table of these jobs.

    They are `FIXED`, with `IMAGE_NAME` where any frame has a name; then the standard
    deviations of the nine angles, first all components together and then each
    component that any job has; then, where any job has errata to correct, what they
    change in the nine angles.

    Args:
        histories: one or more jobs

    Raises:
        VopdError: where they have different units
    """
    estimate = histories[0].estimate
    kind = estimate.units, estimate.about.words.source
    for one in histories:
        if (one.estimate.units, one.about.words.source) != kind:
            sources = f"{histories[0].about.source} and {one.about.source}"
            raise VopdError(f"{sources} have different kinds or units: write a table for each")
    words = estimate.about.words
    fixed = [*_fixed(words.source, estimate.units, tuple(words.columns.items()))]
    if any(h.estimate.frame_names for h in histories):
        fixed.insert(3, IMAGE_NAME)
    if any(h.estimate.gimbal_deg is not None for h in histories):
        fixed += GIMBAL
    components = [c for c in COMPONENTS if any(c in h.uncertainty.components for h in histories)]
    faulty = any(h.estimate.slip_effect_deg is not None for h in histories)
    effects = SLIP_EFFECTS if faulty else ()
    return (*fixed, *_sigmas(tuple(components)), *INTERVALS, *COVARIANCES, *effects)


@cache
def _sigmas(components: tuple[str, ...]) -> list[TableColumn]:
    """The columns of the standard deviations: all components together, and each of these."""
    sources = [("", "total", "standard deviation, all components together")]
    sources += [
        (f"{c}_", f"components.{c}", f"standard deviation, component {c}") for c in components
    ]
    return [
        TableColumn(f"sigma_{name}{angle}_deg", "deg", 6, f"uncertainty.{source}.{k}", meaning)
        for name, source, meaning in sources
        for k, angle in enumerate(ANGLES)
    ]
