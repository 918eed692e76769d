"""The rotation of every frame against scipy's least squares a frame at a time."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.kit.random_flights import Sightings, lenses, random_frame
from tests.tolerances import within
from vopd.flight import solve
from vopd.flight.solve import CAUCHY, HUBER, Attitudes, solve_rotations
from vopd.geometry.lenses import project

LENSES = lenses()
LOOKS = ("", "", "up", "down")
FRAMES = 12


def flight(
    name: str, seed: int, noise_px: float, fewest: int = 2
) -> tuple[list[Sightings], np.ndarray]:
    """Frames of two to eight landmarks, and the standard deviation of every pick."""
    rng = np.random.default_rng(seed)
    frames = [
        random_frame(rng, LENSES[name], int(rng.integers(fewest, 9)), noise_px, LOOKS[k % 4])
        for k in range(FRAMES)
    ]
    return frames, np.exp(rng.uniform(-0.5, 0.5, sum(len(f.pixel) for f in frames)))


def solved(frames: list[Sightings], sigma: np.ndarray, loss: str = "least-squares") -> Attitudes:
    return solve_rotations(
        frames[0].lens,
        len(frames),
        np.concatenate([np.full(len(f.pixel), k) for k, f in enumerate(frames)]),
        np.concatenate([f.pixel for f in frames]),
        sigma,
        np.concatenate([f.direction for f in frames]),
        np.ones(len(sigma), bool),
        loss,
    )


def residuals(frame: Sightings, sigma: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    image = project(frame.lens, frame.direction @ rotation.T).pixel
    return np.asarray((frame.pixel - image) / sigma[:, None])


def picks(frames: list[Sightings], sigma: np.ndarray) -> list[np.ndarray]:
    return np.split(sigma, np.cumsum([len(f.pixel) for f in frames])[:-1])


@pytest.mark.parametrize("name", list(LENSES))
def test_rotations_are_those_of_scipy(name: str) -> None:
    frames, sigma = flight(name, 20, 0.0)
    rng = np.random.default_rng(21)
    for frame in frames:  # noise so small that scipy's sum of squares shows a turn of 1e-9 degree
        frame.pixel[:] += rng.normal(0.0, 1e-3, frame.pixel.shape)
    found = solved(frames, sigma)
    assert found.converged.all()
    for frame, own, rotation in zip(frames, picks(frames, sigma), found.rotation, strict=True):

        def of(v: np.ndarray, frame: Sightings = frame, own: np.ndarray = own) -> np.ndarray:
            return residuals(frame, own, Rotation.from_rotvec(v).as_matrix() @ frame.rotation)

        best = least_squares(
            lambda v, of=of: of(v).ravel(), np.zeros(3),
            jac="3-point", xtol=3e-16, ftol=None, gtol=None, x_scale=1e-4,
        )  # fmt: skip
        other = Rotation.from_rotvec(best.x).as_matrix() @ frame.rotation
        turn = Rotation.from_matrix(rotation @ other.T).magnitude()
        assert np.degrees(turn) <= within("flight rotation")


def pinhole(frame: Sightings, rotation: np.ndarray) -> np.ndarray:
    """A pinhole's image in extended precision, by its own formula."""
    ray = frame.direction.astype(np.longdouble) @ rotation.T
    return np.asarray(frame.lens.focal_px * ray[:, :2] / ray[:, 2:] + frame.lens.centre_px)


def turned(rotation: np.ndarray, axis: int, step: float) -> np.ndarray:
    """A rotation turned a little in extended precision, to the third order."""
    skew = np.zeros((3, 3), np.longdouble)
    i, j = ((1, 2), (2, 0), (0, 1))[axis]
    skew[i, j], skew[j, i] = -step, step
    return (np.eye(3) + skew + skew @ skew / 2 + skew @ skew @ skew / 6) @ rotation


LOSS = {
    "least-squares": lambda z: z,
    "huber": lambda z: np.where(z <= HUBER**2, z, 2 * HUBER * np.sqrt(z) - HUBER**2),
    "cauchy": lambda z: CAUCHY**2 * np.log1p(z / CAUCHY**2),
}


