"""Principal distance, principal point and distortion solved with the attitude."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.command import Ran, vopd
from tests.tolerances import assert_close, within
from vopd.stellar import StarField, wahba
from vopd.stellar.field import Failure
from vopd.stellar.methods.calibration import UNKNOWNS, calibrate

LOOK = Rotation.from_euler("ZYX", [100.0, -40.0, 15.0], degrees=True).as_matrix()
FOCAL, CENTRE, K1, SIGMA = 2400.0, np.array([14.0, -9.0]), -0.08, 0.3
SIZE = (3000, 2000)


def sky(count: int, half: tuple[float, float] = (0.6, 0.4), seed: int = 2) -> np.ndarray:
    """Directions of stars over a field of these tangents, (n, 3), and their tangents."""
    rng = np.random.default_rng(seed)
    return rng.uniform([-half[0], -half[1]], half, (count, 2))


def stars_of(tangents: np.ndarray) -> np.ndarray:
    rays = np.column_stack([tangents, np.full(len(tangents), -1.0)])
    return rays / np.linalg.norm(rays, axis=1)[:, None] @ LOOK


def images_of(tangents: np.ndarray, k1: float = K1) -> np.ndarray:
    """Images in pixels from near the principal point, y up."""
    r2 = (tangents**2).sum(axis=1, keepdims=True)
    return CENTRE + FOCAL * tangents * (1.0 + k1 * r2)


def test_counted_errors_have_the_stated_covariance() -> None:
    """Of 400 draws: the squares of errors over the covariance, and each deviation."""
    tangents = sky(40)
    exact, stars = images_of(tangents), stars_of(tangents)
    rng = np.random.default_rng(4)
    scaled, squares = [], []
    for _ in range(400):
        field = StarField.of(stars, exact + rng.normal(0.0, SIGMA, exact.shape), FOCAL * 1.01)
        found = calibrate(field, wahba(field).matrix, UNKNOWNS)
        assert found.failure == Failure.NONE
        turn = Rotation.from_matrix(found.matrix @ LOOK.T).as_rotvec()
        error = np.array([*turn, *(np.array(found.lens) - [FOCAL, *CENTRE, K1])])
        covariance = found.covariance * SIGMA**2
        scaled.append(error / np.sqrt(np.diag(covariance)))
        squares.append(error @ np.linalg.solve(covariance, error))
    assert np.abs(np.std(scaled, axis=0) - 1.0).max() < within("rae resection sigma")
    assert abs(np.mean(squares) / 7.0 - 1.0) < within("rae resection sigma")


def written(images: np.ndarray, stars: np.ndarray) -> str:
    """Pixels of a picture of SIZE, y downward, and direction cosines."""
    pixels = (np.array(SIZE) - 1.0) / 2.0 + images * [1.0, -1.0]
    rows = (",".join(f"{v:.17g}" for v in row) for row in np.column_stack([pixels, stars]))
    return "\n".join(["x_px,y_px,u,v,w", *rows]) + "\n"


def solve(text: str, *arguments: str) -> Ran:
    return vopd("stars", "solve", "-", "--size", "3000,2000", "--y-down", "--format", "json",
                *arguments, stdin=text)  # fmt: skip


def solved(text: str, *arguments: str) -> dict[str, Any]:
    result = solve(text, *arguments)
    assert result.status == 0, result.stderr
    (row,) = json.loads(result.stdout)
    return row  # type: ignore[no-any-return]


def test_the_command_finds_an_exact_camera() -> None:
    """The principal point in the file's coordinates: y down from the middle of the picture."""
    tangents = sky(12)
    text = written(images_of(tangents), stars_of(tangents))
    row = solved(text, "--focal-px", "2300", "--free", "focal,centre,k1")
    found = [row["focal_px"], row["centre_x_px"], row["centre_y_px"], row["k1"]]
    assert_close("rae exact camera", found, [FOCAL, 1499.5 + 14.0, 999.5 + 9.0, K1])
    assert np.abs(np.array(row["matrix"]) - LOOK).max() < within("rae weighted element")
    given = ("--focal-px", str(FOCAL), "--centre", "1513.5,1008.5", "--k1", str(K1))
    again = solved(text, *given)
    assert np.abs(np.array(again["matrix"]) - LOOK).max() < within("rae weighted element")
    assert_close("residual", again["residuals_px"], np.zeros((12, 2)))


def test_the_reading_error_has_fewer_degrees_of_freedom() -> None:
    tangents = sky(12)
    read = images_of(tangents) + np.random.default_rng(5).normal(0.0, SIGMA, (12, 2))
    row = solved(written(read, stars_of(tangents)), "--focal-px", "2400", "--free", "focal,k1")
    assert row["reading_freedom"] == 2 * 12 - 3 - 2
    assert {"sigma_focal_px", "sigma_k1"} <= set(row) and "centre_x_px" not in row
    text = vopd("stars", "solve", "-", "--size", "3000,2000", "--y-down", "--focal-px", "2400",
                "--free", "focal", stdin=written(read, stars_of(tangents))).stdout  # fmt: skip
    assert "focal 2" in text and "standard deviation" in text


def test_a_narrow_field_does_not_hold_the_camera() -> None:
    tangents = sky(12, half=(0.03, 0.03))
    read = images_of(tangents) + np.random.default_rng(5).normal(0.0, SIGMA, (12, 2))
    text = written(read, stars_of(tangents))
    result = solve(text, "--focal-px", "2400", "--free", "focal,centre,k1")
    assert "can hardly tell focal, centre_x, centre_y and k1 from" in result.stderr
    assert "the stars do not hold k1" in result.stderr
    wide = sky(40)
    read = images_of(wide) + np.random.default_rng(5).normal(0.0, SIGMA, (40, 2))
    quiet = solve(written(read, stars_of(wide)), "--focal-px", "2400", "--free", "focal,centre,k1")
    assert quiet.status == 0 and quiet.stderr == ""


def test_a_wrong_star_is_rejected_and_the_camera_solved_again() -> None:
    tangents = sky(30)
    read = images_of(tangents) + np.random.default_rng(6).normal(0.0, SIGMA, (30, 2))
    read[7] += [25.0, -30.0]
    free = ("--focal-px", "2400", "--free", "focal,centre,k1")
    row = solved(written(read, stars_of(tangents)), *free, "--reject")
    good = np.delete(np.arange(30), 7)
    same = solved(written(read[good], stars_of(tangents)[good]), *free)
    assert 8 not in row["stars"] and len(row["stars"]) == 29
    assert_close("rae exact camera", row["focal_px"], same["focal_px"])


REFUSED = {
    "too few": (3, ("--free", "focal,centre,k1"), 1, "takes 4 stars at least"),
    "a name": (9, ("--free", "focal,k2"), 2, "'k2' is not one of focal, centre, k1"),
    "k1 twice": (9, ("--free", "k1", "--k1", "0.1"), 2, "--k1 and --free k1 exclude"),
    "a method": (9, ("--free", "focal", "--method", "svd"), 2, "--free and --method exclude"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_solved_is_refused(name: str) -> None:
    count, options, status, said = REFUSED[name]
    tangents = sky(count)
    text = written(images_of(tangents), stars_of(tangents))
    result = solve(text, "--focal-px", "2400", *options)
    assert result.status == status and said in result.stderr, result.stderr
