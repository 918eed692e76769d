"""Solve the rotation of every frame of a flight by least squares."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools, Floats, Ints
from vopd.flight.flight import CameraPath, Flight
from vopd.flight.solve.lines_of_sight import SightLines, sight_lines
from vopd.geometry.lenses import Lens, Projection, Unseen, project, ray_of_pixel
from vopd.geometry.rotation_fit import huber_weight
from vopd.geometry.rotations import rotation_matrices, rotation_of_directions
from vopd.landmark_layout import AT_ONCE, TOGETHER, LandmarkLayout

# Robust losses: Huber and Cauchy

HUBER = 1.345  # standard deviations from where on the loss grows evenly
CAUCHY = 2.385  # standard deviations; both have 95 % of least squares' efficiency


class Loss(NamedTuple):
    """A loss of z, the squared distance over the squared standard deviation of a pick."""

    value: Callable[[Floats], Floats]
    weight: Callable[[Floats], Floats]  # its derivative
    curvature: Callable[[Floats], Floats]  # its second derivative


def _huber(z: Floats) -> Floats:
    return np.where(z <= HUBER**2, z, 2.0 * HUBER * np.sqrt(z) - HUBER**2)


def _huber_weight(z: Floats) -> Floats:
    return huber_weight(np.sqrt(z), HUBER)


def _huber_curvature(z: Floats) -> Floats:
    return np.where(z <= HUBER**2, 0.0, -0.5 * HUBER / np.maximum(z, HUBER**2) ** 1.5)


def _cauchy(z: Floats) -> Floats:
    return CAUCHY**2 * np.log1p(z / CAUCHY**2)


def _cauchy_weight(z: Floats) -> Floats:
    return 1.0 / (1.0 + z / CAUCHY**2)


def _cauchy_curvature(z: Floats) -> Floats:
    return -((CAUCHY + z / CAUCHY) ** -2.0)


LOSSES = {
    "least-squares": Loss(np.asarray, np.ones_like, np.zeros_like),
    "huber": Loss(_huber, _huber_weight, _huber_curvature),
    "cauchy": Loss(_cauchy, _cauchy_weight, _cauchy_curvature),
}
"""By the names that a project file takes."""


# Linear equations of picks at an attitude, weighted by a loss


class PickBlock(NamedTuple):
    """B frames that have n picks each."""

    lens: Lens
    pixel: Floats  # (B, n, 2) u, v
    direction: Floats  # (B, n, 3) unit vectors east, north, up
    sigma: Floats  # (B, n) of u and v, pixels
    loss: Loss

    def of(self, rows: Bools) -> PickBlock:
        """Take some of the frames, (B,)."""
        return self._replace(
            lens=self.lens.of(rows),
            pixel=self.pixel[rows],
            direction=self.direction[rows],
            sigma=self.sigma[rows],
        )


class PickEquations(NamedTuple):
    """The equations of B frames for a small turn about the camera's axes."""

    rotation: Floats  # (B, 3, 3) where they hold, from local to camera axes
    cost: Floats  # (B,) infinite where a pick has no image
    gradient: Floats  # (B, 3)
    normal: Floats  # (B, 3, 3) of the reweighted equations
    curvature: Floats  # (B, 3, 3) what the loss's own curvature adds to it
    weight: Floats  # (B, n)
    unseen: Ints  # (B, n)

    def of(self, rows: Bools) -> PickEquations:
        """Take the equations of some of the frames, (B,)."""
        return PickEquations._make(part[rows] for part in self)


