"""Simulated films with something wrong in one frame of eight, or with a wrong first estimate."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from tests.kit.coverage_count import CAMERA
from tests.kit.simulated_films import SimulatedFilms, camera_matrix
from tests.kit.wgs84_film import MM_PER_INCH

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
