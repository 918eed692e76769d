"""Write or check the names that last in docs/promises.md, which are those of the package's tables.

python tools/public_names.py --write
python tools/public_names.py --check
"""

from __future__ import annotations

import sys
import textwrap
from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path

from made_page import between, write_or_check

import vopd
from vopd.attitude.flags import MEANING
from vopd.attitude.mean import MeanAttitude
from vopd.attitude.rate import Turn, TurningRate
from vopd.attitude.sigmas import COMPONENTS
from vopd.attitude.table import (
    COVARIANCES,
    FIXED,
    GIMBAL,
    IMAGE_NAME,
    INTERVALS,
    MATRICES,
    PLACES,
    SLIP_EFFECTS,
    TableColumn,
)
from vopd.attitude.uncertainty import ANGLES
from vopd.batch.folder import WORST_FIRST
from vopd.cli import COMMANDS
from vopd.estimate import FrameStatus
from vopd.flight.direction import Direction
from vopd.flight.project.keys import KEYS
from vopd.job import Camera, Clock, Ignored, Landmarks, Trajectory, Wind
from vopd.results import Outcome

PAGE = Path(__file__).parents[1] / "docs" / "promises.md"
HIDDEN = """
layout points by_row take concat as_job divided used_count estimates estimate history_parts chosen
"""
"""Attributes that rooms of the package use among each other."""
BEGIN, END = "<!-- names -->\n", "<!-- end of names -->"


def names(every: Iterable[str]) -> str:
    """List names in Markdown."""
    return ", ".join(f"`{one}`" for one in every)


def attributes(kind: type) -> str:
    """List the public attributes of a class: fields, properties and methods."""
    own = [one.name for one in fields(kind)] if hasattr(kind, "__dataclass_fields__") else []
    bases = [vars(base) for base in kind.__mro__[:-1] if base.__module__.startswith("vopd.")]
    inherited = [name for base in reversed(bases) for name in base if not name.startswith("_")]
    hidden = {*HIDDEN.split()}
    return names(one for one in dict.fromkeys([*own, *inherited]) if one not in hidden)


def columns(some: Iterable[TableColumn]) -> str:
    """List the columns of a table, with the units that they may have."""
    units = {"length": "ft", "image": "mm", "source": "deck"}
    return names(one.name.format(**units) for one in some)


def page() -> str:
    """Lay out all names in Markdown, a paragraph for each kind."""
    sections: dict[str, list[str]] = {}
    for key in KEYS:
        sections.setdefault(key.section, []).append(key.name)
    sigmas = names(f"sigma_{angle}_deg" for angle in ANGLES)
    paragraphs = {
        "Names of `vopd`": names(vopd.__all__),
        "Attributes of `Run`": attributes(vopd.Run),
        "Attributes of `Results`": attributes(vopd.Results),
        "Outcomes of a frame in `Results.outcome`": names(
            f"{one.value} {one.name}" for one in Outcome
        ),
        "Attributes of `Deck`": attributes(vopd.Deck),
        "Attributes of `Job`": attributes(vopd.Job),
        **{
            f"Attributes of `Job.{kind.__name__.lower()}`": attributes(kind)
            for kind in (Camera, Trajectory, Wind, Clock, Landmarks, Ignored)
        },
        "Attributes of `FlightResult`": attributes(vopd.FlightResult),
        "Attributes of `FlightResult.direction()`": attributes(Direction),
        "Methods of a history, of `FlightResult.history()` and `Run.histories()`": names(
            ("mean", "rate", "turn")
        ),
        "Attributes of `history.mean()`": attributes(MeanAttitude),
        "Attributes of `history.rate()`": attributes(TurningRate),
        "Attributes of `history.turn()`": attributes(Turn),
        "Attributes of `Adjustment`": attributes(vopd.Adjustment),
        "Attributes of `Sigmas`": attributes(vopd.Sigmas),
        "Attributes of `Finding`": attributes(vopd.Finding),
        "Commands": names(COMMANDS),
        "Exit statuses": "0, 1, 2, 3, and 128 and a signal's number (see below)",
        "Columns of the attitude table, in their order (flights have `project`, `m` and `px` in "
        "place of `deck`, `ft` and `mm`)": columns(FIXED),
        "After `frame`, if frames have names": columns([IMAGE_NAME]),
        "Then, if images have them": columns(GIMBAL),
        "Then, if positions of a flight are solved for": columns(PLACES),
        "Then standard deviations": f"{sigmas}; and `sigma_COMPONENT_ANGLE_deg` of each component "
        f"that a source has: {names(COMPONENTS)}",
        "Then intervals and covariances": columns([*INTERVALS, *COVARIANCES]),
        "The same covariances as matrices, in JSON Lines, npz, Parquet and DataFrames": columns(
            MATRICES
        ),
        "At the end, if a run has errata that can be corrected": columns(SLIP_EFFECTS),
        "Statuses of frames": names(one.name.lower() for one in FrameStatus),
        "Flags": names(MEANING),
        "Statuses of sources of a batch": names(WORST_FIRST[::-1]),
        **{f"Keys of `flight.toml` in `[{one}]`": names(keys) for one, keys in sections.items()},
    }
    lines = [
        "\n".join(textwrap.wrap(f"{what}: {text}.", 118, break_on_hyphens=False))
        for what, text in paragraphs.items()
    ]
    return "\n\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(write_or_check(PAGE, lambda text: between(text, BEGIN, END, page()), __doc__))
