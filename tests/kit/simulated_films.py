"""Films of known attitudes with random errors in everything a deck states, and their decks.

Many jobs are drawn at once; whatever is common to a job, such as an error of a landmark, is drawn
anew for every job. Nothing of the program is used: the geometry is that of the Earths below (metres
from the centre, x, y, z last) and of the definitions in Appendix A.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from tests.kit.wgs84_film import FOOT_M, MM_PER_INCH, ecef, geodetic
from vopd.job import Camera, Clock, Ignored, Job, Landmarks, Readings, Trajectory, Wind

# Earths


Array = np.ndarray
SEA_LEVEL_KFT = 20925.698  # group 8's RZ at sea level
LANDMARK_RADIUS_KM = 6378.165


class Earth(NamedTuple):
    """How a deck's numbers become positions: what its maker and the truth take the Earth to be."""

    place: Callable[[Array, Array, Array], Array]  # latitude, longitude, deg, altitude, ft -> m
    origin: Callable[[Array, Array, Array], Array]  # the same for group 8, by RZ in kft
    origin_axes: Callable[[Array, Array], Array]  # rows east, north, up at the origin
    camera_axes: Callable[[Array], Array]  # rows east, north, up at a position
    label: Callable[[Array], Array]  # position -> latitude, longitude, deg, as a map has them
    foot_m: float = FOOT_M  # of the vehicle's path


def east_north_up(longitude: Array, latitude: Array) -> Array:
    """Rows east, north, up (..., 3, 3), radians."""
    (st, sp), (ct, cp) = (f(np.array([longitude, latitude])) for f in (np.sin, np.cos))
    east = np.stack([-st, ct, 0.0 * st], axis=-1)
    up = np.stack([cp * ct, cp * st, sp], axis=-1)
    return np.stack([east, np.cross(up, east), up], axis=-2)


def _on_ellipsoid(latitude: Array, longitude: Array, altitude_ft: Array) -> Array:
    return np.moveaxis(ecef(latitude, longitude, altitude_ft * FOOT_M), 0, -1)


def _label(position: Array) -> Array:
    longitude, latitude = geodetic(np.moveaxis(position, -1, 0))
    return np.degrees(np.stack([latitude, longitude], axis=-1))


def _normal_axes(position: Array) -> Array:
    return east_north_up(*geodetic(np.moveaxis(position, -1, 0)))


def _central_axes(position: Array) -> Array:
    x, y, z = np.moveaxis(position, -1, 0)
    return east_north_up(np.arctan2(y, x), np.arctan2(z, np.hypot(x, y)))


WGS84 = Earth(
    place=_on_ellipsoid,
    origin=lambda phi, theta, kft: _on_ellipsoid(phi, theta, (kft - SEA_LEVEL_KFT) * 1000.0),
    origin_axes=lambda phi, theta: east_north_up(np.radians(theta), np.radians(phi)),
    camera_axes=_normal_axes,
    label=_label,
)
"""The Earth, with the ellipsoid's normal as the vertical."""

WGS84_CENTRAL = WGS84._replace(
    origin_axes=lambda phi, theta: _central_axes(_on_ellipsoid(phi, theta, 0.0 * phi)),
    camera_axes=_central_axes,
)
"""The Earth, with the vertical of 1974: away from its centre."""


def _geocentric_deg(latitude: Array, four_phi: float) -> Array:
    """The series of the listing."""
    two = 2.0 * np.radians(latitude)
    series = -0.1932398611111 * np.sin(two) + four_phi * np.sin(2.0 * two)
    return np.asarray(latitude + series + 7.2222222222e-7 * np.sin(3.0 * two))


def _on_sphere(latitude: Array, longitude: Array, radius_m: Array, four_phi: float) -> Array:
    phi, theta = np.radians(_geocentric_deg(latitude, four_phi)), np.radians(longitude)
    return np.asarray(radius_m)[..., None] * east_north_up(theta, phi)[..., 2, :]


def _label_1974(position: Array) -> Array:
    x, y, z = np.moveaxis(position, -1, 0)
    central = np.degrees(np.arctan2(z, np.hypot(x, y)))
    latitude = central
    for _ in range(5):
        latitude = latitude + central - _geocentric_deg(latitude, 3.2586e-5)
    return np.stack([latitude, np.degrees(np.arctan2(y, x))], axis=-1)


