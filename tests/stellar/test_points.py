"""Directions of points of a photograph, against hand calculation and counted errors."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import stdtrit

from tests.approved.texts import assert_approved, refused
from tests.kit.command import DECKS, vopd
from tests.kit.stars import solve_text
from tests.tolerances import assert_close, within
from vopd.findings import InputError
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.photograph import StarRequest, solve_photograph
from vopd.stellar.files.read import StarFile

FOCAL = 76.0
ALPHA, DELTA = 80.0, 10.0
EAST, NORTH, AHEAD = (
    np.array([-np.sin(a := np.radians(ALPHA)), np.cos(a), 0.0]),
    np.array([-np.sin(d := np.radians(DELTA)) * np.cos(a), -np.sin(d) * np.sin(a), np.cos(d)]),
    np.array([np.cos(d) * np.cos(a), np.cos(d) * np.sin(a), np.sin(d)]),
)
"""Of a camera with north up: x of the photograph is west."""
STARS = np.array(
    [[-18, -14], [16, -17], [12, 15], [-15, 18], [2, -3], [19, 1], [-5, 11], [-11, -2], [7, 8.0]]
)


def directions(tangents: np.ndarray) -> np.ndarray:
    """Right ascension and declination of points, degrees (n, 2)."""
    x, y = np.asarray(tangents).T
    u, v, w = (AHEAD + np.outer(y, NORTH) - np.outer(x, EAST)).T
    return np.degrees([np.arctan2(v, u), np.arctan2(w, np.hypot(u, v))]).T


def photograph(image: np.ndarray, sky: np.ndarray, unit: str = "mm") -> StarFile:
    lines, names = tuple(range(2, 2 + len(image))), ("",) * len(image)
    return StarFile("a.csv", lines, names, image, unit, "ra_deg,dec_deg", sky)


def found(file: StarFile, point: Any, axes: ImageAxes, *free: str) -> dict[str, Any]:
    request = StarRequest(axes, free=free, points=(tuple(point),))
    (one,) = solve_photograph(file, request).solved
    assert one.points is not None
    return {**one.points[0], "freedom": one.reading_freedom, "sigma": one.reading_sigma}


def test_points_by_hand() -> None:
    """Five degrees up and 5 to the left of a camera at 80, 10 with north up; y counts downward."""
    tangent = np.tan(np.radians(5.0))
    up, left = np.array([[0.0, tangent], [-tangent, 0.0]]) * FOCAL
    by_hand = [
        [80.0, 15.0],
        [80.0 + np.degrees(np.arctan2(np.sin(a := np.radians(5.0)), np.cos(a) * np.cos(d))),
         np.degrees(np.arcsin(np.sin(d) * np.cos(a)))],
    ]  # fmt: skip
    sky = directions(STARS / FOCAL)
    for down in (1.0, -1.0):
        file = photograph(STARS * [1.0, down], sky)
        axes = ImageAxes(focal_mm=FOCAL, y_down=down < 0.0)
        points = [found(file, point * [1.0, down], axes) for point in (up, left)]
        assert_close("rae angle", [[one["ra_deg"], one["dec_deg"]] for one in points], by_hand)
    pixels = photograph(STARS * [100.0, -100.0] + [2000.5, 1500.0], sky, "px")
    axes = ImageAxes(focal_px=7600.0, size_px=(4002.0, 3001.0), y_down=True)
    one = found(pixels, left * 100.0 + [2000.5, 1500.0], axes)
    assert_close("rae angle", [one["ra_deg"], one["dec_deg"]], by_hand[1])


def test_a_known_k1_goes_by_the_camera_that_is_solved() -> None:
    """Images of a lens with k1 -.2, its principal distance stated 5 % too long and solved for."""
    k1, sky = -0.2, directions(STARS / FOCAL)
    point = np.array([0.15, -0.2])
    images = [FOCAL * at * (1.0 + k1 * (at @ at)) for at in (*STARS / FOCAL, point)]
    axes = ImageAxes(focal_mm=1.05 * FOCAL, k1=k1)
    one = found(photograph(np.array(images[:-1]), sky), images[-1], axes, "focal")
    assert_close("rae angle", [one["ra_deg"], one["dec_deg"]], directions(point[None])[0])


SIGMA, DRAWN = 0.02, 200
POINT = np.array([17.0, -19.0])


@pytest.mark.parametrize("free", [(), ("focal", "k1"), ("centre",)])
def test_counted_errors_of_points(free: tuple[str, ...]) -> None:
    """Half-widths hold the true direction in 95 %, of a picture's corner too, read as the stars."""
    rng = np.random.default_rng(3)
    sky = directions(STARS / FOCAL)
    true = directions(POINT[None] / FOCAL)[0]
    inside, squares = list[bool](), list[float]()
    for _ in range(DRAWN):
        file = photograph(STARS + rng.normal(0.0, SIGMA, STARS.shape), sky)
        point = POINT + rng.normal(0.0, SIGMA, 2)
        one = found(file, point, ImageAxes(focal_mm=FOCAL), *free)
        off = np.array([one["ra_deg"], one["dec_deg"]]) - true
        sigmas = np.array([one["sigma_ra_deg"], one["sigma_dec_deg"]])
        inside += (np.abs(off) < stdtrit(one["freedom"], 0.975) * sigmas).tolist()
        squares += ((off / sigmas * one["sigma"] / SIGMA) ** 2).tolist()
    assert abs(np.mean(inside) - 0.95) < within("coverage of points")
    assert abs(np.mean(squares) - 1.0) < within("variance of points")


