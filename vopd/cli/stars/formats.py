"""The formats in which `vopd stars solve` writes attitudes."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import PurePath
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from vopd.findings import Report
    from vopd.stellar.files.solved_photograph import SolvedPhotograph
    from vopd.stellar.files.star_request import StarRequest

SOLUTION_FORMATS = ("text", "json", "csv", "jsonl", "npz", "parquet", "aem", "czml")
SUFFIXES = {
    ".json": "json", ".csv": "csv", ".jsonl": "jsonl", ".ndjson": "jsonl", ".npz": "npz",
    ".parquet": "parquet", ".pq": "parquet", ".aem": "aem", ".czml": "czml",
}  # fmt: skip
BINARY = ("npz", "parquet")
PICTURES = (".png", ".svg", ".pdf", ".jpg", ".jpeg", ".gif", ".tif", ".tiff")


def format_of(output: str, form: str | None) -> str:
    """The format of the output: as asked for, or by the suffix of its name.

    Raises:
        click.UsageError: it is binary, and would go to a terminal, or FILE is a picture.
    """
    suffix = PurePath(output).suffix.lower()
    if form is None and suffix in PICTURES:
        raise click.UsageError(
            f"{output}: write the solution to a .json, and vopd plot draws its residuals."
        )
    form = form or SUFFIXES.get(suffix, "text")
    if form in BINARY and output == "-" and sys.stdout.isatty():
        raise click.UsageError(f"{form} is binary: name a file with -o.")
    return form


def render(
    form: str, photographs: Sequence[SolvedPhotograph], request: StarRequest, report: Report
) -> bytes:
    """The content of the output.

    Args:
        form: of SOLUTION_FORMATS
        photographs: what was solved
        request: what was asked for
        report: takes warnings

    Raises:
        VopdError: where a package that the format needs is not installed.
    """
    if form in ("text", "json", "csv"):
        from vopd.stellar.files.solve import solution_text

        return solution_text(photographs, form, request).encode()
    if form in ("aem", "czml"):
        from vopd.cli.stars.dated_files import render_dated

        return render_dated(form, photographs, request.sky, report)
    from vopd.export.plain_table import render_table
    from vopd.stellar.files.solution_table import solution_table

    table = solution_table(photographs)
    return render_table(form, table.values, table.conventions, table.columns)
