"""Every field of a camera solved with the attitude, its failures, and where the solution starts."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close, within
from vopd.stellar import StarField, wahba
from vopd.stellar.field import Failure
from vopd.stellar.methods import calibration as calibration_start
from vopd.stellar.methods.calibration import (
    PARAMETERS,
    UNKNOWNS,
    Calibration,
    LensOfStars,
    calibrate,
    calibrate_from_both_starts,
    estimated_start,
    without_lens,
)

LOOK = Rotation.from_euler("ZYX", [100.0, -40.0, 15.0], degrees=True).as_matrix()
TRUE = LensOfStars(240.0, 1.4, -0.9, -0.08)
TANGENTS = np.random.default_rng(2).uniform([-0.6, -0.4], [0.6, 0.4], (14, 2))
OFF = np.random.default_rng(3).normal(0.0, 0.05, (14, 2))


def imaged(tangents: np.ndarray, lens: LensOfStars) -> np.ndarray:
    """centre + focal (1 + k1 r**2) (u, v)."""
    r2 = (tangents**2).sum(axis=1, keepdims=True)
    centre = [lens.centre_x, lens.centre_y]
    return np.asarray(centre + lens.focal * tangents * (1.0 + lens.k1 * r2))


def stars_of(tangents: np.ndarray) -> np.ndarray:
    rays = np.column_stack([tangents, np.full(len(tangents), -1.0)])
    return np.asarray(rays / np.linalg.norm(rays, axis=1)[:, None] @ LOOK)


def field(errors: np.ndarray | None = None, stated: float = 241.0) -> StarField:
    images = imaged(TANGENTS, TRUE) + OFF
    return StarField.of(stars_of(TANGENTS), images, stated, True, errors)


def covariances() -> np.ndarray:
    halves = np.random.default_rng(5).normal(size=(14, 2, 2)) + 2.0 * np.eye(2)
    return np.asarray(halves @ halves.swapaxes(1, 2))


def test_what_can_be_solved_and_its_unknowns() -> None:
    assert PARAMETERS == {"focal": ("focal",), "centre": ("centre_x", "centre_y"), "k1": ("k1",)}
    assert UNKNOWNS == LensOfStars._fields == ("focal", "centre_x", "centre_y", "k1")
    assert LensOfStars(5.0) == (5.0, 0.0, 0.0, 0.0)


SETS = [names for n in range(5) for names in combinations(UNKNOWNS, n)]


@pytest.mark.parametrize("free", SETS, ids=["+".join(names) or "none" for names in SETS])
def test_solution_and_covariance_are_scipys(free: tuple[str, ...]) -> None:
    """What is not free keeps its value; the growth is of the root of the attitude's variances."""
    errors = covariances() if len(free) % 2 else None
    one = field(errors)
    kept = {"focal": 240.5, "centre_x": 1.0, "centre_y": -0.5, "k1": -0.07}
    found = calibrate(one, wahba(one).matrix, free, LensOfStars(**kept))
    assert (found.failure, found.free, found.freedom) == (Failure.NONE, free, 28 - 3 - len(free))
    assert all(getattr(found.lens, name) == kept[name] for name in UNKNOWNS if name not in free)
    white = np.linalg.inv(
        np.linalg.cholesky(np.tile(np.eye(2), (14, 1, 1)) if errors is None else errors)
    )
    units = {"focal": 100.0, "centre_x": 1.0, "centre_y": 1.0, "k1": 1.0}

    def residuals(change: np.ndarray) -> np.ndarray:
        turned = Rotation.from_rotvec(change[:3]).as_matrix() @ found.matrix
        x, y, z = turned @ one.directions.T
        moved = {
            n: getattr(found.lens, n) + units[n] * c for n, c in zip(free, change[3:], strict=True)
        }
        images = imaged(np.column_stack([-x / z, -y / z]), found.lens._replace(**moved))
        return np.asarray(np.einsum("nij,nj->ni", white, one.image_mm - images).ravel())

    start = np.full(3 + len(free), 1e-3)
    ends = {"xtol": 1e-15, "ftol": 1e-15, "gtol": 1e-15}
    other = least_squares(residuals, start, jac="3-point", **ends)
    assert np.abs(other.x).max() < within("rae angle of nine digits")
    stated = np.linalg.inv(other.jac.T @ other.jac)
    sizes = np.array([1.0, 1.0, 1.0, *(units[name] for name in free)])
    sigmas = np.sqrt(np.diag(stated))
    ratio = found.covariance / np.outer(sizes * sigmas, sizes * sigmas)
    assert np.abs(ratio - stated / np.outer(sigmas, sigmas)).max() < within("rae sigma by scipy")
    alone = np.linalg.inv(other.jac[:, :3].T @ other.jac[:, :3])
    growth = np.sqrt(np.trace(stated[:3, :3]) / np.trace(alone))
    assert abs(found.growth / growth - 1.0) < within("rae sigma by scipy")
    side = residuals(np.zeros(3 + len(free)))
    assert_close("ratio", found.variance / (side @ side / found.freedom), 1.0)
    assert 2 <= found.iterations < 20


