"""Errors that are the same in all frames of a job, solved for with the reading sigma."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.attitude.residual_test import finite
from vopd.attitude.sigmas import ErrorComponent
from vopd.estimate import Estimate

MOST_LANDMARKS = 100  # whose errors are solved for; of more, each frame has its own
MOST_IN_A_FRAME = 40  # landmarks; a frame with more has its own
MOST_NUMBERS = 20_000_000  # of the columns of all frames


def landmarks_solved_for(estimates: Sequence[Estimate]) -> Ints | None:
    """The numbers of all landmarks of a job; None where each frame has errors of its own.

    Args:
        estimates: the blocks of the job
    """
    numbers = np.unique(np.concatenate([e.landmark[e.used] for e in estimates]))
    sizes = [(len(e.frame), e.used.shape[1]) for e in estimates]
    columns = sum(f * 6 * count**2 for f, count in sizes if count <= MOST_IN_A_FRAME)
    one_frame = sum(frames for frames, _ in sizes) == 1
    few = len(numbers) <= MOST_LANDMARKS and columns <= MOST_NUMBERS
    return None if one_frame or not few else numbers


def solved_for(component: ErrorComponent, numbers: Ints | None) -> bool:
    """Whether the errors of a component are the same in all frames and are solved for.

    Args:
        component: one of the job's errors, in one block
        numbers: those of its landmarks whose errors are solved for
    """
    few = numbers is not None and component.residual.shape[1] <= 2 * MOST_IN_A_FRAME
    return component.common and (few or not component.each_landmark)


class CommonErrors(NamedTuple):
    """Errors that are the same in all frames, one standard deviation each."""

    columns: Floats  # (F, 2L, K) of the residuals
    cause: Ints  # (F, K) which of the job's causes each column is
    causes: int

    def of(self, frames: Bools) -> CommonErrors:
        """Those of some frames."""
        return CommonErrors(self.columns[frames], self.cause[frames], self.causes)

    def summed(self, blocks: Floats) -> Floats:
        """Blocks (F, K, K) of frames added up by their causes."""
        index = self.cause[:, :, None] * self.causes + self.cause[:, None, :]
        total = np.bincount(index.ravel(), blocks.ravel(), self.causes**2)
        return np.asarray(total.reshape(self.causes, self.causes))

    def summed_products(self, weighted: Floats) -> Floats:
        """Weighted residuals (F, 2L) times the columns, added up by their causes."""
        own = (self.columns.swapaxes(1, 2) @ weighted[..., None])[..., 0]
        return np.bincount(self.cause.ravel(), own.ravel(), self.causes).astype(np.float64)


def common_errors(
    estimate: Estimate, components: list[ErrorComponent], frames: Ints, numbers: Ints | None
) -> CommonErrors:
    """The errors of a job that are the same in all frames and are solved for.

    Args:
        estimate: the job, or a block of it
        components: its errors
        frames: indices of frames
        numbers: those of the job's landmarks whose errors are solved for
    """
    count = estimate.used.shape[1]
    columns, causes, number = [], [], 0
    for one in components:
        if not solved_for(one, numbers):
            if one.each_landmark and numbers is not None:
                number += 3 * len(numbers)
            continue
        change = one.residual[frames]
        if numbers is None or not one.each_landmark:
            columns.append(change)
            index = np.arange(change.shape[2])
            causes.append(np.broadcast_to(number + index, (len(frames), len(index))))
            number += len(index)
            continue
        own = np.zeros((len(frames), 2 * count, count, 3))
        at = np.arange(count)
        own[:, at, at], own[:, count + at, at] = change[:, :count], change[:, count:]
        columns.append(own.reshape(len(frames), 2 * count, 3 * count))
        which = np.minimum(np.searchsorted(numbers, estimate.landmark[frames]), len(numbers) - 1)
        index = number + 3 * which[..., None] + np.arange(3)
        causes.append(index.reshape(len(frames), 3 * count))
        number += 3 * len(numbers)
    none = np.zeros((len(frames), 2 * count, 0))
    used = np.tile(estimate.used[frames], 2)
    return CommonErrors(
        finite(np.concatenate([none, *columns], axis=2), used),
        np.concatenate([np.zeros((len(frames), 0), np.int64), *causes], axis=1),
        number,
    )
