"""Flights for tests: a project in a folder, three frames by hand, a flight of unlike frames."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from vopd.arrays import Floats
from vopd.estimate import MapGrid
from vopd.findings import VopdError
from vopd.flight.flight import (
    CameraPath,
    Flight,
    FlightOptions,
    LandmarkSet,
    Picks,
    Refraction,
    TrackFixes,
)
from vopd.flight.formats.by_content import InputFormat, read_by_content
from vopd.flight.formats.files import InputFile
from vopd.flight.formats.lens import LENS_FORMATS, LensQuestion, LensRead
from vopd.flight.formats.track import TrackRows
from vopd.flight.project.keys import Section
from vopd.flight.solve.lines_of_sight import sight_lines
from vopd.geometry.earth import earth_centred_m, geodetic, local_axes
from vopd.geometry.lenses import Lens, LensKind, project
from vopd.geometry.rotations import FORWARD

SIZE = (1920, 1080)
K = np.array([-0.1, 0.02, 1e-3, -2e-3, 3e-3, 0, 0, 0, 0, 0, 0, 0])
LENS = Lens(
    LensKind.BROWN, SIZE, np.array([1500.0, 1490.0]), np.array([962.3, 534.8]), K
)  # fmt: skip
LATITUDE, LONGITUDE, HEIGHT = 47.6435, 16.4759, 460.0
MARKS = ("church", "mast", "bridge", "corner", "tower", "well")
EAST_NORTH_UP = np.array(
    [[-150, 420, 5], [60, 380, 30], [180, 500, -5], [-40, 300, 2], [20, 610, 60], [110, 330, 0]],
    dtype=np.float64,
)
FRAMES = 5
YAW, PITCH, ROLL = 5.0, -12.0, 2.0  # of the first frame; yaw grows by a degree a frame

TOML = """\
[flight]
name = "F12"
epoch = 2026-05-01T11:58:42Z
[camera]
image_size_px = [1920, 1080]
pixel_grid = "centre"
lens = { model = "brown", fx_px = 1500.0, fy_px = 1490.0, cx_px = 962.3, cy_px = 534.8, \
k = [-0.1, 0.02, 1e-3, -2e-3, 3e-3] }
[picks]
file = "picks.csv"
pixel_grid = "centre"
frame_rate_hz = 10.0
first_frame_t_s = 2.0
[landmarks]
file = "landmarks.csv"
height = "ellipsoid"
sigma_m = "exact"
[track]
file = "track.csv"
height = "ellipsoid"
sigma_m = "exact"
sigma_t_s = "exact"
"""


def truth_deg() -> Floats:
    """Yaw, pitch and roll of the camera in each frame, (F, 3)."""
    angles = np.tile([YAW, PITCH, ROLL], (FRAMES, 1))
    angles[:, 0] += np.arange(FRAMES)
    return angles


def camera_m(time_s: Floats) -> Floats:
    """The camera's position at these times: 20 m/s north, 5 m/s east, climbing at 2 m/s."""
    start = earth_centred_m(LATITUDE, LONGITUDE, HEIGHT + 80.0)
    way = np.outer(np.asarray(time_s) - 2.0, [5.0, 20.0, 2.0])
    return np.asarray(start + way @ local_axes(start))


def marks_m() -> Floats:
    """Where the landmarks are, Earth-centred."""
    origin = earth_centred_m(LATITUDE, LONGITUDE, HEIGHT)
    return np.asarray(origin + EAST_NORTH_UP @ local_axes(origin))


def pixels(noise_px: float = 0.0, seed: int = 1) -> Floats:
    """Where each landmark is seen in each frame, (F, N, 2)."""
    frames, marks = np.divmod(np.arange(FRAMES * len(MARKS)), len(MARKS))
    lines = sight_lines(camera_m(2.0 + np.arange(FRAMES) / 10.0), marks_m(), frames, marks,
                        Refraction())  # fmt: skip
    rotations = [local_to_camera(angles) for angles in truth_deg()]
    ray = np.einsum("pij,pj->pi", np.array(rotations)[frames], lines.direction)
    noise = np.random.default_rng(seed).normal(0.0, noise_px, (len(frames), 2))
    return (project(LENS, ray).pixel + noise).reshape(FRAMES, len(MARKS), 2)


def local_to_camera(angles_deg: Floats) -> Floats:
    """East, north, up to right, down, forward, by yaw, pitch, roll of the forward body."""
    body = Rotation.from_euler("ZYX", angles_deg, degrees=True).as_matrix()  # columns in NED
    ned_from_enu = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
    camera_from_body = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
    return np.asarray(camera_from_body @ body.T @ ned_from_enu)


def write_project(folder: Path, toml: str = TOML, noise_px: float = 0.0) -> Path:
    """Write flight.toml and its three tables; the path of flight.toml."""
    folder.mkdir(exist_ok=True)
    seen = pixels(noise_px)
    rows = [
        f"{frame},{name},{u:.9f},{v:.9f}"
        for frame in range(FRAMES)
        for name, (u, v) in zip(MARKS, seen[frame], strict=True)
    ]
    (folder / "picks.csv").write_text("\n".join(["frame,landmark,u_px,v_px", *rows, ""]))
    where = geodetic(marks_m())
    rows = [
        f"{name},{a:.12f},{b:.12f},{h:.6f}" for name, a, b, h in zip(MARKS, *where, strict=True)
    ]
    (folder / "landmarks.csv").write_text("\n".join(["landmark,lat_deg,lon_deg,h_m", *rows, ""]))
    time_s = np.array([1.0, 2.0, 3.0, 4.0])
    where = geodetic(camera_m(time_s))
    rows = [f"{t},{a:.12f},{b:.12f},{h:.6f}" for t, a, b, h in zip(time_s, *where, strict=True)]
    (folder / "track.csv").write_text("\n".join(["t_s,lat_deg,lon_deg,h_m", *rows, ""]))
    path = folder / "flight.toml"
    path.write_text(toml)
    return path


