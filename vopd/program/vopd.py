"""Program VOPD, from a job to its results (A 105 to A 455)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.errata import NO_FIXES, Fix, Fixes
from vopd.job import Job
from vopd.program.alpbet import Alpbet, alpbet
from vopd.program.average import averages
from vopd.program.constants import factor, twopi
from vopd.program.frames import orient_frames, orient_from
from vopd.program.ftlup import TableOutOfOrder, ftlup
from vopd.program.ignored import kept
from vopd.program.orient import Orientation, Sight
from vopd.program.positions import directions, landmarks, outside, where_and_when
from vopd.program.tgtcam import Dircos
from vopd.results import Outcome, Results, Stage, Stop


@np.errstate(all="ignore")
def run(job: Job, fixes: Fixes = NO_FIXES, start_deg: Floats | None = None) -> Results:
    """Solve a job for all its frames at once; every frame comes out as it would alone.

    `fixes` are the slips to correct (`vopd.errata`), none for the original.
    `start_deg` (F, 3) are first estimates of the camera's yaw, pitch, roll to
    start each frame from, in the place of group 8 and of the frame before. A
    table that is out of order ends the job at the frame that first uses it: the
    results go that far and say so in `stop`. Raises `UndefinedLandmark`.
    """
    readings = job.readings
    dropped, used = kept(readings, job.ignored)
    fields: dict[str, Any] = {
        "fixes": fixes,
        "frame": readings.frame,
        "landmark": readings.landmark,
        "used": used,
        "ignored": readings.present & ~used & ~dropped[:, None],
    }
    outcome = np.where(dropped, Outcome.DROPPED, Outcome.SOLVED)
    try:
        fields |= where_and_when(job)
    except TableOutOfOrder as error:
        return _stopped(job, fields, outcome, 0, Stage.TIME, error)
    fields |= landmarks(job, used, fixes)
    names = "vehicle_ft", "longitude_deg", "geocentric_latitude_deg", "radius_km"
    fields["direction"] = directions(job, fixes, *(fields[name] for name in names))
    fields |= _film(job, fixes)
    flying = np.flatnonzero(~dropped)
    if not len(flying):
        return _results(job, fields, outcome)
    try:
        fields |= _distortion(job, fields)
    except TableOutOfOrder as error:
        return _stopped(job, fields, outcome, int(flying[0]), Stage.LENS, error)
    done = _solve(job, fields, dropped, fixes, start_deg)
    early = (done.last_pass > 0) & (done.last_pass < 22)
    outcome = np.where(early & ~dropped, Outcome.EXACT, outcome)
    outcome = np.where(~dropped & (done.last_pass == 22), Outcome.EXACT_LATE, outcome)
    fields |= _attitude(job, done, dropped)
    try:
        fields |= _attack(job, fields)
    except TableOutOfOrder as error:
        reached = np.flatnonzero(~dropped & ~early)
        if len(reached):
            return _stopped(job, fields, outcome, int(reached[0]), Stage.WIND, error)
    return _results(job, fields, outcome)


def _film(job: Job, fixes: Fixes) -> dict[str, Any]:
    """Averages on the reader, and on the film (A 233 to A 254)."""
    centre, point = averages(job.readings, rounded=Fix.EIGHT_DIGITS not in fixes)
    return {
        "centre_in": centre,
        "point_in": point,
        "centre_mm": centre * factor,
        "point_mm": point * factor,
    }


def _distortion(job: Job, fields: dict[str, Any]) -> dict[str, Any]:
    """Radial distance and lens correction of every landmark (A 343 to A 348)."""
    camera = job.camera
    away = fields["point_mm"] - fields["centre_mm"][:, None]
    r = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2)
    delr = -ftlup(r, 1, camera.lens_radius_mm, camera.lens_distortion_um) / 1000.0
    return {"radius_mm": r, "distortion_mm": delr, "at_centre": (r == 0) & fields["used"]}


def _solve(
    job: Job, fields: dict[str, Any], dropped: Bools, fixes: Fixes, start_deg: Floats | None
) -> Orientation:
    """The Euler angles of every frame; leaves the starts in `fields`."""
    seen = sight(fields, fixes, job.camera.focal_length_mm)
    if start_deg is not None:
        done, start = orient_from(np.array(start_deg.T), seen)
    else:
        turn = 360.0 if Fix.RESTART in fixes else twopi
        done, start = orient_frames(job.camera.initial_deg, seen, dropped, turn)
    fields["start_deg"] = start.T
    return done


def sight(fields: Mapping[str, Any], fixes: Fixes, cc: float) -> Sight:
    """What the solve is given, of the fields of `Results` by name."""
    r, delr, used = fields["radius_mm"], fields["distortion_mm"], fields["used"]
    distr = np.where(r == 0, 1.0, 1.0 - delr / r)  # not 0/0 at the frame's centre
    away = fields["point_mm"] - fields["centre_mm"][:, None]
    x, y = (np.ascontiguousarray((distr * away[..., k]).T) for k in (0, 1))
    dircos = [np.ascontiguousarray(fields["direction"][..., k].T) for k in range(3)]
    first = used.argmax(axis=1)
    xmu1 = np.broadcast_to(dircos[1][first, np.arange(len(first))], dircos[1].shape)
    return Sight(
        dircos=Dircos(*dircos),
        x=x,
        y=y,
        xmu1=dircos[1] if Fix.FIRST_LANDMARK in fixes else xmu1,
        used=np.ascontiguousarray(used.T),
        cc=cc,
    )


def _attitude(job: Job, done: Orientation, dropped: Bools) -> dict[str, Any]:
    """Camera and vehicle angles, residuals and their deviation (A 296 to A 304, A 444 to A 448)."""
    camera_deg = np.where(dropped, np.nan, done.angles).T
    vehicle = job.camera.multiplier * camera_deg + job.camera.offset_deg
    low, high = np.array([0.0, -180.0, 0.0]), np.array([360.0, 180.0, 360.0])
    vehicle = np.where(vehicle < low, vehicle + 360.0, vehicle)
    vehicle = np.where(vehicle > high, vehicle - 360.0, vehicle)
    return {
        "camera_deg": camera_deg,
        "vehicle_deg": vehicle,
        "residual_mm": np.moveaxis(done.eps, 0, -1).swapaxes(0, 1),
        "correction_rad": done.correction.T,
        "last_pass": done.last_pass,
        "singular": done.singular,
    }


def _attack(job: Job, fields: dict[str, Any]) -> dict[str, Any]:
    """Angles of attack and the deviation of the residuals."""
    fitted = 3 if Fix.STANDARD_DEVIATION in fields["fixes"] else 0
    z, attack = attack_angles(job, fields["time_s"], fields["vehicle_deg"])
    return {
        "alpha_deg": attack.alphad,
        "beta_deg": attack.betad,
        "eta_deg": attack.etad,
        "airspeed_ft_s": attack.cvp,
        "residual_deviation_mm": _deviation(fields["residual_mm"], fields["used"], fitted),
        "outside_wind": outside(z, job.wind.altitude_ft),
    }


def attack_angles(job: Job, time_s: Floats, vehicle_deg: Floats) -> tuple[Floats, Alpbet]:
    """Altitude, ft (F,), and what the air does, of time and attitude (F, 3) (C 6 to C 38)."""
    path = job.trajectory
    z = ftlup(time_s, 1, path.time_s, path.altitude_ft)
    wind = ftlup(z, 1, job.wind.altitude_ft, job.wind.velocity_ft_s)
    v1 = ftlup(time_s, 1, path.time_s, path.velocity_ft_s)
    yaw, pitch, roll = vehicle_deg.T
    return z, alpbet(v1, wind, theta=pitch, psi=yaw, phi=roll)


def _deviation(residual: Floats, used: Bools, fitted: int) -> Floats:
    """Root of the sum of squares over 2N less what was fitted (A 444 to A 447)."""
    total = np.zeros(len(used))
    for j in range(used.shape[1]):
        total = total + residual[:, j, 0] ** 2 + residual[:, j, 1] ** 2
    return np.asarray(np.sqrt(total / (2.0 * used.sum(axis=1) - fitted)))


def _stopped(
    job: Job, fields: dict[str, Any], outcome: Ints, at: int, stage: Stage, error: TableOutOfOrder
) -> Results:
    """The results up to the frame whose table stops the run."""
    tables = (
        (job.clock.frame, 6, "frame numbers"),
        (job.trajectory.time_s, 7, "times"),
        (job.camera.lens_radius_mm, 1, "radial distances"),
        (job.wind.altitude_ft, 4, "altitudes"),
    )
    found = (
        (group, table) for values, group, table in tables if np.array_equal(values, error.vari)
    )
    group, table = next(found)
    outcome = outcome[: at + 1].copy()
    outcome[at] = Outcome.STOPPED
    fixes = fields.pop("fixes")
    fields = {name: value[: at + 1] for name, value in fields.items()} | {"fixes": fixes}
    stop = Stop(at, stage, group, table, error.position, error.vari, error.vard)
    return _results(job, fields, outcome, stop)


_SHAPES = {
    "F": (
        "time_s alpha_deg beta_deg eta_deg airspeed_ft_s residual_deviation_mm last_pass "
        "singular outside_clock outside_trajectory outside_wind"
    ),
    "FL": (
        "longitude_deg latitude_deg geocentric_latitude_deg altitude_ft radius_km radius_kft "
        "radius_mm distortion_mm at_centre"
    ),
    "F2": "centre_in centre_mm",
    "F3": "vehicle_ft start_deg camera_deg vehicle_deg correction_rad",
    "FL2": "point_in point_mm residual_mm",
    "FL3": "direction",
}
_FLAGS = {"singular", "outside_clock", "outside_trajectory", "outside_wind", "at_centre"}


def _results(job: Job, fields: dict[str, Any], outcome: Ints, stop: Stop | None = None) -> Results:
    """All fields of `Results`; those that were not reached are NaN, or false, or zero."""
    size = {"F": outcome.shape[0], "L": fields["landmark"].shape[1], "2": 2, "3": 3}
    for axes, names in _SHAPES.items():
        for name in names.split():
            if name not in fields:
                empty: Any = np.nan
                if name in _FLAGS or name == "last_pass":
                    empty = False if name in _FLAGS else 0
                fields[name] = np.full([size[axis] for axis in axes], empty)
    used = fields["used"]
    for name in ("radius_mm", "distortion_mm", "residual_mm"):
        mask = used[..., None] if fields[name].ndim == 3 else used
        fields[name] = np.where(mask, fields[name], np.nan)
    return Results(job=job, outcome=outcome, stop=stop, **fields)
