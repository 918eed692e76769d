"""Methods chosen by name: which stars each solves, what each is handed, and its reading sigma."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.kit.rae_listings import jnkmat
from tests.tolerances import assert_close
from vopd.stellar import (
    Failure,
    StarField,
    church,
    collinearity,
    single_rotation,
    two_star,
    uncertainty,
    wahba,
)
from vopd.stellar.interstar_angles import interstar_reading_sigma_mm, star_disagreement_arcsec
from vopd.stellar.methods.run import SolvedStars, StarOptions, refused, solve_by_methods

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


def test_the_usual_options() -> None:
    assert StarOptions() == StarOptions(
        initial_deg=None, start="svd", weights="uniform", corrections=None, reading_sigma_mm=None,
        unit_cross_products=True, rotation_angle="farther", rotation="nearest",
    )  # fmt: skip
    (plain,) = solve_by_methods(FIELD, ["collinearity"])
    assert plain == solve("collinearity")[0] and plain.weights is None


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
    total = star_disagreement_arcsec(FIELD).total_arcsec
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
        stars = FIELD.only(subset)
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
