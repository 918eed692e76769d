"""Flights with errors drawn from their priors; geodesy and camera by numpy and scipy alone."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from tests.tolerances import assert_close
from vopd.arrays import Floats, Ints
from vopd.estimate import COMMON_PART
from vopd.flight.flight import (
    CameraPath,
    Flight,
    FlightOptions,
    LandmarkSet,
    Picks,
    Refraction,
    TrackFixes,
)
from vopd.flight.solve.equations import Priors, Readout
from vopd.flight.solve.joint import JointSolution
from vopd.geometry.lenses import Lens, LensKind

RADIUS, E2 = 6378137.0, (2.0 - 1.0 / 298.257223563) / 298.257223563
FOCAL, SIZE, CENTRE = 3000.0, (4000, 3000), np.array([1999.5, 1499.5])
NED_FROM_ENU = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
LENS = ("focal", "centre_u", "centre_v", "k1", "k2")


def geodetic(position: Floats) -> tuple[Floats, Floats, Floats]:
    """Latitude, longitude (radians) and height of Earth-centred positions (..., 3)."""
    x, y, z = np.moveaxis(position, -1, 0)
    across = np.hypot(x, y)
    latitude = np.arctan2(z, across * (1.0 - E2))
    for _ in range(10):
        normal = RADIUS / np.sqrt(1.0 - E2 * np.sin(latitude) ** 2)
        latitude = np.arctan2(z + E2 * normal * np.sin(latitude), across)
    flat = np.sqrt(1.0 - E2 * np.sin(latitude) ** 2)
    height = across * np.cos(latitude) + z * np.sin(latitude) - RADIUS * flat
    return latitude, np.arctan2(y, x), height


def axes(position: Floats) -> Floats:
    """East, north, up as rows (..., 3, 3)."""
    latitude, longitude, _ = geodetic(position)
    (sl, so), (cl, co) = np.sin([latitude, longitude]), np.cos([latitude, longitude])
    rows = [[-so, co, 0.0 * so], [-sl * co, -sl * so, cl], [cl * co, cl * so, sl]]
    return np.stack([np.stack(row, -1) for row in rows], -2)


ORIGIN = np.array([4317000.0, 607000.0, 4642000.0])  # 47 north, 8 east, 1384 m high


class LensTruth(NamedTuple):
    """A camera of Brown's model with two coefficients."""

    focal: float = FOCAL
    centre_u: float = float(CENTRE[0])
    centre_v: float = float(CENTRE[1])
    k1: float = 0.0
    k2: float = 0.0

    def image(self, ray: Floats) -> Floats:
        """Project rays in camera axes (..., 3)."""
        x, y = ray[..., 0] / ray[..., 2], ray[..., 1] / ray[..., 2]
        r2 = x * x + y * y
        scale = self.focal * (1.0 + self.k1 * r2 + self.k2 * r2 * r2)
        return np.stack([scale * x + self.centre_u, scale * y + self.centre_v], -1)


class Scene(NamedTuple):
    """A camera's true places and rotations, landmarks, and which of them each pick is of."""

    camera_m: Floats  # (F, 3) Earth-centred
    rotation: Floats  # (F, 3, 3) from local axes to camera axes
    landmark_m: Floats  # (N, 3) Earth-centred
    frame: Ints  # (P,)
    landmark: Ints  # (P,)


