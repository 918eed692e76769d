"""Reasons why a problem has no solution, one code for each problem of a stack."""

from __future__ import annotations

from enum import IntEnum

import numpy as np

from vopd.arrays import Bools, Ints


class Failure(IntEnum):
    """The reason why a problem has no solution; `NONE` if it has one."""

    NONE = 0
    NOT_FINITE = 1
    TOO_FEW_STARS = 2
    SAME_STAR = 3
    GREAT_CIRCLE = 4
    PRINCIPAL_POINT = 5
    NO_ROTATION = 6
    AXIS_IN_PLANE = 7
    SINGULAR = 8
    NO_CONVERGENCE = 9
    BEHIND_CAMERA = 10
    NOT_A_ROTATION = 11
    TOO_UNCERTAIN = 12


REASONS = {
    Failure.NOT_FINITE: "a coordinate is not a finite number",
    Failure.TOO_FEW_STARS: "too few stars",
    Failure.SAME_STAR: "the same star twice: two directions, or two images, coincide",
    Failure.GREAT_CIRCLE: "the stars, or their images, lie on one great circle",
    Failure.PRINCIPAL_POINT: "an image at the principal point, where weight wR (eq. 3.17) is "
    "infinite",
    Failure.NO_ROTATION: "the rotation is zero, or a star lies on its axis",
    Failure.AXIS_IN_PLANE: "the rotation axis lies in the plane of the two stars",
    Failure.SINGULAR: "the stars leave the attitude undetermined, or every weight is zero",
    Failure.NO_CONVERGENCE: "no convergence",
    Failure.BEHIND_CAMERA: "a star lies behind the camera in the solution",
    Failure.NOT_A_ROTATION: "the matrix as solved is far from a rotation: the stars lie too near "
    "one great circle for the errors of their images",
    Failure.TOO_UNCERTAIN: "the stars do not determine the attitude with readings of this accuracy",
}
"""What each code means, as the end of a sentence."""


def first_failure(*failures: Ints) -> Ints:
    """For each problem, the first of several codes that is not `NONE`."""
    worst = failures[-1]
    for failure in reversed(failures[:-1]):
        worst = np.where(failure != Failure.NONE, failure, worst)
    return worst


def when(condition: Bools | np.bool_, failure: Failure) -> Ints:
    """An array of codes: one code where a condition holds, `NONE` elsewhere."""
    return np.where(condition, failure, Failure.NONE)
