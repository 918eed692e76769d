"""The table of `vopd adjust`: parameters before and after, as text, CSV and JSON."""

from __future__ import annotations

import csv
import io
import json
from math import isfinite
from typing import TYPE_CHECKING

from vopd.findings import count_text, size_text
from vopd.flight.parameters import text_row
from vopd.flight.solve.free import decimals
from vopd.geometry.lenses import Lenses
from vopd.screen import aligned

if TYPE_CHECKING:
    from vopd.flight.adjust.adjustment import Adjustment
    from vopd.flight.parameters import Parameter

COLUMNS = (
    "parameter",
    "unit",
    "before",
    "after",
    "sigma_before",
    "sigma_after",
    "moved_sigmas",
    "held",
    "trades_with",
)
"""Of the table as CSV and JSON; the text has blanks for underscores."""
SHOWN = 0.3  # correlation in a text: the other formats have all


def as_text(made: Adjustment, correlations: bool) -> str:
    """Write the table for reading."""
    head = [name.replace("_", " ") for name in COLUMNS]
    lines = [_solved_text(made)]
    if made.parameters:
        lines += ["", *aligned([head, *map(text_row, made.parameters)], {0, 1, 7, 8})]
        lines += _focal_lengths(made)
    if correlations:
        lines += ["", *_pairs(made)]
    return "\n".join(lines) + "\n"


def _focal_lengths(made: Adjustment) -> list[str]:
    """Say what fx and fy are where they change by two parameters, one after the other."""
    if not any(one.name == "aspect" and one.held for one in made.parameters):
        return []
    sigma_px = [one.sigma_after for one in made.parameters if one.name == "focal" and one.held]
    digits = decimals(sigma_px[0]) if sigma_px else None
    lens = made.result.flight.lens
    px = (f"{one:.7g}" if digits is None else f"{one:.{digits}f}" for one in lens.focal_px.tolist())
    first = " of the first lens" if isinstance(lens, Lenses) else ""
    also = "focal is the mean of fx and fy before aspect scales fy; " if sigma_px else ""
    return ["", "{}as solved{} fx is {} px and fy {} px".format(also, first, *px)]


def _pairs(made: Adjustment) -> list[str]:
    """List the pairs that are correlated most, strongest first."""
    names, found = [one.name for one in made.parameters], []
    for k, row in enumerate(made.correlation.tolist()):
        found += [(abs(row[j]), k, j, row[j]) for j in range(k) if abs(row[j]) >= SHOWN]
    found.sort(key=lambda pair: (-pair[0], pair[1:]))
    if not found:
        return [f"no correlation is above {SHOWN:g}"]
    rows = [["correlation", "", ""], *([f"{r:+.3f}", names[j], names[k]] for _, k, j, r in found)]
    return [
        *aligned(rows, {0, 1, 2}),
        f"(of parameters after the solve; those below {SHOWN:g} are left out)",
    ]


def _solved_text(made: Adjustment) -> str:
    result = made.result
    frames = count_text(int(result.solved.sum()), "frame")
    reading = result.estimates.reading
    sigma = "" if reading is None else f", reading sigma {size_text(reading.sigma, 3)} px"
    picks = count_text(int(result.estimates.solved.used.sum()), "pick")
    return f"{result.flight.source}: {frames}, {picks}{sigma}"


def _row(one: Parameter) -> list[object]:
    """Take the values of a row; None where there is none."""
    numbers = (one.before, one.after, one.sigma_before, one.sigma_after, one.moved)
    values = [value if isfinite(value) else None for value in numbers]
    return [one.name, one.unit, *values, one.held, list(one.trades_with)]


def as_csv(made: Adjustment, correlations: bool) -> str:
    """Write the table as CSV; an empty cell is none."""
    names = [f"correlation {one.name}" for one in made.parameters] if correlations else []
    page = io.StringIO()
    writer = csv.writer(page, lineterminator="\n")
    writer.writerow([*COLUMNS, *names])
    for one, row in zip(made.parameters, made.correlation.tolist(), strict=True):
        *values, held, trades = _row(one)
        more = [value if isfinite(value) else "" for value in row] if correlations else []
        writer.writerow([*values, "yes" if held else "no", "; ".join(trades), *more])  # type: ignore[arg-type]
    return page.getvalue()


def as_json(made: Adjustment, correlations: bool, tests: object = None) -> str:
    """Write the table as JSON; null is none.

    Args:
        made: the adjustment
        correlations: whether the matrix is there
        tests: those of leaving out; None: there are none
    """
    result = made.result
    reading = result.estimates.reading
    table: dict[str, object] = {
        "source": result.flight.source,
        "frames": int(result.solved.sum()),
        "picks": int(result.estimates.solved.used.sum()),
        "reading_sigma_px": None if reading is None else reading.sigma,
        "misfits": result.misfits,
        "warnings": [one.message for one in result.findings],
        "parameters": [dict(zip(COLUMNS, _row(one), strict=True)) for one in made.parameters],
    }
    if correlations:
        table["correlations"] = [
            [value if isfinite(value) else None for value in row]
            for row in made.correlation.tolist()
        ]
    if tests is not None:
        table["tests"] = tests
    return json.dumps(table, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
