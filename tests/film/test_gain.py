"""Images, residuals, partials and gain of an estimate, by Appendix A written anew and by scipy.

The camera's angles are those that the run ended with; everything else is worked out here.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.kit import appendix_a, spherical_film
from tests.kit.jobs import reread
from tests.tolerances import assert_close
from vopd.errata import fixes
from vopd.estimate import Estimate
from vopd.film import film_estimate
from vopd.program.vopd import run

FOCAL = 10.4
MM_PER_INCH = 0.713816400205
RUNS = {"1974": fixes("eight-digits"), "first-landmark": fixes("first-landmark", "eight-digits")}


@cache
def solved(name: str) -> tuple[np.ndarray, Estimate]:
    """Two frames, read with errors of some micrometres by a lens without distortion.

    The vehicle's pitch is half the camera's, backward, and its roll is turned by 30 degrees.
    Gives film coordinates (F, L, 2), mm, and the estimate.
    """
    truth = np.array([[140.0, -60.0, 60.0], [143.0, -57.0, 64.0]])
    job = spherical_film.job(truth, truth[0], multiplier=(1.0, -0.5, 1.0))
    errors = np.random.default_rng(8).normal(0.0, 0.02, (2, 5, 1, 2))
    camera = replace(
        job.camera,
        lens_distortion_um=0.0 * job.camera.lens_distortion_um,
        offset_deg=np.array([0.0, 0.0, 30.0]),
    )
    readings = reread(job.readings, landmark_in=job.readings.landmark_in + errors)
    job = replace(job, camera=camera, readings=readings)
    centre = readings.fiducial_in.mean(axis=(1, 2))[:, None]
    film = (readings.landmark_in.mean(axis=2) - centre) * MM_PER_INCH
    return film, film_estimate(run(job, RUNS[name]))


def flat(pairs: np.ndarray) -> np.ndarray:
    """x of every landmark, then y of every landmark."""
    return np.concatenate([pairs[:, 0], pairs[:, 1]])


def partials(one: Estimate, frame: int, erratum: bool) -> np.ndarray:
    """Of the computed coordinates by camera yaw, pitch, roll, (2L, 3) mm per radian."""
    angles = one.camera_deg[frame] / appendix_a.RAD
    return -flat(appendix_a.partials(angles, one.direction[frame], FOCAL, erratum))


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("frame", [0, 1])
def test_images_and_residuals(name: str, frame: int) -> None:
    """A residual is measured minus computed."""
    film, one = solved(name)
    angles = one.camera_deg[frame] / appendix_a.RAD
    computed = appendix_a.project(angles, one.direction[frame], FOCAL)
    assert np.abs(film[frame] - computed).max() > 1e-3
    assert_close("residual", one.image[frame], film[frame])
    assert_close("residual", one.residual[frame], flat(film[frame] - computed))


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("frame", [0, 1])
def test_partials_and_gain(name: str, frame: int) -> None:
    """The partials are the correct ones; the gain has those of the run, with its erratum."""
    _, one = solved(name)
    true = partials(one, frame, erratum=False)
    of_run = partials(one, frame, erratum=name == "1974")
    assert_close("derivative by steps", one.partials[frame] / 10.0, true / 10.0)
    gain = np.linalg.solve(of_run.T @ true, of_run.T)
    assert_close("derivative by steps", one.gain[frame], gain)
    if name == "1974":
        assert np.abs(gain - np.linalg.pinv(true)).max() > 1e-4


@pytest.mark.parametrize("axis", range(3), ids=("yaw", "pitch", "roll"))
def test_the_gain_of_the_body_is_its_small_rotation(axis: int) -> None:
    """Residuals that turn the camera by a small angle turn the body about its own axes.

    Group 3 makes the vehicle's angles of the camera's; forward, right, down by scipy.
    """
    _, one = solved("1974")
    step = 1e-4 * np.eye(3)[axis]
    turn = np.degrees(step) * [1.0, -0.5, 1.0]
    ends = [
        Rotation.from_euler("ZYX", one.vehicle_deg[0] + sign * turn, degrees=True)
        for sign in (-1.0, 1.0)
    ]
    expected = (ends[0].inv() * ends[1]).as_rotvec() / 2e-4
    found = one.body_gain[0] @ one.partials[0] @ step / 1e-4
    assert_close("derivative by steps", found, expected)
    assert (one.vehicle_by_camera == np.diag([1.0, -0.5, 1.0])).all()
