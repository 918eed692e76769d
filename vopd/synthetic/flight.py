"""Synthetic flights whose true attitude is known, as card decks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.findings import VopdError
from vopd.geometry.earth import earth_centred, geodetic_latitude
from vopd.geometry.ellipsoids import WGS84
from vopd.job import Camera, Clock, Ignored, Job, Landmarks, Readings, Trajectory, Wind
from vopd.program.constants import eradkm, factor, ftpkm, vftpkm
from vopd.program.earth import SEA_LEVEL_KFT
from vopd.program.geocentric import LANDMARK_FOUR_PHI, ORIGIN_FOUR_PHI, geocentric
from vopd.synthetic import LIMITS, SPHERE_1974, Plan

if TYPE_CHECKING:
    from numpy.random import Generator


class RandomPart(IntEnum):
    """The parts of a flight that are random, each with its own stream of random numbers."""

    PATH = 0
    WIND = 1
    ATTITUDE = 2
    GROUND = 3
    FILM = 4


def random_stream(plan: Plan, part: RandomPart, which: int = 0) -> Generator:
    """Start the random numbers of one part of the flight, or of repeated reading `which`."""
    return np.random.default_rng([plan.seed, part, which])


# The trajectory over New Mexico: past its highest point, by parachute

ORIGIN_LATITUDE_DEG = 33.083333  # the origin of the report's case 1
ORIGIN_LONGITUDE_DEG = -106.3333
ORIGIN_RADIUS_KFT = 20925.698
GRAVITY_FT_S2 = 32.0
LAST_FRAME = 9_999  # four columns
FRAME_RATE = 32.0  # frames a second
FIRST_TIME_S = 40.0  # flight time of frame 0
MARGIN_S = 1.0  # of the trajectory table, on either side of the film
SHORTEST_S = 47.0  # film that the trajectory table has room for, at least
SLOWING_S = 12.0  # in which the speed over the ground falls to 1/e


def frame_numbers(plan: Plan) -> Ints:
    """Number the frames in the order of reading (F,): from 1 to 9,999, then from 1 again."""
    return 1 + np.arange(plan.frames, dtype=np.int64) % LAST_FRAME


def clock(plan: Plan) -> Clock:
    """Lay out the time table of group 6: two rows, before the first frame and after the last."""
    frame = np.array([0, min(plan.frames, LAST_FRAME) + 1], dtype=np.int64)
    return Clock(frame, FIRST_TIME_S + frame / FRAME_RATE)


def trajectory(plan: Plan, until_s: float) -> Trajectory:
    """Fly the trajectory of group 7, from before the first frame to after `until_s`.

    Numbers are rounded as the cards have them. The vehicle coasts over the top
    and sinks towards its speed v under the parachute, height =
    top - v tau ln cosh((t - t_top) / tau) with tau = v / g; its speed over the
    ground falls to the wind's. Altitudes are those of a sphere.
    """
    random = random_stream(plan, RandomPart.PATH)
    until_s = max(until_s, FIRST_TIME_S + SHORTEST_S)
    t = np.linspace(FIRST_TIME_S - MARGIN_S, until_s + MARGIN_S, plan.trajectory_rows)
    t = np.round(t, 4)
    sink, top = random.uniform(170.0, 205.0), random.uniform(140e3, 149e3)
    tau = sink / GRAVITY_FT_S2
    since_top = (t - FIRST_TIME_S - random.uniform(5.0, 15.0)) / tau
    up = top - sink * tau * np.log(np.cosh(since_top))
    sink_speed = sink * np.tanh(since_top)

    start = random.uniform([-20e3, -20e3], [20e3, 20e3])  # east, north
    launch = random.uniform([-900.0, -500.0], [-500.0, 500.0])
    drift = random.uniform([-40.0, -15.0], [-20.0, 15.0])
    flown = (t - FIRST_TIME_S)[:, None]
    left = np.exp(-flown / SLOWING_S)
    ground = start + drift * flown + (launch - drift) * SLOWING_S * (1.0 - left)
    ground_speed = drift + (launch - drift) * left

    position = np.column_stack([ground, up]).round(2)
    velocity = np.column_stack([ground_speed[:, ::-1], sink_speed]).round(3)
    sea_level = ORIGIN_RADIUS_KFT * 1000.0
    from_centre = np.linalg.norm(position + np.array([0.0, 0.0, sea_level]), axis=1)
    return Trajectory(
        time_s=t,
        position_ft=position,
        velocity_ft_s=velocity + 0.0,  # no minus zero
        altitude_ft=np.round(from_centre - sea_level, 1),
        origin_latitude_deg=ORIGIN_LATITUDE_DEG,
        origin_longitude_deg=ORIGIN_LONGITUDE_DEG,
        origin_radius_kft=ORIGIN_RADIUS_KFT,
    )


def position_ft(path: Trajectory, time_s: Floats) -> Floats:
    """Interpolate east, north, up of the origin, ft (F, 3), linearly between the table's rows."""
    return np.stack([np.interp(time_s, path.time_s, axis) for axis in path.position_ft.T], axis=1)


