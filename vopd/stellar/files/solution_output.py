"""Solutions as JSON and CSV."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence

from vopd.stellar.files.solution_table import columns_of, rows_of
from vopd.stellar.files.solved_photograph import SolvedPhotograph


def as_json(photographs: Sequence[SolvedPhotograph]) -> str:
    """The solutions as a JSON array; numbers have all their digits."""
    solutions = []
    for photograph in photographs:
        image = {"image": photograph.label} if photograph.label else {}
        for one in photograph.solved:
            names = [photograph.file.names[star - 1] for star in one.stars]
            row = image | one.as_dict(photograph.file.unit)
            row |= {"names": names} if any(names) else {}
            row |= {"epoch": photograph.epoch} if photograph.epoch else {}
            solutions.append(json.dumps(row, allow_nan=False))
    return "[\n" + ",\n".join(solutions) + "\n]\n"


def as_csv(photographs: Sequence[SolvedPhotograph]) -> str:
    """The solutions as CSV, one line each; a list (stars, residuals) is one cell with spaces."""
    page = io.StringIO()
    columns = [column.name for column in columns_of(photographs)]
    writer = csv.DictWriter(page, columns, lineterminator="\n", restval="")
    writer.writeheader()
    writer.writerows(rows_of(photographs))
    return page.getvalue()
