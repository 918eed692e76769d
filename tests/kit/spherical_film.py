"""Jobs made from known attitudes, by the program's Earth and Appendix A's camera, written anew.

The Earth is the program's sphere with its landmark series and its factors of
length; nothing of `vopd.program` is used.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from tests.kit import appendix_a
from vopd.job import (
    Camera,
    Clock,
    Ignored,
    Job,
    LandmarkReadings,
    Landmarks,
    Readings,
    Trajectory,
    Wind,
)
from vopd.landmark_layout import LandmarkLayout

MM_PER_INCH = 0.713816400205
LENS_MM = np.arange(25) * 0.5
LENS_UM = 4.0 * np.arange(25) + 0.3 * np.arange(25) ** 2  # no landmark stands beyond 12 mm
ORIGIN = {"latitude": 33.083333, "longitude": -106.3333, "kft": 20925.698}
CENTRE_IN = np.array([7.2, 5.2])


def geocentric(latitude: float, four_phi: float) -> float:
    """Degrees to degrees, by the series of the listing."""
    phi = latitude / appendix_a.RAD
    series = -0.1932398611111 * np.sin(2 * phi) + four_phi * np.sin(4 * phi)
    return float(latitude + series + 7.2222222222e-7 * np.sin(6 * phi))


def turn(longitude: float, latitude: float) -> np.ndarray:
    """Rows east, north, up in Earth-centred axes."""
    about_z = Rotation.from_euler("z", -(90.0 + longitude), degrees=True)
    return (Rotation.from_euler("x", -(90.0 - latitude), degrees=True) * about_z).as_matrix()


def place(longitude: float, latitude: float, km: float) -> np.ndarray:
    return km * turn(longitude, latitude)[2]


def cosines(
    position_ft: np.ndarray, marks: Landmarks, moved_ft: np.ndarray | float = 0.0
) -> np.ndarray:
    """East, north, up (L, 3) of the landmarks at the camera's own geocentric vertical.

    `moved_ft` moves every landmark east, north, up.
    """
    latitude = geocentric(ORIGIN["latitude"], 0.0003258611111111)
    here = place(ORIGIN["longitude"], latitude, ORIGIN["kft"] * 1000.0 / 3280.8336)
    here = here + position_ft * 0.0003048006 @ turn(ORIGIN["longitude"], latitude)
    longitude, up = np.degrees(
        [np.arctan2(here[1], here[0]), np.arcsin(here[2] / np.sqrt(here @ here))]
    )
    seen = []
    for k in range(len(marks.number)):
        east = marks.longitude_deg[k] + marks.longitude_min[k] / 60
        north = geocentric(marks.latitude_deg[k] + marks.latitude_min[k] / 60, 0.0000325861111111)
        there = place(east, north, marks.altitude_ft[k] / 3280.8336 + 6378.165)
        there = there + moved_ft * np.ones(3) / 3280.8336 @ turn(east, north)
        away = turn(longitude, up) @ (there - here)
        seen.append(away / np.linalg.norm(away))
    return np.array(seen)


def uncorrected(film: np.ndarray) -> np.ndarray:
    """Film coordinates that the lens correction takes to these: r + table(r)/1000 is inverted."""
    ideal = np.linalg.norm(film, axis=-1, keepdims=True)
    radius = ideal
    for _ in range(60):
        radius = ideal - np.interp(radius, LENS_MM, LENS_UM) / 1000.0
    return film * radius / ideal


def job(
    truth_deg: np.ndarray, start_deg: np.ndarray, multiplier: tuple[float, ...] = (1, 1, 1)
) -> Job:
    """A film of these attitudes (F, 3) 120,000 ft up, a frame a second; five landmarks below."""
    count = len(truth_deg)
    t = np.arange(count) * 1.0
    path = np.stack([400.0 * t, 700.0 - 300.0 * t, 120000.0 - 50.0 * t], axis=1)
    marks = Landmarks(
        number=np.array([11, 12, 13, 14, 15]),
        longitude_deg=np.full(5, -106.0),
        longitude_min=np.array([-12.0, -24.0, -18.0, -27.5, -20.25]),
        latitude_deg=np.full(5, 33.0),
        latitude_min=np.array([2.0, 1.0, 8.5, 9.75, -2.5]),
        altitude_ft=np.array([4000.0, 4300.0, 5200.0, 3900.0, 8000.0]),
    )
    film = np.array([
        appendix_a.project(np.asarray(angles) / appendix_a.RAD, cosines(path[k], marks), 10.4)
        for k, angles in enumerate(truth_deg)
    ])  # fmt: skip
    points = uncorrected(film) / MM_PER_INCH + CENTRE_IN
    corners = CENTRE_IN + np.array([[-7.0, -5.0], [7.0, -5.0], [7.0, 5.0], [-7.0, 5.0]])
    blur = np.array([-0.001, 0.0, 0.001])[:, None]  # three readings about the mean
    return Job(
        title="1 SYNTHETIC".ljust(80),
        camera=Camera(
            10.4, LENS_MM, LENS_UM, np.array(multiplier, float), np.zeros(3), np.asarray(start_deg)
        ),
        trajectory=Trajectory(
            t, path, np.tile([-100.0, 200.0, 50.0], (count, 1)), path[:, 2].copy(),
            ORIGIN["latitude"], ORIGIN["longitude"], ORIGIN["kft"],
        ),
        wind=Wind(np.array([0.0, 200000.0]), np.zeros((2, 2))),
        clock=Clock(np.array([1, max(count, 2)]), np.array([0.0, max(count, 2) - 1.0])),
        landmarks=marks,
        ignored=Ignored(np.zeros(0, int), np.zeros((0, 6), int), np.zeros(5, int)),
        readings=Readings.of(
            frame=np.arange(count) + 1,
            fiducial_in=np.tile(corners[:, None] + blur, (count, 1, 1, 1)),
            landmark=np.tile(marks.number, (count, 1)),
            present=np.ones((count, 5), bool),
            landmark_in=points[:, :, None] + blur,
        ),
        return_group=13,
    )  # fmt: skip


# Frames of unlike counts


TRUTH = np.array([140.0, -80.0, 60.0])


def uneven(count: list[int]) -> Job:
    """A film of frames with these numbers of landmarks, five of them read again and again.

    The angles differ a little from frame to frame, and every reading has an error.
    """
    rng = np.random.default_rng(len(count))
    even = job(TRUTH + rng.uniform(-1.0, 1.0, (len(count), 3)), TRUTH)
    old, layout = even.readings, LandmarkLayout(np.array(count))
    which = old.layout.start[layout.frame]
    which += (np.arange(layout.total) - layout.start[layout.frame]) % 5
    points = old.points.landmark_in[which]
    errors = np.round(rng.normal(0.0, 0.003, points.shape), 3)
    marks = LandmarkReadings(old.points.landmark[which], points + errors)
    readings = Readings(layout, marks, old.frame, old.fiducial_in)
    return replace(even, readings=readings)
