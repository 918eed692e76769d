"""Render the video of a flight, with clicks, track, landmarks, and the truth of every frame.

    python -m tools.render_video FOLDER [--seed 7] [--size 480x270 --frames 40] [--clicks 6] ...

A vehicle climbs from 1.8 to 4.5 km in 10 s and spins about the axis of its aft camera, which looks
back to the ground: coning, shake, motion blur, noise, a drifting exposure, H.264. Nothing of the
package takes part: projection, lens, Earth and rotations are written here again with numpy, and
PyAV compresses the frames. FOLDER becomes a project that `vopd attitude`, `vopd pick` and
`vopd track` read as it is, and has the truth beside it:

    flight.toml       lens, video, presentation times; places and track are exact unless --track-m
    video.mp4         grey, 30 frames a second
    landmarks.csv     latitude, longitude, ellipsoidal height; `patch_px` where --mast-m is given
    track.csv         a fix a frame (two beyond each end), seconds on the clock of the frames
    clicks.csv        as `vopd pick` writes it: --clicks of them, with --click-px of error
    terrain.tif       with --hills-m: GeoTIFF, float32, EPSG:4326, heights above the ellipsoid
    truth.csv         frame, time_s, camera_yaw_deg .. quaternion_z, latitude_deg ..: the columns of
                      `vopd attitude`, at the frame's time (the first row's, with --readout-ms)
    truth_picks.csv   true pixels of every landmark in the picture, and `hidden` (1: by the plume);
                      a file of picks itself: `[picks] file = "truth_picks.csv"`

The ground is a plane that touches the ellipsoid at ORIGIN, or hills above it. Its texture (parcels,
tracks, roads, roofs, noise of all sizes) repeats after some 5.7 km. Landmarks are the middles of
bow ties and the corners of bright roofs. Light goes straight: `refraction = "off"`.

Frames count as they stand in the video. Each of --cuts takes 1.5 s of the flight away; presentation
times go on with the flight's clock, so that times stay true and the picture jumps.

A 1920 x 1080 frame takes about .4 s of one core, and 550 MB in all.
"""

from __future__ import annotations

import argparse
import struct
from dataclasses import dataclass, field
from datetime import UTC, datetime
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import numpy as np

Floats = np.ndarray[Any, np.dtype[np.floating[Any]]]

ORIGIN = 46.9, 9.3, 620.0  # latitude, longitude, ellipsoidal height of the ground
EPOCH = datetime(2026, 5, 1, 9, 30, tzinfo=UTC)
FOCAL_PX, K1, K2 = 1300.0, -0.08, 0.012  # of 1920 pixels
FULL = 1920
ALTITUDE_M, CLIMB_M_S = 1800.0, 270.0
TILT_DEG, CONING_DEG, CONING_HZ = 10.0, 2.0, 0.4
SPIN_DEG_S, SPIN_VARIES_DEG_S = 16.0, 4.0  # 160 degrees in 10 s, 20 deg/s at most
SHAKE_DEG, SHAKE_HZ = 0.1, (4.0, 13.0)
STABILISED_HZ = 0.5, 4.0  # of shifts by stabilisation
EXPOSURE_S, SAMPLES = 0.004, 4  # of each pixel, spread over its square and over the exposure
NOISE = 2.0  # grey levels
PERIOD_M = 5500.0  # of the texture, at least
APART_M, EDGE_PX = 260.0, 25.0  # of landmarks at 1.8 km
MARK_M, MAST_TOP_M = 26.0, 14.0  # their size; on the ground larger in smaller pictures
CUT_S = 1.5
TICKS = 90_000  # of presentation times a second


@dataclass(frozen=True)
class Settings:
    """A video to render; see `python -m tools.render_video --help`."""

    seed: int = 7
    size: tuple[int, int] = (1920, 1080)
    frames: int = 300
    rate_hz: float = 30.0
    mbit_s: float | None = None  # 8 for 1920 x 1080 at 30 Hz, as many bits a pixel for others
    landmarks: int = 6
    clicks: int = 27
    click_px: float = 0.5
    plume: bool = False
    mast_m: float = 0.0
    hills_m: float = 0.0
    cuts: int = 0
    readout_ms: float = 0.0
    say_readout: bool = True
    track_m: float = 0.0
    stabilised_px: float = 0.0
    codec: str = "libx264"
    key_frames: int = 30  # frames from one to the next


# The Earth, and the camera's movement


def earth_centred_m(latitude_deg: Any, longitude_deg: Any, height_m: Any) -> Floats:
    """Convert geodetic coordinates on WGS 84 to Earth-centred ones, (..., 3)."""
    p, t, h = np.radians(latitude_deg), np.radians(longitude_deg), np.asarray(height_m)
    e2 = (2.0 - 1.0 / 298.257223563) / 298.257223563
    n = 6378137.0 / np.sqrt(1.0 - e2 * np.sin(p) ** 2)
    across = (n + h) * np.cos(p)
    xyz = [across * np.cos(t), across * np.sin(t), (n * (1.0 - e2) + h) * np.sin(p)]
    return np.stack(np.broadcast_arrays(*xyz), axis=-1)


