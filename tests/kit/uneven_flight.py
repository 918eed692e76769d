"""A flight whose frames have any number of picks, made from a known truth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.spatial.transform import Rotation

from tests.kit.flight_project import LENS, camera_m, marks_m
from vopd.flight.flight import CameraPath, Flight, LandmarkSet, Picks, Refraction
from vopd.flight.solve import sight_lines
from vopd.geometry.lenses import project
from vopd.geometry.rotations import FORWARD

NOISE_PX = 0.5
BODY_FROM_CAMERA = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
NED_FROM_ENU = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])


def uneven_flight(counts: Sequence[int], seed: int = 1) -> Flight:
    """A camera that swings over landmarks, each frame with the first so many of them."""
    rng = np.random.default_rng(seed)
    marks = rng.dirichlet(np.ones(len(marks_m())), max(counts)) @ marks_m()
    time_s = 2.0 + np.arange(len(counts)) / 1000.0
    frame = np.repeat(np.arange(len(counts)), counts)
    mark = np.concatenate([np.arange(count) for count in counts])
    swing = np.stack([5 + 4 * np.sin(time_s), -12 + np.cos(2 * time_s), time_s], axis=1)
    body = Rotation.from_euler("ZYX", swing, degrees=True).as_matrix()
    turn = BODY_FROM_CAMERA @ body.swapaxes(1, 2) @ NED_FROM_ENU
    camera = camera_m(time_s)
    lines = sight_lines(camera, marks, frame, mark, Refraction())
    seen = project(LENS, np.einsum("pij,pj->pi", turn[frame], lines.direction)).pixel
    return Flight(
        name="uneven",
        source="flight.toml",
        lens=LENS,
        frame=np.arange(len(counts)),
        image_name=tuple(f"{k}.jpg" for k in range(len(counts))),
        time_s=time_s,
        epoch=None,
        picks=Picks(frame, mark, seen + rng.normal(0.0, NOISE_PX, seen.shape), np.ones(len(frame))),
        landmarks=LandmarkSet(
            tuple(f"mark {k}" for k in range(len(marks))), marks, np.full((len(marks), 3), 0.3)
        ),
        path=CameraPath(
            camera,
            np.full(3, 0.1),
            velocity_m_s=np.tile([20.0, 5.0, -2.0], (len(counts), 1)),
            wind_m_s=rng.normal(0.0, 1.0, (len(counts), 2)),
            lever_arm_m=np.array([0.1, 0.2, 0.3]),
            gimbal_deg=swing,
        ),
        mount=FORWARD,
    )
