"""Routines of Rae (1987) as listed: the printout of STARS, TRUOPK and TUSTAR."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from vopd.arrays import Floats
from vopd.findings import VopdError, count_text
from vopd.geometry.linear import ARCSEC_PER_RADIAN, dot, transform
from vopd.stellar.angles import omega_phi_kappa_deg, orientation_matrix
from vopd.stellar.field import Failure, StarField, image_points_mm
from vopd.stellar.methods.collinearity import StartRule, correct, rule_of_step, start_rotation
from vopd.stellar.methods.two_star import two_star
from vopd.stellar.methods.weights import WeightRule

# Program STARS (appendix B): angles and residuals before each correction

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
    """Print what program STARS prints, without carriage control.

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
            matrix, _, _ = correct(flat, matrix, rule, reading_sigma_mm, listed=True)
            turned = omega_phi_kappa_deg(matrix[0])
            if not (fit and np.isfinite(turned).all()):
                raise VopdError(
                    f"the attitude is undetermined after {count_text(done, 'correction')}"
                )
            angles = turned + 360.0 * np.round((angles - turned) / 360.0)  # STARS adds corrections
    return "\n".join(lines) + "\n"


def _start_deg(field: StarField, initial_deg: ArrayLike | None, start: StartRule) -> Floats:
    """Choose the angles to start from; raise VopdError if the stars determine none."""
    if initial_deg is not None:
        return np.array(initial_deg, dtype=float)
    angles = omega_phi_kappa_deg(start_rotation(field.flat(), start)[0])
    if not np.isfinite(angles).all():
        raise VopdError("the stars do not determine an attitude to start from")
    return angles


def _angle_lines(angles_deg: Floats) -> list[str]:
    """Format the angles as PRTOPK's formats 10, 20, 30 do."""
    lines = []
    for name, angle in zip(("OMEGA", "PHI", "KAPPA"), angles_deg.tolist(), strict=True):
        minutes, thousandths = divmod(round(abs(angle) * 3_600_000), 60_000)
        degrees, minutes = divmod(minutes, 60)
        whole = f"{'-' if angle < 0.0 else ''}{degrees}"
        lines.append(f"{name:<7}={whole:>6}{minutes:4d}{thousandths / 1000.0:8.3f}")
    return lines


def _residual_lines(field: StarField, angles_deg: Floats) -> list[str]:
    """Format the residuals and their sums as PRTRRES's formats 10 to 33 do."""
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


# Routine TRUOPK (appendix C): angles by trying all eight combinations
#
# It shows what the listing does, errors included; use
# `vopd.stellar.omega_phi_kappa_deg` for angles. T12 stands where T22 should, the
# tests divide by the elements, and their tolerance of .3 percent is less than the
# errors of a Church solution's elements. M12 to M23 are taken as real numbers
# here; the listing makes them integers by the implicit rule.

SMALL = 0.00001
COMBINATIONS = np.array(list(itertools.product((0, 1), repeat=3)))  # I, J, K, K fastest


def truopk(angles_deg: Floats, m12: Floats, m13: Floats, m22: Floats, m23: Floats) -> Floats:
    """Find the first of eight combinations of angles that passes the listing's tests.

    Args:
        angles_deg: arc tangents and arc sine of eq. 3.5, (..., 3), degrees
        m12: element of M, (...)
        m13: element of M, (...)
        m22: element of M, (...)
        m23: element of M, (...)

    Returns:
        omega, phi, kappa, (..., 3), degrees; NaN where no combination passes.

    Source: Rae (1987), appendix C.
    """
    sine, cosine = np.sin(np.radians(angles_deg)), np.cos(np.radians(angles_deg))
    first = np.arctan2(sine, cosine)
    second = np.arctan2(sine * [-1.0, 1.0, -1.0], -cosine)  # phi keeps its sine
    candidates = np.where(COMBINATIONS == 0, first[..., None, :], second[..., None, :])
    so, sp, sk = np.moveaxis(np.sin(candidates), -1, 0)
    co, _, ck = np.moveaxis(np.cos(candidates), -1, 0)
    t12 = so * sp * ck + co * sk
    t13 = -co * sp * ck + so * sk
    t22 = -so * sp * sk + co * ck
    t23 = co * sp * sk + so * ck
    e12, e13, e22, e23 = (np.asarray(e, dtype=float)[..., None] for e in (m12, m13, m22, m23))
    with np.errstate(divide="ignore", invalid="ignore"):
        missed = (
            ((t12 - e12) * (t12 - e12) / e12 / e12 > SMALL)
            | ((t13 - e13) * (t13 - e13) / e13 / e13 > SMALL)
            | ((t22 - e22) * (t12 - e22) / e22 / e22 > SMALL)  # T12, as listed
            | ((t23 - e23) * (t23 - e23) / e23 / e23 > SMALL)
        )
    chosen = np.argmin(missed, axis=-1)[..., None]
    angles = np.degrees(np.take_along_axis(candidates, chosen[..., None], axis=-2)[..., 0, :])
    found = ~np.take_along_axis(missed, chosen, axis=-1)
    return np.where(found, angles, np.nan)


# Routine TUSTAR (appendix D): the two-star solution and its angles
#
# It shows what the listing prints; use `vopd.stellar.two_star` for attitudes. Its
# phi and delta come from the cosine of an angle that is already in degrees, so
# that they are wrong even for data without errors, and its fictitious star is not
# a unit vector.


@dataclass(frozen=True)
class TustarAnswers:
    """The results of TUSTAR for a stack of pairs (...)."""

    matrix: Floats  # the orientation matrix, (..., 3, 3)
    omega_phi_kappa_deg: Floats  # its angles, phi wrong, (..., 3), degrees
    alpha_delta_swing_deg: Floats  # its angles, delta wrong, (..., 3), degrees
    interstar_rad: Floats  # angle between the two stars, (...), radians
    discrepancy_arcsec: Floats  # that minus the angle between the images, (...), seconds of arc


def tustar(pair: StarField) -> TustarAnswers:
    """Solve pairs of stars exactly as routine TUSTAR does.

    Args:
        pair: problems of two stars, (..., 2)

    Returns:
        What it prints; NaN where its arc cosines fail.

    Source: Rae (1987), appendix D.
    """
    m = two_star(pair, unit_cross_products=False).matrix
    omega = np.degrees(np.arctan2(-m[..., 2, 1], m[..., 2, 2]))
    cos_phi = np.minimum(m[..., 2, 2] / np.cos(omega), 1.0)  # omega is in degrees: as listed
    phi = np.degrees(np.arctan2(m[..., 2, 0], cos_phi))
    kappa = np.degrees(np.arctan2(-m[..., 1, 0], m[..., 0, 0]))
    alpha = np.degrees(np.arctan2(-m[..., 2, 1], -m[..., 2, 0]))
    cos_delta = np.minimum(-m[..., 2, 0] / np.cos(alpha), 1.0)  # so is alpha
    delta = np.degrees(np.arctan2(-m[..., 2, 2], cos_delta))
    swing = np.degrees(np.arctan2(m[..., 0, 2], m[..., 1, 2]))
    stars, photo = pair.directions, pair.photo
    with np.errstate(invalid="ignore"):
        on_sky = np.arccos(dot(stars[..., 0, :], stars[..., 1, :]))
        on_photo = np.arccos(dot(photo[..., 0, :], photo[..., 1, :]))
    return TustarAnswers(
        m,
        np.stack([omega, phi, kappa], axis=-1),
        np.stack([alpha, delta, swing], axis=-1),
        on_sky,
        (on_sky - on_photo) * ARCSEC_PER_RADIAN,
    )
