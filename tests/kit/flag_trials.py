"""Trials of the flags: what is wrong in simulated films, and which frames are wrong then."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from tests.kit.coverage_cells import READINGS
from tests.kit.coverage_count import CAMERA
from tests.kit.film_earths import WGS84
from tests.kit.simulated_films import (
    FOCAL_MM,
    LENS_MM,
    LENS_UM,
    Plan,
    SimulatedFilms,
    camera_matrix,
)
from tests.kit.spoiled_films import (
    Random,
    Spoiled,
    exchanged,
    from_anywhere,
    from_the_other_side,
    misread,
    nothing,
    only,
)
from tests.kit.wgs84_film import MM_PER_INCH
from vopd.attitude.history import History

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


def beyond_three_sigmas(films: SimulatedFilms, histories: list[History]) -> Array:
    """Frames of which a vehicle or camera angle is wrong by more than three sigmas."""
    found = np.stack([np.hstack([h.estimate.camera_deg, h.estimate.vehicle_deg])
                      for h in histories])  # fmt: skip
    sigma = np.stack([h.uncertainty.total[:, :6] for h in histories])
    error = (found - films.truth_deg[..., :6] + 180.0) % 360.0 - 180.0
    return np.asarray((np.abs(error) > 3.0 * sigma).any(axis=-1))


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
FAITHFUL = SHORT._replace(earth=WGS84)

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
    Trial("faithful run on WGS 84, wrong by more than three sigmas", FAITHFUL,
          ("model_error",), nothing, beyond_three_sigmas, fixes=()),
    Trial("start at the other solution", SHORT, ("behind_camera",), from_the_other_side, far_off),
    Trial("start anywhere, and the solve ends elsewhere", SHORT, ("behind_camera",),
          from_anywhere, far_off),
    Trial("pitch jumps by 5 degrees", STILL._replace(jobs=100, frames=9, jump_deg=5.0),
          ("jump",), nothing, middle, max_rate_deg_s=MAX_RATE_DEG_S),
)  # fmt: skip