def geodetic(place_m: Floats) -> Floats:
    """Convert Earth-centred places to latitude, longitude, degrees, and height, (..., 3)."""
    e2 = (2.0 - 1.0 / 298.257223563) / 298.257223563
    x, y, z = np.moveaxis(place_m, -1, 0)
    across = np.hypot(x, y)
    p = np.arctan2(z, across * (1.0 - e2))
    for _ in range(6):
        n = 6378137.0 / np.sqrt(1.0 - e2 * np.sin(p) ** 2)
        p = np.arctan2(z + e2 * n * np.sin(p), across)
    n = 6378137.0 / np.sqrt(1.0 - e2 * np.sin(p) ** 2)
    h = across * np.cos(p) + z * np.sin(p) - 6378137.0**2 / n
    return np.stack([np.degrees(p), np.degrees(np.arctan2(y, x)), h], axis=-1)


def axes(latitude_deg: Any, longitude_deg: Any) -> Floats:
    """East, north, up in Earth-centred axes, (..., 3, 3): rows are the vectors."""
    p, t = np.radians(latitude_deg), np.radians(longitude_deg)
    zero = np.zeros_like(p)
    east = [-np.sin(t), np.cos(t), zero]
    north = [-np.sin(p) * np.cos(t), -np.sin(p) * np.sin(t), np.cos(p)]
    up = [np.cos(p) * np.cos(t), np.cos(p) * np.sin(t), np.sin(p)]
    return np.stack([np.stack(one, axis=-1) for one in (east, north, up)], axis=-2)


def from_local(local_m: Floats) -> Floats:
    """Latitude, longitude, degrees, and height of places east, north, up of ORIGIN, (..., 3)."""
    return geodetic(earth_centred_m(*ORIGIN) + local_m @ axes(*ORIGIN[:2]))


