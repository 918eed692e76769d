"""How all pictures look: colours that differ in grey and to the colour-blind, sizes, captions."""

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
    """The settings of matplotlib under which pictures are drawn and saved."""
    import matplotlib as mpl

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(_SETTINGS)
        yield


def caption(histories: Sequence[History]) -> str:
    """Decks, the title of a single job, and the fixes in force."""
    decks = list(dict.fromkeys(h.about.source for h in histories))
    text = ", ".join(decks[:3]) + (f" and {len(decks) - 3} more" if len(decks) > 3 else "")
    if len(histories) == 1:
        text += f", job {histories[0].about.job}: {histories[0].about.title}"
    else:
        text += f", {len(histories)} jobs"
    fixes = histories[0].about.fixes
    if fixes:
        text += f"\ncorrected run, not the original: {fixes}"
    return _plain(text)


def label(history: History, histories: Sequence[History]) -> str:
    """A job's name in a legend."""
    decks = {h.about.source for h in histories}
    return _plain(history.about.label if len(decks) > 1 else f"job {history.about.job}")


def _plain(text: str) -> str:
    """Text that matplotlib takes as it stands: no mathematics, nothing that does not print."""
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in text).replace("$", r"\$")
