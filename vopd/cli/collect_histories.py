"""Solve decks and flights into attitude histories, for the commands attitude, plot and report."""

from __future__ import annotations

from collections.abc import Callable

import click

from vopd.attitude.history import History
from vopd.attitude.misfit_findings import misfit_findings
from vopd.cli.console import Messages, Progress
from vopd.cli.options import HistoryOptions
from vopd.findings import VopdError
from vopd.pipeline import solve_sources
from vopd.solved import Run
from vopd.solved_job import DeckEnd, SolvedJob


def collect_histories(
    decks: tuple[str, ...], asked: HistoryOptions, heard: Callable[[str], object] = lambda _: None
) -> tuple[list[History], int]:
    """Make the attitude histories of all decks; also returns the exit status so far.

    A deck that fails is reported on standard error, and the others are still solved.

    Args:
        decks: files of 80-column cards, - is standard input; or flight projects, `.toml`
        asked: what the options ask for
        heard: is given all warnings and errors, also those that are not printed

    Raises:
        VopdError: where no frame of any deck has an attitude
    """
    if asked.solve.fixes and not asked.quiet:
        click.echo(f"corrected run, not the original: {asked.solve.fixes}", err=True)
    histories: list[History] = []
    failed = False
    messages, progress = Messages(asked.quiet, heard), Progress("frames")
    for one in solve_sources(decks, asked.solve):
        for finding in one.findings:
            messages(finding)
        if isinstance(one, DeckEnd):
            progress.close()
            messages.close()
            if one.error is not None:
                messages.error(str(one.error))
                failed = True
            continue
        how = asked.sigmas, asked.max_rate_deg_s, asked.vertical
        if isinstance(one, SolvedJob):
            (made,) = Run([one]).histories(*how)
        else:
            made = one.history(*how)
        for finding in misfit_findings(made):
            messages(finding)
        histories.append(made)
        progress.add(len(made.estimate.frame))
    if not any(h.has_attitude.any() for h in histories):
        if failed:
            raise click.exceptions.Exit(1)
        raise VopdError(f"{', '.join(decks)}: no frame has an attitude")
    return histories, 1 if failed else _status(histories, asked)


def _status(histories: list[History], asked: HistoryOptions) -> int:
    """3 where a frame did not converge, or has any flag and `--strict` was asked for."""
    unconverged = any(h.flags.raised["not_converged"].any() for h in histories)
    flagged = any(h.flags.any().any() for h in histories)
    if asked.strict and flagged and not asked.quiet:
        count = sum(int(h.flags.any().sum()) for h in histories)
        click.echo(f"--strict: {count} frames are flagged", err=True)
    return 3 if unconverged or (asked.strict and flagged) else 0
