"""Normal equations of a flight: its rotations eliminated, its fixes a chain, the rest dense.

With x the place of a frame's camera, c what is common to the flight and u the turn of the frame,
the equations of u are eliminated by 3 x 3; what they say of x is handed to the fixes that it lies
between, which are coupled to their neighbours alone.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from vopd.arrays import Array, Floats, Ints
from vopd.flight.flight import TrackFixes
from vopd.flight.solve.equations import LinearisedPicks, Model, State
from vopd.flight.solve.rotations import LOSSES
from vopd.geometry.banded import BlockTridiagonal

MOST_KEPT = 50_000  # picks whose equations are kept, about 300 bytes each
LEAST_CURVED = 1e-3  # of the reweighted equations: with less the loss's curvature has no minimum


class Eliminated(NamedTuple):
    """B frames of which the turns are eliminated.

    Their q further unknowns are the camera's place, if it is not exact, the parameters, the
    landmarks of the frame, and the clicks that its picks carry.
    """

    frames: Ints  # (B,)
    inverse: Array  # (B, 3, 3) of the equations of the turns
    mixed: Array  # (B, 3, q) of turns and further unknowns
    column: Ints  # (B, q) or (B, q - 3): where parameters and landmarks are in what is common


class RightSide(NamedTuple):
    """Right sides of normal equations, k of them."""

    turn: Floats  # (F, 3, k)
    place: Floats  # (F, 3, k)
    fix: Floats  # (J, 3, k) besides what the places hand on
    common: Floats  # (K, k)


class Normal:
    """The normal equations of all unknowns at a state.

    Attributes:
        cost: the sum of all losses and squares of priors; infinite where a pick has no image
        frame_cost: the losses of each frame, and its part in the priors of its fixes, (F,)
        residual: of the picks that take part, in their standard deviations, (P, 2)
        weight: of the loss, (P,)
        right: the right side of the next step
        parts: the frames' turns, eliminated
        place: what the frames say of their places, (F, 3, 3)
        border: of their places and what is common, handed to the fixes, (3J, K)
        common: of what is common, (K, K)
        log_determinant: of the turns
        plain: whether nothing but the reweighting is in them
    """

    def __init__(
        self, model: Model, state: State, newton: bool = False, carry: complex = 0.0,
        damping: Floats | None = None, rows: list[LinearisedPicks] | None = None,
    ) -> None:  # fmt: skip
        """Form the equations.

        Args:
            model: the flight
            state: where
            newton: with the loss's own curvature, where the frame has a minimum with it
            carry: multiplies the weights by 1 + carry times themselves, for a derivative
            damping: Levenberg's of each frame, (F,): a part of the diagonal
            rows: the equations of the picks, if they are known at this state
        """
        self.model, self.state, self._newton, self._carry = model, state, newton, carry
        self.damping = None if damping is None or not damping.any() else damping
        kind = np.result_type(np.float64, type(carry)) if carry else np.dtype(np.float64)
        self.plain = not (newton or carry) and self.damping is None
        self.size = len(model.common_sigma)
        self._wide = self.size + 3  # landmarks that are exact write into the last three
        self.fixes = model.fixes_at(state)
        self.residual, self.weight = np.zeros((len(model.pick), 2)), np.ones(len(model.pick))
        self.place = np.zeros((model.frames, 3, 3), kind)
        fixes = 0 if self.fixes is None else self.fixes.blocks * self.fixes.together
        self._border = np.zeros((3 * fixes, self._wide), kind)
        self._common = np.zeros((self._wide, self._wide), kind)
        self._turn, self._place = np.zeros((model.frames, 3)), np.zeros((model.frames, 3))
        self._right = np.zeros(self._wide)
        self.parts: list[Eliminated] = []
        self.frame_cost = model.prior_cost_of_frames(state)
        self.cost, self.log_determinant = model.prior_cost(state), 0.0
        self._kept = rows
        for some in self._rows():
            self._eliminate(some)
        self.border, self.common = self._border[:, : self.size], self._common[:-3, :-3]
        common = model.common_of(state)
        if model.clicks is not None:
            own, clicks = model.of_clicks, model.clicks
            self.common[own, own] += clicks.normal * (1.0 + carry)
            self._right[own] += clicks.right - clicks.normal @ common[own]
            self.cost += float(clicks.squares(state.click_px).sum())
        self.right = RightSide(
            self._turn[..., None],
            self._place[..., None],
            -(state.fix_m / model.fix_sigma_m**2)[..., None],
            (self._right[: self.size] - common / model.common_sigma**2)[:, None],
        )

    @np.errstate(all="ignore")
    def _eliminate(self, rows: LinearisedPicks) -> None:
        """Form the equations of some frames, and eliminate their turns."""
        loss, z = self.model.loss, (rows.residual**2).sum(axis=2)
        cost, weight = loss.value(z).sum(axis=1), loss.weight(z)
        cost = np.where(np.isfinite(cost), cost, np.inf)
        self.cost += float(cost.sum())
        self.frame_cost[rows.frames] += cost
        self.residual[rows.picks], self.weight[rows.picks] = rows.residual, weight
        if not np.isfinite(self.cost):
            return
        further, index = self.model.further(rows)
        count, n = rows.picks.shape
        turn = rows.by_turn.reshape(count, 2 * n, 3)
        across, across_further = turn.swapaxes(1, 2), further.swapaxes(1, 2)
        once = (rows.residual * weight[..., None]).reshape(count, 2 * n, 1)
        right, right_further = across @ once, (across_further @ once)[..., 0]
        if loss is not LOSSES["least-squares"]:
            # the transposed rows are weighted: they stand on the left of every product below
            across, across_further = self._weighted(rows, turn, further, weight, z)
        normal = across @ turn
        if self.damping is not None:
            normal = normal + self.damping[rows.frames, None, None] * (normal * np.eye(3))
        if not np.iscomplexobj(normal):
            triangle = np.linalg.cholesky(normal)
            self.log_determinant += 2.0 * float(np.log(np.einsum("bii->bi", triangle)).sum())
        inverse, mixed = np.linalg.inv(normal), across @ further
        beside = turn @ (inverse @ mixed)
        np.subtract(further, beside, out=beside)  # what no turn of the frame explains
        plain = loss is LOSSES["least-squares"] and self.damping is None
        # as a square it is never negative, whatever the rounding
        left = beside if plain else across_further.swapaxes(1, 2)
        self.parts.append(Eliminated(rows.frames, inverse, mixed, index))
        self._turn[rows.frames] = right[..., 0]
        if self.fixes is not None:
            self._place[rows.frames], right_further = right_further[:, :3], right_further[:, 3:]
            self._hand_on(rows.frames, left[..., :3].swapaxes(1, 2) @ beside, index)
            left, beside = left[..., 3:], beside[..., 3:]
        _add(self._right, index, right_further)
        if (index == index[0]).all():  # the same landmarks: one product of all frames
            every = beside.reshape(count * 2 * n, -1)
            total = (every if plain else left.reshape(every.shape)).T @ every
            _add(self._common, index[0][:, None] * self._wide + index[0], total)
        elif index.shape[1] >= MANY and 2 * index.shape[1] >= self._wide:  # as many clicks are
            every = self._spread(beside, index)
            self._common += (every if plain else self._spread(left, index)).T @ every
        else:
            total = left.swapaxes(1, 2) @ beside
            _add(self._common, index[:, :, None] * self._wide + index[:, None], total)

    def _spread(self, values: Array, index: Ints) -> Array:
        """Spread the columns of frames' rows (B, m, q) over all that is common, (B m, K)."""
        count, rows, _ = values.shape
        full = np.zeros((count * rows, self._wide), values.dtype)
        first = np.arange(count * rows).reshape(count, rows, 1) * self._wide
        _add(full, first + index[:, None], values)
        return full

    def _weighted(
        self, rows: LinearisedPicks, turn: Floats, further: Floats, weight: Floats, z: Floats
    ) -> tuple[Array, Array]:
        """Weigh the transposed rows by the loss, and its curvature where there is a minimum."""
        matrix: Array = weight[..., None, None] * np.eye(2)
        if self._carry:
            matrix = matrix * (1.0 + self._carry * weight[..., None, None])
        if self._newton:
            both = rows.residual[..., :, None] * rows.residual[..., None, :]
            curved = matrix + 2.0 * self.model.loss.curvature(z)[..., None, None] * both
            own, plain = (
                np.linalg.eigvalsh((rows.by_turn.swapaxes(2, 3) @ one @ rows.by_turn).sum(axis=1))
                for one in (curved, matrix)
            )
            definite = own[:, 0] > LEAST_CURVED * plain[:, 0]
            matrix = np.where(definite[:, None, None, None], curved, matrix)
        count, n = weight.shape
        weighted = (matrix @ one.reshape(count, n, 2, -1) for one in (turn, further))
        across, more = (one.reshape(count, 2 * n, -1).swapaxes(1, 2) for one in weighted)
        return across, more

    def again(
        self, newton: bool = False, carry: complex = 0.0, damping: Floats | None = None
    ) -> Normal:
        """Form the equations at the same state in another way; those of few picks are known."""
        return Normal(self.model, self.state, newton, carry, damping, self._kept)

    def _hand_on(self, frames: Ints, left: Array, index: Ints) -> None:
        """Hand what frames say of their places (B, 3, q) to the fixes."""
        assert self.fixes is not None
        self.place[frames] = left[..., :3]
        if self.size:
            weight, first = self.fixes.by_block[frames], self.fixes.block[frames]
            if self.fixes.together > NARROW:
                self._hand_on_wide(frames, left[..., 3:], index)
                return
            same, at = bool((index == index[0]).all()), np.arange(len(first))
            if same:  # landmarks: one sum of a fix's frames
                at = np.flatnonzero(np.append(True, first[1:] != first[:-1]))
            row = (3 * self.fixes.together * first[at])[:, None, None] + np.arange(3)[:, None]
            to = row * self._wide + index[at][:, None]
            for slot in np.flatnonzero(weight.any(axis=0)):
                values = left[..., 3:] * weight[:, slot, None, None]
                if same:
                    values = np.add.reduceat(values, at, axis=0)
                _add(self._border, to + 3 * slot * self._wide, values)

    def _hand_on_wide(self, frames: Ints, left: Array, index: Ints) -> None:
        """Hand what frames say of their places and of what is common to blocks of many fixes."""
        assert self.fixes is not None
        full = np.zeros((len(frames), 3, self._wide), left.dtype)
        full[np.arange(len(frames))[:, None], :, index] = left.swapaxes(1, 2)
        rows = 3 * self.fixes.together
        for block, some in frames_by_block(self.fixes, frames):
            weight = self.fixes.by_block[frames[some]]
            both = np.tensordot(weight, full[some], axes=(0, 0)).reshape(2 * rows, -1)
            self._border[block * rows : (block + 2) * rows] += both

    def _rows(self) -> Iterable[LinearisedPicks]:
        """Iterate over the equations of all picks, kept if they are few."""
        if self._kept is None and len(self.model.pick) <= MOST_KEPT:
            self._kept = list(self.model.rows(self.state))
        return self.model.rows(self.state) if self._kept is None else self._kept

    def right_side(self, values: Floats) -> RightSide:
        """Multiply the transposed rows by values of the picks.

        Args:
            values: with their weights, in standard deviations of the picks, (P, 2, k)
        """
        k = values.shape[2]
        turn, place = np.zeros((self.model.frames, 3, k)), np.zeros((self.model.frames, 3, k))
        common = np.zeros((self._wide, k))
        for rows in self._rows():
            count, n = rows.picks.shape
            own = values[rows.picks].reshape(count, 2 * n, k)
            turn[rows.frames] = rows.by_turn.reshape(count, 2 * n, 3).swapaxes(1, 2) @ own
            place[rows.frames] = rows.by_place.reshape(count, 2 * n, 3).swapaxes(1, 2) @ own
            further, index = self.model.further(rows)
            by_further = (further.swapaxes(1, 2) @ own)[:, further.shape[2] - index.shape[1] :]
            _add(common, index[..., None] * k + np.arange(k), by_further)
        fix = np.zeros((*self.model.fix_sigma_m.shape, k))
        return RightSide(turn, place, fix, common[: self.size])

    def seen(self, turn: Floats, place: Floats, common: Floats) -> Floats:
        """Move all unknowns: what that does to the images, in standard deviations (P, 2, k).

        Args:
            turn: of the frames, (F, 3, k)
            place: moves of their cameras by the fixes, (F, 3, k)
            common: moves of what is common, (K, k)
        """
        k = turn.shape[2]
        out = np.zeros((len(self.model.pick), 2, k))
        padded = np.concatenate([common, np.zeros((3, k))])
        for rows in self._rows():
            count, n = rows.picks.shape
            further, index = self.model.further(rows)
            moved = padded[index]
            if self.fixes is not None:
                moved = np.concatenate([place[rows.frames], moved], axis=1)
            total = rows.by_turn.reshape(count, 2 * n, 3) @ turn[rows.frames] + further @ moved
            out[rows.picks] = total.reshape(count, n, 2, k)
        return out


