"""Every field of a solved photograph, by numbers made by hand, and its names in a dictionary."""

from __future__ import annotations

from dataclasses import fields, replace
from math import cos, degrees, sin, sqrt

import numpy as np
import pytest

from tests.kit.rae_listings import jnkmat
from tests.tolerances import assert_close
from vopd.stellar import Failure, StarField, StarSolution
from vopd.stellar.methods.run import ReadingScale, SolvedStars, split_solutions

ANGLES = ((10.0, 20.0, 30.0), (-40.0, 5.0, 170.0))
TRUE = np.array([jnkmat(*one) for one in ANGLES])
SHEARED = TRUE @ np.diag([1.02, 1.0, 0.99])  # as a Church matrix: M'M - 1 is .0404 and -.0199
IMAGES = np.array([[[5.0, 2.0], [-7.0, 3.0]], [[1.0, -6.0], [8.0, 8.0]]])
OFF = np.array([[[0.3, -0.4], [0.0, 0.1]], [[0.6, 0.0], [-0.2, 0.2]]])
COVARIANCE = np.array([np.diag([1.0, 4.0, 16.0]), np.diag([9.0, 1.0, 1.0])]) * 1e-6
SIGMA = 0.01
ARCSEC = degrees(1.0) * 3600.0
SUBSETS = np.array([[0, 3], [4, 2]])


def problems(errors: np.ndarray | None = None) -> StarField:
    """Two problems of two stars whose residuals are OFF by the matrices TRUE, and 100 mm."""
    rays = np.concatenate([IMAGES - OFF, np.full((2, 2, 1), -100.0)], axis=-1)
    rays /= np.linalg.norm(rays, axis=-1)[..., None]
    stars = np.einsum("pji,pnj->pni", TRUE, rays)
    return StarField.of(stars, IMAGES, 100.0, True, errors)


def solution(matrix: np.ndarray = TRUE, **more: object) -> StarSolution:
    none = np.array([0, 0])
    given = {"failure": none, "iterations": np.array([5, 7]), "converged": np.array([True, False])}
    return StarSolution(matrix, **{**given, **more})  # type: ignore[arg-type]


def split(one: StarSolution, **more: object) -> list[SolvedStars]:
    given = {
        "problems": problems(), "subsets": SUBSETS, "choice": "nearest",
        "reading": ReadingScale(SIGMA, 6, SIGMA), "covariance": COVARIANCE,
        "disagreement_arcsec": None, "robust": False, **more,
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
        assert_close("residual", one.residuals, OFF[k])
        assert_close("residual", one.rms, sqrt((OFF[k] ** 2).sum() / 4.0))
        assert one.images == IMAGES[k].tolist()
        sigmas = np.sqrt(np.diag(COVARIANCE[k])) * SIGMA * ARCSEC
        assert_close("rae angle", one.rotation_sigma_arcsec or [], sigmas)
        assert_close("rae angle", one.rotation_rms_arcsec or 0.0, sqrt((sigmas**2).sum()))
        found = one.rotation_covariance_arcsec2 or []
        assert_close("rae angle", found, COVARIANCE[k] * (SIGMA * ARCSEC) ** 2)
        assert one.weighted_rms is None and one.weights is None and one.axis is None


def test_sigmas_of_the_angles_and_where_the_axis_points() -> None:
    """Seen straight: omega turns about x, phi about y, kappa about z; 95 percent by Student's F."""
    straight = solution(np.array([np.eye(3), jnkmat(0.0, 0.0, 90.0)]))
    known = ReadingScale(SIGMA, None, SIGMA)
    plain, turned = split(straight, reading=known)
    by_turns = [[1e-3, 2e-3, 4e-3], [1e-3, 3e-3, 1e-3]]
    for one, turns in ((plain, by_turns[0]), (turned, by_turns[1])):
        expected = degrees(SIGMA) * np.array(turns)
        assert_close("rae angle", (one.angle_sigmas_deg or [])[:3], expected)
    two = 2.447746830680816 * SIGMA * ARCSEC  # the root of chi square of two, 95 percent
    assert_close("rae angle", plain.boresight_95_arcsec or [], [two * 2e-3, two * 1e-3])
    assert_close("rae angle", turned.boresight_95_arcsec or [], [two * 3e-3, two * 1e-3])
    (estimated, _) = split(straight, reading=ReadingScale(SIGMA, 6, SIGMA))
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
    assert np.abs(np.array(as_solved.residuals) - OFF[0]).max() > 0.01
    assert_close("residual", nearest.residuals, OFF[0])
    assert nearest.rotation_sigma_arcsec is not None
    assert as_solved == as_solved.without_uncertainty() and as_solved.reading_sigma == SIGMA


WEIGHTS = np.array([[[1.0, 1.0], [0.5, 0.5]], [[0.49, 0.49], [1.0, 1.0]]])


def test_root_mean_squares_with_weights_and_errors() -> None:
    """A robust weight below a half leaves a star out of the rms; weighted squares by their sum."""
    robust = split(solution(weights=WEIGHTS), robust=True)
    plain = split(solution(weights=WEIGHTS))
    assert_close("residual", robust[0].rms, sqrt((OFF[0] ** 2).sum() / 4.0))
    assert_close("residual", robust[1].rms, sqrt((OFF[1, 1] ** 2).sum() / 2.0))
    for k in (0, 1):
        assert_close("residual", plain[k].rms, sqrt((OFF[k] ** 2).sum() / 4.0))
        expected = sqrt((WEIGHTS[k] * OFF[k] ** 2).sum() / WEIGHTS[k].sum())
        assert_close("residual", [robust[k].weighted_rms, plain[k].weighted_rms], expected)
        assert robust[k].weights == WEIGHTS[k].tolist()
    errors = np.broadcast_to(np.diag([4.0, 0.25]), (2, 2, 2, 2))
    for k, one in enumerate(split(solution(), problems=problems(errors))):
        whitened = OFF[k] * [0.5, 2.0]
        assert_close("residual", one.weighted_rms or 0.0, sqrt((whitened**2).sum() / 4.0))
        assert_close("residual", one.rms, sqrt((OFF[k] ** 2).sum() / 4.0))


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
    reading = ReadingScale(sigma, 4, least)
    first, second = split(solution(), covariance=covariance, reading=reading)
    assert first.failure == (Failure.TOO_UNCERTAIN if refused else Failure.NONE)
    assert second.failure == Failure.NONE
    failed = solution(failure=np.array([Failure.BEHIND_CAMERA, Failure.NONE]))
    assert split(failed, covariance=covariance, reading=reading)[0].failure == Failure.BEHIND_CAMERA


def test_where_no_uncertainty_is_stated() -> None:
    unknown = split(solution(), reading=ReadingScale(np.nan, None, np.nan))
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