def drone(
    rng: np.random.Generator, frames: int, landmarks: int, *, seen: float = 1.0,
    spacing_m: float = 2.0, height_m: float = 100.0, tilt_deg: float = 30.0,
) -> Scene:  # fmt: skip
    """A drone that flies straight on and looks `tilt_deg` ahead of the nadir.

    `seen` is the part of the landmarks that is picked in each frame.
    """
    heading = rng.uniform(0.0, 360.0)
    along = np.array([np.sin(np.radians(heading)), np.cos(np.radians(heading)), 0.0])
    camera = (np.arange(frames) - frames / 2)[:, None] * spacing_m * along + [0.0, 0.0, height_m]
    angles = np.stack(  # yaw, pitch, roll
        [
            heading + rng.normal(0.0, 5.0, frames),
            tilt_deg - 90.0 + rng.normal(0.0, 4.0, frames),
            rng.normal(0.0, 4.0, frames),
        ],
        -1,
    )
    level = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # looks north
    turned = Rotation.from_euler("ZXY", angles * [-1.0, 1.0, 1.0], degrees=True).as_matrix()
    rotation = level @ turned.swapaxes(1, 2)
    middle = frames // 2
    spread = rng.uniform(-0.3, 0.3, (landmarks, 2)) * np.array(SIZE) / FOCAL
    ray = np.column_stack([spread, np.ones(landmarks)]) @ rotation[middle]
    fall = (camera[middle, 2] - rng.uniform(-5.0, 5.0, landmarks)) / -ray[:, 2]
    ground = camera[middle] + ray * fall[:, None]
    picked = rng.random((frames, landmarks)) < seen
    own = axes(ORIGIN)
    return Scene(ORIGIN + camera @ own, rotation, ORIGIN + ground @ own, *np.nonzero(picked))


def flight_of(
    rng: np.random.Generator, scene: Scene, sigma_px: float, priors: Priors, *,
    velocity_m_s: tuple[float, float, float] = (0.0, 0.0, 0.0), loss: str = "least-squares",
    time_s: Floats | None = None,
) -> Flight:  # fmt: skip
    """A flight whose picks, fixes, places, landmarks, lens and clock are wrong by their sigmas.

    Args:
        rng: the source of what is random
        scene: the truth
        sigma_px: of picks
        priors: the standard deviations; an infinite one draws nothing
        velocity_m_s: east, north, up
        loss: by name
        time_s: of the frames; None: 30 frames a second
    """
    frames, own = len(scene.camera_m), axes(scene.camera_m)
    wrong = {n: rng.normal() * s for n, s in priors.parameter.items() if np.isfinite(s)}
    lens = LensTruth()
    lens = lens._replace(**{n: getattr(lens, n) + wrong[n] for n in LENS if n in wrong})
    away = scene.landmark_m[scene.landmark] - scene.camera_m[scene.frame]
    ray = np.einsum("pij,pjk,pk->pi", scene.rotation[scene.frame], own[scene.frame], away)
    pixel = lens.image(ray) + rng.normal(0.0, sigma_px, (len(ray), 2))
    moved = np.tile([wrong.get(name, 0.0) for name in ("east", "north", "up")], (frames, 1))
    moved += np.array(velocity_m_s) * wrong.get("clock", 0.0)
    if priors.fixes is not None:
        moved += at_frames(priors.fixes, rng.normal(0.0, priors.fixes.sigma_m))
    landmark_m, sigma_m = scene.landmark_m, np.zeros((len(scene.landmark_m), 3))
    if priors.landmark_m is not None:
        sigma_m = priors.landmark_m
        landmark_m = landmark_m - turned_out(axes(landmark_m), rng.normal(0.0, sigma_m))
    return Flight(
        "drawn",
        "drawn.toml",
        Lens(LensKind.BROWN, SIZE, np.full(2, FOCAL), CENTRE, np.zeros(12)),
        np.arange(frames),
        (),
        np.arange(frames) / 30.0 if time_s is None else time_s,
        None,
        Picks(scene.frame, scene.landmark, pixel, np.full(len(pixel), sigma_px)),
        LandmarkSet(tuple(f"P{k}" for k in range(len(landmark_m))), landmark_m, sigma_m),
        CameraPath(
            scene.camera_m - turned_out(own, moved),
            priors.fixes,
            np.array([priors.parameter.get(name, 0.0) for name in ("east", "north", "up")]),
            velocity_m_s=np.tile(np.array(velocity_m_s) @ NED_FROM_ENU, (frames, 1)),
        ),
        np.eye(3),
        Refraction(0.0, False),
        FlightOptions(loss),
    )


def turned_out(own: Floats, vector: Floats) -> Floats:
    """Vectors east, north, up (n, 3) as Earth-centred ones."""
    return np.einsum("nji,nj->ni", own, vector)


