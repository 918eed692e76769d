"""Calibration of a camera by stars."""

from __future__ import annotations

import json
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved, refused
from tests.kit.command import Ran, vopd
from tests.tolerances import assert_close, within
from vopd.findings import InputError
from vopd.stellar import StarField, wahba
from vopd.stellar.field import Failure
from vopd.stellar.files import photograph as solved_calibration
from vopd.stellar.files.images import ImageAxes
from vopd.stellar.files.photograph import StarRequest, solve_calibration
from vopd.stellar.files.read import StarFile
from vopd.stellar.methods.calibration import (
    PARAMETERS,
    UNKNOWNS,
    Calibration,
    LensOfStars,
    calibrate,
    calibrate_from_both_starts,
    calibrate_together,
    estimated_start,
    focal_by_pairs,
    without_lens,
)
from vopd.stellar.methods.run import SolvedStars

# Principal distance, principal point and distortion solved with the attitude


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


@pytest.mark.parametrize("spread", [(1.0, 1.0, 1.0), (0.2, 1.0, 4.0)])
def test_photographs_share_one_camera(spread: tuple[float, ...]) -> None:
    """Three attitudes and one lens: scipy's least squares of all 13 unknowns at once."""
    rng, fields, looks = np.random.default_rng(11), [], []
    for count in (6, 12, 20):
        tangents = sky(count, seed=count)
        look = Rotation.from_rotvec(rng.normal(0.0, 1.0, 3)).as_matrix()
        rays = np.column_stack([tangents, np.full(count, -1.0)])
        stars = rays / np.linalg.norm(rays, axis=1)[:, None] @ look
        read = images_of(tangents) + rng.normal(0.0, SIGMA, (count, 2))
        fields.append(StarField.of(stars, read, FOCAL))
        looks.append(look)
    starts = [calibrate(f, wahba(f).matrix, UNKNOWNS) for f in fields]
    found = calibrate_together(fields, starts, spread)
    assert found is not None

    def residuals(at: np.ndarray) -> np.ndarray:
        out, (focal, centre, k1) = [], (at[9] * FOCAL, at[10:12] * FOCAL, at[12])
        for k, field in enumerate(fields):
            turn = Rotation.from_rotvec(at[3 * k : 3 * k + 3]).as_matrix()
            ray = field.directions @ (turn @ looks[k]).T
            tangents = ray[:, :2] / -ray[:, 2:]
            r2 = (tangents**2).sum(axis=1, keepdims=True)
            off = centre + focal * tangents * (1.0 + k1 * r2) - field.image_mm
            out.append(off / spread[k])
        return np.concatenate(out).ravel()

    start = np.concatenate([np.zeros(9), [1.0, 0.0, 0.0, 0.0]])
    dense = least_squares(residuals, start, method="lm", xtol=1e-15, ftol=1e-15, gtol=1e-15)
    sigma = np.sqrt(np.diag(np.linalg.inv(dense.jac.T @ dense.jac)))
    lens = np.array([FOCAL, FOCAL, FOCAL, 1.0])
    for k, one in enumerate(found):
        own = np.sqrt(np.diag(one.covariance)) * spread[k]
        assert_close("rae sigma by scipy", own[3:] / (sigma[9:] * lens), 1.0)
        variance = dense.fun @ dense.fun / one.freedom * spread[k] ** 2
        assert_close("rae sigma by scipy", one.variance / variance, 1.0)
        turn = Rotation.from_rotvec(dense.x[3 * k : 3 * k + 3]).as_matrix() @ looks[k]
        assert np.abs(one.matrix - turn).max() < within("rae weighted element")
        away = (np.array(one.lens) - dense.x[9:] * lens) / own[3:]
        assert np.abs(away).max() < within("rae sigma by scipy")
        assert one.freedom == 2 * 38 - 9 - 4


