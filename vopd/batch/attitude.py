"""One deck, from its cards to the attitude history of every job."""

from __future__ import annotations

from collections.abc import Iterator
from typing import BinaryIO

from vopd.attitude.history import History, history
from vopd.attitude.input_sigmas import Sigmas
from vopd.batch.deck import not_converged, raise_stop, solve_deck
from vopd.errata import NO_FIXES, Fixes
from vopd.findings import Report


def deck_histories(
    file: BinaryIO,
    name: str,
    report: Report,
    *,
    fixes: Fixes = NO_FIXES,
    closed_form: bool = False,
    sigmas: Sigmas = Sigmas(),  # noqa: B008  it is frozen
    max_rate_deg_s: float | None = None,
) -> Iterator[History]:
    """The histories of a deck's jobs, each as soon as it is solved.

    `report` is given the warnings, those of frames that did not converge too.
    Raises `DeckError` where the deck cannot be read on, or a table out of
    order ended the run, after all jobs before and what there is of that one.
    """
    for solved in solve_deck(file, name, report, fixes=fixes, closed_form=closed_form):
        yield history(
            solved.results, name, solved.number, sigmas=sigmas, max_rate_deg_s=max_rate_deg_s
        )
        for finding in not_converged(solved):
            report(finding.warned())
        raise_stop(solved)
