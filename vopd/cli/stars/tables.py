"""`vopd stars tables`: the tables and figures of the report, recomputed."""

from __future__ import annotations

from pathlib import PurePath

import click

from vopd.cli.options import output_option
from vopd.cli.output import refuse_to_overwrite
from vopd.cli.stars.solve import PICTURES
from vopd.files import whole_file

FIGURE_SUFFIXES = (".png", ".svg", ".pdf")


@click.command("tables", short_help="Print the report's tables and figures, recomputed.")
@output_option("Write the output to this file; a .png, .svg or .pdf has the figures drawn.")
def tables(output: str) -> None:
    """Print the report's tables 6.1 to 6.5 and the values of figures 6.1 to 6.3.

    Each is computed from the sample data, with the report's number beneath it
    where that is legible. * and + mark differences; the notes under a table explain
    them. The scan lost the figures and table 6.5: these are recomputed, for all six
    pairs of stars.

    With -o FILE.png, .svg or .pdf the figures are drawn instead, by matplotlib.

    \b
    Examples:
      vopd stars tables
      vopd stars tables -o figures.pdf

    Exit status: 0 all well; 1 the file cannot be written; 2 wrong usage.
    """
    suffix = PurePath(output).suffix.lower()
    if suffix in PICTURES and suffix not in FIGURE_SUFFIXES:
        raise click.UsageError(f"{output}: the figures are written as .png, .svg or .pdf.")
    refuse_to_overwrite((), output)
    content = _figures(suffix) if suffix in FIGURE_SUFFIXES else _tables()
    with whole_file(output) as page:
        page.write(content)


def _tables() -> bytes:
    from vopd.stellar.tables_1987 import as_text
    from vopd.stellar.tables_1987 import tables as compute

    return "\n".join(map(as_text, compute())).encode()


def _figures(suffix: str) -> bytes:
    from vopd.figures.stars import draw_errors_by_pair
    from vopd.figures.style import save
    from vopd.stellar.tables_1987 import FIGURE_ANGLES, FIGURE_TITLE, figure_errors

    pairs, methods, errors = figure_errors()
    panels = {
        FIGURE_TITLE.format(number=k + 1, name=name): errors[:, :, k]
        for k, name in enumerate(FIGURE_ANGLES)
    }
    return save(draw_errors_by_pair(pairs, methods, panels), suffix)
