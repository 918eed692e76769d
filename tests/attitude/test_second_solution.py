"""The attitude with the landmarks behind the camera, against scipy's search for the best."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.kit.estimates import estimate
from tests.kit.jobs import only, turned
from tests.kit.wgs84_film import camera_matrix
from tests.tolerances import assert_close, within
from vopd.attitude import geometry as second_solution
from vopd.attitude.geometry import second_solution_rms
from vopd.errata import fixes
from vopd.estimate import Estimate
from vopd.film import film_estimate
from vopd.geometry.rotation_fit import Sights
from vopd.program.vopd import run


def best_behind(one: Estimate) -> float:
    """The least root mean square of all minima with the landmarks behind, by scipy."""
    used = one.used[0]
    measured, cosines = one.image[0][used], one.direction[0][used]
    best = np.inf
    rng = np.random.default_rng(0)

    def residual(turn: np.ndarray, base: np.ndarray) -> np.ndarray:
        p, q, r = Rotation.from_rotvec(turn).as_matrix() @ base @ cosines.T
        return np.concatenate([measured[:, 0] - 10.4 * p / r, measured[:, 1] - 10.4 * q / r])

    for base in Rotation.random(12, random_state=rng).as_matrix():
        fit = least_squares(residual, np.zeros(3), args=(base,), method="lm", xtol=1e-14)
        ahead = (Rotation.from_rotvec(fit.x).as_matrix() @ base @ cosines.T)[2]
        if (ahead < 0.0).all():
            best = min(best, float(np.sqrt(np.mean(fit.fun**2))))
    return best


@pytest.mark.parametrize(
    ("landmarks", "pitch"),
    [((0, 3), -80.0), ((0, 3), -70.0), ((0, 1, 2), -80.0), ((0, 1, 3, 4), -70.0)],
)
def test_the_second_solution_is_the_best_on_the_other_side(
    landmarks: tuple[int, ...], pitch: float
) -> None:
    angles = np.array([[140.0, pitch, 60.0]])
    job = only(turned(angles, angles[0]), *landmarks)
    one = film_estimate(run(job, fixes("first-landmark")))
    found = float(second_solution_rms(one)[0])
    best = best_behind(one)
    assert_close("minimiser's residual", found, best)
    assert (len(landmarks) == 2) == (best < within("exact fit"))


@pytest.mark.parametrize("spread", [1.0, 0.3, 0.03, 1e-3])
def test_what_cannot_fit_is_not_searched_and_what_fits_is_found(spread: float) -> None:
    """Landmarks about a line in the image, whose plane the second attitude is mirrored at."""
    points = np.random.default_rng(3).uniform(-4.0, 4.0, (200, 4, 2)) * [1.0, spread]
    frames = estimate(np.tile([140.0, -70.0, 60.0], (len(points), 1)), points, noise=0.01)
    every = second_solution_rms(frames)
    assert np.isfinite(every).sum() > 20
    for limit in np.nanquantile(every, [0.0, 0.2, 0.9]):
        found, fits = second_solution_rms(frames, limit), every <= limit
        assert (found[fits] == every[fits]).all()
        assert not (found[~fits] <= limit).any()
    skipped = np.isnan(second_solution_rms(frames, 0.0)) & np.isfinite(every)
    assert skipped.any()


FLAT = np.array([[3.0, 0.3], [-4.0, -0.2], [1.0, -0.3], [2.0, 0.2], [-1.0, 0.1]])


def mirrored(one: Estimate, k: int) -> float:
    """Least squares by scipy from the attitude mirrored at the landmarks' plane."""
    here = one.used[k]
    cosines, measured = one.direction[k, here], one.image[k, here]
    normal = np.linalg.svd(cosines)[2][2]
    base = -camera_matrix(*one.camera_deg[k]) @ (np.eye(3) - 2.0 * np.outer(normal, normal))

    def residual(turn: np.ndarray) -> np.ndarray:
        p, q, r = Rotation.from_rotvec(turn).as_matrix() @ base @ cosines.T
        return np.concatenate([measured[:, 0] - 10.4 * p / r, measured[:, 1] - 10.4 * q / r])

    fit = least_squares(residual, np.zeros(3), method="lm", xtol=1e-14)
    assert ((Rotation.from_rotvec(fit.x).as_matrix() @ base @ cosines.T)[2] < 0.0).all()
    return float(np.sqrt(np.mean(fit.fun**2)))


