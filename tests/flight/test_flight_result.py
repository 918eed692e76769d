"""What the library returns for a flight project."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import vopd
from tests.kit.flight_project import FRAMES, camera_m, truth_deg, write_project
from tests.tolerances import assert_close, within


def test_a_flight_is_solved_by_one_call(tmp_path: Path) -> None:
    flight = vopd.solve_flight(write_project(tmp_path))
    assert isinstance(flight, vopd.FlightResult)
    truth = truth_deg() % 360.0 - [0, 360, 0]
    assert_close("flight angle", flight.camera_deg, truth)
    assert_close("flight angle", flight.vehicle_deg, truth)
    assert flight.frame.tolist() == list(range(FRAMES)) and flight.image_name == ()
    assert flight.solved.all() and flight.findings == ()
    assert flight.about[0] == "lens: brown, 5 coefficients, centre grid"
    assert np.isfinite(flight.attack_deg).all()
    assert repr(flight).endswith("flight.toml, 5 frames)")


def test_its_table_has_the_columns_of_the_command(tmp_path: Path) -> None:
    flight = vopd.solve_flight(write_project(tmp_path, noise_px=0.3))
    table = flight.to_dataframe()
    assert len(table) == FRAMES
    assert np.abs(table["camera_yaw_deg"] - flight.camera_deg[:, 0]).max() < within("six decimals")
    assert (table["sigma_camera_yaw_deg"] > 0.0).all()
    assert table.attrs["project"].endswith("flight.toml")
    assert "jump" in " ".join(flight.to_dataframe(max_rate_deg_s=1.0)["flags"])


def test_its_angles_against_the_vertical_that_is_asked_for(tmp_path: Path) -> None:
    """Pitch is the elevation of the forward axis above the plane across the Earth's radius."""
    flight = vopd.solve_flight(write_project(tmp_path))
    up = camera_m(flight.time_s)
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    position = flight.estimate.position
    yaw, pitch, _ = np.radians(flight.vehicle_deg.T)
    forward = np.stack([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), -np.sin(pitch)])
    earth_fixed = np.einsum("kf,fki->fi", forward, position.north_east_down)
    expected = np.degrees(np.arcsin((earth_fixed * up).sum(axis=1)))
    turned = flight.history(vertical="geocentric").estimate.vehicle_deg[:, 1]
    assert_close("flight angle", turned, expected)
    assert np.abs(turned - flight.vehicle_deg[:, 1]).min() > within("flight angle")
    table = flight.to_dataframe(vertical="geocentric")
    assert np.abs(table["vehicle_pitch_deg"] - expected).max() < within("six decimals")


def test_a_frame_with_one_landmark_is_not_solved(tmp_path: Path) -> None:
    path = write_project(tmp_path)
    rows = (tmp_path / "picks.csv").read_text().splitlines()
    (tmp_path / "picks.csv").write_text("\n".join([*rows[:26]]))
    flight = vopd.solve_flight(path)
    assert flight.solved.tolist() == [True, True, True, True, False]
    assert np.isnan(flight.camera_deg[4]).all()
    assert "frame 4: fewer than two landmarks" in str(flight.findings[0])
