"""Three frames of four landmarks without noise, with something in every field of a flight."""

from __future__ import annotations

from datetime import UTC, datetime

import numpy as np

from tests.kit.flight_project import LENS, MARKS, camera_m, marks_m, pixels
from vopd.estimate import MapGrid
from vopd.flight.flight import CameraPath, Flight, FlightOptions, LandmarkSet, Picks
from vopd.geometry.rotations import FORWARD

FRAMES, MARK = 3, 4
TIME_S = 2.0 + np.arange(FRAMES) / 10.0
SIGMA_PX = np.tile([0.5, 1.0, 2.0, 4.0], FRAMES)
EPOCH = datetime(2026, 5, 1, tzinfo=UTC)
VELOCITY, WIND = np.array([20.0, 5.0, -2.0]), np.array([3.0, -1.0])
UNUSED = 3  # a check landmark


def three_frames() -> Flight:
    """At the truth of flight_project.py; the first has no position, the last mark is a check."""
    position = camera_m(TIME_S)
    position[0] = np.nan
    mark_sigma = np.full((MARK, 3), np.nan)
    mark_sigma[:2] = [[1.0, 2.0, 3.0], [7.0, 4.0, 1.0]]
    return Flight(
        name="F12",
        source="flight.toml",
        lens=LENS,
        frame=np.array([7, 9, 12]),
        image_name=("a.jpg", "b.jpg", "c.jpg"),
        time_s=TIME_S,
        epoch=EPOCH,
        picks=Picks(
            np.repeat(np.arange(FRAMES), MARK),
            np.tile(np.arange(MARK), FRAMES),
            pixels()[:FRAMES, :MARK].reshape(-1, 2),
            SIGMA_PX,
            repeatability_px=0.7,
            one_sigma_px=2.0,
            least_sigma_px=0.2,
        ),
        landmarks=LandmarkSet(
            MARKS[:MARK], marks_m()[:MARK], mark_sigma, (True, True, True, False)
        ),
        path=CameraPath(
            position,
            np.array([0.5, np.nan, 0.25]),
            sigma_time_s=0.01,
            velocity_m_s=np.tile(VELOCITY, (FRAMES, 1)),
            acceleration_m_s2=np.array([[9.0, 9.0, 9.0], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]),
            wind_m_s=np.tile(WIND, (FRAMES, 1)),
            gimbal_deg=np.arange(9.0).reshape(3, 3),
        ),
        mount=FORWARD,
        options=FlightOptions(focal_relative_sigma=0.002, principal_point_sigma_px=(1.5, 2.5)),
        grid=MapGrid("EPSG:32633", np.arange(3.0), np.arange(3.0) + 5, np.full(3, 0.3)),
    )  # fmt: skip
