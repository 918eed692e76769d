"""Solve decks and flights into attitude histories, for the commands attitude, plot and report."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import click

from vopd.attitude.findings import findings_of
from vopd.attitude.history import History
from vopd.attitude.long_history import HistoryParts, one_part
from vopd.cli.console import Messages, Progress
from vopd.cli.options import SharedOptions, tell_unused
from vopd.findings import VopdError, findings_in
from vopd.job import goes_on
from vopd.pipeline import in_groups, is_flight, solve_sources
from vopd.results import SolvedJob, SourceEnd
from vopd.solved import histories_of_run


@dataclass
class Collected:
    """The jobs of all sources, and what is still to be told about them."""

    messages: Messages  # by which warnings are told
    jobs: list[HistoryParts] = field(default_factory=list)
    untold: list[HistoryParts] = field(default_factory=list)  # whose frames have not been counted
    failed: bool = False  # some source could not be read or solved
    misfits: bool = False  # some flight does
    mistaken: int = 0  # flights whose residuals, or track, speak for an error of their inputs
    unread: int = 0  # decks that go on behind their last job
    clicks: tuple[str, ...] = ()  # where to click next in flights that are tracked from clicks

    def status(self, options: SharedOptions) -> int:
        """Tell what is known once all parts have been made; return the exit status.

        Of flights that are tracked from clicks that is also where to click next. The status is 3
        where a frame did not converge, a flight misfits, or with `--strict` a frame has any flag,
        the errata of the program change a job by more than its standard deviations, cards of a
        deck are not read, or the residuals or the track of a flight speak for an error of its
        inputs.
        """
        for job in self.untold:
            for finding in findings_of(job.about, job.summary):
                self.messages(finding)
        self.messages.close()
        for text in () if options.quiet else self.clicks:
            click.echo(text, err=True)
        if self.failed:
            return 1
        every = [job.summary for job in self.jobs]
        doubtful = options.doubtful(
            sum(one.flagged for one in every), self.mistaken,
            sum(one.errata > 0 for one in every), self.unread,
        )  # fmt: skip
        unconverged = any(one.unconverged for one in every)
        return 3 if unconverged or self.misfits or doubtful else 0


def collect_jobs(
    decks: tuple[str, ...],
    options: SharedOptions,
    by_parts: bool,
    on_message: Callable[[str], object] = lambda _: None,
    misfits: bool = True,
    job: int | None = None,
) -> Collected:
    """Solve all decks and flights, for their attitude histories.

    A source that fails is reported on standard error, and the others are still solved.

    Args:
        decks: files of 80-column cards, - is standard input; or flight projects, `.toml`
        options: what the options ask for
        by_parts: whether the parts of long jobs are made later, one after the other
        on_message: is given all warnings and errors, also those that are not printed
        misfits: whether to warn of frames that misfit, which a table in short says itself
        job: the only one that counts, from 1; None: all

    Raises:
        VopdError: where no frame of any deck has an attitude, or there is no such job
    """
    tell_unused(decks, options.quiet)
    if options.solve.fixes and not options.quiet and not all(map(is_flight, decks)):
        click.echo(f"corrected run, not the original: {options.solve.fixes}", err=True)
    messages = Messages(options.quiet, on_message)
    found = Collected(messages)
    progress = Progress("frames solved", stopped="nothing is written")
    solves = solve_sources(decks, options.solve, sigmas=options.history.sigmas)
    for some in in_groups(solves):
        solved = [one for one in some if isinstance(one, SolvedJob)]
        of_jobs = iter(histories_of_run(solved, options.history) if solved else [])
        for one in some:
            for finding in one.findings:
                messages(finding)
            found.unread += goes_on(one.findings)
            if isinstance(one, SourceEnd):
                progress.close()
                messages.close()
                if one.error is not None:
                    told = "\n".join(map(str, findings_in(one.error, one.source)))
                    messages.error(told if len(decks) > 1 else str(one.error))
                    found.failed = True
                continue
            if isinstance(one, SolvedJob):
                made = one_part(next(of_jobs))
                if job not in (None, made.about.job):
                    continue
            else:
                from vopd.flight.result import unused_options  # decks need not wait for it

                if job not in (None, 1):
                    continue
                found.misfits |= one.misfits
                found.mistaken += one.mistaken
                found.clicks += tuple(one.next_clicks)
                for finding in unused_options(one, options.history):
                    messages(finding)
                made = one.history_parts(options.history)
                made = made if by_parts else one_part(made.whole)
            if misfits and made.counted:
                for finding in findings_of(made.about, made.summary):
                    messages(finding)
            elif misfits:
                found.untold.append(made)
            found.jobs.append(made)
            progress.add(made.frames)
    if not any(job.has_attitude() for job in found.jobs):
        if found.failed:
            raise click.exceptions.Exit(1)
        none = "no frame has an attitude" if job is None or found.jobs else f"no job {job}"
        raise VopdError(f"{', '.join(decks)}: {none}")
    return found


def collect_histories(
    decks: tuple[str, ...],
    options: SharedOptions,
    on_message: Callable[[str], object] = lambda _: None,
    job: int | None = None,
) -> tuple[list[History], int]:
    """Solve all decks and flights for whole histories, and the exit status so far.

    Arguments and errors as `collect_jobs`.
    """
    found = collect_jobs(decks, options, by_parts=False, on_message=on_message, job=job)
    return [job.whole for job in found.jobs], found.status(options)
