"""Plausible and implausible residuals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2

from vopd.stellar.field import StarField, star_directions
from vopd.stellar.files import mistakes as plausibility
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mistakes import (
    implausible_residuals,
    judge,
    unexplained_advice,
)
from vopd.stellar.files.read import StarFile
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm
from vopd.stellar.outlier_search import AttitudeFit, fit_attitude

# What is said of residuals: what allows them, what to do about them, which mistakes are tried


FOCAL = 50.0


def star_file(count: int = 6, unit: str = "mm", largest: float = 10.0) -> StarFile:
    image = np.full((count, 2), 1.0)
    image[-1, 0] = -largest
    return StarFile("a.csv", tuple(range(2, 2 + count)), ("",) * count, image, unit, "", image)


def stars(count: int) -> StarField:
    """Stars straight ahead, without reading errors."""
    rng = np.random.default_rng(count)
    images = rng.uniform(-15.0, 15.0, (count, 2))
    rays = np.column_stack([images, np.full(count, -FOCAL)])
    return StarField.of(rays / np.linalg.norm(rays, axis=1)[:, None], images, FOCAL)


def fit(sigma: float, freedom: int = 9) -> AttitudeFit:
    return AttitudeFit(sigma**2, freedom, np.eye(3))


@pytest.mark.parametrize(("chance", "large"), [(1.1e-4, False), (0.9e-4, True)])
@pytest.mark.parametrize("freedom", [1, 9])
def test_a_stated_sigma(chance: float, large: bool, freedom: int) -> None:
    """The sum of squares is as large by chance once in 10,000."""
    ratio = (chi2.isf(chance, freedom) / freedom) ** 0.5
    found = implausible_residuals(fit(0.0123456 * ratio, freedom), stars(6), 0.0123456, "px")
    assert found == ("the stated sigma allows 0.0123 px" if large else "")


@pytest.mark.parametrize(("sigma", "large"), [(0.499, False), (0.501, True)])
def test_two_stars_have_no_interstar_angles_to_judge_by(sigma: float, large: bool) -> None:
    found = implausible_residuals(fit(sigma, 1), stars(2), None, "px")
    assert found == ("a photograph allows 0.5 px at most" if large else "")


@pytest.mark.parametrize(("sigma", "large"), [(0.9e-6, False), (1.1e-6, True)])
def test_rounding_is_no_error(monkeypatch: pytest.MonkeyPatch, sigma: float, large: bool) -> None:
    """Where interstar angles are exact, a millionth of the principal distance is allowed."""
    monkeypatch.setattr(plausibility, "interstar_reading_sigma_mm", lambda field: 1.5e-9)
    found = implausible_residuals(fit(sigma * FOCAL), stars(8), None, "mm")
    assert found == ("the interstar angles allow 1.5e-09 mm" if large else "")


@pytest.mark.parametrize(
    ("sigma", "said"), [(0.49, ""), (0.51, "a photograph allows 0.5 mm at most")]
)
def test_no_reading_is_so_bad(monkeypatch: pytest.MonkeyPatch, sigma: float, said: str) -> None:
    monkeypatch.setattr(plausibility, "interstar_reading_sigma_mm", lambda field: 0.4)
    assert implausible_residuals(fit(sigma), stars(8), None, "mm") == said


PLATE = "coordinates of 501 mm: are they pixels? Name their columns x_px, y_px"
TWO = "two stars cannot tell what is wrong (which stars they are, their coordinates, "
TWO += "the principal distance): add a third one"
AGREE = "the stars agree with each other to 0.1 mm: is the stated sigma too small?"
NONE = "none of the common mistakes explains this (mirrored or exchanged coordinates, wrong "
NONE += "units, another camera, wrong stars)"
UNEXPLAINED: list[tuple[StarFile, str, str]] = [
    (star_file(6, largest=501.4), "0.1 mm", PLATE),
    (star_file(2, largest=501.4), "", PLATE),
    (star_file(6, largest=-501.4), "", PLATE),
    (star_file(6, largest=500.0), "", NONE),
    (star_file(6, "px", largest=501.0), "", NONE),
    (star_file(2, "px", largest=501.0), "", TWO),
    (star_file(2), "0.1 mm", TWO),
    (star_file(3), "0.1 mm", AGREE),
    (star_file(3), "", NONE),
]


@pytest.mark.parametrize(("file", "agreement", "said"), UNEXPLAINED)
def test_what_to_do(file: StarFile, agreement: str, said: str) -> None:
    assert unexplained_advice(file, agreement) == said


# How large residuals may be beside what the interstar angles say, for few stars and for more


FOCAL_MM = 50.0


def photograph(count: int) -> StarField:
    """Stars read to about .001 mm."""
    rng = np.random.default_rng(count)
    images = rng.uniform(-15.0, 15.0, (count, 2))
    rays = np.column_stack([images, np.full(count, -FOCAL_MM)])
    stars = rays / np.linalg.norm(rays, axis=1)[:, None]
    return StarField.of(stars, images + rng.normal(0.0, 1e-3, images.shape), FOCAL_MM)


@pytest.mark.parametrize(
    ("count", "times", "implausible"),
    [
        (3, 49.0, False), (3, 51.0, True), (4, 49.0, False), (4, 51.0, True),
        (5, 4.9, False), (5, 5.1, True), (12, 4.9, False), (12, 5.1, True),
    ],
)  # fmt: skip
def test_the_limit_is_five_times_and_of_four_stars_or_fewer_fifty(
    count: int, times: float, implausible: bool
) -> None:
    stars = photograph(count)
    interstar = interstar_reading_sigma_mm(stars)
    fit = fit_attitude(stars)._replace(variance_mm2=(times * interstar) ** 2)
    allowed = f"the interstar angles allow {interstar:.3g} mm"
    assert implausible_residuals(fit, stars, None, "mm") == (allowed if implausible else "")


@pytest.mark.parametrize(("off_mm", "noticed"), [(2.9e-4, False), (3.1e-4, True)])
def test_an_error_that_rounding_makes_is_no_mistake(off_mm: float, noticed: bool) -> None:
    """One star of eight exact ones is off; a millionth of the principal distance is allowed."""
    image = np.array(
        [[4, 17], [-16, -13], [-15, 15], [9, -1], [-20, 5], [2, 18], [-12, 1], [12, -7]], float
    )
    rays = np.column_stack([image, np.full(8, -76.0)])
    sky = (
        np.degrees(np.arctan2(rays[:, 1], rays[:, 0])),
        np.degrees(np.arctan2(rays[:, 2], np.hypot(rays[:, 0], rays[:, 1]))),
    )
    image[2, 0] += off_mm
    lines, names = tuple(range(2, 10)), ("",) * 8
    file = StarFile("a.csv", lines, names, image, "mm", "ra_deg,dec_deg", np.column_stack(sky))
    field = StarField.of(star_directions(*sky), image, 76.0)
    found = judge(file, field, None, ImageAxes(focal_mm=76.0))
    assert (found.sigma > 76.0e-6) == noticed
    assert [one.star for one in found.outliers] == ([2] if noticed else [])
    assert (found.mistake is not None) == bool(found.expected) == noticed
