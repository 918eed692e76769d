"""Fields, inverses and partials of lens models, against OpenCV and by differences."""

from __future__ import annotations

import warnings

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.random_flights import CENTRE, SIZE, lenses
from tests.tolerances import assert_close
from vopd.geometry import lenses as models
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes
from vopd.geometry.lenses import UNSEEN_MEANING, Lens, LensKind, Unseen, project, ray_of_pixel
from vopd.geometry.linear import confidence_ellipse
from vopd.geometry.sexagesimal import format_dms, parse_angle_deg, parse_number

LENSES = lenses()


def rays(seed: int, angle: float) -> np.ndarray:
    """A thousand rays up to an angle off the optical axis."""
    rng = np.random.default_rng(seed)
    off, about = rng.uniform(0.0, angle, 1000), rng.uniform(0.0, 2.0 * np.pi, 1000)
    across = np.sin(off)
    return np.stack([across * np.cos(about), across * np.sin(about), np.cos(off)], axis=1)


def camera_matrix(lens: Lens) -> np.ndarray:
    (fx, fy), (cx, cy) = lens.focal_px, lens.centre_px
    return np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize("count", [4, 5, 8, 12])
def test_brown_is_that_of_opencv(count: int) -> None:
    k = LENSES["brown"].k.copy()
    k[count:] = 0.0
    lens = Lens(LensKind.BROWN, SIZE, np.array([1500.0, 1490.0]), CENTRE, k)
    ray = rays(1, 0.6)
    expected, _ = cv2.projectPoints(ray, np.zeros(3), np.zeros(3), camera_matrix(lens), k[:count])
    assert_close("flight pixel", project(lens, ray).pixel, expected[:, 0])


def test_fisheye_is_that_of_opencv() -> None:
    lens, ray = LENSES["fisheye"], rays(2, 1.45)
    expected, _ = cv2.fisheye.projectPoints(
        ray[:, None], np.zeros(3), np.zeros(3), camera_matrix(lens), lens.k
    )
    assert_close("flight pixel", project(lens, ray).pixel, expected[:, 0])


@pytest.mark.parametrize("kind", LENSES)
def test_a_smaller_picture_has_every_point_in_proportion_from_its_corner(kind: str) -> None:
    """A picture of a quarter of the width and height."""
    ray, small = rays(4, 0.3), LENSES[kind].scaled(0.25)
    expected = 0.25 * (project(LENSES[kind], ray).pixel + 0.5) - 0.5
    assert np.isfinite(expected).all()
    assert_close("flight pixel", project(small, ray).pixel, expected)


def test_skew_moves_u_by_the_distorted_y() -> None:
    ray = rays(3, 0.6)
    plain, skew = project(LENSES["brown"], ray), project(LENSES["skew"], ray)
    yd = (plain.pixel[:, 1] - CENTRE[1]) / 1490.0
    assert_close("flight pixel", skew.pixel - plain.pixel, np.stack([3.0 * yd, 0.0 * yd], axis=1))


def test_radial_table_adds_to_the_measured_radius() -> None:
    lens = LENSES["table"]
    pixel = CENTRE + np.array([[0.0, 0.0], [300.0, 0.0], [0.0, -700.0]])
    ray = ray_of_pixel(lens, pixel)
    # 300 px: .7 + 3.3 * 100 / 300; 700 px: 4 - 2 * 200 / 400
    ideal = np.array([[0.0, 0.0], [(300.0 + 1.8) / 1500.0, 0.0], [0.0, -(700.0 + 3.0) / 1500.0]])
    assert_close("flight ray", ray[:, :2] / ray[:, 2:], ideal)


@pytest.mark.parametrize("name", list(LENSES))
def test_pixel_to_ray_undoes_ray_to_pixel(name: str) -> None:
    ray = rays(4, 1.5 if name == "fisheye" else 0.6)
    assert_close("flight ray", ray_of_pixel(LENSES[name], project(LENSES[name], ray).pixel), ray)