def equations_at(block: PickBlock, rotation: Floats) -> PickEquations:
    """Linearise the equations of frames at an attitude of each.

    Args:
        block: the frames
        rotation: from local to camera axes, (B, 3, 3)
    """
    seen: Projection = project(block.lens, block.direction @ rotation.swapaxes(1, 2))
    residual = (block.pixel - seen.pixel) / block.sigma[..., None]
    by_turns = seen.by_turns / block.sigma[..., None, None]
    z = residual[..., 0] ** 2 + residual[..., 1] ** 2
    weight = block.loss.weight(z)
    cost = block.loss.value(z).sum(axis=1)
    rows = by_turns.reshape(len(by_turns), -1, 3)
    weighted = (rows * np.repeat(weight, 2, axis=1)[..., None]).swapaxes(1, 2)
    normal = weighted @ rows
    return PickEquations(
        rotation,
        np.where(np.isfinite(cost), cost, np.inf),
        (weighted @ residual.reshape(len(rows), -1, 1))[..., 0],
        normal,
        _curvature(block.loss, z, by_turns, residual, normal),
        weight / block.sigma**2,
        seen.unseen,
    )


def _curvature(loss: Loss, z: Floats, by_turns: Floats, residual: Floats, normal: Floats) -> Floats:
    """Estimate the loss's own curvature in the normal equations (B, 3, 3)."""
    if loss is LOSSES["least-squares"]:
        return np.zeros_like(normal)
    outward = (by_turns.swapaxes(2, 3) @ residual[..., None])[..., 0]
    curved = outward * (2.0 * loss.curvature(z))[..., None]
    return np.asarray(curved.swapaxes(1, 2) @ outward)


# The first attitude: Wahba's problem

UNDETERMINED = 1e-10  # of the sum of weights: the turn about one direction is not held


def first_attitude(ray: Floats, direction: Floats, weight: Floats) -> tuple[Floats, Bools]:
    """Solve Wahba's problem by singular values: no estimate is needed.

    With B the sum of weight ray direction', B = U S V', the rotation that makes the
    sum of weight ``|ray - R direction|^2`` least is U diag(1, 1, det U det V) V'. Where
    the second singular value and the signed third cancel, every turn about one
    direction fits alike: all landmarks lie on one line through the camera.

    Args:
        ray: unit vectors in camera axes, (B, n, 3)
        direction: unit vectors in local axes, (B, n, 3)
        weight: of each, 0 for one that takes no part, (B, n)

    Returns:
        The rotations from local to camera axes (B, 3, 3), and whether the directions determine
        them, (B,).
    """
    known = np.asarray(np.isfinite(np.concatenate([ray, direction], axis=2)).all(axis=2))
    w = np.where(known, weight, 0.0)
    total = w.sum(axis=1)
    w = w / np.where(total > 0.0, total, 1.0)[:, None]
    rays = np.where(known[..., None], ray, 0.0)
    directions = np.where(known[..., None], direction, 0.0)
    rotation, sizes = rotation_of_directions(rays, directions, w)
    return rotation, sizes[:, 1] + sizes[:, 2] > UNDETERMINED


# Least squares of rotations, the camera's position known
#
# Residuals are pixels in the image as it was taken, measured minus computed, over
# the standard deviation of the pick. Frames with like numbers of picks are solved
# together over arrays.

PASSES = 500
WORK, WORK_A_PICK = 1_000_000, 12  # picks times passes that frames without hope may not exceed
SMALL_RAD = 1e-13  # a step that ends a frame
SMALL_STEP = 1e-7  # rad; its change of the cost is rounding
NOISE_RAD, NOISE_AT_MOST_RAD = 1e-11, 1e-8
STALE, FALLEN = 30, 1e-12  # passes in which the cost has not fallen by that part: no more is gained
LEAST_DAMPING, MOST_DAMPING = 1e-12, 1e12


class Attitudes(NamedTuple):
    """The rotation of every frame, F frames and P picks."""

    rotation: Floats  # (F, 3, 3) from local east, north, up to camera axes; NaN where not solved
    correction_rad: Floats  # (F, 3) the last one, about the camera's axes
    converged: Bools  # (F,)
    weight: Floats  # (P,) 1/px^2, with the loss's; 0 for a pick that takes no part
    set_aside: NDArray[np.int8]  # (P,) of `Unseen`: picks without an image at the solution

    def put(self, frames: Ints, picks: Ints, part: Attitudes) -> None:
        """Write down those of some frames and their picks."""
        self.rotation[frames], self.correction_rad[frames] = part.rotation, part.correction_rad
        self.converged[frames] = part.converged
        self.weight[picks], self.set_aside[picks] = part.weight, part.set_aside


