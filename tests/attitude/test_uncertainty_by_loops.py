"""Every component of the uncertainty of every angle, and covariances, by loops over causes.

The derivatives are any numbers: each input has its own, and they are added up here one
cause at a time, as the definitions in docs/uncertainty.md have it.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit.estimates import estimate
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.attitude.reading_sigma import JobReadingSigma
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.uncertainty import Uncertainty, eta_interval_deg, uncertainty
from vopd.estimate import Estimate, Responses, StatedSigmas

ANGLES = np.array([[140.0, -60.0, 20.0], [20.0, 30.0, 330.0]])
STATED = StatedSigmas((1.0, 2.0, 3.0), (4.0, 5.0, 6.0), 0.07, 0.08, (0.09, 0.1))
GIVEN = Sigmas(reading=0.5, fiducial=0.3, velocity=0.2, wind=0.15, mount_deg=0.4)
COMMON = ("principal_point", "landmark", "focal", "time", "mount")
COUNT = 4  # landmarks, of which the third of frame 2 takes no part


def made() -> Estimate:
    """Two frames whose derivatives are any numbers; 0 for a landmark that takes no part."""
    rng = np.random.default_rng(8)
    used = np.array([[True] * 4, [True, True, False, True]])
    here = np.tile(used, 2)

    def some(*shape: int) -> Floats:
        return rng.normal(size=(2, *shape))

    of_landmarks = Responses(
        landmark=some(8, 3) * here[..., None], position=some(8, 3) * here[..., None],
        focal_length=some(8) * here, time=some(8) * here, attack_by_camera=some(3, 3),
        attack_by_time=some(3), attack_by_velocity=some(3, 3),
    )  # fmt: skip
    return estimate(
        ANGLES, used=used, vehicle_deg=ANGLES[::-1] + 7.0, vehicle_by_camera=some(3, 3),
        gain=some(3, 8) * here[:, None], body_gain=some(3, 8) * here[:, None],
        responses=of_landmarks, relative_sigma=rng.uniform(0.5, 2.0, (2, 4)), stated=STATED,
    )  # fmt: skip


def turned(angles_deg: Floats, axis: int, by_deg: float) -> Floats:
    """Yaw, pitch, roll after a small turn of a vehicle about one of its axes."""
    before = Rotation.from_euler("ZYX", angles_deg, degrees=True)
    small = Rotation.from_rotvec(by_deg * np.eye(3)[axis], degrees=True)
    return np.asarray((before * small).as_euler("ZYX", degrees=True))


def causes(e: Estimate, k: int) -> dict[str, list[tuple[Floats, Floats, Floats]]]:
    """Of frame k: for each cause the residuals (8,), further angles (9,) and turn (3,), radians."""
    r, used = e.responses, np.tile(e.used[k], 2)
    along = np.repeat(np.eye(2), COUNT, axis=1) * used
    nine, three = np.zeros(9), np.zeros(3)
    found: dict[str, list[tuple[Floats, Floats, Floats]]] = {
        "reading": [
            (0.5 * e.relative_sigma[k, i % COUNT] * np.eye(8)[i], nine, three) for i in range(8)
        ],
        "centre": [(-0.15 * one, nine, three) for one in along],
        "principal_point": [(-0.09 * along[0], nine, three), (-0.1 * along[1], nine, three)],
        "position": [(r.position[k, :, c] * (4.0, 5.0, 6.0)[c], nine, three) for c in range(3)],
        "focal": [(0.07 * r.focal_length[k], nine, three)],
        "time": [(0.08 * r.time[k], np.append(np.zeros(6), 0.08 * r.attack_by_time[k]), three)],
        "landmark": [
            (r.landmark[k, :, c] * (1.0, 2.0, 3.0)[c] * (np.arange(8) % COUNT == i), nine, three)
            for i in range(COUNT)
            for c in range(3)
        ],
        "velocity": [
            (np.zeros(8), np.append(np.zeros(6), 0.2 * r.attack_by_velocity[k, :, c]), three)
            for c in range(3)
        ],
        "wind": [
            (np.zeros(8), np.append(np.zeros(6), -0.15 * r.attack_by_velocity[k, :, c]), three)
            for c in range(2)
        ],
    }  # fmt: skip
    found["mount"] = []
    for c in range(3):
        step = 1e-3
        there, back = (turned(e.vehicle_deg[k], c, way * step) for way in (1.0, -1.0))
        by_turn = (there - back) / (2.0 * step)
        camera = np.linalg.solve(e.vehicle_by_camera[k], by_turn)  # the same turn, of the camera
        angles = np.concatenate([np.zeros(3), by_turn, r.attack_by_camera[k] @ camera])
        size = np.radians(0.4)
        found["mount"].append((np.zeros(8), size * angles, size * np.eye(3)[c]))
    return found


def or_one(values: Floats) -> Floats:
    """To divide by: 1 where a cause changes nothing."""
    return np.where(values > 0.0, values, 1.0)


def test_every_component_of_every_angle_and_the_covariances() -> None:
    e = made()
    found = uncertainty(e, GIVEN)
    assert set(found.components) == set(causes(e, 0))
    for k in range(2):
        squares, covariance, common = np.zeros(9), np.zeros((3, 3)), np.zeros((3, 3))
        alpha_beta = np.zeros((2, 2))
        for name, ones in causes(e, k).items():
            of_this = np.zeros(9)
            for residual, further, turn in ones:
                camera = e.gain[k] @ residual
                attack = e.responses.attack_by_camera[k] @ camera
                vehicle = e.vehicle_by_camera[k] @ camera
                change = np.degrees(np.concatenate([camera, vehicle, attack]) + further)
                body = np.degrees(e.body_gain[k] @ residual + turn)
                of_this += change**2
                alpha_beta += np.outer(change[6:8], change[6:8])
                covariance += np.outer(body, body)
                common += np.outer(body, body) * (name in COMMON)
            assert_close(
                "seven digits",
                found.components[name][k] ** 2 / or_one(of_this),
                of_this / or_one(of_this),
            )
            squares += of_this
        assert_close("seven digits", found.total[k] ** 2 / squares, np.ones(9))
        assert_close(
            "seven digits", found.half_width_95[k] ** 2 / squares, np.full(9, 1.9599639845**2)
        )
        assert_close("seven digits", found.covariance_deg2[k] / covariance, np.ones((3, 3)))
        assert_close("seven digits", found.covariance_common_deg2[k] / common, np.ones((3, 3)))
        (ends,) = eta_interval_deg(np.array([3.0]), np.sqrt(squares[8:]), alpha_beta[None])
        assert_close("seven digits", found.eta_interval_95_deg[k] / or_one(ends), ends > 0.0)
    assert np.isinf(found.freedom).all()


QUANTILES = {  # of Student's t for 68.27 and 95 %, by table G.2 of the GUM (ISO, 1995)
    0.5: (1.84, 12.71), 1: (1.84, 12.71), 2: (1.32, 4.30), 3: (1.20, 3.18), 5: (1.11, 2.57),
    8: (1.07, 2.31), 20: (1.03, 2.09), np.inf: (1.0, 1.96),
}  # fmt: skip


def of(freedom: float, fiducial: float) -> Uncertainty:
    scale = JobReadingSigma(0.5, freedom, "residuals", np.full(2, 0.5), 0.5)
    return uncertainty(estimate(ANGLES), Sigmas(fiducial=fiducial), scale)


@pytest.mark.parametrize("freedom", [*QUANTILES])
def test_few_degrees_of_freedom_have_the_factors_of_student_s_t(freedom: float) -> None:
    """The reading's component has that of one standard deviation, an interval that of 95 %."""
    plain, found = of(np.inf, 0.0), of(freedom, 0.0)
    assert list(found.components) == ["reading"]
    one_sigma, upper = (np.full((2, 9), factor) for factor in QUANTILES[freedom])
    assert_close("quantile of two decimals", found.total / plain.total, one_sigma)
    reading = found.components["reading"]
    assert_close("quantile of two decimals", reading / plain.total, one_sigma)
    assert_close("quantile of two decimals", found.half_width_95 / plain.total, upper)
    assert (found.freedom == freedom).all()
    wider = found.half_width_95[:, 8] / 1.9599639845
    covariance = np.array([
        gain @ gain.T * (0.5 * w / plain) ** 2
        for gain, w, plain in zip(
            np.degrees(estimate(ANGLES).gain[:, :2]), wider, plain.total[:, 8], strict=True
        )
    ])  # fmt: skip
    ends = eta_interval_deg(np.full(2, 3.0), wider, covariance)
    assert_close("seven digits", found.eta_interval_95_deg / or_one(ends), ends > 0.0)


def test_degrees_of_freedom_of_several_components_are_those_of_welch_and_satterthwaite() -> None:
    """What is known well adds no degree: 2 of the reading's are 2 (whole / part) ** 2."""
    plain, found = of(np.inf, 0.7), of(2, 0.7)
    part = plain.components["reading"] ** 2
    whole = part + plain.components["centre"] ** 2
    assert_close("seven digits", found.freedom / (2.0 * (whole / part) ** 2), np.ones((2, 9)))
    assert_close("ratio", found.components["centre"], plain.components["centre"])
    student = (found.components["reading"] / plain.components["reading"]) ** 2
    assert_close("quantile of two decimals", np.sqrt(student), np.full((2, 9), 1.32))
    both = student * part + plain.components["centre"] ** 2
    assert_close("seven digits", found.total**2 / both, np.ones((2, 9)))
