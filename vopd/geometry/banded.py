"""Symmetric block-tridiagonal matrices: solutions, selected inverses and determinants.

The fixes of a track are coupled to their neighbours alone. Every second block is eliminated
at once, which leaves a block-tridiagonal matrix of half the length (cyclic reduction): numpy
works on stacks, and a chain of 50,000 fixes takes 16 rounds. LAPACK's banded Cholesky solves
as fast, but has no selected inverse.
"""

from __future__ import annotations

import numpy as np

from vopd.arrays import Array


class BlockTridiagonal:
    """A factored symmetric matrix of J by J blocks.

    Args:
        diagonal: blocks on the diagonal, (J, b, b)
        coupling: blocks of each row with the next, (J - 1, b, b)

    Raises:
        numpy.linalg.LinAlgError: if a real matrix is not positive definite
    """

    def __init__(self, diagonal: Array, coupling: Array) -> None:
        # of the odd blocks of each round, (O, b, b): the inverse, and that times the coupling with
        # the block before and with the block after, 0 behind the last one
        self.rounds: list[tuple[Array, Array, Array]] = []
        self.log_determinant = 0.0
        self.is_diagonal = not coupling.any()
        while len(diagonal) > 1 and not self.is_diagonal:
            diagonal, coupling = self._reduce(diagonal, coupling)
        self.last = self._inverted(diagonal)

    def _inverted(self, blocks: Array) -> Array:
        """Invert blocks, and take note of their determinants; only real ones are checked."""
        if not np.iscomplexobj(blocks):
            triangle = np.linalg.cholesky(blocks)
            self.log_determinant += 2.0 * float(np.log(np.einsum("jii->ji", triangle)).sum())
        return np.asarray(np.linalg.inv(blocks))

    def _reduce(self, diagonal: Array, coupling: Array) -> tuple[Array, Array]:
        """Eliminate every second block."""
        inverse = self._inverted(diagonal[1::2])
        odd = len(inverse)
        to_before = coupling[0::2]  # rows: the block before
        to_after = np.zeros_like(to_before)
        to_after[: len(coupling[1::2])] = coupling[1::2]  # rows: the odd block
        before, after = inverse @ to_before.swapaxes(1, 2), inverse @ to_after
        even = diagonal[0::2].copy()
        even[:odd] -= to_before @ before
        following = len(even) - 1
        even[1:] -= (to_after.swapaxes(1, 2) @ after)[:following]
        self.rounds.append((inverse, before, after))
        return even, -(to_before @ after)[:following]

    def solve(self, right: Array) -> Array:
        """Solve for the unknowns, (J, b, k).

        Args:
            right: right sides, (J, b, k)
        """
        odds = []
        right = right.astype(np.result_type(right, self.last))
        for _, before, after in self.rounds:
            odd, even = right[1::2], right[0::2].copy()
            even[: len(odd)] -= before.swapaxes(1, 2) @ odd
            even[1:] -= (after.swapaxes(1, 2) @ odd)[: len(even) - 1]
            odds.append(odd)
            right = even
        found = self.last @ right
        for (inverse, before, after), odd in zip(self.rounds[::-1], odds[::-1], strict=True):
            behind = np.zeros((len(odd), *found.shape[1:]), found.dtype)
            behind[: len(found) - 1] = found[1 : len(odd) + 1]
            own = inverse @ odd - before @ found[: len(odd)] - after @ behind
            found = _interleaved(found, own)
        return found

    def selected_inverse(self) -> tuple[Array, Array]:
        """Invert: blocks of the inverse on the diagonal (J, b, b) and beside it (J - 1, b, b).

        Source: K. Takahashi, J. Fagan, M.-S. Chen, Formation of a sparse bus impedance
        matrix, Proc. 8th PICA Conference (1973), here by cyclic reduction.
        """
        diagonal = self.last
        beside = np.zeros_like(diagonal[1:])
        for inverse, before, after in self.rounds[::-1]:
            odd, even = len(inverse), len(diagonal)
            at = diagonal[:odd]
            behind = np.zeros_like(at)
            behind[: even - 1] = diagonal[1 : odd + 1]
            across = np.zeros_like(at)  # rows: the block before, columns: the one after
            across[: even - 1] = beside[:odd]
            by_before = -(before @ at + after @ across.swapaxes(1, 2))
            by_after = -(before @ across + after @ behind)
            own = inverse - by_before @ before.swapaxes(1, 2)
            own -= by_after @ after.swapaxes(1, 2)
            diagonal = _interleaved(diagonal, own)
            beside = _interleaved(by_before.swapaxes(1, 2), by_after)[: len(diagonal) - 1]
        return diagonal, beside


def _interleaved(even: Array, odd: Array) -> Array:
    """Put blocks eliminated in a round between those that were left."""
    both = np.empty((len(even) + len(odd), *even.shape[1:]), np.result_type(even, odd))
    both[0::2], both[1::2] = even, odd
    return both
