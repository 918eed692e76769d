"""Mark the frames of a figure against time: flagged, misfits, and those with errata above sigma."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.history import History
from vopd.figures.style import COLOURS, FLAGGED, label


class FrameMark(NamedTuple):
    """How frames are marked: with a symbol at the angle, or at the bottom of the panel."""

    flag: str  # of `vopd.attitude.flags.MEANING`; empty for any other flag
    text: str  # in the legend
    look: dict[str, Any]
    at_bottom: bool = False


MARKS = (
    FrameMark("", "flagged", {"marker": "o", "mfc": "none", "mec": FLAGGED, "mew": 0.6, "ms": 5}),
    FrameMark("misfit", "misfit", {"marker": "X", "mfc": FLAGGED, "mec": "white", "ms": 8}),
    FrameMark(
        "model_error",
        "model error",
        {"marker": "|", "mec": COLOURS[5], "mew": 1.2, "ms": 9},
        at_bottom=True,
    ),
)


def marked(history: History, mark: FrameMark) -> Bools:
    """The frames with a mark (F,); of other flags those that have no mark of their own."""
    raised = history.flags.raised
    if mark.flag:
        return raised[mark.flag]
    own = [one.flag for one in MARKS if one.flag]
    found = ~history.has_attitude & False
    for name, frames in raised.items():
        if name not in own:
            found = found | frames
    return found


def draw_marks(axis: Any, history: History, order: Ints, angle: Floats, known: Bools) -> None:
    """Draw the marks of one job into a panel.

    Args:
        axis: the panel
        history: the job
        order: indices of the frames in order of time
        angle: the angle of each of these, as it is drawn
        known: which of them have one
    """
    time_s = history.order_axis[0][order]
    for mark in MARKS:
        here = known & marked(history, mark)[order]
        if not here.any():
            continue
        if mark.at_bottom:
            axis.plot(
                time_s[here], [0.03] * int(here.sum()), ls="", zorder=1.5,
                transform=axis.get_xaxis_transform(), **mark.look,
            )  # fmt: skip
        else:
            axis.plot(time_s[here], angle[here], ls="", **mark.look)


def draw_legend(figure: Any, histories: Sequence[History]) -> None:
    """Put the legend of jobs, band and marks below the panels, where no data are."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    colour = COLOURS[0] if len(histories) == 1 else "0.5"
    handles: list[Any] = []
    texts: list[str] = []
    if len(histories) > 1:
        for number, history in enumerate(histories[: len(COLOURS)]):
            handles.append(Line2D([], [], color=COLOURS[number]))
            texts.append(label(history, histories))
    handles.append(Patch(color=colour, alpha=0.3, lw=0))
    texts.append("95 % interval")
    for mark in MARKS:
        if any((marked(h, mark) & h.has_attitude).any() for h in histories):
            handles.append(Line2D([], [], ls="", **mark.look))
            texts.append(mark.text)
    figure.legend(handles, texts, loc="outside lower center", ncols=4)
