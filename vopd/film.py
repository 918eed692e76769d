"""The estimate of a deck's job: angles, residuals, partials and gain of every frame."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints, distinct_in_rows
from vopd.errata import Fix, Fixes
from vopd.estimate import (
    About,
    Block,
    Estimate,
    FrameStatus,
    Position,
    Responses,
    Units,
    Vertical,
    Words,
)
from vopd.findings import VopdError
from vopd.geometry.earth import (
    M_PER_KM,
    earth_centred,
    earth_centred_m,
    east_north_up,
    geodetic,
    geodetic_latitude,
    local_axes,
)
from vopd.geometry.ellipsoids import ELLIPSOIDS
from vopd.geometry.linear import inverse, singular_values
from vopd.geometry.rotations import camera_axes, turns_by_body_angles
from vopd.job import Job
from vopd.program.alpbet import alpbet
from vopd.program.constants import factor, ftpkm, rad
from vopd.program.frames import WIND_ALTITUDES
from vopd.program.ftlup import Tables, ftlup_each
from vopd.program.orient import Sight, equations
from vopd.program.positions import (
    TRAJECTORY_TIMES,
    directions,
    earth_fixed,
    group_9,
    origin_of,
)
from vopd.program.vopd import radial_factor, run_jobs
from vopd.results import Outcome, Results, SolvedJob

if TYPE_CHECKING:
    from vopd.scene import JobScene

DOWN_1974 = "toward the Earth's centre (as in 1974)"
TOGETHER = 4000  # frames
SINGULAR = 1e-14  # of the singular values of P'B, squares of the partials' own

STATUS = {
    Outcome.SOLVED: FrameStatus.SOLVED,
    Outcome.DROPPED: FrameStatus.IGNORED,
    Outcome.EXACT: FrameStatus.EXACT,
    Outcome.EXACT_LATE: FrameStatus.EXACT,
    Outcome.STOPPED: FrameStatus.STOPPED,
}


def film_estimate(
    results: Results, source: str = "", job: int = 1, whole: Job | None = None
) -> Estimate:
    """Make the estimate of one job of a deck, for `vopd.attitude`.

    Args:
        results: one job as `vopd.program.vopd.run` solved it
        source: the deck's name, for tables and files
        job: the job's number in its deck, from 1
        whole: the job with all its frames, where `results` has only some of them
    """
    (estimate,) = _estimates([(SolvedJob(source, job, results), whole or results.job)])
    return estimate


def estimates_of_jobs(jobs: Sequence[SolvedJob]) -> list[list[Block]]:
    """Make the estimates of many jobs; short jobs together are faster than one after the other.

    Args:
        jobs: solved jobs, all with the same fixes

    Returns:
        The blocks of every job: frames with like numbers of landmarks.
    """
    blocks = [one.results.layout.blocks() for one in jobs]
    made: list[Estimate] = []
    some: list[Part] = []
    count = 0
    for one, of_job in zip(jobs, blocks, strict=True):
        for frames in of_job:
            results = one.results if len(of_job) == 1 else one.results.as_job(frames)
            some.append((replace(one, results=results), one.results.job))
            count += len(frames)
            if count >= TOGETHER:
                made += _estimates(some)
                some, count = [], 0
    made += _estimates(some)
    each = iter(made)
    jobs_blocks = [[(frames, next(each)) for frames in of_job] for of_job in blocks]
    return [one if len(one) == 1 else _with_one_scene(one) for one in jobs_blocks]


def _with_one_scene(blocks: list[Block]) -> list[Block]:
    """Describe the surroundings of all frames of a job in each of its blocks."""
    scene = partial(_scene_of_blocks, blocks)
    return [(frames, replace(estimate, scene=scene)) for frames, estimate in blocks]


def _scene_of_blocks(blocks: Sequence[Block]) -> JobScene:
    """Join the surroundings of a job's blocks, in the order of its frames."""
    every = [estimate.scene() for _, estimate in blocks if estimate.scene is not None]
    order = np.concatenate([frames for frames, _ in blocks])
    camera_m = np.concatenate([one.camera_m for one in every])[np.argsort(order)]
    where = {
        int(number): (block, int(place))
        for block, (frames, estimate) in enumerate(blocks)
        for number, place in zip(estimate.frame, frames, strict=True)
    }

    def sight(frame: int, name: str) -> tuple[Ints, Floats]:
        return every[where[frame][0]].sight(frame, name)

    def film(indices: Ints) -> tuple[Floats, Floats, Floats]:
        corners, axes = np.empty((len(indices), 4, 2)), np.empty((len(indices), 3, 3))
        places = np.empty((len(indices), len(every[0].names), 2))
        for (frames, _), one in zip(blocks, every, strict=True):
            here = np.isin(indices, frames)
            assert one.film is not None
            if here.any():
                own = np.searchsorted(frames, indices[here])
                corners[here], places[here], axes[here] = one.film(own)
        return corners, places, axes

    return replace(
        every[0], camera_m=camera_m, index=lambda frame, _: where[frame][1], sight=sight, film=film
    )


