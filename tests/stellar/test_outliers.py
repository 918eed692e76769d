"""Interstar angles, and stars that do not fit."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import f as f_distribution

from tests.kit.stars import COSINES
from tests.kit.stars import solve_text as solve
from tests.tolerances import assert_close
from vopd.stellar import outlier_search
from vopd.stellar.field import Failure, StarField
from vopd.stellar.interstar_angles import (
    interstar_reading_sigma_mm,
    median_disagreement_mm,
    star_disagreement_arcsec,
    star_pairs,
    widest_pair,
)
from vopd.stellar.methods.two_star import two_star
from vopd.stellar.outlier_search import AttitudeFit, Outlier, find_outliers, fit_attitude

FOCAL = 50.0


def stars(count: int, sigma: float = 0.01) -> StarField:
    """So many within 15 mm of the centre, seen along the camera's own axes."""
    rng = np.random.default_rng(count)
    images = rng.uniform(-15.0, 15.0, (count, 2))
    rays = np.column_stack([images, np.full(count, -FOCAL)])
    noisy = images + rng.normal(0.0, sigma, images.shape) if sigma else images
    return StarField.of(rays / np.linalg.norm(rays, axis=1)[:, None], noisy, FOCAL)


# Limits of the tests by interstar angles, and which stars are compared


def test_the_reading_error_of_interstar_angles() -> None:
    """A normal error is larger than .6745 deviations in half of all cases."""
    table = np.array([[1.0, 2.0, np.nan], [3.0, 4.0, 100.0]])
    found = interstar_reading_sigma_mm(stars(3), table)
    assert_close("rae element", found, 3.0 / 0.6744897501960817)
    assert_close("rae element", median_disagreement_mm(stars(3), table), [2.0, 3.0, 100.0])
    assert np.isnan(interstar_reading_sigma_mm(stars(2)))


def test_pairs_in_the_order_of_the_report() -> None:
    assert star_pairs(4).tolist() == [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]
    assert star_pairs(1).tolist() == []


def test_the_widest_pair() -> None:
    """By the sine: 80 degrees before 150; of stars that are used; the first of none."""
    degrees = np.radians([0.0, 150.0, 80.0, 20.0])
    directions = np.column_stack([np.cos(degrees), np.sin(degrees), np.zeros(4)])
    used = np.array([[1, 1, 1, 1], [1, 1, 0, 1], [1, 0, 0, 0], [1, 0, 0, 1]], bool)
    field = StarField.of(directions, np.zeros((4, 2)), 1.0, used)
    assert widest_pair(field).tolist() == [[0, 2], [1, 3], [0, 1], [0, 3]]
    same = StarField.of(
        np.tile([0.0, 0.0, 1.0], (3, 1)), np.zeros((3, 2)), 1.0, [False, True, True]
    )
    assert widest_pair(same).tolist() == [1, 2]


def test_disagreements_leave_out_stars_that_are_not_used() -> None:
    """Right angles in the sky, 45, 45 and 60 degrees on the photograph."""
    images = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [5.0, 5.0]])
    sky = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    used = np.array([[1, 1, 1, 0], [1, 1, 0, 0], [1, 0, 0, 0]], bool)
    total, median = star_disagreement_arcsec(StarField.of(sky, images, 1.0, used))
    none = np.nan
    sums = [[90.0, 75.0, 75.0, none], [45.0, 45.0, none, none], [none] * 4]
    middles = [[45.0, 37.5, 37.5, none], [45.0, 45.0, none, none], [none] * 4]
    assert_close("rae angle", total / 3600.0, sums)
    assert_close("rae angle", median / 3600.0, middles)


# Limits of the search for stars that do not fit: halves, chances, rounds and pairs