def no_attitudes(frames: int, picks: int) -> Attitudes:
    """Make the attitudes of frames before any solve."""
    return Attitudes(
        np.full((frames, 3, 3), np.nan),
        np.full((frames, 3), np.nan),
        np.zeros(frames, bool),
        np.zeros(picks),
        np.zeros(picks, np.int8),
    )


@np.errstate(all="ignore")
def solve_rotations(
    lens: Lens,
    frames: int,
    frame: Ints,
    pixel: Floats,
    sigma_px: Floats,
    direction: Floats,
    used: Bools,
    loss: str = "least-squares",
    passes: int = PASSES,
    picks: int | None = None,
) -> Attitudes:
    """Solve all frames that have two picks or more.

    Args:
        lens: the camera's lens
        frames: how many frames there are
        frame: index of each pick's frame, (P,)
        pixel: u, v of each pick, (P, 2)
        sigma_px: standard deviation of each pick's u and v, (P,)
        direction: unit vectors east, north, up to each pick's landmark, (P, 3)
        used: picks that take part, (P,)
        loss: a name of `LOSSES`
        passes: after how many a frame is left as it is, not converged; many frames that
            do not converge are left earlier
        picks: how many there are, where these frames are some of a flight's
    """
    out = no_attitudes(frames, len(frame))
    work = WORK_A_PICK + WORK / max(picks or len(frame), 1)
    seen = np.isfinite(direction).all(axis=1)
    placed = np.bincount(frame[seen], minlength=frames) > 0  # frames whose camera has a place
    out.set_aside[used & ~seen & placed[frame]] = Unseen.NOWHERE
    usable = used & seen & np.isfinite(pixel).all(axis=1)
    ray = ray_of_pixel(lens.of(frame), pixel)
    outside = usable & ~np.isfinite(ray).all(axis=1)
    out.set_aside[outside] = Unseen.OUTSIDE_FIELD
    usable &= ~outside
    for _ in range(3):  # once more for frames of which a pick has been set aside
        again = np.zeros(frames, bool)
        for index, rows in blocks_by_count(
            frames, frame, usable & np.isnan(out.rotation[frame, 0, 0])
        ):
            own = lens.of(index)
            block = PickBlock(own, pixel[rows], direction[rows], sigma_px[rows], LOSSES[loss])
            rotation, determined = first_attitude(ray[rows], block.direction, block.sigma**-2.0)
            state = equations_at(block, rotation)
            lost = np.isinf(state.cost)
            out.set_aside[rows[lost]] = state.unseen[lost]
            again[index[lost]] = True
            good = determined & ~lost
            if good.any():
                frames_left = index[good], rows[good]
                _solve(block.of(good), state.of(good), out, *frames_left, passes, work)
        usable &= out.set_aside == 0
        if not again.any():
            break
    return out


def blocks_by_count(frames: int, frame: Ints, usable: Bools) -> list[tuple[Ints, Ints]]:
    """Sort frames (B,) and their picks (B, n) into a block for each number of picks from two on."""
    count = np.bincount(frame[usable], minlength=frames)
    picks = np.flatnonzero(usable)
    picks = picks[np.argsort(frame[picks], kind="stable")]
    first = np.cumsum(count) - count
    blocks = []
    for n in np.unique(count[count >= 2]):
        index = np.flatnonzero(count == n)
        blocks.append((index, picks[first[index][:, None] + np.arange(n)]))
    return blocks