Part = tuple[SolvedJob, Job]
"""Some frames of a job as they were solved, and the job with all its frames."""


def _estimates(parts: Sequence[Part]) -> list[Estimate]:
    """Make estimates: those of one largest number of landmarks together, in one array."""
    alike: dict[int, list[int]] = {}
    for k, (one, _) in enumerate(parts):
        alike.setdefault(one.results.layout.widest, []).append(k)
    made: dict[int, Estimate] = {}
    for indices in alike.values():
        made |= zip(indices, _joined_estimates([parts[k] for k in indices]), strict=True)
    estimates = [made[k] for k in range(len(parts))]
    determined = [np.asarray(np.isfinite(one.gain).all(axis=(1, 2))) for one in estimates]
    effects = slip_effects_deg([one.results for one, _ in parts], determined)
    pairs = zip(estimates, effects, strict=True)
    return [replace(one, slip_effect_deg=effect) for one, effect in pairs]


def sight_of(results: Results, focal_length_mm: Floats) -> Sight:
    """Rebuild the input of the solve that gave some results, by landmark and frame.

    Args:
        results: frames of one job or of several
        focal_length_mm: of every frame (F,)
    """
    layout, points = results.layout, results.points
    away = points.point_mm - results.centre_mm[layout.frame]
    image = radial_factor(points.radius_mm, points.distortion_mm)[:, None] * away

    def arranged(values: Floats) -> Floats:
        return np.ascontiguousarray(layout.padded(values, np.nan).T)

    xlam, xmu, xnu = (arranged(points.direction[:, k]) for k in range(3))
    used = np.ascontiguousarray(layout.padded(points.used).T)
    xmu1 = xmu
    if Fix.FIRST_LANDMARK not in results.fixes and len(used):
        first = np.take_along_axis(xmu1, used.argmax(axis=0)[None], axis=0)
        xmu1 = np.broadcast_to(first, used.shape)
    x, y = arranged(image[:, 0]), arranged(image[:, 1])
    return Sight((xlam, xmu, xnu), x, y, xmu1, used, focal_length_mm)


@np.errstate(all="ignore")
def _joined_estimates(parts: Sequence[Part]) -> list[Estimate]:
    """Make the estimates of some jobs in one array.

    The partials B are the correct ones of the computed coordinates by the camera's
    yaw, pitch, roll. The gain is what the solve makes of a change of the residuals,
    (P'B)^-1 P' with the partials P of the run: with the erratum `first-landmark` in
    it the run ends where P'(residuals) is zero, which is not quite least squares.
    """
    joined = joined_jobs([one.results for one, _ in parts])
    results = joined.results
    seen = sight_of(results, joined.focal_length_mm)
    radians = results.camera_deg / rad
    _, of_run = equations(radians.T, seen)
    residual, correct = equations(radians.T, seen._replace(xmu1=seen.dircos[1]))
    partials = -columns(correct)
    gain = _gain(-columns(of_run), partials, results)
    vehicle_by_camera = np.zeros((len(results.frame), 3, 3))
    vehicle_by_camera[:, range(3), range(3)] = joined.multiplier
    body_turns = turns_by_body_angles(np.radians(results.vehicle_deg)) @ vehicle_by_camera
    together = Estimate(
        about=_about(parts[0][0]),
        units=Units(),
        frame=results.frame,
        status=_status(results.outcome),
        solved=results.solved,
        converged=results.converged,
        correction_rad=results.correction_rad,
        time_s=results.time_s,
        position=position(joined),
        displacement=results.vehicle_ft,
        camera_deg=results.camera_deg,
        vehicle_deg=results.vehicle_deg,
        vehicle_by_camera=vehicle_by_camera,
        attack_deg=np.stack([results.alpha_deg, results.beta_deg, results.eta_deg], axis=1),
        airspeed=results.airspeed_ft_s,
        landmark=results.landmark,
        used=results.used,
        ignored=results.ignored,
        direction=results.direction,
        image=np.stack([seen.x.T, seen.y.T], axis=-1),
        residual=flat(residual),
        partials=partials,
        gain=gain,
        body_gain=body_turns @ gain,
        responses=responses(joined, seen, radians),
        relative_sigma=np.ones(results.used.shape),
        focal_length=np.nan,
        reading_spread=np.nan,
        reading_floor=np.nan,
        extrapolated={
            "time": results.outside_clock,
            "trajectory": results.outside_trajectory,
            "wind": results.outside_wind & results.solved,
        },
    )
    noises = reading_noises([whole for _, whole in parts])
    estimates = [
        replace(
            together.take(frames),
            about=_about(one),
            focal_length=whole.camera.focal_length_mm,
            reading_spread=spread_mm,
            reading_floor=resolution_mm,
            fiducial_sigma=fiducial_mm,
        )
        for (one, whole), frames, (spread_mm, resolution_mm, fiducial_mm) in zip(
            parts, joined.frames, noises, strict=True
        )
    ]
    return [
        replace(one, scene=partial(deck_scene, one, job, results.fixes))
        for one, (_, job) in zip(estimates, parts, strict=True)
    ]


