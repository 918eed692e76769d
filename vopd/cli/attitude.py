"""`vopd attitude`: write the attitude table of flights and decks, or a file for another tool."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC
from shlex import quote
from typing import Any

import click
import numpy as np

from vopd.attitude.history import History, has_photographs
from vopd.attitude.included import errors_texts, largest_component
from vopd.attitude.long_history import HistoryParts
from vopd.attitude.table import chosen_columns, table_blocks
from vopd.cli.console import Progress, screen_columns
from vopd.cli.histories import Collected, collect_jobs
from vopd.cli.options import SharedOptions, history_options, output_option, sources_argument
from vopd.cli.output import refuse_to_overwrite
from vopd.export import (
    FORMATS,
    MEAN_FORMATS,
    AttitudeFormat,
    FileRequest,
    of_file,
    own_epoch,
)
from vopd.files import ESCAPED, whole_file
from vopd.findings import Finding, Report, VopdError
from vopd.inputs import since_1970, utc_moment
from vopd.pipeline import is_flight

NO_EPOCH = "give [flight] epoch in the project, or --epoch"


def _formats() -> str:
    rows = [(one.name, " ".join(one.suffixes), one.about) for one in FORMATS.values()]
    return "\n".join(f"    {name:8} {suffixes:14} {about}" for name, suffixes, about in rows)


TEXT = "text"  # what a terminal shows; not the format of a file

_HELP = """Show the attitude of every frame with its uncertainty and flags, or write it to a file.

SOURCE is a flight project, whose name ends in .toml (vopd help flight-project), or
a deck of 80-column cards; - is a deck on standard input. The table has a row for
each frame: the angles of camera and vehicle, the angles of attack alpha, beta and
eta, the position, the quaternion, standard deviations and flags. Every file states
its axes, the ranges of its angles, and the fixes in force.

A terminal shows the first 20 frames in short: the angles with half of their 95 %
intervals. Below are a summary of the uncertainty, the doubtful frames, and what to
do next. A file or a pipe gets all frames and all columns.

\b
Formats, by FILE's suffix or --format:
{formats}

\b
Examples:
    vopd attitude examples/hill/flight.toml
    vopd attitude flight.toml -o flight.parquet --landmark-sigma 0.1
    vopd attitude decks/appendix_h/case1.dat
    vopd attitude flight.dat -o flight.aem --epoch 1974-08-27T17:30:00Z
    vopd demo | vopd attitude - --format jsonl

The table includes ignored frames, without angles. aem, acm, czml and kml have only
the frames with an attitude, in order of time. vopd help attitude-files explains the
columns.