def fixed(
    monkeypatch: pytest.MonkeyPatch, doubt: list[float], rounds: list[list[float]]
) -> list[list[int]]:
    """Let stars be in doubt by this much, and have these chances in each round; the good ones."""
    given: list[list[int]] = []

    def chances(field: Any, good: Any, fit: Any) -> tuple[Any, Any]:
        given.append(np.flatnonzero(good).tolist())
        chance = np.array([rounds[min(len(given), len(rounds)) - 1]])
        return chance, np.arange(chance.size)[None] + 10.0

    def fit(field: StarField) -> list[AttitudeFit]:
        return [AttitudeFit(1.0, 9, np.eye(3))]

    table = np.array([doubt])
    monkeypatch.setattr(outlier_search, "median_disagreement_mm", lambda field, off: table)
    monkeypatch.setattr(outlier_search, "_distance_by_pairs", lambda field: -np.array(doubt))
    monkeypatch.setattr(outlier_search, "_chances", chances)
    monkeypatch.setattr(outlier_search, "fit_attitudes", fit)
    monkeypatch.setattr(outlier_search, "_again_without", lambda *problem: None)
    return given


HALVES = [(4, 3), (5, 3), (6, 4), (7, 4), (8, 5), (9, 5)]


@pytest.mark.parametrize(("count", "half"), HALVES)
def test_where_the_search_begins(monkeypatch: pytest.MonkeyPatch, count: int, half: int) -> None:
    """From the half of the stars, and one, that is least in doubt."""
    given = fixed(monkeypatch, [float(k) for k in range(count)], [[0.0] * count])
    find_outliers(stars(count))
    find_outliers(stars(count), start="interstar")
    find_outliers(stars(count), start="pairs")
    first = list(range(half))
    assert given == [first, first, list(range(count - half, count))]


def test_a_chance_of_one_in_a_thousand(monkeypatch: pytest.MonkeyPatch) -> None:
    """Stars with it are good; once good a star stays so; the least likely is first."""
    chances = [0.0, 0.0, 0.0, 0.0, 0.0, 1e-3, 0.99e-3, 1e-9, 1e-9]
    given = fixed(monkeypatch, [float(k) for k in range(9)], [chances])
    assert find_outliers(stars(9)) == [
        Outlier(8, 18.0, 1e-9), Outlier(7, 17.0, 1e-9), Outlier(6, 16.0, 0.99e-3),
    ]  # fmt: skip
    assert given == [[0, 1, 2, 3, 4], [0, 1, 2, 3, 4, 5]]


def test_a_wrong_star_of_the_half_with_which_it_starts() -> None:
    """It starts from nine of sixteen stars, of which eight are right: those that fit have one."""
    field = stars(16)
    images = field.image_mm.copy()
    images[8:] = np.random.default_rng(0).uniform(-15.0, 15.0, (8, 2))
    found = find_outliers(replace(field, image_mm=images))
    assert {one.star for one in found} == set(range(8, 16))
    good = fit_attitude(field.select(np.arange(8)))
    expected = np.hypot(*(images - _seen(field, good.matrix)).T)
    for one in found:
        assert_close("rae element", one.distance_mm / expected[one.star], 1.0)


def _seen(field: StarField, matrix: Any) -> Any:
    camera = field.directions @ matrix.T
    return -FOCAL * camera[:, :2] / camera[:, 2:]


def test_what_has_no_outliers(monkeypatch: pytest.MonkeyPatch) -> None:
    given = fixed(monkeypatch, [0.0] * 4, [[0.0] * 4])
    assert find_outliers(stars(3)) == [] and given == []
    assert len(find_outliers(stars(4))) == 1
    nothing = AttitudeFit(np.inf, 9, np.eye(3))
    monkeypatch.setattr(outlier_search, "fit_attitudes", lambda field: [nothing])
    assert find_outliers(stars(4)) == []


