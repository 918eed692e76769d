"""Lens models against OpenCV, their inverses, partials and limits."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.random_flights import CENTRE, SIZE, lenses
from tests.tolerances import assert_close
from vopd.geometry.lenses import Lens, LensKind, Unseen, project, ray_of_pixel

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