Exit status: 0 the file is written; 1 a source could not be read or solved
(the sources before it are written), no frame has an attitude, or FILE cannot
be written; 2 wrong usage; 3 the file is written, but some frame did not
converge, a flight misfits, or with --strict some frame has a flag.
"""


@click.command("attitude", help=_HELP.format(formats=_formats()))
@sources_argument
@output_option("The file to write; by default standard output.")
@click.option(
    "--format",
    "form",
    type=click.Choice([TEXT, *FORMATS]),
    help="By default what FILE's suffix says; on standard output text for a terminal, else csv.",
)
@click.option(
    "--columns",
    metavar="basic|all|LIST",
    help="Columns of the table; LIST has their names in the CSV, with commas.  [default: all; "
    "basic in text]",
)
@click.option(
    "--roll",
    type=click.Choice(["180", "360"]),
    help="Write roll from -180 to 180, or from 0 to 360 degrees.  [default: 360; 180 in text]",
)
@click.option(
    "--epoch",
    metavar="TIME",
    help="The moment of time zero, ISO 8601, UTC; aem, acm and czml need it.  "
    "[default: that of the project]",
)
@click.option(
    "--aem-version",
    type=click.Choice([1, 2]),
    help="Version of the AEM, CCSDS 504.0-B.  [default: 2]",
)
@click.option(
    "--originator", metavar="TEXT", help="The originator that aem and acm name.  [default: VOPD]"
)
@click.option(
    "--object-name",
    metavar="TEXT",
    help="The vehicle's name, in aem, acm, czml and kml.  [default: UNKNOWN, or the job's title]",
)
@click.option(
    "--object-id",
    metavar="TEXT",
    help="The vehicle's international designator, in aem and acm.  [default: UNKNOWN]",
)
@click.option(
    "--mean",
    is_flag=True,
    help="Write one row for each job instead: the mean attitude of its frames, with its "
    "uncertainty; for text, csv, jsonl, npz and parquet.",
)
@history_options
@click.pass_context
def command(
    ctx: click.Context,
    /,
    sources: tuple[str, ...],
    output: str,
    form: str | None,
    columns: str | None,
    roll: str | None,
    epoch: str | None,
    mean: bool,
    options: SharedOptions,
    **names: Any,
) -> None:
    """Write the attitude table, or the attitude history in the format of another tool."""
    screen = form == TEXT or (form is None and output == "-" and sys.stdout.isatty())
    chosen = FORMATS["csv"] if screen else _format(output, form)
    if mean and (columns is not None or roll or epoch is not None):
        raise click.UsageError(
            "--columns, --roll and --epoch are for a row a frame: leave out --mean."
        )
    if mean and chosen.name not in MEAN_FORMATS:
        raise click.UsageError(f"--mean is for {', '.join(MEAN_FORMATS)}, not {chosen.name}.")
    names["columns"] = None if columns is None else tuple(columns.replace(" ", "").split(","))
    names["roll_180"] = roll and roll == "180"
    request = _request(chosen, epoch, names, any(map(is_flight, sources)))
    refuse_to_overwrite(sources, output)
    chosen.ready()
    if chosen.binary and output == "-" and sys.stdout.isatty():
        raise click.UsageError(f"{chosen.name} is binary: name a file with -o.")
    short = screen and (mean or columns in (None, "basic"))  # which says itself how sure it is
    by_parts, misfits = chosen.by_parts and not mean, mean or not short
    found = collect_jobs(sources, options, by_parts, misfits=misfits)
    request = _with_epoch(chosen, request, [job.head for job in found.jobs], found.messages)
    if columns is not None:
        try:
            chosen_columns([job.head for job in found.jobs], request.columns)
        except VopdError as error:
            raise click.UsageError(f"--columns: {error}") from error
    progress = Progress(
        "frames written",
        total=sum(job.frames for job in found.jobs),
        stopped="the table is not complete" if output == "-" else f"{output} is not written",
    )
    jobs = [job.watched(progress.add) for job in found.jobs]
    coding = sys.stdout.encoding if output == "-" else "utf-8"
    with whole_file(output) as file:
        if screen and mean:
            file.write(_means(jobs).encode(coding, ESCAPED))
        elif short:
            told = _short(jobs, sources, found, options.quiet, roll != "360")
            file.write(told.encode(coding, ESCAPED))
        elif screen:
            file.write(_listed(jobs, request, roll).encode(coding, ESCAPED))
        elif mean:
            file.write(chosen.mean_table(jobs, request))
        else:
            for page in chosen.pages(jobs, request, found.messages):
                file.write(page)
    progress.close()
    if not options.quiet and not short:
        means = [job.whole.mean() for job in found.jobs] if mean else []
        for source, included, left in errors_texts([job.head for job in found.jobs], means):
            said = f"the sigmas do not include errors of: {left}"
            if included:
                said = f"the sigmas include errors of: {included}"
                said += f"; not included: {left}" * bool(left)
            click.echo(f"{source}: {said}", err=True)
    ctx.exit(found.status(options))


def _short(
    jobs: Sequence[HistoryParts],
    sources: Sequence[str],
    found: Collected,
    quiet: bool,
    roll_180: bool,
) -> str:
    """Write the frames in short, and what to do next."""
    from vopd.attitude.summary import text

    names = quote(sources[0]) if len(sources) == 1 else "SOURCE..."
    steps = []
    if found.misfits or found.mistaken:
        steps.append(f"vopd check {names} says which file or value is likely wrong")
    head = jobs[0].head
    if len(jobs) == 1 and head.about.words.sigma_keys and largest_component(head) == "focal":
        steps.append(
            "the largest part of +- is the stated error of the focal length: vopd adjust "
            f"{names} --free focal says "
            'how well the picks hold it, and [solve] free = ["focal"] takes it from them'
        )
    few = sum(len(job.head.status) for job in jobs) <= MOST_PHOTOGRAPHS
    shown = " --photographs" * (few and has_photographs(head))
    steps.append(f"vopd report {names} -o report.html{shown} draws every frame")
    every = len(chosen_columns([jobs[0].head]))
    table = f"-o FILE.csv writes all frames with {every} columns"
    return text(
        jobs,
        screen_columns(),
        steps={"table": table, "next": "; ".join(steps)},
        printed=0 if quiet else found.messages.warnings,
        roll_180=roll_180,
    )


MOST_PHOTOGRAPHS = 60  # of a report that is proposed: each has some .1 MB


def _means(jobs: Sequence[HistoryParts]) -> str:
    """Write the mean attitude of each job in short."""
    from vopd.attitude.summary import means_text

    table = "-o FILE.csv writes it with all columns"
    return means_text([job.whole for job in jobs], screen_columns(), {"table": table})


def _listed(jobs: Sequence[HistoryParts], request: FileRequest, roll: str | None) -> str:
    """Write the columns that are named, of all frames, aligned."""
    from vopd.export.tables import as_text
    from vopd.screen import aligned

    heads = [job.head for job in jobs]
    columns = chosen_columns(heads, request.columns, roll != "360")
    rows = [[one.name for one in columns]]
    for values in table_blocks(jobs, columns):
        rows += map(list, zip(*as_text(values, columns).values(), strict=True))
    words = {k for k, one in enumerate(columns) if one.decimals is None}
    return "\n".join(aligned(rows, words)) + "\n"


def _format(output: str, form: str | None) -> AttitudeFormat:
    if form is not None:
        return FORMATS[form]
    if output == "-":
        return FORMATS["csv"]
    try:
        return of_file(output)
    except VopdError as error:
        raise click.UsageError(f"{error}; or give --format.") from error


def _with_epoch(
    chosen: AttitudeFormat, request: FileRequest, histories: Sequence[History], report: Report
) -> FileRequest:
    """Add the epoch of the sources to the request if no option gives one.

    One that is not that of a source is warned of.

    Raises:
        VopdError: where the format needs one and there is none, or the option's is not that of
            the times
    """
    if request.epoch is not None:
        for one in histories:
            first_s = float(np.fmin.reduce(one.estimate.time_s, initial=np.inf))
            if wrong := since_1970(request.epoch, first_s):
                raise VopdError(f"{one.about.source}: --epoch {wrong}")
            if one.about.epoch not in (None, request.epoch):
                own = one.about.epoch.astimezone(UTC).isoformat().replace("+00:00", "Z")
                text = f"--epoch: the dates are other ones than the project's, whose epoch is {own}"
                report(Finding(text, one.about.source, severity="warning"))
        return request
    epoch = own_epoch(histories)
    if chosen.needs_epoch and epoch is None:
        several = any(h.about.epoch is not None for h in histories)
        why = "the sources do not have one epoch: write a file for each" if several else NO_EPOCH
        raise VopdError(f"{histories[0].about.source}: {chosen.name} needs dates: {why}")
    return replace(request, epoch=epoch)


def _request(
    chosen: AttitudeFormat, epoch: str | None, names: dict[str, Any], flights: bool
) -> FileRequest:
    """Check the options; `flights`: some source is a project, which may have an epoch.

    Raises:
        click.UsageError: where an option would have no effect, or is wrong
    """
    given = {name: value for name, value in names.items() if value is not None}
    for name in (*given, *["epoch"] * (epoch is not None)):
        if name not in chosen.options:
            option = "--" + name.replace("_", "-").removesuffix("-180")
            takers = [one.name for one in FORMATS.values() if name in one.options]
            raise click.UsageError(f"{option} is for {', '.join(takers)}, not {chosen.name}.")
    if chosen.needs_epoch and epoch is None and not flights:
        raise click.UsageError(
            f"{chosen.name} needs dates: give the moment of time zero, "
            "for instance --epoch 1974-08-27T17:30:00Z."
        )
    try:
        if "originator" in chosen.options:
            from vopd.export.ccsds import text_value

            for name in ("originator", "object_name", "object_id"):
                text_value(given.get(name, ""))
        zero = None if epoch is None else utc_moment(epoch)
    except VopdError as error:
        raise click.UsageError(f"{error}.") from error
    return FileRequest(epoch=zero, **given)
