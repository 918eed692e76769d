"""Write a table that is no attitude history, such as that of star photographs."""

from __future__ import annotations

from vopd.attitude.table_values import TableArrays
from vopd.export import FORMATS
from vopd.export.json_lines import Described, json_lines
from vopd.export.npz import archive
from vopd.export.parquet import table_file

WRITERS = {"jsonl": json_lines, "npz": archive, "parquet": table_file}
"""The formats that hold any table, by their names in `vopd.export.FORMATS`."""


def render_table(
    form: str, values: TableArrays, stated: dict[str, str], columns: Described
) -> bytes:
    """Make the content of a file.

    Args:
        form: of WRITERS
        values: an array for each column
        stated: the conventions
        columns: unit and meaning of each column

    Raises:
        VopdError: where a package that the format needs is not installed.
    """
    FORMATS[form].ready()
    return WRITERS[form](values, stated, columns)
