"""Means over the frames of flights: one frame, errors in common, and how far the truth is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from tests.kit.joint_flights import Scene, drone, flight_of
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.attitude.history import History
from vopd.attitude.sigmas import Sigmas
from vopd.flight.flight import Flight, TrackFixes
from vopd.flight.result import solve_flight_read
from vopd.flight.solve.equations import Priors
from vopd.geometry.rotations import body_angles_by_turns

MOUNT = Rotation.from_euler("ZYX", [20.0, -70.0, 5.0], degrees=True).as_matrix()


def project(
    rng: np.random.Generator,
    scene: Scene,
    priors: Priors,
    loss: str = "least-squares",
    **more: float,
) -> Flight:
    """A flight that states the standard deviations its errors are drawn from, and `more`."""
    flight = flight_of(rng, scene, 1.0, priors, velocity_m_s=(4.0, 2.0, 0.0), loss=loss)
    place = [priors.parameter.get(name, 0.0) for name in ("east", "north", "up")]
    path = replace(flight.path, bias_sigma_m=np.array(place))
    options = replace(flight.options, parameter_sigma=more)
    picks = replace(flight.picks, stated=True)
    return replace(flight, path=path, options=options, picks=picks, mount=MOUNT)


def once_a_second(frames: int, rate_hz: float) -> TrackFixes:
    """Fixes a second apart, of frames between them."""
    time = np.arange(frames) / rate_hz
    part = time - np.floor(time)
    first = np.floor(time).astype(np.int64)
    sigma_m = np.tile([2.0, 2.0, 4.0], (first[-1] + 2, 1))
    return TrackFixes(first, np.stack([1.0 - part, part], axis=1), sigma_m)


FLIGHTS = {
    "exact": (Priors(), {}),
    "lens and clock": (Priors(), {"focal": 5.0, "centre_u": 2.0, "clock": 0.05, "k1": 0.01}),
    "track": (Priors(once_a_second(8, 3.0), np.full((5, 3), 0.1)), {"focal": 5.0, "clock": 0.05}),
    "bias": (Priors(once_a_second(8, 3.0), None, {"east": 1.0, "north": 1.0, "up": 2.0}), {}),
    "place": (Priors(None, None, {"east": 0.3, "north": 0.3, "up": 0.3}), {"refraction": 0.06}),
}


def history_of(name: str, loss: str = "least-squares") -> History:
    rng = np.random.default_rng(len(name))
    priors, more = FLIGHTS[name]
    flight = project(rng, drone(rng, 8, 5), priors, loss=loss, **more)
    return solve_flight_read(flight).history(Sigmas(mount_deg=0.01))


@pytest.mark.parametrize("name", FLIGHTS)
def test_the_mean_of_one_frame_is_that_frame(name: str) -> None:
    one = history_of(name)
    doubt = one.uncertainty
    for frame in (0, 5):
        found = one.mean([frame])
        assert_close("mean of one frame, deg", found.camera_deg, one.estimate.camera_deg[frame])
        assert_close("mean of one frame, deg", found.vehicle_deg, one.estimate.vehicle_deg[frame])
        whole = doubt.covariance_deg2[frame]
        assert_close("mean of one frame", found.covariance_deg2 / whole[0, 0], whole / whole[0, 0])
        assert set(found.components) == set(doubt.components)
        for part, own in found.components.items():
            expected = doubt.components[part][frame, :6]
            assert_close("mean of one frame", own / expected[5], expected / expected[5])
        assert_close(
            "mean of one frame", found.half_width_95 / doubt.half_width_95[frame, :6], np.ones(6)
        )


def test_a_robust_mean_of_one_frame_is_that_frame() -> None:
    one = history_of("track", "cauchy")
    whole = one.uncertainty.covariance_deg2[3]
    found = one.mean([3]).covariance_deg2
    assert_close("mean of one frame", found / whole[0, 0], whole / whole[0, 0])


def test_errors_that_are_only_propagated_keep_their_sign() -> None:
    """An error of the clock turns frames of a camera that shakes to and fro: their mean hardly."""
    rng = np.random.default_rng(1)
    scene = drone(rng, 8, 5)
    scene = scene._replace(rotation=np.repeat(scene.rotation[:1], 8, axis=0))
    flight = project(rng, scene, Priors(), clock=0.05)
    velocity = 20.0 * np.array([[1.0, 0.5, 0.0]] * 4 + [[-1.0, -0.5, 0.0]] * 4)
    flight = replace(flight, path=replace(flight.path, velocity_m_s=velocity))
    one = solve_flight_read(flight).history()
    ((_, whole),) = one.estimates()
    turn_deg = np.degrees(whole.body_gain @ whole.responses.time[..., None])[..., 0] * 0.05
    by_turns = body_angles_by_turns(np.radians(one.mean().vehicle_deg[None]))[0]
    rms = np.sqrt(((turn_deg @ by_turns.T) ** 2).mean(axis=0))
    found, expected = one.mean().components["time"][3:], np.abs(by_turns @ turn_deg.mean(axis=0))
    assert (expected < 0.3 * rms).all()
    assert_close("mean of propagated turns", found / rms, expected / rms)


def errors_of_means(kind: str, flights: int) -> Floats:
    """The squared distances of means from the truth, by their covariances."""
    found = []
    for seed in range(flights):
        rng = np.random.default_rng(seed)
        scene = drone(rng, 15, 4, spacing_m=0.0 if kind == "place" else 1.0)
        priors = Priors(None, np.full((4, 3), 0.1), dict.fromkeys(("east", "north", "up"), 0.3))
        if kind == "track":
            priors = Priors(once_a_second(15, 5.0))
        flight = project(rng, scene, priors)
        one = solve_flight_read(flight).history()
        mean = one.mean()
        off = Rotation.from_matrix(MOUNT @ scene.rotation @ EN_TO_NED)
        estimated = Rotation.from_euler("ZYX", one.estimate.vehicle_deg, degrees=True).inv()
        turn = np.degrees((off * estimated.inv()).as_rotvec()).mean(axis=0)
        found.append(turn @ np.linalg.solve(mean.covariance_deg2, turn))
    return np.array(found)


EN_TO_NED = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


@pytest.mark.parametrize("kind", ["place", "track"])
def test_means_are_as_far_from_the_truth_as_their_covariance_says(kind: str) -> None:
    """By errors of all frames as their own it would be fifteen times, or three times, as far."""
    squares = errors_of_means(kind, 12)
    assert chi2.ppf(0.0005, 36) < squares.sum() < chi2.ppf(0.9995, 36)
