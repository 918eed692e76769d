"""Films of known attitudes over WGS 84, by exact geometry; nothing of the program is used."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from vopd.job import Camera, Clock, Ignored, Job, Landmarks, Readings, Trajectory, Wind

FOOT_M = 1000.0 / 3280.8336
MM_PER_INCH = 0.713816400205
A_M, F = 6378137.0, 1 / 298.257223563  # WGS 84
FRAMES = 12


def ecef(lat_deg: float, lon_deg: float, h_m: float, a: float = A_M, f: float = F) -> np.ndarray:
    """Earth-centred metres by the parametric (reduced) latitude, not the program's formula."""
    lat, lon, b = np.radians(lat_deg), np.radians(lon_deg), a * (1 - f)
    beta = np.arctan2(b * np.sin(lat), a * np.cos(lat))
    p = a * np.cos(beta) + h_m * np.cos(lat)
    return np.array([p * np.cos(lon), p * np.sin(lon), b * np.sin(beta) + h_m * np.sin(lat)])


def geodetic(point: np.ndarray) -> np.ndarray:
    """Longitude, latitude (radians), height: Newton on the parametric latitude."""
    p, z, b = np.hypot(point[0], point[1]), point[2], A_M * (1 - F)
    beta = np.arctan2(z * A_M, p * b)
    for _ in range(20):
        g = p * A_M * np.sin(beta) - z * b * np.cos(beta)
        g -= (A_M**2 - b**2) * np.sin(beta) * np.cos(beta)
        slope = p * A_M * np.cos(beta) + z * b * np.sin(beta)
        slope -= (A_M**2 - b**2) * np.cos(2 * beta)
        beta -= g / slope
    lat = np.arctan2(A_M * np.sin(beta), b * np.cos(beta))
    return np.array([np.arctan2(point[1], point[0]), lat])


def enu(lon: float, lat: float) -> np.ndarray:
    """Rows east, north, up of a geodetic place, radians."""
    return Rotation.from_euler("ZX", [np.pi / 2 + lon, np.pi / 2 - lat]).as_matrix().T


def camera_matrix(yaw: float, pitch: float, roll: float) -> np.ndarray:
    """Appendix A's matrix from its meaning: the optical axis at azimuth `yaw` and elevation
    `pitch`; with no roll x points left of it, level, and y completes x, y, axis."""
    s, p, r = np.radians([yaw, pitch, roll])
    axis = np.array([np.sin(s) * np.cos(p), np.cos(s) * np.cos(p), np.sin(p)])
    x0 = np.array([-np.cos(s), np.sin(s), 0.0])
    y0 = np.cross(axis, x0)
    return np.array([np.cos(r) * x0 + np.sin(r) * y0, -np.sin(r) * x0 + np.cos(r) * y0, axis])


def film(
    lat_deg: float, lon_deg: float, decimals: int | None, scale: float = 1.0
) -> tuple[Job, np.ndarray]:
    """A film of a known attitude over a place on Earth, and the true camera angles (F, 3).

    It is taken from 118,000 ft times `scale` above the origin, of landmarks up to 7 km
    times `scale` away from it.
    """
    rng = np.random.default_rng(round(1000 + lat_deg))
    t = np.arange(FRAMES) * 1.0
    enu_ft = (
        np.stack([900.0 * t - 3000.0, 5000.0 - 700.0 * t, 118000.0 - 450.0 * t], axis=1) * scale
    )
    h0_ft = 1200.0
    origin = ecef(lat_deg, lon_deg, h0_ft * FOOT_M)
    path = origin + enu_ft * FOOT_M @ enu(*np.radians([lon_deg, lat_deg]))
    truth = np.stack([352.0 + 1.5 * t, -78.0 + 1.1 * t, 195.0 - 2.0 * t], axis=1)
    truth[:, 0] %= 360.0
    numbers = np.array([11, 22, 33, 44])
    around = np.array([[-0.05, -0.02], [0.04, 0.05], [0.02, -0.06], [-0.04, 0.06]])
    mark_deg = np.array([lat_deg, lon_deg]) + scale * around / [1.0, np.cos(np.radians(lat_deg))]
    digits = 6000.0 / scale  # hundredths of a minute, as cards hold
    mark_deg = np.round(mark_deg * digits) / digits
    heights_ft = h0_ft + scale * (np.array([4000.0, 1500.0, 6200.0, 0.0]) - h0_ft)
    marks = [ecef(*place, h * FOOT_M) for place, h in zip(mark_deg, heights_ft, strict=True)]
    points = np.zeros((FRAMES, 4, 2))
    focal = 10.4
    for k in range(FRAMES):
        toward_m = (np.array(marks) - path[k]) @ enu(*geodetic(path[k])).T
        x, y, z = camera_matrix(*truth[k]) @ toward_m.T
        points[k] = np.stack([focal * x / z, focal * y / z], axis=1)
    centre_in = np.array([7.0, 5.0])
    corners = centre_in + np.array([[-7, -5], [7, -5], [7, 5], [-7, 5]])
    readings = points / MM_PER_INCH + centre_in
    if decimals is not None:
        readings = np.round(readings, decimals)
    job = Job(
        title="1SYNTHETIC".ljust(80),
        camera=Camera(
            focal, np.arange(25.0), np.zeros(25), np.ones(3), np.zeros(3), truth[0] + 4.0
        ),
        trajectory=Trajectory(
            t, enu_ft, rng.normal(0.0, 500.0, (FRAMES, 3)).round(1), enu_ft[:, 2].copy(),
            lat_deg, lon_deg, 20925.698 + h0_ft / 1000.0,
        ),
        wind=Wind(np.array([0.0, 200000.0]), np.zeros((2, 2))),
        clock=Clock(np.array([1, FRAMES]), np.array([0.0, FRAMES - 1.0])),
        landmarks=Landmarks(
            numbers, np.zeros(4), np.round(mark_deg[:, 1] * 60, 8), np.zeros(4),
            np.round(mark_deg[:, 0] * 60, 8), heights_ft,
        ),
        ignored=Ignored(np.zeros(0, int), np.zeros((0, 6), int), np.zeros(4, int)),
        readings=Readings.of(
            frame=np.arange(FRAMES) + 1,
            fiducial_in=np.tile(corners[None, :, None], (FRAMES, 1, 3, 1)).astype(float),
            landmark=np.tile(numbers, (FRAMES, 1)),
            present=np.ones((FRAMES, 4), bool),
            landmark_in=np.repeat(readings[:, :, None], 3, axis=2),
        ),
        return_group=13,
    )  # fmt: skip
    return job, truth


def worst(found: np.ndarray, truth: np.ndarray) -> float:
    return float(np.abs((found - truth + 180.0) % 360.0 - 180.0).max())


PLACES = [(33.08, -106.33), (-33.9, 18.4), (67.9, 21.1), (0.05, 129.9), (-77.8, 166.7)]