def deck_scene(estimate: Estimate, job: Job, fixes: Fixes) -> JobScene:
    """Describe the surroundings of a job's frames, for figures.

    Positions are drawn on WGS 84: their latitudes, longitudes and altitudes are those of the
    cards. Places on the film are those of the run's own Earth.
    """
    marks, where = job.landmarks, estimate.position
    metres = estimate.units.metres_per_length
    number = marks.number.tolist()
    index = {one: k for k, one in enumerate(number)}

    def index_of(frame: int, _: str) -> int:
        return int(np.flatnonzero(estimate.frame == frame)[0])

    def sight(frame: int, _: str) -> tuple[Ints, Floats]:
        k = index_of(frame, "")
        here = np.flatnonzero(estimate.used[k])
        axes = camera_axes(np.radians(estimate.camera_deg[[k]]))[0]
        focal = np.full((len(here), 1), estimate.focal_length)
        ray = np.hstack([estimate.image[k, here], focal])
        with np.errstate(all="ignore"):  # of a focal length of 0 there is none
            ray /= np.linalg.norm(ray, axis=1, keepdims=True)
        known = np.isfinite(ray).all(axis=1)
        here, ray = here[known], ray[known]
        north, east, down = where.north_east_down[k]
        own = np.array([index[one] for one in estimate.landmark[k, here].tolist()], dtype=np.int64)
        return own, ray @ axes @ np.stack([east, north, -down])

    @np.errstate(all="ignore")
    def film(indices: Ints) -> tuple[Floats, Floats, Floats]:
        read = {int(one): k for k, one in enumerate(job.readings.frame)}
        own = [read[int(one)] for one in estimate.frame[indices]]
        corner = job.readings.fiducial_in[own].mean(axis=2) * factor
        corner -= corner.mean(axis=1, keepdims=True)
        around = np.argsort(np.arctan2(corner[..., 1], corner[..., 0]), axis=1)
        each = (len(indices), len(number))
        thj, phij, rj = (np.broadcast_to(one, each) for one in group_9(marks, fixes))
        vehicle_ft = estimate.displacement[indices]
        toward = directions(origin_of(job), fixes, vehicle_ft, thj, phij, rj)
        axes = camera_axes(np.radians(estimate.camera_deg[indices]))
        place = FilmView(axes, estimate.focal_length).pixel_of(toward)
        return np.take_along_axis(corner, around[..., None], axis=1), place, axes

    from vopd.scene import FilmView, JobScene

    return JobScene(
        tuple(map(str, number)),
        earth_centred_m(
            marks.latitude_deg + marks.latitude_min / 60.0,
            marks.longitude_deg + marks.longitude_min / 60.0,
            marks.altitude_ft * metres,
        ),
        np.zeros(len(number), bool),
        earth_centred_m(where.latitude_deg, where.longitude_deg, where.altitude * metres),
        index_of,
        sight,
        film=film,
    )


def _about(one: SolvedJob) -> About:
    results = one.results
    title = results.job.title[1:].strip()  # column 1 is the printer's carriage control
    about = About(one.source, one.number, title, str(results.fixes), DOWN_1974, DECK_WORDS)
    if Fix.EARTH in results.fixes:
        about = about._replace(down=f"along the normal of {results.fixes.ellipsoid.label}")
    return about


def _status(outcome: Ints) -> Ints:
    return np.array([STATUS[one] for one in Outcome])[outcome]


def _gain(of_run: Floats, partials: Floats, results: Results) -> Floats:
    """Compute (P'B)^-1 P' (F, 3, 2L), the angles' derivatives by the measured coordinates.

    NaN where P'B is singular but for rounding: an angle that nothing determines has
    no standard deviation, not that of a pseudo-inverse.
    """
    crossed = of_run.swapaxes(1, 2) @ partials
    known: Bools = results.solved & (distinct_in_rows(results.landmark, results.used) >= 2)
    sizes, _ = singular_values(crossed)
    known &= sizes[:, 2] > SINGULAR * sizes[:, 0]
    gain = inverse(crossed) @ of_run.swapaxes(1, 2)
    return np.asarray(np.where(known[:, None, None], gain, np.nan))


