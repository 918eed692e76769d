"""The equations of the picks of frames at an attitude, weighted by a loss."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.flight.robust_loss import LOSSES, Loss
from vopd.geometry.lenses import Lens, Projection, project


class PickBlock(NamedTuple):
    """B frames that have n picks each."""

    lens: Lens
    pixel: Floats  # (B, n, 2) u, v
    direction: Floats  # (B, n, 3) unit vectors east, north, up
    sigma: Floats  # (B, n) of u and v, pixels
    loss: Loss

    def of(self, rows: Bools) -> PickBlock:
        """Some of the frames, (B,)."""
        return self._replace(
            pixel=self.pixel[rows], direction=self.direction[rows], sigma=self.sigma[rows]
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
        """Those of some of the frames, (B,)."""
        return PickEquations._make(part[rows] for part in self)


def equations_at(block: PickBlock, rotation: Floats) -> PickEquations:
    """The equations of frames at an attitude of each.

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
    """What the loss's own curvature adds to the normal equations (B, 3, 3)."""
    if loss is LOSSES["least-squares"]:
        return np.zeros_like(normal)
    outward = (by_turns.swapaxes(2, 3) @ residual[..., None])[..., 0]
    curved = outward * (2.0 * loss.curvature(z))[..., None]
    return np.asarray(curved.swapaxes(1, 2) @ outward)
