"""`vopd attitude`: write the attitude table of flights and decks, or a file for another tool."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from itertools import zip_longest
from typing import Any

import click

from vopd.attitude.history import History
from vopd.attitude.included import included_text, left_out_text
from vopd.attitude.mean import MeanAttitude
from vopd.cli.console import Messages, Progress
from vopd.cli.histories import collect_jobs
from vopd.cli.options import SharedOptions, history_options, output_option, sources_argument
from vopd.cli.output import refuse_to_overwrite
from vopd.export import (
    FORMATS,
    MEAN_FORMATS,
    AttitudeFormat,
    FileRequest,
    created_now,
    of_file,
    own_epoch,
    parse_epoch,
)
from vopd.export.ccsds import text_value
from vopd.files import whole_file
from vopd.findings import VopdError
from vopd.pipeline import is_flight

_DEFAULTS: dict[str, Any] = {
    "aem_version": 2,
    "originator": "VOPD",
    "object_name": "",
    "object_id": "",
}
SIGMA_OPTIONS = {
    "position": "--position-sigma",
    "landmark": "--landmark-sigma",
    "focal": "--focal-sigma",
    "time": "--time-sigma",
    "mount": "--mount-sigma",
    "velocity": "--velocity-sigma",
    "wind": "--wind-sigma",
}
"""The option that states the standard deviation of a component of a deck's uncertainty."""
NO_EPOCH = "give [flight] epoch in the project, or --epoch"


def _formats() -> str:
    rows = [(one.name, " ".join(one.suffixes), one.about) for one in FORMATS.values()]
    return "\n".join(f"    {name:8} {suffixes:14} {about}" for name, suffixes, about in rows)


_HELP = """Write the attitude table: the angles of every frame, how sure they are, and flags.

SOURCE is a flight project, whose name ends in .toml (docs/flight-project.md), or
a deck of 80-column cards; - is a deck on standard input. The table has a row a
frame: the angles of camera and vehicle, the angles of attack alpha, beta and eta,
the position, the quaternion, standard deviations and flags. Every file states from
which axes to which its angles turn, their ranges, and which fixes are in force.

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

The table has all frames, also ignored ones, which have no angles; aem, acm, czml
and kml have the frames with an attitude, in order of time.
docs/attitude-files.md explains the columns.

Exit status: 0 the file is written; 1 a source could not be read or solved
(what comes before that is written), no frame has an attitude, or FILE cannot
be written; 2 wrong usage; 3 the file is written, but some frame did not
converge, a flight misfits, or with --strict some frame has a flag.
"""


@click.command("attitude", help=_HELP.format(formats=_formats()))
@sources_argument
@output_option("The file to write; by default standard output.")
@click.option(
    "--format",
    "form",
    type=click.Choice(list(FORMATS)),
    help="By default what FILE's suffix says; csv on standard output.",
)
@click.option(
    "--epoch",
    metavar="TIME",
    help="The moment of time zero, ISO 8601, UTC; aem, acm and czml need it.  "
    "[default: that of the project]",
)
@click.option(
    "--aem-version",
    type=click.Choice(["1", "2"]),
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
    help="Write a row a job instead: the mean attitude of its frames, and how sure that is; "
    "for csv, jsonl, npz and parquet.",
)
@history_options
@click.pass_context
def command(
    ctx: click.Context,
    /,
    sources: tuple[str, ...],
    output: str,
    form: str | None,
    epoch: str | None,
    mean: bool,
    options: SharedOptions,
    **names: Any,
) -> None:
    """Write the attitude table, or the attitude history in the format of another tool."""
    chosen = _format(output, form)
    if mean and chosen.name not in MEAN_FORMATS:
        raise click.UsageError(f"--mean is for {', '.join(MEAN_FORMATS)}, not {chosen.name}.")
    request = _request(chosen, epoch, names, any(map(is_flight, sources)))
    refuse_to_overwrite(sources, output)
    chosen.ready()
    if chosen.binary and output == "-" and sys.stdout.isatty():
        raise click.UsageError(f"{chosen.name} is binary: name a file with -o.")
    found = collect_jobs(sources, options, chosen.by_parts and not mean)
    request = _with_epoch(chosen, request, [job.head for job in found.jobs])
    messages = Messages(options.quiet)
    progress = Progress("frames written", total=sum(job.frames for job in found.jobs))
    jobs = [job.watched(progress.add) for job in found.jobs]
    with whole_file(output) as file:
        if mean:
            file.write(chosen.mean_table(jobs, request))
        else:
            for page in chosen.pages(jobs, request, messages):
                file.write(page)
    progress.close()
    if not options.quiet:
        means = [job.whole.mean() for job in found.jobs] if mean else []
        for sentence in _left_out([job.head for job in found.jobs], means):
            click.echo(sentence, err=True)
    ctx.exit(found.status(options, messages))


def _left_out(heads: Sequence[History], means: Sequence[MeanAttitude]) -> list[str]:
    """Say which errors the sigmas contain and which not, once for sources that are alike.

    Args:
        heads: the history of each job, or of its first frames
        means: the mean attitude of each, if that is written
    """
    sources: dict[str, dict[str, None]] = {}
    for one, mean in zip_longest(heads, means):
        keys = one.about.words.sigma_keys
        left = left_out_text(one, keys or SIGMA_OPTIONS, mean)
        told = f"the sigmas do not include errors of: {left}"
        if keys:
            told = f"the sigmas include errors of: {included_text(one, mean)}"
            told += f"; not included: {left}" * bool(left)
        if left or keys:
            sources.setdefault(told, {})[one.about.source] = None
    return [
        f"{next(iter(some))}{f' and {len(some) - 1} more' * (len(some) > 1)}: {told}"
        for told, some in sources.items()
    ]


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
    chosen: AttitudeFormat, request: FileRequest, histories: Sequence[History]
) -> FileRequest:
    """Add the epoch of the sources to the request if no option gives one.

    Raises:
        VopdError: where the format needs one and there is none
    """
    if request.epoch is not None:
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
    for name in given:
        if name not in chosen.options:
            option = "--" + name.replace("_", "-")
            takers = [one.name for one in FORMATS.values() if name in one.options]
            raise click.UsageError(f"{option} is for {', '.join(takers)}, not {chosen.name}.")
    if chosen.needs_epoch and epoch is None and not flights:
        raise click.UsageError(
            f"{chosen.name} needs dates: give the moment of time zero, "
            "for instance --epoch 1974-08-27T17:30:00Z."
        )
    values = _DEFAULTS | given
    values["aem_version"] = int(values["aem_version"])
    try:
        if "originator" in chosen.options:
            for name in ("originator", "object_name", "object_id"):
                text_value(values[name])
        zero = None if epoch is None else parse_epoch(epoch)
    except VopdError as error:
        raise click.UsageError(f"{error}.") from error
    return FileRequest(epoch=zero, created=created_now(), **values)
