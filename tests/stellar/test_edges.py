"""Thresholds and first steps: where the rules of the stellar methods begin and end."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close, within
from vopd.findings import InputError, VopdError
from vopd.stellar import (
    StarField,
    church,
    closed_form,
    collinearity,
    orientation_matrix,
    outliers,
    single_rotation,
    two_star,
)
from vopd.stellar.field import Failure
from vopd.stellar.listed import tustar
from vopd.stellar.radec import read_typed
from vopd.stellar.tables_1987 import DIRECTIONS, PERTURBED_MM, TRUTH_DEG, sample_field

IMAGES = np.array([[24.0, 20.0], [-15.0, 18.0], [-21.0, -22.0], [19.0, -14.0], [3.0, 5.0]])


def moved(*arcsec: float) -> StarField:
    """Stars of IMAGES seen straight on, each moved so far: along x by turns and along y."""
    rays = np.column_stack([IMAGES[: len(arcsec)], np.full(len(arcsec), -76.0)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    for k, size in enumerate(arcsec):
        axis = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]][k % 2]
        turn = Rotation.from_rotvec(np.radians(size / 3600.0) * np.array(axis))
        rays[k] = turn.apply(rays[k])
    return StarField.of(rays, IMAGES[: len(arcsec)], 76.0)


@pytest.mark.parametrize(
    ("arcsec", "expected"),
    [
        ((10.0, -12.0, 2000.0, 8.0, 9.0), [2]),
        ((10.0, -12.0, 25.0, 8.0, 9.0), []),  # no more than twice the others'
        ((0.0, 0.0, 0.3, 0.0, 0.0), []),  # below a second, whatever the others
        ((0.0, 0.0, 30.0, 0.0, 0.0), [2]),
        ((0.0, 900.0, 0.0), []),  # of three nobody can tell which
    ],
)
def test_who_stands_out(arcsec: tuple[float, ...], expected: list[int]) -> None:
    assert np.flatnonzero(outliers(moved(*arcsec))).tolist() == expected


def test_the_first_robust_pass_has_no_weights() -> None:
    start = {"initial_deg": [150.0, -15.0, 50.0], "corrections": 1}
    first = collinearity(sample_field(), weights="robust", **start).matrix  # type: ignore[arg-type]
    plain = collinearity(sample_field(), **start).matrix  # type: ignore[arg-type]
    np.testing.assert_array_equal(first, plain)


def test_every_start_within_60_degrees_leads_home() -> None:
    """Axes all around the true one, by 10 and by 60 degrees, whatever the turn about them."""
    home = orientation_matrix(TRUTH_DEG)
    around = np.radians(np.arange(0.0, 360.0, 30.0))
    tilts = [
        Rotation.from_rotvec(np.radians(tilt) * np.array([np.cos(a), np.sin(a), 0.0]))
        for tilt in (10.0, 60.0)
        for a in around
    ]
    spins = [Rotation.from_rotvec([0.0, 0.0, spin]) for spin in (0.0, 2.0, np.pi)]
    starts = np.array([(s * t).as_matrix() @ home for t in tilts for s in spins])
    angles = np.degrees(  # of these matrices, by eq. 3.5
        [[np.arctan2(-m[2, 1], m[2, 2]), np.arcsin(m[2, 0]), np.arctan2(-m[1, 0], m[0, 0])]
         for m in starts]
    )  # fmt: skip
    fields = StarField.of(np.tile(DIRECTIONS, (len(starts), 1, 1)), PERTURBED_MM, 76.0)
    solution = collinearity(fields, initial_deg=angles)
    assert solution.converged.all() and solution.iterations.max() < 50
    assert np.ptp(solution.matrix, axis=0).max() < within("rae rotation")


@pytest.mark.parametrize("solve", [two_star, single_rotation])
def test_one_image_of_two_stars_is_no_pair(solve: object) -> None:
    rays = np.array([[0.1, 0.2, -1.0], [0.1, 0.3, -1.0]])
    stars = rays / np.linalg.norm(rays, axis=1)[:, None]
    same = StarField.of(stars, [[5.0, 5.0], [5.0, 5.0]], 76.0)
    assert solve(same).failure == Failure.SAME_STAR  # type: ignore[operator]
    same = StarField.of(stars[[0, 0]], [[5.0, 5.0], [7.0, 5.0]], 76.0)
    assert solve(same).failure == Failure.SAME_STAR  # type: ignore[operator]


def test_too_few_stars_and_shapes_that_do_not_fit() -> None:
    assert church(StarField.of(DIRECTIONS[:2], PERTURBED_MM[:2], 76.0)).failure == 2
    single = StarField.of(np.tile(DIRECTIONS[:1], (3, 1, 1)), PERTURBED_MM[:1], 76.0)
    assert collinearity(single).failure.tolist() == [2, 2, 2]
    assert np.isnan(closed_form(single)).all() and not outliers(single).any()
    for stars, images, focal in (
        (DIRECTIONS[:3], PERTURBED_MM, 76.0),
        (DIRECTIONS[:, :2], PERTURBED_MM, 76.0),
        (DIRECTIONS[:0], PERTURBED_MM[:0], 76.0),
        (DIRECTIONS, PERTURBED_MM, -76.0),
    ):
        with pytest.raises(VopdError):
            StarField.of(stars, images, focal)


def test_tustar_s_discrepancy_is_celestial_minus_photo() -> None:
    """As the sound one, to what an arc cosine can."""
    pair = StarField.of(DIRECTIONS[:2], PERTURBED_MM[:2], 76.0)
    sound = two_star(pair).interstar_discrepancy_arcsec
    assert sound is not None and sound < -400.0  # -474.40, by hand from the tables
    assert_close("rae arc cosine, rounded stars", tustar(pair).discrepancy_arcsec, sound)


def test_radec2_reads_15_columns_and_50_images() -> None:
    head = ["76.", "1.", "2.", "3."]
    typed = read_typed("\n".join([*head, "10." + " " * 12 + "99", "20.", "9999.9"]))
    assert typed.image_mm.tolist() == [[10.0, 20.0]]
    assert "line 5: columns 16 on are not read: '99'" in str(typed.warnings[0])
    many = read_typed("\n".join([*head, *["1.", "2."] * 60]))
    assert many.image_mm.shape == (50, 2)
    with pytest.raises(InputError, match="line 6, image y"):
        read_typed("\n".join([*head, "10."]))
    (warning,) = read_typed("\n".join([*head, "1.", "2."])).warnings
    assert "no 9999.9" in str(warning)
