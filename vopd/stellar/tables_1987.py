"""The tables and figures of Rae (1987), recomputed and compared with the printed ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.geometry.sexagesimal import format_dms
from vopd.stellar.field import StarField, image_directions
from vopd.stellar.interstar_angles import star_pairs
from vopd.stellar.listed import truopk, tustar
from vopd.stellar.methods.church import ChurchWeights, church
from vopd.stellar.methods.collinearity import collinearity
from vopd.stellar.methods.single_rotation import single_rotation
from vopd.stellar.methods.two_star import two_star
from vopd.stellar.radec import radec2
from vopd.stellar.solution import StarSolution

# Tables 6.1 to 6.4 as printed, character for character, and their misprints

TABLE_6_1 = (
    ("1", "-4°25'49.68\"", "73°17'20.53\"", "24.000", "24.000", "76.000"),
    ("2", "82°19'23.81\"", "65°40'39.65\"", "-15.000", "15.000", "76.000"),
    ("3", "67°24'41.59\"", "38°35'22.22\"", "-24.000", "-24.000", "76.000"),
    ("4", "23°46'52.69\"", "52°14'21.68\"", "20.000", "-10.000", "76.000"),
)
"""Star, right ascension, declination, x, y, principal distance; no errors."""

TABLE_6_2 = (
    ("1", "0.28668456", "-0.02221252", "0.95776749", "0.28964233", "0.28603683", "-0.91339491"),
    ("2", "0.05501895", "0.40817799", "0.91124291", "-0.19240306", "0.19366887", "-0.96201530"),
    ("3", "0.30023306", "0.72167371", "0.62373646", "-0.28503185", "-0.28863985", "-0.95994801"),
    ("4", "0.56036911", "0.24693381", "0.79057584", "0.25009172", "-0.12630895", "-0.95994801"),
)
"""Star, U, V, W, P, Q, R; P, Q, R are those of the perturbed images of table 6.3."""

TABLE_6_3 = (
    ("1", "-4°25'49.68\"", "73°17'20.53\"", "24.100", "23.800", "76.000"),
    ("2", "82°19'23.81\"", "65°40'39.65\"", "-15.200", "15.300", "76.000"),
    ("3", "67°24'41.59\"", "38°35'22.22\"", "-23.700", "-24.000", "76.000"),
    ("4", "23°46'52.69\"", "52°14'21.68\"", "19.800", "-10.000", "76.000"),
)
"""As table 6.1, with errors in the images."""

TABLE_6_4 = (
    ("collinearity", "0.0151", "0.0216", "-0.0605"),
    ("church-weighted", "0.0521", "0.2025", "-0.2469"),
    ("church", "0.0501", "0.2033", "-0.2318"),
)
"""Method, errors of omega, phi and kappa (truth minus estimate), degrees."""

MISPRINTS = {
    ("6.2", "3", "R"): ("-0.91402619", "the R of row 4 stands in row 3 too"),
    ("6.4", "church", "kappa"): ("-0.2315", "an 8 for a 5"),
}
"""Table, row and column of a misprint: what should stand there, and how it differs."""


# The sample data: four fictitious stars (tables 6.1 to 6.3, program CHURCH)

FOCAL_LENGTH_MM = 76.0

TRUTH_DEG = np.array([156.1413452, -18.7472372, 46.0052148])
"""omega, phi, kappa the stars were made with: alpha 50, delta 60, swing 10."""

EXACT_MM, PERTURBED_MM = (
    np.array([row[3:5] for row in table], dtype=np.float64) for table in (TABLE_6_1, TABLE_6_3)
)
"""Images without errors, and with those that tables 6.4, 6.5 and figures 6.1 to 6.3 are about."""

DIRECTIONS = np.array(
    [
        [0.286684559, -0.022212524, 0.957767491],
        [0.055018946, 0.408177992, 0.911242911],
        [0.300233062, 0.721673709, 0.623736456],
        [0.560369112, 0.246933809, 0.790575836],
    ]
)
"""U, V, W to nine digits, as CHURCH and TESTU hold them in DATA."""


def sample_field(image_mm: Floats = PERTURBED_MM) -> StarField:
    """Build the field of the four stars with the perturbed images, or with other images."""
    return StarField.of(DIRECTIONS, image_mm, FOCAL_LENGTH_MM)


# Tables of computed and printed numbers


@dataclass(frozen=True)
class ReportRow:
    """One row of a table: what was computed and, where that is legible, what was printed."""

    label: str  # what the row is about
    computed: Sequence[str]  # its numbers as text
    printed: Sequence[str] = ()  # what the report printed; empty where that is lost
    # after each printed number "", "*" for a misprint, or "+" for a difference
    marks: Sequence[str] = ()


@dataclass(frozen=True)
class ReportTable:
    """A table of the report, recomputed."""

    title: str  # its number and heading
    columns: Sequence[str]  # heads of the columns
    rows: Sequence[ReportRow]  # its rows
    notes: Sequence[str] = ()  # lines below it that explain the marks


def compared_row(
    table: str,
    key: str,
    label: str,
    numbers: Sequence[float],
    columns: Sequence[str],
    digits: int,
    texts: Sequence[str],
) -> ReportRow:
    """Compare a row's computed numbers with the printed ones, and mark differences.

    Args:
        table: the table's number, `6.2`
        key: the row's name among the misprints
        label: what the row is about
        numbers: computed
        columns: heads of the columns
        digits: decimals to show of the computed numbers
        texts: printed numbers
    """
    marks = []
    for number, column, text in zip(numbers, columns, texts, strict=True):
        places = len(text.partition(".")[2])
        agrees = f"{number:.{places}f}" == text
        misprint = (table, key, column) in MISPRINTS
        marks.append("" if agrees else "*" if misprint else "+")
    return ReportRow(label, [f"{number:.{digits}f}" for number in numbers], texts, marks)


def misprint_notes(table: str) -> list[str]:
    """Explain the misprints of a table, in the lines below it."""
    return [
        f"* misprint ({why}): should be {right}"
        for (where, _, _), (right, why) in MISPRINTS.items()
        if where == table
    ]


# Tables as text: each computed row above the printed one


def as_text(table: ReportTable) -> str:
    """Format a table: title, rows with their differences marked, and notes about the marks."""
    texts = [text for row in table.rows for text in (*row.computed, *row.printed)]
    width = max(len(text) for text in (*table.columns, *texts))
    labels = max(len(row.label) for row in table.rows)
    compared = any(row.printed for row in table.rows)
    margin = labels + (10 if compared else 1)
    lines = [table.title, " " * margin + _cells(table.columns, (), width)]
    for row in table.rows:
        for label, source, cells, marks in (
            (row.label, "computed", row.computed, ()),
            ("", "printed", row.printed, row.marks),
        ):
            head = f"{label:<{labels}}  {source:<8}" if compared else f"{label:<{margin}}"
            if cells:
                lines.append(head + _cells(cells, marks, width))
    return "\n".join(line.rstrip() for line in (*lines, *table.notes)) + "\n"


def _cells(texts: Sequence[str], marks: Sequence[str], width: int) -> str:
    marks = marks or [""] * len(texts)
    return "".join(
        f" {text:>{width}}{mark or ' '}" for text, mark in zip(texts, marks, strict=True)
    )


# Table 6.5 and figures 6.1 to 6.3, lost in the scan, and two routines as listed


def rotation_table() -> ReportTable:
    """Recompute table 6.5: axis and angle of the single rotation of every pair."""
    pairs = star_pairs(len(DIRECTIONS))
    solution = single_rotation(sample_field().select(pairs))
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


FIGURE_METHODS: dict[str, Callable[..., StarSolution]] = {
    "collinearity": collinearity,
    "two-star unit": two_star,
    "two-star raw": lambda pair: two_star(pair, unit_cross_products=False),
    "single-rotation": single_rotation,
}


FIGURE_ANGLES = ("omega", "phi", "kappa")
FIGURE_TITLE = "Figure 6.{number}. Error of {name}, truth minus estimate, degrees"


def figure_errors() -> tuple[list[str], tuple[str, ...], Floats]:
    """Recompute the errors of omega, phi, kappa of every pair by four methods.

    Returns:
        The pairs, the methods, and the errors, (pairs, methods, 3), degrees.
    """
    pairs = star_pairs(len(DIRECTIONS))
    fields = sample_field().select(pairs)
    errors = np.stack(
        [angle_errors_deg(method(fields)) for method in FIGURE_METHODS.values()], axis=1
    )
    return [_pair(pair) for pair in pairs], tuple(FIGURE_METHODS), errors


def figure_tables() -> list[ReportTable]:
    """Tabulate figures 6.1 to 6.3."""
    pairs, methods, errors = figure_errors()
    lost = "The figures are lost in the scan."
    return [
        ReportTable(
            FIGURE_TITLE.format(number=k + 1, name=name),
            methods,
            [
                ReportRow(pair, [f"{value:.7f}" for value in error])
                for pair, error in zip(pairs, errors[:, :, k].tolist(), strict=True)
            ],
            [lost],
        )
        for k, name in enumerate(FIGURE_ANGLES)
    ]


def as_listed_table() -> ReportTable:
    """Run the two routines that, as listed, cannot have made the printed tables."""
    listed = tustar(sample_field(EXACT_MM).select(np.array([0, 1])[None, :]))
    angles = (*listed.omega_phi_kappa_deg[0].tolist(), *listed.alpha_delta_swing_deg[0].tolist())
    rows = [ReportRow("TUSTAR, stars 1,2 of table 6.1", [f"{value:.4f}" for value in angles])]
    choices: tuple[tuple[str, ChurchWeights], ...] = (
        ("church", "uniform"),
        ("church-weighted", "formula"),
    )
    for name, weights in choices:
        solution = church(sample_field(), weights=weights)
        m = solution.matrix
        found = truopk(solution.omega_phi_kappa_deg, m[0, 1], m[0, 2], m[1, 1], m[1, 2])
        texts = [f"{value:.4f}" if np.isfinite(value) else "not found" for value in found]
        rows.append(ReportRow(f"TRUOPK, {name}", texts))
    columns = ("omega", "phi", "kappa", "alpha", "delta", "swing")
    return ReportTable("As listed. What TUSTAR and TRUOPK answer, degrees", columns, rows)


def angle_errors_deg(solution: StarSolution) -> Floats:
    """Subtract estimated from true angles, degrees, the sign of table 6.4."""
    error: Floats = TRUTH_DEG - solution.omega_phi_kappa_deg
    return error


def _pair(pair: Ints) -> str:
    return f"stars {int(pair[0]) + 1},{int(pair[1]) + 1}"


# Tables 6.1 to 6.4, and all tables

EARLY_START_DEG = np.array([140.0, -10.0, 45.0])
LAST_PRINTED = 3
"""A start, one of many, from which STARS' last printed angles have table 6.4's errors."""


def tables() -> list[ReportTable]:
    """Recompute all tables and figures of the report; errors have the sign of table 6.4."""
    return [
        _stars("6.1", "Error-free images", EXACT_MM, TABLE_6_1),
        _direction_cosines(),
        _stars("6.3", "Perturbed images", PERTURBED_MM, TABLE_6_3),
        _errors(),
        rotation_table(),
        *figure_tables(),
        as_listed_table(),
    ]


def _stars(
    number: str, title: str, image_mm: Floats, rows: Sequence[tuple[str, ...]]
) -> ReportTable:
    """Recompute tables 6.1 and 6.3: stars that RADEC2 finds for the error-free images."""
    made = radec2(EXACT_MM, FOCAL_LENGTH_MM, TRUTH_DEG)
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
    """Recompute table 6.2."""
    made = radec2(EXACT_MM, FOCAL_LENGTH_MM, TRUTH_DEG)
    photo = image_directions(PERTURBED_MM, FOCAL_LENGTH_MM)
    values = np.concatenate([made.directions, photo], axis=-1)
    names = ("U", "V", "W", "P", "Q", "R")
    rows = [
        compared_row("6.2", row[0], f"star {row[0]}", numbers, names, 10, row[1:])
        for numbers, row in zip(values.tolist(), TABLE_6_2, strict=True)
    ]
    title = "Table 6.2. Direction cosines of the stars and of the perturbed images"
    return ReportTable(title, names, rows, misprint_notes("6.2"))


def _errors() -> ReportTable:
    """Recompute table 6.4."""
    field = sample_field()
    solutions = {
        "collinearity": collinearity(field),
        "church-weighted": church(field, weights="formula"),
        "church": church(field),
    }
    names = ("omega", "phi", "kappa")
    rows = [
        compared_row(
            "6.4", row[0], row[0], angle_errors_deg(solutions[row[0]]).tolist(), names, 7, row[1:]
        )
        for row in TABLE_6_4
    ]
    early = collinearity(field, initial_deg=EARLY_START_DEG, corrections=LAST_PRINTED)
    start, error = (
        ", ".join(form.format(value) for value in values)
        for form, values in (("{:.0f}", EARLY_START_DEG), ("{:.4f}", angle_errors_deg(early)))
    )
    notes = [
        *misprint_notes("6.4"),
        "+ one unit off. STARS prints the angles before each of its four corrections: those",
        f"  after three come last. From {start}, say, their errors are {error}.",
    ]
    title = "Table 6.4. Errors of the angles, truth minus estimate, degrees"
    return ReportTable(title, names, rows, notes)
