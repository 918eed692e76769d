"""The table of `vopd adjust`: parameters before and after, as text, CSV and JSON."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Floats
from vopd.findings import count_text
from vopd.scene import Change
from vopd.screen import aligned

if TYPE_CHECKING:
    from vopd.flight.adjust.adjustment import Adjustment, Parameter
    from vopd.flight.result import FlightResult

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
NOT_STATED = "none"
SHOWN = 0.3  # correlation in a text: the other formats have all


def as_text(made: Adjustment, correlations: bool) -> str:
    """Write the table for reading."""
    head = [name.replace("_", " ") for name in COLUMNS]
    lines = [_solved_text(made)]
    if made.parameters:
        lines += ["", *aligned([head, *map(text_row, made.parameters)], {0, 1, 7, 8})]
    if correlations:
        lines += ["", *_pairs(made)]
    return "\n".join(lines) + "\n"


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
    sigma = "" if reading is None else f", reading sigma {reading.sigma:.3g} px"
    picks = count_text(int(result.estimates.solved.used.sum()), "pick")
    return f"{result.flight.source}: {frames}, {picks}{sigma}"


def text_row(one: Parameter) -> list[str]:
    """Write the cells of a row, by `COLUMNS`."""
    from vopd.flight.solve.free import decimals

    digits = decimals(one.sigma_after)
    before, after = (f"{value:.{digits}f}" if digits is not None else f"{value:.7g}"
                     for value in (one.before, one.after))  # fmt: skip
    sigmas = [
        f"{sigma:.2g}" if isfinite(sigma) else NOT_STATED
        for sigma in (one.sigma_before, one.sigma_after)
    ]
    kept = not one.held and one.after == one.before
    moved = f"{one.moved:+.1f}" if isfinite(one.moved) and not kept else "-"
    held = "held" if one.held else "not held" + ": kept" * kept
    return [
        one.name, one.unit or "-", before, after, *sigmas, moved, held,
        ", ".join(one.trades_with) or "-",
    ]  # fmt: skip


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


# Parameters and residuals before and after, for a figure


def changes(made: Adjustment) -> list[Change]:
    """List the parameters before and after, in the standard deviations that were stated.

    Args:
        made: the adjustment; of a parameter without a stated one, in that after the solve
    """
    found = []
    for one in made.parameters:
        _, _, before, after, _, sigma, _, held, trades = text_row(one)
        unit = one.unit and f" {one.unit}"
        told = f"{before} → {after} ± {sigma}{unit}"
        if held.endswith("kept"):
            told = f"{before}{unit}" + f", trades with {trades}" * (trades != "-")
        stated = isfinite(one.sigma_before) and one.sigma_before > 0.0
        unit_sigma = one.sigma_before if stated else one.sigma_after
        moved = float("nan") if held.endswith("kept") else one.moved
        name = one.name.removeprefix("landmark:")
        found.append(Change(name, told, moved, one.sigma_after / unit_sigma, stated))
    return found


def residual_sizes(made: Adjustment) -> tuple[tuple[str, ...], Floats]:
    """Measure the residuals with all parameters as stated, and as solved.

    Returns:
        Names of the landmarks, and the root mean square of a residual's coordinates before and
        after, of each landmark and of all, pixels, (M + 1, 2); NaN: it has none.
    """
    from vopd.flight.result import FlightResult, settled, with_named_picks

    result = made.result
    stated, joint = result, result.estimates.joint
    if any(one.after != one.before for one in made.parameters):
        assert joint is not None
        read = replace(result.read, options=replace(result.read.options, free=(), kept=()))
        before = settled(read, ~joint.model.used)
        if not read.options.drop_blunders:
            before = with_named_picks(read, before, before)
        stated = FlightResult(before, ())
    sizes = [_sizes(one) for one in (stated, result)]
    return result.flight.landmarks.name, np.stack(sizes, axis=1)


def _sizes(result: FlightResult) -> Floats:
    """Find the root mean square of the residuals of picks that are used, (M + 1,)."""
    scene = result.estimates.scene()
    views = scene.views(np.arange(len(scene.camera_m))) if scene.views is not None else None
    assert views is not None
    square = ((views.pixel - views.fitted) ** 2).sum(axis=1) / 2.0
    here = views.used & np.isfinite(square)
    marks = len(scene.names)
    count = np.bincount(views.landmark[here], minlength=marks)
    total = np.bincount(views.landmark[here], square[here], minlength=marks)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.sqrt(np.append(total, total.sum()) / np.append(count, count.sum())))
