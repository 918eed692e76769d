"""The report's tables 6.1 to 6.5 and figures 6.1 to 6.3, computed, beside what it printed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.sexagesimal import format_dms
from vopd.stellar.directions import image_directions
from vopd.stellar.interstar_angles import star_pairs
from vopd.stellar.methods.church import church
from vopd.stellar.methods.collinearity import collinearity
from vopd.stellar.methods.single_rotation import single_rotation
from vopd.stellar.methods.two_star import two_star
from vopd.stellar.rae1987 import printed_tables, sample_data
from vopd.stellar.rae1987.radec2 import radec2
from vopd.stellar.rae1987.truopk import truopk
from vopd.stellar.rae1987.tustar import tustar
from vopd.stellar.star_solution import StarSolution


@dataclass(frozen=True)
class ReportRow:
    """One row of a table: what was computed and, where it is legible, what was printed."""

    label: str
    computed: Sequence[str]
    printed: Sequence[str] = ()
    marks: Sequence[str] = ()


@dataclass(frozen=True)
class ReportTable:
    """A table of the report; `notes` say what the marks in it mean."""

    title: str
    columns: Sequence[str]
    rows: Sequence[ReportRow]
    notes: Sequence[str] = ()


def tables() -> list[ReportTable]:
    """All of them, in the report's order; errors have the sign of table 6.4."""
    return [
        _stars("6.1", "Error-free images", sample_data.EXACT_MM, printed_tables.TABLE_6_1),
        _direction_cosines(),
        _stars("6.3", "Perturbed images", sample_data.PERTURBED_MM, printed_tables.TABLE_6_3),
        _errors(),
        _rotations(),
        *_figures(),
        _as_listed(),
    ]


def _stars(
    number: str, title: str, image_mm: Floats, rows: Sequence[tuple[str, ...]]
) -> ReportTable:
    """Stars as RADEC2 makes them from the error-free images; images as given."""
    made = radec2(sample_data.EXACT_MM, sample_data.FOCAL_LENGTH_MM, sample_data.TRUTH_DEG)
    computed = [
        [format_dms(ra, 4), format_dms(dec, 4), f"{x:.3f}", f"{y:.3f}"]
        for ra, dec, (x, y) in zip(made.ra_deg, made.dec_deg, image_mm, strict=True)
    ]
    return ReportTable(
        f"Table {number}. {title}; stars by RADEC2, principal distance 76 mm",
        ("right ascension", "declination", "x mm", "y mm"),
        [
            ReportRow(f"star {row[0]}", new, row[1:5])
            for new, row in zip(computed, rows, strict=True)
        ],
    )


def _direction_cosines() -> ReportTable:
    made = radec2(sample_data.EXACT_MM, sample_data.FOCAL_LENGTH_MM, sample_data.TRUTH_DEG)
    photo = image_directions(sample_data.PERTURBED_MM, sample_data.FOCAL_LENGTH_MM)
    values = np.concatenate([made.directions, photo], axis=-1)
    names = ("U", "V", "W", "P", "Q", "R")
    rows = [
        _row("6.2", row[0], f"star {row[0]}", numbers, names, 10, row[1:])
        for numbers, row in zip(values.tolist(), printed_tables.TABLE_6_2, strict=True)
    ]
    title = "Table 6.2. Direction cosines of the stars and of the perturbed images"
    return ReportTable(title, names, rows, _notes("6.2"))


def _errors() -> ReportTable:
    field = sample_data.sample_field()
    solutions = {
        "collinearity": collinearity(field),
        "church-weighted": church(field, formula_weights=True),
        "church": church(field),
    }
    names = ("omega", "phi", "kappa")
    rows = [
        _row("6.4", row[0], row[0], _error(solutions[row[0]]).tolist(), names, 7, row[1:])
        for row in printed_tables.TABLE_6_4
    ]
    early = collinearity(field, initial_deg=EARLY_START_DEG, corrections=LAST_PRINTED)
    start, error = (
        ", ".join(form.format(value) for value in values)
        for form, values in (("{:.0f}", EARLY_START_DEG), ("{:.4f}", _error(early)))
    )
    notes = [
        *_notes("6.4"),
        "+ one unit off. STARS prints the angles before each of its four corrections: those",
        f"  after three come last. From {start}, say, their errors are {error}.",
    ]
    title = "Table 6.4. Errors of the angles, truth minus estimate, degrees"
    return ReportTable(title, names, rows, notes)