@pytest.mark.parametrize("name", list(LENSES))
def test_partials_by_turns_are_those_of_differences(name: str) -> None:
    ray, step = rays(5, 0.6), 1e-5
    for axis in range(3):
        turn = Rotation.from_rotvec(np.eye(3)[axis] * step).as_matrix()
        there, back = (project(LENSES[name], ray @ way).pixel for way in (turn.T, turn))
        # a step across a row of the table meets two slopes
        smooth = np.abs(there - back).max(axis=1) >= 0.0
        if name == "table":
            radius = np.hypot(*(there - CENTRE).T)
            smooth = np.abs(radius[:, None] - [200.0, 500.0, 900.0]).min(axis=1) > 0.1
        by_turn = project(LENSES[name], ray).by_turns[..., axis]
        difference = (there - back) / (2.0 * step)
        assert_close("flight partial", by_turn[smooth], difference[smooth])
        assert smooth.sum() > 900


def test_behind_the_camera_and_beyond_the_fold_there_is_no_image() -> None:
    k = np.zeros(12)
    k[0] = -0.3
    folding = Lens(LensKind.BROWN, SIZE, np.array([1500.0, 1500.0]), CENTRE, k)
    # r (1 - .3 r2) grows until r2 = 1 / .9
    assert_close("flight ray", folding.field_radius, np.sqrt(1.0 / 0.9))
    seen = project(folding, np.array([[0.3, -0.2, -1.0], [1.1, 0.0, 1.0], [1.0, 0.0, 1.0]]))
    assert seen.unseen.tolist() == [Unseen.BEHIND_CAMERA, Unseen.OUTSIDE_FIELD, Unseen.SEEN]
    assert np.isnan(seen.pixel[:2]).all() and np.isnan(seen.by_turns[:2]).all()
    assert_close("flight pixel", seen.pixel[2], CENTRE + np.array([1500.0 * 0.7, 0.0]))
    # the greatest radius of the image is r (1 - .3 r2) at the fold, .703
    outside, inside = ray_of_pixel(
        folding, CENTRE + np.array([[1500.0 * 0.71, 0.0], [1500.0 * 0.70, 0.0]])
    )
    assert np.isnan(outside).all() and np.isfinite(inside).all()


def test_fisheye_ends_where_its_polynomial_folds_and_at_90_degrees() -> None:
    folding = Lens(
        LensKind.FISHEYE, SIZE, np.array([700.0, 700.0]), CENTRE, np.array([-0.3, 0, 0, 0])
    )
    # t (1 - .3 t2) grows until t2 = 1 / .9
    assert_close("flight ray", folding.field_radius, np.tan(np.sqrt(1.0 / 0.9)))
    assert np.isnan(ray_of_pixel(folding, CENTRE + np.array([[700.0 * 0.71, 0.0]]))).all()
    assert project(LENSES["fisheye"], np.array([[1.0, 0.0, 0.0]])).unseen[0] == 1


def test_the_table_ends_at_its_last_row() -> None:
    lens = LENSES["table"]
    assert np.isnan(ray_of_pixel(lens, CENTRE + np.array([[1301.0, 0.0]]))).all()
    last = np.array([[(1300.0 - 3.0 + 0.1) / 1500.0, 0.0, 1.0]])
    assert project(lens, last).unseen[0] == Unseen.OUTSIDE_FIELD


def test_rays_that_are_not_known_have_no_image() -> None:
    for lens in LENSES.values():
        assert np.isnan(project(lens, np.full((1, 3), np.nan)).pixel).all()
        assert np.isnan(ray_of_pixel(lens, np.full((1, 2), np.nan))).all()


# Where lens models end, angles of ellipses around the half circle, and angles as text


def fisheye(radius: float, *k: float) -> float:
    """The angle off the axis of an image at this radius; NaN where there is none."""
    with np.errstate(all="ignore"):
        (x,), (y,) = models.undistort_fisheye(np.array(k), np.array([radius]), np.array([0.0]))
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
    assert models.field_radius_fisheye(np.zeros(4)) == np.inf


