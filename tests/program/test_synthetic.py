"""Known attitudes, photographed by an independent camera over an independent Earth, come back."""

from __future__ import annotations

import numpy as np
import pytest

from tests.kit import spherical_film
from tests.tolerances import assert_close
from vopd.errata import fixes
from vopd.program.vopd import run


def turned(found: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    return (found - wanted + 180.0) % 360.0 - 180.0


def looking_down(frames: int) -> np.ndarray:
    """Pitch -86 to -60, all yaws and rolls."""
    k = np.arange(frames)
    return np.stack(
        [(20.0 + 47.0 * k) % 360, -86.0 + 26.0 * k / frames, (300.0 - 61.0 * k) % 360], 1
    )


@pytest.mark.parametrize("k", range(8))
def test_one_frame(k: int) -> None:
    """From six degrees away in every angle."""
    truth = looking_down(8)[k : k + 1]
    results = run(spherical_film.job(truth, truth[0] + [6.0, -6.0, 6.0]))
    assert results.converged.all()
    assert_close("angle from readings", turned(results.camera_deg, truth), 0.0)
    assert_close("residual of readings", results.residual_mm, 0.0)


def test_a_film_that_is_tracked() -> None:
    """Group 8's estimate serves 12 frames that wander 10 degrees from it."""
    k = np.arange(12.0)
    truth = np.stack([140.0 + k, -80.0 + 0.8 * k, 60.0 - 0.9 * k], axis=1)
    results = run(spherical_film.job(truth, truth[5]))
    assert results.converged.all()
    assert_close("angle from readings", turned(results.camera_deg, truth), 0.0)
    assert (results.start_deg == truth[5]).all()


def test_every_part_of_the_model_matters() -> None:
    """What the errata change, the independent model has as the listing does, so each one shows."""
    truth = looking_down(2)
    job = spherical_film.job(truth[:1], truth[0])
    for name in ("latitude-series", "earth"):
        moved = turned(run(job, fixes(name)).camera_deg, truth[:1])
        assert np.abs(moved).max() > 1e-3, name
    for name in ("feet-per-km", "sin-6phi"):
        moved = turned(run(job, fixes(name)).camera_deg, run(job).camera_deg)
        assert 0 < np.abs(moved).max() < 1e-4, name


def test_the_camera_in_the_vehicle() -> None:
    """Vehicle angles are minus the camera's: 20, -86, 300 become 340, 86, 60."""
    truth = np.array([[20.0, -86.0, 300.0]])
    results = run(spherical_film.job(truth, truth[0], multiplier=(-1, -1, -1)))
    assert_close("angle from readings", results.vehicle_deg, [[340.0, 86.0, 60.0]])
