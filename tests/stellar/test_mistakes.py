"""Mistakes: changes, advice, and the one believed."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2
from scipy.stats import f as f_distribution

from tests.approved.texts import assert_approved
from tests.kit.command import DECKS, Ran, vopd
from tests.kit.stars import HEAD, Star, photograph, written
from tests.tolerances import assert_close, within
from vopd.mistakes import Explanation, Mistake
from vopd.stellar import find_outliers, right_ascension_declination_deg
from vopd.stellar.field import Failure, StarField, star_directions
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
    implausible_residuals,
    judge,
    simplest,
    star_mistake,
    tried,
    unexplained_advice,
)
from vopd.stellar.files.read import PixelFormat, StarFile
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm
from vopd.stellar.methods.calibration import LensOfStars, calibrate, calibrate_from_both_starts
from vopd.stellar.outlier_search import AttitudeFit, Outlier, fit_attitude

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


@pytest.mark.parametrize("unit", ["mm", "px"])
@pytest.mark.parametrize("down", ["neither", "option", "format"])
def test_other_images(unit: str, down: str) -> None:
    """Mirrored in y; and in pixels with x and y exchanged, before the principal point is taken."""
    pixels = PixelFormat(y_down=down == "format")
    axes = ImageAxes(
        focal_px=100.0, centre_px=(40.0, 50.0), y_down=True if down == "option" else None
    )
    if unit == "mm":
        axes = ImageAxes(focal_mm=100.0, y_down=True if down == "option" else None)
    stars = problem()
    first, *others = corrected(IMAGE_MISTAKES, star_file(unit, pixels=pixels), stars, axes)
    assert_approved(first[1])
    assert first[0].image_mm.tolist() == (stars.image_mm * [1, -1]).tolist()
    found = [advice for _, advice in others]
    assert bool(found) == (unit == "px")
    assert_approved(found)
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
    ((_, advice),) = corrected(IMAGE_MISTAKES, file, problem(), axes)
    assert_approved(advice)


HOURS, SWAP, RADIANS = "hours", "declination", "radians"  # a word of each advice
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
    assert_approved([advice for _, advice in found])
    for (one, advice), word in zip(found, TRIED[last], strict=True):
        assert word in advice
        assert_close("rae element", one.directions, made[word])
        assert one.image_mm.tolist() == problem().image_mm.tolist()


def test_hours_that_were_degrees() -> None:
    ((found, advice),) = corrected(
        DIRECTION_MISTAKES, star_file(kind="ra_hours,dec_deg"), problem()
    )
    assert_approved(advice)
    directions = star_directions(np.array([1.0, 3.0, 5.0]) / 15.0, SKY[:, 1])
    assert_close("rae element", found.directions, directions)
    for kind in ("u,v,w", "x_m,y_m,z_m", "name"):
        assert corrected(DIRECTION_MISTAKES, star_file(kind=kind), problem()) == []


LENS = LensOfStars(123.456789, 1.234567, -2.345678, -0.0123456)
PX = {"focal_px": 100.0, "centre_px": (2000.0, 1000.0)}
ADVICE: list[tuple[str, dict[str, Any], tuple[str, ...], bool, list[str]]] = [
    ("mm", {}, ("focal",), True, ["123.5", "--focal 123.5"]),
    ("px", PX, ("focal",), True, ["123.457", "--focal-px 123.457"]),
    ("px", PX | {"pitch_um": 5.0}, ("focal",), True, ["0.6173", "--focal 0.6173"]),
    ("mm", {}, ("k1",), True, ["--k1 -0.01235"]),
    ("mm", {"k1": 0.1}, ("k1",), True, ["--k1 0.08765"]),
    ("px", PX, ("centre",), False, []),
    ("px", PX, ("centre",), True, ["--centre 2001.23,997.654"]),
    ("px", PX | {"y_down": True}, ("centre",), True, ["--centre 2001.23,1002.35"]),
    ("mm", {}, ("centre",), True, ["x 1.235, y -2.346 mm"]),
    ("mm", {"y_down": True}, ("centre",), True, ["x 1.235, y 2.346 mm"]),
    ("mm", {}, ("focal", "k1"), True, ["--focal 123.5", "--k1 -0.01235", "--free focal,k1"]),
    (
        "px", PX, ("focal", "centre", "k1"), False,
        ["--focal-px 123.457", "--free centre", "--k1 -0.01235", "--free focal,centre,k1"],
    ),
    (
        "mm", {"free": ("focal", "centre")}, ("focal", "k1"), True,
        ["--focal 123.5", "--k1 -0.01235", "--free focal,centre,k1"],
    ),
    ("mm", {"free": ("k1",)}, ("centre",), True, ["x 1.235, y -2.346 mm", "--free centre,k1"]),
    ("mm", {"free": ("k1",)}, ("k1",), True, ["--k1 -0.01235"]),
]  # fmt: skip
"""The numbers of each advice: those of `LENS`, in the axes and units of the camera."""


@pytest.mark.parametrize(("unit", "camera", "free", "named", "parts"), ADVICE)
def test_advice_about_a_camera(
    unit: str, camera: dict[str, Any], free: tuple[str, ...], named: bool, parts: list[str]
) -> None:
    axes = ImageAxes(**({"focal_mm": 76.0} if unit == "mm" else {}) | camera)
    assert_approved(camera_advice(free, LENS, star_file(unit), axes, named=named), parts=parts)


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
    assert_approved(advice, parts=["80", "80"])
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


# What is said of residuals: what allows them, what to do about them, which mistakes are tried


FOCAL_SIZE = 50.0


def star_file_size(count: int = 6, unit: str = "mm", largest: float = 10.0) -> StarFile:
    image = np.full((count, 2), 1.0)
    image[-1, 0] = -largest
    return StarFile("a.csv", tuple(range(2, 2 + count)), ("",) * count, image, unit, "", image)


def stars_size(count: int) -> StarField:
    """Stars straight ahead, without reading errors."""
    rng = np.random.default_rng(count)
    images = rng.uniform(-15.0, 15.0, (count, 2))
    rays = np.column_stack([images, np.full(count, -FOCAL_SIZE)])
    return StarField.of(rays / np.linalg.norm(rays, axis=1)[:, None], images, FOCAL_SIZE)


def fit_size(sigma: float, freedom: int = 9) -> AttitudeFit:
    return AttitudeFit(sigma**2, freedom, np.eye(3))


@pytest.mark.parametrize(("chance", "large"), [(1.1e-4, False), (0.9e-4, True)])
@pytest.mark.parametrize("freedom", [1, 9])
def test_a_stated_sigma(chance: float, large: bool, freedom: int) -> None:
    """The sum of squares is as large by chance once in 10,000."""
    ratio = (chi2.isf(chance, freedom) / freedom) ** 0.5
    found = implausible_residuals(
        fit_size(0.0123456 * ratio, freedom), stars_size(6), 0.0123456, "px", np.nan
    )
    assert bool(found) == large
    assert_approved(found, parts=["0.0123"] if large else [])


@pytest.mark.parametrize(("sigma", "large"), [(0.499, False), (0.501, True)])
def test_two_stars_have_no_interstar_angles_to_judge_by(sigma: float, large: bool) -> None:
    found = implausible_residuals(fit_size(sigma, 1), stars_size(2), None, "px", np.nan)
    assert found == ("a photograph allows 0.5 px at most" if large else "")


@pytest.mark.parametrize(("sigma", "large"), [(0.9e-6, False), (1.1e-6, True)])
def test_rounding_is_no_error(sigma: float, large: bool) -> None:
    """Where interstar angles are exact, a millionth of the principal distance is allowed."""
    found = implausible_residuals(fit_size(sigma * FOCAL_SIZE), stars_size(8), None, "mm", 1.5e-9)
    assert bool(found) == large
    assert_approved(found, parts=["1.5e-09"] if large else [])


@pytest.mark.parametrize(("sigma", "parts"), [(0.49, []), (0.51, ["0.5 mm"])])
def test_no_reading_is_so_bad(sigma: float, parts: list[str]) -> None:
    found = implausible_residuals(fit_size(sigma), stars_size(8), None, "mm", 0.4)
    assert bool(found) == bool(parts)
    assert_approved(found, parts=parts)


PLATE, TWO, AGREE, NONE = "x_px", "two stars", "stated sigma", "none of"  # words of each advice
UNEXPLAINED: list[tuple[StarFile, str, str]] = [
    (star_file_size(6, largest=501.4), "0.1 mm", PLATE),
    (star_file_size(2, largest=501.4), "", PLATE),
    (star_file_size(6, largest=-501.4), "", PLATE),
    (star_file_size(6, largest=500.0), "", NONE),
    (star_file_size(6, "px", largest=501.0), "", NONE),
    (star_file_size(2, "px", largest=501.0), "", TWO),
    (star_file_size(2), "0.1 mm", TWO),
    (star_file_size(3), "0.1 mm", AGREE),
    (star_file_size(3), "", NONE),
]


@pytest.mark.parametrize(("file", "agreement", "word"), UNEXPLAINED)
def test_what_to_do(file: StarFile, agreement: str, word: str) -> None:
    assert_approved(unexplained_advice(file, agreement), parts=[word])


# How large residuals may be beside what the interstar angles say, for few stars and for more


FOCAL_MM = 50.0


def misread_stars(count: int) -> StarField:
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
    stars = misread_stars(count)
    interstar = float(interstar_reading_sigma_mm(stars))
    fit = fit_attitude(stars)._replace(variance_mm2=(times * interstar) ** 2)
    found = implausible_residuals(fit, stars, None, "mm", interstar)
    assert bool(found) == bool(implausible)
    assert_approved(found, parts=[f"{interstar:.3g}"] if implausible else [])


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


# Mistakes of a star file that leave large residuals: each is named, and mends the file


def solve(text: str, *arguments: str, focal: float = 76.0) -> Ran:
    return vopd("stars", "solve", "-", "--focal", f"{focal}", *arguments, stdin=text)


def misidentified(stars: list[Star]) -> Iterator[Star]:
    for k, (x, y, ra, dec) in enumerate(stars):
        yield (x, y, ra + 3.0 * (k == 2), dec)


MISTAKES: dict[str, tuple[Callable[[Star], Star], str]] = {
    "hours": (lambda s: (s[0], s[1], s[2] / 15.0, s[3]), "seems to be in hours: name its column"),
    "ra, dec": (lambda s: (s[0], s[1], s[3], s[2]), "right ascension and declination seem to be"),
    "x, y": (lambda s: (s[1], s[0], s[2], s[3]), "or x and y are exchanged"),
    "y down": (lambda s: (s[0], -s[1], s[2], s[3]), "y seems to point down: --y-down"),
}


@pytest.mark.parametrize("count", [3, 4, 10])
@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_of_coordinates_is_named(name: str, count: int) -> None:
    """The residuals without it are those of the readings: .005 mm, not millimetres."""
    make, said = MISTAKES[name]
    result = solve(written([make(star) for star in photograph(count)]))
    assert result.status == 3, result.stderr
    assert_approved(result.stderr)
    (line,) = [line for line in result.stderr.splitlines() if said in line]
    assert 0.0005 < float(line.split("then ")[1].split()[0]) < 0.015


def test_the_advice_mends_the_file() -> None:
    stars = photograph()
    good = solve(written(stars), "--format", "csv")
    assert good.status == 0 and good.stderr == ""
    in_hours = [(x, y, ra / 15.0, dec) for x, y, ra, dec in stars]
    hours = written(in_hours, HEAD.replace("ra_deg", "ra_hours"))
    down = written([(x, -y, ra, dec) for x, y, ra, dec in stars])
    expected = [float(cell) for cell in good.stdout.splitlines()[1].split(",")[2:5]]
    for result in (solve(hours, "--format", "csv"), solve(down, "--y-down", "--format", "csv")):
        assert result.status == 0 and result.stderr == ""
        found = [float(cell) for cell in result.stdout.splitlines()[1].split(",")[2:5]]
        assert_close("rae angle of seven decimals", found, expected)
    wrong = solve(written(stars), "--y-down")
    assert wrong.status == 3
    assert_approved(wrong.stderr)


@pytest.mark.parametrize("focal", [50.0, 75.0, 100.0])
def test_a_wrong_principal_distance_is_found(focal: float) -> None:
    result = solve(written(photograph()), focal=focal)
    assert result.status == 3
    found = float(result.stderr.split("--focal ")[1].split(";")[0].split(",")[0])
    assert_close("rae principal distance", found, 76.0)


@pytest.mark.parametrize("count", [4, 5, 10, 30])
def test_a_misidentified_star_is_named_and_left_out(count: int) -> None:
    text = written(list(misidentified(photograph(count))))
    plain = solve(text)
    assert plain.status == 3 and "line 4: star 3 disagrees with the others" in plain.stderr
    left_out = solve(text, "--reject", "--format", "csv")
    assert left_out.status == 0 and "line 4: star 3 is left out" in left_out.stderr
    numbers = left_out.stdout.splitlines()[1].split(",")[1].split()
    assert numbers == [str(k) for k in range(1, count + 1) if k != 3]
    if count >= 10:
        robust = solve(text, "--weights", "robust")
        assert robust.status == 0 and "star 3 disagrees with the others" in robust.stderr


def test_of_three_stars_none_can_be_accused() -> None:
    result = solve(written(list(misidentified(photograph(3)))))
    assert result.status == 3
    assert_approved(result.stderr)


def test_a_given_reading_sigma_is_the_measure() -> None:
    text = written(photograph(30))
    assert solve(text, "--reading-sigma", "0.005").stderr == ""
    small = solve(text, "--reading-sigma", "0.001")
    assert small.status == 3
    assert_approved(small.stderr)


@pytest.mark.parametrize("name", ["table_6_1", "table_6_3", "table_6_3_cosines", "orion"])
def test_good_files_draw_no_warning(name: str) -> None:
    result = vopd("stars", "solve", DECKS / "stars" / f"{name}.csv", "--focal", "76")
    assert result.status == 0 and result.stderr == ""


@pytest.mark.parametrize(("count", "wrong"), [(4, 1), (6, 2), (10, 3), (30, 8)])
def test_several_wrong_stars_do_not_hide_each_other(count: int, wrong: int) -> None:
    """Images .3 to 3 mm off among readings good to .01: none of 20 photographs is misjudged."""
    rng = np.random.default_rng(9)
    for _ in range(20):
        images = rng.uniform(-18.0, 18.0, (count, 2))
        rays = np.column_stack([images, np.full(count, -50.0)])
        rays /= np.linalg.norm(rays, axis=1)[:, None]
        read = images + rng.normal(0.0, 0.01, images.shape)
        read[:wrong] += rng.choice([-1.0, 1.0], (wrong, 2)) * rng.uniform(0.3, 3.0, (wrong, 2))
        found = find_outliers(StarField.of(rays, read, 50.0))
        assert sorted(outlier.star for outlier in found) == list(range(wrong))
        assert find_outliers(StarField.of(rays[wrong:], read[wrong:], 50.0)) == []


def test_warnings_of_one_kind_are_counted() -> None:
    """27 stars have 351 pairs; those with a poor axis are three lines and a number."""
    result = solve(written(photograph(27)), "--all-pairs", "--method", "all")
    lines = result.stderr.splitlines()
    assert 0 < len(lines) <= 8
    assert sum("rotation axis lies near" in line for line in lines) == 3
    assert any("more like these" in line for line in lines)
    assert solve(written(photograph(27)), "--all-pairs", "-q").stderr == ""


def test_a_robust_solution_marks_the_star_that_hardly_counts() -> None:
    text = written(list(misidentified(photograph(10))))
    plain, robust = solve(text), solve(text, "--weights", "robust")
    marked = [line for line in robust.stdout.splitlines() if line.strip().startswith("3 ")]
    assert marked and marked[0].rstrip().endswith("*")
    assert "* weight below 0.5" in robust.stdout
    rms = [float(run.stdout.partition("rms mm")[2].split()[0]) for run in (plain, robust)]
    assert rms[0] > 0.5 and rms[1] < 0.05


def test_a_robust_solution_in_which_no_star_counts_fully_has_the_rms_of_all() -> None:
    options = ("--weights", "robust", "--reading-sigma", "1e-6")
    result = solve(written(photograph(10)), *options, "--format", "json")
    (one,) = json.loads(result.stdout)
    assert result.status == 3 and np.max(one["weights"]) < 0.5
    assert_close("rae element", one["rms_mm"], np.sqrt(np.mean(np.square(one["residuals_mm"]))))
    assert_approved(solve(written(photograph(10)), *options).stdout.partition("* ")[2][:80])


def test_the_chance_of_an_outlier_is_that_of_the_f_distribution() -> None:
    """Of good readings few stars stand out: at most one of 100 photographs, at 1 in 1,000 each."""
    rng = np.random.default_rng(12)
    images = rng.uniform(-18.0, 18.0, (100, 8, 2))
    rays = np.concatenate([images, np.full((100, 8, 1), -50.0)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    read = images + rng.normal(0.0, 0.01, images.shape)
    found = [find_outliers(StarField.of(r, i, 50.0)) for r, i in zip(rays, read, strict=True)]
    assert sum(map(bool, found)) <= 1
    read[0, 3] += [0.12, 0.0]  # twelve deviations: the chance by scipy from the others' attitude
    (outlier,) = find_outliers(StarField.of(rays[0], read[0], 50.0))
    others = np.arange(8) != 3
    fit = fit_attitude(StarField.of(rays[0][others], read[0][others], 50.0))
    whole = fit_attitude(StarField.of(rays[0], read[0], 50.0))
    assert outlier.star == 3 and (fit.freedom, whole.freedom) == (11, 13)
    gained = whole.variance_mm2 * 13 - fit.variance_mm2 * 11
    expected = 8.0 * f_distribution.sf(gained / 2.0 / fit.variance_mm2, 2, 11)
    assert abs(outlier.chance / expected - 1.0) < within("rae outlier chance")


@pytest.mark.parametrize("count", [3, 4, 5, 12])
def test_good_photographs_are_not_called_implausible(count: int) -> None:
    """30 photographs of any attitude and reading error: no status 3."""
    rng = np.random.default_rng(60 + count)
    for _ in range(30):
        images = rng.uniform(-15.0, 15.0, (count, 2))
        rays = np.column_stack([images, np.full(count, -50.0)])
        turn = Rotation.from_quat(rng.normal(size=4)).as_matrix()
        stars = rays / np.linalg.norm(rays, axis=1)[:, None] @ turn
        read = images + rng.normal(0.0, 10.0 ** rng.uniform(-3.0, -1.3), images.shape)
        ra, dec = right_ascension_declination_deg(stars)
        columns = np.column_stack([ra, dec])
        lines = tuple(range(2, count + 2))
        file = StarFile("", lines, ("",) * count, read, "mm", "ra_deg,dec_deg", columns)
        assert judge(file, StarField.of(stars, read, 50.0), None, ImageAxes(50.0)).expected == ""


# Mistakes about the camera, and two mistakes at once: they are named with what mends them


PX_NAMED = "x_px,y_px,ra_deg,dec_deg"
CAMERA_PX = ("--focal-px", "15200", "--size", "6000,4000", "--y-down")


def solve_px(text: str, *arguments: str) -> Ran:
    return vopd("stars", "solve", "-", *arguments, stdin=text)


def exact(count: int = 10) -> list[Star]:
    """A photograph without reading errors."""
    return photograph(count, 0.0)


def in_pixels(stars: list[Star], k1: float = 0.0) -> str:
    """The photograph in pixels of 5 um, y downward, by a lens with radial distortion."""
    rows: list[Star] = []
    for x, y, ra, dec in stars:
        out = (1.0 + k1 * (x * x + y * y) / 76.0**2) / 0.005
        rows.append((2999.5 + x * out, 1999.5 - y * out, ra, dec))
    return written(rows, PX_NAMED)


def test_coordinates_from_the_corner_are_noticed() -> None:
    """The principal point is where the stars were moved to: 18, 12 mm."""
    moved = [(x + 18.0, y + 12.0, ra, dec) for x, y, ra, dec in exact()]
    wrong = solve(written(moved))
    assert wrong.status == 3
    found = re.search(r" at x (\S+), y (\S+) mm", wrong.stderr)
    assert found is not None, wrong.stderr
    assert_close("rae advised point", [float(one) for one in found.groups()], [18.0, 12.0])
    assert solve(written(moved), "--free", "centre", "-q").status == 0


def test_a_wrong_principal_point_in_pixels_is_named() -> None:
    """Width and height exchanged, or the corner for the middle, which is 2999.5, 1999.5."""
    text = in_pixels(exact())
    for wrong in (("--size", "4000,6000"), ("--centre", "0,0")):
        result = solve_px(text, "--focal-px", "15200", "--y-down", *wrong)
        assert result.status == 3
        found = re.search(r"another one: --centre (\S+),(\S+);", result.stderr)
        assert found is not None, result.stderr
        advised = [float(one) for one in found.groups()]
        assert_close("rae advised pixel", advised, [2999.5, 1999.5])
        assert solve_px(text, "--focal-px", "15200", "--y-down", *wrong, "--free", "centre",
                        "-q").status == 0  # fmt: skip


def test_distortion_of_the_lens_is_named() -> None:
    text = in_pixels(photograph(12), k1=-0.05)
    wrong = solve_px(text, *CAMERA_PX)
    assert wrong.status == 3
    found = re.search(r"--free k1, or --k1 (\S+);", wrong.stderr)
    assert found is not None, wrong.stderr
    assert_close("rae advised k1", float(found[1]), -0.05)
    assert solve_px(text, *CAMERA_PX, "--k1", found[1]).status == 0
    strong = in_pixels(photograph(12), k1=-0.5)
    both = solve_px(strong, "--focal-px", "14000", *CAMERA_PX[2:])
    assert both.status == 3
    assert_approved(both.stderr)


@pytest.mark.parametrize(
    ("options", "off"),
    [(("--focal-px", "15300"), (300.0, 240.0)), (("--free", "focal"), (200.0, 160.0))],
)
def test_a_camera_is_named_whose_errors_only_together_explain_the_residuals(
    options: tuple[str, ...], off: tuple[float, float]
) -> None:
    """A principal point off by 384 or 256 px, and distortion, which turn the axis by a degree.

    Mending one of them leaves more than a third of the residuals; mending all leaves the .1 px
    of the readings.
    """
    text = in_pixels(photograph(30, 0.0005), k1=-0.05)
    centre = ("--centre", f"{2999.5 - off[0]},{1999.5 - off[1]}", "--y-down")
    wrong = solve_px(text, *options, *centre)
    assert wrong.status == 3
    (advice,) = [line for line in wrong.stderr.splitlines() if "residuals are then" in line]
    found = re.search(r"--centre (\S+),(\S+), .* --free (\S+) solves", advice)
    assert found is not None and found[3] == "focal,centre,k1", advice
    assert_close(
        "rae advised pixel by stars", [float(one) for one in found.groups()[:2]], [2999.5, 1999.5]
    )
    assert solve_px(text, "--free", found[3], *centre, "-q").status == 0


@pytest.mark.parametrize("focal", [7.6, 760.0])
def test_a_principal_distance_in_other_units_is_named_and_solved(focal: float) -> None:
    text = written(exact())
    assert " 76 mm: --focal 76" in solve(text, focal=focal).stderr
    solved = solve(text, "--free", "focal", focal=focal)
    assert solved.status == 0
    (line,) = [line for line in solved.stdout.splitlines() if line.startswith("focal ")]
    assert_close("rae principal distance", float(line.split()[1]), 76.0)


MIRROR_NAMED, HOURS_NAMED = "--y-down (or x", "seems to be in hours"
CHANGES: dict[str, tuple[Callable[[Star], Star], float, tuple[str, ...]]] = {
    "mirror, hours": (
        lambda s: (s[0], -s[1], s[2] / 15.0, s[3]),
        76.0,
        (MIRROR_NAMED, HOURS_NAMED),
    ),
    "mirror, focal": (lambda s: (s[0], -s[1], s[2], s[3]), 50.0, (MIRROR_NAMED, "--focal 76;")),
    "hours, focal": (lambda s: (s[0], s[1], s[2] / 15.0, s[3]), 50.0, (HOURS_NAMED, "--focal 76;")),
    "mirror, corner": (
        lambda s: (s[0] + 40.0, 30.0 - s[1], s[2], s[3]),
        76.0,
        (MIRROR_NAMED, ": --free centre"),
    ),
    "radians": (
        lambda s: (s[0], s[1], float(np.radians(s[2])), float(np.radians(s[3]))),
        76.0,
        ("seem to be in radians",),
    ),
}


@pytest.mark.parametrize("name", CHANGES)
def test_two_mistakes_at_once_are_named(name: str) -> None:
    change, focal, said = CHANGES[name]
    result = solve(written([change(star) for star in photograph()]), focal=focal)
    assert result.status == 3
    (advice,) = [line for line in result.stderr.splitlines() if "residuals are then" in line]
    assert all(words in advice for words in said), advice


def all_sky(angle_by: Callable[[np.ndarray], np.ndarray], widest_deg: float = 75.0) -> str:
    """Thirty stars about the zenith of a camera in pixels, 1000, 1000 its middle.

    Args:
        angle_by: distances from the middle, px, by angles from the axis, radians
        widest_deg: angle of the outermost star
    """
    rng = np.random.default_rng(8)
    angle = np.radians(np.sqrt(rng.uniform(0.0, widest_deg**2, 30)))
    way = rng.uniform(0.0, 2.0 * np.pi, 30)
    # the axis at right ascension 0, declination 90; x toward 90 degrees, y (down) toward 0
    x, y = angle_by(angle) * [np.sin(way), np.cos(way)]
    return written(
        [
            (
                1000.0 + x[k],
                1000.0 + y[k],
                float(np.degrees(way[k])),
                90.0 - float(np.degrees(angle[k])),
            )
            for k in range(30)
        ],
        PX_NAMED,
    )


@pytest.mark.parametrize(
    "options", [("--focal-px", "640"), ("--free", "focal"), ("--free", "focal,k1")]
)
def test_a_fisheye_is_named(options: tuple[str, ...]) -> None:
    """640 px a radian, read to a pixel; the outermost angle is tried by whole degrees of 74."""
    rng = np.random.default_rng(2)
    text = all_sky(lambda angle: 640.0 * angle + rng.normal(0.0, 1.0, 30))
    for flip in ("--y-down", "--y-up"):
        result = solve_px(text, "--size", "2001,2001", flip, *options)
        told = re.search(r"a fisheye of about (\S+) px a radian", result.stderr)
        if told is not None:
            break
    assert told is not None, result.stderr
    assert result.status in (1, 3)
    assert_close("rae fisheye", float(told[1]), 640.0)


def test_a_wide_photograph_in_central_projection_is_no_fisheye() -> None:
    """Half of the stars have the place of another: nothing fits."""
    lines = all_sky(lambda angle: 640.0 * np.tan(angle), 50.0).splitlines()
    cells = [line.split(",") for line in lines[1:]]
    wrong = [
        ",".join(one[:2] + other[2:])
        for one, other in zip(cells, cells[15:] + cells[:15], strict=True)
    ]
    result = solve_px("\n".join([lines[0], *wrong, ""]), "--size", "2001,2001", "--focal-px", "640")
    assert result.status in (1, 3) and "fisheye" not in result.stderr


def test_degrees_in_a_column_of_hours_are_named() -> None:
    """Right ascensions from 0 to 24 degrees, which are hours as well."""
    stars = [(x, y, ra - 53.0, dec) for x, y, ra, dec in photograph(20) if 53.0 < ra < 77.0]
    result = solve(written(stars, HEAD.replace("ra_deg", "ra_hours")))
    assert result.status == 3
    assert_approved(result.stderr)


def test_pixels_in_columns_of_millimetres_are_noticed() -> None:
    result = solve(in_pixels(photograph()).replace(PX_NAMED, HEAD), focal=50.0)
    assert result.status == 3
    assert_approved(result.stderr)


def test_exchanged_pixels_are_named() -> None:
    """The origin lies in the corner, so that exchanging x and y is more than a mirror image."""
    head = "y_px,x_px,ra_deg,dec_deg"
    result = solve_px(in_pixels(photograph()).replace(PX_NAMED, head), *CAMERA_PX)
    assert result.status == 3
    assert_approved(result.stderr)


def test_stars_in_another_order_get_no_absurd_advice() -> None:
    stars = exact()
    others = stars[1:] + stars[:1]
    shifted = [(*image[:2], *star[2:]) for image, star in zip(stars, others, strict=True)]
    result = solve(written(shifted))
    assert result.status == 3
    assert_approved(result.stderr)


def test_two_stars_are_tested_by_the_angle_between_them() -> None:
    """Good to .005 mm; with a principal distance a tenth too long nothing fits."""
    text = written(photograph(2))
    good = solve(text)
    assert good.status == 0 and good.stderr == ""
    assert_approved(good.stdout)
    assert solve(text, "--reading-sigma", "0.005").status == 0
    wrong = solve(text, "--reading-sigma", "0.005", focal=83.6)
    assert wrong.status == 3
    assert_approved(wrong.stderr)


def test_a_camera_is_not_solved_with_the_stars_behind_it() -> None:
    """A mirrored photograph fits a camera that looks the other way; that is no solution."""
    stars = np.array(exact())
    mirrored = stars[:, :2] * [1.0, -1.0]
    field = StarField.of(star_directions(stars[:, 2], stars[:, 3]), mirrored, 76.0)
    behind = Rotation.from_euler("zyx", [65.0, -20.0, 30.0], degrees=True).as_matrix()
    axes = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]) @ behind.T
    start = axes * [[1.0], [-1.0], [1.0]] * np.linalg.det(axes * [[1.0], [-1.0], [1.0]])
    found = calibrate(field, start, ("centre_x", "centre_y"))
    assert found.failure != Failure.NONE
    assert calibrate_from_both_starts(field, ("centre_x", "centre_y")).failure != Failure.NONE
    text = written([tuple(star) for star in np.column_stack([mirrored, stars[:, 2:]])])  # type: ignore[misc]
    refusal = solve(text, "--free", "centre")
    assert refusal.status == 1 and refusal.stdout == "" and MIRROR_NAMED in refusal.stderr