def test_a_photograph_by_itself_is_solved_as_one_of_several() -> None:
    """The covariance of its attitude with the lens, too."""
    tangents = sky(12)
    read = images_of(tangents) + np.random.default_rng(3).normal(0.0, SIGMA, (12, 2))
    field = StarField.of(stars_of(tangents), read, FOCAL)
    alone = calibrate(field, wahba(field).matrix, UNKNOWNS)
    found = calibrate_together([field], [alone])
    assert found is not None
    scale = np.sqrt(np.diag(alone.covariance))
    ratio = (found[0].covariance - alone.covariance) / np.outer(scale, scale)
    assert_close("rae sigma by scipy", ratio, 0.0 * ratio)
    correlation = alone.covariance[:3, 3:] / np.outer(scale[:3], scale[3:])
    assert np.abs(correlation).max() > 0.5


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


@pytest.mark.parametrize(
    "options", [("--free", "focal,centre", "--focal-px", "2300"), ("--free", "focal,centre")]
)
def test_a_known_distortion_is_that_of_the_solved_camera(options: tuple[str, ...]) -> None:
    """k1 goes by the principal point and distance that are found, not by those to start from."""
    tangents = sky(12)
    text = written(images_of(tangents), stars_of(tangents))
    row = solved(text, *options, "--k1", str(K1))
    found = [row["focal_px"], row["centre_x_px"], row["centre_y_px"]]
    assert_close("rae exact camera", found, [FOCAL, 1499.5 + 14.0, 999.5 + 9.0])
    assert row["picture"]["k1"] == K1 and "k1" not in row
    head, *lines = text.splitlines()
    twice = [f"{head},image", *(f"{line},{name}" for name in "ab" for line in lines)]
    for each in json.loads(solve("\n".join(twice), *options, "--k1", str(K1)).stdout):
        assert_close("rae exact camera", each["focal_px"], FOCAL)


@pytest.mark.parametrize(
    "options",
    [("--centre", "1513.5,1008.5", "--k1", str(K1)), ("--free", "centre,k1")],
    ids=["stated", "solved"],
)
def test_the_field_of_an_image_is_that_of_its_lens(options: tuple[str, ...]) -> None:
    """Edges 1514 and 1486, 1009 and 991 px from the principal point, (1 + k1 r**2) r of them."""
    tangents = sky(12)
    text = written(images_of(tangents), stars_of(tangents)).replace("u,v,w", "ra_deg,dec_deg")
    u, v, w = stars_of(tangents).T
    places = np.column_stack([np.degrees(np.arctan2(v, u)), np.degrees(np.arcsin(w))])
    head, *lines = text.splitlines()
    rows = [
        ",".join([*line.split(",")[:2], f"{ra:.17g}", f"{dec:.17g}"])
        for line, (ra, dec) in zip(lines, places.tolist(), strict=True)
    ]
    shown = vopd("stars", "solve", "-", "--size", "3000,2000", "--y-down", "--focal-px", str(FOCAL),
                 *options, stdin="\n".join([head, *rows])).stdout  # fmt: skip
    angles = [
        max(np.roots([K1, 0.0, 1.0, -px / FOCAL]).real, key=lambda r: -abs(r - px / FOCAL))
        for px in (1514.0, 1486.0, 1009.0, 991.0)
    ]
    left, right, up, down = np.degrees(np.arctan(angles))
    (field,) = (line for line in shown.splitlines() if line.startswith("field "))
    assert field.split()[1:4] == [f"{left + right:.4g}", "x", f"{up + down:.4g}"]


@pytest.mark.parametrize("stated", [True, False], ids=["of both", "of one"])
def test_the_better_photograph_tells_the_camera_they_share(tmp_path: Path, stated: bool) -> None:
    """That of .01 px against one of 20 px whose principal distance is 1 % longer."""
    tangents = sky(30)
    stars, near = stars_of(tangents), FOCAL * tangents
    rng = np.random.default_rng(8)
    files = tmp_path / "good.csv", tmp_path / "bad.csv"
    for file, scale, sigma, says in zip(
        files, (1.0, 1.01), (0.01, 20.0), (True, stated), strict=True
    ):
        text = written(scale * near + rng.normal(0.0, sigma, near.shape), stars)
        head, *lines = text.splitlines()
        more = [f"{head},sigma_px", *(f"{line},{sigma}" for line in lines)]
        file.write_text("\n".join(more if says else [head, *lines]))
    options = ("--size", "3000,2000", "--y-down", "--focal-px", "2400", "--free", "focal")
    good, bad = json.loads(vopd("stars", "solve", *files, "--format", "json", *options).stdout)
    assert good["focal_px"] == bad["focal_px"]
    assert_close("sigmas of one draw", (good["focal_px"] - FOCAL) / good["sigma_focal_px"], 0.0)


