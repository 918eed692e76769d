"""Mistakes: changes, advice, and the one believed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.stats import f as f_distribution

from tests.tolerances import assert_close
from vopd.mistakes import Explanation, Mistake
from vopd.stellar.field import StarField, star_directions
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mistakes import (
    DIRECTION_MISTAKES,
    IMAGE_MISTAKES,
    SEVERAL_OF_CAMERA,
    TWO_MISTAKES,
    Corrected,
    believed,
    camera_advice,
    camera_mistake,
    simplest,
    star_mistake,
    tried,
)
from vopd.stellar.files.read import PixelFormat, StarFile
from vopd.stellar.methods.calibration import LensOfStars
from vopd.stellar.outlier_search import AttitudeFit, Outlier

# What undoing each common mistake does to a photograph, when it is tried, and the advice


IMAGE = np.array([[10.0, 30.0], [50.0, 20.0], [70.0, 90.0]])
SKY = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])


AXES = ImageAxes(focal_mm=100.0)
UNSOLVED = AttitudeFit(np.inf, 1, np.eye(3))


def star_file(unit: str = "mm", kind: str = "ra_deg,dec_deg", **more: Any) -> StarFile:
    given: dict[str, Any] = {"image": IMAGE, "positions": SKY} | more
    return StarFile(
        "a.csv", (2, 3, 4), ("",) * 3, given.pop("image"), unit, kind, given.pop("positions"),
        **given,
    )  # fmt: skip


def problem(focal: float = 100.0) -> StarField:
    return StarField.of(star_directions(SKY[:, 0], SKY[:, 1]), IMAGE - [40.0, 50.0], focal)


def corrected(
    mistakes: tuple[Mistake[Corrected], ...], file: StarFile, stars: StarField,
    axes: ImageAxes = AXES, fit: AttitudeFit = UNSOLVED,
) -> list[tuple[StarField, str]]:  # fmt: skip
    """The problems with each mistake corrected, and the advice."""
    return [
        (one.stars, mistake.advice.format(*values))
        for mistake in mistakes
        for one, values in mistake.change(file, stars, axes, fit)
    ]


MIRROR = "the photograph is a mirror image of the sky: y seems to point {} "
MIRROR += "(or x and y are exchanged; only the swing tells which)"
EXCHANGED = "x_px and y_px seem to be exchanged"


@pytest.mark.parametrize("unit", ["mm", "px"])
@pytest.mark.parametrize("down", ["neither", "option", "format"])
def test_other_images(unit: str, down: str) -> None:
    """Mirrored in y; and in pixels with x and y exchanged, before the principal point is taken."""
    pixels = PixelFormat(y_down=down == "format")
    axes = ImageAxes(focal_px=100.0, centre_px=(40.0, 50.0), y_down=down == "option")
    if unit == "mm":
        axes = ImageAxes(focal_mm=100.0, y_down=down == "option")
    stars = problem()
    first, *others = corrected(IMAGE_MISTAKES, star_file(unit, pixels=pixels), stars, axes)
    way = "down: --y-down" if down == "neither" else "up: no --y-down"
    assert first[1] == MIRROR.format(way)
    assert first[0].image_mm.tolist() == (stars.image_mm * [1, -1]).tolist()
    assert [advice for _, advice in others] == ([EXCHANGED] if unit == "px" else [])
    for one, _ in others:
        sign = 1.0 if down == "neither" else -1.0
        swapped = [[-10.0, -40.0 * sign], [-20.0, 0.0], [50.0, 20.0 * sign]]
        assert_close("rae element", one.image_mm, swapped)
    for one, _ in (first, *others):
        assert one.directions.tolist() == stars.directions.tolist()


def test_images_exchanged_are_not_tried_where_the_lens_does_not_hold() -> None:
    """A barrel of -.3 turns back at a tangent of 1.05: 50, 0 has no image in it."""
    axes = ImageAxes(focal_px=60.0, centre_px=(0.0, 20.0), k1=-0.3)
    file = star_file("px", image=np.array([[0.0, 20.0], [0.0, 60.0], [5.0, 25.0]]))
    assert [advice for _, advice in corrected(IMAGE_MISTAKES, file, problem(), axes)] == [
        MIRROR.format("down: --y-down")
    ]


HOURS = "right ascension seems to be in hours: name its column ra_hours"
DEGREES = "right ascension seems to be in degrees: name its column ra_deg"
SWAP = "right ascension and declination seem to be exchanged"
RADIANS = "right ascension and declination seem to be in radians: write degrees"
TRIED = {  # the right ascension and declination of the last star: what is tried
    (24.0, 6.0): [HOURS, SWAP],
    (-24.0, 6.0): [HOURS, SWAP],
    (24.1, 6.0): [SWAP],
    (90.0, 6.0): [SWAP],
    (-90.1, 6.0): [],
    (90.1, 6.0): [],
    (6.28, 1.57): [HOURS, SWAP, RADIANS],
    (-6.28, -1.57): [HOURS, SWAP, RADIANS],
    (6.29, 1.57): [HOURS, SWAP],
    (6.28, 1.58): [HOURS, SWAP],
    (1.0, -1.58): [HOURS, SWAP],
}


@pytest.mark.parametrize("last", TRIED)
def test_other_directions(last: tuple[float, float]) -> None:
    """Each is tried where all stars allow it, and leaves the images as they are."""
    positions = np.array([[1.0, 0.5], [2.0, -0.25], last])
    ra, dec = positions.T
    made = {
        HOURS: star_directions(ra * 15.0, dec),
        SWAP: star_directions(dec, ra),
        RADIANS: star_directions(np.degrees(ra), np.degrees(dec)),
    }
    found = corrected(DIRECTION_MISTAKES, star_file(positions=positions), problem())
    assert [advice for _, advice in found] == TRIED[last]
    for one, advice in found:
        assert_close("rae element", one.directions, made[advice])
        assert one.image_mm.tolist() == problem().image_mm.tolist()


def test_hours_that_were_degrees() -> None:
    ((found, advice),) = corrected(
        DIRECTION_MISTAKES, star_file(kind="ra_hours,dec_deg"), problem()
    )
    assert advice == DEGREES
    directions = star_directions(np.array([1.0, 3.0, 5.0]) / 15.0, SKY[:, 1])
    assert_close("rae element", found.directions, directions)
    for kind in ("u,v,w", "x_m,y_m,z_m", "name"):
        assert corrected(DIRECTION_MISTAKES, star_file(kind=kind), problem()) == []


LENS = LensOfStars(123.456789, 1.234567, -2.345678, -0.0123456)
FOCAL = "the principal distance seems to be "
POINT = "the principal point seems to be "
K1 = "the lens seems to distort the image: --free k1, or --k1 "
PX = {"focal_px": 100.0, "centre_px": (2000.0, 1000.0)}
ADVICE: list[tuple[str, dict[str, Any], tuple[str, ...], bool, str]] = [
    ("mm", {}, ("focal",), True, FOCAL + "123.5 mm: --focal 123.5"),
    ("px", PX, ("focal",), True, FOCAL + "123.457 px: --focal-px 123.457"),
    ("px", PX | {"pitch_um": 5.0}, ("focal",), True, FOCAL + "0.6173 mm: --focal 0.6173"),
    ("mm", {}, ("k1",), True, K1 + "-0.01235"),
    ("mm", {"k1": 0.1}, ("k1",), True, K1 + "0.08765"),
    ("px", PX, ("centre",), False, POINT + "another one: --free centre"),
    ("px", PX, ("centre",), True, POINT + "another one: --centre 2001.23,997.654"),
    (
        "px", PX | {"y_down": True}, ("centre",), True,
        POINT + "another one: --centre 2001.23,1002.35",
    ),
    (
        "mm", {}, ("centre",), True, POINT + "at x 1.235, y -2.346 mm of the file: subtract them "
        "from its coordinates, or --free centre",
    ),
    (
        "mm", {"y_down": True}, ("centre",), True, POINT + "at x 1.235, y 2.346 mm of the file: "
        "subtract them from its coordinates, or --free centre",
    ),
    (
        "mm", {}, ("focal", "k1"), True, FOCAL + "123.5 mm: --focal 123.5, and " + K1
        + "-0.01235; --free focal,k1 solves them together",
    ),
    (
        "px", PX, ("focal", "centre", "k1"), False, FOCAL + "123.457 px: --focal-px 123.457, and "
        + POINT + "another one: --free centre, and " + K1
        + "-0.01235; --free focal,centre,k1 solves them together",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("unit", "camera", "free", "named", "advice"), ADVICE)
def test_advice_about_a_camera(
    unit: str, camera: dict[str, Any], free: tuple[str, ...], named: bool, advice: str
) -> None:
    axes = ImageAxes(**({"focal_mm": 76.0} if unit == "mm" else {}) | camera)
    assert camera_advice(free, LENS, star_file(unit), axes, named=named) == advice


def test_which_mistakes_are_tried_together() -> None:
    """Two mistakes of images or of directions are never, nor two of a camera and of stars."""
    assert len(IMAGE_MISTAKES) * len(DIRECTION_MISTAKES) == 8
    assert len(TWO_MISTAKES) == 8 + (2 + 4) * 4
    names = [one.name for one in TWO_MISTAKES]
    assert "a mirror image, and radians" in names and "radians, and wrong stars" in names
    assert [one.name for one in SEVERAL_OF_CAMERA] == [
        "another focal and k1", "another focal and centre", "another focal and centre and k1",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("free", "least"),
    [(("focal",), 3), (("centre",), 3), (("k1",), 3), (("focal", "k1"), 3),
     (("focal", "centre"), 4), (("focal", "centre", "k1"), 4)],
)  # fmt: skip
def test_how_many_stars_a_camera_takes(free: tuple[str, ...], least: int) -> None:
    """Two coordinates each: three for the attitude, one an unknown, and one to judge it by."""
    rng = np.random.default_rng(7)
    for count, solved in ((least - 1, False), (least, True)):
        image = rng.uniform(-20.0, 20.0, (count, 2)) + np.array([[0.0, 5.0]])
        rays = np.column_stack([image, np.full(count, -80.0)])
        rays /= np.linalg.norm(rays, axis=1)[:, None]
        stars = StarField.of(rays, image, 76.0)
        axes = ImageAxes(focal_mm=76.0)
        found = corrected((camera_mistake(*free),), star_file(), stars, axes)
        assert bool(found) == solved


@pytest.mark.parametrize("far", [False, True])
def test_a_camera_that_fits(far: bool) -> None:
    """Images of 80 mm where 76 are stated: exact, so that the variance is that of rounding."""
    rng = np.random.default_rng(3)
    image = rng.uniform(-20.0, 20.0, (8, 2))
    rays = np.column_stack([image, np.full(8, -80.0)])
    stars = StarField.of(rays / np.linalg.norm(rays, axis=1)[:, None], image, 76.0)
    axes = ImageAxes(focal_mm=76.0)
    near = AttitudeFit(1e-4, 13, np.eye(3))
    change = camera_mistake("focal").change(star_file(), stars, axes, UNSOLVED if far else near)
    ((found, (advice,)),) = change
    assert advice == FOCAL + "80 mm: --focal 80"
    assert found.fit is not None
    assert_close("rae element", found.fit.matrix, np.eye(3))
    assert found.fit.freedom == 16 - 4
    assert_close("rae element", found.fit.variance_mm2 / (1e-18 * 80.0**2), 1.0)
    assert_close("rae angle", found.stars.focal_length_mm, [80.0])


# When a mistake is believed: limits of gain, size and chance, and what is tried for it


FOCAL_MISTAKES = 50.0


def stars(count: int = 6, sigma: float = 0.0, moved: tuple[int, ...] = ()) -> StarField:
    """Stars straight ahead, read with errors of this size, some of them moved by 2 mm."""
    rng = np.random.default_rng(count)
    images = rng.uniform(-15.0, 15.0, (count, 2))
    rays = np.column_stack([images, np.full(count, -FOCAL_MISTAKES)])
    images = images + rng.normal(0.0, sigma, images.shape) if sigma else images
    images[list(moved)] += 2.0
    return StarField.of(rays / np.linalg.norm(rays, axis=1)[:, None], images, FOCAL_MISTAKES)


def fit(variance: float, freedom: int = 9) -> AttitudeFit:
    return AttitudeFit(variance, freedom, np.eye(3))


@pytest.mark.parametrize(("gain", "sigma"), [(8.9, np.inf), (9.1, 0.02)])
def test_the_variance_must_be_nine_times_smaller(gain: float, sigma: float) -> None:
    assert believed(fit(0.0004, 99), fit(gain * 0.0004, 99), stars()) == sigma


@pytest.mark.parametrize(("sigma", "is_reading"), [(0.499, True), (0.501, False)])
def test_what_is_left_must_be_a_reading(sigma: float, is_reading: bool) -> None:
    """A hundredth of the principal distance, .5 mm, is no reading's error."""
    assert np.isfinite(believed(fit(sigma**2, 99), fit(100.0, 99), stars())) == is_reading