def at_frames(fixes: TrackFixes, error: Floats) -> Floats:
    """Errors of fixes (J, 3) at the frames, frame by frame (F, 3)."""
    out = np.zeros((len(fixes.first), 3))
    for frame, (first, weight) in enumerate(zip(fixes.first, fixes.weight, strict=True)):
        for slot, part in enumerate(weight):
            if part:
                out[frame] += part * error[first + slot]
    return out


# A flight of which everything may be wrong, and its equations as one matrix


def random_problem(
    rng: np.random.Generator, width: int, loss: str, rolling: bool
) -> tuple[Flight, Priors, Readout | None]:
    """A drone of which everything may be wrong; each frame between `width` fixes.

    Of three the middle one may be the curvature of a gap.
    """
    scene = drone(rng, 8, 5, seen=0.9)
    fixes = None
    if width:
        first, weight = np.sort(rng.integers(0, 5, 8)), rng.dirichlet(np.ones(width), 8)
        gaps = np.arange(4 + width) % 2 == 1 if width == 3 else None
        fixes = TrackFixes(first, weight, np.tile([1.0, 1.0, 2.0], (4 + width, 1)), gaps)
    marks = np.array([[0.1] * 3, [0.0] * 3, [2.0] * 3, [0.05] * 3, [0.1, 0.1, 0.0]])
    drawn = {"focal": 5.0, "k1": 0.01, "centre_u": 3.0, "clock": 0.05}
    flight = flight_of(
        rng, scene, 1.0, Priors(fixes, marks, drawn), velocity_m_s=(3.0, 4.0, 0.5), loss=loss
    )
    others = {"refraction": 0.1, "p1": 1e-3, "aspect": 1e-3, "clock_rate": 1e-4, "east": 0.5}
    arm_m, readout = np.array([0.3, 0.2, -0.1]), None
    flight = replace(flight, refraction=Refraction(), path=replace(flight.path, lever_arm_m=arm_m))
    if rolling:
        others["readout"] = 0.003
        part = rng.uniform(-0.5, 0.5, len(scene.frame))
        readout = Readout(0.01, part, rng.normal(0.0, 0.3, (8, 3)))
    return flight, Priors(fixes, marks, drawn | others), readout


def accurate_inverse(matrix: Any) -> Floats:
    """Invert a matrix of long doubles with a diagonal above 0: scaled, and refined twice.

    Small parts of a covariance are lost in the rounding of a plain inverse, to 1e-9 of them on some
    processors. Where a long double is a double, the scale alone makes it ten times less.
    """
    scale = 1.0 / np.sqrt(np.diag(matrix))
    scaled = matrix * scale * scale[:, None]
    found = np.linalg.inv(scaled.astype(np.float64)).astype(np.longdouble)
    for _ in range(2):
        found = found + found @ (np.eye(len(scaled)) - scaled @ found)
    return np.asarray(found * scale * scale[:, None], dtype=np.float64)


