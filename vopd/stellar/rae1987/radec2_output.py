"""Make the output of `vopd stars radec`: fictitious stars as text, JSON or CSV."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence

import numpy as np

from vopd.findings import Report
from vopd.stellar.files.input_text import read_text
from vopd.stellar.files.read import read_images_mm
from vopd.stellar.radec import FictitiousStars, printout, radec2, read_typed


def radec_text(
    name: str | None,
    focal_length_mm: float | None,
    omega_phi_kappa_deg: Sequence[float] | None,
    images: Sequence[Sequence[float]],
    form: str,
    report: Report,
) -> str:
    """Make fictitious stars and write them.

    Args:
        name: a file of images; None: `images`; `-` is standard input
        focal_length_mm: principal distance, mm; without it and the attitude the
            file holds what was typed to RADEC2
        omega_phi_kappa_deg: the attitude, degrees
        images: x, y of each image, mm
        form: "text", "json" or "csv"
        report: takes the warnings

    Returns:
        The stars as text.

    Raises:
        DeckError: the file cannot be read, or is not what it should be.
    """
    if focal_length_mm is None or omega_phi_kappa_deg is None:
        typed = read_typed(*read_text(name or "-"))
        for warning in typed.warnings:
            report(warning)
        made = radec2(typed.image_mm, typed.focal_length_mm, typed.omega_phi_kappa_deg)
    else:
        image_mm = np.array(images)
        if name is not None:
            image_mm = read_images_mm(*read_text(name))
        made = radec2(image_mm, focal_length_mm, np.array(omega_phi_kappa_deg))
    if form == "text":
        return printout(made)
    return _made_json(made) if form == "json" else _made_csv(made)


MADE_COLUMNS = ("x_mm", "y_mm", "ra_deg", "dec_deg")


def _made_rows(made: FictitiousStars) -> list[list[float]]:
    rows: list[list[float]] = np.column_stack([made.image_mm, made.ra_deg, made.dec_deg]).tolist()
    return rows


def _made_csv(made: FictitiousStars) -> str:
    page = io.StringIO()
    writer = csv.writer(page, lineterminator="\n")
    writer.writerows([MADE_COLUMNS, *_made_rows(made)])
    return page.getvalue()


def _made_json(made: FictitiousStars) -> str:
    stars = [
        {
            **dict(zip(MADE_COLUMNS, row, strict=True)),
            **dict(zip("uvw", made.directions[k].tolist(), strict=True)),
            **dict(zip("pqr", made.photo[k].tolist(), strict=True)),
        }
        for k, row in enumerate(_made_rows(made))
    ]
    return "[\n" + ",\n".join(json.dumps(star, allow_nan=False) for star in stars) + "\n]\n"