@pytest.mark.parametrize("radius", [0.6, 0.611, 0.612, 0.615])
def test_beyond_the_fold_of_a_fisheye_is_no_image_though_the_radius_grows_again(
    radius: float,
) -> None:
    """t - .5 t3 + .11 t5 grows to .6117 at t2 = (1.5 - root .05) / 1.1, and from 1.57 on again."""
    k = (-0.5, 0.11, 0.0, 0.0)
    fold = np.sqrt((1.5 - np.sqrt(0.05)) / 1.1)
    assert_close("ratio", models.field_radius_fisheye(np.array(k)), np.tan(fold))
    found = fisheye(radius, *k)
    if radius < fold - 0.5 * fold**3 + 0.11 * fold**5:
        assert found < fold
        assert_close("ratio", found - 0.5 * found**3 + 0.11 * found**5, radius)
    else:
        assert np.isnan(found)


def test_a_fisheye_that_folds_beyond_90_degrees_has_no_limit() -> None:
    """1 - .36 t2 is 0 at t = 1.67, more than a quarter of a circle."""
    assert models.field_radius_fisheye(np.array([-0.12, 0, 0, 0])) == np.inf
    assert models.field_radius_fisheye(np.array([-0.2, 0, 0, 0])) < 10.0


def test_a_lens_ends_where_its_denominator_is_zero() -> None:
    """r / (1 - .5 r2) grows without end towards the root of 2."""
    k = np.zeros(12)
    k[5] = -0.5
    assert_close("ratio", models.field_radius_brown(k), np.sqrt(2.0))
    radius = np.array([1.0, 1.4])
    x, y = models.undistort_brown(k, radius / (1.0 - 0.5 * radius**2), np.zeros(2))
    assert_close("ratio", x, radius)
    assert not y.any()
    assert models.field_radius_brown(np.zeros(12)) == np.inf


def test_where_the_image_is_turned_inside_out_there_is_no_ideal_point() -> None:
    """Tangential terms fold the plane inside the field of the radial part."""
    k = np.array([0, 0, -0.105, 0.022, -0.015, 0, 0, 0.014, 0, 0.084, 0, 0])
    folded = np.array([-1.0880, -0.7308])
    (xd, yd), _ = models.distort_brown(k, *folded[:, None])
    step = 1e-6
    (east, _), (north, _) = (
        models.distort_brown(k, *(folded + step * axis)[:, None]) for axis in np.eye(2)
    )
    columns = [[(one[0] - xd) / step, (one[1] - yd) / step] for one in (east, north)]
    assert np.linalg.det(np.array(columns)[..., 0]) < 0.0
    assert np.hypot(*folded) < models.field_radius_brown(k)
    assert np.isnan(models.undistort_brown(k, xd, yd)).all()


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
        (-1e-9, 2, "0°00'00.00\""), (-1.0001e-3, 0, "-0°00'04\""),
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
    assert np.isfinite(models.field_radius_brown(k)) == folds
    assert np.isfinite(models.field_radius_fisheye(k[:4])) == folds
    if folds:
        fold = np.sqrt((1.5 - np.sqrt(2.25 - 20.0 * second)) / (10.0 * second))
        assert_close("ratio", models.field_radius_brown(k), fold)
        assert_close("ratio", models.field_radius_fisheye(k[:4]), np.tan(fold))


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
        Unseen.NOWHERE: "is at the camera's own place, or deep in the Earth,",
    }
    assert [one.value for one in Unseen] == [0, 1, 2, 3]


# Distortion and its inverse where they are delicate: at the axis, at the ends, with one row


BROWN = np.array([-0.28, 0.09, 1e-3, -8e-4, -0.02, 0.01, 2e-3, 1e-3, 5e-4, 1e-4, -3e-4, 2e-4])
FISHEYE = np.array([0.03, 0.01, -0.02, 0.004])
TABLE = np.array([[0.0, 0.0], [0.2, 0.21], [0.4, 0.43], [0.5, 0.52]])  # measured, ideal
POINTS = np.array([[0.0, 0.0], [0.3, 0.0], [0.0, -0.3], [0.25, -0.31], [1e-9, 2e-9]])
X, Y = POINTS.T


