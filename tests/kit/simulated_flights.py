"""Flights of known attitude with random errors in what their projects state, and their files.

Nothing of the package is used, numpy and the standard library alone: geodesy, attitude, lens,
refraction, path, clock, wind and readout are written here from their definitions. Errors that are
common to a flight are drawn once a flight. A project states the standard deviations from which the
errors were drawn, times `Plan.stated`; an error of standard deviation 0 is stated as exact.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

Array = np.ndarray
Triple = tuple[float, float, float]

# WGS 84, metres

SEMI_AXIS_M, FLATTENING = 6378137.0, 1 / 298.257223563
E2 = FLATTENING * (2.0 - FLATTENING)


def ecef(latitude: Array, longitude: Array, height: Array) -> Array:
    """Convert geodetic coordinates, radians and metres, to Earth-centred ones, (..., 3)."""
    n = SEMI_AXIS_M / np.sqrt(1.0 - E2 * np.sin(latitude) ** 2)
    across = (n + height) * np.cos(latitude)
    up = (n * (1.0 - E2) + height) * np.sin(latitude)
    return np.stack([across * np.cos(longitude), across * np.sin(longitude), up], axis=-1)


def geodetic(point: Array) -> tuple[Array, Array, Array]:
    """Convert Earth-centred positions to latitude, longitude, radians, and height, metres."""
    x, y, z = np.moveaxis(point, -1, 0)
    across = np.hypot(x, y)
    latitude = np.arctan2(z, across * (1.0 - E2))
    for _ in range(6):  # each gains a factor of E2 h / a at least
        n = SEMI_AXIS_M / np.sqrt(1.0 - E2 * np.sin(latitude) ** 2)
        latitude = np.arctan2(z + E2 * n * np.sin(latitude), across)
    sine = np.sin(latitude)
    height = across * np.cos(latitude) + z * sine - SEMI_AXIS_M * np.sqrt(1.0 - E2 * sine**2)
    return latitude, np.arctan2(y, x), height


def local_axes(point: Array) -> Array:
    """Resolve east, north, up at Earth-centred positions: rows, (..., 3, 3)."""
    latitude, longitude, _ = geodetic(point)
    (st, sp), (ct, cp) = (f(np.array([longitude, latitude])) for f in (np.sin, np.cos))
    east = np.stack([-st, ct, 0.0 * st], axis=-1)
    up = np.stack([cp * ct, cp * st, sp], axis=-1)
    return np.stack([east, np.cross(up, east), up], axis=-2)


# Attitude

CAMERA_FROM_BODY = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
NED_FROM_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


def body_to_ned(angles_deg: Array) -> Array:
    """Turn yaw about down, pitch about the new right, roll about the new forward, (..., 3, 3)."""
    (sy, sp, sr), (cy, cp, cr) = (
        np.moveaxis(f(np.radians(angles_deg)), -1, 0) for f in (np.sin, np.cos)
    )
    forward = np.stack([cp * cy, cp * sy, -sp], axis=-1)
    right = np.stack([sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, sr * cp], axis=-1)
    return np.stack([forward, right, np.cross(forward, right)], axis=-1)


def attack_deg(angles_deg: Array, through_air: Array) -> Array:
    """Alpha, beta, eta by their definitions, (F, 3), for velocities north, east, down (F, 3)."""
    u, v, w = np.einsum("fij,fi->jf", body_to_ned(angles_deg), through_air)
    return np.degrees(
        np.stack([np.arctan2(w, u), np.arctan2(v, u), np.arctan2(np.hypot(v, w), u)], axis=-1)
    )


def turns_deg(rotation: Array) -> Array:
    """Convert rotations of less than 90 degrees to vectors, axis times angle, (..., 3)."""
    off = np.stack([rotation[..., 2, 1], rotation[..., 0, 2], rotation[..., 1, 0]], axis=-1)
    off -= np.stack([rotation[..., 1, 2], rotation[..., 2, 0], rotation[..., 0, 1]], axis=-1)
    sine = np.linalg.norm(off, axis=-1, keepdims=True) / 2.0
    large = sine > 1e-9
    scale = np.where(large, np.arcsin(np.minimum(sine, 1.0)) / np.where(large, sine, 1.0), 1.0)
    return np.asarray(np.degrees(off / 2.0 * scale))


def mean_angles_deg(angles_deg: Array) -> Array:
    """Average attitudes: the one from which the turns to all have the mean zero, (3,)."""
    bodies, middle = body_to_ned(angles_deg), np.array(angles_deg[len(angles_deg) // 2])
    for _ in range(20):
        mean = turns_deg(body_to_ned(middle).T @ bodies).mean(axis=0)
        forward, right, down = (body_to_ned(middle) @ _rotation(mean)).T
        middle = np.degrees([
            np.arctan2(forward[1], forward[0]), -np.arcsin(forward[2]),
            np.arctan2(right[2], down[2]),
        ])  # fmt: skip
    return middle


def _rotation(turn_deg: Array) -> Array:
    """Convert a small turn to a rotation by Cayley's formula, exact to second order."""
    x, y, z = np.radians(turn_deg) / 2.0
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.linalg.solve(np.eye(3) - cross, np.eye(3) + cross))