STEP_S, STEP_FT_S = 1e-3, 1e-3

TIMES_S = np.array([0.0, STEP_S, -STEP_S])  # the times that are looked up, from that of each frame
AT_TIME, LATER, EARLIER = 0, 1, 2  # their indices
_AXES = np.eye(3) * STEP_FT_S
FASTER_FT_S = np.concatenate([np.zeros((1, 3)), _AXES, -_AXES])
"""What is added to the velocity along north, east, down: nothing, more of each, less of each."""


class JoinedJobs(NamedTuple):
    """The results of jobs with the same fixes and the same largest number of landmarks.

    What belongs to a job as a whole is here for every one of its frames. The vehicle's path and
    the wind are those at each of `TIMES_S`; NaN where a table is out of order.
    """

    results: Results  # the arrays of all jobs; its `job` is that of the first
    frames: list[slice]  # of each job
    origin: Floats  # (3, F)
    focal_length_mm: Floats  # (F,)
    multiplier: Floats  # (F, 3) of vehicle yaw, pitch, roll by those of the camera
    altitude_ft: Floats  # (F,) at the frame's time
    travelled_ft: Floats  # (F, 3, 3) east, north, up, by the time
    velocity_ft_s: Floats  # (F, 3, 7, 3) north, east, down, by the time and `FASTER_FT_S`
    wind_ft_s: Floats  # (F, 3, 2) north, east, by the time


@np.errstate(all="ignore")
def joined_jobs(jobs: Sequence[Results]) -> JoinedJobs:
    """Put the frames of jobs one after the other.

    Args:
        jobs: one or more, all with the same fixes and the same largest number of landmarks
    """
    results = Results.concat(jobs)
    count = [len(one.frame) for one in jobs]
    ends = np.cumsum(count).tolist()
    cameras, paths = [one.job.camera for one in jobs], [one.job.trajectory for one in jobs]
    origins = np.stack([origin_of(one.job) for one in jobs], axis=1)

    # Everything is looked up in two calls: by the time, then by the altitude found
    which = np.repeat(np.arange(len(jobs)), count)
    position, velocity, altitude = (
        np.concatenate([getattr(one, name) for one in paths])
        for name in ("position_ft", "velocity_ft_s", "altitude_ft")
    )
    shifts = len(FASTER_FT_S)
    faster = (velocity[:, None] + FASTER_FT_S).reshape(-1, 3 * shifts)
    last = np.cumsum([len(one.time_s) for one in paths])
    columns = np.split(np.column_stack([altitude, position, faster]), last[:-1])
    by_time = [(one.time_s, own) for one, own in zip(paths, columns, strict=True)]
    found = _look_up(results.time_s[:, None] + TIMES_S, which, Tables.of(TRAJECTORY_TIMES, by_time))
    altitude_ft = np.ascontiguousarray(found[..., 0])
    by_height = [(one.job.wind.altitude_ft, one.job.wind.velocity_ft_s) for one in jobs]
    return JoinedJobs(
        results=results,
        frames=[slice(end - n, end) for n, end in zip(count, ends, strict=True)],
        origin=np.repeat(origins, count, axis=1),
        focal_length_mm=np.repeat([one.focal_length_mm for one in cameras], count),
        multiplier=np.repeat([one.multiplier for one in cameras], count, axis=0),
        altitude_ft=altitude_ft[:, AT_TIME],
        travelled_ft=found[..., 1:4] - results.vehicle_ft[:, None],
        velocity_ft_s=found[..., 4:].reshape(len(found), len(TIMES_S), shifts, 3),
        wind_ft_s=_look_up(altitude_ft, which, Tables.of(WIND_ALTITUDES, by_height)),
    )


def _look_up(x: Floats, which: Ints, tables: Tables) -> Floats:
    """Look up as `ftlup_each` does; NaN for a job whose run stopped at its table."""
    stopped = tables.refused()
    if not stopped.any():
        return ftlup_each(x, which, tables)
    found = np.full((*x.shape, tables.vard.shape[1]), np.nan)
    for k in np.flatnonzero(~stopped):
        own = slice(tables.first[k], tables.first[k] + tables.size[k])
        one = Tables(tables.name, tables.size[[k]], tables.vari[own], tables.vard[own])
        rows = which == k
        found[rows] = ftlup_each(x[rows], np.zeros(int(rows.sum()), np.int64), one)
    return found


def flat(pairs: Floats) -> Floats:
    """Rearrange image coordinates to (F, 2L).

    Args:
        pairs: x and y as the solve has them, (2, L, F)
    """
    return np.moveaxis(pairs, -1, 0).reshape(pairs.shape[-1], -1)