class Dense:
    """The equations of a solution's picks as one matrix: turns, fixes, then what is common."""

    def __init__(self, solution: JointSolution) -> None:
        model = solution.model
        fixes, self.frames, self.names = model.priors.fixes, model.frames, model.names
        self.since_s = (np.arange(self.frames) - (self.frames - 1) / 2.0) / 30.0
        count = 3 * self.frames + model.fix_sigma_m.size + len(model.common_sigma)
        self.common = count - len(model.common_sigma)  # where it begins
        self.rows = np.zeros((2 * len(model.pick), count))
        self.residual = np.zeros(2 * len(model.pick))
        self.place = np.zeros((self.frames, 3, count))  # of the cameras, by all unknowns
        for frame in range(self.frames):
            if fixes is not None:
                for slot, weight in enumerate(fixes.weight[frame]):
                    at = 3 * self.frames + 3 * (fixes.first[frame] + slot)
                    self.place[frame, :, at : at + 3] += weight * np.eye(3)
            by = model.velocity_m_s[frame]
            for column, name in enumerate(model.names, self.common):
                if name in ("east", "clock", "clock_rate"):
                    since = self.since_s[frame]
                    own = {"east": [1.0, 0.0, 0.0], "clock": by, "clock_rate": by * since}[name]
                    self.place[frame, :, column] = own
        for rows in model.rows(solution.state):
            for b, frame in enumerate(rows.frames):
                for n, pick in enumerate(rows.picks[b]):
                    at = slice(2 * pick, 2 * pick + 2)
                    self.residual[at] = rows.residual[b, n]
                    own = self.rows[at]
                    own[:, : self.common] = (
                        rows.by_place[b, n] @ self.place[frame, :, : self.common]
                    )
                    own[:, 3 * frame : 3 * frame + 3] = rows.by_turn[b, n]
                    parameters = self.common + len(model.names)
                    own[:, self.common : parameters] = rows.by_parameter[b, n]
                    free = np.flatnonzero(model.free == model.landmark[pick])
                    if len(free):
                        column = parameters + 3 * free[0]
                        own[:, column : column + 3] = rows.by_landmark[b, n]
        own = np.zeros(3 * self.frames)
        prior = np.concatenate([model.fix_sigma_m.ravel(), model.common_sigma])
        self.prior = np.concatenate([own, prior**-2.0])
        self.weight = np.repeat(solution.normal.weight, 2)
        state = solution.state
        own_m = state.landmark_m[model.free].ravel()
        self.state = np.concatenate([own, state.fix_m.ravel(), state.parameter, own_m])
        exact, weight = self.rows.astype(np.longdouble), self.weight.astype(np.longdouble)
        normal = exact.T @ (weight[:, None] * exact) + np.diag(self.prior.astype(np.longdouble))
        self.normal = normal.astype(np.float64)
        self.inverse = accurate_inverse(normal)
        common = [name + COMMON_PART for name in model.component]
        between = None if fixes is None else fixes.between
        gaps = np.zeros(len(model.fix_sigma_m), bool) if between is None else between
        each = np.where(np.repeat(gaps, 3), "interpolation", "position").tolist()
        self.component = each + common
        if fixes is not None and fixes.between is not None:
            for at in np.flatnonzero(fixes.between):
                self.component[3 * at : 3 * at + 3] = ["interpolation"] * 3

    def part(self, name: str) -> Floats:
        """The part of a component in the covariance of all unknowns."""
        if name == "reading":
            weighted = self.weight[:, None] * self.rows @ self.inverse
            return weighted.T @ weighted
        own = np.array([one == name for one in self.component])
        prior = np.concatenate([np.zeros(3 * self.frames), self.prior[3 * self.frames :] * own])
        return self.inverse @ (prior[:, None] * self.inverse)

    def marginal_weight(self) -> Floats:
        """The weights of the residuals at the stated places, less what the turns fit."""
        turns, errors = np.split(self.rows, [3 * self.frames], axis=1)
        marginal = np.eye(len(errors)) + errors / self.prior[3 * self.frames :] @ errors.T
        weight = np.asarray(np.linalg.inv(marginal))
        fitted = weight @ turns
        return weight - fitted @ np.linalg.solve(turns.T @ fitted, fitted.T)

    def turns(self, matrix: Floats) -> Floats:
        """The blocks of the frames' turns (F, 3, 3)."""
        return self.turns_and_times(matrix)[:, :3, :3]

    def turns_and_times(self, matrix: Floats) -> Floats:
        """Covariances of each frame's turn and of the error of its time, (F, 4, 4)."""
        found = []
        for frame, since in enumerate(self.since_s):
            by = np.zeros((4, len(matrix)))
            by[:3, 3 * frame : 3 * frame + 3] = np.eye(3)
            for column, name in enumerate(self.names, start=self.common):
                by[3, column] = {"clock": 1.0, "clock_rate": since}.get(name, 0.0)
            found.append(by @ matrix @ by.T)
        return np.array(found)


def scaled_close(quantity: str, actual: Floats, expected: Floats) -> None:
    """Compare with a tolerance of the largest element."""
    scale = np.abs(expected).max()
    assert_close(quantity, actual / scale, expected / scale)
