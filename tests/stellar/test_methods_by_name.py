"""Methods given by name, and the fields of their solutions."""

from __future__ import annotations

from dataclasses import fields, replace
from math import cos, degrees, sin, sqrt
from typing import Any

import numpy as np
import pytest

from tests.kit.rae_listings import jnkmat
from tests.tolerances import assert_close
from vopd.stellar import (
    Failure,
    StarField,
    StarSolution,
    church,
    collinearity,
    single_rotation,
    two_star,
    uncertainty,
    wahba,
)
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm, star_disagreement_arcsec
from vopd.stellar.methods.run import (
    SolvedStars,
    StarOptions,
    refused,
    solve_by_methods,
    split_solutions,
)

# Methods chosen by name: which stars each solves, what each is handed, and its reading sigma


FOCAL = 100.0
IMAGES = np.array([[30.0, 5], [-28, 16], [4, -33], [21, 24], [-15, -22], [9, 12], [-3, 31]])
OFF = np.array([[3.0, -1], [-2, 2], [1, 3], [0, -2], [90, 60], [-1, 1], [2, 0]]) * 0.01
"""Errors of some hundredths of a millimetre, and one star that is a millimetre off."""


def field() -> StarField:
    rays = np.column_stack([IMAGES, np.full(7, -FOCAL)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    return StarField.of(rays @ np.array(jnkmat(150.0, -20.0, 40.0)), IMAGES + OFF, FOCAL)


FIELD = field()
ALL = np.arange(7)
START = {"initial_deg": (120.0, -10.0, 20.0)}
ALL_METHODS = [
    "collinearity", "church", "church-weighted", "church-weighted-r", "two-star",
    "single-rotation", "svd",
]  # fmt: skip


def solve(method: str, **more: Any) -> list[SolvedStars]:
    names = ("pairs", "subset", "stars")
    given = {name: more.pop(name) for name in names if name in more}
    stars = given.pop("stars", FIELD)
    return solve_by_methods(stars, [method], options=StarOptions(**more), **given)


def collinear(**options: Any) -> Any:
    return lambda one: collinearity(one, **options)


def churches(**options: Any) -> Any:
    return lambda one: church(one, **options)


CASES: dict[str, tuple[str, dict[str, Any], Any]] = {
    "usual": ("collinearity", {}, collinear()),
    "initial": ("collinearity", {**START, "corrections": 2}, collinear(**START, corrections=2)),
    "initial none": ("collinearity", {"corrections": 0}, collinear(start="svd", corrections=0)),
    "start": ("collinearity", {"start": "two-star", "corrections": 1},
              collinear(start="two-star", corrections=1)),
    "listed": ("collinearity", {"weights": "listed", "corrections": 3},
               collinear(weights="listed", corrections=3)),
    "robust": ("collinearity", {"weights": "robust"}, collinear(weights="robust")),
    "robust sigma": ("collinearity", {"weights": "robust", "reading_sigma_mm": 0.02},
                     collinear(weights="robust", reading_sigma_mm=0.02)),
    "church": ("church", {}, churches()),
    "weighted": ("church-weighted", {}, churches(weights="formula")),
    "weighted sigma": ("church-weighted", {"reading_sigma_mm": 1.0},
                       churches(weights="formula", reading_sigma_mm=1.0)),
    "weighted r": ("church-weighted-r", {}, churches(weights="formula-r")),
    "weighted r sigma": ("church-weighted-r", {"reading_sigma_mm": 1.0},
                         churches(weights="formula-r", reading_sigma_mm=1.0)),
    "svd": ("svd", {}, wahba),
    "two-star": ("two-star", {}, two_star),
    "raw": ("two-star", {"unit_cross_products": False},
            lambda one: two_star(one, unit_cross_products=False)),
    "farther": ("single-rotation", {}, single_rotation),
    "mean": ("single-rotation", {"rotation_angle": "mean"},
             lambda one: single_rotation(one, angle="mean")),
}  # fmt: skip


def expected_stars(method: str) -> np.ndarray:
    return ALL[:2] if method in ("two-star", "single-rotation") else ALL


@pytest.mark.parametrize("rotation", ["nearest", "as-solved"])
@pytest.mark.parametrize("name", CASES)
def test_each_method_is_handed_its_options(name: str, rotation: str) -> None:
    method, options, direct = CASES[name]
    (one,) = solve(method, **options, rotation=rotation)
    stars = expected_stars(method)
    solution = direct(FIELD.select(stars[None, :]))
    matrix = solution.matrix[0] if rotation == "as-solved" else solution.rotation()[0]
    assert (one.method, one.stars) == (method, tuple(int(k) + 1 for k in stars))
    assert_close("rae element", one.matrix, matrix)
    assert (one.iterations, one.failure) == (solution.iterations[0], solution.failure[0])
    if one.weights is not None or solution.weights is not None:
        assert_close("rae element", np.array(one.weights), solution.weights[0])


def test_the_cases_differ_so_that_a_lost_option_shows() -> None:
    found = {}
    for name, (method, options, _) in CASES.items():
        (one,) = solve(method, **options, rotation="as-solved")
        found[name] = (method, *np.round(np.ravel(one.matrix), 9))
    assert len(set(found.values())) == len(found)


def test_which_stars_each_method_solves() -> None:
    """Without pairs all stars, or the first two; with pairs those methods that can."""
    solved = solve_by_methods(FIELD, ALL_METHODS)
    assert [one.method for one in solved] == ALL_METHODS
    assert [one.stars for one in solved] == [
        tuple((expected_stars(name) + 1).tolist()) for name in ALL_METHODS
    ]
    pairs = np.array([[5, 1], [0, 3]])
    solved = solve_by_methods(FIELD, ALL_METHODS, pairs=pairs)
    names = ["collinearity", "two-star", "single-rotation", "svd"]
    assert [(one.method, one.stars) for one in solved] == [
        (name, pair) for name in names for pair in ((6, 2), (1, 4))
    ]
    some = solve_by_methods(FIELD, ALL_METHODS, subset=np.array([6, 2, 4, 0]))
    assert [one.stars for one in some] == [
        (7, 3) if name in ("two-star", "single-rotation") else (7, 3, 5, 1) for name in ALL_METHODS
    ]


def test_disagreements_are_shown_with_several_pairs_only() -> None:
    total, _ = star_disagreement_arcsec(FIELD)
    for one in solve("svd", pairs=np.array([[5, 1], [0, 3]])):
        assert one.disagreement_arcsec == [total[k - 1] for k in one.stars]
    assert solve("svd", pairs=np.array([[5, 1]]))[0].disagreement_arcsec is None
    assert solve("svd")[0].disagreement_arcsec is None
    assert solve("svd", subset=np.array([0, 1, 2, 3]))[0].disagreement_arcsec is None


def by_residuals(stars: StarField) -> float:
    off = collinearity(stars).residuals_mm(stars)
    return float(np.sqrt((off**2).sum() / (2 * len(off) - 3)))


GOOD = np.array([0, 1, 2, 3, 5, 6])


@pytest.mark.parametrize("method", ["collinearity", "svd", "church", "two-star"])
def test_whence_the_reading_sigma_comes(method: str) -> None:
    """Given; or from the residuals of all stars that are used; robust: from interstar angles."""
    given = solve(method, reading_sigma_mm=0.25)[0]
    assert (given.reading_sigma, given.reading_freedom) == (0.25, None)
    for subset in (ALL, GOOD, GOOD[:3]):
        one = solve(method, subset=subset)[0]
        stars = FIELD.select(subset)
        assert_close("rae element", one.reading_sigma or 0.0, by_residuals(stars))
        assert one.reading_freedom == 2 * len(subset) - 3
        robust = solve(method, subset=subset, weights="robust")[0]
        assert robust.reading_sigma == interstar_reading_sigma_mm(stars)
        assert robust.reading_freedom == 2 * len(subset) - 3
    two = solve(method, subset=GOOD[:2])[0]
    if method != "church":
        assert two.reading_sigma is None and two.rotation_sigma_arcsec is None
        assert two.failure == Failure.NONE


def test_robust_weights_below_a_half_leave_a_star_out_of_the_rms() -> None:
    """Listed ones do not: they fall with small residuals too."""
    (robust,) = solve("collinearity", weights="robust")
    counts = np.array(robust.weights) >= 0.5
    assert 0 < (~counts[:, 0]).sum() < 4
    squares = np.array(robust.residuals)[counts] ** 2
    assert_close("rae element", robust.rms, np.sqrt(squares.mean()))
    (listed,) = solve("collinearity", weights="listed", corrections=2)
    assert (np.array(listed.weights) < 0.5).any()
    assert_close("rae element", listed.rms, np.sqrt((np.array(listed.residuals) ** 2).mean()))


def test_without_a_solution_the_reading_sigma_is_that_of_the_interstar_angles() -> None:
    stars = FIELD.directions * np.where(np.arange(7) == 2, -1.0, 1.0)[:, None]
    behind = StarField.of(stars, FIELD.image_mm, FOCAL)
    assert collinearity(behind).failure != Failure.NONE
    (one,) = solve("two-star", stars=behind)
    assert one.reading_sigma == interstar_reading_sigma_mm(behind)


def test_a_wrong_star_is_no_reason_to_refuse_a_solution() -> None:
    """With the sigma of the residuals a pair 1 mm apart would be too uncertain, by angles not."""
    images = np.array([[30.0, 5], [30.3, 5], [4, -33], [21, 24], [-15, -22], [9, 12], [-3, 31]])
    rays = np.column_stack([images, np.full(7, -FOCAL)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    noise = np.array([[2.0, -1], [-1, 1], [1, 2], [0, -2], [4000, 9000], [-1, 1], [2, 0]]) * 5e-4
    one = StarField.of(rays, images + noise, FOCAL)
    interstar, residuals = interstar_reading_sigma_mm(one), by_residuals(one)
    sigma_deg = np.degrees(np.sqrt(2.0)) / 0.3  # of the turn about the pair, for readings of 1 mm
    assert interstar * sigma_deg < 1.5 and residuals * sigma_deg > 6.0
    pair = np.array([[0, 1]])
    assert solve("svd", stars=one, pairs=pair)[0].failure == Failure.NONE
    given = solve("svd", stars=one, pairs=pair, reading_sigma_mm=residuals)[0]
    assert given.failure == Failure.TOO_UNCERTAIN


COVARIANCES: dict[str, Any] = {
    "usual": lambda f, m, s: uncertainty.collinearity_covariance(f, m),
    "listed": lambda f, m, s: uncertainty.collinearity_covariance(f, m, s.weights),
    "robust sigma": lambda f, m, s: uncertainty.collinearity_covariance(f, m, s.weights),
    "svd": lambda f, m, s: uncertainty.wahba_covariance(f),
    "church": lambda f, m, s: uncertainty.church_covariance(f, m),
    "weighted": lambda f, m, s: uncertainty.church_covariance(f, m, weights="formula"),
    "weighted sigma": lambda f, m, s: uncertainty.church_covariance(
        f, m, weights="formula", reading_sigma_mm=1.0
    ),
    "weighted r": lambda f, m, s: uncertainty.church_covariance(f, m, weights="formula-r"),
    "two-star": lambda f, m, s: uncertainty.pair_covariance(f, m, two_star),
    "raw": lambda f, m, s: uncertainty.pair_covariance(f, m, CASES["raw"][2]),
    "farther": lambda f, m, s: uncertainty.pair_covariance(f, m, single_rotation),
    "mean": lambda f, m, s: uncertainty.pair_covariance(f, m, CASES["mean"][2]),
}


@pytest.mark.parametrize("name", COVARIANCES)
def test_each_solution_has_the_covariance_of_its_own_method(name: str) -> None:
    method, options, direct = CASES[name]
    (one,) = solve(method, **options)
    problem = FIELD.select(expected_stars(method)[None, :])
    solution = direct(problem)
    stated = COVARIANCES[name](problem, solution.rotation(), solution)[0]
    seconds = np.array(one.rotation_covariance_arcsec2)
    found = seconds / (3600.0 * 180.0 / np.pi * (one.reading_sigma or 0.0)) ** 2
    assert_close("ratio", found / np.abs(stated).max(), stated / np.abs(stated).max())


def test_what_leaves_no_attitude_to_show() -> None:
    """All failures but none at all, and no convergence."""
    shown = {code.name for code in Failure if not refused(code)}
    assert shown == {"NONE", "NO_CONVERGENCE"} and len(Failure) == 13


# Every field of a solved photograph, by numbers made by hand, and its names in a dictionary


ANGLES = ((10.0, 20.0, 30.0), (-40.0, 5.0, 170.0))
TRUE = np.array([jnkmat(*one) for one in ANGLES])
SHEARED = TRUE @ np.diag([1.02, 1.0, 0.99])  # as a Church matrix: M'M - 1 is .0404 and -.0199
IMAGES_FIELDS = np.array([[[5.0, 2.0], [-7.0, 3.0]], [[1.0, -6.0], [8.0, 8.0]]])
OFF_FIELDS = np.array([[[0.3, -0.4], [0.0, 0.1]], [[0.6, 0.0], [-0.2, 0.2]]])
COVARIANCE = np.array([np.diag([1.0, 4.0, 16.0]), np.diag([9.0, 1.0, 1.0])]) * 1e-6
SIGMA = 0.01
ARCSEC = degrees(1.0) * 3600.0
SUBSETS = np.array([[0, 3], [4, 2]])


def problems(errors: np.ndarray | None = None) -> StarField:
    """Two problems of two stars whose residuals are OFF by the matrices TRUE, and 100 mm."""
    rays = np.concatenate([IMAGES_FIELDS - OFF_FIELDS, np.full((2, 2, 1), -100.0)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1)[..., None]
    stars = np.einsum("pji,pnj->pni", TRUE, rays)
    return StarField.of(stars, IMAGES_FIELDS, 100.0, True, errors)


def solution(matrix: np.ndarray = TRUE, **more: object) -> StarSolution:
    none = np.array([0, 0])
    given = {"failure": none, "iterations": np.array([5, 7]), "converged": np.array([True, False])}
    return StarSolution(matrix, **{**given, **more})  # type: ignore[arg-type]


def split(one: StarSolution, **more: object) -> list[SolvedStars]:
    given = {
        "problems": problems(), "subsets": SUBSETS, "covariance": COVARIANCE, "sigma": SIGMA,
        "freedom": 6, "least_sigma": SIGMA, **more,
    }  # fmt: skip
    return split_solutions("a method", one, **given)  # type: ignore[arg-type]


def test_what_every_solution_has() -> None:
    first, second = split(solution(), disagreement_arcsec=np.array([10.0, 11, 12, 13, 14]))
    assert (first.method, first.failure, first.reading_sigma) == ("a method", Failure.NONE, SIGMA)
    assert (first.stars, second.stars) == ((1, 4), (5, 3))
    assert (first.iterations, second.iterations) == (5, 7)
    assert (first.converged, second.converged) == (True, False)
    assert (first.disagreement_arcsec, second.disagreement_arcsec) == ([10.0, 13.0], [14.0, 12.0])
    assert first.reading_freedom == second.reading_freedom == 6
    for k, one in enumerate((first, second)):
        m = TRUE[k]
        assert_close("rae angle", one.angles_deg[:3], ANGLES[k])
        alpha, delta, swing = np.radians(one.angles_deg[3:])
        axis = [cos(alpha) * cos(delta), sin(alpha) * cos(delta), sin(delta)]
        assert_close("rae element", axis, -m[2])  # the camera looks along -z
        north = np.array([-cos(alpha) * sin(delta), -sin(alpha) * sin(delta), cos(delta)])
        assert_close("rae element", [sin(swing), cos(swing)], m[:2] @ north)
        assert_close("rae element", one.matrix, m)
        assert_close("rae element", one.orthogonality_defect, 0.0)
        assert_close("residual", one.residuals, OFF_FIELDS[k])
        assert_close("residual", one.rms, sqrt((OFF_FIELDS[k] ** 2).sum() / 4.0))
        assert one.images == IMAGES_FIELDS[k].tolist()
        sigmas = np.sqrt(np.diag(COVARIANCE[k])) * SIGMA * ARCSEC
        assert_close("rae angle", one.rotation_sigma_arcsec or [], sigmas)
        assert_close("rae angle", one.rotation_rms_arcsec or 0.0, sqrt((sigmas**2).sum()))
        found = one.rotation_covariance_arcsec2 or []
        assert_close("rae angle", found, COVARIANCE[k] * (SIGMA * ARCSEC) ** 2)
        assert one.weighted_rms is None and one.weights is None and one.axis is None


def test_sigmas_of_the_angles_and_where_the_axis_points() -> None:
    """Seen straight: omega turns about x, phi about y, kappa about z; 95 percent by Student's F."""
    straight = solution(np.array([np.eye(3), jnkmat(0.0, 0.0, 90.0)]))
    plain, turned = split(straight, freedom=None)
    by_turns = [[1e-3, 2e-3, 4e-3], [1e-3, 3e-3, 1e-3]]
    for one, turns in ((plain, by_turns[0]), (turned, by_turns[1])):
        expected = degrees(SIGMA) * np.array(turns)
        assert_close("rae angle", (one.angle_sigmas_deg or [])[:3], expected)
    two = 2.447746830680816 * SIGMA * ARCSEC  # the root of chi square of two, 95 percent
    assert_close("rae angle", plain.boresight_95_arcsec or [], [two * 2e-3, two * 1e-3])
    assert_close("rae angle", turned.boresight_95_arcsec or [], [two * 3e-3, two * 1e-3])
    (estimated, _) = split(straight)
    f_2_6 = sqrt(2.0 * 5.143252849784718) * SIGMA * ARCSEC
    assert_close("rae angle", estimated.boresight_95_arcsec or [], [f_2_6 * 2e-3, f_2_6 * 1e-3])
    assert estimated.boresight_95_angle_deg == plain.boresight_95_angle_deg


def test_the_direction_of_the_longer_semi_axis_is_in_degrees() -> None:
    """A turn about y moves the axis along x, which at swing 0 and the equator is -east."""
    looking = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    one, other = split(solution(np.array([looking, looking])))
    assert_close("rae angle", (one.boresight_95_angle_deg or 0.0) % 180.0, 90.0)
    assert_close("rae angle", (other.boresight_95_angle_deg or 0.0) % 180.0, 0.0)


def test_the_matrix_as_solved_and_the_nearest_rotation() -> None:
    """TRUE diag(1.02, 1, .99): its nearest rotation is TRUE; the defect is of the matrix itself."""
    nearest, _ = split(solution(SHEARED))
    as_solved, _ = split(solution(SHEARED), choice="as-solved")
    assert_close("rae element", nearest.matrix, TRUE[0])
    assert_close("rae element", as_solved.matrix, SHEARED[0])
    gram = np.abs(SHEARED[0] @ SHEARED[0].T - np.eye(3)).max()
    assert_close("rae defect", [nearest.orthogonality_defect, as_solved.orthogonality_defect], gram)
    _, straight = split(solution(np.array([SHEARED[0], TRUE[1]])))
    assert_close("rae defect", straight.orthogonality_defect, 0.0)
    m = SHEARED[0]
    angles = [np.arctan2(-m[2, 1], m[2, 2]), np.arcsin(m[2, 0]), np.arctan2(-m[1, 0], m[0, 0])]
    assert_close("rae angle", as_solved.angles_deg[:3], np.degrees(angles))
    assert_close("rae angle", nearest.angles_deg[:3], ANGLES[0])
    assert np.abs(np.array(as_solved.residuals) - OFF_FIELDS[0]).max() > 0.01
    assert_close("residual", nearest.residuals, OFF_FIELDS[0])
    assert nearest.rotation_sigma_arcsec is not None
    assert as_solved == as_solved.without_uncertainty() and as_solved.reading_sigma == SIGMA


WEIGHTS = np.array([[[1.0, 1.0], [0.5, 0.5]], [[0.49, 0.49], [1.0, 1.0]]])


def test_root_mean_squares_with_weights_and_errors() -> None:
    """A robust weight below a half leaves a star out of the rms; weighted squares by their sum."""
    robust = split(solution(weights=WEIGHTS), robust=True)
    plain = split(solution(weights=WEIGHTS))
    assert_close("residual", robust[0].rms, sqrt((OFF_FIELDS[0] ** 2).sum() / 4.0))
    assert_close("residual", robust[1].rms, sqrt((OFF_FIELDS[1, 1] ** 2).sum() / 2.0))
    for k in (0, 1):
        assert_close("residual", plain[k].rms, sqrt((OFF_FIELDS[k] ** 2).sum() / 4.0))
        expected = sqrt((WEIGHTS[k] * OFF_FIELDS[k] ** 2).sum() / WEIGHTS[k].sum())
        assert_close("residual", [robust[k].weighted_rms, plain[k].weighted_rms], expected)
        assert robust[k].weights == WEIGHTS[k].tolist()
    errors = np.broadcast_to(np.diag([4.0, 0.25]), (2, 2, 2, 2))
    for k, one in enumerate(split(solution(), problems=problems(errors))):
        whitened = OFF_FIELDS[k] * [0.5, 2.0]
        assert_close("residual", one.weighted_rms or 0.0, sqrt((whitened**2).sum() / 4.0))
        assert_close("residual", one.rms, sqrt((OFF_FIELDS[k] ** 2).sum() / 4.0))


def test_what_only_a_single_rotation_has() -> None:
    axes = np.array([[0.0, 0.6, 0.8], [-0.6, 0.0, -0.8]])
    given = {
        "axis": axes, "angle_deg": np.array([-12.0, 34.0]), "conditioning": np.array([0.1, 0.2]),
        "interstar_discrepancy_arcsec": np.array([-5.0, 6.0]),
    }  # fmt: skip
    first, second = split(solution(**given))
    dec = degrees(np.arcsin(0.8))
    for one, expected in ((first, (90.0, dec)), (second, (180.0, -dec))):
        assert_close("rae angle", [one.axis_ra_deg or 0.0, one.axis_dec_deg or 0.0], expected)
    names = ("axis", "angle_deg", "conditioning", "interstar_discrepancy_arcsec")
    for k, one in enumerate((first, second)):
        expected = [np.asarray(given[name])[k].tolist() for name in names]
        assert [getattr(one, name) for name in names] == expected


@pytest.mark.parametrize(
    ("least", "sigma", "refused"),
    [(0.99, 1.0, False), (1.01, 1.0, True), (0.5, 90.0, False), (1.01, np.nan, True)],
)
def test_from_which_uncertainty_on_there_is_no_solution(
    least: float, sigma: float, refused: bool
) -> None:
    """Three degrees about the worst axis, with the smallest reading sigma that is possible."""
    covariance = np.array([np.diag([1e-9, np.radians(3.0) ** 2, 1e-9]), np.eye(3) * 1e-9])
    reading = {"sigma": sigma, "freedom": 4, "least_sigma": least}
    first, second = split(solution(), covariance=covariance, **reading)
    assert first.failure == (Failure.TOO_UNCERTAIN if refused else Failure.NONE)
    assert second.failure == Failure.NONE
    failed = solution(failure=np.array([Failure.BEHIND_CAMERA, Failure.NONE]))
    assert split(failed, covariance=covariance, **reading)[0].failure == Failure.BEHIND_CAMERA


def test_where_no_uncertainty_is_stated() -> None:
    unknown = split(solution(), sigma=np.nan, freedom=None, least_sigma=np.nan)
    assert all(one == one.without_uncertainty() and one.reading_sigma is None for one in unknown)
    holes = COVARIANCE.copy()
    holes[0, 2, 2] = np.nan
    first, second = split(solution(), covariance=holes)
    assert first == first.without_uncertainty() and second != second.without_uncertainty()
    codes = np.array([Failure.NO_CONVERGENCE, Failure.BEHIND_CAMERA])
    first, second = split(solution(failure=codes))
    assert first == first.without_uncertainty() and second.rotation_sigma_arcsec is not None


FULL = SolvedStars(
    method="m", stars=(1, 4), failure=Failure.NONE, angles_deg=[1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
    matrix=[[7.0]], orthogonality_defect=8.0, residuals=[[9.0]], iterations=10, converged=True,
    rms=11.0, reading_sigma=12.0, reading_freedom=13, rotation_sigma_arcsec=[2.0, 3.0, 6.0],
    rotation_covariance_arcsec2=[[15.0]], angle_sigmas_deg=[16.0, 17.0, 18.0, 19.0, 20.0, 21.0],
    boresight_95_arcsec=[22.0, 23.0], boresight_95_angle_deg=24.0, weighted_rms=25.0, axis=[26.0],
    axis_ra_deg=27.0, axis_dec_deg=28.0, angle_deg=29.0, conditioning=30.0,
    interstar_discrepancy_arcsec=31.0, weights=[[32.0]], disagreement_arcsec=[33.0],
    camera_m=[34.0], camera_sigma_m=[35.0], sky={"azimuth_deg": 36.0},
    camera={"focal": 37.0, "centre_x": 38.0, "centre_y": 39.0, "k1": 40.0},
    camera_sigmas={"focal": 41.0, "centre_x": 42.0, "centre_y": 43.0, "k1": 44.0}, images=[[45.0]],
)  # fmt: skip

NAMES = {
    "method": "m", "stars": [1, 4],
    "omega_deg": 1.0, "phi_deg": 2.0, "kappa_deg": 3.0,
    "alpha_deg": 4.0, "delta_deg": 5.0, "swing_deg": 6.0,
    "matrix": [[7.0]], "orthogonality_defect": 8.0, "residuals_U": [[9.0]], "iterations": 10,
    "converged": True, "rms_U": 11.0, "reading_sigma_U": 12.0, "reading_freedom": 13,
    "rotation_sigma_arcsec": [2.0, 3.0, 6.0], "rotation_covariance_arcsec2": [[15.0]],
    "sigma_omega_deg": 16.0, "sigma_phi_deg": 17.0, "sigma_kappa_deg": 18.0,
    "sigma_alpha_deg": 19.0, "sigma_delta_deg": 20.0, "sigma_swing_deg": 21.0,
    "boresight_95_arcsec": [22.0, 23.0], "boresight_95_angle_deg": 24.0, "weighted_rms_U": 25.0,
    "axis": [26.0], "axis_ra_deg": 27.0, "axis_dec_deg": 28.0, "angle_deg": 29.0,
    "conditioning": 30.0, "interstar_discrepancy_arcsec": 31.0, "weights": [[32.0]],
    "disagreement_arcsec": [33.0], "camera_m": [34.0], "camera_sigma_m": [35.0],
    "azimuth_deg": 36.0, "focal_U": 37.0, "centre_x_U": 38.0, "centre_y_U": 39.0, "k1": 40.0,
    "sigma_focal_U": 41.0, "sigma_centre_x_U": 42.0, "sigma_centre_y_U": 43.0, "sigma_k1": 44.0,
    "images_U": [[45.0]],
}  # fmt: skip


@pytest.mark.parametrize("unit", ["mm", "px"])
def test_the_dictionary_has_every_value_under_its_name(unit: str) -> None:
    expected = {name.replace("_U", f"_{unit}"): value for name, value in NAMES.items()}
    assert FULL.as_dict(unit) == expected
    assert list(FULL.as_dict(unit))[:8] == list(expected)[:8]
    if unit == "mm":
        assert FULL.as_dict() == expected


def test_a_value_that_there_is_not_has_no_name_and_zero_has_one() -> None:
    optional = {one.name: None for one in fields(FULL) if one.default is None}
    bare = replace(FULL, **optional, iterations=0, rms=0.0, converged=False)  # type: ignore[arg-type]
    assert list(bare.as_dict()) == [
        "method", "stars", "omega_deg", "phi_deg", "kappa_deg", "alpha_deg", "delta_deg",
        "swing_deg", "matrix", "orthogonality_defect", "residuals_mm", "iterations", "converged",
        "rms_mm",
    ]  # fmt: skip
    assert (bare.as_dict()["iterations"], bare.as_dict()["rms_mm"]) == (0, 0.0)
    assert bare.rotation_rms_arcsec is None


def test_without_uncertainty_five_fields_are_missing_and_no_others() -> None:
    bare = FULL.without_uncertainty()
    gone = {one.name for one in fields(FULL) if getattr(bare, one.name) != getattr(FULL, one.name)}
    assert gone == {
        "rotation_sigma_arcsec", "rotation_covariance_arcsec2", "angle_sigmas_deg",
        "boresight_95_arcsec", "boresight_95_angle_deg",
    }  # fmt: skip
    assert all(getattr(bare, name) is None for name in gone)
    assert FULL.rotation_rms_arcsec == 7.0 and bare.rotation_rms_arcsec is None
    unlike = replace(FULL, angle_sigmas_deg=None)
    assert unlike.rotation_rms_arcsec == 7.0
