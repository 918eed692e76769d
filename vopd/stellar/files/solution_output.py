"""Solutions as text, JSON and CSV."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from typing import Any

from vopd.stellar.files.star_file import StarFile
from vopd.stellar.interstar_angles import star_disagreement_arcsec
from vopd.stellar.methods.run_methods import SolvedField
from vopd.stellar.star_field import StarField


def as_json(records: Sequence[SolvedField]) -> str:
    """One array of solutions, every number to its last digit."""
    solutions = [json.dumps(record.as_dict(), allow_nan=False) for record in records]
    return "[\n" + ",\n".join(solutions) + "\n]\n"


CSV_COLUMNS = (
    "method",
    "stars",
    "omega_deg",
    "phi_deg",
    "kappa_deg",
    "alpha_deg",
    "delta_deg",
    "swing_deg",
    *(f"m{i}{j}" for i in (1, 2, 3) for j in (1, 2, 3)),
    "orthogonality_defect",
    "rms_mm",
    "residuals_mm",
    "iterations",
    "converged",
    "axis_x",
    "axis_y",
    "axis_z",
    "angle_deg",
    "conditioning",
    "interstar_discrepancy_arcsec",
    "disagreement_arcsec",
    "weights",
)


def as_csv(records: Sequence[SolvedField]) -> str:
    """A line a solution; lists (stars, residuals, ...) are one cell, spaces between."""
    page = io.StringIO()
    writer = csv.DictWriter(page, CSV_COLUMNS, lineterminator="\n", restval="")
    writer.writeheader()
    for record in records:
        row = record.as_dict()
        for i, elements in enumerate(row.pop("matrix"), start=1):
            row.update({f"m{i}{j}": value for j, value in enumerate(elements, start=1)})
        if "axis" in row:
            row.update(zip(("axis_x", "axis_y", "axis_z"), row.pop("axis"), strict=True))
        row["rms_mm"] = record.rms_mm
        row["converged"] = str(record.converged).lower()
        writer.writerow({name: _cell(value) for name, value in row.items()})
    return page.getvalue()


def as_text(records: Sequence[SolvedField], file: StarFile, stars: StarField) -> str:
    """A table of the attitudes; of a single one its matrix and residuals too."""
    pages = [_table(records)] if records else []
    if len(records) == 1:
        pages.append(_details(records[0], file))
    if any("disagreement_arcsec" in record.values for record in records):
        pages.append(_disagreements(file, stars))
    return "\n".join(pages)


def _table(records: Sequence[SolvedField]) -> str:
    angles = ("omega", "phi", "kappa", "alpha", "delta", "swing")
    lines = [f"{'method':<16} {'stars':<9}" + "".join(f" {name + ' deg':>12}" for name in angles)]
    lines[0] += f" {'rms mm':>9}"
    extras: list[tuple[str, str, str]] = [
        ("conditioning", "sin(D1,D2)", ".3f"),
        ("interstar_discrepancy_arcsec", "discr. sec", ".2f"),
    ]
    shown = [extra for extra in extras if any(extra[0] in record.values for record in records)]
    lines[0] += "".join(f" {title:>10}" for _, title, _ in shown)
    for record in records:
        numbers = (*record.omega_phi_kappa_deg, *record.alpha_delta_swing_deg)
        line = f"{record.method:<16} {_stars(record.stars):<9}"
        line += "".join(f" {number:12.7f}" for number in numbers) + f" {record.rms_mm:9.5f}"
        for name, _, form in shown:
            value = record.values.get(name)
            line += f" {'' if value is None else format(value, form):>10}"
        lines.append(line.rstrip() + ("" if record.converged or record.iterations == 0 else "  *"))
    if any(record.iterations and not record.converged for record in records):
        lines.append("* the last correction still moved an image")
    return "\n".join(lines) + "\n"


def _details(record: SolvedField, file: StarFile) -> str:
    lines = [f"matrix, as solved (orthogonality defect {record.orthogonality_defect:.1e})"]
    lines += ["".join(f" {element:15.10f}" for element in row) for row in record.matrix]
    if record.iterations:
        lines += ["", f"{record.iterations} corrections"]
    if "axis" in record.values:
        axis = " ".join(f"{component:.10f}" for component in record.values["axis"])
        lines += ["", f"one rotation: {record.values['angle_deg']:.7f} degrees about {axis}"]
    weights = record.values.get("weights")
    lines += ["", "residuals, observed minus computed" + (", and weights" if weights else "")]
    lines.append(f"{'star':>6} {'x mm':>11} {'y mm':>11}")
    for k, (star, residual) in enumerate(zip(record.stars, record.residuals_mm, strict=True)):
        line = f"{star:6d}" + "".join(f" {value:11.6f}" for value in residual)
        if weights:
            line += "".join(f" {value:11.3g}" for value in weights[k])
        lines.append(f"{line}  {file.names[star - 1]}".rstrip())
    return "\n".join(lines) + "\n"


def _disagreements(file: StarFile, stars: StarField) -> str:
    total, median = star_disagreement_arcsec(stars)
    lines = [
        "disagreement of each star with the others: celestial minus photographed angles,",
        "their sizes added up, and their median, seconds of arc",
        f"{'star':>6} {'sum':>12} {'median':>12}",
    ]
    for k, name in enumerate(file.names):
        lines.append(f"{k + 1:6d} {total[k]:12.2f} {median[k]:12.2f}  {name}".rstrip())
    return "\n".join(lines) + "\n"


def _stars(stars: Sequence[int]) -> str:
    if len(stars) > 4 and list(stars) == list(range(stars[0], stars[-1] + 1)):
        return f"{stars[0]}-{stars[-1]}"
    return ",".join(map(str, stars))


def _cell(value: Any) -> Any:
    if isinstance(value, list):
        return " ".join(str(_cell(item)) for item in value)
    return value