def wind(plan: Plan) -> Wind:
    """Blow the wind of group 4: from the east, stronger with height, in whole ft/s."""
    altitude = np.arange(70e3, 161e3, 10e3)
    phase = random_stream(plan, RandomPart.WIND).uniform(0.0, 6.0)
    toward_north = 20.0 * np.sin(altitude / 15e3 + phase)
    toward_east = -20.0 - 140.0 * ((altitude - 70e3) / 90e3) ** 2
    velocity = np.column_stack([toward_north, toward_east]).round()
    return Wind(altitude, velocity + 0.0)


# The attitude of the camera, which swings and cones below the parachute

AMPLITUDE = np.array([1.0, 0.6, 0.8])  # of yaw, pitch, roll, in units of `swing_deg`


def camera_swing(plan: Plan, time_s: Floats) -> tuple[Floats, Floats]:
    """Swing the camera: yaw, pitch and roll are each a slow and a fast sine about a mean.

    Together they make the camera cone. Yaw starts a little west of north and
    turns east through 360 degrees, so the film soon has frames whose yaw is 0 to
    6.28 degrees: the next frame starts from these, and from no others. The first
    estimate is the mean, in whole degrees.

    Args:
        plan: the flight
        time_s: times of the frames, s (F,)

    Returns:
        First estimate of yaw, pitch, roll for group 8, degrees (3,); and the true yaw 0 to 360,
        pitch, roll 0 to 360, degrees (F, 3).
    """
    random = random_stream(plan, RandomPart.ATTITUDE)
    mean = random.uniform([353.0, -56.0, 275.0], [359.0, -48.0, 290.0])
    slow = 2.0 * np.pi / random.uniform(5.0, 9.0, 3)
    fast = slow * random.uniform(2.2, 2.8, 3)
    fast_part = random.uniform(0.15, 0.3, 3)
    phase = np.array([0.0, 1.5, 3.0]) + random.uniform(-0.2, 0.2, (2, 3))
    flown = (time_s - FIRST_TIME_S)[:, None]
    swing = (1.0 - fast_part) * np.sin(slow * flown + phase[0])
    swing += fast_part * np.sin(fast * flown + phase[1])
    camera = mean + plan.swing_deg * AMPLITUDE * swing
    camera[:, [0, 2]] %= 360.0
    return np.round(mean), camera


# The camera: images of landmarks, and the ground that images show
#
# The camera model of TM X-3050, Appendix A, without its formulas. The optical
# axis points at azimuth sigma 1 and elevation sigma 2; image x and y lie across
# it, turned by sigma 3, with x to the left and y up when sigma 3 is zero. The
# vertical is the line to the Earth's centre, or on WGS 84 the ellipsoid's normal.

LENS_ROWS = 25


@dataclass(frozen=True)
class CameraView:
    """Position and axes of the camera in each frame, in Earth-fixed axes."""

    position_km: Floats  # (F, 3)
    axes: Floats  # (F, 3, 3): image x, image y and optical axis as rows

    def only(self, frames: np.ndarray | slice) -> CameraView:
        """Select some of the frames."""
        return CameraView(self.position_km[frames], self.axes[frames])