# Lens and air

WIDE, HIGH = 1920, 1080
MIDDLE = np.array([(WIDE - 1) / 2.0, (HIGH - 1) / 2.0])  # pixels, first one's centre is 0
EARTH_M, SCALE_M = 6371e3, 8000.0  # the coefficient of refraction is of this radius, and decays so


class LensErrors(NamedTuple):
    """Errors of the lens, or their standard deviations."""

    focal_rel: float = 0.0
    u_px: float = 0.0  # of the principal point
    v_px: float = 0.0
    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0
    aspect: float = 0.0  # of fy alone, a part of it; no project states it


def image_of(plan: Plan, wrong: LensErrors, ray: Array) -> Array:
    """Find the pixel of rays in camera axes, (..., 3) to (..., 2)."""
    k1, k2 = plan.distortion[0] + wrong.k1, plan.distortion[1] + wrong.k2
    across = np.hypot(ray[..., 0], ray[..., 1])
    if plan.fisheye:
        angle = np.arctan2(across, ray[..., 2])
        scale = angle * (1.0 + k1 * angle**2 + k2 * angle**4) / across
        x, y = ray[..., 0] * scale, ray[..., 1] * scale
    else:
        a, b = ray[..., 0] / ray[..., 2], ray[..., 1] / ray[..., 2]
        r2 = a * a + b * b
        grow = 1.0 + k1 * r2 + k2 * r2 * r2
        x = a * grow + 2.0 * wrong.p1 * a * b + wrong.p2 * (r2 + 2.0 * a * a)
        y = b * grow + wrong.p1 * (r2 + 2.0 * b * b) + 2.0 * wrong.p2 * a * b
    focal = plan.focal_px * (1.0 + wrong.focal_rel)
    return (
        focal * np.stack([x, y * (1.0 + wrong.aspect)], axis=-1) + MIDDLE + [wrong.u_px, wrong.v_px]
    )


def ray_of(plan: Plan, pixel: Array) -> Array:
    """Find rays near those of pixels, without distortion: to lay landmarks, not exact."""
    x, y = np.moveaxis((pixel - MIDDLE) / plan.focal_px, -1, 0)
    if not plan.fisheye:
        return np.stack([x, y, np.ones_like(x)], axis=-1)
    angle = np.maximum(np.hypot(x, y), 1e-9)
    return np.stack([x / angle * np.sin(angle), y / angle * np.sin(angle), np.cos(angle)], axis=-1)


NODES, WEIGHTS = np.polynomial.legendre.leggauss(8)


def raised_rad(camera_m: Array, landmark_m: Array, coefficient: float) -> Array:
    """Integrate how far air raises a landmark: curvature times (1 - s/L) along the straight line.

    Args:
        camera_m: Earth-centred, (..., 3)
        landmark_m: Earth-centred, (..., 3)
        coefficient: curvature of a level ray at the ground, in curvatures of the Earth
    """
    away = landmark_m - camera_m
    length = np.linalg.norm(away, axis=-1)
    total = np.zeros(length.shape)
    for node, weight in zip((NODES + 1.0) / 2.0, WEIGHTS / 2.0, strict=True):
        point = camera_m + node * away
        rise = np.einsum("...i,...i->...", local_axes(point)[..., 2, :], away) / length
        density = np.exp(-geodetic(point)[2] / SCALE_M)
        total += weight * (1.0 - node) * density * np.sqrt(np.maximum(1.0 - rise**2, 0.0))
    return total * coefficient * length / EARTH_M


# What to draw


