"""Angles of matrices where they are hard: phi and delta near +-90, elements past 1."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.kit import rae_listings as listings
from tests.tolerances import assert_close, within
from vopd.geometry.sexagesimal import format_dms, parse_angle_deg
from vopd.stellar import (
    alpha_delta_swing_deg,
    matrix_from_alpha_delta_swing,
    omega_phi_kappa_deg,
    orientation_matrix,
    orthogonality_defect,
)
from vopd.stellar.radec import radec2

turn = st.floats(-180.0, 180.0)


@given(turn, st.floats(-90.0, 90.0), turn)
def test_the_matrix_is_jnkmats(omega: float, phi: float, kappa: float) -> None:
    mine = orientation_matrix(np.array([omega, phi, kappa]))
    assert np.abs(mine - listings.jnkmat(omega, phi, kappa)).max() < within("rae element")


@pytest.mark.parametrize("short", [1.0, 1e-2, 1e-4, 1e-6, 1e-7, 1e-9, 0.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
@given(first=turn, last=turn)
def test_near_the_pole_the_matrix_comes_back(
    side: float, short: float, first: float, last: float
) -> None:
    angles = np.array([first, side * (90.0 - short), last])
    m = orientation_matrix(angles)
    back = orientation_matrix(omega_phi_kappa_deg(m))
    assert np.abs(back - m).max() < within("rae element near a pole")
    m = matrix_from_alpha_delta_swing(angles)
    back = matrix_from_alpha_delta_swing(alpha_delta_swing_deg(m))
    assert np.abs(back - m).max() < within("rae element near a pole")


def test_a_thousandth_from_the_pole_all_three_are_known() -> None:
    for phi in (-89.999, 89.999):
        m = orientation_matrix(np.array([30.0, phi, 20.0]))
        found = omega_phi_kappa_deg(m)
        assert_close("rae angle", found, [30.0, phi, 20.0])


@pytest.mark.parametrize(("delta", "alpha"), [(90.0, 40.0), (-90.0, 60.0)])
def test_at_the_celestial_pole_swing_is_zero(delta: float, alpha: float) -> None:
    """Alpha 50, swing 10: only 50 - 10 is defined above, 50 + 10 below (y axis worked by hand)."""
    found = alpha_delta_swing_deg(matrix_from_alpha_delta_swing(np.array([50.0, delta, 10.0])))
    assert_close("rae angle", found[0], alpha)
    assert abs(found[1] - delta) < within("angle at a pole") and found[2] == 0.0


def test_an_element_past_one_is_clipped() -> None:
    m = orientation_matrix(np.array([10.0, 90.0, 0.0]))
    m[2, 0] = 1.0 + 1e-6
    assert abs(omega_phi_kappa_deg(m)[1] - 90.0) < within("angle of a matrix")
    m = orientation_matrix(np.array([180.0, 0.0, 0.0]))
    m[2, 2] = -1.0 - 1e-6
    assert abs(alpha_delta_swing_deg(m)[1] - 90.0) < within("angle of a matrix")


def test_the_two_triples_are_one_attitude() -> None:
    """The source notes: the sample is exactly alpha 50, delta 60, swing 10."""
    angles = omega_phi_kappa_deg(matrix_from_alpha_delta_swing(np.array([50.0, 60.0, 10.0])))
    assert_close("rae angle of seven digits", angles, [156.1413452, -18.7472372, 46.0052148])


def test_the_optical_axis_points_to_alpha_delta() -> None:
    made = radec2(np.array([[0.0, 0.0]]), 76.0, np.array([156.1413452, -18.7472372, 46.0052148]))
    assert_close("rae axis by seven decimals", [made.ra_deg[0], made.dec_deg[0]], [50.0, 60.0])


def test_omega_turns_y_toward_z_then_phi_z_toward_x_then_kappa_x_toward_y() -> None:
    """A quarter turn each: the rows of M are the camera's axes in the sky's."""
    quarter = np.eye(3) * 90.0
    expected = [
        [[1, 0, 0], [0, 0, 1], [0, -1, 0]],  # y becomes the old z
        [[0, 0, -1], [0, 1, 0], [1, 0, 0]],  # z becomes the old x
        [[0, 1, 0], [-1, 0, 0], [0, 0, 1]],  # x becomes the old y
    ]
    assert np.abs(orientation_matrix(quarter) - expected).max() < within("rae element")


def test_defect_by_hand() -> None:
    """diag(1, 1.1, 1): M M' - I has 1.21 - 1."""
    assert_close("table value", orthogonality_defect(np.diag([1.0, 1.1, 1.0])), 0.21)
    assert orthogonality_defect(np.eye(3)) == 0.0


@pytest.mark.parametrize(
    ("text", "degrees"),
    [
        ("-0 30 0", -0.5),
        ("-0h30m0s", -7.5),
        ("+1:30:36", 1.51),
        ("5h12m3s", 78.0125),
        ("12°30'", 12.5),
        ("-4.5", -4.5),
    ],
)
def test_angles_as_people_write_them(text: str, degrees: float) -> None:
    assert abs(parse_angle_deg(text, hours=True) - degrees) < within("rae element")


@pytest.mark.parametrize("text", ["3 60 0", "3 0 60", "3 0 59 9", "3 -1 0", "", "3h", "1e", "٣"])
def test_what_is_no_angle(text: str) -> None:
    with pytest.raises(ValueError, match=r"angle|below 60"):
        parse_angle_deg(text, hours=True)


def test_angles_are_written_with_their_carry() -> None:
    assert format_dms(-0.25) == "-0°15'00.00\"" and format_dms(59.9999999) == "60°00'00.00\""