SPHERE_1974 = Earth(
    place=lambda phi, theta, ft: _on_sphere(
        phi, theta, LANDMARK_RADIUS_KM * 1000.0 + ft * FOOT_M, 0.0000325861111111
    ),
    origin=lambda phi, theta, kft: _on_sphere(
        phi, theta, kft * 1000.0 * FOOT_M, 0.0003258611111111
    ),
    origin_axes=lambda phi, theta: east_north_up(
        np.radians(theta), np.radians(_geocentric_deg(phi, 0.0003258611111111))
    ),
    camera_axes=_central_axes,
    label=_label_1974,
    foot_m=0.3048006,
)
"""The program's own Earth, its errata included: a faithful run errs in nothing else."""


# Films


Array = np.ndarray
FOCAL_MM = 10.4
LENS_MM = np.arange(25) * 0.5
LENS_UM = (4.0 * np.arange(25) + 0.3 * np.arange(25) ** 2).round(3)
HALF_MM = np.array([5.0, 3.7])  # half of a frame
CORNERS_IN = np.array([[-7.0, -5.0], [7.0, -5.0], [7.0, 5.0], [-7.0, 5.0]])
FRAME_S = 0.25
EARTH_FT = 2.0903e7


class Errors(NamedTuple):
    """Standard deviations of what goes wrong, 0 for nothing; which are common to a job."""

    reading_in: float = 0.0  # of a single reading on the reader
    identification_mm: float = 0.0  # of a landmark in a frame, common to its three readings
    fiducial_factor: float = 1.0  # readings of fiducials are so many times noisier
    landmark_ft: float = 0.0  # east, north, up; each landmark the same in the whole job
    position_ft: float = 0.0  # east, north, up; of every frame by itself
    focal_mm: float = 0.0  # one a job
    time_s: float = 0.0  # one a job
    velocity_ft_s: float = 0.0  # north, east, down; of every frame by itself
    wind_ft_s: float = 0.0  # north, east; one a job
    mount_deg: float = 0.0  # about forward, right, down; one a job


class Plan(NamedTuple):
    """What films to draw; ranges are uniform."""

    errors: Errors
    landmarks: int = 4
    poor: bool = False  # the landmarks in a strip of 2 by .4 mm
    jobs: int = 100
    frames: int = 12
    yaw_deg: tuple[float, float] = (0.0, 360.0)
    pitch_deg: tuple[float, float] = (-80.0, -50.0)
    roll_deg: tuple[float, float] = (0.0, 360.0)
    eta_deg: tuple[float, float] = (10.0, 30.0)  # total angle of attack, before the jitter
    jitter_deg: tuple[float, float, float] = (2.0, 2.0, 20.0)  # of the camera from frame to frame
    acceleration_ft_s2: float = 10.0  # standard deviation, north, east, down; one a job
    jump_deg: float = 0.0  # by which pitch is off in the middle frame of a job
    earth: Earth = WGS84
    decimals: int | None = 3  # of the readings, in


class SimulatedFilms(NamedTuple):
    """J jobs of F frames and L landmarks: what their decks state, and the true angles."""

    plan: Plan
    truth_deg: Array  # (J, F, 9) camera, vehicle, alpha, beta, eta
    multiplier: Array  # (J, 3)
    offset_deg: Array  # (J, 3)
    time_s: Array  # (F,)
    position_ft: Array  # (J, F, 3) east, north, up of the origin
    velocity_ft_s: Array  # (J, F, 3) north, east, down
    wind_ft_s: Array  # (J, 2) toward north, east
    origin: Array  # (J, 3) latitude, longitude, deg, RZ, kft
    latitude_min: Array  # (J, L) of the landmarks
    longitude_min: Array  # (J, L)
    altitude_ft: Array  # (J, L)
    fiducial_in: Array  # (J, F, 4, 3, 2)
    landmark_in: Array  # (J, F, L, 3, 2)
    seen: Array  # (J, F, L) which landmarks are read