def test_the_attitude_of_a_pair_is_judged_by_the_median() -> None:
    """Four of nine stars are wrong, by much: the distances of the five good ones are small."""
    field = stars(9, 0.001)
    image = field.image_mm.copy()
    image[[1, 4, 6, 8]] += [[4.0, 1.0], [-3.0, 2.0], [1.0, -6.0], [-5.0, -5.0]]
    found = outlier_search._distance_by_pairs(StarField.of(field.directions, image, FOCAL))
    assert (found > 1.0).tolist() == [k in (1, 4, 6, 8) for k in range(9)]
    image = field.image_mm.copy()
    image[[1, 4, 6, 8]] += np.random.default_rng(0).uniform(-12.0, 12.0, (4, 2))
    other = StarField.of(field.directions, image, FOCAL)
    tried = []
    for pair in star_pairs(9):
        (turn,) = two_star(other.select(pair[None])).rotation()
        rays = other.directions @ turn.T
        tried.append(np.hypot(*(image - rays[:, :2] / -rays[:, 2:] * FOCAL).T))
    best = min(tried, key=lambda one: sorted(one)[4])
    assert_close("residual", outlier_search._distance_by_pairs(other), best)
    image = field.image_mm.copy()
    image[[1, 4, 6, 8]] += [[4.0, 1.0], [-3.0, 2.0], [1.0, -6.0], [-5.0, -5.0]]
    doubled = np.tile(4.0 * np.eye(2), (9, 1, 1))
    half = outlier_search._distance_by_pairs(
        StarField.of(field.directions, image, FOCAL, errors=doubled)
    )
    assert_close("rae element", half, found / 2.0)


def test_statistics_of_an_attitude(monkeypatch: pytest.MonkeyPatch) -> None:
    """Squares of residuals over two coordinates each less three; exact ones have a floor."""
    fit = fit_attitude(stars(6, 0.1))
    assert fit.freedom == 9 and 0.001 < fit.variance_mm2 < 0.1
    exact = fit_attitude(stars(6, 0.0))
    assert_close("rae element", exact.variance_mm2 / (1e-18 * FOCAL**2), 1.0)
    assert [fit_attitude(stars(count, 0.0)).freedom for count in (1, 2)] == [1, 1]
    field = stars(6, 0.1)
    errors = np.tile(4.0 * np.eye(2), (6, 1, 1))
    twice = fit_attitude(StarField.of(field.directions, field.image_mm, FOCAL, errors=errors))
    assert_close("rae element", twice.variance_mm2 * 4.0, fit.variance_mm2)
    used = np.arange(6) < 5
    some = fit_attitude(StarField.of(field.directions, field.image_mm, FOCAL, used))
    alone = fit_attitude(field.select(used))
    assert some.freedom == alone.freedom == 7
    assert_close("rae element", some.variance_mm2, alone.variance_mm2)
    broken = fit_attitude(StarField.of(field.directions, np.full((6, 2), np.nan), FOCAL))
    assert broken.variance_mm2 == np.inf and np.isnan(broken.matrix).all()
    assert broken.freedom == 9 and Failure.NONE == 0


@pytest.mark.parametrize("errors", [False, True])
def test_the_chance_of_a_star(errors: bool) -> None:
    """By the F test: its residual's covariance has the attitude's by the stars that are good."""
    rng = np.random.default_rng(3)
    field = stars(7, 0.02)
    roots = rng.normal(size=(7, 2, 2)) + 2.0 * np.eye(2)
    spread = roots @ roots.swapaxes(-1, -2) if errors else np.tile(np.eye(2), (7, 1, 1))
    field = StarField.of(field.directions, field.image_mm, FOCAL, errors=spread if errors else None)
    turn = Rotation.from_rotvec([0.001, -0.002, 0.003]).as_matrix()
    good = np.array([True, True, False, True, True, True, False])

    def seen(matrix: np.ndarray) -> np.ndarray:
        rays = field.directions @ matrix.T
        return rays[:, :2] / -rays[:, 2:] * FOCAL

    columns = []
    for axis in np.eye(3):
        both = [
            seen(Rotation.from_rotvec(step * axis).as_matrix() @ turn) for step in (1e-6, -1e-6)
        ]
        columns.append((both[0] - both[1]) / 2e-6)
    design = np.stack(columns, axis=-1)
    normal = sum(design[k].T @ np.linalg.inv(spread[k]) @ design[k] for k in np.flatnonzero(good))
    off = field.image_mm - seen(turn)
    expected = []
    for k in range(7):
        whole = spread[k] + design[k] @ np.linalg.inv(normal) @ design[k].T
        size = off[k] @ np.linalg.inv(whole) @ off[k] / 2.0 / 0.003
        expected.append(min(1.0, 7.0 * f_distribution.sf(size, 2, 7)))
    assert min(expected) < max(expected) == 1.0
    fit = AttitudeFit(0.003, 7, turn)
    both = outlier_search._chances(StarField.stack([field]), good[None], [fit])
    (chance,), (distance,) = both
    assert_close("rae sigma by differences", chance, expected)
    assert_close("rae element", distance, np.hypot(*off.T))


