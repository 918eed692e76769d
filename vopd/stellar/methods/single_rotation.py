"""The single rotation that carries two stars onto their images (section 4, program TWOSTAR)."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np

from vopd.arrays import Floats
from vopd.findings import refuse_other_word
from vopd.geometry.linear import dot, norm, unit
from vopd.stellar.field import (
    DEGENERATE,
    Failure,
    StarField,
    first_failure,
    refuse_other_field,
    when,
)
from vopd.stellar.interstar_angles import interstar_discrepancy_arcsec
from vopd.stellar.methods.collinearity import rotation_about
from vopd.stellar.methods.two_star import same_star
from vopd.stellar.solution import StarSolution, closed_form_solution

AngleRule = Literal["farther", "mean"]

ILL_CONDITIONED = 0.2
"""sin(D1, D2) below which reading errors grow fivefold and the solution draws a warning."""

FLAT_COSINE = 0.999  # cosine from which an arc cosine would lose more than a digit of the angle


def single_rotation(pair: StarField, *, angle: AngleRule = "farther") -> StarSolution:
    """Solve the attitude from two stars, as a single rotation about one axis.

    D1 and D2 lead from each star to its image on the unit sphere (eqs. 4.1,
    4.2). The axis is at right angles to both (4.3 to 4.5), in the sense of
    D1 x D2; the angle about it is that of the star farther from the axis
    (PIKFAR, AXIANG). The matrix is exactly a rotation, by Rodrigues' formula:
    listing ROTATE divides by a component that may be 0.

    Args:
        pair: problems of two stars, (..., 2)
        angle: "farther", as the program does, or "mean", the mean of both stars'
            angles, each weighted by the square of the star's distance from the axis
            (recommended in section 6)

    Returns:
        The solution, with `axis`, `angle_deg` and `conditioning`. The last is
        sin(D1, D2); it is 0 where the axis lies in the plane of the two stars,
        and this, not the choice of stars, makes a pair poor. It fails there,
        where a star does not move (no rotation, or a star on the axis), and
        where the two stars are the same.

    Source: Rae (1987), section 4, program TWOSTAR.
    """
    refuse_other_field(pair, "single_rotation", 2)
    refuse_other_word(angle, get_args(AngleRule), "angle")
    stars, images = pair.directions, pair.photo
    first, second = np.moveaxis(images - stars, -2, 0)
    still = np.minimum(norm(first), norm(second)) < DEGENERATE
    normal = np.cross(unit(first), unit(second))
    conditioning = norm(normal)
    axis = unit(normal)

    feet = dot(stars, axis[..., None, :])[..., None] * axis[..., None, :]
    from_axis, to_axis = stars - feet, images - feet
    reach = norm(from_axis)
    both = _angle(from_axis, to_axis, axis[..., None, :])
    if angle == "mean":
        angle_rad = np.arctan2(*((reach**2 * part(both)).sum(axis=-1) for part in (np.sin, np.cos)))
    else:
        angle_rad = np.where(reach[..., 0] > reach[..., 1], both[..., 0], both[..., 1])

    failure = first_failure(
        pair.unfit(least=2),
        same_star(pair),
        when(still, Failure.NO_ROTATION),
        when(conditioning < DEGENERATE, Failure.AXIS_IN_PLANE),
    )
    return closed_form_solution(
        rotation_about(axis, angle_rad),
        failure,
        pair,
        axis=axis,
        angle_deg=np.degrees(angle_rad),
        conditioning=conditioning,
        interstar_discrepancy_arcsec=interstar_discrepancy_arcsec(pair),
    )


def _angle(star: Floats, image: Floats, axis: Floats) -> Floats:
    """Measure the angle from star to image about the axis, radians, by the right-hand rule.

    The listing divides by the square of the star's arm alone. With directions
    that are not quite of length 1, as printed ones, this differs from eq. 4.8 in
    about their last digit. Where the arc cosine is flat the arc tangent replaces it.
    """
    square = dot(star, star)
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = dot(star, image) / square
        sine = dot(axis, np.cross(star, image)) / square
    flat = np.abs(cosine) > FLAT_COSINE
    size = np.where(flat, np.arctan2(np.abs(sine), cosine), np.arccos(np.clip(cosine, -1.0, 1.0)))
    return np.where(sine < 0.0, -size, size)