def camera_matrix(angles_deg: Array) -> Array:
    """Rows of the image axes x, y and of the optical axis in east, north, up, (..., 3, 3).

    With no roll x points left of the axis, level; y completes x, y, axis.
    """
    s, p, r = np.moveaxis(np.radians(angles_deg), -1, 0)
    axis = np.stack([np.sin(s) * np.cos(p), np.cos(s) * np.cos(p), np.sin(p)], axis=-1)
    left = np.stack([-np.cos(s), np.sin(s), 0.0 * s], axis=-1)
    above = np.cross(axis, left)
    c, d = np.cos(r)[..., None], np.sin(r)[..., None]
    return np.stack([c * left + d * above, c * above - d * left, axis], axis=-2)


def body_to_ned(angles_deg: Array) -> Array:
    """Columns forward, right, down in north, east, down (..., 3, 3), by yaw, pitch, roll."""
    turn = Rotation.from_euler("ZYX", angles_deg.reshape(-1, 3), degrees=True)
    return np.asarray(turn.as_matrix()).reshape(*angles_deg.shape, 3)


def angles_of(body_to_ned: Array) -> Array:
    """Yaw, pitch, roll of such columns; pitch -90 to 90."""
    turn = Rotation.from_matrix(body_to_ned.reshape(-1, 3, 3))
    return turn.as_euler("ZYX", degrees=True).reshape(*body_to_ned.shape[:-2], 3)


def uncorrected(ideal_mm: Array) -> Array:
    """Where the film shows what the lens correction takes to these points."""
    ideal = np.linalg.norm(ideal_mm, axis=-1, keepdims=True)
    radius = ideal
    for _ in range(40):
        radius = ideal - np.interp(radius, LENS_MM, LENS_UM) / 1000.0
    return np.asarray(ideal_mm * radius / ideal)


def simulate(plan: Plan, seed: int) -> SimulatedFilms:
    """Draw the films of a plan.

    Args:
        plan: what to draw
        seed: of the random numbers
    """
    rng = np.random.default_rng(seed)
    e, jobs = plan.errors, plan.jobs
    origin = np.stack([
        rng.uniform(-60.0, 60.0, jobs).round(4), rng.uniform(-175.0, 175.0, jobs).round(4),
        (SEA_LEVEL_KFT + rng.uniform(0.0, 5.0, jobs)).round(3),
    ], axis=1)  # fmt: skip
    flight = _flight(plan, rng)
    axes = plan.earth.origin_axes(origin[:, 0], origin[:, 1])
    start = plan.earth.origin(*origin.T)
    true_ft, velocity = flight.at(flight.late_s)
    camera_m = start[:, None] + true_ft * plan.earth.foot_m @ axes
    labels = _landmarks(plan, rng, flight, camera_m)
    marks_m = plan.earth.place(labels[..., 0] / 60.0, labels[..., 1] / 60.0, labels[..., 2])
    away = marks_m[:, None] - camera_m[:, :, None]
    local = away @ plan.earth.camera_axes(camera_m).swapaxes(-1, -2)
    x, y, z = np.moveaxis(local @ camera_matrix(flight.camera_deg).swapaxes(-1, -2), -1, 0)
    focal = FOCAL_MM + rng.normal(0.0, e.focal_mm, (jobs, 1, 1, 1))
    assert (z > 0.0).all()
    film = uncorrected(focal * np.stack([x / z, y / z], axis=-1))
    film += rng.normal(0.0, e.identification_mm, film.shape)
    fiducial_in, landmark_in = _read(plan, rng, film)
    stated_ft, _ = flight.at(np.zeros((jobs, 1)))
    attack = _attack_deg(flight.vehicle_deg, velocity, flight.wind)
    moved = rng.normal(0.0, e.landmark_ft, labels.shape)
    minutes = np.degrees(moved[..., :2] / EARTH_FT) * 60.0
    minutes[..., 1] /= np.cos(np.radians(labels[..., 0] / 60.0))
    noise = rng.normal(0.0, 1.0, (2, *velocity.shape))
    at_stated = velocity - flight.acceleration[:, None] * flight.late_s[..., None]
    return SimulatedFilms(
        plan=plan,
        truth_deg=np.concatenate([flight.camera_deg, flight.vehicle_deg, attack], axis=-1),
        multiplier=flight.multiplier,
        offset_deg=flight.offset_deg,
        time_s=flight.time_s,
        position_ft=(stated_ft + e.position_ft * noise[0]).round(2),
        velocity_ft_s=(at_stated + e.velocity_ft_s * noise[1]).round(3),
        wind_ft_s=(flight.wind + rng.normal(0.0, e.wind_ft_s, flight.wind.shape)).round(2),
        origin=origin,
        latitude_min=(labels[..., 0] + minutes[..., 0]).round(5),
        longitude_min=(labels[..., 1] + minutes[..., 1]).round(5),
        altitude_ft=(labels[..., 2] + moved[..., 2]).round(2),
        fiducial_in=fiducial_in,
        landmark_in=landmark_in,
        seen=np.ones(landmark_in.shape[:3], bool),
    )