class Errors(NamedTuple):
    """Standard deviations of what goes wrong in a flight, 0 or empty for nothing.

    Where there are several classes of landmarks, or of fixes, each is drawn at random and stands
    in a column of its file.
    """

    pick_px: float = 0.8
    landmark_m: tuple[float, ...] = ()  # east, north, up; each landmark the same in its flight
    fix_m: tuple[Triple, ...] = ()  # east, north, up, of every position of the track by itself
    bias_m: Triple = (0.0, 0.0, 0.0)  # of a whole track, or of the place of a camera that stands
    clock_s: float = 0.0  # one a flight, as all that follow but for the velocity
    clock_rate_ppm: float = 0.0  # about the middle of the flight
    readout_ms: float = 0.0
    lens: LensErrors = LensErrors()
    refraction: float = 0.0  # of the coefficient, as a part of it
    velocity_m_s: float = 0.0  # north, east, down, of every row of the track by itself
    velocity_bias_m_s: float = 0.0  # one a flight
    wind_m_s: float = 0.0  # toward north, east


class Plan(NamedTuple):
    """What flights to draw; pairs are ranges of uniform distributions."""

    errors: Errors = Errors()
    flights: int = 40
    frames: int = 50
    landmarks: int = 4  # in a frame
    own: bool = False  # each frame has landmarks of its own, of one class
    poor: bool = False  # landmarks in a strip of 200 by 40 px
    sigma_px: bool = False  # stated, or left to the residuals
    stated: float = 1.0  # standard deviations in the project over the true ones
    frame_hz: float = 2.0
    fix_hz: float = 0.0  # of the track; 0: a position for every frame
    stands: bool = False  # one place for all frames
    height_m: tuple[float, float] = (80.0, 120.0)
    pitch_deg: tuple[float, float] = (-60.0, -25.0)
    jitter_deg: float = 3.0  # of every frame by itself
    swing_deg: float = 0.0  # of a smooth motion of all three angles
    swing_s: float = 4.0
    distance_m: tuple[float, float] = (0.0, 0.0)  # of landmarks; 0: they are on the ground
    speed_m_s: float = 3.0  # standard deviation of a horizontal component; up a third
    ahead: bool = False  # the vehicle flies where it looks, 5 to 15 degrees off
    weave_m: float = 0.0  # across the path
    weave_s: float = 8.0
    focal_px: float = 1500.0
    distortion: tuple[float, float] = (0.0, 0.0)  # k1, k2
    fisheye: bool = False
    refraction: float = 0.0  # the coefficient at the ground
    velocity: bool = False  # columns of the track
    wind: bool = False  # a sounding
    readout_ms: float = 0.0  # downward, frames have the time of the first row


class Truth(NamedTuple):
    """The true flight of F frames and L landmarks in each."""

    angles_deg: Array  # (F, 9) yaw, pitch, roll of camera and vehicle, alpha, beta, eta or NaN
    place_m: Array  # (F, 3) Earth-centred, of the camera
    group: Array  # (F,) class of the frame's fix, or of its landmarks if they are its own
    wrong: tuple[int, ...]  # of a blunder: its frame, and the landmarks of its picks
    value: dict[str, float]  # of parameters, by the names and in the units of vopd adjust


# A flight


class Drawn(NamedTuple):
    """What is true of a flight."""

    plan: Plan
    path: Flown
    angles_deg: Array  # (F, 3) yaw, pitch, roll
    marks_m: Array  # (N, 3) Earth-centred
    which: Array  # (F, L) the landmarks of each frame
    lens: LensErrors
    air: float  # the coefficient of refraction
    late_s: float  # how much later than they say all frames are
    readout_s: float
    slow: float = 0.0  # seconds that frames are later for each second that they say
    off_m: Array = np.zeros(3)  # of all places, east, north, up
    frame_late_s: Array | float = 0.0  # of each frame, (F,)
    off_px: Array | float = 0.0  # of each pick, (F, L, 2)

    @property
    def time_s(self) -> Array:
        """Times that the frames say, (F,)."""
        return np.asarray(np.arange(self.plan.frames) / self.plan.frame_hz)

    @property
    def true_s(self) -> Array:
        """True times of the frames on the clock of the track, (F,)."""
        return np.asarray(self.time_s * (1.0 + self.slow) + self.late_s + self.frame_late_s)

    @property
    def place_m(self) -> Array:
        """Places of the camera, Earth-centred, (F, 3)."""
        return self.path.place_m(self.true_s, self.off_m)

    def pixels(self, turn_deg: Array | float = 0.0, off_m: Array | float = 0.0) -> Array:
        """Image the landmarks without errors of picks, (F, L, 2).

        Args:
            turn_deg: added to yaw, pitch, roll of all frames, (3,)
            off_m: added to the places of all frames, east, north, up, (3,)
        """
        row_s = np.zeros(self.which.shape)
        look = (self.angles_deg + turn_deg)[:, None]
        for _ in range(4 if self.readout_s else 1):  # a row later is a small part of a row more
            moved = self.path.attitude_deg(self.time_s[:, None] + row_s)
            moved -= self.path.attitude_deg(self.time_s)[:, None]
            place = self.path.place_m(self.true_s[:, None] + row_s, self.off_m + off_m)
            ray = _rays(place, self.marks_m[self.which], look + moved, self.air)
            pixel = image_of(self.plan, self.lens, ray)
            row_s = self.readout_s * pixel[..., 1] / HIGH
        return np.asarray(pixel + self.off_px)