@pytest.mark.parametrize(
    ("kind", "k"), [("brown", BROWN), ("fisheye", FISHEYE), ("radial_table", TABLE)]
)
def test_distortion_is_undone_also_on_the_axis(kind: str, k: np.ndarray) -> None:
    """Without a warning of numpy's, and the derivatives are those of differences."""
    distort, undistort = (
        getattr(models, f"distort_{kind}"),
        getattr(models, f"undistort_{kind}"),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        moved, by = distort(k, X, Y)
        assert_close("flight ray", undistort(k, *moved), [X, Y])
    step = 1e-7
    for axis, way in enumerate(([step, 0.0], [0.0, step])):
        there, back = (distort(k, X + s * way[0], Y + s * way[1])[0] for s in (1.0, -1.0))
        slope = (np.array(there) - np.array(back)).T / (2 * step)
        assert_close("derivative by steps", by[..., axis][:4], slope[:4])


@pytest.mark.parametrize("index", range(12))
def test_each_coefficient_of_brown_by_its_own_term(index: int) -> None:
    """k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4, at x = .3, y = -.2, r2 = .13; OpenCV's formulas."""
    k, x, y, r2 = np.zeros(12), 0.3, -0.2, 0.13
    k[index] = 0.1
    radial = {0: r2, 1: r2**2, 4: r2**3}
    under = {5: r2, 6: r2**2, 7: r2**3}
    across = {
        2: (2 * x * y, r2 + 2 * y * y), 3: (r2 + 2 * x * x, 2 * x * y),
        8: (r2, 0.0), 9: (r2**2, 0.0), 10: (0.0, r2), 11: (0.0, r2**2),
    }  # fmt: skip
    factor = (1 + 0.1 * radial.get(index, 0.0)) / (1 + 0.1 * under.get(index, 0.0))
    dx, dy = across.get(index, (0.0, 0.0))
    (xd, yd), _ = models.distort_brown(k, np.array(x), np.array(y))
    assert_close("ratio", [xd, yd], [x * factor + 0.1 * dx, y * factor + 0.1 * dy])


def test_a_field_ends_at_the_first_of_several_ends() -> None:
    """(1 - r2)(1 - r2 / 4) is the growth of r - (5 / 12) r3 + r5 / 20: ends at 1 and at 2."""
    k = np.zeros(12)
    k[:2] = -5 / 12, 1 / 20
    assert_close("ratio", models.field_radius_brown(k), 1.0)
    radius = np.linspace(0.64, 3.0, 40)  # it grows to 19 / 30, and from .27 at 2 on again
    with np.errstate(all="ignore"):
        found = models.undistort_brown(k, np.append(0.6, radius), np.zeros(41))[0]
    assert 0.6 < found[0] < 1.0 and np.isnan(found[1:]).all()


def test_a_field_ends_at_a_pole_before_a_fold() -> None:
    """1 / (1 - r2 / 4) has a pole at 2, and grows all the way."""
    k = np.zeros(12)
    k[5] = -0.25
    assert_close("ratio", models.field_radius_brown(k), 2.0)
    radius = np.array([0.5, 1.9])
    moved = radius / (1 - radius**2 / 4)
    assert_close("flight ray", models.undistort_brown(k, moved, 0.0 * moved)[0], radius)
    assert np.isnan(models.undistort_brown(k, -moved[1:], np.array([np.nan]))[0]).all()


@pytest.mark.parametrize("radius", [0.0, 0.1, 0.2, 0.3, 0.4, 0.45, 0.5])
def test_a_table_is_linear_between_its_rows_and_their_slopes(radius: float) -> None:
    """On a row the slope is that of what follows, and on the last one of what is before it."""
    ideal = np.interp(radius, TABLE[:, 0], TABLE[:, 1])
    (xd, yd), by = models.distort_radial_table(TABLE, np.array(ideal), np.array(0.0))
    slope = 0.2 / 0.21 if ideal < 0.21 else 0.2 / 0.22 if ideal < 0.43 else 0.1 / 0.09
    assert_close("ratio", [xd, yd], [radius, 0.0])
    factor = radius / ideal if radius else slope
    assert_close("ratio", by, [[slope, 0.0], [0.0, factor]])
    assert_close("ratio", models.undistort_radial_table(TABLE, xd, yd), [ideal, 0.0])


def test_a_table_ends_with_its_last_row() -> None:
    assert models.field_radius_radial_table(TABLE) == 0.52
    found = models.undistort_radial_table(TABLE, np.array([0.5, 0.500001, 0.0]), np.zeros(3))[0]
    assert_close("ratio", found, [0.52, np.nan, 0.0])