@pytest.mark.parametrize("count", [2, 3, 5])
def test_frames_by_hand(count: int) -> None:
    """Solved, one landmark only, not solved, and with a landmark that takes no part."""
    angles = np.tile([140.0, -60.0, 20.0], (4, 1))
    points = np.array([FLAT[:count]] * 4) + np.random.default_rng(1).normal(0, 0.02, (4, count, 2))
    points[3, -1] = 1.0, 9.0  # which would spoil the plane
    used = np.ones((4, count), bool)
    used[1, 1:] = used[3, -1] = False
    solved = np.array([True, True, False, True])
    one = estimate(angles, np.array([FLAT[:count]] * 4), used=used, solved=solved)
    one.__dict__["image"] = points
    found = second_solution_rms(one)
    least = count > 2
    assert np.isfinite(found).tolist() == [True, False, False, least]
    assert_close("minimiser's residual", found[0], mirrored(one, 0))
    if least:
        assert_close("minimiser's residual", found[3], mirrored(one, 3))
    for limit in (found[0] * 1.001, found[0] * 0.999):
        some = second_solution_rms(one, limit)[0]
        assert some == found[0] or (np.isnan(some) and limit < found[0])
    if least:
        assert np.isnan(second_solution_rms(one, 1e-9)[0])


def test_a_solution_behind_the_camera_is_always_searched() -> None:
    """Directions that point away show the same image; the other side is then the front, and the
    bound that spares a search is not for it.
    """
    angles = np.tile([140.0, -60.0, 20.0], (1, 1))
    front = estimate(angles, FLAT)
    behind = estimate(angles, FLAT, direction=-front.direction)
    (expected,) = second_solution_rms(front)
    assert_close("minimiser's residual", second_solution_rms(behind, 1e-9), [expected])
    assert np.isnan(second_solution_rms(front, 1e-9)).all()


@pytest.mark.parametrize(
    ("same_side", "turn", "found"),
    [([], 0.9e-3, True), ([], 1.1e-3, False), ([], np.nan, False), ([1], 1e-9, False),
     ([0, 1, 2, 3, 4], 1e-9, False)],
)  # fmt: skip
def test_a_second_solution_has_settled_with_all_landmarks_on_the_other_side(
    same_side: list[int], turn: float, found: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A last turn below a thousandth of a radian. Directions are turned instead of the camera."""
    one = estimate(np.array([[140.0, -60.0, 20.0]]), FLAT)
    axes = camera_matrix(140.0, -60.0, 20.0)[None]
    sides = iter([np.isin(np.arange(5), same_side)[None] - 0.5, np.ones((1, 5))])
    monkeypatch.setattr(
        second_solution, "fit_rotations", lambda *_: (axes, np.array([[0.0, -turn, 0.0]]))
    )
    monkeypatch.setattr(second_solution, "ahead", lambda *_: next(sides))
    sights = Sights(one.direction, one.image, one.used, 10.4)
    assert np.isfinite(second_solution._searched(sights, axes)).tolist() == [found]


def test_the_bound_allows_for_the_residuals_of_the_first_solution() -> None:
    """An image that the second solution fits exactly, and the first one badly."""
    one = estimate(np.array([[140.0, -60.0, 20.0]]), FLAT)
    cosines = one.direction[0]
    normal = np.linalg.svd(cosines)[2][2]
    axes = -camera_matrix(140.0, -60.0, 20.0) @ (np.eye(3) - 2.0 * np.outer(normal, normal))
    p, q, r = axes @ cosines.T
    one.__dict__["image"] = 10.4 * np.stack([p / r, q / r], axis=1)[None]
    assert_close("minimiser's residual", second_solution_rms(one, 1e-3), [0.0])