def write_flight(
    folder: Path, plan: Plan, rng: np.random.Generator, mistake: str = "", noticed: float = 1.0
) -> Truth:
    """Draw a flight, and write its project as a user has it.

    Args:
        folder: for `flight.toml`, `picks.csv`, `landmarks.csv`, `track.csv` and `wind.csv`
        plan: what to draw
        rng: the random numbers
        mistake: one of `MISTAKES` or `BLUNDERS` that the project does not know of
        noticed: its size, in those that are noticeable
    """
    e = plan.errors
    path = Flown(plan, rng)
    more = rng.spawn(1)[0]  # for errors that few plans have: the others' flights stay as they are
    lens = LensErrors(*rng.normal(0.0, e.lens[:-1]), more.normal(0.0, e.lens.aspect))
    slow, readout_s = 1e-6 * more.normal(0.0, e.clock_rate_ppm), plan.readout_ms / 1000.0
    readout_s += more.normal(0.0, e.readout_ms) / 1000.0
    air = plan.refraction * (1.0 + rng.normal(0.0, e.refraction))
    clock_s = rng.normal(0.0, e.clock_s)
    late_s = clock_s - slow * (plan.frames - 1) / plan.frame_hz / 2.0
    time_s = np.arange(plan.frames) / plan.frame_hz
    angles = path.attitude_deg(time_s)
    angles += rng.uniform(-1.0, 1.0, angles.shape) * plan.jitter_deg
    marks_m, which, mark_m, mark_group = _landmarks(plan, rng, path, angles, time_s + late_s)
    right = Drawn(plan, path, angles, marks_m, which, lens, air, late_s, readout_s, slow)
    wrong: tuple[int, ...] = ()
    if mistake in BLUNDERS:
        slots = rng.choice(which.shape[1], 2, replace=False).tolist()
        wrong = (int(rng.integers(plan.frames)), *slots)
    drawn = spoiled(right, mistake, noticed, rng, wrong) if mistake else right

    pixel = drawn.pixels() + rng.normal(0.0, e.pick_px, (*which.shape, 2))
    if mistake == "u and v exchanged":
        pixel = pixel[..., ::-1]
    if mistake == "v upward":
        pixel = pixel * [1.0, -1.0] + [0.0, HIGH - 1.0]
    if mistake == "labels of a frame":
        pixel[wrong[0], slots] = pixel[wrong[0], slots[::-1]]
    label = np.arange(len(marks_m))
    if mistake == "labels exchanged":
        label[:2] = 1, 0
    _table(folder / "picks.csv", "frame,landmark,u_px,v_px", "%d,m%d,%.4f,%.4f", np.stack([
        np.repeat(np.arange(plan.frames), which.shape[1]), label[which].ravel(),
        *pixel.reshape(-1, 2).T,
    ]))  # fmt: skip
    off_m = rng.normal(size=marks_m.shape) * mark_m[:, None]
    stated_m = marks_m + _enu(off_m, marks_m)
    by_row = len(e.landmark_m) > 1
    columns = [np.arange(len(marks_m)), *_degrees(stated_m), *([plan.stated * mark_m] * by_row)]
    _table(folder / "landmarks.csv", "landmark,lat_deg,lon_deg,h_m" + ",sigma_m" * by_row,
           f"m%d,{PLACE}" + ",%g" * by_row, np.stack(columns))  # fmt: skip
    bias_m = rng.normal(0.0, e.bias_m)
    if plan.stands:
        place = right.place_m[:1]
        place = _degrees(place + _enu(bias_m, place))
        fix_group = np.zeros(plan.frames, int)
        where = "[position]\nlat_deg = {:.12f}\nlon_deg = {:.12f}\nh_m = {:.5f}\n".format(
            *(float(one[0]) for one in place)
        )
    else:
        fix_group = _write_track(folder, plan, rng, path, time_s, bias_m)
        where = '[track]\nfile = "track.csv"\n'
    wind = rng.normal(0.0, 6.0, 2) * plan.wind
    if plan.wind:
        _write_wind(folder, wind + rng.normal(0.0, e.wind_m_s, 2))
    (folder / "flight.toml").write_text(_project(plan, where), encoding="utf-8")
    velocity = path.velocity_m_s(drawn.true_s, drawn.place_m)
    velocity[:, :2] -= wind
    attack = np.full_like(angles, np.nan) if plan.stands else attack_deg(angles, velocity)
    group = mark_group if plan.own and by_row else fix_group
    wrong = (wrong[0], *which[wrong[0], slots].tolist()) if wrong else ()
    value = _values(drawn, clock_s, -bias_m, -off_m)
    return Truth(np.hstack([angles, angles, attack]), drawn.place_m, group, wrong, value)