def columns(partials: Floats) -> Floats:
    """Rearrange partial derivatives to (F, 2L, 3).

    Args:
        partials: by three angles, as the solve has them, (2, 3, L, F)
    """
    return np.moveaxis(partials, (3, 0, 2, 1), (0, 1, 2, 3)).reshape(partials.shape[3], -1, 3)


KM_PER_FT = 0.3048e-3
OF_1974 = ELLIPSOIDS["international1924"]  # its flattening is that of the series of A 56 and A 195


def position(joined: JoinedJobs) -> Position:
    """Place the camera of each frame, with the local axes there.

    The spherical Earth of 1974 gives the camera's direction from the Earth's centre
    correctly, but its distance wrongly away from the equator. Therefore the direction
    and the altitude of group 7 are used. The program's series from geodetic to
    geocentric latitude is that of a flattening of 1/297, and so is the way back. Down
    is what the run uses: toward the Earth's centre, or with the fix `earth` along the
    ellipsoid's normal.
    """
    fixes = joined.results.fixes
    camera = earth_fixed(joined.origin, fixes, joined.results.vehicle_ft).T
    longitude = np.arctan2(camera[1], camera[0])
    geocentric = np.arctan2(camera[2], np.hypot(camera[0], camera[1]))
    altitude = joined.altitude_ft
    latitude = _geodetic(geocentric, altitude * KM_PER_FT)
    fixed = Fix.EARTH in fixes
    if fixed:
        latitude = geodetic_latitude(fixes.ellipsoid, camera)
    east, north, up = np.moveaxis(
        east_north_up(latitude if fixed else geocentric, longitude), 1, -1
    )
    return Position(
        latitude_deg=np.degrees(latitude),
        longitude_deg=np.degrees(longitude),
        altitude=altitude,
        north_east_down=np.stack([north, east, -up], axis=-2),
        geocentric_latitude_deg=np.degrees(geocentric),
        vertical=Vertical.GEODETIC if fixed else Vertical.GEOCENTRIC,
        to_own_m=_to_own_m(joined, np.degrees(latitude), np.degrees(longitude)),
    )


def _to_own_m(joined: JoinedJobs, latitude_deg: Floats, longitude_deg: Floats) -> Floats:
    """Measure how far (F, 2), m east and north, the deck itself puts the camera from a position.

    That is group 7's X, Y, Z along east, north and up of group 8's origin, on WGS 84.
    """
    on_wgs84 = Fixes(frozenset({Fix.EARTH}))
    own = earth_fixed(joined.origin, on_wgs84, joined.results.vehicle_ft) * M_PER_KM
    here = earth_centred_m(latitude_deg, longitude_deg, geodetic(own).height_m)
    apart = (own - here)[:, None]
    return np.asarray((local_axes(own)[:, :2] * apart).sum(axis=-1))


def _geodetic(geocentric: Floats, height_km: Floats) -> Floats:
    """Convert geocentric to geodetic latitude, radians, at a height."""
    latitude = np.array(geocentric)
    for _ in range(6):  # each step gains a factor of 1/300
        x, _, z = earth_centred(OF_1974, latitude, np.zeros_like(latitude), height_km)
        latitude = latitude + geocentric - np.arctan2(z, x)
    return latitude


STEP_FT, STEP_MM, STEP_DEG = 1.0, 1e-3, 1e-3


@np.errstate(all="ignore")
def responses(joined: JoinedJobs, seen: Sight, radians: Floats) -> Responses:
    """Compute the derivatives of some jobs at the angles they were solved to.

    Args:
        joined: the jobs
        seen: what their solve was given
        radians: camera yaw, pitch, roll, (F, 3)
    """

    def residual(direction: Floats) -> Floats:
        xlam, xmu, xnu = (np.ascontiguousarray(direction[..., k].T) for k in range(3))
        return flat(equations(radians.T, seen._replace(dircos=(xlam, xmu, xnu)))[0])

    def by_landmark(axis: Floats) -> Floats:
        return _central(lambda s: residual(_moved_landmarks(joined, s * axis)), STEP_FT)

    def by_position(axis: Floats) -> Floats:
        return _central(lambda s: residual(_moved_vehicle(joined, s * axis)), STEP_FT)

    def by_focal_length(step: float) -> Floats:
        return flat(equations(radians.T, seen._replace(cc=seen.cc + step * STEP_MM))[0])

    def by_time(step: float) -> Floats:
        at = LATER if step > 0.0 else EARLIER
        return residual(_moved_vehicle(joined, joined.travelled_ft[:, at]))

    steps = np.eye(3) * STEP_FT
    return Responses(
        landmark=np.stack([by_landmark(axis) for axis in steps], axis=-1),
        position=np.stack([by_position(axis) for axis in steps], axis=-1),
        focal_length=_central(by_focal_length, STEP_MM),
        time=_central(by_time, STEP_S),
        attack_by_camera=_attack_by_camera(joined),
        attack_by_time=_attack_by_time(joined),
        attack_by_velocity=_attack_by_velocity(joined),
    )