def view(
    path: Trajectory, position_ft: Floats, camera_deg: Floats, earth: str = SPHERE_1974
) -> CameraView:
    """Place the camera in Earth-fixed axes.

    Args:
        path: the trajectory, for its origin
        position_ft: east, north, up of the origin, ft (F, 3)
        camera_deg: yaw, pitch, roll of the camera, degrees (F, 3)
        earth: of `Plan`
    """
    origin_deg = np.array(path.origin_longitude_deg)
    if earth == SPHERE_1974:
        east, north, up = local_axes(
            origin_deg, geocentric(path.origin_latitude_deg, ORIGIN_FOUR_PHI)
        )
        centre, km_per_ft = up * (path.origin_radius_kft * 1000.0 / ftpkm), vftpkm
    else:
        east, north, up = local_axes(origin_deg, np.array(path.origin_latitude_deg))
        above_ft = np.array((path.origin_radius_kft - SEA_LEVEL_KFT) * 1000.0)
        centre = landmark_km(origin_deg, np.array(path.origin_latitude_deg), above_ft, earth)
        km_per_ft = 1.0 / ftpkm
    position = centre + (position_ft * km_per_ft) @ np.stack([east, north, up])
    longitude = np.degrees(np.arctan2(position[:, 1], position[:, 0]))
    latitude = np.arctan2(position[:, 2], np.hypot(position[:, 0], position[:, 1]))
    if earth != SPHERE_1974:
        latitude = geodetic_latitude(WGS84, position.T)
    local = np.stack(local_axes(longitude, np.degrees(latitude)), axis=1)  # (F, 3, 3) as rows
    return CameraView(position, camera_axes(camera_deg) @ local)


def local_axes(longitude_deg: Floats, latitude_deg: Floats) -> tuple[Floats, Floats, Floats]:
    """Resolve east, north, up (..., 3) at longitudes and latitudes of the vertical in degrees."""
    lon, lat = np.radians(longitude_deg), np.radians(latitude_deg)
    zero = np.zeros_like(lon)
    east = np.stack([-np.sin(lon), np.cos(lon), zero], axis=-1)
    up = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1)
    return east, np.cross(up, east), up


def camera_axes(camera_deg: Floats) -> Floats:
    """Turn the camera: image x, image y, optical axis as rows (F, 3, 3) in east, north, up."""
    yaw, pitch, roll = np.radians(camera_deg).T
    zero = np.zeros_like(yaw)
    flat = np.stack([np.sin(yaw), np.cos(yaw), zero], axis=-1)  # direction of sight on the map
    right = np.stack([np.cos(yaw), -np.sin(yaw), zero], axis=-1)
    vertical = np.array([0.0, 0.0, 1.0])
    cos, sin = np.cos(pitch)[:, None], np.sin(pitch)[:, None]
    axis, above = cos * flat + sin * vertical, cos * vertical - sin * flat
    cos, sin = np.cos(roll)[:, None], np.sin(roll)[:, None]
    return np.stack([sin * above - cos * right, cos * above + sin * right, axis], axis=1)


def lens_table(plan: Plan) -> tuple[Floats, Floats]:
    """Tabulate the lens of group 1: radii in mm, to beyond the corner, and distortions in µm."""
    corner = np.hypot(*plan.frame_in) / 2.0 * factor
    radius = np.linspace(0.0, 1.05 * corner, LENS_ROWS).round(3)
    return radius, (145.0 * (radius / radius[-1]) ** 1.5).round(1)


def images(plan: Plan, seen: CameraView, ground_km: Floats) -> tuple[Floats, Floats]:
    """Project points on the ground, with how steeply the camera looks at them.

    Args:
        plan: the flight
        seen: the camera in F frames
        ground_km: points (N, 3), the same in every frame, or (F, N, 3), Earth-fixed, km

    Returns:
        The images on the film reader, in (F, N, 2), NaN for points behind the camera; and the
        sine of the angle between the line of sight and the point's horizontal (F, N).
    """
    sight = ground_km - seen.position_km[:, None]
    x, y, depth = np.moveaxis(sight @ seen.axes.swapaxes(1, 2), -1, 0)
    depth = np.where(depth > 0.0, depth, np.nan)
    straight = plan.focal_length_mm * np.stack([x / depth, y / depth], axis=-1)
    size = np.linalg.norm(sight, axis=-1) * np.linalg.norm(ground_km, axis=-1)
    slope = -(sight * ground_km).sum(axis=-1) / size
    return np.array(plan.frame_in) / 2.0 + distorted(plan, straight) / factor, slope


