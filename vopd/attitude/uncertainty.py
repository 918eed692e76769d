"""How well the angles are known: covariances from the correct partials, share by share."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from vopd.arrays import Bools, Floats
from vopd.attitude.input_sigmas import Sigmas, reading_sigma_mm
from vopd.attitude.solution import Solution
from vopd.program.angles import attack_angles
from vopd.program.ftlup import TableOutOfOrder, ftlup

ANGLES = (
    "camera_yaw", "camera_pitch", "camera_roll",
    "vehicle_yaw", "vehicle_pitch", "vehicle_roll",
    "alpha", "beta", "eta",
)  # fmt: skip
"""The nine angles of a frame in the order of every array here."""

SHARES = ("reading", "centre", "landmark", "position", "focal", "time")
STEP_FT, STEP_MM, STEP_S, STEP_DEG = 1.0, 1e-3, 1e-3, 1e-3


@dataclass(frozen=True)
class Uncertainty:
    """Standard deviations of the nine `ANGLES`, degrees, frame axis first.

    `total` is the root of the sum of squares of the shares, which are those of
    `SHARES` that are not left out. `camera_covariance_deg2` is that of camera
    yaw, pitch, roll, all shares together. `by_residuals`: the reading share has
    the scale of the frame's own residuals, else of `reading_mm`.
    """

    total: Floats  # (F, 9)
    shares: dict[str, Floats]  # (F, 9) each
    camera_covariance_deg2: Floats  # (F, 3, 3)
    by_residuals: Bools  # (F,)
    reading_mm: float


@np.errstate(all="ignore")
def uncertainty(solved: Solution, sigmas: Sigmas) -> Uncertainty:
    """Covariances of a job's angles.

    Each share is a set of independent causes, each with what one standard
    deviation of it does to the nine angles: `effects` (F, 9, causes).
    """
    reading_mm = sigmas.reading_mm
    if reading_mm is None:
        reading_mm = reading_sigma_mm(solved.results.job)
    by_residuals = solved.used.sum(axis=1) >= 3
    scale = np.where(by_residuals, _unit_mm(solved), reading_mm)
    chain = _chain(solved)
    through = chain @ solved.gain
    effects = {
        "reading": through * scale[:, None, None],
        "centre": through @ _shifts(solved) * (reading_mm / 2.0),
    }
    for name, sigma, effect in (
        ("landmark", sigmas.landmark_ft, _landmark),
        ("position", sigmas.position_ft, _position),
        ("focal", sigmas.focal_mm, _focal),
    ):
        if sigma > 0.0:
            effects[name] = np.concatenate(list(effect(solved, through)), axis=2) * sigma
    if sigmas.time_s > 0.0:
        effects["time"] = _time(solved, through) * sigmas.time_s
    degrees = {name: np.degrees(effect) for name, effect in effects.items()}
    camera = [effect[:, :3] for effect in degrees.values()]
    shares = {name: np.sqrt((effect**2).sum(axis=2)) for name, effect in degrees.items()}
    return Uncertainty(
        total=np.sqrt(sum(share**2 for share in shares.values())),
        shares=shares,
        camera_covariance_deg2=np.asarray(sum(e @ e.swapaxes(1, 2) for e in camera)),
        by_residuals=by_residuals,
        reading_mm=reading_mm,
    )


def _unit_mm(solved: Solution) -> Floats:
    """Standard deviation of a film coordinate by the frame's residuals: three angles are fitted."""
    freedom = 2.0 * solved.used.sum(axis=1) - 3.0
    return np.asarray(np.sqrt((solved.residual**2).sum(axis=1) / freedom))


