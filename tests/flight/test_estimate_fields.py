"""Every field of a flight's estimate, by the truth that the flight was made from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.flight_project import (
    EPOCH,
    LENS,
    MARKS,
    THREE_FRAMES,
    TIME_S,
    UNUSED,
    camera_m,
    local_to_camera,
    pixels,
    three_frames,
    truth_deg,
)
from tests.tolerances import assert_close
from vopd.estimate import Estimate
from vopd.flight.estimate import _largest_lean, flight_estimate, whole_flight
from vopd.flight.solve import SolvedFlight, solve
from vopd.geometry.earth import earth_centred_m
from vopd.geometry.lenses import project


@pytest.fixture(scope="module")
def solved() -> SolvedFlight:
    return solve(three_frames())


@pytest.fixture(scope="module")
def estimate(solved: SolvedFlight) -> Estimate:
    return flight_estimate(solved)


def test_what_the_estimate_is_of(estimate: Estimate) -> None:
    about = estimate.about
    assert (about.source, about.title, about.epoch) == ("flight.toml", "F12", EPOCH)
    assert about.words.surface != ""
    assert tuple(estimate.units) == ("m", "px", 1.0, "px", 1.0)
    assert estimate.frame.tolist() == [7, 9, 12]
    assert estimate.frame_names == ("a.jpg", "b.jpg", "c.jpg")
    assert estimate.time_s.tolist() == TIME_S.tolist()
    assert estimate.status.tolist() == [4, 0, 0]  # unsolved, solved, solved
    assert estimate.solved.tolist() == estimate.converged.tolist() == [True] * 3
    assert estimate.landmark_names == dict(zip(range(1, 5), MARKS, strict=False))
    assert estimate.grid is not None and estimate.grid.easting.tolist() == [0, 1, 2]
    assert estimate.gimbal_deg is not None and estimate.gimbal_deg[1].tolist() == [3, 4, 5]
    assert (estimate.reading_spread, estimate.reading_floor) == (0.7, 0.2)
    assert estimate.focal_length == 1495.0  # of 1500 and 1490


def test_a_frame_that_has_not_converged_is_not_said_to_have(solved: SolvedFlight) -> None:
    attitudes = solved.attitudes
    left = attitudes._replace(converged=np.array([False, True, False]))
    found = flight_estimate(replace(solved, attitudes=left))
    assert found.converged.tolist() == [True, True, False]  # the first has nothing to converge
    assert found.status.tolist() == [4, 0, 0]
    assert np.array_equal(found.correction_rad, attitudes.correction_rad, equal_nan=True)
    assert (np.abs(attitudes.correction_rad[1:]) > 0.0).any()


def test_which_picks_take_part(estimate: Estimate) -> None:
    assert estimate.landmark.tolist() == [[1, 2, 3, 4]] * 3
    assert estimate.used.tolist() == [[False] * 4, [True] * 3 + [False], [True] * 3 + [False]]
    assert estimate.ignored.tolist() == [[False] * 3 + [True]] * 3
    assert_close("ratio", estimate.relative_sigma, np.tile([0.25, 0.5, 1.0, 2.0], (3, 1)))
    for values in (estimate.direction, estimate.image):
        assert (values[0] == 0.0).all() and (values[:, UNUSED] == 0.0).all()
        assert (values[1:, :UNUSED] != 0.0).all()


def test_a_pick_without_weight_takes_no_part(solved: SolvedFlight) -> None:
    weight = solved.attitudes.weight.copy()
    weight[5] = 0.0
    found = flight_estimate(replace(solved, attitudes=solved.attitudes._replace(weight=weight)))
    assert found.used[1].tolist() == [True, False, True, False]
    assert not found.ignored[1, 1]


def test_angles_directions_and_images_are_the_truth(estimate: Estimate) -> None:
    truth = truth_deg()[1:THREE_FRAMES] % 360.0 - [0.0, 360.0, 0.0]
    assert_close("flight angle", estimate.camera_deg[1:], truth)
    assert_close("flight angle", estimate.vehicle_deg[1:], truth)
    for frame in (1, 2):
        ray = estimate.direction[frame, :UNUSED] @ local_to_camera(truth_deg()[frame]).T
        seen = project(LENS, ray).pixel
        assert_close("trial without noise", seen, pixels()[frame, :UNUSED])
        ideal = -1495.0 * ray[:, :2] / ray[:, 2:]
        assert_close("trial without noise", estimate.image[frame, :UNUSED], ideal)


def test_residuals_are_measured_less_computed_to_the_left_and_up(solved: SolvedFlight) -> None:
    """A pick 3 px to the right and 2 px down of its image, the attitude as it was."""
    pixel = solved.flight.picks.pixel.copy()
    pixel[[5, 7]] += [3.0, 2.0]
    one = replace(solved.flight, picks=replace(solved.flight.picks, pixel=pixel))
    found = flight_estimate(replace(solved, flight=one)).residual
    expected = np.zeros((3, 8))
    expected[1, [1, 5]] = [-3.0, -2.0]  # that of the check landmark takes no part
    assert_close("trial without noise", found, expected)


def test_positions_and_how_far_the_camera_went(estimate: Estimate) -> None:
    """From the first position that is known, 20 m/s north, 5 m/s east, 2 m/s up."""
    where, camera = estimate.position, camera_m(TIME_S)
    back = earth_centred_m(where.latitude_deg, where.longitude_deg, where.altitude)
    assert_close("flight position", back[1:], camera[1:])
    sine = camera[1:, 2] / np.linalg.norm(camera[1:], axis=1)
    assert_close("latitude, deg", where.geocentric_latitude_deg[1:], np.degrees(np.arcsin(sine)))
    lat, lon = np.radians(where.latitude_deg[2]), np.radians(where.longitude_deg[2])
    north = [-np.sin(lat) * np.cos(lon), -np.sin(lat) * np.sin(lon), np.cos(lat)]
    down = [-np.cos(lat) * np.cos(lon), -np.cos(lat) * np.sin(lon), -np.sin(lat)]
    assert_close("ratio", where.north_east_down[2], [north, [-np.sin(lon), np.cos(lon), 0], down])
    assert_close("flight position", estimate.displacement[1:], [[0, 0, 0], [0.5, 2.0, 0.2]])
    assert where.largest_lean_deg is not None
    lean = where.latitude_deg - where.geocentric_latitude_deg
    assert where.largest_lean_deg == np.nanmax(np.abs(lean)) > 0.19


def test_the_lean_is_the_largest_of_both_hemispheres() -> None:
    """tan of the geocentric latitude is (1 - f)2 tan of the geodetic one, on the ground."""
    ratio = (1 - 1 / 298.257223563) ** 2
    lean = 45.0 - np.degrees(np.arctan(ratio))
    somewhere = earth_centred_m([-45.0, np.nan, 10.0], [20.0, 30.0, 40.0], [0.0, 0.0, 0.0])
    assert_close("latitude, deg", _largest_lean(somewhere), lean)
    assert _largest_lean(np.full((2, 3), np.nan)) == 0.0 == _largest_lean(np.zeros((0, 3)))


def test_a_flight_without_any_position_has_no_origin(solved: SolvedFlight) -> None:
    lost = replace(solved, camera_m=np.full((3, 3), np.nan))
    assert np.isnan(whole_flight(lost).origin_m).all()


def test_without_velocity_or_acceleration(solved: SolvedFlight) -> None:
    path = solved.flight.path
    for without in (
        replace(path, velocity_m_s=None),
        replace(path, acceleration_m_s2=None, wind_m_s=None),
    ):
        found = flight_estimate(replace(solved, flight=replace(solved.flight, path=without)))
        if without.velocity_m_s is None:
            assert np.isnan(found.attack_deg).all() and np.isnan(found.airspeed).all()
        else:
            assert (found.responses.attack_by_time[1:] == 0.0).all()
            assert_close("ratio", found.airspeed[1:], np.full(2, np.sqrt(429.0)))


def test_stated_sigmas_are_root_mean_squares_and_zero_where_not_given(estimate: Estimate) -> None:
    """Four landmarks, two with standard deviations: 1, 2, 3 m and 7, 4, 1 m."""
    stated = estimate.stated
    assert_close("ratio", stated.landmark, np.sqrt([50 / 4, 20 / 4, 10 / 4]))
    assert stated.position == (0.5, 0.0, 0.25) and stated.time_s == 0.01
    assert_close("ratio", stated.focal_length, 0.002 * 1495.0)
    assert stated.principal_point == (1.5, 2.5)