@pytest.mark.parametrize(("chance", "is_rare"), [(1.1e-4, False), (0.9e-4, True)])
@pytest.mark.parametrize("freedom", [(3, 9), (9, 7)])
def test_chance_must_not_explain_it(chance: float, is_rare: bool, freedom: tuple[int, int]) -> None:
    ratio = float(f_distribution.isf(chance, *freedom))
    assert ratio > 9.0
    found = believed(fit(1e-6, freedom[1]), fit(ratio * 1e-6, freedom[0]), stars())
    assert np.isfinite(found) == is_rare


def test_whatever_fits_is_better_than_no_attitude() -> None:
    assert believed(fit(1e-6, 1), fit(np.inf, 1), stars()) == 0.001


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
    wrong = star_mistake([Outlier(k, 1.0, 0.0) for k in moved])
    (found,) = tried((wrong,), star_file(), field, fit(1.0), AXES)
    assert (found.advice, found.points) == (advice, tuple(sorted(moved)))
    assert 0.1 < 1000.0 * found.residual < 3.0


def test_three_stars_at_least_are_left() -> None:
    for count, wrong in ((4, True), (5, False)):
        outliers = [Outlier(k, 1.0, 0.0) for k in (0, 1)]
        found = corrected((star_mistake(outliers),), star_file(), stars(count, 0.001, (0, 1)))
        assert (found == []) == wrong
    assert corrected((star_mistake([]),), star_file(), stars()) == []


