"""The look of all figures: colours that the colour-blind can tell apart, sizes, captions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from vopd.attitude.history import History

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")  # Okabe and Ito
FLAGGED = "#b30000"
_SETTINGS: dict[Any, Any] = {
    "font.size": 9.0,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "legend.frameon": False,
    "svg.hashsalt": "vopd",
    "svg.fonttype": "path",
    "path.simplify": True,
}


@contextmanager
def style() -> Iterator[None]:
    """Apply the style for drawing and saving a figure, and restore the old settings afterwards."""
    import matplotlib as mpl

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_SETTINGS)
        yield


def caption(histories: Sequence[History]) -> str:
    """The caption: sources, the title if there is one job, and the fixes that were applied."""
    names = list(dict.fromkeys(h.about.source for h in histories))
    text = ", ".join(names[:3]) + (f" and {len(names) - 3} more" if len(names) > 3 else "")
    if len(histories) == 1:
        text += f", job {histories[0].about.job}: {histories[0].about.title}"
    else:
        text += f", {len(histories)} jobs"
    fixes = histories[0].about.fixes
    if fixes:
        text += f"\ncorrected run, not the original: {fixes}"
    return plain(text)


def label(history: History, histories: Sequence[History]) -> str:
    """The label of a job in a legend."""
    sources = {h.about.source for h in histories}
    return plain(history.about.label if len(sources) > 1 else f"job {history.about.job}")


def plain(text: str) -> str:
    """Text that matplotlib shows as it is: no formulas, and `?` for unprintable characters."""
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in text).replace("$", r"\$")