def test_a_stated_sigma_counts_beside_residuals_that_tell_the_other(tmp_path: Path) -> None:
    """As uncertain as the 20 px that the residuals of the other tell: they share the middle."""
    tangents = sky(30)
    stars, near = stars_of(tangents), FOCAL * tangents
    rng = np.random.default_rng(9)
    head, *lines = written(near + rng.normal(0.0, 0.01, near.shape), stars).splitlines()
    (tmp_path / "a.csv").write_text(
        "\n".join([f"{head},sigma_px", *(f"{one},20" for one in lines)])
    )
    (tmp_path / "b.csv").write_text(written(1.01 * near + rng.normal(0.0, 20.0, near.shape), stars))
    options = ("--size", "3000,2000", "--y-down", "--focal-px", "2400", "--free", "focal")
    files = tmp_path / "a.csv", tmp_path / "b.csv"
    ran = vopd("stars", "solve", *files, "--format", "json", *options)
    first, second = (one["focal_px"] for one in json.loads(ran.stdout))
    assert first == second and 0.003 < first / FOCAL - 1.0 < 0.007


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
    assert_approved(result.stderr)
    wide = sky(40)
    read = images_of(wide) + np.random.default_rng(5).normal(0.0, SIGMA, (40, 2))
    quiet = solve(written(read, stars_of(wide)), "--focal-px", "2400", "--free", "focal,centre,k1")
    assert quiet.status == 0 and quiet.stderr == ""


def test_a_wrong_star_is_rejected_and_the_camera_solved_again(tmp_path: Path) -> None:
    tangents = sky(30)
    read = images_of(tangents) + np.random.default_rng(6).normal(0.0, SIGMA, (30, 2))
    read[7] += [25.0, -30.0]
    free = ("--focal-px", "2400", "--free", "focal,centre,k1")
    row = solved(written(read, stars_of(tangents)), *free, "--reject")
    good = np.delete(np.arange(30), 7)
    same = solved(written(read[good], stars_of(tangents)[good]), *free)
    assert 8 not in row["stars"] and len(row["stars"]) == 29
    assert_close("rae exact camera", row["focal_px"], same["focal_px"])
    for name, own in (("a.csv", np.arange(30)), ("b.csv", good)):
        (tmp_path / name).write_text(written(read[own], stars_of(tangents)[own]))
    shared = [
        json.loads(vopd("stars", "solve", *(tmp_path / one for one in names), "--size", "3000,2000",
                        "--y-down", "--format", "json", *free, "--reject").stdout)
        for names in (("a.csv", "a.csv"), ("b.csv", "b.csv"))
    ]  # fmt: skip
    assert_close("rae exact camera", shared[0][0]["focal_px"], shared[1][0]["focal_px"])


