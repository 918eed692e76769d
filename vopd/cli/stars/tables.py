"""`vopd stars tables`: the tables and figures of the report, recomputed."""

from __future__ import annotations

import click

from vopd.cli.file_options import output_option
from vopd.cli.output import whole_file


@click.command("tables", short_help="Print the report's tables and figures, recomputed.")
@output_option("Write the output to this file.")
def tables(output: str) -> None:
    """Print the report's tables 6.1 to 6.5 and the values of figures 6.1 to 6.3.

    Each is computed from the sample data, with what the report printed beneath
    it where that is legible; * and + mark where the two differ, and the notes
    under a table say why. The figures and table 6.5 are lost in the scan: what
    stands here is recomputed, for all six pairs of stars.
    """
    from vopd.stellar.rae1987.recomputed_tables import tables as compute
    from vopd.stellar.rae1987.table_text import as_text

    with whole_file(output) as page:
        page.write("\n".join(as_text(table) for table in compute()).encode())