def _moved_vehicle(joined: JoinedJobs, shift_ft: Floats) -> Floats:
    """Find directions (F, L, 3) with the vehicle moved east, north, up by (F, 3) or (3,)."""
    r = joined.results
    marks = r.longitude_deg, r.geocentric_latitude_deg, r.radius_km
    return directions(joined.origin, r.fixes, r.vehicle_ft + shift_ft, *marks)


def _moved_landmarks(joined: JoinedJobs, shift_ft: Floats) -> Floats:
    """Find directions (F, L, 3) with every landmark moved east, north, up by (3,)."""
    east, north, up = shift_ft / ftpkm
    r = joined.results
    latitude = np.radians(r.geocentric_latitude_deg)
    return directions(
        joined.origin,
        r.fixes,
        r.vehicle_ft,
        r.longitude_deg + np.degrees(east / (r.radius_km * np.cos(latitude))),
        r.geocentric_latitude_deg + np.degrees(north / r.radius_km),
        r.radius_km + up,
    )


def _attack_by_camera(joined: JoinedJobs) -> Floats:
    columns = []
    for k, multiplier in enumerate(joined.multiplier.T):
        turn = np.zeros_like(joined.multiplier)
        turn[:, k] = STEP_DEG * multiplier
        change = _attack_deg(joined, turn_deg=turn) - _attack_deg(joined, turn_deg=-turn)
        columns.append(_short_way(change) / (2.0 * STEP_DEG))
    return np.stack(columns, axis=-1)


def _attack_by_time(joined: JoinedJobs) -> Floats:
    change = _attack_deg(joined, LATER) - _attack_deg(joined, EARLIER)
    return np.radians(_short_way(change)) / (2.0 * STEP_S)


def _attack_by_velocity(joined: JoinedJobs) -> Floats:
    columns = []
    for k in (1, 2, 3):  # indices in FASTER_FT_S; the opposite is three farther on
        change = _attack_deg(joined, faster=k) - _attack_deg(joined, faster=k + 3)
        columns.append(np.radians(_short_way(change)) / (2.0 * STEP_FT_S))
    return np.stack(columns, axis=-1)


def _attack_deg(
    joined: JoinedJobs, time: int = AT_TIME, faster: int = 0, turn_deg: Floats | float = 0.0
) -> Floats:
    """Compute alpha, beta, eta (F, 3) at one of `TIMES_S` and `FASTER_FT_S`, attitude shifted."""
    yaw, pitch, roll = (joined.results.vehicle_deg + turn_deg).T
    velocity, wind = joined.velocity_ft_s[:, time, faster], joined.wind_ft_s[:, time]
    alphad, betad, etad, _ = alpbet(velocity, wind, theta=pitch, psi=yaw, phi=roll)
    return np.stack([alphad, betad, etad], axis=1)


def _short_way(change_deg: Floats) -> Floats:
    return np.asarray((change_deg + 180.0) % 360.0 - 180.0)


def _central(at: Callable[[float], Floats], step: float) -> Floats:
    return np.asarray((at(1.0) - at(-1.0)) / (2.0 * step))


WIDEST_IN = 100.0  # no film reader is wider
RESOLUTION_IN = 0.001  # of a reading on a card
MEDIAN_CHI2_4 = 3.3566939800333224  # of chi-square with four degrees of freedom
FRAMES_FOR_SHAPE = 3  # so many show how far the fiducials' rectangle keeps its shape


def reading_noises(jobs: Sequence[Job]) -> list[tuple[float, float, float]]:
    """Estimate the noise of the readings of each of some jobs; those of one size together.

    The spread of three readings says how well the reader repeats them, not how well
    the point was identified. For fiducials the change of their shape from frame to
    frame says that as well, and the larger of the two counts.

    Args:
        jobs: their readings; one that is farther from the others than a film reader
            is wide is left out, for it would pass for the noise of all frames

    Returns:
        For each job the standard deviation, mm, of a film coordinate that is the mean of three
        readings: of a landmark's, by its three readings, NaN where there is no landmark; what
        rounding to a card's last digit leaves; and of a fiducial's, NaN where none is usable.
    """
    alike: dict[tuple[int, int], list[int]] = {}
    for k, job in enumerate(jobs):
        layout = job.readings.layout
        alike.setdefault((len(layout.count), layout.total), []).append(k)
    resolution = RESOLUTION_IN / np.sqrt(12.0)
    found: dict[int, tuple[float, float, float]] = {}
    for indices in alike.values():
        several = [jobs[k].readings for k in indices]
        fiducial_in = np.stack([one.fiducial_in for one in several])
        points = _spread_in(np.stack([one.points.landmark_in for one in several]))
        spread = _spread_in(fiducial_in.reshape(len(several), -1, 3, 2))
        fiducial = np.fmax(np.fmax(spread, _fiducial_shape_in(fiducial_in)), resolution)
        for k, point, own in zip(indices, points, fiducial, strict=True):
            found[k] = factor * float(point), factor * resolution, factor * float(own)
    return [found[k] for k in range(len(jobs))]


