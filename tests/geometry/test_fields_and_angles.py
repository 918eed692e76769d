"""Where lens models end, angles of ellipses around the half circle, and angles as text."""

from __future__ import annotations

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.geometry import lenses as brown_lens
from vopd.geometry import lenses as fisheye_lens
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes
from vopd.geometry.lenses import UNSEEN_MEANING, Unseen
from vopd.geometry.linear import confidence_ellipse
from vopd.geometry.sexagesimal import format_dms, parse_angle_deg, parse_number


def fisheye(radius: float, *k: float) -> float:
    """The angle off the axis of an image at this radius; NaN where there is none."""
    with np.errstate(all="ignore"):
        (x,), (y,) = fisheye_lens.undistort_fisheye(
            np.array(k), np.array([radius]), np.array([0.0])
        )
    assert y == 0.0 or np.isnan(y)
    return float(np.arctan(x))


@pytest.mark.parametrize("radius", [0.0, 0.5, 1.57, 1.571, 2.0])
def test_a_fisheye_without_coefficients_ends_at_90_degrees(radius: float) -> None:
    """Its radius is the angle."""
    found = fisheye(radius, 0.0, 0.0, 0.0, 0.0)
    if radius < np.pi / 2:
        assert_close("ratio", found, radius)
    else:
        assert np.isnan(found)
    assert fisheye_lens.field_radius_fisheye(np.zeros(4)) == np.inf


@pytest.mark.parametrize("radius", [0.6, 0.611, 0.612, 0.615])
def test_beyond_the_fold_of_a_fisheye_is_no_image_though_the_radius_grows_again(
    radius: float,
) -> None:
    """t - .5 t3 + .11 t5 grows to .6117 at t2 = (1.5 - root .05) / 1.1, and from 1.57 on again."""
    k = (-0.5, 0.11, 0.0, 0.0)
    fold = np.sqrt((1.5 - np.sqrt(0.05)) / 1.1)
    assert_close("ratio", fisheye_lens.field_radius_fisheye(np.array(k)), np.tan(fold))
    found = fisheye(radius, *k)
    if radius < fold - 0.5 * fold**3 + 0.11 * fold**5:
        assert found < fold
        assert_close("ratio", found - 0.5 * found**3 + 0.11 * found**5, radius)
    else:
        assert np.isnan(found)


def test_a_fisheye_that_folds_beyond_90_degrees_has_no_limit() -> None:
    """1 - .36 t2 is 0 at t = 1.67, more than a quarter of a circle."""
    assert fisheye_lens.field_radius_fisheye(np.array([-0.12, 0, 0, 0])) == np.inf
    assert fisheye_lens.field_radius_fisheye(np.array([-0.2, 0, 0, 0])) < 10.0


def test_a_lens_ends_where_its_denominator_is_zero() -> None:
    """r / (1 - .5 r2) grows without end towards the root of 2."""
    k = np.zeros(12)
    k[5] = -0.5
    assert_close("ratio", brown_lens.field_radius_brown(k), np.sqrt(2.0))
    radius = np.array([1.0, 1.4])
    x, y = brown_lens.undistort_brown(k, radius / (1.0 - 0.5 * radius**2), np.zeros(2))
    assert_close("ratio", x, radius)
    assert not y.any()
    assert brown_lens.field_radius_brown(np.zeros(12)) == np.inf


def test_where_the_image_is_turned_inside_out_there_is_no_ideal_point() -> None:
    """Tangential terms fold the plane inside the field of the radial part."""
    k = np.array([0, 0, -0.105, 0.022, -0.015, 0, 0, 0.014, 0, 0.084, 0, 0])
    folded = np.array([-1.0880, -0.7308])
    (xd, yd), _ = brown_lens.distort_brown(k, *folded[:, None])
    step = 1e-6
    (east, _), (north, _) = (
        brown_lens.distort_brown(k, *(folded + step * axis)[:, None]) for axis in np.eye(2)
    )
    columns = [[(one[0] - xd) / step, (one[1] - yd) / step] for one in (east, north)]
    assert np.linalg.det(np.array(columns)[..., 0]) < 0.0
    assert np.hypot(*folded) < brown_lens.field_radius_brown(k)
    assert np.isnan(brown_lens.undistort_brown(k, xd, yd)).all()


@pytest.mark.parametrize("degrees", range(0, 180, 15))
def test_the_longer_axis_of_an_ellipse_around_the_half_circle(degrees: int) -> None:
    """From the second coordinate toward the first; .95 of chi-square with two degrees is 5.9915."""
    angle = np.radians(degrees)
    longer, shorter = (
        np.array([np.sin(angle), np.cos(angle)]),
        np.array([np.cos(angle), -np.sin(angle)]),
    )
    covariance = 9.0 * np.outer(longer, longer) + 4.0 * np.outer(shorter, shorter)
    semi_axes, found_rad = confidence_ellipse(covariance)
    assert 0.0 <= found_rad < np.pi
    away = (found_rad - angle + np.pi / 2) % np.pi - np.pi / 2
    assert_close("ratio", away, 0.0)
    expected = np.sqrt(5.991464547107979) * np.array([3.0, 2.0])
    assert_close("semi-axis by a quantile", semi_axes, expected)


