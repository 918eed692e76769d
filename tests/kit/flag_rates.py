"""How often each flag is raised without a reason, and how often where there is one.

Films of `tests.kit.simulated_films` with random errors are solved as they are, and with
something wrong in them: a landmark misread, the labels of two exchanged, a start at the
other solution or anywhere, a jump.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from tests.kit.coverage_cells import READINGS
from tests.kit.coverage_count import CAMERA, solved
from tests.kit.simulated_films import Plan, SimulatedFilms, camera_matrix, simulate
from tests.kit.wgs84_film import MM_PER_INCH
from vopd.attitude.flags import MEANING
from vopd.attitude.history import History

Array = np.ndarray
MAX_RATE_DEG_S = 10.0


class Trial(NamedTuple):
    """Films with something wrong in them.

    `spoil` changes them before they are solved; `start` gives the angles (J, F, 3) to start
    from. `which` says which frames (J, F) are wrong then; None: all. `shown` are the flags
    whose rates are of interest.
    """

    name: str
    plan: Plan
    shown: tuple[str, ...]
    spoil: Callable[[SimulatedFilms, np.random.Generator], SimulatedFilms] | None = None
    start: Callable[[SimulatedFilms, np.random.Generator], Array] | None = None
    which: Callable[[SimulatedFilms, list[History]], Array] | None = None
    max_rate_deg_s: float | None = None


class Rates(NamedTuple):
    """The share of wrong frames that have each flag, and any that tells of an error."""

    frames: int
    flag: dict[str, float]
    none: float  # without any flag but those of the geometry


OF_GEOMETRY = ("two_landmarks", "weak_geometry", "second_solution", "pitch_near_90")
"""Flags that say how well a frame can be determined, not that something is wrong in it."""


def rates(trial: Trial, landmarks: int, seed: int, jobs: int | None = None) -> Rates:
    """Solve the films of a trial and count their flags.

    Args:
        trial: what is wrong
        landmarks: in a frame
        seed: of the random numbers
        jobs: how many, in the place of the plan's
    """
    rng = np.random.default_rng(seed)
    plan = trial.plan._replace(landmarks=landmarks, jobs=jobs or trial.plan.jobs)
    films = simulate(plan, seed)
    if trial.spoil:
        films = trial.spoil(films, rng)
    start = trial.start(films, rng) if trial.start else None
    histories = solved(films, max_rate_deg_s=trial.max_rate_deg_s, start_deg=start)
    wrong = np.ones(films.truth_deg.shape[:2], bool)
    if trial.which:
        wrong = trial.which(films, histories)
    raised = {
        name: np.stack([h.flags.raised[name] for h in histories])[wrong]
        for name in MEANING
        if all(name in h.flags.raised for h in histories)
    }
    telling = [one for name, one in raised.items() if name not in OF_GEOMETRY]
    silent = ~np.any(telling, axis=0)
    shares = {name: float(one.mean()) if one.size else np.nan for name, one in raised.items()}
    return Rates(int(wrong.sum()), shares, float(silent.mean()) if silent.size else np.nan)


def misread(mm: float) -> Callable[[SimulatedFilms, np.random.Generator], SimulatedFilms]:
    """One landmark of every frame is off by so much in any direction, in all three readings."""

    def spoil(films: SimulatedFilms, rng: np.random.Generator) -> SimulatedFilms:
        jobs, frames, count = films.landmark_in.shape[:3]
        which = rng.integers(count, size=(jobs, frames))
        around = rng.uniform(0.0, 2 * np.pi, (jobs, frames))
        off = mm / MM_PER_INCH * np.stack([np.cos(around), np.sin(around)], axis=-1)
        chosen = np.arange(count) == which[..., None]
        moved = films.landmark_in + (chosen[..., None] * off[:, :, None])[..., None, :]
        return films._replace(landmark_in=moved.round(3))

    return spoil


def swapped(films: SimulatedFilms, rng: np.random.Generator) -> SimulatedFilms:
    """The labels of two landmarks are exchanged in every frame."""
    jobs, frames, count = films.landmark_in.shape[:3]
    order = np.tile(np.arange(count), (jobs, frames, 1))
    pair = rng.permuted(order, axis=2)[..., :2]
    np.put_along_axis(order, pair, pair[..., ::-1], axis=2)
    return films._replace(
        landmark_in=np.take_along_axis(films.landmark_in, order[..., None, None], axis=2)
    )


def from_the_other_side(films: SimulatedFilms, _rng: np.random.Generator) -> Array:
    """The attitude mirrored at the plane of two landmarks, which shows them behind the camera.

    The plane is that of the optical axis and the line on the film between the first two.
    """
    true = camera_matrix(films.truth_deg[..., CAMERA])
    line = (films.landmark_in[:, :, 1] - films.landmark_in[:, :, 0]).mean(axis=2)
    line = line / np.linalg.norm(line, axis=-1, keepdims=True)
    across = np.stack([-line[..., 1], line[..., 0], 0.0 * line[..., 0]], axis=-1)
    turned = -(np.eye(3) - 2.0 * across[..., :, None] * across[..., None, :])
    return _angles_deg(turned @ true)


def _angles_deg(matrix: Array) -> Array:
    """Camera yaw, pitch, roll of rows x, y, axis."""
    axis = matrix[..., 2, :]
    yaw = np.arctan2(axis[..., 0], axis[..., 1])
    pitch = np.arcsin(np.clip(axis[..., 2], -1.0, 1.0))
    roll = np.arctan2(matrix[..., 0, 2], matrix[..., 1, 2])
    return np.degrees(np.stack([yaw % (2 * np.pi), pitch, roll % (2 * np.pi)], axis=-1))


def from_anywhere(films: SimulatedFilms, rng: np.random.Generator) -> Array:
    """Starts all over the sphere."""
    shape = films.truth_deg.shape[:2]
    yaw, roll = rng.uniform(0.0, 360.0, (2, *shape))
    pitch = np.degrees(np.arcsin(rng.uniform(-1.0, 1.0, shape)))
    return np.stack([yaw, pitch, roll], axis=-1)


def far_off(films: SimulatedFilms, histories: list[History]) -> Array:
    """Frames whose camera looks or is turned elsewhere than in truth by more than ten degrees."""
    found = np.stack([h.estimate.camera_deg for h in histories])
    product = (camera_matrix(found) * camera_matrix(films.truth_deg[..., CAMERA])).sum(
        axis=(-1, -2)
    )
    return np.asarray(~((product - 1.0) / 2.0 > np.cos(np.radians(10.0))))


def middle(films: SimulatedFilms, _histories: list[History]) -> Array:
    """The middle frame of every job."""
    jobs, frames = films.truth_deg.shape[:2]
    return np.tile(np.arange(frames) == frames // 2, (jobs, 1))


OF_ERRORS = ("not_converged", "out_of_range", "behind_camera", "outlier", "misfit")
STILL = Plan(READINGS, jobs=80, frames=40, jitter_deg=(0.1, 0.1, 0.1))
TRIALS = (
    Trial("nothing", STILL, (*OF_ERRORS, "jump"), max_rate_deg_s=MAX_RATE_DEG_S),
    Trial("nothing, poor geometry", STILL._replace(poor=True), OF_ERRORS),
    Trial("a landmark misread by .1 mm", STILL, ("outlier", "misfit"), misread(0.1)),
    Trial("a landmark misread by 1 mm", STILL, ("outlier", "misfit"), misread(1.0)),
    Trial("two labels exchanged", STILL, ("outlier", "misfit"), swapped),
    Trial("start at the other solution", STILL, ("behind_camera",),
          start=from_the_other_side, which=far_off),
    Trial("start anywhere, and the solve ends elsewhere", STILL, ("behind_camera",),
          start=from_anywhere, which=far_off),
    Trial("pitch jumps by 5 degrees", STILL._replace(jobs=200, frames=9, jump_deg=5.0),
          ("jump",), which=middle, max_rate_deg_s=MAX_RATE_DEG_S),
)  # fmt: skip
