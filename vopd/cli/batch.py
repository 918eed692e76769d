"""`vopd batch`: solve many decks and flights into one folder."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from vopd.cli.console import Progress
from vopd.cli.options import (
    FILE_NAME,
    FOLDER_NAME,
    SharedOptions,
    WholeRange,
    history_options,
    tell_unused,
)
from vopd.export import FORMATS
from vopd.findings import count_text

if TYPE_CHECKING:  # its help does not wait for what solves
    from vopd.batch.folder import SourceRecord

FAILED_SHOWN = 20
NO_DATES = tuple(one.name for one in FORMATS.values() if not one.needs_epoch)
"""The formats that need no date; a date belongs to one source, not to a batch."""


def _shard(ctx: click.Context, option: click.Parameter, text: str | None) -> tuple[int, int]:
    if text is None:
        return 1, 1
    parts = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text, re.ASCII)
    if parts is None or not 1 <= int(parts[1]) <= int(parts[2]):
        raise click.BadParameter(f"{text!r} is not I/N with I from 1 to N, for instance 2/10.")
    return int(parts[1]), int(parts[2])


def _jobs(ctx: click.Context, option: click.Parameter, jobs: int) -> int:
    """Let processes load the package while this one does, which begins after the last option."""
    if jobs > 1 and not ctx.resilient_parsing:
        from vopd.batch.workers import load_ahead

        load_ahead()
    return jobs


@click.command("batch")
@click.argument("sources", type=FILE_NAME, metavar="SOURCE...", nargs=-1)
@click.option(
    "-d",
    "--directory",
    "folder",
    type=FOLDER_NAME,
    metavar="OUTDIR",
    required=True,
    help="The folder for all outputs; it is made if it does not exist.",
)
@click.option(
    "--manifest",
    type=FILE_NAME,
    metavar="FILE",
    help="A text file with a source on each line, relative to the file's own folder.",
)
@click.option(
    "--format",
    "formats",
    type=click.Choice(NO_DATES),
    multiple=True,
    help="Format of the attitude tables; repeatable.  [default: csv]",
)
@click.option(
    "--report",
    is_flag=True,
    help="Also write index.html, and a page for each source with a flag, a misfit or a failure.",
)
@click.option("--report-all", is_flag=True, help="The same, with a page for every source.")
@click.option(
    "--jobs",
    type=WholeRange(1, 1024),
    default=1,
    show_default=True,
    metavar="N",
    callback=_jobs,
    help="Number of processes.",
)
@click.option(
    "--shard",
    callback=_shard,
    metavar="I/N",
    help="Solve part I of N only; the parts may run at the same time, on several machines.",
)
@click.option(
    "--dask",
    metavar="ADDRESS",
    help="Solve on the cluster of this dask.distributed scheduler, such as tcp://10.0.0.1:8786.",
)
@click.option(
    "--shared-filesystem",
    "shared",
    is_flag=True,
    help="With --dask: the workers see the sources and OUTDIR under the same paths.",
)
@click.option("--resume", is_flag=True, help="Continue a batch that ended early.")
@history_options
@click.pass_context
def command(
    ctx: click.Context,
    /,
    sources: tuple[str, ...],
    folder: str,
    manifest: str | None,
    formats: tuple[str, ...],
    report: bool,
    report_all: bool,
    jobs: int,
    shard: tuple[int, int],
    dask: str | None,
    shared: bool,
    resume: bool,
    options: SharedOptions,
) -> None:
    """Solve many decks and flights, and write the attitude table of each.

    SOURCE is a deck, a flight project (.toml), a pattern in quotes such as
    'flights/*/flight.toml', or a folder, of which all .dat, .deck, .cards and
    .toml files are taken. OUTDIR gets the files of each source under its name: the
    attitude table and, for a deck, the listing. It also gets summary.jsonl (with
    pyarrow also summary.parquet), which has a row for each source.

    \b
    Examples:
        vopd batch decks/appendix_h -d solved
        vopd batch 'flights/*/flight.toml' -d solved --jobs 4 --format parquet
        vopd batch --manifest list.txt -d solved --shard 2/10

    --resume continues a batch that was killed. It solves again the sources that
    failed, and those whose input, options or outputs have changed.

    Exit status: 0 all well; 1 no source could be solved, or an output could not be
    written; 2 wrong usage; 3 some source failed, some frame did not converge, a
    flight misfits, or with --strict some frame has a flag.
    """
    chosen = tuple(dict.fromkeys(formats)) or ("csv",)
    if not sources and manifest is None:
        raise click.UsageError("name a SOURCE, or a --manifest.")
    if dask is not None and jobs > 1:
        raise click.UsageError("--jobs is for this machine, --dask for a cluster: give one.")
    if shared and dask is None:
        raise click.UsageError("--shared-filesystem is for --dask.")
    for form in chosen:
        FORMATS[form].ready()
    if report or report_all:
        from vopd.report import check_ready

        check_ready()
    from vopd.batch.folder import BatchFolder, summary_text, write_summary
    from vopd.batch.sources import BatchSettings, find_sources
    from vopd.batch.workers import run_batch

    number, count = shard
    place = BatchFolder(folder, number, count)
    settings = BatchSettings(
        folder=folder,
        working=str(place.working),
        solve=options.solve,
        history=options.history,
        formats=chosen,
        report="all" if report_all else "flagged" if report else "",
    )
    plan = find_sources(sources, manifest, folder, settings.suffixes)
    tell_unused([one.path for one in plan], options.quiet)
    mine = plan[number - 1 :: count]
    if not mine:
        if not options.quiet:
            has = f"part {number} of {count} is empty: {count_text(len(plan), 'source')} in all"
            click.echo(has, err=True)
        return
    with place.begun(resume, settings.options) as earlier:
        progress = Progress(
            "sources", total=len(mine), stopped="the same command with --resume goes on"
        )
        try:
            records = run_batch(
                mine, settings, place, earlier, progress.add,
                jobs=jobs, dask=dask, shared=shared, warn=partial(click.echo, err=True),
            )  # fmt: skip
        finally:
            progress.close()
        last = place.finish(plan, settings.options, partial(write_summary, settings))
    click.echo(summary_text(records), nl=False)
    if not last and not options.quiet:
        click.echo(
            f"part {number} of {count} is finished; the part that ends last writes "
            f"{Path(folder) / 'summary.jsonl'}",
            err=True,
        )
    ctx.exit(_status(records, options))


def _status(records: Sequence[SourceRecord], options: SharedOptions) -> int:
    """List failed sources on standard error, and find the exit status."""
    from vopd.batch.folder import FAILED, MISFITS, UNCONVERGED

    failed = [one for one in records if one.status == FAILED]
    for one in failed[:FAILED_SHOWN]:
        click.echo(one.error, err=True)
    if len(failed) > FAILED_SHOWN:
        more = count_text(len(failed) - FAILED_SHOWN, "more source")
        click.echo(f"{more} failed; summary.jsonl says why", err=True)
    if records and len(failed) == len(records):
        return 1
    doubtful = options.doubtful(
        sum(one.flagged for one in records), sum(one.mistaken for one in records),
        sum(one.errata for one in records), sum(one.unread for one in records),
    )  # fmt: skip
    unsure = any(one.status in (UNCONVERGED, MISFITS) for one in records)
    return 3 if failed or unsure or doubtful else 0
