"""How often each flag is raised, by films with a known mistake in them."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from tests.kit.coverage import CAMERA, READINGS, histories_of
from tests.kit.simulated_films import (
    FOCAL_MM,
    LENS_MM,
    LENS_UM,
    Plan,
    SimulatedFilms,
    camera_matrix,
    simulate,
)
from tests.kit.wgs84_film import MM_PER_INCH
from vopd.attitude.flags import MEANING
from vopd.attitude.history import History

Array = np.ndarray
Random = np.random.Generator
FIRST_NUMBER = 11  # of the landmarks of `film_decks`


class Spoiled(NamedTuple):
    """Films, which frames of them are wrong, and how they are to be solved."""

    films: SimulatedFilms
    wrong: Array  # (J, F)
    mend: Array  # (J, F) text that the flag `misfit` should name
    start_deg: Array | None = None  # (J, F, 3) camera angles to start from; None: the true ones


def _one_in_eight(films: SimulatedFilms, rng: Random) -> Array:
    """Wrong frames (J, F): one of every eight that follow each other."""
    jobs, frames = films.truth_deg.shape[:2]
    chosen = rng.integers(8, size=(jobs, -(-frames // 8)))
    return np.asarray(np.arange(frames) % 8 == np.repeat(chosen, 8, axis=1)[:, :frames])


def _no_text(films: SimulatedFilms) -> Array:
    return np.full(films.truth_deg.shape[:2], "", dtype=object)


def nothing(films: SimulatedFilms, _rng: Random) -> Spoiled:
    """Films as they are."""
    return Spoiled(films, np.zeros(films.truth_deg.shape[:2], bool), _no_text(films))


def misread(mm: float) -> Callable[[SimulatedFilms, Random], Spoiled]:
    """One landmark is off by so much in any direction, in all three readings."""

    def spoil(films: SimulatedFilms, rng: Random) -> Spoiled:
        jobs, frames, count = films.seen.shape
        wrong = _one_in_eight(films, rng)
        which = rng.integers(count, size=(jobs, frames))
        around = rng.uniform(0.0, 2 * np.pi, (jobs, frames))
        off = mm / MM_PER_INCH * np.stack([np.cos(around), np.sin(around)], axis=-1)
        chosen = (np.arange(count) == which[..., None]) & wrong[..., None]
        moved = films.landmark_in + (chosen[..., None] * off[:, :, None])[..., None, :]
        mend = np.vectorize(lambda k: f"without {FIRST_NUMBER + k}", otypes=[object])(which)
        return Spoiled(films._replace(landmark_in=moved.round(3)), wrong, mend)

    return spoil


def exchanged(films: SimulatedFilms, rng: Random) -> Spoiled:
    """The labels of two landmarks are exchanged."""
    jobs, frames, count = films.seen.shape
    wrong = _one_in_eight(films, rng)
    order = np.tile(np.arange(count), (jobs, frames, 1))
    pair = np.sort(rng.permuted(order, axis=2)[..., :2], axis=2)
    other = np.where(wrong[..., None], pair[..., ::-1], pair)
    np.put_along_axis(order, pair, other, axis=2)
    moved = np.take_along_axis(films.landmark_in, order[..., None, None], axis=2)
    mend = np.vectorize(
        lambda a, b: f"exchange {FIRST_NUMBER + a}+{FIRST_NUMBER + b}", otypes=[object]
    )(pair[..., 0], pair[..., 1])
    return Spoiled(films._replace(landmark_in=moved), wrong, mend)


def only(count: int) -> Callable[[SimulatedFilms, Random], Spoiled]:
    """No more than so many landmarks are read."""

    def spoil(films: SimulatedFilms, rng: Random) -> Spoiled:
        wrong = _one_in_eight(films, rng)
        rank = rng.permuted(np.tile(np.arange(films.seen.shape[2]), (*wrong.shape, 1)), axis=2)
        seen = ~wrong[..., None] | (rank < count)
        return Spoiled(films._replace(seen=seen), wrong, _no_text(films))

    return spoil


def from_the_other_side(films: SimulatedFilms, rng: Random) -> Spoiled:
    """Start at the attitude mirrored at the plane of two landmarks: they lie behind the camera.

    The plane is that of the optical axis and the line on the film between the first two.
    """
    true = camera_matrix(films.truth_deg[..., CAMERA])
    line = (films.landmark_in[:, :, 1] - films.landmark_in[:, :, 0]).mean(axis=2)
    line = line / np.linalg.norm(line, axis=-1, keepdims=True)
    across = np.stack([-line[..., 1], line[..., 0], 0.0 * line[..., 0]], axis=-1)
    turned = -(np.eye(3) - 2.0 * across[..., :, None] * across[..., None, :])
    return nothing(films, rng)._replace(start_deg=_angles_deg(turned @ true))


def _angles_deg(matrix: Array) -> Array:
    """Camera yaw, pitch, roll of rows x, y, axis."""
    axis = matrix[..., 2, :]
    yaw = np.arctan2(axis[..., 0], axis[..., 1])
    pitch = np.arcsin(np.clip(axis[..., 2], -1.0, 1.0))
    roll = np.arctan2(matrix[..., 0, 2], matrix[..., 1, 2])
    return np.degrees(np.stack([yaw % (2 * np.pi), pitch, roll % (2 * np.pi)], axis=-1))


def from_anywhere(films: SimulatedFilms, rng: Random) -> Spoiled:
    """Start all over the sphere."""
    shape = films.truth_deg.shape[:2]
    yaw, roll = rng.uniform(0.0, 360.0, (2, *shape))
    pitch = np.degrees(np.arcsin(rng.uniform(-1.0, 1.0, shape)))
    return nothing(films, rng)._replace(start_deg=np.stack([yaw, pitch, roll], axis=-1))


# Trials


Array = np.ndarray
MAX_RATE_DEG_S = 10.0


class Trial(NamedTuple):
    """Films with something wrong in them, and the flags whose rates are of interest.

    `which` says after the solve which frames (J, F) are wrong; None: those of `spoil`.
    """

    name: str
    plan: Plan
    shown: tuple[str, ...]
    spoil: Callable[[SimulatedFilms, Random], Spoiled]
    which: Callable[[SimulatedFilms, list[History]], Array] | None = None
    reading: bool = False  # whether the sigma of the readings is stated
    fixes: tuple[str, ...] = ("all",)
    max_rate_deg_s: float | None = None


def far_off(films: SimulatedFilms, histories: list[History]) -> Array:
    """Frames whose camera looks or is turned elsewhere than in truth by more than ten degrees."""
    found = np.stack([h.estimate.camera_deg for h in histories])
    product = camera_matrix(found) * camera_matrix(films.truth_deg[..., CAMERA])
    return np.asarray(~((product.sum(axis=(-1, -2)) - 1.0) / 2.0 > np.cos(np.radians(10.0))))


def weak(films: SimulatedFilms, _histories: list[History]) -> Array:
    """Frames in which one turn moves the image 20 times less than another one does.

    By the turns of the rays of the readings themselves, a microradian about each axis.
    """
    centre = films.fiducial_in.mean(axis=(2, 3))
    film = (films.landmark_in.mean(axis=3) - centre[:, :, None]) * MM_PER_INCH
    radius = np.linalg.norm(film, axis=-1, keepdims=True)
    film *= 1.0 + np.interp(radius, LENS_MM, LENS_UM) / 1000.0 / radius
    ray = np.concatenate([film, np.full((*film.shape[:3], 1), FOCAL_MM)], axis=-1)
    moved = []
    for axis in np.eye(3):
        x, y, z = np.moveaxis(ray @ Rotation.from_rotvec(1e-6 * axis).as_matrix(), -1, 0)
        image = FOCAL_MM * np.stack([x / z, y / z], axis=-1)
        moved.append((image - film).reshape(*film.shape[:2], -1))
    size = np.linalg.svd(np.stack(moved, axis=-1), compute_uv=False)
    return np.asarray(size[..., 0] > 20.0 * size[..., 2])


def middle(films: SimulatedFilms, _histories: list[History]) -> Array:
    """The middle frame of every job."""
    jobs, frames = films.truth_deg.shape[:2]
    return np.tile(np.arange(frames) == frames // 2, (jobs, 1))


ANY = ("not_converged", "out_of_range", "behind_camera", "outlier", "misfit")
NAMED = ("misfit", "outlier")
STILL = Plan(READINGS, jobs=50, frames=60, jitter_deg=(0.1, 0.1, 0.1))
SHORT = STILL._replace(jobs=60, frames=16)

TRIALS = (
    Trial("nothing", STILL, (*ANY, "jump"), nothing, max_rate_deg_s=MAX_RATE_DEG_S),
    Trial("nothing, sigma given", STILL, ("misfit",), nothing, reading=True),
    Trial("nothing, poor geometry", STILL._replace(poor=True), ANY, nothing),
    Trial("a landmark misread by .1 mm", SHORT, NAMED, misread(0.1)),
    Trial("a landmark misread by .1 mm, sigma given", SHORT, NAMED, misread(0.1), reading=True),
    Trial("a landmark misread by 1 mm", SHORT, NAMED, misread(1.0)),
    Trial("a landmark misread by 1 mm, sigma given", SHORT, NAMED, misread(1.0), reading=True),
    Trial("two labels exchanged", SHORT, NAMED, exchanged),
    Trial("two labels exchanged, sigma given", SHORT, NAMED, exchanged, reading=True),
    Trial("one landmark read", SHORT, ("undetermined",), only(1)),
    Trial("two landmarks read", SHORT, ("two_landmarks",), only(2)),
    Trial("one turn moves the image 20 times less than another", SHORT._replace(poor=True),
          ("weak_geometry",), nothing, weak),
    Trial("start at the other solution", SHORT, ("behind_camera",), from_the_other_side, far_off),
    Trial("start anywhere, and the solve ends elsewhere", SHORT, ("behind_camera",),
          from_anywhere, far_off),
    Trial("pitch jumps by 5 degrees", STILL._replace(jobs=100, frames=9, jump_deg=5.0),
          ("jump",), nothing, middle, max_rate_deg_s=MAX_RATE_DEG_S),
)  # fmt: skip


# Rates


Array = np.ndarray
OF_GEOMETRY = ("two_landmarks", "weak_geometry", "second_solution", "pitch_near_90")
"""Flags that say how well a frame can be determined, not that something is wrong in it."""


class Rates(NamedTuple):
    """Shares of the frames in which something is wrong, and of the others."""

    wrong: int  # how many frames
    others: int
    found: dict[str, float]  # the share of wrong frames that have the flag
    false: dict[str, float]  # the share of the others
    silent: float  # the share of wrong frames without any flag but those of the geometry
    named: float  # the share of wrong frames whose flag `misfit` names what is wrong
    named_alone: float  # and nothing else


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
    made = trial.spoil(simulate(plan, seed), rng)
    histories = histories_of(
        made.films, trial.fixes, trial.reading, trial.max_rate_deg_s, made.start_deg
    )
    wrong = trial.which(made.films, histories) if trial.which else made.wrong
    raised = {
        name: np.stack([h.flags.raised[name] for h in histories])
        for name in MEANING
        if all(name in h.flags.raised for h in histories)
    }
    telling = [one for name, one in raised.items() if name not in OF_GEOMETRY]
    named = np.stack([_named(h, mend) for h, mend in zip(histories, made.mend, strict=True)])
    return Rates(
        wrong=int(wrong.sum()),
        others=int((~wrong).sum()),
        found={name: _share(one[wrong]) for name, one in raised.items()},
        false={name: _share(one[~wrong]) for name, one in raised.items()},
        silent=_share(~np.any(telling, axis=0)[wrong]),
        named=_share(named[wrong] > 0),
        named_alone=_share(named[wrong] == 1),
    )


def _share(hits: Array) -> float:
    return float(hits.mean()) if hits.size else np.nan


def _named(history: History, mend: Array) -> Array:
    """How many repairs `misfit` names, where the right one is among them, else 0, (F,)."""
    raised, detail = history.flags.raised["misfit"], history.flags.detail["misfit"]
    count = np.zeros(len(mend), int)
    for k in np.flatnonzero(raised):
        told = [one.split(" (")[0] for one in detail[k].split(" or ")]
        count[k] = len(told) if mend[k] in told else 0
    return count
