"""Clicks as unknowns of a flight: picks that a program tracks carry the errors of their clicks.

A click has two offsets that all its tracks share, in every frame. Readings of one pick from
several clicks are no repeated readings: their mean is the pick, and what they differ by says how
far the clicks are off.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.flight.flight import Clicks, FrameSlots


class ClickEquations:
    """The readings of the picks that take part, as equations of the errors of Q clicks.

    Attributes:
        seen: indices of the clicks that they carry, (Q,)
        column: index of the clicks of each pick among those, Q where a slot is empty, (P, S)
        by_click: of each pick by the errors of these clicks, (P, S, 2, 2)
        normal: what readings of the same picks say of the clicks' errors e as e'Ne, by the
            standard deviations of the readings, (2Q, 2Q)
        right: the same as the right side of N e, (2Q,)
        spare: how many readings each pick has besides one, (P,)
    """

    def __init__(self, clicks: Clicks, pick: Ints) -> None:
        """Sort the readings by their picks.

        Args:
            clicks: of all picks
            pick: indices of those that take part, (P,)
        """
        self._readings = own = clicks.of_picks(pick)
        self.seen, self._local = np.unique(own.click, return_inverse=True)
        q = len(self.seen)
        self.spare = np.maximum(np.bincount(own.pick, minlength=len(pick)) - 1, 0)
        self.column, self.by_click = _of_picks(own, self._local, len(pick), q)
        self._weight = own.own_px**-2.0
        weighted = own.by_click * self._weight[:, None, None]
        right = np.zeros((q, 2))
        np.add.at(right, self._local, np.einsum("rij,ri->rj", weighted, own.off_px))
        self.right: Floats = right.ravel()
        self.normal = self._normal(own, len(pick))

    def _normal(self, own: Clicks, picks: int) -> Floats:
        """Multiply the readings' derivatives, the means of their picks taken off."""
        from scipy.sparse import csr_array  # of flights with clicks alone

        q, size = len(self.seen), len(own.pick)
        inside = np.arange(2)
        column = np.broadcast_to(2 * self._local[:, None, None] + inside, (size, 2, 2))
        total = np.bincount(own.pick, self._weight, picks)
        found = np.zeros((2 * q, 2 * q))
        for values, row, sign, rows in (
            (own.by_click * np.sqrt(self._weight)[:, None, None], np.arange(size), 1.0, size),
            (
                own.by_click * (own.part * np.sqrt(total[own.pick]))[:, None, None],
                own.pick, -1.0, picks,
            ),
        ):  # fmt: skip
            at = np.broadcast_to(2 * row[:, None, None] + inside[:, None], (size, 2, 2))
            shape = (2 * rows, 2 * q)
            one = csr_array((values.ravel(), (at.ravel(), column.ravel())), shape)
            found += sign * (one.T @ one).toarray()
        return found

    def _shifts(self, click_px: Floats) -> tuple[Floats, Floats]:
        """Shift readings (R, 2) and their picks (P, 2) by errors of all clicks (C, 2)."""
        own = self._readings
        shift = np.einsum("rij,rj->ri", own.by_click, click_px[own.click])
        mean = np.zeros((len(self.column), 2))
        np.add.at(mean, own.pick, shift * own.part[:, None])
        return shift, mean

    def shift_px(self, click_px: Floats) -> Floats:
        """Shift the picks by errors of the clicks, (P, 2).

        Args:
            click_px: errors of all clicks, (C, 2)
        """
        return self._shifts(click_px)[1]

    def squares(self, click_px: Floats) -> Floats:
        """Add up how far the readings of each pick are apart, (P,): squares over their variances.

        Args:
            click_px: errors of all clicks, (C, 2)
        """
        own = self._readings
        shift, mean = self._shifts(click_px)
        away = own.off_px - shift + mean[own.pick]
        squares = self._weight * (away**2).sum(axis=1)
        return np.bincount(own.pick, squares, len(self.column)).astype(np.float64)


def _of_picks(own: Clicks, click: Ints, picks: int, none: int) -> tuple[Ints, Floats]:
    """Spread readings in the order of their picks: clicks (P, S) and derivatives (P, S, 2, 2)."""
    count = np.bincount(own.pick, minlength=picks)
    slot = np.arange(len(own.pick)) - np.repeat(np.cumsum(count) - count, count)
    slots = int(count.max(initial=0))
    column, by_click = np.full((picks, slots), none), np.zeros((picks, slots, 2, 2))
    column[own.pick, slot] = click
    by_click[own.pick, slot] = own.by_click * own.part[:, None, None]
    return column, by_click


AT_ONCE = 4_000_000  # numbers


def errors_of_frames(clicks: Clicks, slots: FrameSlots, used: Bools) -> Floats:
    """Find errors of the picks of each frame that have the covariance by their clicks, (F, 2L, 2L).

    Args:
        clicks: of the picks
        slots: where each pick stands in arrays of frames
        used: picks that take part, (P,)
    """
    picks, marks = len(slots.frame), slots.slots
    own = clicks.of_picks(np.arange(picks))
    column, by_click = _of_picks(own, own.click, picks, 0)
    root = clicks.root
    if root is None:
        root = np.diag(np.repeat(clicks.sigma_px, 2))
    by_click[~used] = 0.0
    columns, by = slots.spread(column), slots.spread(by_click)
    out = np.zeros((slots.frames, 2 * marks, 2 * marks))
    step = max(AT_ONCE // max(columns[0].size * 2 * root.shape[1], 1), 1)
    for first in range(0, slots.frames, step):
        some = slice(first, first + step)
        rows = root[2 * columns[some][..., None] + np.arange(2)]
        moved = np.einsum("flsac,flscr->falr", by[some], rows)
        moved = moved.reshape(len(moved), 2 * marks, -1)
        size, axes = np.linalg.eigh(moved @ moved.swapaxes(1, 2))
        out[some] = axes * np.sqrt(np.maximum(size, 0.0))[:, None]
    return out