def distorted(plan: Plan, straight_mm: Floats) -> Floats:
    """Distort images as the lens does, mm from the frame's centre (..., 2).

    The program corrects with the table's value at the measured radius; this is
    the inverse, exact because both are linear between the table's rows.
    """
    radius, distortion = lens_table(plan)
    straight = np.hypot(straight_mm[..., 0], straight_mm[..., 1])
    measured = np.interp(straight, radius + distortion / 1000.0, radius)
    return straight_mm * (measured / np.where(straight > 0.0, straight, 1.0))[..., None]


def seen_ground(plan: Plan, seen: CameraView, point_in: Floats, height_ft: Floats) -> Floats:
    """Trace undistorted images to points on the ground, which is a sphere.

    Args:
        plan: the flight
        seen: the camera in F frames
        point_in: images on the film reader, in (F, N, 2)
        height_ft: heights of the points above the sphere, ft (F, N)

    Returns:
        The points in Earth-fixed axes, km (F, N, 3); NaN where the line of sight misses the Earth.
    """
    film = (point_in - np.array(plan.frame_in) / 2.0) * factor / plan.focal_length_mm
    sight = np.concatenate([film, np.ones_like(film[..., :1])], axis=-1) @ seen.axes
    sight /= np.linalg.norm(sight, axis=-1, keepdims=True)
    camera = seen.position_km[:, None]
    along = (sight * camera).sum(axis=-1)
    radius = eradkm + height_ft / ftpkm
    with np.errstate(invalid="ignore"):
        reach = np.sqrt(along**2 - (camera**2).sum(axis=-1) + radius**2)
    return np.asarray(camera + (-along - reach)[..., None] * sight)


def landmark_km(
    longitude_deg: Floats, latitude_deg: Floats, height_ft: Floats, earth: str = SPHERE_1974
) -> Floats:
    """Place landmarks in Earth-fixed axes, km (..., 3): as the program does, or on WGS 84."""
    if earth != SPHERE_1974:
        latitude, longitude = np.radians(latitude_deg), np.radians(longitude_deg)
        return np.moveaxis(earth_centred(WGS84, latitude, longitude, height_ft / ftpkm), 0, -1)
    _, _, up = local_axes(longitude_deg, geocentric(latitude_deg, LANDMARK_FOUR_PHI))
    return up * (eradkm + height_ft / ftpkm)[:, None]


# Landmarks on the ground, so that every frame has enough of them in view

MOST = int(LIMITS["landmarks"][1])  # landmark numbers
STEP = 16  # only every 16th frame is considered first
AT_A_TIME = 600  # frames, where landmarks are placed
FRAMES_AT_A_TIME = 2000  # where landmarks in view are counted or chosen
POINTS = 1500  # to choose landmarks from
FLATTEST = np.sin(np.radians(8.0))  # of the flattest line of sight of a landmark

ZONES = np.array([[0.05, 0.4], [0.6, 0.95]])
"""Two zones of the frame, by x over its width; each has half of a frame's landmarks."""
IN_Y = (0.04, 0.96)
IN_X = (0.03, 0.97)


