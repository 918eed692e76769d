"""Carry out `vopd batch`: find the sources, solve them, and say how they ended."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import click

from vopd.batch.folder import BatchFolder
from vopd.batch.outputs import summary_text, write_summary
from vopd.batch.run import ClusterRequest, run_batch
from vopd.batch.settings import BatchSettings
from vopd.batch.source_record import FAILED, UNCONVERGED, SourceRecord
from vopd.batch.sources import BatchSource, Shard, find_sources
from vopd.cli.console import Progress
from vopd.cli.options import HistoryOptions

FAILED_SHOWN = 20


class BatchRequest(NamedTuple):
    """The arguments of `vopd batch`, besides those that several commands share."""

    sources: tuple[str, ...]
    manifest: str | None
    folder: str
    shard: tuple[int, int]
    jobs: int
    formats: tuple[str, ...]
    report: bool
    dask: str | None
    shared: bool
    resume: bool


def solve_batch(request: BatchRequest, asked: HistoryOptions) -> int:
    """Solve a batch, and print its summary and its errors.

    Args:
        request: what is to be solved and written
        asked: how

    Returns:
        The exit status of the command.
    """
    shard = Shard(*request.shard)
    place = BatchFolder(request.folder, shard)
    settings = BatchSettings(
        folder=request.folder,
        working=str(place.working),
        solve=asked.solve,
        sigmas=asked.sigmas,
        max_rate_deg_s=asked.max_rate_deg_s,
        vertical=asked.vertical,
        formats=request.formats,
        report=request.report,
    )
    plan = find_sources(request.sources, request.manifest, request.folder, settings.suffixes)
    records, last = _run(plan, settings, place, request)
    click.echo(summary_text(records), nl=False)
    if not last and not asked.quiet:
        click.echo(
            f"part {shard.number} of {shard.count} is finished; the part that ends last writes "
            f"{Path(request.folder) / 'summary.jsonl'}",
            err=True,
        )
    return _status(records, asked)


def _run(
    plan: Sequence[BatchSource],
    settings: BatchSettings,
    place: BatchFolder,
    request: BatchRequest,
) -> tuple[list[SourceRecord], bool]:
    """Solve the sources of this shard; also returns whether it ended last."""
    mine = place.shard.part(plan)
    cluster = None
    if request.dask is not None:
        cluster = ClusterRequest(request.dask, request.shared, _warn)
    with place.begun(request.resume, settings.options) as earlier:
        progress = Progress("sources", total=len(mine))
        try:
            records = run_batch(mine, settings, place, earlier, request.jobs, progress.add, cluster)
        finally:
            progress.close()

        def write(rows: list[SourceRecord]) -> None:
            write_summary(settings, rows)

        return records, place.finish(plan, settings.options, write)


def _warn(message: str) -> None:
    click.echo(message, err=True)


def _status(records: Sequence[SourceRecord], asked: HistoryOptions) -> int:
    """The exit status; failed sources are listed on standard error."""
    failed = [one for one in records if one.status == FAILED]
    for one in failed[:FAILED_SHOWN]:
        click.echo(one.error, err=True)
    if len(failed) > FAILED_SHOWN:
        more = len(failed) - FAILED_SHOWN
        click.echo(f"{more} more sources failed; summary.jsonl says why", err=True)
    if records and len(failed) == len(records):
        return 1
    doubtful = any(one.status == UNCONVERGED or (asked.strict and one.flagged) for one in records)
    return 3 if failed or doubtful else 0