MANY = 64  # columns of a frame, from which one product of all frames is quicker than their sum


def _add(to: Array, index: Ints, values: Array) -> None:
    """Add values at flat indices, several of which may be the same."""
    where = index if index.shape == values.shape else np.broadcast_to(index, values.shape)
    # of one dimension and type it takes an eighth of the time
    np.add.at(to.reshape(-1), where.ravel(), values.astype(to.dtype, copy=False).ravel())


class Factored:
    """The normal equations with their priors, factored.

    Attributes:
        normal: the equations
        chain: of the fixes; None where positions are exact
        back: the fixes by what is common, (J, 3, K)
        log_determinant: of all equations, where they are real
    """

    def __init__(
        self, normal: Normal, damping: float = 0.0, fix_scale: complex | Array = 1.0,
        common_scale: complex = 1.0,
    ) -> None:  # fmt: skip
        """Factor the equations.

        Args:
            normal: the equations
            damping: Levenberg's of what is common; that of frames and fixes is in `normal`
            fix_scale: multiplies the prior weights of fixes, of all or of each (J, 1): 1, or with
                an imaginary part that carries the derivative
            common_scale: the same for those of what is common

        Raises:
            numpy.linalg.LinAlgError: if they have no minimum
        """
        self.normal, self.model, self.fixes = normal, normal.model, normal.fixes
        size = normal.size
        prior = self.model.common_sigma**-2.0 * common_scale
        common = normal.common + np.diag(prior)
        common = common + np.diag(damping * np.diag(common).real)
        self.log_determinant = normal.log_determinant
        self.chain, self.back = None, np.zeros((0, 3, size))
        if self.fixes is not None:
            self.chain = self._chain(fix_scale)
            self.log_determinant += self.chain.log_determinant
            self.back = self._along(normal.border.reshape(len(normal.border) // 3, 3, size))
            common = common - normal.border.T @ self.back.reshape(len(normal.border), size)
        with np.errstate(divide="ignore", invalid="ignore"):  # refused below
            self._scale = 1.0 / np.sqrt(np.abs(np.diag(common).real))
            self._scaled = common * self._scale[:, None] * self._scale
        if size and not np.iscomplexobj(common):
            if not np.isfinite(self._scaled).all():
                raise np.linalg.LinAlgError("an unknown without an observation")
            from scipy.linalg import cho_factor  # takes a twentieth of a second to load

            self._triangle = cho_factor(self._scaled, lower=True)
            diagonal = np.diag(self._triangle[0]) / self._scale
            self.log_determinant += 2.0 * float(np.log(diagonal).sum())

    @cached_property
    def common(self) -> Array:
        """The covariance of what is common, (K, K)."""
        if np.iscomplexobj(self._scaled):
            inverse = np.linalg.inv(self._scaled)
            return np.asarray(inverse * self._scale[:, None] * self._scale)
        return self._of_common(np.eye(len(self._scale)))

    def _of_common(self, right: Floats) -> Floats:
        """Solve for what is common, (K, k)."""
        if not len(right):
            return right
        from scipy.linalg import cho_solve

        scale = self._scale[:, None]
        return np.asarray(cho_solve(self._triangle, right * scale) * scale)

    def _chain(self, fix_scale: complex | Array) -> BlockTridiagonal:
        """Factor the equations of the fixes."""
        assert self.fixes is not None
        fixes, place, inside = self.fixes, self.normal.place, np.arange(3)
        together, width = fixes.together, 3 * fixes.together
        kind = np.result_type(place, fix_scale)
        diagonal, coupling = (np.zeros((fixes.blocks, width, width), kind) for _ in range(2))
        if together > NARROW:
            _add_wide(fixes, place, diagonal, coupling)
        for one, other in pairs(fixes.by_block) if together <= NARROW else ():
            upper = one // together, other // together
            if upper != (1, 0):  # the transposed one
                values = place * (fixes.by_block[:, one] * fixes.by_block[:, other])[:, None, None]
                block = (fixes.block + (upper == (1, 1)))[:, None, None]
                row, column = 3 * (one % together) + inside, 3 * (other % together) + inside
                to = coupling if upper == (0, 1) else diagonal
                _add(to, (block * width + row[:, None]) * width + column, values)
        prior = np.ones((fixes.blocks * together, 3), kind)
        prior[: len(fixes.sigma_m)] = self.model.fix_sigma_m**-2.0 * fix_scale
        at, prior = np.arange(width), prior.reshape(fixes.blocks, width)
        diagonal[:, at, at] += prior
        if self.normal.damping is not None:
            own = np.zeros(fixes.blocks)
            np.maximum.at(own, fixes.block, self.normal.damping)
            np.maximum.at(own, fixes.block + 1, self.normal.damping)
            diagonal[:, at, at] += own[:, None] * diagonal[:, at, at]
        return BlockTridiagonal(diagonal, coupling[:-1])

    def _along(self, right: Array) -> Array:
        """Solve for fixes, those that fill up the last block included, (J, 3, k)."""
        assert self.chain is not None and self.fixes is not None
        k = right.shape[2]
        full = np.zeros((self.fixes.blocks * self.fixes.together, 3, k), right.dtype)
        full[: len(right)] = right
        blocks = full.reshape(self.fixes.blocks, 3 * self.fixes.together, k)
        return self.chain.solve(blocks).reshape(full.shape)

    def solve(self, right: RightSide) -> tuple[Floats, Floats, Floats]:
        """Solve for all unknowns.

        Returns:
            Turns (F, 3, k), 0 for frames that take no part; errors of fixes (J, 3, k); what is
            common (K, k).
        """
        normal, k = self.normal, right.turn.shape[2]
        place, taken = right.place.copy(), np.zeros((normal.size + 3, k))
        for one in normal.parts:
            some = np.flatnonzero(right.turn[one.frames].any(axis=(1, 2)))
            frames, mixed = one.frames[some], one.mixed[some]
            own = mixed.swapaxes(1, 2) @ (one.inverse[some] @ right.turn[frames])
            if self.fixes is not None:
                place[frames] -= own[:, :3]
                own = own[:, 3:]
            _add(taken, one.column[some][..., None] * k + np.arange(k), own)
        fix = right.fix if self.fixes is None else right.fix + handed(self.fixes, place)
        fix, common = self.solve_further(fix, right.common - taken[:-3])
        return self.turns(right.turn, fix, common), fix, common

    def solve_further(self, fix: Floats, common: Floats) -> tuple[Floats, Floats]:
        """Solve for what is left where the turns are eliminated.

        Args:
            fix: right sides, (J, 3, k)
            common: likewise, (K, k)
        """
        if self.fixes is None:
            return fix, self._of_common(common)
        fix = self._along(fix)
        common = common - self.normal.border.T @ fix.reshape(len(self.normal.border), -1)
        common = self._of_common(common)
        return (fix - self.back @ common)[: len(self.model.fix_sigma_m)], common

    def turns(self, right: Floats | None, fix: Floats, common: Floats) -> Floats:
        """Solve for turns where all else is known, (F, 3, k); 0 for frames that take no part.

        Args:
            right: right sides, (F, 3, k); None: 0
            fix: errors of fixes, (J, 3, k)
            common: of what is common, (K, k)
        """
        k = common.shape[1]
        turn, padded = (
            np.zeros((self.model.frames, 3, k)),
            np.concatenate([common, np.zeros((3, k))]),
        )
        places = turn if self.fixes is None else self.fixes.at_frames(fix)
        for one in self.normal.parts:
            further = padded[one.column]
            if self.fixes is not None:
                further = np.concatenate([places[one.frames], further], axis=1)
            own = -one.mixed @ further
            turn[one.frames] = one.inverse @ (own if right is None else right[one.frames] + own)
        return turn


def handed(fixes: TrackFixes, place: Floats) -> Floats:
    """Hand right sides of places (F, 3, k) to the fixes that they lie between (J, 3, k)."""
    out, k = np.zeros((*fixes.sigma_m.shape, place.shape[2])), place.shape[2]
    for slot, weight in enumerate(fixes.weight.T):
        number = np.minimum(fixes.first + slot, len(out) - 1)
        row = (3 * number)[:, None, None] + np.arange(3)[:, None]
        _add(out, row * k + np.arange(k), place * weight[:, None, None])
    return out


NARROW = 4  # fixes in a block: of wider ones the frames of a block are added up together


def _add_wide(fixes: TrackFixes, place: Array, diagonal: Array, coupling: Array) -> None:
    """Add what frames say of their places (F, 3, 3) to the equations of blocks of many fixes."""
    width = 3 * fixes.together
    for block, some in frames_by_block(fixes, np.arange(len(fixes.block))):
        weight = fixes.by_block[some]
        slots = weight.shape[1]
        each = (weight[:, :, None] * place[some].reshape(-1, 1, 9)).reshape(len(some), -1)
        products = (weight.T @ each).reshape(slots, slots, 3, 3)
        both = products.transpose(1, 2, 0, 3).reshape(2 * width, 2 * width)
        diagonal[block] += both[:width, :width]
        diagonal[block + 1] += both[width:, width:]
        coupling[block] += both[:width, width:]


def frames_by_block(fixes: TrackFixes, frames: Ints) -> Iterator[tuple[int, Ints]]:
    """Iterate over the blocks of fixes, with the places among some frames of those of each.

    Args:
        fixes: of the track
        frames: indices, (B,)
    """
    block = fixes.block[frames]
    order = np.argsort(block, kind="stable")
    found, first = np.unique(block[order], return_index=True)
    return zip(found.tolist(), np.split(order, first[1:]), strict=True)


def pairs(by_block: Floats) -> list[tuple[int, int]]:
    """List the pairs of slots in which any frame has a part."""
    slots = np.flatnonzero(by_block.any(axis=0)).tolist()
    return [(one, other) for one in slots for other in slots]