def test_a_pair_without_an_attitude_is_not_the_best() -> None:
    """The first two are one star: nothing fits them, and nothing is said by them."""
    field = stars(7, 0.001)
    same = field.select(np.array([0, 0, 1, 2, 3, 4, 5]))
    assert 0.0 < outlier_search._distance_by_pairs(same).max() < 0.1


def test_a_star_at_right_angles_to_the_view_does_not_fit() -> None:
    """It has no image, and so no chance."""
    field = stars(6, 0.01)
    directions = field.directions.copy()
    directions[2] = [1.0, 0.0, 0.0]
    aside = StarField.of(directions, field.image_mm, FOCAL)
    with np.errstate(invalid="ignore"):
        (chance,), _ = outlier_search._chances(
            StarField.stack([aside]), np.arange(6)[None] != 2, [AttitudeFit(1e-4, 7, np.eye(3))]
        )
    assert chance[2] == 0.0 and (np.delete(chance, 2) > 0.0).all()


# The single rotation where it ends: axes near the plane of the stars, turns near none


AXIS = np.array([0.3, 0.2, -1.0]) / np.sqrt(1.13)


def turned_pair(dihedral_sine: float, angle_deg: float = 30.0, first: float = 10.0) -> str:
    """Two stars that one turn about AXIS carries onto images with this sine(D1, D2).

    D1 and D2 are at right angles to the axis, turned like the stars' arms: the angle
    between them is that between the planes through the axis and each star.
    """
    side = np.cross(AXIS, [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    lines = []
    for cone_deg, about in ((first, 0.0), (25.0, np.arcsin(dihedral_sine))):
        arm = Rotation.from_rotvec(about * AXIS).apply(side)
        ray = np.cos(np.radians(cone_deg)) * AXIS + np.sin(np.radians(cone_deg)) * arm
        star = Rotation.from_rotvec(np.radians(-angle_deg) * AXIS).apply(ray)
        lines.append(",".join(f"{v:.17g}" for v in (*(ray[:2] * -76.0 / ray[2]), *star)))
    return COSINES + "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("sine", "status", "said"),
    [
        (0.5e-6, 1, "lines 2 and 3: single-rotation: the rotation axis lies in the plane"),
        (2e-6, 0, "= 0.000 is below 0.2"),
        (0.19, 0, "= 0.190 is below 0.2"),
        (0.21, 0, ""),
    ],
)
def test_the_thresholds_of_an_axis_in_the_stars_plane(sine: float, status: int, said: str) -> None:
    result = solve(turned_pair(sine), "--method", "single-rotation")
    assert result.status == status
    assert said in result.stderr
    assert result.stderr.startswith("warning: ") == (status == 0 and said != "")
    assert (result.stderr == "") == (said == "")


@pytest.mark.parametrize(("angle_deg", "first"), [(0.0, 10.0), (1e-5, 10.0), (30.0, 0.0)])
def test_no_rotation_and_a_star_on_the_axis(angle_deg: float, first: float) -> None:
    result = solve(turned_pair(0.5, angle_deg, first), "--method", "single-rotation")
    assert result.status == 1
    assert "lines 2 and 3: single-rotation: the rotation is zero, or a star" in result.stderr
    assert solve(turned_pair(0.5, angle_deg, first), "--method", "two-star").status == 0
