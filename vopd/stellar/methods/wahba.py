"""Attitude by the singular-value solution of Wahba's problem."""

from __future__ import annotations

from vopd.arrays import Bools, Floats
from vopd.geometry.rotations import rotation_of_directions
from vopd.stellar.field import (
    DEGENERATE,
    Failure,
    StarField,
    first_failure,
    refuse_other_field,
    when,
)
from vopd.stellar.methods.weights import star_weights
from vopd.stellar.solution import StarSolution, closed_form_solution


def wahba(field: StarField) -> StarSolution:
    """Find the attitude that brings the stars' directions closest to those of their images.

    The rotation M that makes the (weighted) sum of |p - M u|**2 least, over all stars of
    a problem, found from the singular-value decomposition of the sum of p u'.
    It takes no start value and no iteration, from two stars on. All unit
    vectors weigh the same, so that the result differs slightly from that of
    `collinearity`, which weighs image coordinates.

    Args:
        field: the stars and their images

    Returns:
        The solution; it fails with fewer than two stars and with directions
        that all coincide or are opposite (to .2 seconds of arc).

    Source: F. L. Markley, Attitude determination using vector observations and
    the singular value decomposition, J. Astronautical Sciences 36 (1988).
    """
    refuse_other_field(field, "wahba")
    matrix, determined = wahba_rotation(field)
    failure = first_failure(field.unfit(least=2), when(~determined, Failure.SAME_STAR))
    return closed_form_solution(matrix, failure, field)


def wahba_rotation(field: StarField) -> tuple[Floats, Bools]:
    """Solve Wahba's problem: rotations (..., 3, 3), and whether the stars determine them (...)."""
    weights = star_weights(field)
    rotation, sizes = rotation_of_directions(field.photo, field.directions, weights)
    # Two stars a small angle apart leave about angle**2 / 4 of the sum of weights.
    least = (DEGENERATE / 2.0) ** 2 * weights.sum(axis=-1)
    return rotation, sizes[..., 1] + sizes[..., 2] > least
