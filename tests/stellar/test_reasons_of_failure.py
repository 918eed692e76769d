"""What is said of each reason for which stars give no attitude."""

from __future__ import annotations

from vopd.stellar.field import REASONS, Failure


def test_every_reason_in_words() -> None:
    """Rae's equation 3.17 is the weight wR = 1/r; it has no value at r = 0."""
    assert {failure.name: text for failure, text in REASONS.items()} == {
        "NOT_FINITE": "a coordinate is not a finite number",
        "TOO_FEW_STARS": "too few stars",
        "SAME_STAR": "the same star twice: two directions, or two images, coincide",
        "GREAT_CIRCLE": "the stars, or their images, lie on one great circle",
        "PRINCIPAL_POINT": "an image at the principal point, where weight wR (eq. 3.17) is "
        "infinite",
        "NO_ROTATION": "the rotation is zero, or a star lies on its axis",
        "AXIS_IN_PLANE": "the rotation axis lies in the plane of the two stars",
        "SINGULAR": "the stars leave the attitude undetermined, or every weight is zero",
        "NO_CONVERGENCE": "no convergence",
        "BEHIND_CAMERA": "a star lies behind the camera in the solution",
        "NOT_A_ROTATION": "the matrix as solved is far from a rotation: the stars lie too near "
        "one great circle for the errors of their images",
        "TOO_UNCERTAIN": "the stars do not determine the attitude with readings of this accuracy",
    }
    assert set(REASONS) == set(Failure) - {Failure.NONE}