def _values(drawn: Drawn, clock_s: float, bias_m: Array, marks_m: Array) -> dict[str, float]:
    """Name the true values of what `vopd adjust` solves for, in its units."""
    plan, lens = drawn.plan, drawn.lens
    value = {
        "focal": plan.focal_px * (1.0 + lens.focal_rel), "aspect": 1.0 + lens.aspect,
        "centre_u": float(MIDDLE[0]) + lens.u_px, "centre_v": float(MIDDLE[1]) + lens.v_px,
        "k1": plan.distortion[0] + lens.k1, "k2": plan.distortion[1] + lens.k2,
        "p1": lens.p1, "p2": lens.p2, "clock": clock_s, "clock-rate": 1e6 * drawn.slow,
        "readout": 1e3 * drawn.readout_s,
    }  # fmt: skip
    for axis, name in enumerate(("east", "north", "up")):
        value[f"track-offset {name}"] = float(bias_m[axis])
        value |= {f"landmark:m{k} {name}": float(m) for k, m in enumerate(marks_m[:, axis])}
    return value


class Flown:
    """A drawn path: a straight one at constant speed, with a weaving across it, and attitude."""

    def __init__(self, plan: Plan, rng: np.random.Generator) -> None:
        latitude, longitude = np.radians([rng.uniform(-60.0, 60.0), rng.uniform(-179.0, 179.0)])
        self.plan = plan
        self.ground_m = ecef(latitude, longitude, np.array(300.0))
        self.axes = local_axes(self.ground_m)
        self.base_deg = np.array(
            [rng.uniform(0.0, 360.0), rng.uniform(*plan.pitch_deg), rng.uniform(-5.0, 5.0)]
        )
        self.phase = rng.uniform(0.0, 2.0 * np.pi, 4)
        self.start = np.array([0.0, 0.0, rng.uniform(*plan.height_m)])
        velocity = rng.normal(0.0, plan.speed_m_s, 3) * [1.0, 1.0, 0.3]
        if plan.ahead:
            heading = np.radians(self.base_deg[0] + rng.uniform(5.0, 15.0) * rng.choice([-1, 1]))
            velocity = plan.speed_m_s * np.array([np.sin(heading), np.cos(heading), 0.05])
        self.velocity = velocity * (not plan.stands)
        side = np.array([-self.velocity[1], self.velocity[0], 0.0])
        self.side = plan.weave_m * side / max(float(np.linalg.norm(side)), 1e-9)
        self.middle_s = (plan.frames - 1) / plan.frame_hz / 2.0

    def place_m(self, time_s: Array, off_m: Array | float = 0.0) -> Array:
        """Place the camera, Earth-centred, (..., 3), so far off east, north, up."""
        weave = np.sin(2.0 * np.pi * time_s / self.plan.weave_s + self.phase[3])[..., None]
        since = (time_s - self.middle_s)[..., None]
        local = self.start + since * self.velocity + weave * self.side + off_m
        return np.asarray(self.ground_m + local @ self.axes)

    def velocity_m_s(self, time_s: Array, place_m: Array) -> Array:
        """Differentiate the path, north, east, down at the camera, (F, 3)."""
        turn = 2.0 * np.pi / self.plan.weave_s
        weave = turn * np.cos(turn * time_s + self.phase[3])[..., None]
        earth = (self.velocity + weave * self.side) @ self.axes
        return np.einsum("fij,fj->fi", NED_FROM_ENU @ local_axes(place_m), earth)

    def attitude_deg(self, time_s: Array) -> Array:
        """Yaw, pitch, roll without the jitter of frames, (..., 3)."""
        angle = 2.0 * np.pi * time_s[..., None] / self.plan.swing_s + self.phase[:3]
        return np.asarray(self.base_deg + self.plan.swing_deg * np.sin(angle))


