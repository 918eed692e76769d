"""Mistakes about the camera, and two mistakes at once: they are named with what mends them."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.command import Ran, vopd
from tests.kit.star_photographs import HEAD, Star, photograph, written
from tests.tolerances import assert_close
from vopd.stellar import StarField, star_directions
from vopd.stellar.field import Failure
from vopd.stellar.methods.calibration import calibrate, calibrate_from_both_starts

PX = "x_px,y_px,ra_deg,dec_deg"
CAMERA_PX = ("--focal-px", "15200", "--size", "6000,4000", "--y-down")


def solve(text: str, *arguments: str, focal: float = 76.0) -> Ran:
    return vopd("stars", "solve", "-", "--focal", f"{focal}", *arguments, stdin=text)


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