def _solve(
    block: PickBlock,
    state: PickEquations,
    out: Attitudes,
    index: Ints,
    rows: Ints,
    passes: int,
    work_a_pick: float,
) -> None:
    """Solve a block by Levenberg and Marquardt on a rotation vector; frames leave it when done."""
    damping = np.full(len(index), 1e-6)
    before = np.full(len(index), np.inf)
    least, stale = state.cost, np.zeros(len(index))
    work = work_a_pick * rows.size
    for _ in range(passes):
        turn = damped_turn(state, damping)
        size = np.abs(turn).max(axis=1)
        finite = np.isfinite(size)
        by = rotation_matrices(turn if finite.all() else np.nan_to_num(turn))
        tried = equations_at(block, by @ state.rotation)
        # within rounding of the cost a small step is taken as it is
        better = (tried.cost <= state.cost) | (size < SMALL_STEP)
        better &= np.isfinite(tried.cost) & finite
        state = _chosen(better, tried, state)
        damping = np.where(better, np.maximum(damping / 10.0, LEAST_DAMPING), damping * 10.0)
        # a step that no longer shrinks is rounding
        noise = ((size < NOISE_RAD) & (size > 0.9 * before)) | (
            (size < NOISE_AT_MOST_RAD) & (size >= before)
        )
        stale = np.where(state.cost < least * (1.0 - FALLEN), 0.0, stale + 1.0)
        least = np.minimum(least, state.cost)
        done = (better & ((size < SMALL_RAD) | noise)) | (damping > MOST_DAMPING)
        done |= stale >= STALE
        before = np.where(better, size, before)
        work -= rows.size
        if done.any():
            _keep(out, index, rows, state, turn, done, size < NOISE_AT_MOST_RAD)
            if done.all():
                return
            left = ~done
            block, index, rows, state = block.of(left), index[left], rows[left], state.of(left)
            damping, before, turn = damping[left], before[left], turn[left]
            least, stale = least[left], stale[left]
        if work < 0:
            break
    _keep(out, index, rows, state, turn, index >= 0, np.abs(turn).max(axis=1) < NOISE_AT_MOST_RAD)


def damped_turn(state: PickEquations, damping: Floats) -> Floats:
    """Solve for the turn (B, 3) of each frame; NaN if the damped equations have no minimum.

    Reweighting alone closes in slowly where many picks lie on the flat part of a
    loss: its curvature makes the step Newton's.
    """
    diagonal = np.einsum("bii->bi", state.normal)
    damped = state.normal + state.curvature
    damped = damped + np.eye(3) * (damping[:, None] * diagonal)[:, None, :]
    a, b, c, _, d, e, _, _, f = damped.reshape(-1, 9).T
    second = a * d - b * b
    third = f * second - a * e * e + 2.0 * b * c * e - d * c * c
    definite = (a > 0.0) & (second > 0.0) & (third > 0.0)
    if not definite.all():
        damped[~definite] = np.eye(3)
    turn = np.linalg.solve(damped, state.gradient[..., None])[..., 0]
    turn[~definite] = np.nan
    return np.asarray(turn)


def _chosen(better: Bools, tried: PickEquations, state: PickEquations) -> PickEquations:
    """Choose the state of each frame: the one that was tried if it is better."""
    if better.all():
        return tried
    return PickEquations(
        *(
            np.where(better.reshape(-1, *[1] * (new.ndim - 1)), new, old)
            for new, old in zip(tried, state, strict=True)
        )
    )


def _keep(
    out: Attitudes,
    index: Ints,
    rows: Ints,
    state: PickEquations,
    turn: Floats,
    done: Bools,
    converged: Bools,
) -> None:
    """Write down the frames that are done."""
    out.rotation[index[done]] = state.rotation[done]
    out.correction_rad[index[done]] = turn[done]
    out.converged[index[done]] = converged[done]
    out.weight[rows[done]] = state.weight[done]


# Blocks of frames: work arrays grow neither with the flight nor with one long frame


