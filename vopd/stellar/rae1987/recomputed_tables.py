"""Recompute tables 6.1 to 6.4 of the report and compare them with the print; make all tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vopd.arrays import Floats
from vopd.geometry.sexagesimal import format_dms
from vopd.stellar.directions import image_directions
from vopd.stellar.methods.church import church
from vopd.stellar.methods.collinearity import collinearity
from vopd.stellar.radec import radec2
from vopd.stellar.rae1987 import printed_tables, sample_data
from vopd.stellar.rae1987.report_table import ReportRow, ReportTable, compared_row, misprint_notes
from vopd.stellar.tables_1987 import (
    angle_errors_deg,
    as_listed_table,
    figure_tables,
    rotation_table,
)

EARLY_START_DEG = np.array([140.0, -10.0, 45.0])
LAST_PRINTED = 3
"""A start, one of many, from which STARS' last printed angles have table 6.4's errors."""


def tables() -> list[ReportTable]:
    """All tables and figures of the report, recomputed; errors have the sign of table 6.4."""
    return [
        _stars("6.1", "Error-free images", sample_data.EXACT_MM, printed_tables.TABLE_6_1),
        _direction_cosines(),
        _stars("6.3", "Perturbed images", sample_data.PERTURBED_MM, printed_tables.TABLE_6_3),
        _errors(),
        rotation_table(),
        *figure_tables(),
        as_listed_table(),
    ]


def _stars(
    number: str, title: str, image_mm: Floats, rows: Sequence[tuple[str, ...]]
) -> ReportTable:
    """Tables 6.1 and 6.3: stars that RADEC2 makes of the error-free images, and the images."""
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
    """Table 6.2."""
    made = radec2(sample_data.EXACT_MM, sample_data.FOCAL_LENGTH_MM, sample_data.TRUTH_DEG)
    photo = image_directions(sample_data.PERTURBED_MM, sample_data.FOCAL_LENGTH_MM)
    values = np.concatenate([made.directions, photo], axis=-1)
    names = ("U", "V", "W", "P", "Q", "R")
    rows = [
        compared_row("6.2", row[0], f"star {row[0]}", numbers, names, 10, row[1:])
        for numbers, row in zip(values.tolist(), printed_tables.TABLE_6_2, strict=True)
    ]
    title = "Table 6.2. Direction cosines of the stars and of the perturbed images"
    return ReportTable(title, names, rows, misprint_notes("6.2"))


def _errors() -> ReportTable:
    """Table 6.4."""
    field = sample_data.sample_field()
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
        for row in printed_tables.TABLE_6_4
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