def test_it_starts_from_the_fields_focal_length_and_changes_no_argument() -> None:
    one = field()
    start, lens = wahba(one).matrix, LensOfStars(241.0)
    before = start.copy(), one.image_mm.copy(), one.focal_length_mm.copy()
    assert_close("rae angle", calibrate(one, start, ("k1",)).lens,
                 calibrate(one, start, ("k1",), lens).lens)  # fmt: skip
    assert calibrate(one, start, ("k1",)).lens.focal == 241.0
    calibrate(one, start, UNKNOWNS, lens)
    assert lens == LensOfStars(241.0)
    for array, old in zip((start, one.image_mm, one.focal_length_mm), before, strict=True):
        assert (array == old).all()


def test_few_stars_have_one_degree_of_freedom_at_least() -> None:
    for count, freedom in ((4, 1), (3, 1), (5, 3)):
        one = StarField.of(stars_of(TANGENTS[:count]), imaged(TANGENTS[:count], TRUE), 240.0)
        assert calibrate(one, LOOK, UNKNOWNS).freedom == freedom
        assert calibrate(one, LOOK, ()).freedom == 2 * count - 3


def is_unsolved(found: Calibration, failure: Failure, free: tuple[str, ...]) -> bool:
    size = 3 + len(free)
    blank = np.isnan([found.growth, found.variance]).all() and np.isnan(found.covariance).all()
    return found.failure == failure and bool(blank) and found.covariance.shape == (size, size)


def test_why_there_is_no_solution() -> None:
    three = StarField.of(stars_of(TANGENTS[:3]), imaged(TANGENTS[:3], TRUE), 240.0)
    assert is_unsolved(calibrate(three, LOOK, UNKNOWNS), Failure.SINGULAR, UNKNOWNS)
    images = imaged(TANGENTS, TRUE)
    behind = StarField.of(-stars_of(TANGENTS), images, 240.0)
    found = calibrate(behind, LOOK, (), TRUE)
    assert is_unsolved(found, Failure.BEHIND_CAMERA, ())
    some = stars_of(TANGENTS) * np.where(np.arange(14) == 3, -1.0, 1.0)[:, None]
    found = calibrate(StarField.of(some, images, 240.0), LOOK, (), TRUE)
    assert is_unsolved(found, Failure.BEHIND_CAMERA, ())
    flipped = StarField.of(stars_of(TANGENTS), -images, 240.0)
    found = calibrate(flipped, LOOK, ("focal",))  # a principal distance below zero would fit
    assert is_unsolved(found, Failure.NO_CONVERGENCE, ("focal",))
    spoiled = images.copy()
    spoiled[2, 0] = np.nan
    assert calibrate(StarField.of(stars_of(TANGENTS), spoiled, 240.0), LOOK, ()).failure != 0


@pytest.mark.parametrize("k1", [-0.08, 0.0, 0.08])
def test_images_without_the_lens(k1: float) -> None:
    """They are focal (u, v): undone to the last digits; a lens's field ends where it turns back."""
    lens = TRUE._replace(k1=k1)
    assert_close("flight pixel", without_lens(imaged(TANGENTS, lens), lens), 240.0 * TANGENTS)
    beyond = without_lens(np.array([[1e4, 0.0]]), TRUE)
    assert np.isnan(beyond).all()