class FlightPart(NamedTuple):
    """Some frames of a flight as a flight of their own."""

    frames: Ints  # their indices (B,)
    picks: Ints  # the indices of their picks
    flight: Flight


class FlightBlocks:
    """The frames of a flight in blocks that have like numbers of picks.

    Attributes:
        flight: the flight
        layout: how many picks each frame has
    """

    def __init__(self, flight: Flight) -> None:
        self.flight = flight
        self.layout = LandmarkLayout(
            np.bincount(flight.picks.frame, minlength=len(flight.frame)).astype(np.int64)
        )
        frame = flight.picks.frame
        in_order = bool((frame[1:] >= frame[:-1]).all())
        self._order = None if in_order else np.argsort(frame, kind="stable")

    def __iter__(self) -> Iterator[FlightPart]:
        runs = self.layout.runs(TOGETHER, AT_ONCE)
        return (self.part(frames) for blocks in runs for frames in blocks)

    def parts(self, chosen: Bools) -> Iterator[FlightPart]:
        """Iterate over the blocks with the chosen frames alone, without those that have none.

        Args:
            chosen: (F,)
        """
        for frames in self.layout.blocks(AT_ONCE):
            if chosen[frames].any():
                yield self.part(frames[chosen[frames]])

    def picks(self, frames: Ints) -> Ints:
        """Locate the picks of some frames, one frame after the other: their indices."""
        rows = self.layout.rows(frames)
        return rows if self._order is None else np.asarray(self._order[rows])

    def part(self, frames: Ints) -> FlightPart:
        """Take some of the frames as a flight of their own."""
        flight, rows = self.flight, self.picks(frames)
        if len(frames) == len(flight.frame):
            return FlightPart(frames, np.arange(len(flight.picks.frame)), flight)
        picks = replace(
            flight.picks,
            frame=np.repeat(np.arange(len(frames)), self.layout.count[frames]),
            landmark=flight.picks.landmark[rows],
            pixel=flight.picks.pixel[rows],
            sigma_px=flight.picks.sigma_px[rows],
            part=None if flight.picks.part is None else flight.picks.part[rows],
            followed=None if flight.picks.followed is None else flight.picks.followed[rows],
            clicks=None if flight.picks.clicks is None else flight.picks.clicks.of_picks(rows),
        )
        part = replace(
            flight,
            lens=flight.lens.of(frames),
            frame=flight.frame[frames],
            image_name=tuple(flight.image_name[k] for k in frames) if flight.image_name else (),
            time_s=flight.time_s[frames],
            picks=picks,
            path=path_part(flight.path, frames),
            grid=None if flight.grid is None else flight.grid.take(frames),
        )
        return FlightPart(frames, rows, part)


def path_part(path: CameraPath, frames: Ints) -> CameraPath:
    """Cut some frames out of the path: its arrays with two axes are by frame."""
    values: dict[str, Any] = {field.name: getattr(path, field.name) for field in fields(path)}
    by_frame = {name: v[frames] for name, v in values.items() if np.ndim(v) == 2}
    fixes = None if path.fixes is None else path.fixes.of_frames(frames)
    return replace(path, fixes=fixes, **by_frame)


# A flight solved, with the lever arm iterated

LEVER_PASSES = 4  # an arm of a metre at 20 m range converges by a factor of 20 each


@dataclass(frozen=True, eq=False)
class SolvedFlight:
    """A flight's rotations, or those of some of its frames."""

    flight: Flight
    camera_m: Floats  # (F, 3) Earth-centred, the lever arm applied
    attitudes: Attitudes
    used: Bools  # (P,) picks that were to take part
    raised_most_rad: float  # by refraction, of all lines of sight; NaN where there is none
    landmark_m: Floats | None = None  # (N, 3) Earth-centred, where they were solved for

    @cached_property
    def lines(self) -> SightLines:
        """The lines of sight that the rotations were solved from."""
        return _lines(self.flight, self.camera_m, self.landmark_m)

    def part(self, part: FlightPart) -> SolvedFlight:
        """Take some of the frames of the solution."""
        if part.flight is self.flight:
            return self
        attitudes, frames, picks = self.attitudes, part.frames, part.picks
        return SolvedFlight(
            part.flight,
            self.camera_m[frames],
            Attitudes(
                attitudes.rotation[frames],
                attitudes.correction_rad[frames],
                attitudes.converged[frames],
                attitudes.weight[picks],
                attitudes.set_aside[picks],
            ),
            self.used[picks],
            self.raised_most_rad,
            self.landmark_m,
        )