@np.errstate(all="ignore")
def _spread_in(triples: Floats) -> Floats:
    """Estimate the standard deviation (J,) of the mean of three readings (J, n, 3, 2).

    Each spread has two degrees of freedom; the mean of three has a third of their variance.
    """
    variance = triples.var(axis=2, ddof=1).reshape(len(triples), -1)
    usable = variance < WIDEST_IN**2
    each = zip(variance, usable, strict=True)
    means = [own[good].mean() if good.any() else np.nan for own, good in each]
    return np.sqrt(np.array(means) / 3.0)


@np.errstate(all="ignore")
def _fiducial_shape_in(fiducial_in: Floats) -> Floats:
    """Estimate the standard deviation (J,) of a fiducial's coordinate, by the shape of the four.

    The shape is where each stands from the centre of the four. What the film's turn on
    the reader and its shrinking change, in first order, is taken out of each frame. The
    median over frames is taken, so that one misread fiducial does not count. NaN with
    fewer than `FRAMES_FOR_SHAPE` frames.

    Args:
        fiducial_in: the readings of jobs of one number of frames (J, F, 4, 3, 2)
    """
    corner = fiducial_in.mean(axis=3)
    shape = corner - corner.mean(axis=2, keepdims=True)
    known = np.isfinite(shape).all(axis=(2, 3))
    if len(known) > 1 and not known.all():
        return np.concatenate([_fiducial_shape_in(one[None]) for one in fiducial_in])
    shape = shape[:, known[0]]  # of a single job, if any frame is left out
    if shape.shape[1] < FRAMES_FOR_SHAPE:
        return np.full(len(shape), np.nan)
    mean = np.median(shape, axis=1, keepdims=True)
    size = (mean**2).sum(axis=(2, 3))
    change = shape - mean
    turned = np.stack([-mean[..., 1], mean[..., 0]], axis=-1)
    for direction in (mean, turned):
        along = (change * direction).sum(axis=(2, 3)) / size
        change = change - along[..., None, None] * direction
    squares = np.median((change**2).sum(axis=(2, 3)), axis=1)  # four degrees of freedom a frame
    meaningless = (size[:, 0] == 0.0) | (squares > WIDEST_IN**2)
    return np.where(meaningless, np.nan, np.sqrt(squares / MEDIAN_CHI2_4))


@np.errstate(all="ignore")
def slip_effects_deg(
    results: Sequence[Results], determined: Sequence[Bools]
) -> list[Floats | None]:
    """Subtract nine angles of a run from those with all errata corrected, (F, 9) degrees a job.

    They are camera yaw, pitch, roll, vehicle yaw, pitch, roll, alpha, beta, eta. Each frame
    is solved once more, starting from its solution. With the fix `earth` the vertical
    is that of an ellipsoid, without it that of a sphere. Both solves are relative to the
    vertical of their own Earth, and that is what is compared: the landmarks, group 7's
    axes and the vertical turn together from one Earth to the other, so that the angle
    between the two verticals is not a part of the difference.

    Args:
        results: jobs as they were solved, all with the same fixes; they are solved together
        determined: of each job the frames whose attitude the landmarks determine, (F,)

    Returns:
        The differences, -180 to 180; NaN for frames that are not determined or do not
        converge with the fixes. None where the run has all fixes.
    """
    if not results or results[0].fixes.chosen == frozenset(Fix):
        return [None] * len(results)
    starts = []
    for one, known in zip(results, determined, strict=True):
        frames = len(one.frame)
        start = np.full((len(one.job.readings.frame), 3), one.job.camera.initial_deg)
        start[:frames] = np.where(known[:, None], one.camera_deg, start[:frames])
        starts.append(start)
    fixes = Fixes(frozenset(Fix), results[0].fixes.ellipsoid)
    solved: list[Results] = []
    for ended in run_jobs([one.job for one in results], fixes, starts):
        if isinstance(ended, VopdError):
            raise ended
        solved.append(ended)
    counts = [min(len(a.frame), len(b.frame)) for a, b in zip(results, solved, strict=True)]
    run, fixed = _first_frames(results, counts), _first_frames(solved, counts)
    sure = np.concatenate([one[:n] for one, n in zip(determined, counts, strict=True)])
    sure &= fixed.solved & fixed.converged
    change = np.where(sure[:, None], _short_way(_angles_deg(fixed) - _angles_deg(run)), np.nan)
    effects: list[Floats | None] = []
    for one, effect in zip(results, np.split(change, np.cumsum(counts)[:-1]), strict=True):
        missing = np.full((len(one.frame) - len(effect), 9), np.nan)  # the run with fixes ended
        effects.append(np.concatenate([effect, missing]))
    return effects


