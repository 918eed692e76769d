"""When a mistake is believed: limits of gain, size and chance, and what is tried for it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import f as f_distribution

from tests.tolerances import assert_close
from vopd.stellar.field import StarField
from vopd.stellar.files import mistakes as mistake_trials
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mistakes import (
    MendedCamera,
    MendedStars,
    UsualMistake,
    _mistake,
    by_camera,
    by_coordinates,
    by_wrong_stars,
)
from vopd.stellar.files.read import StarFile
from vopd.stellar.outlier_search import AttitudeFit, Outlier

FOCAL = 50.0
AXES = ImageAxes(focal_mm=FOCAL)


def stars(count: int = 6, sigma: float = 0.0, moved: tuple[int, ...] = ()) -> StarField:
    """Stars straight ahead, read with errors of this size, some of them moved by 2 mm."""
    rng = np.random.default_rng(count)
    images = rng.uniform(-15.0, 15.0, (count, 2))
    rays = np.column_stack([images, np.full(count, -FOCAL)])
    images = images + rng.normal(0.0, sigma, images.shape) if sigma else images
    images[list(moved)] += 2.0
    return StarField.of(rays / np.linalg.norm(rays, axis=1)[:, None], images, FOCAL)


def fit(variance: float, freedom: int = 9) -> AttitudeFit:
    return AttitudeFit(variance, freedom, np.eye(3))


@pytest.mark.parametrize(("gain", "believed"), [(8.9, False), (9.1, True)])
def test_the_variance_must_be_nine_times_smaller(gain: float, believed: bool) -> None:
    found = _mistake("x", fit(gain * 0.0004, 99), fit(0.0004, 99), stars(), (1, 2))
    assert found == (UsualMistake("x", 0.02, (1, 2)) if believed else None)


@pytest.mark.parametrize(("sigma", "believed"), [(0.499, True), (0.501, False)])
def test_what_is_left_must_be_a_reading(sigma: float, believed: bool) -> None:
    """A hundredth of the principal distance, .5 mm, is no reading's error."""
    found = _mistake("x", fit(100.0, 99), fit(sigma**2, 99), stars())
    assert (found is not None) == believed


@pytest.mark.parametrize(("chance", "believed"), [(1.1e-4, False), (0.9e-4, True)])
@pytest.mark.parametrize("freedom", [(3, 9), (9, 7)])
def test_chance_must_not_explain_it(
    chance: float, believed: bool, freedom: tuple[int, int]
) -> None:
    ratio = float(f_distribution.isf(chance, *freedom))
    assert ratio > 9.0
    found = _mistake("x", fit(ratio * 1e-6, freedom[0]), fit(1e-6, freedom[1]), stars())
    assert (found is not None) == believed


def test_whatever_fits_is_better_than_no_attitude() -> None:
    assert _mistake("x", fit(np.inf, 1), fit(1e-6, 1), stars()) == UsualMistake("x", 0.001)


def test_coordinates_are_tried_by_a_solution_without_iteration_first(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Only where it leaves less than the stars as they are are they solved."""
    monkeypatch.setattr(mistake_trials, "fit_attitude", lambda field: fit(1e-6))
    field = stars(6, 0.1)
    rough = mistake_trials._roughly_mm2(field)
    turn = Rotation.align_vectors(field.photo, field.directions)[0]
    seen = turn.apply(field.directions)
    off = field.image_mm - seen[:, :2] / -seen[:, 2:] * FOCAL
    assert_close("rae element", rough, (off**2).sum() / (2 * 6 - 3))
    for more, tried in ((1.001, True), (0.999, False)):
        found = by_coordinates(MendedStars("y", field), fit(rough * more))
        assert found == (UsualMistake("y", 0.001) if tried else None)


@pytest.mark.parametrize(
    ("count", "moved", "advice"),
    [
        (7, (4,), "star 5 disagrees with the others: misidentified, or misread? --reject leaves "
         "it out"),
        (8, (5, 0), "stars 1, 6 disagree with the others: misidentified, or misread? --reject "
         "leaves them out"),
    ],
)  # fmt: skip
def test_stars_that_disagree(count: int, moved: tuple[int, ...], advice: str) -> None:
    field = stars(count, 0.001, moved)
    found = by_wrong_stars(field, [Outlier(k, 1.0, 0.0) for k in moved], fit(1.0))
    assert found is not None
    assert (found.advice, found.stars) == (advice, tuple(sorted(moved)))
    assert 0.1 < 1000.0 * found.sigma < 3.0


def test_three_stars_at_least_are_left() -> None:
    for count, wrong in ((4, True), (5, False)):
        outliers = [Outlier(k, 1.0, 0.0) for k in (0, 1)]
        found = by_wrong_stars(stars(count, 0.001, (0, 1)), outliers, fit(np.inf))
        assert (found is None) == wrong
    assert by_wrong_stars(stars(), [], fit(1.0)) is None


def test_a_camera_is_judged_by_its_own_principal_distance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of 500 mm, of which 4 are less than a hundredth; the stated one has 50."""
    field = replace(stars(), focal_length_mm=np.array([500.0]))
    camera = MendedCamera("longer", fit(16.0), field)
    monkeypatch.setattr(mistake_trials, "mended_camera", lambda *_, **__: camera)
    found = by_camera(stars(), ("focal",), fit(np.inf), FILE, AXES)
    assert found == UsualMistake("longer", 4.0)


@pytest.mark.parametrize("named", [True, False])
@pytest.mark.parametrize(("variance", "far"), [(0.249, False), (0.251, True), (np.inf, True)])
def test_a_camera_is_far_where_no_reading_is_as_bad(
    monkeypatch: pytest.MonkeyPatch, variance: float, far: bool, named: bool
) -> None:
    given: list[Any] = []

    def mended(*arguments: Any, **options: bool) -> None:
        given.append((arguments[1], options))

    monkeypatch.setattr(mistake_trials, "mended_camera", mended)
    assert by_camera(stars(), ("k1",), fit(variance), FILE, AXES, named=named) is None
    by_camera(stars(), ("k1",), fit(variance), FILE, AXES)
    assert given == [
        (("k1",), {"named": named, "far": far}),
        (("k1",), {"named": True, "far": far}),
    ]


FILE = StarFile("a", (2,), ("",), np.zeros((1, 2)), "mm", "ra_deg,dec_deg", np.zeros((1, 2)))