def turns(vector: Floats) -> Floats:
    """Rotation matrices of rotation vectors, radians, (..., 3) to (..., 3, 3)."""
    angle = np.linalg.norm(vector, axis=-1)[..., None, None]
    x, y, z = np.moveaxis(vector, -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    cross = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    sine, versine = np.sinc(angle / np.pi), 0.5 * np.sinc(angle / 2.0 / np.pi) ** 2
    return np.asarray(np.eye(3) + sine * cross + versine * cross @ cross)


@dataclass(frozen=True)
class Motion:
    """Where the camera is and how it is turned, east, north, up of ORIGIN.

    Attributes:
        azimuth: of the tilt from straight down, radians
        shake: frequency, Hz, and phase, of sinusoids about three axes, (3, S, 2)
    """

    azimuth: float
    phase: float
    shake: Floats

    def place_m(self, time_s: Floats) -> Floats:
        """The camera, (..., 3)."""
        t = np.asarray(time_s, float)
        way = CLIMB_M_S * np.tan(np.radians(TILT_DEG)) * (t - 2.0) + 1.2 * t**2
        east, north = way * np.sin(self.azimuth), way * np.cos(self.azimuth)
        return np.stack([east, north, ALTITUDE_M + CLIMB_M_S * t], axis=-1)

    def turn(self, time_s: Floats) -> Floats:
        """From camera axes (right, down, forward) to east, north, up, (..., 3, 3)."""
        t = np.asarray(time_s, float)
        down = np.array([[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
        lean = np.radians(TILT_DEG) * np.array([np.cos(self.azimuth), -np.sin(self.azimuth), 0.0])
        wave = 2.0 * np.pi / 10.0 * 2.0
        spin = SPIN_DEG_S * t + SPIN_VARIES_DEG_S / wave * (1.0 - np.cos(wave * t))
        zero = np.zeros_like(t)
        cone = 2.0 * np.pi * CONING_HZ * t + self.phase
        coning = np.radians(CONING_DEG) * np.stack([np.cos(cone), np.sin(cone), zero], axis=-1)
        frequency, phase = self.shake[..., 0], self.shake[..., 1]
        waves = np.sin(2.0 * np.pi * frequency * t[..., None, None] + phase).sum(axis=-1)
        shake = np.radians(SHAKE_DEG) * np.sqrt(2.0 / frequency.shape[1]) * waves
        about = np.stack([zero, zero, np.radians(spin)], axis=-1)
        return np.asarray(turns(lean) @ down @ turns(coning) @ turns(about) @ turns(shake))


def new_motion(rng: np.random.Generator) -> Motion:
    """Draw a flight's movement."""
    shake = np.stack([rng.uniform(*SHAKE_HZ, (3, 9)), rng.uniform(0, 2 * np.pi, (3, 9))], axis=-1)
    return Motion(rng.uniform(0, 2 * np.pi), rng.uniform(0, 2 * np.pi), shake)


def new_shifts_px(settings: Settings, time_s: Floats) -> Floats:
    """Draw shifts of the whole picture as a stabilisation has them, frame by frame, (F, 2)."""
    rng = np.random.default_rng([settings.seed, 1])
    frequency, phase = rng.uniform(*STABILISED_HZ, (2, 9)), rng.uniform(0.0, 2.0 * np.pi, (2, 9))
    waves = np.sin(2.0 * np.pi * frequency * time_s[:, None, None] + phase).sum(axis=-1)
    return np.asarray(settings.stabilised_px * np.sqrt(1.0 / 9.0) * waves)


# The lens


@dataclass(frozen=True)
class Camera:
    """Brown's lens with two radial coefficients, pixels from the centre of the first."""

    size: tuple[int, int]
    focal_px: float
    centre_px: tuple[float, float]

    def pixel(self, ray: Floats) -> Floats:
        """Project rays in camera axes, (..., 3) to (..., 2); NaN behind the camera."""
        x, y = ray[..., 0] / ray[..., 2], ray[..., 1] / ray[..., 2]
        r2 = x * x + y * y
        grown = self.focal_px * (1.0 + K1 * r2 + K2 * r2 * r2)
        both = np.stack([grown * x + self.centre_px[0], grown * y + self.centre_px[1]], axis=-1)
        return np.where(ray[..., 2:] > 0.0, both, np.nan)

    def slopes(self, du: float, dv: float) -> tuple[Floats, Floats]:
        """Undistorted x and y of all pixels, moved by a part of a pixel, (V, U) each."""
        u = (np.arange(self.size[0]) + du - self.centre_px[0]) / self.focal_px
        v = (np.arange(self.size[1]) + dv - self.centre_px[1]) / self.focal_px
        far = np.sqrt(u[None, :] ** 2 + v[:, None] ** 2)
        # the inverse along the radius, from a dense table by Newton's method
        table = np.linspace(0.0, far.max(), 4000)
        r = table.copy()
        for _ in range(20):
            r -= (r + K1 * r**3 + K2 * r**5 - table) / (1.0 + 3.0 * K1 * r**2 + 5.0 * K2 * r**4)
        ratio = np.interp(far, table[1:], r[1:] / table[1:])
        return (ratio * u[None, :]).astype(np.float32), (ratio * v[:, None]).astype(np.float32)

    def sees(self, pixel: Floats, edge_px: float = 0.0) -> Any:
        """Which pixels are in the picture, (...)."""
        width, height = self.size
        u, v = pixel[..., 0], pixel[..., 1]
        inside = (u >= edge_px) & (u <= width - 1.0 - edge_px)
        return inside & (v >= edge_px) & (v <= height - 1.0 - edge_px)


def new_camera(size: tuple[int, int]) -> Camera:
    """The camera of 1920 x 1080, or the same picture in another size."""
    scale = size[0] / FULL
    centre = (size[0] - 1.0) / 2.0 + 3.3 * scale, (size[1] - 1.0) / 2.0 - 2.1 * scale
    return Camera(size, FOCAL_PX * scale, centre)


# The ground


@dataclass(frozen=True)
class Ground:
    """The ground and the landmarks on it.

    Attributes:
        texel_m: size of a texel
        packed: grey levels of a texel, its right, lower and lower right neighbour, (N, N) uint32
        axis: of the texture against east
        hills: east and north wave number, rad/m, phase, amplitude, (W, 4)
        mark: east, north and height of the landmarks above the plane, (L, 3)
        foot: height of the ground beneath, (L,)
    """

    texel_m: float
    packed: Any
    axis: float
    hills: Floats
    mark: Floats
    foot: Floats

    def height_m(self, east: Floats, north: Floats) -> Floats:
        """Height above the plane, (...)."""
        return hills_m(self.hills, east, north)

    def texture(self, east: Floats, north: Floats) -> Floats:
        """Grey levels of places, bilinear, (...)."""
        n = len(self.packed)
        c, s = (np.float32(f / self.texel_m) for f in (np.cos(self.axis), np.sin(self.axis)))
        i, j = c * east + s * north - np.float32(0.5), c * north - s * east - np.float32(0.5)
        i0, j0 = np.floor(i), np.floor(j)
        i, j = i - i0, j - j0
        at = (j0.astype(np.int32) & (n - 1)) * n + (i0.astype(np.int32) & (n - 1))
        four = self.packed.ravel()[at]
        parts = [(four >> np.uint32(k)) & np.uint32(255) for k in (0, 8, 16, 24)]
        grey = [part.astype(np.float32) for part in parts]
        upper, lower = grey[0] + i * (grey[1] - grey[0]), grey[2] + i * (grey[3] - grey[2])
        return np.asarray(upper + j * (lower - upper))


def hills_m(hills: Floats, east: Floats, north: Floats) -> Floats:
    """Sum waves, (...)."""
    out = np.zeros(np.broadcast(east, north).shape)
    for ke, kn, phase, amplitude in hills:
        out += amplitude * np.sin(ke * east + kn * north + phase)
    return out


def texture(rng: np.random.Generator, texel_m: float) -> Any:
    """Draw fields, roads, roofs and noise of all sizes, grey levels (N, N) uint8, periodic."""
    n = 2 ** int(np.ceil(np.log2(PERIOD_M / texel_m)))
    noise = rng.normal(0.0, 1.0, (4, 4)).astype(np.float32)
    while len(noise) < n:
        for axis in (0, 1):
            before, after = np.roll(noise, 1, axis), np.roll(noise, -1, axis)
            pair = np.stack([0.75 * noise + 0.25 * before, 0.75 * noise + 0.25 * after], axis + 1)
            shape = list(noise.shape)
            shape[axis] *= 2
            noise = pair.reshape(shape)
        size = n // len(noise)
        strength = 11.0 if size > 16 else 8.0
        noise = noise + strength * rng.standard_normal(noise.shape, dtype=np.float32)
    out = 118.0 + noise

    def wide(metres: float) -> int:
        return max(1, round(metres / texel_m))

    def split(j0: int, j1: int, i0: int, i1: int, depth: int) -> None:
        tall, broad = j1 - j0, i1 - i0
        if max(tall, broad) * texel_m < rng.uniform(70.0, 330.0) or max(tall, broad) < 6:
            field = out[j0:j1, i0:i1]
            field += rng.normal(0.0, 26.0)
            if rng.random() < 0.4:  # furrows
                every = wide(rng.uniform(7.0, 16.0))
                rows = np.arange(tall if rng.random() < 0.5 else broad) // every % 2 * 14.0
                field += rows[:, None] if len(rows) == tall else rows[None, :]
            return
        cut = rng.uniform(0.3, 0.7)
        line, grey = wide(10.0 if depth < 5 else 3.0), 190.0 if depth < 5 else rng.choice([50, 175])
        if tall > broad:
            at = j0 + int(cut * tall)
            split(j0, at, i0, i1, depth + 1)
            split(at, j1, i0, i1, depth + 1)
            out[at : at + line, i0:i1] = grey + 0.3 * noise[at : at + line, i0:i1]
        else:
            at = i0 + int(cut * broad)
            split(j0, j1, i0, at, depth + 1)
            split(j0, j1, at, i1, depth + 1)
            out[j0:j1, at : at + line] = grey + 0.3 * noise[j0:j1, at : at + line]

    split(0, n, 0, n, 0)
    for _ in range(9000):  # roofs and trees
        j, i = rng.integers(0, n, 2)
        tall, broad = wide(rng.uniform(4.0, 18.0)), wide(rng.uniform(4.0, 18.0))
        out[j : j + tall, i : i + broad] = rng.choice([45.0, 60.0, 80.0, 165.0, 205.0])
    return np.clip(out, 12, 243).round().astype(np.uint8)


def packed(grey: Any) -> Any:
    """Put the four neighbours of a bilinear sample into one number."""
    one = grey.astype(np.uint32)
    right = np.roll(one, -1, 1)
    return one | right << 8 | np.roll(one, -1, 0) << 16 | np.roll(right, -1, 0) << 24


def new_hills(rng: np.random.Generator, hills_of_m: float) -> Floats:
    """Draw hills whose lowest and highest point are so far apart, (W, 4); none for 0."""
    if hills_of_m <= 0.0:
        return np.empty((0, 4))
    length, way = rng.uniform(1500.0, 3500.0, 5), rng.uniform(0.0, 2.0 * np.pi, 5)
    phase, amplitude = rng.uniform(0.0, 2.0 * np.pi, 5), rng.uniform(0.6, 1.0, 5)
    k = 2.0 * np.pi / length
    hills = np.stack([k * np.cos(way), k * np.sin(way), phase, amplitude], axis=1)
    east, north = np.meshgrid(np.arange(-4000.0, 4000.0, 50.0), np.arange(-4000.0, 4000.0, 50.0))
    found = hills_m(hills, east, north)
    hills[:, 3] *= hills_of_m / (found.max() - found.min())
    return hills


def new_marks(
    rng: np.random.Generator, settings: Settings, camera: Camera, motion: Motion, hills: Floats,
    time_s: Floats,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Choose landmarks that all stand in the first frame, and in 60 % of all.

    Returns:
        East, north and height, (L, 3), and the ground's height beneath, (L,).
    """
    middle = motion.place_m(time_s[0])[:2]
    drawn = middle + rng.uniform(-1700.0, 1700.0, (6000, 2))
    foot = hills_m(hills, drawn[:, 0], drawn[:, 1])
    mark = np.column_stack([drawn, foot + settings.mast_m])
    seen = camera.sees(pixels(camera, motion, mark, time_s[::3]), EDGE_PX * camera.size[0] / FULL)
    good, chosen = seen[0] & (seen.mean(axis=0) >= 0.6), list[int]()
    for k in np.flatnonzero(good):
        if all(np.hypot(*(drawn[k] - drawn[other])) > APART_M for other in chosen):
            chosen.append(int(k))
        if len(chosen) == settings.landmarks:
            return mark[chosen], foot[chosen]
    raise SystemExit(f"only {len(chosen)} landmarks have a place: take fewer, or another seed")


def pixels(
    camera: Camera, motion: Motion, mark: Floats, time_s: Floats, readout_s: float = 0.0
) -> Floats:
    """Project landmarks at frames' times, each at its own row's, (F, L, 2)."""
    late: Any = np.zeros((len(time_s), len(mark)))
    for _ in range(8 if readout_s else 1):
        when = time_s[:, None] + late
        ray = np.einsum("flij,fli->flj", motion.turn(when), mark - motion.place_m(when))
        pixel = camera.pixel(ray)
        late = np.nan_to_num(pixel[..., 1]) / (camera.size[1] - 1.0) * readout_s
    return pixel


# Frames


@dataclass
class Renderer:
    """Renders one frame after the other."""

    settings: Settings
    camera: Camera
    motion: Motion
    ground: Ground
    rng: np.random.Generator
    shift_px: Floats  # of the whole picture in each frame, (F, 2)
    slopes: list[tuple[Floats, Floats]] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Undistort the pixels, at four places spread over each."""
        self.slopes = self._slopes(np.zeros(2))

    def _slopes(self, shift_px: Floats) -> list[tuple[Floats, Floats]]:
        u, v = shift_px
        spread = ((-0.375, -0.125), (0.125, -0.375), (0.375, 0.125), (-0.125, 0.375))
        return [self.camera.slopes(du - u, dv - v) for du, dv in spread]

    def frame(self, number: int, time_s: float) -> Any:
        """Render a frame, grey levels (V, U) uint8."""
        width, height = self.camera.size
        light = np.zeros((height, width), np.float32)
        row_s = np.arange(height) / (height - 1.0) * self.settings.readout_ms / 1000.0
        shift_px = self.shift_px[number]
        if shift_px.any():
            self.slopes = self._slopes(shift_px)
        for part, (x, y) in enumerate(self.slopes):
            when = time_s + row_s + EXPOSURE_S * ((part + 0.5) / SAMPLES - 0.5)
            if not self.settings.readout_ms:
                when = when[:1]
            light += self._sample(when, x, y, shift_px)
        light /= SAMPLES
        light *= 1.0 + 0.15 * np.sin(2.0 * np.pi * (time_s / 7.0 + 0.1)) - 0.02 * (time_s / 10.0)
        if self.settings.plume:
            cover, shade = self._plume(number)
            light += cover * (shade - light)
        light += NOISE * self.rng.standard_normal(light.shape, dtype=np.float32)
        return np.clip(light + 0.5, 0.0, 255.0).astype(np.uint8)

    def _sample(self, when: Floats, x: Floats, y: Floats, shift_px: Floats) -> Floats:
        """Trace one ray a pixel to the ground and to what stands on it."""
        turn = self.motion.turn(when).astype(np.float32)[:, :, :, None]
        place = self.motion.place_m(when).astype(np.float32)[:, :, None]
        out = np.empty(x.shape, np.float32)
        for top in range(0, len(x), 60):
            rows = slice(top, min(top + 60, len(x)))
            of = rows if len(when) > 1 else slice(0, 1)
            m, c, xs, ys = turn[of], place[of], x[rows], y[rows]
            de, dn, du = (m[:, k, 0] * xs + m[:, k, 1] * ys + m[:, k, 2] for k in range(3))
            reach = -c[:, 2] / du
            if len(self.ground.hills):
                reach = reach + self._relief(c, de, dn, du) / du
            east, north = c[:, 0] + reach * de, c[:, 1] + reach * dn
            out[rows] = self.ground.texture(east, north)
        for which in range(len(self.ground.mark)):
            self._draw(which, when, x, y, shift_px, out)
        return out

    def _relief(self, c: Floats, de: Floats, dn: Floats, du: Floats) -> Floats:
        """Height of the ground that each ray meets, from every fourth pixel of every fourth row."""
        tall, broad = de.shape
        j = np.unique(np.append(np.arange(0, tall, 4), tall - 1))
        i = np.unique(np.append(np.arange(0, broad, 4), broad - 1))
        e, n, u = (d[np.ix_(j, i)] for d in (de, dn, du))
        own = c if len(c) == 1 else c[j]
        z = np.zeros(e.shape)
        for _ in range(14):
            reach = (z - own[:, 2]) / u
            z = self.ground.height_m(own[:, 0] + reach * e, own[:, 1] + reach * n)
        wide = np.stack([np.interp(np.arange(broad), i, row) for row in z])
        at = np.searchsorted(j, np.arange(tall), "right") - 1
        at = np.minimum(at, len(j) - 2)
        part = ((np.arange(tall) - j[at]) / (j[at + 1] - j[at]))[:, None]
        return np.asarray(wide[at] + part * (wide[at + 1] - wide[at]), np.float32)

    def _draw(
        self, which: int, when: Floats, x: Floats, y: Floats, shift_px: Floats, out: Floats
    ) -> None:
        """Draw a landmark: a bow tie, or a roof with the landmark in its corner; on a mast."""
        mark, foot = self.ground.mark[which], self.ground.foot[which]
        middle = when[len(when) // 2]
        size = MAST_TOP_M if mark[2] > foot else MARK_M * np.sqrt(FULL / self.camera.size[0])
        around = np.array([[a, b, 0.0] for a in (-2.5, 2.5) for b in (-2.5, 2.5)]) * size
        spot = np.concatenate([mark + around, [[*mark[:2], foot]]])
        seen = pixels(self.camera, self.motion, spot, np.array([middle]))[0] + shift_px
        spare = 3.0 + 40.0 * self.settings.readout_ms / 1000.0 * self.camera.size[0] / 10.0
        if not np.isfinite(seen).all():
            return
        low = np.maximum(np.floor(seen.min(axis=0) - spare), 0).astype(int)
        high = np.minimum(np.ceil(seen.max(axis=0) + spare), np.array(self.camera.size)).astype(int)
        if (low >= high).any():
            return
        box = slice(low[1], high[1]), slice(low[0], high[0])
        of = box[0] if len(when) > 1 else slice(0, 1)
        m, c = self.motion.turn(when)[of][..., None], self.motion.place_m(when)[of][..., None]
        de, dn, du = (m[:, k, 0] * x[box] + m[:, k, 1] * y[box] + m[:, k, 2] for k in range(3))
        texel = float(np.linalg.norm(mark - self.motion.place_m(middle))) / self.camera.focal_px
        angle = 0.7 + 1.3 * which
        cosine, sine = np.cos(angle), np.sin(angle)
        slope = np.zeros(2)  # of the ground that a mark lies on
        if mark[2] == foot and len(self.ground.hills):
            beside = mark[:2] + size * np.array([[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]])
            west, east, south, north = self.ground.height_m(*beside.T)
            slope = np.array([east - west, north - south]) / (2.0 * size)
        for z in [*np.arange(foot, mark[2], max(1.0, 0.7 * texel)), mark[2]]:
            rise = slope[0] * (c[:, 0] - mark[0]) + slope[1] * (c[:, 1] - mark[1])
            reach = (z - c[:, 2] + rise) / (du - slope[0] * de - slope[1] * dn)
            e, n = c[:, 0] + reach * de - mark[0], c[:, 1] + reach * dn - mark[1]
            a, b = cosine * e + sine * n, cosine * n - sine * e
            if z < mark[2]:  # the shaft
                cover, grey = _inside(np.maximum(abs(a), abs(b)), 1.2, texel), np.float32(40.0)
            elif which % 2:  # a roof from the landmark on
                cover = _inside(np.maximum(abs(a - size), abs(b - 0.7 * size) / 0.7), size, texel)
                grey = np.float32(225.0)
            else:
                cover = _inside(np.maximum(abs(a), abs(b)), size / 2.0, texel)
                side = np.clip(2.0 * a / texel, -1.0, 1.0) * np.clip(2.0 * b / texel, -1.0, 1.0)
                grey = 130.0 + 95.0 * side
            out[box] += (cover * (grey - out[box])).astype(np.float32)

    def _plume(self, number: int) -> tuple[Floats, Floats]:
        """Cover and grey level of a plume over a third of the picture."""
        first, last = plume_frames(self.settings)
        if not first <= number < last:
            return np.float32(0.0), np.float32(0.0)  # type: ignore[return-value]
        width, height = self.camera.size
        rng = np.random.default_rng([self.settings.seed, number])
        coarse = 175.0 + rng.normal(0.0, 18.0, (9, 16))
        at_u, at_v = np.linspace(0.0, 15.0, width), np.linspace(0.0, 8.0, height)
        wide = np.stack([np.interp(at_u, np.arange(16), row) for row in coarse])
        j = np.minimum(at_v.astype(int), 7)
        shade = wide[j] + (at_v - j)[:, None] * (wide[j + 1] - wide[j])
        u, v = np.arange(width)[None, :], np.arange(height)[:, None]
        return plume_cover(u / width, v / height, number).astype(np.float32), shade


def _inside(far: Floats, limit: float, texel_m: float) -> Floats:
    """Cover of a square, with an edge of half a pixel as each ray has it."""
    return np.asarray(np.clip((limit - far) / (0.5 * texel_m) + 0.5, 0.0, 1.0))


def plume_frames(settings: Settings) -> tuple[int, int]:
    """The first frame with a plume, and the first without it again: a second in the middle."""
    first = max(1, settings.frames // 2 - round(settings.rate_hz / 2))
    return first, first + round(settings.rate_hz)


def plume_cover(u: Floats, v: Floats, number: int) -> Floats:
    """How far a plume hides the picture at parts of its width and height, 0 to 1."""
    waves = 0.03 * np.sin(9.0 * v + 0.4 * number) + 0.02 * np.sin(23.0 * v - 0.7 * number)
    return np.asarray(np.clip((1.0 / 3.0 + waves - u) / 0.02 + 0.5, 0.0, 1.0))


def compress(path: Path, settings: Settings, ticks: Any, frames: Any) -> None:
    """Write frames as H.264, or by another codec."""
    width, height = settings.size
    bits = settings.mbit_s * 1e6 if settings.mbit_s else 8e6 * width * height / (1920 * 1080)
    if not settings.mbit_s:
        bits *= settings.rate_hz / 30.0
    with av.open(str(path), "w") as container:
        stream: Any = container.add_stream(settings.codec, rate=Fraction(settings.rate_hz))
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.bit_rate = round(bits)
        stream.codec_context.time_base = stream.time_base = Fraction(1, TICKS)
        stream.codec_context.thread_count = 1
        stream.options = {"preset": "medium", "g": str(settings.key_frames)}
        chroma = np.full((height // 2, width), 128, np.uint8)
        for tick, grey in zip(ticks, frames, strict=True):
            luma = np.round(16.0 + grey * np.float32(219.0 / 255.0)).astype(np.uint8)
            frame = av.VideoFrame.from_ndarray(np.concatenate([luma, chroma]), "yuv420p")
            frame.pts, frame.time_base = int(tick), Fraction(1, TICKS)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())


# The project


def frame_times(settings: Settings) -> Any:
    """Presentation times of the frames, in ticks; cuts leave time out, evenly over the video."""
    step = round(TICKS / settings.rate_hz)
    number = np.arange(settings.frames)
    gap = round(CUT_S * settings.rate_hz)
    for cut in range(settings.cuts):
        number[settings.frames * (cut + 1) // (settings.cuts + 1) :] += gap
    return number * step


def truth_rows(motion: Motion, time_s: Floats) -> list[str]:
    """Rows of truth.csv: angles of the camera against north, east, down where it is."""
    place = from_local(motion.place_m(time_s))
    local = axes(place[:, 0], place[:, 1])
    enu = local @ axes(*ORIGIN[:2]).T @ motion.turn(time_s)
    ned = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    m = ned @ enu @ np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    yaw = np.degrees(np.arctan2(m[:, 1, 0], m[:, 0, 0])) % 360.0
    roll = np.degrees(np.arctan2(m[:, 2, 1], m[:, 2, 2])) % 360.0
    pitch = -np.degrees(np.arcsin(m[:, 2, 0]))
    rows = []
    for k, t in enumerate(time_s):
        _, vectors = np.linalg.eigh(_quaternion_form(m[k]))
        x, y, z, w = vectors[:, -1] * (1.0 if vectors[3, -1] >= 0.0 else -1.0)
        a, b, h = place[k]
        rows.append(
            f"{k},{t:.6f},{yaw[k]:.6f},{pitch[k]:.6f},{roll[k]:.6f},"
            f"{w:.10f},{x:.10f},{y:.10f},{z:.10f},{a:.9f},{b:.9f},{h:.4f}"
        )
    return rows


def _quaternion_form(m: Floats) -> Floats:
    """The symmetric form whose largest eigenvector is the quaternion x, y, z, w (Bar-Itzhack)."""
    form = np.empty((4, 4))
    form[:3, :3] = m + m.T - np.trace(m) * np.eye(3)
    form[3, :3] = form[:3, 3] = m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]
    form[3, 3] = np.trace(m)
    return form


def write_terrain(path: Path, hills: Floats) -> None:
    """Write hills as a GeoTIFF of heights above the ellipsoid, on a grid of about 30 m."""
    step, half = 0.0003, 0.075
    latitude = ORIGIN[0] + half - step * np.arange(round(2 * half / step) + 1)
    longitude = ORIGIN[1] - half * 1.4 + step * 1.4 * np.arange(len(latitude))
    p, t = np.meshgrid(latitude, longitude, indexing="ij")
    local = (earth_centred_m(p, t, ORIGIN[2]) - earth_centred_m(*ORIGIN)) @ axes(*ORIGIN[:2]).T
    height = ORIGIN[2] + hills_m(hills, local[..., 0], local[..., 1]) - local[..., 2]
    data = np.ascontiguousarray(height, "<f4").tobytes()
    scale = struct.pack("<3d", step * 1.4, step, 0.0)
    tie = struct.pack("<6d", 0.0, 0.0, 0.0, longitude[0], latitude[0], 0.0)
    # GTModelType geographic, GTRasterType points, EPSG:4326
    keys = struct.pack("<16H", 1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 2, 2048, 0, 1, 4326)
    body = 8 + len(data)
    short, long = 3, 4
    tags = [
        (256, long, 1, p.shape[1]), (257, long, 1, p.shape[0]), (258, short, 1, 32),
        (259, short, 1, 1), (262, short, 1, 1), (273, long, 1, 8), (277, short, 1, 1),
        (278, long, 1, p.shape[0]), (279, long, 1, len(data)), (339, short, 1, 3),
        (33550, 12, 3, body), (33922, 12, 6, body + 24), (34735, short, 16, body + 72),
    ]  # fmt: skip
    index = struct.pack("<H", len(tags))
    index += b"".join(struct.pack("<HHII", *tag) for tag in tags) + struct.pack("<I", 0)
    head = struct.pack("<2sHI", b"II", 42, body + 104)
    path.write_bytes(head + data + scale + tie + keys + index)


def clicked(
    settings: Settings, camera: Camera, pixel: Floats, hidden: Any, rng: np.random.Generator
) -> list[str]:
    """Rows of clicks: all that are seen in every 60th frame, or as many as asked for from there.

    With as many as there are landmarks, or fewer, all are of frame 0.
    """
    few = settings.clicks <= settings.landmarks
    every = 1 if few else max(1, min(60, settings.frames // 2 - 1))
    rows = []
    for k in range(0, 1 if few else settings.frames, every):
        for which in np.flatnonzero(camera.sees(pixel[k], 3.0) & ~hidden[k]):
            u, v = pixel[k, which] + rng.normal(0.0, settings.click_px, 2)
            rows.append(f"{k},L{which + 1},{u:.2f},{v:.2f}")
    return rows[: settings.clicks]


def project_text(settings: Settings, camera: Camera) -> str:
    """The text of flight.toml."""
    (width, height), f, (cx, cy) = camera.size, camera.focal_px, camera.centre_px
    lens = f'model = "brown", fx_px = {f}, fy_px = {f}, cx_px = {cx}, cy_px = {cy}'
    readout = ""
    if settings.readout_ms and settings.say_readout:
        readout = f'readout_ms = {settings.readout_ms}\nreadout = "down"\n'
        readout += 'frame_time = "first-row"\n'
    return f"""\
# Rendered by tools/render_video.py; truth.csv and truth_picks.csv have the truth.
[flight]
name = "rendered climb, seed {settings.seed}"
epoch = {EPOCH.isoformat().replace("+00:00", "Z")}
[camera]
image_size_px = [{width}, {height}]
lens = {{ {lens}, k = [{K1}, {K2}, 0.0, 0.0] }}
pixel_grid = "centre"
{readout}[picks]
file = "clicks.csv"
pixel_grid = "centre"
sigma_px = {settings.click_px or 0.5}
video = "video.mp4"
times = "video"
first_frame_t_s = 0.0
[landmarks]
file = "landmarks.csv"
height = "ellipsoid"
sigma_m = "exact"
[track]
file = "track.csv"
height = "ellipsoid"
clock = "seconds"
sigma_m = "exact"
sigma_t_s = "exact"
[atmosphere]
refraction = "off"
"""


def _write(path: Path, *lines: str) -> None:
    path.write_text("\n".join([*lines, ""]), encoding="utf-8", newline="\n")


def make(folder: Path, settings: Settings) -> None:
    """Render a video, and write the project and its truth.

    Args:
        folder: where to; made if it is not there
        settings: the flight's
    """
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(settings.seed)
    camera, motion = new_camera(settings.size), new_motion(rng)
    hills, ticks = new_hills(rng, settings.hills_m), frame_times(settings)
    time_s, readout_s = ticks / TICKS, settings.readout_ms / 1000.0
    mark, foot = new_marks(rng, settings, camera, motion, hills, time_s)
    shift_px = new_shifts_px(settings, time_s)
    pixel = pixels(camera, motion, mark, time_s, readout_s) + shift_px[:, None]
    hidden = np.zeros(pixel.shape[:2], bool)
    if settings.plume:
        first, last = plume_frames(settings)
        for k in range(first, min(last, settings.frames)):
            part = pixel[k] / camera.size
            hidden[k] = plume_cover(part[:, 0], part[:, 1], k) > 0.02
    places = from_local(mark)
    small = ",13" if settings.mast_m else ""
    _write(
        folder / "landmarks.csv", "landmark,lat_deg,lon_deg,h_m" + (",patch_px" if small else ""),
        *(f"L{k + 1},{a:.10f},{b:.10f},{h:.5f}{small}" for k, (a, b, h) in enumerate(places)),
    )  # fmt: skip
    step_s = 1.0 / settings.rate_hz
    fix_s = np.concatenate([[-2 * step_s, -step_s], time_s, time_s[-1] + step_s * np.array([1, 2])])
    off = rng.normal(size=3)
    off *= settings.track_m / np.linalg.norm(off)
    _write(
        folder / "track.csv", "t_s,lat_deg,lon_deg,h_m",
        *(f"{t:.6f},{a:.10f},{b:.10f},{h:.5f}"
          for t, (a, b, h) in zip(fix_s, from_local(motion.place_m(fix_s) + off), strict=True)),
    )  # fmt: skip
    _write(
        folder / "clicks.csv", "# pixels: u right, v down, (0, 0) the centre of the first pixel",
        "frame,landmark,u_px,v_px", *clicked(settings, camera, pixel, hidden, rng),
    )  # fmt: skip
    names = "frame,time_s,camera_yaw_deg,camera_pitch_deg,camera_roll_deg,quaternion_w,"
    names += "quaternion_x,quaternion_y,quaternion_z,latitude_deg,longitude_deg,altitude_m"
    _write(folder / "truth.csv", names, *truth_rows(motion, time_s))
    seen = camera.sees(pixel)
    _write(
        folder / "truth_picks.csv", "frame,landmark,u_px,v_px,hidden",
        *(f"{k},L{n + 1},{pixel[k, n, 0]:.4f},{pixel[k, n, 1]:.4f},{int(hidden[k, n])}"
          for k, n in zip(*np.nonzero(seen), strict=True)),
    )  # fmt: skip
    (folder / "flight.toml").write_text(project_text(settings, camera), encoding="utf-8")
    if settings.hills_m:
        write_terrain(folder / "terrain.tif", hills)
    # texels of a pixel at the beginning
    texel_m = ALTITUDE_M / camera.focal_px
    ground = Ground(
        texel_m, packed(texture(rng, texel_m)), rng.uniform(0.1, 1.4), hills, mark, foot
    )
    renderer = Renderer(settings, camera, motion, ground, rng, shift_px)
    shown = (renderer.frame(k, float(t)) for k, t in enumerate(time_s))
    compress(folder / "video.mp4", settings, ticks, shown)


def main() -> None:
    """Read the options and render."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add, default = parser.add_argument, Settings()
    add("folder", type=Path)
    add("--seed", type=int, default=default.seed)
    add("--size", default="1920x1080", help="pixels; the focal length goes with the width")
    add("--frames", type=int, default=default.frames)
    add("--rate", type=float, default=default.rate_hz, help="frames a second")
    add("--mbit", type=float, help="Mbit/s; 8 for 1920x1080 at 30, as many a pixel for others")
    add("--landmarks", type=int, default=default.landmarks)
    add(
        "--clicks",
        type=int,
        default=default.clicks,
        help="27: those seen in every 60th frame; as many as landmarks or fewer: in frame 0",
    )
    add("--click-px", type=float, default=default.click_px, help="error of a click, each axis")
    add("--plume", action="store_true", help="hide the left third for a second in the middle")
    add("--mast-m", type=float, default=0.0, help="landmarks are tops of masts")
    add("--hills-m", type=float, default=0.0, help="from the lowest to the highest point")
    add("--cuts", type=int, default=0, help="pieces of 1.5 s of the flight that are left out")
    add("--readout-ms", type=float, default=0.0, help="rolling shutter, downward")
    add("--hide-readout", action="store_true", help="do not state it in flight.toml")
    add("--track-m", type=float, default=0.0, help="the whole track is off by that much, unsaid")
    add(
        "--stabilised-px", type=float, default=0.0,
        help="the picture is shifted by so much, rms of u and v together, unsaid",
    )  # fmt: skip
    add("--codec", default=default.codec)
    add("--key-frames", type=int, default=default.key_frames, help="frames from one to the next")
    given = parser.parse_args()
    width, height = (int(one) for one in given.size.split("x"))
    make(given.folder, Settings(
        given.seed, (width, height), given.frames, given.rate, given.mbit, given.landmarks,
        given.clicks, given.click_px, given.plume, given.mast_m, given.hills_m, given.cuts,
        given.readout_ms, not given.hide_readout, given.track_m, given.stabilised_px, given.codec,
        given.key_frames,
    ))  # fmt: skip


if __name__ == "__main__":
    main()