def pick_distances_px(solved: SolvedFlight) -> Floats:
    """Measure how far each pick is from its landmark's image, (P,)."""
    return np.asarray(np.hypot(*pick_errors_px(solved).T))


def pick_errors_px(solved: SolvedFlight) -> Floats:
    """Subtract from each pick its landmark's image, (P, 2); NaN where it has none."""
    flight = solved.flight
    rotation = solved.attitudes.rotation[flight.picks.frame]
    ray = np.einsum("pij,pj->pi", rotation, solved.lines.direction)
    seen = project(flight.lens.of(flight.picks.frame), ray).pixel
    return np.asarray(flight.picks.pixel - seen)


def solve(
    flight: Flight,
    left_out: Bools | None = None,
    passes: int = PASSES,
    before: SolvedFlight | None = None,
) -> SolvedFlight:
    """Solve all frames of a flight.

    Args:
        flight: the flight
        left_out: picks that take no part besides those of check landmarks, (P,)
        passes: after how many a frame is left as it is
        before: the flight solved with other picks left out; frames with the same picks are not
            solved again
    """
    takes_part = flight.landmarks.takes_part
    used = takes_part[flight.picks.landmark]
    if left_out is not None:
        used &= ~left_out
    changed = np.ones(len(flight.frame), bool)
    if before is None:
        camera_m = flight.path.position_m.copy()
        attitudes, raised = no_attitudes(len(flight.frame), len(used)), np.nan
    else:
        camera_m, raised = before.camera_m.copy(), before.raised_most_rad
        attitudes = deepcopy(before.attitudes)
        changed[:] = False
        changed[flight.picks.frame[used != before.used]] = True
    for part in FlightBlocks(flight).parts(changed):
        at, found, lines = _solve_part(part.flight, used[part.picks], passes, len(used))
        camera_m[part.frames] = at
        attitudes.put(part.frames, part.picks, found)
        raised = np.fmax(raised, np.fmax.reduce(lines.raised_rad, initial=np.nan))
    return SolvedFlight(flight, camera_m, attitudes, used, float(raised))


def _solve_part(
    flight: Flight, used: Bools, passes: int, picks: int
) -> tuple[Floats, Attitudes, SightLines]:
    """Solve position, attitudes and lines of sight of some frames of a flight of so many picks."""
    camera_m = flight.path.position_m
    arm = np.zeros(3) if flight.path.lever_arm_m is None else flight.path.lever_arm_m
    for left in range(LEVER_PASSES * bool(arm.any()), -1, -1):
        lines = _lines(flight, camera_m)
        attitudes = solve_rotations(
            flight.lens,
            len(flight.frame),
            flight.picks.frame,
            flight.picks.pixel,
            flight.picks.sigma_px,
            lines.direction,
            used,
            flight.options.loss,
            passes,
            picks,
        )
        if left:
            to_local = attitudes.rotation.swapaxes(1, 2) @ flight.mount.T
            away = np.einsum("fji,fjk,k->fi", lines.axes, to_local, arm)
            camera_m = flight.path.position_m + away
    return camera_m, attitudes, lines


def _lines(flight: Flight, camera_m: Floats, landmark_m: Floats | None = None) -> SightLines:
    picks = flight.picks
    marks = flight.landmarks.position_m if landmark_m is None else landmark_m
    return sight_lines(camera_m, marks, picks.frame, picks.landmark, flight.refraction)