# Three frames by hand


THREE_FRAMES, MARK = 3, 4
TIME_S = 2.0 + np.arange(THREE_FRAMES) / 10.0
SIGMA_PX = np.tile([0.5, 1.0, 2.0, 4.0], THREE_FRAMES)
EPOCH = datetime(2026, 5, 1, tzinfo=UTC)
VELOCITY, WIND = np.array([20.0, 5.0, -2.0]), np.array([3.0, -1.0])
UNUSED = 3  # a check landmark


def three_frames() -> Flight:
    """At the truth of flight_project.py; the first has no position, the last mark is a check."""
    position = camera_m(TIME_S)
    position[0] = np.nan
    mark_sigma = np.zeros((MARK, 3))
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
            np.repeat(np.arange(THREE_FRAMES), MARK),
            np.tile(np.arange(MARK), THREE_FRAMES),
            pixels()[:THREE_FRAMES, :MARK].reshape(-1, 2),
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
            TrackFixes(
                np.arange(THREE_FRAMES),
                np.ones((THREE_FRAMES, 1)),
                np.tile([0.5, 0.0, 0.25], (THREE_FRAMES, 1)),
            ),
            velocity_m_s=np.tile(VELOCITY, (THREE_FRAMES, 1)),
            acceleration_m_s2=np.array([[9.0, 9.0, 9.0], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]),
            wind_m_s=np.tile(WIND, (THREE_FRAMES, 1)),
            gimbal_deg=np.arange(9.0).reshape(3, 3),
        ),
        mount=FORWARD,
        options=FlightOptions(
            parameter_sigma={
                "focal": 0.002 * LENS.focal_px.mean(),
                "centre_u": 1.5,
                "centre_v": 2.5,
                "clock": 0.01,
            }
        ),
        grid=MapGrid("EPSG:32633", np.arange(3.0), np.arange(3.0) + 5, np.full(3, 0.3)),
    )  # fmt: skip


# Frames of unlike counts


NOISE_PX = 0.5
BODY_FROM_CAMERA = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]])
NED_FROM_ENU = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1]])


def uneven_flight(counts: Sequence[int], seed: int = 1, noise_px: float = NOISE_PX) -> Flight:
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
        picks=Picks(frame, mark, seen + rng.normal(0.0, noise_px, seen.shape), np.ones(len(frame))),
        landmarks=LandmarkSet(
            tuple(f"mark {k}" for k in range(len(marks))), marks, np.full((len(marks), 3), 0.3)
        ),
        path=CameraPath(
            camera,
            TrackFixes(
                np.arange(len(counts)), np.ones((len(counts), 1)), np.full((len(counts), 3), 0.1)
            ),
            velocity_m_s=np.tile([20.0, 5.0, -2.0], (len(counts), 1)),
            wind_m_s=rng.normal(0.0, 1.0, (len(counts), 2)),
            lever_arm_m=np.array([0.1, 0.2, 0.3]),
            gimbal_deg=swing,
        ),
        mount=FORWARD,
    )


# Rows of a track


def track(clock: str | None, *time_s: float, image: tuple[str, ...] = (), **more: Any) -> TrackRows:
    position = np.zeros((len(time_s), 3))
    times = None if clock is None else np.array(time_s)
    return TrackRows(position, True, None, clock, times, "", [*image], **more)


def keys(**values: Any) -> Section:
    return Section("p.toml", "track", values)


# Texts read as files of a flight


def read_text(formats: Sequence[InputFormat[Any]], name: str, text: str, *more: Any) -> Any:
    """What a text says by the first of these formats that recognises it."""
    return read_by_content(formats, InputFile(name, Path("nowhere") / name, text), *more)


def text_told(formats: Sequence[InputFormat[Any]], name: str, text: str, *more: Any) -> str:
    """The message by which a text is refused."""
    with pytest.raises(VopdError) as refused:
        read_text(formats, name, text, *more)
    return str(refused.value)


def lens_of(text: str, **question: Any) -> LensRead:
    """The lens in a text, the file of which is called `lens`."""
    found: LensRead = read_text(LENS_FORMATS, "lens", text, LensQuestion(**question))
    return found


def no_lens(text: str, **question: Any) -> str:
    """The message by which the text of a lens is refused."""
    return text_told(LENS_FORMATS, "lens", text, LensQuestion(**question))


def long_track(folder: Path) -> None:
    """A track of a minute at both sides of the frames, by the times of the one of 4 s."""
    time_s = np.arange(-30.0, 31.0)
    where = geodetic(camera_m(time_s))
    rows = [f"{t},{a:.12f},{b:.12f},{h:.6f}" for t, a, b, h in zip(time_s, *where, strict=True)]
    (folder / "track.csv").write_text("\n".join(["t_s,lat_deg,lon_deg,h_m", *rows, ""]))