def _rotations() -> ReportTable:
    pairs = star_pairs(len(sample_data.DIRECTIONS))
    solution = single_rotation(sample_data.sample_field().select(pairs))
    assert solution.axis is not None
    assert solution.angle_deg is not None
    assert solution.conditioning is not None
    values = np.column_stack([solution.axis, solution.angle_deg, solution.conditioning])
    rows = [
        ReportRow(_pair(pair), [f"{v:.8f}" for v in value[:4]] + [f"{value[4]:.2f}"])
        for pair, value in zip(pairs, values.tolist(), strict=True)
    ]
    columns = ("XR", "YR", "ZR", "angle, deg", "sin(D1,D2)")
    lost = "The report's values are lost in the scan. sin(D1,D2) is not among them."
    title = "Table 6.5. Rotation axes and angles of the single rotations"
    return ReportTable(title, columns, rows, [lost])


EARLY_START_DEG = np.array([140.0, -10.0, 45.0])
LAST_PRINTED = 3
"""A start, one of many, from which STARS' last printed angles have table 6.4's errors."""

FIGURE_METHODS: dict[str, Callable[..., StarSolution]] = {
    "collinearity": collinearity,
    "two-star unit": two_star,
    "two-star raw": lambda pair: two_star(pair, unit_cross_products=False),
    "single-rotation": single_rotation,
}


def _figures() -> list[ReportTable]:
    pairs = star_pairs(len(sample_data.DIRECTIONS))
    fields = sample_data.sample_field().select(pairs)
    errors = np.stack([_error(method(fields)) for method in FIGURE_METHODS.values()], axis=1)
    lost = "The figures are lost in the scan."
    return [
        ReportTable(
            f"Figure 6.{k + 1}. Error of {name}, truth minus estimate, degrees",
            tuple(FIGURE_METHODS),
            [
                ReportRow(_pair(pair), [f"{value:.7f}" for value in error])
                for pair, error in zip(pairs, errors[:, :, k].tolist(), strict=True)
            ],
            [lost],
        )
        for k, name in enumerate(("omega", "phi", "kappa"))
    ]


def _as_listed() -> ReportTable:
    """What the two routines that cannot have made the tables answer."""
    listed = tustar(
        sample_data.sample_field(sample_data.EXACT_MM).select(np.array([0, 1])[None, :])
    )
    angles = (*listed.omega_phi_kappa_deg[0].tolist(), *listed.alpha_delta_swing_deg[0].tolist())
    rows = [ReportRow("TUSTAR, stars 1,2 of table 6.1", [f"{value:.4f}" for value in angles])]
    for name, weighted in (("church", False), ("church-weighted", True)):
        solution = church(sample_data.sample_field(), formula_weights=weighted)
        m = solution.matrix
        found = truopk(solution.omega_phi_kappa_deg, m[0, 1], m[0, 2], m[1, 1], m[1, 2])
        texts = [f"{value:.4f}" if np.isfinite(value) else "not found" for value in found]
        rows.append(ReportRow(f"TRUOPK, {name}", texts))
    columns = ("omega", "phi", "kappa", "alpha", "delta", "swing")
    return ReportTable("As listed. What TUSTAR and TRUOPK answer, degrees", columns, rows)


def _error(solution: StarSolution) -> Floats:
    """Truth minus estimate, degrees, the sign of table 6.4."""
    error: Floats = sample_data.TRUTH_DEG - solution.omega_phi_kappa_deg
    return error


def _pair(pair: Floats) -> str:
    return f"stars {int(pair[0]) + 1},{int(pair[1]) + 1}"


def _row(
    table: str,
    key: str,
    label: str,
    numbers: Sequence[float],
    columns: Sequence[str],
    digits: int,
    texts: Sequence[str],
) -> ReportRow:
    marks = []
    for number, column, text in zip(numbers, columns, texts, strict=True):
        places = len(text.partition(".")[2])
        agrees = f"{number:.{places}f}" == text
        misprint = (table, key, column) in printed_tables.MISPRINTS
        marks.append("" if agrees else "*" if misprint else "+")
    return ReportRow(label, [f"{number:.{digits}f}" for number in numbers], texts, marks)


def _notes(table: str) -> list[str]:
    return [
        f"* misprint ({why}): should be {right}"
        for (where, _, _), (right, why) in printed_tables.MISPRINTS.items()
        if where == table
    ]