REFUSED = {
    "too few": (3, ("--free", "focal,centre,k1"), 1),
    "a name": (9, ("--free", "focal,k2"), 2),
    "k1 twice": (9, ("--free", "k1", "--k1", "0.1"), 2),
    "a method": (9, ("--free", "focal", "--method", "svd"), 2),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_solved_is_refused(name: str) -> None:
    count, options, status = REFUSED[name]
    tangents = sky(count)
    text = written(images_of(tangents), stars_of(tangents))
    result = solve(text, "--focal-px", "2400", *options)
    assert result.status == status
    assert_approved(result.stderr)


# Every field of a camera solved with the attitude, its failures, and where the solution starts


TRUE = LensOfStars(240.0, 1.4, -0.9, -0.08)
TANGENTS = np.random.default_rng(2).uniform([-0.6, -0.4], [0.6, 0.4], (14, 2))
OFF = np.random.default_rng(3).normal(0.0, 0.05, (14, 2))


def imaged(tangents: np.ndarray, lens: LensOfStars) -> np.ndarray:
    """centre + focal (1 + k1 r**2) (u, v)."""
    r2 = (tangents**2).sum(axis=1, keepdims=True)
    centre = [lens.centre_x, lens.centre_y]
    return np.asarray(centre + lens.focal * tangents * (1.0 + lens.k1 * r2))


def stars_of_fields(tangents: np.ndarray) -> np.ndarray:
    rays = np.column_stack([tangents, np.full(len(tangents), -1.0)])
    return np.asarray(rays / np.linalg.norm(rays, axis=1)[:, None] @ LOOK)


def field(errors: np.ndarray | None = None, stated: float = 241.0) -> StarField:
    images = imaged(TANGENTS, TRUE) + OFF
    return StarField.of(stars_of_fields(TANGENTS), images, stated, True, errors)


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
        one = StarField.of(stars_of_fields(TANGENTS[:count]), imaged(TANGENTS[:count], TRUE), 240.0)
        assert calibrate(one, LOOK, UNKNOWNS).freedom == freedom
        assert calibrate(one, LOOK, ()).freedom == 2 * count - 3


def is_unsolved(found: Calibration, failure: Failure, free: tuple[str, ...]) -> bool:
    size = 3 + len(free)
    blank = np.isnan([found.growth, found.variance]).all() and np.isnan(found.covariance).all()
    return found.failure == failure and bool(blank) and found.covariance.shape == (size, size)


@pytest.mark.parametrize(("apart", "known"), [(0.0, False), (1e-12, False), (1e-7, True)])
def test_distances_from_the_centre_that_are_alike_do_not_hold_two_unknowns(
    apart: float, known: bool
) -> None:
    """Stars on a circle about the principal point: focal length and k1 move them alike."""
    azimuth = np.arange(12) * np.pi / 6.0
    radius = 0.4 * (1.0 + apart * (-1.0) ** np.arange(12))
    tangents = radius[:, None] * np.column_stack([np.cos(azimuth), np.sin(azimuth)])
    free = "focal", "k1"
    found = calibrate(StarField.of(stars_of(tangents), images_of(tangents), FOCAL), LOOK, free)
    assert is_unsolved(found, Failure.SINGULAR, free) != known
    assert (found.failure == Failure.NONE) == known


def test_why_there_is_no_solution() -> None:
    three = StarField.of(stars_of_fields(TANGENTS[:3]), imaged(TANGENTS[:3], TRUE), 240.0)
    assert is_unsolved(calibrate(three, LOOK, UNKNOWNS), Failure.SINGULAR, UNKNOWNS)
    images = imaged(TANGENTS, TRUE)
    behind = StarField.of(-stars_of_fields(TANGENTS), images, 240.0)
    found = calibrate(behind, LOOK, (), TRUE)
    assert is_unsolved(found, Failure.BEHIND_CAMERA, ())
    some = stars_of_fields(TANGENTS) * np.where(np.arange(14) == 3, -1.0, 1.0)[:, None]
    found = calibrate(StarField.of(some, images, 240.0), LOOK, (), TRUE)
    assert is_unsolved(found, Failure.BEHIND_CAMERA, ())
    flipped = StarField.of(stars_of_fields(TANGENTS), -images, 240.0)
    found = calibrate(flipped, LOOK, ("focal",))  # a principal distance below zero would fit
    assert is_unsolved(found, Failure.NO_CONVERGENCE, ("focal",))
    spoiled = images.copy()
    spoiled[2, 0] = np.nan
    assert calibrate(StarField.of(stars_of_fields(TANGENTS), spoiled, 240.0), LOOK, ()).failure != 0


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
    one = StarField.of(stars_of_fields(CROSS), imaged(CROSS, lens), 100.0)
    start = estimated_start(one, free)
    assert start is not None
    matrix, found = start
    centre = (50.0, -70.0) if "centre_x" in free else (0.0, 0.0)
    focal = 240.0 if "focal" in free else 100.0
    assert_close("rae angle", found, (focal, *centre, 0.0))
    if "focal" in free and "centre_x" in free:
        assert_close("rae angle", matrix, LOOK)


def test_the_focal_length_by_pairs_is_that_of_most_stars() -> None:
    """Of eight near each other two are taken for others far out: 13 of 28 pairs are wrong."""
    tangents = sky(8, (0.15, 0.1))
    images, directions = FOCAL * tangents, stars_of(tangents)
    images[:2] = [[2400.0, 0.0], [-2400.0, 0.0]]
    step = 4000.0 ** (1.0 / 399.0)
    assert 1.0 / step < focal_by_pairs(images, directions) / FOCAL < step


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
    three = StarField.of(stars_of_fields(TANGENTS[:3]), imaged(TANGENTS[:3], TRUE), 240.0)
    stated_alone = calibrate(three, wahba(three).matrix, UNKNOWNS)
    both = calibrate_from_both_starts(three, UNKNOWNS)
    assert (both.failure, both.lens, both.iterations) == (
        stated_alone.failure, stated_alone.lens, stated_alone.iterations
    )  # fmt: skip


# Cameras solved with the attitude: values, deviations, needs, doubts and errors


COUNT = 8
IMAGE = np.random.default_rng(2).uniform(-20.0, 20.0, (COUNT, 2))
EVERYONE = np.arange(COUNT)


def star_file(unit: str = "mm") -> StarFile:
    lines = tuple(range(2, 2 + COUNT))
    return StarFile("a.csv", lines, ("",) * COUNT, IMAGE, unit, "ra_deg,dec_deg", IMAGE)


RAYS = np.column_stack([IMAGE, np.full(COUNT, -76.0)])
STARS = StarField.of(RAYS / np.linalg.norm(RAYS, axis=1)[:, None], IMAGE, 76.0)
AXES = ImageAxes(focal_mm=76.0)
PX = ImageAxes(focal_px=76.0, centre_px=(1000.0, 500.0), y_down=True)


def lens_of(**more: Any) -> Calibration:
    """What a calibration came to: 1, 2, 3, 4, 5, 6, 7 are the deviations, 9 corrections."""
    given: dict[str, Any] = {
        "failure": Failure.NONE, "matrix": np.eye(3), "lens": LensOfStars(80.0, 0.5, 0.25, 0.001),
        "free": ("focal", "centre_x", "centre_y", "k1"), "growth": 2.0, "variance": 0.04,
        "covariance": np.diag([1e-6, 4e-6, 9e-6, 16e-4, 25e-4, 36e-4, 49e-6]), "freedom": 9,
        "iterations": 9,
    } | more  # fmt: skip
    return Calibration(**given)


def solve_cameras(
    monkeypatch: pytest.MonkeyPatch, found: Calibration, free: tuple[str, ...], *,
    unit: str = "mm", used: Any = EVERYONE, sigma: float | None = None,
) -> tuple[StarField, SolvedStars, list[Any], list[Any]]:  # fmt: skip
    given: list[Any] = []

    def calibrate(stars: StarField, unknowns: tuple[str, ...], _: float) -> Calibration:
        given.extend([stars.used.shape[-1], unknowns])
        return found

    monkeypatch.setattr(solved_calibration, "calibrate_from_both_starts", calibrate)
    axes = AXES if unit == "mm" else PX
    request = StarRequest(axes, free=free)
    stars, solved, _, doubts = solve_calibration(star_file(unit), STARS, used, request, sigma)
    return stars, solved, doubts, given


ALL = ("k1", "centre", "focal")


@pytest.mark.parametrize("sigma", [None, 0.5])
def test_a_camera_in_millimetres(monkeypatch: pytest.MonkeyPatch, sigma: float | None) -> None:
    """Unknowns in their own order; deviations times the reading sigma, .2 by the residuals."""
    used = np.array([0, 2, 3, 4, 5, 6])
    stars, one, findings, given = solve_cameras(monkeypatch, lens_of(), ALL, used=used, sigma=sigma)
    size = sigma or 0.2
    assert given == [6, ("focal", "centre_x", "centre_y", "k1")]
    assert (one.method, one.stars, one.iterations) == ("collinearity", (1, 3, 4, 5, 6, 7), 9)
    assert one.converged and one.failure == Failure.NONE
    assert one.camera == {"focal": 80.0, "centre_x": 0.5, "centre_y": 0.25, "k1": 0.001}
    assert list(one.camera) == ["focal", "centre_x", "centre_y", "k1"]
    assert one.camera_sigmas is not None and one.rotation_sigma_arcsec is not None
    deviations = np.array([0.04, 0.05, 0.06, 0.007]) * size
    assert_close("rae element", list(one.camera_sigmas.values()), deviations)
    turns = np.degrees(np.array([1e-3, 2e-3, 3e-3]) * size) * 3600.0
    assert_close("rae angle", one.rotation_sigma_arcsec, turns)
    assert_close("rae element", one.reading_sigma, size)  # type: ignore[arg-type]
    assert one.reading_freedom == (9 if sigma is None else None)
    assert findings == []
    assert_close("rae element", stars.focal_length_mm, [80.0])
    assert_close("rae element", stars.directions, STARS.directions)
    inner = stars.image_mm
    r2 = (inner**2).sum(axis=1, keepdims=True) / 80.0**2
    assert_close("flight pixel", [0.5, 0.25] + inner * (1.0 + 0.001 * r2), IMAGE)


def test_a_camera_in_pixels(monkeypatch: pytest.MonkeyPatch) -> None:
    """The principal point is that of the file, y down."""
    _, one, _, given = solve_cameras(monkeypatch, lens_of(), ALL, unit="px")
    assert given[0] == 8
    assert one.camera == {
        "focal": 80.0, "centre_x": 1000.5, "centre_y": 499.75, "k1": 0.001
    }  # fmt: skip


def test_a_lens_that_cannot_be_inverted(monkeypatch: pytest.MonkeyPatch) -> None:
    folded = lens_of(lens=lens_of().lens._replace(k1=-1e6))
    with refused(InputError):
        solve_cameras(monkeypatch, folded, ALL)


def deviations(**sigmas: float) -> np.ndarray:
    """The covariance for a reading sigma of .2 and these deviations."""
    names = ("focal", "centre_x", "centre_y", "k1")
    return np.diag([1e-8] * 3 + [(sigmas.get(name, 0.0) / 0.2) ** 2 for name in names])


DOUBTS: list[tuple[dict[str, Any], list[str]]] = [  # a lens: names and numbers that are said
    ({"growth": 10.0}, []),
    ({"growth": 10.6}, ["focal, centre_x, centre_y and k1", "11"]),
    ({"growth": 123.4, "free": ("focal",)}, ["focal", "123"]),
    ({"growth": 11.0, "free": ("focal", "k1")}, ["focal and k1", "11"]),
    ({"covariance": deviations(focal=0.799, centre_x=0.799, centre_y=0.799, k1=0.00999)}, []),
    ({"covariance": deviations(focal=0.80123)}, ["focal", "0.801 px"]),
    ({"covariance": deviations(centre_x=0.80123)}, ["centre_x", "0.801 px"]),
    ({"covariance": deviations(centre_y=12.3456, k1=0.0101234)},
     ["centre_y", "12.3 px", "k1", "0.0101"]),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "said"), DOUBTS)
def test_cameras_that_the_stars_do_not_hold(
    monkeypatch: pytest.MonkeyPatch, changes: dict[str, Any], said: list[str]
) -> None:
    """A growth of 10, and a hundredth of the principal distance, are the limits."""
    _, _, found, _ = solve_cameras(monkeypatch, lens_of(**changes), ALL, unit="px")
    assert len(found) == len(said) // 2
    assert [key for key, _ in found] == [f"calibration {k}" for k in range(len(found))]
    assert_approved([one for _, one in found], parts=said)


@pytest.mark.parametrize("stated", [None, 0.25])
def test_what_the_readings_do_not_determine(
    monkeypatch: pytest.MonkeyPatch, stated: float | None
) -> None:
    """An attitude known to 20 degrees is refused, however the reading sigma is known."""
    _, solved, _, _ = solve_cameras(
        monkeypatch, lens_of(covariance=4.0 * np.eye(7)), ALL, sigma=stated
    )
    assert solved.failure == Failure.TOO_UNCERTAIN