def place_landmarks(plan: Plan, seen: CameraView) -> Landmarks:
    """Place the landmarks of group 9, to the hundredth of a minute.

    Points in view of some frames are tried; the one that most frames need is
    taken, and so on until no frame lacks a landmark.

    Returns:
        The landmarks, those that most frames need first.

    Raises:
        VopdError: where 99 landmark numbers are not enough.
    """
    random = random_stream(plan, RandomPart.GROUND)
    chosen = _landmarks(np.zeros((0, 3)))
    lacking = np.arange(0, len(seen.axes), STEP)
    while len(lacking):
        some = seen.only(lacking[:: 1 + len(lacking) // AT_A_TIME])
        pool = _points(plan, some, random)
        before = len(chosen.number)
        chosen = _cover(plan, some, chosen, pool)
        if len(chosen.number) > MOST or len(chosen.number) == before:
            raise VopdError(
                f"{plan.landmarks} landmarks in each of {plan.frames} frames need more than "
                f"{MOST} landmark numbers: ask for fewer landmarks or frames, less swing or "
                "another camera"
            )
        lacking = np.flatnonzero((_needs(plan, seen, chosen) > 0).any(axis=1))
    return chosen


def points_km(marks: Landmarks, earth: str = SPHERE_1974) -> Floats:
    """Place the landmarks of group 9 on the Earth of a plan, km (N, 3)."""
    longitude = marks.longitude_deg + marks.longitude_min / 60.0
    latitude = marks.latitude_deg + marks.latitude_min / 60.0
    return landmark_km(longitude, latitude, marks.altitude_ft, earth)


def _points(plan: Plan, seen: CameraView, random: np.random.Generator) -> Landmarks:
    """Draw candidates for landmarks: random points in each zone of these frames."""
    count = -(-POINTS // (len(ZONES) * len(seen.axes)))
    shape = len(seen.axes), len(ZONES) * count
    low, high = np.repeat(ZONES, count, axis=0).T
    x = random.uniform(low, high, shape)
    y = random.uniform(*IN_Y, shape)
    height = np.round(random.uniform(3500.0, 6500.0, shape))
    point = seen_ground(plan, seen, np.stack([x, y], axis=-1) * plan.frame_in, height)
    latitude = np.degrees(np.arctan2(point[..., 2], np.hypot(point[..., 0], point[..., 1])))
    longitude = np.degrees(np.arctan2(point[..., 1], point[..., 0]))
    hit = np.isfinite(latitude)
    return _landmarks(np.column_stack([longitude[hit], _geodetic(latitude[hit]), height[hit]]))


def _geodetic(latitude_deg: Floats) -> Floats:
    """Invert the program's series: geodetic latitudes from geocentric ones."""
    geodetic = latitude_deg
    for _ in range(5):
        geodetic = geodetic + latitude_deg - geocentric(geodetic, LANDMARK_FOUR_PHI)
    return geodetic


def _landmarks(rows: Floats) -> Landmarks:
    """Round longitude, latitude, deg, and height, ft (N, 3), to landmarks as on the cards."""
    whole = np.trunc(rows[:, :2])
    minutes = np.round((rows[:, :2] - whole) * 60.0, 2)
    return Landmarks(
        number=np.arange(1, len(rows) + 1, dtype=np.int64),
        longitude_deg=whole[:, 0],
        longitude_min=minutes[:, 0],
        latitude_deg=whole[:, 1],
        latitude_min=minutes[:, 1],
        altitude_ft=rows[:, 2],
    )


def only(marks: Landmarks, which: Ints) -> Landmarks:
    """Select some of the landmarks and number them anew from 1."""
    columns = [getattr(marks, field.name)[which] for field in fields(marks)[1:]]
    return Landmarks(np.arange(1, len(which) + 1, dtype=np.int64), *columns)


def _cover(plan: Plan, seen: CameraView, chosen: Landmarks, pool: Landmarks) -> Landmarks:
    """Add landmarks of `pool` until these frames lack none, or more than `MOST` are needed."""
    need = _needs(plan, seen, chosen)
    helps = _zones(plan, seen, pool)
    added: list[int] = []
    while len(chosen.number) + len(added) <= MOST:
        gain = np.tensordot((need > 0).astype(np.float32), helps.astype(np.float32), 2)
        gain[added] = 0.0
        best = int(gain.argmax())
        if not gain[best]:
            break
        need = need - helps[..., best]
        added.append(best)
    columns = [
        np.concatenate([getattr(chosen, field.name), getattr(pool, field.name)[added]])
        for field in fields(chosen)[1:]
    ]
    return Landmarks(np.arange(1, len(columns[0]) + 1, dtype=np.int64), *columns)


def _needs(plan: Plan, seen: CameraView, marks: Landmarks) -> Ints:
    """Count the landmarks that each zone of each frame still lacks (F, 2)."""
    have = [
        _zones(plan, seen.only(slice(k, k + FRAMES_AT_A_TIME)), marks).sum(axis=2)
        for k in range(0, len(seen.axes), FRAMES_AT_A_TIME)
    ]
    return np.asarray(-(-plan.landmarks // len(ZONES)) - np.concatenate(have))


def _zones(plan: Plan, seen: CameraView, marks: Landmarks) -> Bools:
    """Find the landmarks in each zone of each frame (F, 2, N)."""
    image, slope = images(plan, seen, points_km(marks, plan.earth))
    image = image / plan.frame_in
    visible = slope > FLATTEST
    return np.stack([visible & in_view(image, (low, high)) for low, high in ZONES], axis=1)


def in_view(image: Floats, in_x: tuple[float, float]) -> Bools:
    """Find images (..., 2), as fractions of the frame's size, in view and between two x."""
    x, y = image[..., 0], image[..., 1]
    return np.asarray((x > in_x[0]) & (x < in_x[1]) & (y > IN_Y[0]) & (y < IN_Y[1]))


# Readings of the film: the landmarks of each frame, each read three times

CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])  # over the frame's size


def choose_landmarks(
    plan: Plan, seen: CameraView, marks: Landmarks
) -> tuple[Landmarks, Ints, Floats]:
    """Choose the landmarks that are read in each frame.

    The lowest number in view is read, then always the one farthest on the ground
    from those chosen: a landmark stays until one enters or leaves the frame.

    Returns:
        The landmarks that are read in any frame, numbered anew; the index of each frame's
        landmarks among them (F, L); and their images on the film reader, in (F, L, 2).
    """
    chunks = [
        seen.only(slice(k, k + FRAMES_AT_A_TIME))
        for k in range(0, len(seen.axes), FRAMES_AT_A_TIME)
    ]
    parts = [_choose_in_frames(plan, chunk, marks) for chunk in chunks]
    which, image = (np.concatenate(part) for part in zip(*parts, strict=True))
    read, index = np.unique(which, return_inverse=True)
    return only(marks, read), index.reshape(which.shape), image


def _choose_in_frames(plan: Plan, seen: CameraView, marks: Landmarks) -> tuple[Ints, Floats]:
    where = points_km(marks, plan.earth)
    image, slope = images(plan, seen, where)
    free = in_view(image / plan.frame_in, IN_X) & (slope > FLATTEST)
    apart = np.linalg.norm(where[:, None] - where, axis=-1)
    frames = np.arange(len(image))
    taken = [free.argmax(axis=1)]
    nearest = apart[taken[0]]
    for _ in range(1, plan.landmarks):
        taken.append(np.where(free, nearest, -1.0).argmax(axis=1))
        nearest = np.minimum(nearest, apart[taken[-1]])
    which = np.sort(np.stack(taken, axis=1), axis=1)
    return which, image[frames[:, None], which]


def read_film(plan: Plan, frame: Ints, landmark: Ints, image_in: Floats, time: int) -> Readings:
    """Read every point three times, in thousandths of an inch, with noise.

    Args:
        plan: the flight
        frame: frame numbers (F,)
        landmark: landmark numbers (F, L)
        image_in: images of the landmarks on the film reader, in (F, L, 2)
        time: how often this film was read before; each time has other noise
    """
    random = random_stream(plan, RandomPart.FILM, time)

    def read(point: Floats) -> Floats:
        three = np.repeat(point[:, :, None], 3, axis=2)
        noisy = three + plan.noise_in * random.standard_normal(three.shape)
        return np.asarray(np.round(noisy * 1000.0) / 1000.0 + 0.0)  # no minus zero

    corners = np.broadcast_to(CORNERS * plan.frame_in, (len(frame), 4, 2))
    return Readings.of(
        frame=frame,
        fiducial_in=read(corners),
        landmark=landmark,
        present=np.ones(landmark.shape, bool),
        landmark_in=read(image_in),
    )


# The jobs of the deck, and the true attitude

MULTIPLIER = np.ones(3)  # group 3, as in case 1
OFFSET_DEG = np.array([0.0, 0.0, -210.0])
RETURN_GROUPS = (12, 9, 8, 2)  # in turn: where the next job starts reading
STOP = 13
TITLE_OF = {SPHERE_1974: "", "wgs84": " ON WGS 84"}


@dataclass(frozen=True)
class Truth:
    """The true attitude and position of a synthetic flight, a row for each frame of the deck."""

    frame: Ints  # (F,)
    time_s: Floats  # (F,)
    camera_deg: Floats  # (F, 3) yaw 0..360, pitch, roll 0..360
    vehicle_deg: Floats  # (F, 3) the same by group 3
    position_ft: Floats  # (F, 3) east, north, up of the origin


def make(plan: Plan) -> tuple[list[Job], Truth]:
    """Make the jobs of a deck, all of the same flight, and its true attitude.

    The second job ignores landmark 1 (return group 12), the third does not (9),
    the fourth starts from another estimate (8), the fifth from the film read
    anew (2), and so on in turn.

    Returns:
        The jobs, ready for `write_deck`; and the truth.

    Raises:
        VopdError: where 99 landmark numbers are not enough.
    """
    number = frame_numbers(plan)
    times = clock(plan)
    time_s = np.interp(np.arange(1, number.max() + 1), times.frame, times.time_s)
    path = trajectory(plan, float(times.time_s[-1]))
    where = position_ft(path, time_s)
    estimate, camera_deg = camera_swing(plan, time_s)
    seen = view(path, where, camera_deg, plan.earth)
    marks, which, image = choose_landmarks(plan, seen, place_landmarks(plan, seen))

    def film(time: int) -> Readings:
        return read_film(plan, number, marks.number[which[number - 1]], image[number - 1], time)

    camera = Camera(
        plan.focal_length_mm, *lens_table(plan), MULTIPLIER, OFFSET_DEG, initial_deg=estimate
    )
    no_cards = np.zeros(0, np.int64), np.zeros((0, 6), np.int64)
    first = Job(
        title=f"1   SYNTHETIC FLIGHT {plan.seed}{TITLE_OF[plan.earth]}".ljust(80),
        camera=camera,
        trajectory=path,
        wind=wind(plan),
        clock=times,
        landmarks=marks,
        ignored=Ignored(*no_cards, everywhere=np.zeros_like(marks.number)),
        readings=film(0),
        return_group=STOP,
    )
    vehicle_deg = camera_deg * MULTIPLIER + OFFSET_DEG  # in range: roll stays above 210 degrees
    truth = Truth(number, *(a[number - 1] for a in (time_s, camera_deg, vehicle_deg, where)))
    return _stacked(first, plan.jobs, film), truth


def _stacked(first: Job, count: int, film: Callable[[int], Readings]) -> list[Job]:
    """Stack the jobs that follow the first by their return groups."""
    jobs = [first]
    for k in range(count - 1):
        group, job = RETURN_GROUPS[k % len(RETURN_GROUPS)], jobs[-1]
        jobs[-1] = replace(job, return_group=group)
        if group == 12:
            everywhere = np.where(job.landmarks.number == 1, 1, 0)
            job = replace(job, ignored=replace(job.ignored, everywhere=everywhere))
        else:
            job = replace(job, ignored=first.ignored)
        if group == 8:
            turned = job.camera.initial_deg + np.array([-3.0, 2.0, 3.0])
            job = replace(job, camera=replace(job.camera, initial_deg=turned))
        if group == 2:
            job = replace(job, camera=first.camera, readings=film(1 + k))
        jobs.append(job)
    return jobs


# The true attitude as a CSV table

COLUMNS = (
    *("frame", "time_s"),
    *("camera_yaw_deg", "camera_pitch_deg", "camera_roll_deg"),
    *("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg"),
    *("east_ft", "north_ft", "up_ft"),
)


def truth_csv(truth: Truth) -> str:
    """Write the true attitude as CSV: a header, then a line a frame, in seconds, degrees, feet."""
    angles = np.hstack([truth.camera_deg, truth.vehicle_deg])
    angles = np.where(np.round(angles, 6) == 360.0, 0.0, angles)  # as they are written
    columns = (truth.frame, truth.time_s, angles, truth.position_ft)
    line = ",".join(["%d", "%.5f", *["%.6f"] * 6, *["%.4f"] * 3]) + "\n"
    rows = np.column_stack(columns).tolist()
    return "".join([",".join(COLUMNS) + "\n", *(line % tuple(row) for row in rows)])
