"""Draw the errors of several methods for every pair of stars, one panel for each angle."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vopd.arrays import Floats
from vopd.figures import matplotlib_figure
from vopd.figures.style import COLOURS

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIZE_IN = (9.0, 10.0)
MARKERS = "osD^v*"
APART = 0.12
"""Distance of the methods' marks of one pair, in distances of the pairs."""


class PanelOfErrors(NamedTuple):
    """One panel: a title, and errors in degrees of each method (columns) by pair (rows)."""

    title: str
    errors: Floats


def draw_errors_by_pair(
    pairs: Sequence[str], methods: Sequence[str], panels: Sequence[PanelOfErrors]
) -> Figure:
    """Draw panels one below the other, a mark for each pair and method.

    Args:
        pairs: names of the pairs
        methods: names of the methods
        panels: what to draw

    Raises:
        VopdError: where matplotlib is not installed
    """
    with matplotlib_figure(SIZE_IN) as figure:
        axes = np.atleast_1d(figure.subplots(len(panels), 1, sharex=True))
        place = np.arange(len(pairs))
        for axis, panel in zip(axes, panels, strict=True):
            axis.axhline(0.0, color="0.5", lw=0.8)
            for k, method in enumerate(methods):
                shift = (k - (len(methods) - 1) / 2.0) * APART
                axis.plot(
                    place + shift, panel.errors[:, k], MARKERS[k % len(MARKERS)], ms=6,
                    color=COLOURS[k % len(COLOURS)], label=method,
                )  # fmt: skip
            axis.set_title(panel.title, fontsize="medium")
            axis.set_ylabel("degrees")
            axis.set_xticks(place, pairs)
        axes[0].legend(ncols=len(methods), loc="lower center", bbox_to_anchor=(0.5, 1.12))
        drawn: Figure = figure
    return drawn