@pytest.mark.parametrize("loss", list(LOSS))
def test_a_frame_with_noise_ends_at_the_minimum(loss: str) -> None:
    """Newton's step from the solution, by differences of the cost in extended precision."""
    frames, sigma = flight("pinhole", 22, 1.0, fewest=3)
    rng = np.random.default_rng(23)
    if loss != "least-squares":
        for frame in frames:
            frame.pixel[0] += rng.normal(0.0, 20.0, 2)
    found = solved(frames, sigma, loss)
    assert found.converged.all()
    step = 1e-6
    for frame, own, rotation in zip(frames, picks(frames, sigma), found.rotation, strict=True):
        start = rotation.astype(np.longdouble)

        def cost(way: np.ndarray, f: Sightings = frame, s: np.ndarray = own) -> np.ndarray:
            r = (f.pixel - pinhole(f, way)) / s[:, None]
            return LOSS[loss]((r**2).sum(axis=1)).sum()

        gradient = np.zeros(3)
        hessian = np.zeros((3, 3))
        for a in range(3):
            up, down = turned(start, a, step), turned(start, a, -step)
            up2, down2 = turned(start, a, 2 * step), turned(start, a, -2 * step)
            gradient[a] = (8 * (cost(up) - cost(down)) - cost(up2) + cost(down2)) / (12 * step)
            for b in range(3):
                hessian[a, b] = (
                    cost(turned(up, b, step)) - cost(turned(up, b, -step))
                    - cost(turned(down, b, step)) + cost(turned(down, b, -step))
                ) / (4 * step**2)  # fmt: skip
        left = np.linalg.norm(np.linalg.solve(hessian, gradient))
        name = "flight Newton step" if loss == "least-squares" else "flight robust step"
        assert np.degrees(left) <= within(name)


def test_frames_without_hope_end_early(monkeypatch: pytest.MonkeyPatch) -> None:
    """With room for one pass no frame has converged, and each has the attitude so far."""
    frames, sigma = flight("pinhole", 22, 1.0, fewest=3)
    whole = solved(frames, sigma)
    monkeypatch.setattr(solve, "WORK", 0)
    monkeypatch.setattr(solve, "WORK_A_PICK", 0.5)
    found = solved(frames, sigma)
    assert not found.converged.any()
    assert np.isfinite(found.rotation).all()
    monkeypatch.setattr(solve, "WORK_A_PICK", 20)
    found = solved(frames, sigma)
    assert found.converged.all()
    assert np.array_equal(found.rotation, whole.rotation)


def test_weights_count_and_blunders_lose_theirs() -> None:
    frames, sigma = flight("pinhole", 24, 0.01, fewest=6)
    for frame in frames:
        frame.pixel[0] += 300.0
    truth = [f.rotation for f in frames]

    def worst(loss: str) -> float:
        found = solved(frames, np.full(len(sigma), 0.01), loss).rotation
        apart = Rotation.from_matrix(found @ np.swapaxes(truth, 1, 2)).magnitude()
        return float(np.degrees(apart).max())

    assert worst("cauchy") < within("angle beside a blunder")
    assert worst("least-squares") > 1.0


def test_one_landmark_or_landmarks_on_one_line_have_no_rotation() -> None:
    rng = np.random.default_rng(25)
    whole = random_frame(rng, LENSES["pinhole"], 5, 0.5)
    one = whole._replace(pixel=whole.pixel[:1], direction=whole.direction[:1])
    line = whole._replace(pixel=whole.pixel[[0, 0]], direction=whole.direction[[0, 0]])
    found = solved([one, whole, line], np.ones(8))
    assert np.isnan(found.rotation[[0, 2]]).all()
    alone = solved([whole], np.ones(5))
    np.testing.assert_array_equal(found.rotation[1], alone.rotation[0])


def test_a_pick_whose_landmark_has_no_image_is_set_aside() -> None:
    rng = np.random.default_rng(26)
    frame = random_frame(rng, LENSES["pinhole"], 6, 0.5)
    frame.direction[2] *= -1.0
    found = solved([frame], np.ones(6))
    assert found.set_aside.tolist() == [0, 0, 1, 0, 0, 0]
    assert found.weight[2] == 0.0
    turn = Rotation.from_matrix(found.rotation[0] @ frame.rotation.T).magnitude()
    assert np.degrees(turn) < 0.3