def _first_frames(jobs: Sequence[Results], counts: Sequence[int]) -> Results:
    """Join the first frames of each job; a run may have ended early."""
    each = zip(jobs, counts, strict=True)
    return Results.concat([one if len(one.frame) == n else one.take(slice(n)) for one, n in each])


def _angles_deg(results: Results) -> Floats:
    """Stack the nine angles of every frame, (F, 9) degrees."""
    attack = results.alpha_deg, results.beta_deg, results.eta_deg
    return np.column_stack([results.camera_deg, results.vehicle_deg, *attack])


DECK_WORDS = Words(
    source="deck",
    no_fixes="none; these are the original's numbers",
    surface="on the film",
    centre="centre of the frame",
    landmark="its number in group 9",
    reading="a landmark's film coordinate",
    vertical=(
        "whether group 7's X, Y, Z, and with them these angles, refer to one or the other depends "
        "on the deck's maker, and no card says it"
    ),
    altitude="above sea level, as the deck has them",
    own_position="where the deck's own coordinates put it on WGS 84 (--fix earth puts it there)",
    columns={
        "deck": "the deck's file",
        "job": "the job's number in its deck, from 1",
        "status": "solved, ignored, exact (no residuals at all), stopped",
        "time_s": "flight time",
        "camera_yaw_deg": "SIG1, 0 to 360",
        "camera_pitch_deg": "SIG2, -180 to 180",
        "camera_roll_deg": "SIG3, 0 to 360",
        "vehicle_yaw_deg": "PSI, 0 to 360",
        "vehicle_pitch_deg": "THETA, -180 to 180",
        "vehicle_roll_deg": "PHI, 0 to 360",
        "alpha_deg": "ALPHA, angle of attack in pitch",
        "beta_deg": "BETA, angle of attack in yaw",
        "eta_deg": "ETA, total angle of attack, 0 to 180",
        "vehicle_east_ft": "X, east of group 8's origin",
        "vehicle_north_ft": "Y, north of it",
        "vehicle_up_ft": "Z, up along its vertical",
        "latitude_deg": "of the vehicle, geodetic, as the deck's",
        "altitude_ft": "H, above sea level",
        "last_correction_rad": "the 22nd, largest of three",
    },
    flags={
        "not_converged": (
            "the 22nd correction exceeds 1e-6 rad or is not a number",
            "look at the readings and at group 8's first estimate; try --initial closed-form",
        ),
        "undetermined": (
            "fewer than two landmarks, or equations without a solution: the angles are one of "
            "many attitudes that fit; what is not known is named",
            "read more landmarks",
        ),
        "out_of_range": (
            "an angle of camera or vehicle is beyond a full circle: the solve diverged, or group 3 "
            "has a large multiplier or offset; the listing may have asterisks",
            "look at the readings, at group 3 and at group 8's first estimate",
        ),
        "behind_camera": (
            "a landmark lies behind the camera: the solve ended at the other solution",
            "try --initial closed-form",
        ),
        "two_landmarks": (
            "two landmarks only: one degree of freedom, and an exchanged pair cannot be seen",
            "read a third landmark",
        ),
        "weak_geometry": (
            "one rotation axis is determined 20 times worse than the best one (condition number); "
            "it is named",
            "read landmarks farther apart on the film",
        ),
        "outlier": (
            "a landmark does not fit the others (F test, .001 a frame, four landmarks or more); "
            "it is named",
            "read it again, or ignore it (group 11 in one frame, group 12 in all)",
        ),
    },
    conventions={
        "camera angles": (
            "camera yaw of the optical axis clockwise from north, pitch above the horizontal, "
            "roll clockwise about the optical axis seen from behind (sigma 1, 2, 3 of "
            "NASA TM X-3050)"
        ),
        "position": (
            "longitude east, geodetic latitude as the deck has them; altitude above sea level, "
            "group 7"
        ),
        "time": "seconds of flight, group 6",
    },
)
