"""Choose the jobs that a figure shows: of many, those that a person should look at first."""

from __future__ import annotations

from collections.abc import Sequence

from vopd.attitude.history import History

MOST_DRAWN = 20
"""Jobs of one figure: with more, none can be told from another, and each takes .2 s."""

WORST = "the most frames that did not converge, misfit or have a flag"


def drawn_jobs(histories: Sequence[History]) -> list[History]:
    """All jobs, or of more than `MOST_DRAWN` the worst, in the order in which they are given.

    Args:
        histories: the jobs
    """
    if len(histories) <= MOST_DRAWN:
        return list(histories)
    have = [k for k, one in enumerate(histories) if one.has_attitude.any()]
    have.sort(key=lambda k: _badness(histories[k]), reverse=True)
    return [histories[k] for k in sorted(have[:MOST_DRAWN])]


def left_out_text(histories: Sequence[History]) -> str:
    """Which jobs a figure shows, where it does not show all of them; else empty.

    Args:
        histories: the jobs
    """
    drawn = len(drawn_jobs(histories))
    return "" if drawn == len(histories) else f"{drawn} of {len(histories)} jobs, with {WORST}"


def _badness(history: History) -> tuple[int, int, int]:
    """How many frames did not converge, misfit, and have any flag."""
    raised = history.flags.raised
    return (
        int(raised["not_converged"].sum()),
        int(raised["misfit"].sum()),
        int(history.flags.any().sum()),
    )
