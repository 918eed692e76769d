"""Block-tridiagonal matrices against numpy's dense ones."""

from __future__ import annotations

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.arrays import Array, Floats
from vopd.geometry.banded import BlockTridiagonal

SHAPES = [(blocks, size) for blocks in (1, 2, 3, 4, 5, 8, 13, 50) for size in (1, 3, 6)]


def chain(rng: np.random.Generator, blocks: int, size: int) -> Floats:
    """A positive definite matrix whose blocks are coupled to their neighbours alone."""
    dense = np.eye(blocks * size)
    for one in range(max(blocks - 1, 1)):
        at = slice(one * size, (one + 2) * size)
        rows = rng.normal(size=(2 * size, len(dense[at])))
        dense[at, at] += rows.T @ rows
    return dense


def parts(dense: Array, size: int) -> tuple[Array, Array]:
    """The blocks on the diagonal, and those right of them."""
    starts = range(0, len(dense), size)
    on = [dense[at : at + size, at : at + size] for at in starts]
    right = [dense[at : at + size, at + size : at + 2 * size] for at in starts][:-1]
    return np.array(on), np.array(right).reshape(-1, size, size)


@pytest.mark.parametrize(("blocks", "size"), SHAPES)
def test_a_chain_is_its_dense_matrix(blocks: int, size: int) -> None:
    rng = np.random.default_rng(10 * blocks + size)
    dense = chain(rng, blocks, size)
    factored = BlockTridiagonal(*parts(dense, size))
    right = rng.normal(size=(blocks, size, 2))
    expected = np.linalg.solve(dense, right.reshape(-1, 2))
    assert_close("banded inverse", factored.solve(right).reshape(-1, 2), expected)
    for own, other in zip(
        factored.selected_inverse(), parts(np.linalg.inv(dense), size), strict=True
    ):
        assert_close("banded inverse", own, other)
    sign, logarithm = np.linalg.slogdet(dense)
    assert sign == 1.0
    assert_close("banded log determinant", factored.log_determinant, logarithm)


@pytest.mark.parametrize("blocks", [1, 4, 7])
def test_a_chain_without_couplings_is_its_blocks(blocks: int) -> None:
    rng = np.random.default_rng(blocks)
    on, _ = parts(chain(rng, blocks, 3), 3)
    factored = BlockTridiagonal(on, np.zeros((blocks - 1, 3, 3)))
    right = rng.normal(size=(blocks, 3, 1))
    assert_close("banded inverse", factored.solve(right), np.linalg.solve(on, right))
    diagonal, beside = factored.selected_inverse()
    assert_close("banded inverse", diagonal, np.linalg.inv(on))
    assert beside.shape == (blocks - 1, 3, 3) and not beside.any()
    assert_close("banded log determinant", factored.log_determinant, np.linalg.slogdet(on)[1].sum())


@pytest.mark.parametrize(("blocks", "size"), [(1, 3), (6, 3), (9, 6)])
def test_an_imaginary_part_carries_the_derivative(blocks: int, size: int) -> None:
    """The inverse of A + i t D has the imaginary part -t A^-1 D A^-1, where t^2 is nothing."""
    rng = np.random.default_rng(blocks)
    dense, prior = chain(rng, blocks, size), np.diag(rng.uniform(1.0, 2.0, blocks * size))
    factored = BlockTridiagonal(*parts(dense + 1e-30j * prior, size))
    inverse = np.linalg.inv(dense)
    for own, other in zip(
        factored.selected_inverse(), parts(inverse @ prior @ inverse, size), strict=True
    ):
        assert_close("banded inverse", own.imag / -1e-30, other)


def test_a_matrix_that_is_not_positive_definite_is_refused() -> None:
    dense = chain(np.random.default_rng(1), 5, 3)
    for where in (0, 7, 14):  # of blocks that are eliminated first, later and last
        changed = dense.copy()
        changed[where, where] = -1.0
        with pytest.raises(np.linalg.LinAlgError):
            BlockTridiagonal(*parts(changed, 3))