# Which mistake is taken of several, which are tried alone, and which together


def sized(*sigmas: float, about: tuple[int, ...] = ()) -> list[Explanation]:
    """Mistakes a, b, c that leave these residuals; some are about a star."""
    return [
        Explanation(sigma, "abc"[k], (1,) if k in about else ()) for k, sigma in enumerate(sigmas)
    ]


BEST = [
    (sized(3.0, 1.0, 2.0), "b"),
    (sized(1.0, 1.0, 1.0), "a"),
    (sized(1.004, 1.003, 1.0), "a"),  # to three digits all are 1.00
    (sized(1.006, 1.003, 1.0), "b"),
    (sized(1.0, 2.9, about=(0,)), "b"),  # one about all stars before one about some
    (sized(1.0, 3.1, about=(0,)), "a"),
    (sized(1.0, 2.9, 2.0, about=(0, 2)), "b"),
    (sized(2.0, 1.0, about=(0, 1)), "b"),
    (sized(np.inf, 2.0, np.inf), "b"),
]


@pytest.mark.parametrize(("several", "best"), BEST)
def test_the_best_of_several(several: list[Explanation], best: str) -> None:
    found = simplest(several)
    assert found is not None and found.advice == best
    assert simplest(sized(np.inf)) is None and simplest([]) is None