def test_a_point_of_two_stars_has_no_uncertainty() -> None:
    file = photograph(STARS[:2], directions(STARS[:2] / FOCAL))
    assert set(found(file, POINT, ImageAxes(focal_mm=FOCAL))) == {
        "x", "y", "ra_deg", "ra_hours", "dec_deg", "freedom", "sigma",
    }  # fmt: skip


def test_points_outside(tmp_path: Path) -> None:
    """Outside of the picture, and of the field of k1; a picture's edge is in it."""
    pixels = photograph(STARS * 100.0 + 2000.0, directions(STARS / FOCAL), "px")
    axes = ImageAxes(focal_px=7600.0, size_px=(4001.0, 4001.0), y_down=False)
    assert found(pixels, (-0.5, 4000.5), axes)
    for point in ((-0.6, 5.0), (5.0, 4000.6)):
        with refused(InputError):
            found(pixels, point, axes)
    file = photograph(STARS, directions(STARS / FOCAL))
    with refused(InputError):
        found(file, (90.0, 0.0), ImageAxes(focal_mm=FOCAL, k1=-0.3))


def test_points_beyond_the_stars() -> None:
    """Outermost are the stars at -18, -14 and -15, 18: 22.8 and 23.4 mm from the middle."""
    file = photograph(STARS, directions(STARS / FOCAL))
    for points, far in (
        (((16.5, -16.5),), []),
        (((16.6, -16.6), (0.0, 0.0), (-23.5, 0.0)), ["16.6,-16.6", "-23.5,0"]),
    ):
        request = StarRequest(ImageAxes(focal_mm=FOCAL), points=points)
        said = [str(one) for _, one in solve_photograph(file, request).findings]
        assert len(said) == bool(far)
        for text in said:
            assert_approved(text, parts=[*far, "23.4"])


ORION = (DECKS / "stars" / "orion.csv").read_text(encoding="utf-8")
CLOCK = ("--date", "2020-01-15T21:00Z", "--place", "48,11,500")


def test_points_of_the_command() -> None:
    """Text and JSON; of several methods each; of ground points in their own axes."""
    at = ("--point", "1.816,-12.990", "--point", "5,5")
    texts = [
        solve_text(ORION, *at, *CLOCK).stdout.split("\n\n")[1],
        solve_text(ORION, *at, "--method", "all").stdout.split("\n\n")[1],
    ]
    ground = DECKS / "stars" / "ground_points.csv"
    camera = ("--camera", "1000,2000,3000", "--point", "5,5")
    texts.append(
        vopd("stars", "solve", ground, "--focal", "152.4", *camera).stdout.split("\n\n")[1]
    )
    (one,) = json.loads(solve_text(ORION, *at, *CLOCK, "--format", "json").stdout)
    texts.append("\n".join(map(str, one["points"][0])))
    assert_approved(texts)


@pytest.mark.parametrize("more", [("--format", "csv"), ("--listing",), ("--point", "1")])
def test_points_that_are_refused(more: tuple[str, ...]) -> None:
    result = solve_text(ORION, "--point", "1,2", *more)
    assert result.status == 2
    assert_approved(result.stderr)
