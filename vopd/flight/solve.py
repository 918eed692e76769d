"""The rotation of every frame of a flight by least squares, the camera's position known.

Residuals are pixels in the image as it was taken, measured minus computed, over
the standard deviation of the pick. Frames with like numbers of picks are solved
together over arrays.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vopd.arrays import Bools, Floats, Ints
from vopd.flight.first_attitude import first_attitude
from vopd.flight.pick_equations import PickBlock, PickEquations, equations_at
from vopd.flight.robust_loss import LOSSES
from vopd.geometry.lenses import Lens, Unseen, ray_of_pixel
from vopd.geometry.rotation_vector import rotation_matrices

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
    """Attitudes of frames that are not solved."""
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
    usable = used & np.isfinite(direction).all(axis=1) & np.isfinite(pixel).all(axis=1)
    ray = ray_of_pixel(lens, pixel)
    outside = usable & ~np.isfinite(ray).all(axis=1)
    out.set_aside[outside] = Unseen.OUTSIDE_FIELD
    usable &= ~outside
    for _ in range(3):  # once more for frames of which a pick has been set aside
        again = np.zeros(frames, bool)
        for index, rows in _blocks(frames, frame, usable & np.isnan(out.rotation[frame, 0, 0])):
            block = PickBlock(lens, pixel[rows], direction[rows], sigma_px[rows], LOSSES[loss])
            start = first_attitude(ray[rows], block.direction, block.sigma**-2.0)
            state = equations_at(block, start.rotation)
            lost = np.isinf(state.cost)
            out.set_aside[rows[lost]] = state.unseen[lost]
            again[index[lost]] = True
            good = start.determined & ~lost
            if good.any():
                frames_left = index[good], rows[good]
                _solve(block.of(good), state.of(good), out, *frames_left, passes, work)
        usable &= out.set_aside == 0
        if not again.any():
            break
    return out


def _blocks(frames: int, frame: Ints, usable: Bools) -> list[tuple[Ints, Ints]]:
    """Frames (B,) and their picks (B, n), a block for each number of picks from two on."""
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
    """Levenberg and Marquardt on a rotation vector; frames that are done leave the block."""
    damping = np.full(len(index), 1e-6)
    before = np.full(len(index), np.inf)
    least, stale = state.cost, np.zeros(len(index))
    work = work_a_pick * rows.size
    for _ in range(passes):
        turn = _step(state, damping)
        size = np.abs(turn).max(axis=1)
        turned = rotation_matrices(np.nan_to_num(turn)) @ state.rotation
        tried = equations_at(block, turned)
        # within rounding of the cost a small step is taken as it is
        better = (tried.cost <= state.cost) | (size < SMALL_STEP)
        better &= np.isfinite(tried.cost) & np.isfinite(size)
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
        _keep(out, index, rows, state, turn, done, size < NOISE_AT_MOST_RAD)
        left = ~done
        if done.all():
            return
        work -= rows.size
        if work < 0:
            break
        block, index, rows = block.of(left), index[left], rows[left]
        state = state.of(left)
        damping, before, turn = damping[left], np.where(better, size, before)[left], turn[left]
        least, stale = least[left], stale[left]
    _keep(out, index, rows, state, turn, index >= 0, np.abs(turn).max(axis=1) < NOISE_AT_MOST_RAD)


def _step(state: PickEquations, damping: Floats) -> Floats:
    """The turn (B, 3) of each frame; NaN where the damped equations have no minimum.

    Reweighting alone closes in slowly where many picks lie on the flat part of a
    loss: its curvature makes the step Newton's.
    """
    diagonal = np.einsum("bii->bi", state.normal)
    damped = state.normal + state.curvature
    damped = damped + np.eye(3) * (damping[:, None] * diagonal)[:, None, :]
    (a, b, c), (_, d, e), (_, _, f) = np.moveaxis(damped, 0, -1)
    second = a * d - b * b
    minors = [a, second, f * second - a * e * e + 2.0 * b * c * e - d * c * c]
    definite = np.all([minor > 0.0 for minor in minors], axis=0)
    normal = np.where(definite[:, None, None], damped, np.eye(3))
    turn = np.linalg.solve(normal, state.gradient[..., None])[..., 0]
    return np.asarray(np.where(definite[:, None], turn, np.nan))


def _chosen(better: Bools, tried: PickEquations, state: PickEquations) -> PickEquations:
    """The state of each frame: the one that was tried where it is better."""
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
