"""Photographs with one or two mistakes, which are named."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import f as f_distribution

from tests.kit.command import DECKS, Ran, vopd
from tests.kit.stars import HEAD, Star, photograph, written
from tests.tolerances import assert_close, within
from vopd.stellar import StarField, find_outliers, right_ascension_declination_deg, star_directions
from vopd.stellar.field import Failure
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.mistakes import judge
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.calibration import calibrate, calibrate_from_both_starts
from vopd.stellar.outlier_search import fit_attitude

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
    assert "the residuals are implausible" in result.stderr
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
    assert wrong.status == 3 and "y seems to point up: no --y-down" in wrong.stderr


@pytest.mark.parametrize("focal", [50.0, 75.0, 100.0])
def test_a_wrong_principal_distance_is_found(focal: float) -> None:
    result = solve(written(photograph()), focal=focal)
    assert result.status == 3
    found = float(result.stderr.split("principal distance seems to be ")[1].split()[0])
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
    assert result.status == 3 and "none of the common mistakes explains this" in result.stderr


def test_a_given_reading_sigma_is_the_measure() -> None:
    text = written(photograph(30))
    assert solve(text, "--reading-sigma", "0.005").stderr == ""
    small = solve(text, "--reading-sigma", "0.001")
    assert small.status == 3 and "the stated sigma allows 0.001 mm" in small.stderr
    assert "is the stated sigma too small?" in small.stderr


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
    rms = [float(run.stdout.splitlines()[1].split()[8]) for run in (plain, robust)]
    assert rms[0] > 0.5 and rms[1] < 0.05


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


PX = "x_px,y_px,ra_deg,dec_deg"
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
    return written(rows, PX)


def test_coordinates_from_the_corner_are_noticed() -> None:
    """The principal point is where the stars were moved to: 18, 12 mm."""
    moved = [(x + 18.0, y + 12.0, ra, dec) for x, y, ra, dec in exact()]
    wrong = solve(written(moved))
    assert wrong.status == 3
    found = re.search(r"principal point seems to be at x (\S+), y (\S+) mm", wrong.stderr)
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
    found = re.search(r"the lens seems to distort the image: --free k1, or --k1 (\S+);",
                      wrong.stderr)  # fmt: skip
    assert found is not None, wrong.stderr
    assert_close("rae advised k1", float(found[1]), -0.05)
    assert solve_px(text, *CAMERA_PX, "--k1", found[1]).status == 0
    strong = in_pixels(photograph(12), k1=-0.5)
    both = solve_px(strong, "--focal-px", "14000", *CAMERA_PX[2:])
    assert both.status == 3 and "--free focal,k1 solves them together" in both.stderr


@pytest.mark.parametrize("focal", [7.6, 760.0])
def test_a_principal_distance_in_other_units_is_named_and_solved(focal: float) -> None:
    text = written(exact())
    assert "principal distance seems to be 76 mm: --focal 76" in solve(text, focal=focal).stderr
    solved = solve(text, "--free", "focal", focal=focal)
    assert solved.status == 0
    (line,) = [line for line in solved.stdout.splitlines() if line.startswith("focal ")]
    assert_close("rae principal distance", float(line.split()[1]), 76.0)


MIRROR, HOURS = "--y-down (or x and y", "seems to be in hours"
CHANGES: dict[str, tuple[Callable[[Star], Star], float, tuple[str, ...]]] = {
    "mirror, hours": (lambda s: (s[0], -s[1], s[2] / 15.0, s[3]), 76.0, (MIRROR, HOURS)),
    "mirror, focal": (lambda s: (s[0], -s[1], s[2], s[3]), 50.0, (MIRROR, "--focal 76;")),
    "hours, focal": (lambda s: (s[0], s[1], s[2] / 15.0, s[3]), 50.0, (HOURS, "--focal 76;")),
    "mirror, corner": (
        lambda s: (s[0] + 40.0, 30.0 - s[1], s[2], s[3]),
        76.0,
        (MIRROR, "the principal point seems to be another one: --free centre"),
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


def test_degrees_in_a_column_of_hours_are_named() -> None:
    """Right ascensions from 0 to 24 degrees, which are hours as well."""
    stars = [(x, y, ra - 53.0, dec) for x, y, ra, dec in photograph(20) if 53.0 < ra < 77.0]
    result = solve(written(stars, HEAD.replace("ra_deg", "ra_hours")))
    assert result.status == 3
    assert "right ascension seems to be in degrees: name its column ra_deg" in result.stderr


def test_pixels_in_columns_of_millimetres_are_noticed() -> None:
    result = solve(in_pixels(photograph()).replace(PX, HEAD), focal=50.0)
    assert result.status == 3 and "are they pixels? Name their columns x_px, y_px" in result.stderr


def test_exchanged_pixels_are_named() -> None:
    """The origin lies in the corner, so that exchanging x and y is more than a mirror image."""
    head = "y_px,x_px,ra_deg,dec_deg"
    result = solve_px(in_pixels(photograph()).replace(PX, head), *CAMERA_PX)
    assert result.status == 3 and "x_px and y_px seem to be exchanged" in result.stderr


def test_stars_in_another_order_get_no_absurd_advice() -> None:
    stars = exact()
    others = stars[1:] + stars[:1]
    shifted = [(*image[:2], *star[2:]) for image, star in zip(stars, others, strict=True)]
    result = solve(written(shifted))
    assert result.status == 3 and "none of the common mistakes explains this" in result.stderr


def test_two_stars_are_tested_by_the_angle_between_them() -> None:
    """Good to .005 mm; with a principal distance a tenth too long nothing fits."""
    text = written(photograph(2))
    good = solve(text)
    assert good.status == 0 and good.stderr == ""
    assert "no standard deviations: two stars do not tell the reading error" in good.stdout
    assert solve(text, "--reading-sigma", "0.005").status == 0
    wrong = solve(text, "--reading-sigma", "0.005", focal=83.6)
    assert wrong.status == 3 and "two stars cannot tell what is wrong" in wrong.stderr


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
    refused = solve(text, "--free", "centre")
    assert refused.status == 1 and refused.stdout == "" and MIRROR in refused.stderr