def test_ellipses_of_few_degrees_of_freedom_and_of_what_is_not_known() -> None:
    """2 F(.95; 2, 4) is 13.8885; of a covariance that is not finite nothing is known."""
    semi_axes, angle = confidence_ellipse(np.diag([4.0, 1.0]), freedom=4.0)
    expected = np.sqrt(13.888543819998318) * np.array([2.0, 1.0])
    assert_close("semi-axis by a quantile", semi_axes, expected)
    assert_close("ratio", angle, np.pi / 2)
    semi_axes, angle = confidence_ellipse(
        np.array([np.diag([1.0, 4.0]), [[1.0, np.nan], [np.nan, 1.0]]])
    )
    assert np.isfinite(semi_axes[0]).all() and np.isnan(semi_axes[1]).all()
    assert angle[0] == 0.0 and np.isnan(angle[1])
    below, _ = confidence_ellipse(np.diag([4.0, -1e-20]))  # by rounding
    assert below[1] == 0.0 and below[0] > 0.0


@pytest.mark.parametrize(
    ("text", "degrees"),
    [
        ("3 59 59.9", 3 + 59 / 60 + 59.9 / 3600), ("-0:00:36", -0.01), ("+7 30", 7.5),
        ("0 59", 59 / 60), ("5h59m59s", 15 * (5 + 59 / 60 + 59 / 3600)), ("−1°30'", -1.5),  # noqa: RUF001
        (" 12.5 ", 12.5), ("-1e-3", -0.001),
    ],
)  # fmt: skip
def test_angles_as_text(text: str, degrees: float) -> None:
    assert_close("ratio", parse_angle_deg(text, hours=True), degrees)


@pytest.mark.parametrize("text", ["3 60 0", "3 60", "3 0 60", "3 0 60.0", "0 99 0"])
def test_minutes_and_seconds_are_below_60(text: str) -> None:
    with pytest.raises(ValueError, match=f"minutes and seconds must be below 60: '{text}'"):
        parse_angle_deg(text)


@pytest.mark.parametrize("text", ["nan", "inf", "1_000", "0x10", "1e1234", "", "1,5", "٣"])
def test_what_is_no_number(text: str) -> None:
    with pytest.raises(ValueError, match="not a number"):
        parse_number(text)


def test_hours_are_angles_only_where_they_are_asked_for() -> None:
    with pytest.raises(ValueError, match="not an angle: '5h12m3s'"):
        parse_angle_deg("5h12m3s")


@pytest.mark.parametrize(
    ("angle", "decimals", "text"),
    [
        (-0.25, 2, "-0°15'00.00\""), (0.0, 2, "0°00'00.00\""),
        (1 / 3600 * 59.996, 2, "0°01'00.00\""),
        (1 / 3600 * 59.994, 2, "0°00'59.99\""), (-4.43, 2, "-4°25'48.00\""), (7.5, 0, "7°30'00\""),
        (7.50001, 3, "7°30'00.036\""), (359.99999999, 1, "360°00'00.0\""),
    ],
)  # fmt: skip
def test_angles_to_text(angle: float, decimals: int, text: str) -> None:
    assert format_dms(angle, decimals) == text


@pytest.mark.parametrize("latitude", [-90.0, -47.5, 0.0, 33.0, 89.9, 90.0])
def test_positions_and_axes_on_the_ellipsoid(latitude: float) -> None:
    """Height is along the normal, which is up; east is level, and north completes them."""
    ground, above = (earth_centred_m(latitude, -106.5, height) for height in (-50.0, 1e5))
    up = (above - ground) / (1e5 + 50.0)
    axes = local_axes(ground)
    assert_close("unit rotation", axes[2], up)
    assert_close(
        "unit rotation", axes[0], [-np.sin(np.radians(-106.5)), np.cos(np.radians(-106.5)), 0]
    )
    assert_close("unit rotation", axes[1], np.cross(axes[2], axes[0]))
    found = geodetic(np.stack([ground, above]))
    assert_close("flight height", found.height_m, [-50.0, 1e5])
    assert_close("ratio", found.latitude_deg, [latitude] * 2)
    if latitude not in (-90.0, 90.0):
        assert_close("ratio", found.longitude_deg, [-106.5] * 2)


@pytest.mark.parametrize(("second", "folds"), [(0.1, True), (0.1126, False), (0.12, False)])
def test_a_lens_that_only_slows_down_does_not_end(second: float, folds: bool) -> None:
    """1 - 1.5 t2 + 5 k t4 has roots up to k = 2.25 / 20, and no real ones beyond."""
    k = np.zeros(12)
    k[:2] = -0.5, second
    assert np.isfinite(brown_lens.field_radius_brown(k)) == folds
    assert np.isfinite(fisheye_lens.field_radius_fisheye(k[:4])) == folds
    if folds:
        fold = np.sqrt((1.5 - np.sqrt(2.25 - 20.0 * second)) / (10.0 * second))
        assert_close("ratio", brown_lens.field_radius_brown(k), fold)
        assert_close("ratio", fisheye_lens.field_radius_fisheye(k[:4]), np.tan(fold))


def test_text_of_angles_and_numbers_to_the_last_sign() -> None:
    assert parse_angle_deg("1234 30 0") == 1234.5
    assert format_dms(7.5) == "7°30'00.00\""
    with pytest.raises(ValueError, match=r"^not a number: 'x'$"):
        parse_number("  x ")


def test_one_latitude_and_many_longitudes_are_as_many_positions() -> None:
    found = earth_centred_m(0.0, [0.0, 90.0, 180.0], 1.0)
    expected = [[6378138.0, 0, 0], [0, 6378138.0, 0], [-6378138.0, 0, 0]]
    assert_close("flight position", found, expected)


def test_why_a_ray_has_no_image() -> None:
    assert UNSEEN_MEANING == {
        Unseen.BEHIND_CAMERA: "lies behind the camera",
        Unseen.OUTSIDE_FIELD: "lies outside the field in which the lens model holds",
    }
    assert [one.value for one in Unseen] == [0, 1, 2]