def _chain(solved: Solution) -> Floats:
    """The nine angles by the camera's three, (F, 9, 3)."""
    results = solved.results
    chain = np.zeros((len(results.frame), 9, 3))
    chain[:, 0:3] = np.eye(3)
    chain[:, 3:6] = np.diag(results.job.camera.multiplier)
    for k, multiplier in enumerate(results.job.camera.multiplier):
        step = np.eye(3)[k] * STEP_DEG * multiplier

        def turned(sign: float, step: Floats = step) -> Floats:
            return _attack_deg(solved, 0.0, sign * step)

        chain[:, 6:9, k] = _difference_deg(turned) / (2.0 * STEP_DEG)
    return chain


def _attack_deg(solved: Solution, time_s: float, vehicle_deg: Floats) -> Floats:
    """Alpha, beta, eta (F, 3) at a shifted time and attitude."""
    r = solved.results
    try:
        _, air = attack_angles(r.job, r.time_s + time_s, r.vehicle_deg + vehicle_deg)
    except TableOutOfOrder:  # the run stopped there
        return np.full((len(r.frame), 3), np.nan)
    return np.stack([air.alphad, air.betad, air.etad], axis=1)


def _difference_deg(at: Callable[[float], Floats]) -> Floats:
    """Angles at +1 less those at -1, the short way around."""
    return np.asarray((at(1.0) - at(-1.0) + 180.0) % 360.0 - 180.0)


def _shifts(solved: Solution) -> Floats:
    """The frame's centre moved along x and along y by 1 mm, (F, 2L, 2): all coordinates move."""
    used = solved.used.astype(np.float64)
    nothing = np.zeros_like(used)
    along_x, along_y = np.hstack([used, nothing]), np.hstack([nothing, used])
    return -np.stack([along_x, along_y], axis=2)


def _landmark(solved: Solution, through: Floats) -> Iterator[Floats]:
    """Each landmark by itself moved east, north, up: (F, 9, L) a foot."""
    count = solved.used.shape[1]
    for axis in np.eye(3) * STEP_FT:
        change = _central(_residual_where(solved, solved.moved_landmarks, axis), STEP_FT)
        own = through * change[:, None]
        yield own[:, :, :count] + own[:, :, count:]


def _position(solved: Solution, through: Floats) -> Iterator[Floats]:
    """The vehicle moved east, north, up: (F, 9, 1) a foot."""
    for axis in np.eye(3) * STEP_FT:
        change = _central(_residual_where(solved, solved.moved_vehicle, axis), STEP_FT)
        yield through @ change[:, :, None]


def _residual_where(
    solved: Solution, moved: Callable[[Floats], Floats], axis: Floats
) -> Callable[[float], Floats]:
    return lambda sign: solved.residual_at(moved(sign * axis))


def _focal(solved: Solution, through: Floats) -> Iterator[Floats]:
    """A longer focal length: (F, 9, 1) a millimetre."""
    c = solved.sight.cc
    change = _central(lambda s: solved.residual_at(focal_mm=c + s * STEP_MM), STEP_MM)
    yield through @ change[:, :, None]


def _time(solved: Solution, through: Floats) -> Floats:
    """The nine angles, radians, by a later time: the vehicle is elsewhere and flies otherwise."""
    job, time_s = solved.results.job, solved.results.time_s
    path = job.trajectory

    def place(sign: float) -> Floats:
        try:
            later = ftlup(time_s + sign * STEP_S, 1, path.time_s, path.position_ft)
        except TableOutOfOrder:
            later = np.full_like(solved.results.vehicle_ft, np.nan)
        return solved.residual_at(solved.moved_vehicle(later - solved.results.vehicle_ft))

    effect = (through @ _central(place, STEP_S)[:, :, None])[:, :, 0]
    air = _difference_deg(lambda s: _attack_deg(solved, s * STEP_S, np.zeros(3)))
    effect[:, 6:9] += np.radians(air) / (2.0 * STEP_S)
    return effect[:, :, None]


def _central(at: Callable[[float], Floats], step: float) -> Floats:
    return np.asarray((at(1.0) - at(-1.0)) / (2.0 * step))