CROSS = np.array([[0.3, 0.0], [-0.3, 0.0], [0.0, 0.4], [0.0, -0.4], [0.2, 0.2], [-0.2, -0.2]])


@pytest.mark.parametrize("free", [("focal",), ("centre_x", "centre_y"), UNKNOWNS, ("k1",)])
def test_the_start_by_mean_and_spread_of_the_images(free: tuple[str, ...]) -> None:
    """Of a figure that is alike on all sides: its middle, and the scale that it has."""
    lens = LensOfStars(240.0, 50.0, -70.0)
    one = StarField.of(stars_of(CROSS), imaged(CROSS, lens), 100.0)
    start = estimated_start(one, free)
    assert start is not None
    centre = (50.0, -70.0) if "centre_x" in free else (0.0, 0.0)
    focal = 240.0 if "focal" in free else 100.0
    assert_close("rae angle", start.lens, (focal, *centre, 0.0))
    if "focal" in free and "centre_x" in free:
        assert_close("rae angle", start.matrix, LOOK)


@pytest.mark.parametrize(("cosine", "there_is"), [(0.105, True), (0.095, False)])
def test_stars_too_far_apart_for_a_start(cosine: float, there_is: bool) -> None:
    """84.3 degrees from their mean; without the principal distance they may be farther."""
    around = np.radians([0.0, 120.0, 240.0])
    sine = np.sqrt(1.0 - cosine**2)
    stars = np.column_stack([sine * np.cos(around), sine * np.sin(around), np.full(3, -cosine)])
    stars = np.vstack([stars, [0.0, 0.0, -1.0]])
    images = 100.0 * np.vstack([np.column_stack([np.cos(around), np.sin(around)]), [0.0, 0.0]])
    one = StarField.of(stars, images, 100.0)
    assert (estimated_start(one, UNKNOWNS) is not None) == there_is
    assert estimated_start(one, ("centre_x", "centre_y", "k1")) is not None


def test_the_better_of_both_starts_is_taken() -> None:
    """A stated distance five times too long leads nowhere alone; a good one is not made worse."""
    for stated in (240.0, 1200.0):
        found = calibrate_from_both_starts(field(stated=stated), UNKNOWNS)
        assert found.failure == Failure.NONE
        assert_close("rae camera of few stars", found.lens.focal, 240.0)
    three = StarField.of(stars_of(TANGENTS[:3]), imaged(TANGENTS[:3], TRUE), 240.0)
    stated_alone = calibrate(three, wahba(three).matrix, UNKNOWNS)
    both = calibrate_from_both_starts(three, UNKNOWNS)
    assert (both.failure, both.lens, both.iterations) == (
        stated_alone.failure, stated_alone.lens, stated_alone.iterations
    )  # fmt: skip


@pytest.mark.parametrize(
    ("stated", "estimated", "taken"),
    [(1.0, 2.0, 0), (2.0, 1.0, 1), (None, 5.0, 1), (5.0, None, 0), (None, None, 0)],
)
def test_of_two_solutions_that_with_the_smaller_residuals_is_taken(
    stated: float | None, estimated: float | None, taken: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first starts from Wahba's rotation and the stated lens, the second from the estimate."""
    one = field()
    start = estimated_start(one, UNKNOWNS)
    assert start is not None
    blank = np.zeros((7, 7))
    made = [
        Calibration(
            Failure.NO_CONVERGENCE if variance is None else Failure.NONE, LOOK, TRUE, UNKNOWNS,
            blank, 1.0, np.nan if variance is None else variance, 5, k,
        )
        for k, variance in enumerate((stated, estimated))
    ]  # fmt: skip
    asked: list[tuple[object, ...]] = []

    def solve(*given: object) -> Calibration:
        asked.append(given)
        return made[len(asked) - 1]

    monkeypatch.setattr(calibration_start, "calibrate", solve)
    assert calibrate_from_both_starts(one, UNKNOWNS) is made[taken]
    (first, matrix, free), (second, *rest) = asked
    assert first is second is one and free == UNKNOWNS
    assert (np.asarray(matrix) == wahba(one).matrix).all()
    assert (np.asarray(rest[0]) == start.matrix).all() and rest[1:] == [UNKNOWNS, start.lens]