def _rays(camera_m: Array, mark_m: Array, look_deg: Array, air: float) -> Array:
    """Rays to landmarks in camera axes, raised by the air, (F, L, 3)."""
    axes = local_axes(camera_m)
    local = np.einsum("flij,flj->fli", axes, mark_m - camera_m)
    if air:
        east, north, up = np.moveaxis(local, -1, 0)
        level = np.hypot(east, north)
        higher = np.arctan2(up, level) + raised_rad(camera_m, mark_m, air)
        local = np.stack([east, north, level * np.tan(higher)], axis=-1)
    to_camera = CAMERA_FROM_BODY @ body_to_ned(look_deg).swapaxes(-1, -2) @ NED_FROM_ENU
    ray = np.einsum("flij,flj->fli", to_camera, local)
    assert (ray[..., 2] > 0.0).all()
    return np.asarray(ray)


def _landmarks(
    plan: Plan, rng: np.random.Generator, path: Flown, angles_deg: Array, true_s: Array
) -> tuple[Array, Array, Array, Array]:
    """Lay landmarks where the camera sees them.

    Returns:
        True places (N, 3), the landmarks of each frame (F, L), the standard deviation of each
        landmark (N,), and the class of each frame's (F,).
    """
    n, frames, camera_m = plan.landmarks, plan.frames, path.place_m(true_s)
    sets = frames if plan.own else 1
    if plan.poor:
        along = np.linspace(-100.0, 100.0, n) + rng.uniform(-20.0, 20.0, (sets, n))
        image = np.stack([along, rng.uniform(-20.0, 20.0, (sets, n))], axis=-1)
        image += rng.uniform(-200.0, 200.0, (sets, 1, 2))
    else:
        around = np.arange(n) / n + rng.random((sets, 1)) + rng.uniform(-0.16, 0.16, (sets, n)) / n
        angle = 2.0 * np.pi * around
        image = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        image *= rng.uniform(0.5, 0.9, (sets, n, 1)) * [WIDE / 2, HIGH / 2]
    ray = ray_of(plan, image + MIDDLE)
    middle = slice(None) if plan.own else slice(frames // 2, frames // 2 + 1)
    look = angles_deg if plan.own else path.base_deg[None]
    to_enu = NED_FROM_ENU @ body_to_ned(look) @ CAMERA_FROM_BODY.T
    away = np.einsum("sij,slj->sli", to_enu, ray)
    away /= np.linalg.norm(away, axis=-1, keepdims=True)
    if plan.distance_m[1]:
        reach = rng.uniform(*plan.distance_m, (sets, n))
    else:
        height = rng.uniform(0.0, 10.0, (sets, n))
        reach = (path.start[2] - height) / np.maximum(-away[..., 2], 0.15)
    start = camera_m[middle]
    place = start[:, None] + np.einsum("sij,sli->slj", local_axes(start), away * reach[..., None])
    sizes = np.array(plan.errors.landmark_m or (0.0,))
    group = rng.integers(len(sizes), size=sets if plan.own else n)
    of_mark = np.repeat(group, n) if plan.own else group
    which = np.arange(sets * n).reshape(sets, n)
    if not plan.own:
        which, group = np.repeat(which, frames, axis=0), np.zeros(frames, int)
    return place.reshape(-1, 3), which, sizes[of_mark], group


# Mistakes that a project does not know of

STEPS = {
    "clock": 1e-3,  # s
    "frame rate": 1e-5,  # of itself
    "focal length": 1e-4,  # of itself
    "k1": 1e-4,
    "heights": 0.01,  # m, of the track against the landmarks
    "position": 0.01,  # m, in any direction
    "landmark": 0.01,  # m, in any direction, in all frames
    "readout": 1e-4,  # s
}
"""Mistakes that have a size, and how much of them is small."""
MISTAKES = (*STEPS, "u and v exchanged", "v upward", "labels exchanged")
BLUNDER_STEPS = {"pick": 0.01, "time of a frame": 1e-3}  # px, in any direction; s
BLUNDERS = (*BLUNDER_STEPS, "labels of a frame")
"""What goes wrong in one frame."""
NOTICED = 4.0  # standard deviations of a mistake's size: .001 for fifteen trials together


def spoiled(
    drawn: Drawn, mistake: str, noticed: float, rng: np.random.Generator,
    wrong: tuple[int, ...] = (),
) -> Drawn:  # fmt: skip
    """Make a mistake of a size that is so many times the noticeable one.

    It is noticeable where its estimate differs from zero by `NOTICED` standard deviations in half
    of the flights: by the normal equations of turns and places of the frames, with their priors.
    """
    steps = STEPS | BLUNDER_STEPS
    if mistake not in steps:
        return drawn
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    step = steps[mistake]
    plan = drawn.plan
    middle = drawn.pixels()
    by = (_changed(drawn, mistake, step, way, wrong).pixels() - middle) / step
    turns = [(drawn.pixels(turn_deg=one) - middle) / 1e-3 for one in 1e-3 * np.eye(3)]
    sizes = np.array((plan.errors.fix_m or ((0.0,) * 3,))[0])
    moves = [(drawn.pixels(off_m=one) - middle) / 1e-3 for one in 1e-3 * np.eye(3)]
    known = [moved * size for moved, size in zip(moves, sizes, strict=True)]
    flat = [np.stack(some, axis=-1).reshape(plan.frames, -1, len(some)) / plan.errors.pick_px
            for some in ([by], turns + known)]  # fmt: skip
    effect, others = flat[0], flat[1]
    normal = others.swapaxes(1, 2) @ others + np.diag([0.0] * 3 + [1.0] * 3)
    across = others.swapaxes(1, 2) @ effect
    gain = (effect**2).sum() - (across * np.linalg.solve(normal, across)).sum()
    return _changed(drawn, mistake, noticed * NOTICED / float(np.sqrt(gain)), way, wrong)


def _changed(drawn: Drawn, mistake: str, size: float, way: Array, wrong: tuple[int, ...]) -> Drawn:
    if mistake == "pick":
        off_px = np.zeros((*drawn.which.shape, 2))
        off_px[wrong[:2]] = size * way[:2] / np.linalg.norm(way[:2])
        return drawn._replace(off_px=off_px)
    if mistake == "time of a frame":
        return drawn._replace(frame_late_s=size * (np.arange(drawn.plan.frames) == wrong[0]))
    if mistake == "clock":
        return drawn._replace(late_s=drawn.late_s + size)
    if mistake == "frame rate":
        return drawn._replace(slow=drawn.slow + size)
    if mistake == "focal length":
        return drawn._replace(lens=drawn.lens._replace(focal_rel=drawn.lens.focal_rel + size))
    if mistake == "k1":
        return drawn._replace(lens=drawn.lens._replace(k1=drawn.lens.k1 + size))
    if mistake == "readout":
        return drawn._replace(readout_s=drawn.readout_s + size)
    if mistake == "landmark":
        marks_m = drawn.marks_m.copy()
        marks_m[:1] += _enu(size * way, marks_m[:1])
        return drawn._replace(marks_m=marks_m)
    return drawn._replace(
        off_m=size * (way if mistake == "position" else np.array([0.0, 0.0, 1.0]))
    )


# Its files


def _write_track(
    folder: Path, plan: Plan, rng: np.random.Generator, path: Flown, time_s: Array, bias_m: Array
) -> Array:
    """Write the track; the class of the fixes of each frame (F,), -1 where it has two."""
    e = plan.errors
    fix_s = time_s
    if plan.fix_hz:
        first = time_s[0] - rng.uniform(1.0, 2.0) / plan.fix_hz
        count = int((time_s[-1] - first) * plan.fix_hz) + 3
        fix_s = first + np.arange(count) / plan.fix_hz
    place = path.place_m(fix_s)
    sizes = np.array(e.fix_m or ((0.0, 0.0, 0.0),))
    group = rng.integers(len(sizes), size=len(fix_s))
    moved = rng.normal(size=place.shape) * sizes[group] + bias_m
    head, form = "t_s,lat_deg,lon_deg,h_m", f"%.9f,{PLACE}"
    columns = [fix_s, *_degrees(place + _enu(moved, place))]
    if len(sizes) > 1:
        axes = ("",) if (sizes == sizes[:, :1]).all() else ("_e", "_n", "_u")
        head += "".join(f",sigma{axis}_m" for axis in axes)
        form += ",%g" * len(axes)
        columns += [*(plan.stated * sizes[group]).T[: len(axes)]]
    if plan.velocity:
        speed = path.velocity_m_s(fix_s, place) + rng.normal(0.0, e.velocity_bias_m_s, 3)
        speed += rng.normal(0.0, e.velocity_m_s, speed.shape)
        head, form = head + ",vn_m_s,ve_m_s,vd_m_s", form + ",%.6f,%.6f,%.6f"
        columns += [*speed.T]
    _table(folder / "track.csv", head, form, np.stack(columns))
    near = np.searchsorted(fix_s, time_s + 1e-9) - 1
    after = np.minimum(near + (plan.fix_hz > 0.0), len(fix_s) - 1)
    return np.where(group[near] == group[after], group[near], -1)


def _write_wind(folder: Path, toward: Array) -> None:
    """Write a sounding of the same wind at all heights."""
    north, east = -toward
    rows = np.array([[h, np.degrees(np.arctan2(east, north)) % 360.0, np.hypot(north, east)]
                     for h in (0.0, 9000.0)])  # fmt: skip
    _table(folder / "wind.csv", "h_m,from_deg,speed_m_s", "%g,%.7f,%.7f", rows.T)


READOUT = 'readout_ms = {}\nreadout = "down"\nframe_time = "first-row"'
PLACE = "%.12f,%.12f,%.6f"


def _degrees(point: Array) -> list[Array]:
    latitude, longitude, height = geodetic(point)
    return [np.degrees(latitude), np.degrees(longitude), height]


def _enu(moved: Array, at: Array) -> Array:
    """Resolve moves east, north, up at places (..., 3) in Earth-centred axes."""
    return np.einsum("...ij,...i->...j", local_axes(at), moved)


def _table(path: Path, head: str, form: str, columns: Array) -> None:
    rows = (form % tuple(row) for row in columns.T.tolist())
    path.write_text("\n".join([head, *rows, ""]), encoding="utf-8")


def _project(plan: Plan, where: str) -> str:
    """Write the project: what stands in it of each error is its standard deviation."""
    e, lens = plan.errors, plan.errors.lens

    def sigma(*values: float) -> str:
        if not any(values):
            return '"exact"'
        texts = [f"{plan.stated * one:.9g}" for one in values]
        return texts[0] if len(set(texts)) == 1 else f"[{', '.join(texts)}]"

    k1, k2 = plan.distortion
    lines = [
        '[flight]\nname = "simulated"',
        f'[camera]\nimage_size_px = [{WIDE}, {HIGH}]\npixel_grid = "centre"',
        *([READOUT.format(plan.readout_ms)] if plan.readout_ms else []),
        f'[camera.lens]\nmodel = "{"fisheye" if plan.fisheye else "brown"}"',
        f"fx_px = {plan.focal_px}\ncx_px = {MIDDLE[0]}\ncy_px = {MIDDLE[1]}",
        f"k = [{k1}, {k2}, 0.0, 0.0]",
    ]
    lines.append('[picks]\nfile = "picks.csv"\npixel_grid = "centre"')
    lines.append(f"frame_rate_hz = {plan.frame_hz}\nfirst_frame_t_s = 0.0")
    if plan.sigma_px:
        lines.append(f"sigma_px = {sigma(e.pick_px)}")
    lines.append('[landmarks]\nfile = "landmarks.csv"\nheight = "ellipsoid"')
    if len(e.landmark_m) < 2:
        lines.append(f"sigma_m = {sigma(*e.landmark_m)}")
    lines.append(f'{where}height = "ellipsoid"')
    if plan.stands:
        lines.append(f"sigma_m = {sigma(*e.bias_m)}")
    else:
        if len(e.fix_m) < 2:
            lines.append(f"sigma_m = {sigma(*(e.fix_m or ((0.0,),))[0])}")
        if any(e.bias_m):
            lines.append(f"sigma_bias_m = {sigma(*e.bias_m)}")
        lines.append(f"sigma_t_s = {sigma(e.clock_s)}")
        if plan.velocity:
            total = float(np.hypot(e.velocity_m_s, e.velocity_bias_m_s))
            lines.append(f"velocity_sigma_m_s = {sigma(total)}")
    if plan.wind:
        lines.append(f'[wind]\nfile = "wind.csv"\nsigma_m_s = {sigma(e.wind_m_s)}')
    lines.append(f'[atmosphere]\nrefraction = "{"standard" if plan.refraction else "off"}"')
    if plan.refraction and plan.stated * e.refraction != 0.5:
        lines.append(f"sigma_k = {sigma(e.refraction * plan.refraction)}")
    stated = {
        "focal_rel": (lens.focal_rel,),
        "principal_px": (lens.u_px, lens.v_px),
        "k1": (lens.k1,),
        "k2": (lens.k2,),
        "p1p2": (lens.p1, lens.p2),
        "clock_rate_ppm": (e.clock_rate_ppm,),
        "readout_ms": (e.readout_ms,),
    }
    lines.append("[uncertainty]")
    lines += [f"{key} = {sigma(*values)}" for key, values in stated.items() if any(values)]
    return "\n".join([*lines, ""])
