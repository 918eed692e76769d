"""Printout of program STARS (appendix B): angles and residuals before each correction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Floats
from vopd.findings import VopdError
from vopd.geometry.vectors import transform
from vopd.stellar.angles import omega_phi_kappa_deg, orientation_matrix
from vopd.stellar.directions import image_points_mm
from vopd.stellar.failures import Failure
from vopd.stellar.field import StarField
from vopd.stellar.methods.collinearity import StartRule, correct, rule_of_step, start_rotation
from vopd.stellar.methods.weights import WeightRule

LISTED_CORRECTIONS = 4  # DO 990 ITERAT = 1, 4


def stars_printout(
    field: StarField,
    *,
    initial_deg: ArrayLike | None = None,
    start: StartRule = "svd",
    weights: WeightRule = "uniform",
    corrections: int = LISTED_CORRECTIONS,
    reading_sigma_mm: float | None = None,
) -> str:
    """What program STARS prints, without carriage control.

    Before each correction it prints the angles in degrees, minutes and seconds,
    the residuals, and their sums of squares and of sizes; the angles after the
    last correction are not printed. The angles are right where the listing's
    subroutine DPRDMS errs: see `vopd errata --program rae dprdms-constants`.

    Args:
        field: one problem, without a stack axis
        initial_deg: omega, phi, kappa to start from, (3,), degrees
        start: where to start without them
        weights: as for `collinearity`
        corrections: how many
        reading_sigma_mm: as for `collinearity`

    Returns:
        The printout.

    Raises:
        VopdError: the corrections end before their number: an attitude is undetermined.

    Source: Rae (1987), appendix B, PRTOPK and PRTRRES.
    """
    angles = _start_deg(field, initial_deg, start)
    flat = field.flat()
    fit = flat.unfit(least=2)[0] == Failure.NONE
    matrix = orientation_matrix(angles)[None]
    lines: list[str] = []
    for done in range(corrections):
        lines += _angle_lines(angles) + _residual_lines(field, angles)
        if done + 1 < corrections:
            rule = rule_of_step(weights, done)
            matrix = correct(flat, matrix, rule, reading_sigma_mm, listed=True).matrix
            turned = omega_phi_kappa_deg(matrix[0])
            if not (fit and np.isfinite(turned).all()):
                raise VopdError(f"the attitude is undetermined after {done} corrections")
            angles = turned + 360.0 * np.round((angles - turned) / 360.0)  # STARS adds corrections
    return "\n".join(lines) + "\n"


def _start_deg(field: StarField, initial_deg: ArrayLike | None, start: StartRule) -> Floats:
    """Angles to start from; raises VopdError where the stars determine none."""
    if initial_deg is not None:
        return np.array(initial_deg, dtype=float)
    angles = omega_phi_kappa_deg(start_rotation(field.flat(), start)[0])
    if not np.isfinite(angles).all():
        raise VopdError("the stars do not determine an attitude to start from")
    return angles


def _angle_lines(angles_deg: Floats) -> list[str]:
    """Three lines as PRTOPK's formats 10, 20, 30 have them."""
    lines = []
    for name, angle in zip(("OMEGA", "PHI", "KAPPA"), angles_deg.tolist(), strict=True):
        minutes, thousandths = divmod(round(abs(angle) * 3_600_000), 60_000)
        degrees, minutes = divmod(minutes, 60)
        whole = f"{'-' if angle < 0.0 else ''}{degrees}"
        lines.append(f"{name:<7}={whole:>6}{minutes:4d}{thousandths / 1000.0:8.3f}")
    return lines


def _residual_lines(field: StarField, angles_deg: Floats) -> list[str]:
    """Residuals and their sums as PRTRRES's formats 10 to 33 have them."""
    from fortranformat import FortranRecordWriter

    camera = transform(orientation_matrix(angles_deg), field.directions)
    residuals = field.image_mm - image_points_mm(camera, field.focal_length_mm)
    star = FortranRecordWriter("(I10, 10X, F10.4, 10X, F10.4)")
    lines = [" OBSERVATION NUMBER" + " " * 10 + "X RESIDUAL" + " " * 10 + "Y RESIDUAL"]
    lines += [star.write([k + 1, *row]) for k, row in enumerate(residuals.tolist())]
    sums: Sequence[tuple[str, str, Floats]] = (
        ("SQUARED", "F14.7", (residuals**2).sum(axis=0)),
        ("ABSOLUTE", "F13.7", np.abs(residuals).sum(axis=0)),
    )
    for what, form, totals in sums:
        for axis, total in zip("XY", totals.tolist(), strict=True):
            record = FortranRecordWriter(f"('SUM OF THE {what} {axis} RESIDUALS =', {form})")
            lines.append(record.write([total]))
    return lines