class _Flight(NamedTuple):
    """The true flights: angles of the frames, and paths of constant acceleration."""

    base_deg: Array  # (J, 3) of the camera without jitter
    camera_deg: Array  # (J, F, 3)
    vehicle_deg: Array  # (J, F, 3)
    multiplier: Array
    offset_deg: Array
    time_s: Array  # (F,) as stated
    late_s: Array  # (J, 1) how much later a frame was taken
    start_ft: Array  # (J, 3) east, north, up
    velocity: Array  # (J, 3) north, east, down
    acceleration: Array  # (J, 3)
    wind: Array  # (J, 2)

    def at(self, late_s: Array) -> tuple[Array, Array]:
        """Position, east, north, up, and velocity, north, east, down, so late, (J, F, 3)."""
        s = (self.time_s - self.time_s[0] + late_s)[..., None]
        v, a = self.velocity[:, None], self.acceleration[:, None]
        way = v * s + a * s**2 / 2.0
        return self.start_ft[:, None] + way[..., [1, 0, 2]] * [1.0, 1.0, -1.0], v + a * s


def _flight(plan: Plan, rng: np.random.Generator) -> _Flight:
    """Draw attitudes, mounting, and a velocity that meets the asked total angle of attack."""
    jobs, frames = plan.jobs, plan.frames
    base = np.stack(
        [rng.uniform(*r, jobs) for r in (plan.yaw_deg, plan.pitch_deg, plan.roll_deg)], axis=1
    )
    camera = base[:, None] + rng.uniform(-1.0, 1.0, (jobs, frames, 3)) * plan.jitter_deg
    aft = rng.random(jobs)[:, None] < 0.5
    multiplier = np.where(aft, [1.0, -1.0, -1.0], [1.0, 1.0, 1.0])
    offset = np.where(aft, [180.0, 0.0, 90.0], [0.0, 0.0, -210.0])
    forward = body_to_ned(multiplier * base + offset)
    eta, around = np.radians(rng.uniform(*plan.eta_deg, jobs)), rng.uniform(0.0, 2 * np.pi, jobs)
    mount = Rotation.from_rotvec(rng.normal(0.0, plan.errors.mount_deg, (jobs, 3)), degrees=True)
    relative = np.stack(
        [np.cos(eta), np.sin(eta) * np.cos(around), np.sin(eta) * np.sin(around)], axis=1
    )
    relative = np.einsum("jab,jb->ja", forward, relative * rng.uniform(400.0, 900.0, (jobs, 1)))
    wind = rng.normal(0.0, 60.0, (jobs, 2))
    relative[:, :2] += wind
    camera[:, frames // 2, 1] += plan.jump_deg
    camera[..., ::2] %= 360.0
    vehicle = multiplier[:, None] * camera + offset[:, None]
    if plan.errors.mount_deg:
        vehicle = angles_of(body_to_ned(vehicle) @ mount.as_matrix()[:, None])
    return _Flight(
        base_deg=base,
        camera_deg=camera,
        vehicle_deg=vehicle,
        multiplier=multiplier,
        offset_deg=offset,
        time_s=100.0 + FRAME_S * np.arange(frames),
        late_s=rng.normal(0.0, plan.errors.time_s, (jobs, 1)),
        start_ft=rng.uniform([-5e3, -5e3, 1e5], [5e3, 5e3, 1.5e5], (jobs, 3)),
        velocity=relative,
        acceleration=rng.normal(0.0, plan.acceleration_ft_s2, (jobs, 3)),
        wind=wind,
    )


def _landmarks(plan: Plan, rng: np.random.Generator, flight: _Flight, camera_m: Array) -> Array:
    """True landmarks (J, L, 3): latitude and longitude in minutes, altitude in feet.

    They stand where the middle frame of the job, without its jitter, shows good or poor
    geometry. The minutes have the decimals that cards hold.
    """
    jobs, count = plan.jobs, plan.landmarks
    if plan.poor:
        strip = rng.uniform(-1.0, 1.0, (jobs, count, 2)) * [0.3, 0.2]
        strip[..., 0] += np.linspace(-0.7, 0.7, count)
        turn, away = rng.uniform(0.0, 2 * np.pi, (2, jobs, 1))
        c, s = np.cos(turn), np.sin(turn)
        image = np.stack([c * strip[..., 0] - s * strip[..., 1],
                          s * strip[..., 0] + c * strip[..., 1]], axis=-1)  # fmt: skip
        image = image + 2.5 * np.stack([np.cos(away), np.sin(away)], axis=-1)
    else:
        angle = 2 * np.pi * (np.arange(count) / count + rng.random((jobs, 1)))
        angle = angle + rng.uniform(-1.0, 1.0, (jobs, count)) / count
        size = rng.uniform(0.5, 1.0, (jobs, count, 1))
        image = HALF_MM * size * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    middle = plan.frames // 2
    from_m, look = camera_m[:, middle], flight.base_deg
    ray = np.concatenate([image, np.full((*image.shape[:2], 1), FOCAL_MM)], axis=-1)
    ray = ray @ camera_matrix(look)
    altitude_ft = rng.uniform(0.0, 3000.0, (jobs, count)).round()
    drop_m = (flight.start_ft[:, None, 2] - altitude_ft) * FOOT_M
    reach = drop_m / np.maximum(-ray[..., 2], 0.1 * FOCAL_MM)
    point = from_m[:, None] + (ray * reach[..., None]) @ plan.earth.camera_axes(from_m)
    minutes = (plan.earth.label(point) * 60.0).round(5)
    return np.concatenate([minutes, altitude_ft[..., None]], axis=-1)


def _read(plan: Plan, rng: np.random.Generator, film_mm: Array) -> tuple[Array, Array]:
    """The readings of fiducials and landmarks, inches, of a frame that lies anyhow."""
    frames, sigma = film_mm.shape[:2], plan.errors.reading_in
    centre = np.array([7.2, 5.2]) + rng.uniform(-0.1, 0.1, (*frames, 1, 2))
    true = (np.broadcast_to(centre + CORNERS_IN, (*frames, 4, 2)), centre + film_mm / MM_PER_INCH)
    found = []
    for points, factor in zip(true, (plan.errors.fiducial_factor, 1.0), strict=True):
        noise = rng.normal(0.0, sigma * factor, (*points.shape[:3], 3, 2))
        read = points[..., None, :] + noise
        found.append(read if plan.decimals is None else read.round(plan.decimals))
    return found[0], found[1]


def _attack_deg(vehicle_deg: Array, velocity: Array, wind: Array) -> Array:
    """Alpha, beta, eta (J, F, 3) by the definitions."""
    relative = velocity.copy()
    relative[..., :2] -= wind[:, None]
    u, v, w = np.moveaxis((relative[..., None, :] @ body_to_ned(vehicle_deg))[..., 0, :], -1, 0)
    return np.degrees(
        np.stack([np.arctan2(w, u), np.arctan2(v, u), np.arctan2(np.hypot(v, w), u)], axis=-1)
    )


# Decks of films


TOP_FT = 300000.0


def job_of(films: SimulatedFilms, k: int) -> Job:
    """The k-th job, made of arrays."""
    last = k == len(films.origin) - 1
    frames, count = films.landmark_in.shape[1:3]
    number, landmark = np.arange(frames) + 1, np.arange(count) + 11
    path, origin = films.position_ft[k], films.origin[k]
    minutes = [a[k] for a in (films.longitude_min, films.latitude_min)]
    whole = [np.trunc(m / 60.0) for m in minutes]
    rest = [(m - 60.0 * w).round(5) for m, w in zip(minutes, whole, strict=True)]
    return Job(
        title="1SIMULATED".ljust(80),
        camera=Camera(
            FOCAL_MM, LENS_MM, LENS_UM, films.multiplier[k], films.offset_deg[k],
            films.truth_deg[k, 0, :3].round(3),
        ),
        trajectory=Trajectory(
            films.time_s, path, films.velocity_ft_s[k], path[:, 2], *origin.tolist()
        ),
        wind=Wind(np.array([0.0, TOP_FT]), np.tile(films.wind_ft_s[k], (2, 1))),
        clock=Clock(np.array([1, frames + 1]), films.time_s[0] + FRAME_S * np.array([0.0, frames])),
        landmarks=Landmarks(landmark, whole[0], rest[0], whole[1], rest[1], films.altitude_ft[k]),
        ignored=Ignored(np.zeros(0, int), np.zeros((0, 6), int), np.zeros(count, int)),
        readings=Readings.of(
            frame=number,
            fiducial_in=films.fiducial_in[k],
            landmark=np.tile(landmark, (frames, 1)),
            present=films.seen[k],
            landmark_in=films.landmark_in[k],
        ),
        return_group=13 if last else 1,
    )  # fmt: skip


def jobs_of(films: SimulatedFilms) -> list[Job]:
    """All jobs, made of arrays."""
    return [job_of(films, k) for k in range(len(films.origin))]


def deck_of(films: SimulatedFilms) -> str:
    """All jobs as one deck of cards, punched after Appendix F and the FORMATs of the listing."""
    cards = [card for k in range(len(films.origin)) for card in _cards(job_of(films, k))]
    return "\n".join(cards) + "\n"


def _row(*values: float, width: int = 10) -> str:
    return "".join(_real(value, width) for value in values)


def _real(value: float, width: int) -> str:
    """A number with its point punched, at the right edge of its columns."""
    text = repr(round(float(value), 6))
    assert len(text) < width and "e" not in text, text
    return text.rjust(width)


def _whole(values: list[int]) -> Iterator[str]:
    """Whole numbers, sixteen a card."""
    for k in range(0, len(values), 16):
        yield "".join(f"{value:5d}" for value in values[k : k + 16])


def _cards(job: Job) -> Iterator[str]:
    camera, path, marks = job.camera, job.trajectory, job.landmarks
    frames, count = job.readings.landmark.shape
    for pair in zip(LENS_MM, LENS_UM, strict=True):
        yield _row(*pair)
    yield "1SIMULATED"
    mounting = np.stack([camera.multiplier, camera.offset_deg], axis=1).ravel()
    yield f"{frames:5d}{2:5d}" + "".join(f"{v:.0f}.".rjust(5) for v in mounting)
    for altitude, wind in zip(job.wind.altitude_ft, job.wind.velocity_ft_s, strict=True):
        yield _row(altitude, *wind)
    yield from _whole([count, frames, 2, *job.readings.present.sum(axis=1).tolist()])
    for number, time_s in zip(job.clock.frame, job.clock.time_s, strict=True):
        yield f"{number:5d}{_real(time_s, 10)}"
    for row in zip(
        path.time_s, path.position_ft, path.velocity_ft_s, path.altitude_ft, strict=True
    ):
        yield _row(row[0], *row[1], *row[2], row[3])
    yield _row(
        FOCAL_MM, path.origin_latitude_deg, path.origin_longitude_deg,
        path.origin_radius_kft, *camera.initial_deg,
    )  # fmt: skip
    for row in zip(
        marks.number, marks.longitude_deg, marks.longitude_min, marks.latitude_deg,
        marks.latitude_min, marks.altitude_ft, strict=True,
    ):  # fmt: skip
        yield f"{row[0]:10d}" + _row(*row[1:])
    yield f"{0:5d}"
    yield from _whole([job.return_group, *[0] * count])
    yield from _basic_data(job)


def _basic_data(job: Job) -> Iterator[str]:
    """The film reader's cards: thousandths of an inch without a point."""
    r = job.readings
    for k, frame in enumerate(r.frame):
        points = np.concatenate([r.fiducial_in[k], r.landmark_in[k][r.present[k]]])
        numbers = [0] * 4 + r.landmark[k][r.present[k]].tolist()
        for number, three in zip(numbers, points, strict=True):
            for x, y in (three * 1000.0).round().astype(int):
                yield f"{'':8}{number:02d}{'':30}{x:7d}   {y:7d}      {frame:4d}"
