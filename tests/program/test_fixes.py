"""The errata: each fix moves the answer as its entry says, and all of them give the truth back.

The synthetic jobs are made here by exact WGS 84 geometry, without the program.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import vopd
from tests.tolerances import TOLERANCES
from vopd.errata import NO_FIXES, VOPD_ERRATA, fixes
from vopd.geometry.ellipsoid import ELLIPSOIDS
from vopd.job import Camera, Clock, Ignored, Job, Landmarks, Readings, Trajectory, Wind

DECKS = Path(__file__).parents[2] / "decks" / "appendix_h"
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


def synthetic(lat_deg: float, lon_deg: float, decimals: int | None) -> tuple[Job, np.ndarray]:
    """A film of a known attitude over a place on Earth, and the true camera angles (F, 3)."""
    rng = np.random.default_rng(round(1000 + lat_deg))
    t = np.arange(FRAMES) * 1.0
    enu_ft = np.stack([900.0 * t - 3000.0, 5000.0 - 700.0 * t, 118000.0 - 450.0 * t], axis=1)
    h0_ft = 1200.0
    origin = ecef(lat_deg, lon_deg, h0_ft * FOOT_M)
    path = origin + enu_ft * FOOT_M @ enu(*np.radians([lon_deg, lat_deg]))
    truth = np.stack([352.0 + 1.5 * t, -78.0 + 1.1 * t, 195.0 - 2.0 * t], axis=1)
    truth[:, 0] %= 360.0
    numbers = np.array([11, 22, 33, 44])
    around = np.array([[-0.05, -0.02], [0.04, 0.05], [0.02, -0.06], [-0.04, 0.06]])
    mark_deg = np.array([lat_deg, lon_deg]) + around / [1.0, np.cos(np.radians(lat_deg))]
    mark_deg = np.round(mark_deg * 6000.0) / 6000.0  # hundredths of a minute, as cards hold
    heights_ft = np.array([4000.0, 1500.0, 6200.0, 0.0])
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
            numbers, np.zeros(4), np.round(mark_deg[:, 1] * 60, 2), np.zeros(4),
            np.round(mark_deg[:, 0] * 60, 2), heights_ft,
        ),
        ignored=Ignored(np.zeros(0, int), np.zeros((0, 6), int), np.zeros(4, int)),
        readings=Readings(
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


@pytest.mark.parametrize("place", PLACES)
def test_all_fixes_give_the_true_attitude_back(place: tuple[float, float]) -> None:
    job, truth = synthetic(*place, decimals=None)
    found = vopd.run(job, fixes("all"))
    assert worst(found.camera_deg, truth) < TOLERANCES["attitude, noise-free arrays"].absolute
    assert found.converged.all()


@pytest.mark.parametrize("place", PLACES)
def test_all_fixes_through_a_deck(place: tuple[float, float], tmp_path: Path) -> None:
    job, truth = synthetic(*place, decimals=4)  # -1.2345 and 12.3456 fill seven columns
    deck = tmp_path / "synthetic.dat"
    deck.write_text(vopd.write_deck([job]))
    (read,) = vopd.read_deck(deck)
    found = vopd.run(read, fixes("all"))
    assert worst(found.camera_deg, truth) < TOLERANCES["attitude, noise-free deck"].absolute
    if abs(place[0]) > 30:  # at the equator the sphere's vertical is the ellipsoid's
        assert worst(vopd.run(read).camera_deg, truth) > 0.003


def test_the_ellipsoid_is_the_one_asked_for() -> None:
    """On another ellipsoid the same job has other radii, those of its own formula."""
    job, _ = synthetic(-33.9, 18.4, decimals=None)
    for name, (_, a_km, f) in ELLIPSOIDS.items():
        results = vopd.run(job, fixes("earth", ellipsoid=name))
        marks = job.landmarks
        for k in range(4):
            lat, lon = marks.latitude_min[k] / 60, marks.longitude_min[k] / 60
            there = ecef(lat, lon, marks.altitude_ft[k] * FOOT_M, a_km * 1000.0, f)
            radius_km = np.linalg.norm(there) / 1000.0
            assert abs(results.radius_km[0, k] - radius_km) < TOLERANCES["radius, km"].absolute
            geocentric = np.degrees(np.arctan2(there[2], np.hypot(there[0], there[1])))
            off = results.geocentric_latitude_deg[0, k] - geocentric
            assert abs(off) < TOLERANCES["latitude, deg"].absolute


def case(number: int) -> Job:
    (job,) = vopd.read_deck(DECKS / f"case{number}.dat")
    return job


def test_each_fix_alone_and_in_its_direction() -> None:
    """What each entry of the errata says, on the printed cases."""
    plain = {k: vopd.run(case(k)) for k in (1, 4)}

    def fixed(k: int, name: str) -> vopd.Results:
        return vopd.run(case(k), fixes(name))

    # Appendix A's series by hand for 32.83833 degrees: 32.66249, where the listing prints 32.66227
    latitude = fixed(1, "latitude-series").geocentric_latitude_deg[0, 0]
    assert f"{latitude:.5f}" == "32.66249"
    assert f"{plain[1].geocentric_latitude_deg[0, 0]:.5f}" == "32.66227"
    # scipy's least squares on the collinearity equations of frame 60 ends at 225.1196489
    assert f"{plain[4].camera_deg[1, 0]:.3f}" == "225.133"
    assert f"{fixed(4, 'first-landmark').camera_deg[1, 0]:.3f}" == "225.120"
    # frame 65 starts where frame 60 ended, as the report's text has it, and not at group 8
    assert plain[4].start_deg[2].tolist() == [225.0, -86.0, 182.0]
    near = np.abs(fixed(4, "restart").start_deg[2] - plain[4].camera_deg[1])
    assert near.max() < 1e-6
    # - 2 * 7.2222E-7 sin 6PHI, PHI 32.83833: sin 197.03 deg = -.2929, so + 4.2E-7 degrees
    shift = fixed(1, "sin-6phi").geocentric_latitude_deg - plain[1].geocentric_latitude_deg
    assert abs(shift[0, 0] - 4.23e-7) < 2e-9
    # averages 10.178, 10.174, 10.174: 10.175333..., which unit 9 cuts at eight digits
    assert plain[1].point_in[0, 0, 0] == 10.175333
    assert abs(fixed(1, "eight-digits").point_in[0, 0, 0] - 30.526 / 3) < 1e-14
    # three landmarks: root of 6/(6 - 3) times as much
    ratio = fixed(1, "standard-deviation").residual_deviation_mm / plain[1].residual_deviation_mm
    assert abs(ratio[0] - np.sqrt(2.0)) < 1e-12
    # 1/3280.8336 is 5E-8 less than .0003048006: the camera is 2 mm nearer to the origin
    moved = fixed(1, "feet-per-km").direction - plain[1].direction
    assert 1e-9 < np.abs(moved).max() < 1e-7
    assert worst(fixed(1, "earth").camera_deg, plain[1].camera_deg) > 0.01


def test_nothing_moves_without_a_fix() -> None:
    assert vopd.run(case(4)) == vopd.run(case(4), NO_FIXES)
    assert not NO_FIXES


def test_two_landmarks_leave_one_degree_of_freedom() -> None:
    job, _ = synthetic(33.08, -106.33, decimals=3)
    two = replace(job, ignored=replace(job.ignored, everywhere=np.array([11, 22, 0, 0])))
    one, other = vopd.run(two), vopd.run(two, fixes("standard-deviation"))
    assert np.abs(other.residual_deviation_mm / one.residual_deviation_mm - 2.0).max() < 1e-12


@pytest.mark.parametrize("name", [erratum.name for erratum in VOPD_ERRATA])
def test_a_corrected_run_cannot_be_mistaken(name: str) -> None:
    text = vopd.listing_text(vopd.run(case(4), fixes(name)))
    pages = text.split("\n1")
    assert len(pages) == 4  # the ignored frame's line, two frames, the last title
    assert all(f"CORRECTED RUN, NOT THE ORIGINAL: {name}" in page for page in pages[1:])


def test_unknown_names_are_refused() -> None:
    with pytest.raises(vopd.VopdError, match="no fix is called 'earht'"):
        fixes("earht")
    with pytest.raises(vopd.VopdError, match="no ellipsoid is called 'mars'"):
        fixes("earth", ellipsoid="mars")
