"""The solve against the listing's cards, operation by operation: the same bits.

`solve` is cards A 276 to A 443 of the listing, one frame, one number at a time, with MATINV, which
is Jordan's method with complete pivoting, by Appendix C; nothing of `vopd.program` is used.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from tests.kit import appendix_a
from vopd.program.orient import Orientation, orient

RAD, PI = 57.29577951, 3.14159265
TWOPI = 2.0 * PI
Matrix = list[list[float]]


class Left(NamedTuple):
    """Degrees and residuals of pass 22, or of the pass where all residuals vanish; what follows."""

    angles: list[float]
    eps: Matrix
    after: list[float]
    correction: list[float]
    last_pass: int


def matinv(a: Matrix, b: list[float]) -> None:
    """A becomes its inverse and B the solution, in place; a singular one is left half way."""
    n = len(b)
    used, exchanges = [False] * n, []
    for _ in range(n):
        amax, irow, icolum = 0.0, 0, 0
        for j in range(n):
            for k in range(n):
                if not used[j] and not used[k] and abs(a[j][k]) > amax:
                    amax, irow, icolum = abs(a[j][k]), j, k
        if amax == 0.0:
            return
        used[icolum] = True
        if irow != icolum:
            a[irow], a[icolum] = a[icolum], a[irow]
            b[irow], b[icolum] = b[icolum], b[irow]
        exchanges.append((irow, icolum))
        pivot = a[icolum][icolum]
        a[icolum][icolum] = 1.0
        a[icolum] = [x / pivot for x in a[icolum]]
        b[icolum] = b[icolum] / pivot
        for line in range(n):
            if line != icolum:
                t = a[line][icolum]
                a[line][icolum] = 0.0
                a[line] = [x - y * t for x, y in zip(a[line], a[icolum], strict=True)]
                b[line] = b[line] - b[icolum] * t
    for irow, icolum in reversed(exchanges):
        for row in a:
            row[irow], row[icolum] = row[icolum], row[irow]


def solve(start: np.ndarray, cosines: np.ndarray, film: np.ndarray, cc: float) -> Left:
    """One frame from `start` degrees; cosines (L, 3), film (L, 2) mm from the centre, corrected."""
    with np.errstate(all="ignore"):
        return _solve(start, cosines, film, np.float64(cc))


def _solve(start: np.ndarray, cosines: np.ndarray, film: np.ndarray, cc: np.float64) -> Left:
    alpha, xomeg, xkap = start
    alphar, omegar, xkapr = alpha / RAD, xomeg / RAD, xkap / RAD
    for iteration in range(1, 23):
        salpha, calpha = np.sin(alphar), np.cos(alphar)
        somega, comega = np.sin(omegar), np.cos(omegar)
        skappa, ckappa = np.sin(xkapr), np.cos(xkapr)
        aac = -calpha * ckappa - salpha * somega * skappa
        bbc = salpha * ckappa - calpha * somega * skappa
        ccc = comega * skappa
        aacp = calpha * skappa - salpha * somega * ckappa
        bbcp = -salpha * skappa - calpha * somega * ckappa
        cccp = comega * ckappa
        ddc, eec, ffc = salpha * comega, calpha * comega, somega
        eps, seen = [], []
        for (xlam, xmu, xnu), (x, y) in zip(cosines, film, strict=True):
            gc = ddc * xlam + eec * xmu + ffc * xnu
            xmm = (aac * xlam + bbc * xmu + ccc * xnu) / gc
            xnn = (aacp * xlam + bbcp * xmu + cccp * xnu) / gc
            eps.append([x - cc * xmm, y - cc * xnn])
            seen.append((xmm, xnn, cc / gc))
        if all(e == 0 for pair in eps for e in pair):
            return Left([alpha, xomeg, xkap], eps, [], [], iteration)
        xn, c = [[0.0] * 3 for _ in range(3)], [0.0] * 3
        for (xlam, xmu, xnu), (xmm, xnn, qq), e in zip(cosines, seen, eps, strict=True):
            ff1, ff2, ff3 = aac - ddc * xmm, bbc - eec * xmm, ccc - ffc * xmm
            fb1, fb2, fb3 = aacp - ddc * xnn, bbcp - eec * xnn, cccp - ffc * xnn
            gg1 = xmm * comega + ffc * skappa
            gb1 = xnn * comega + ffc * ckappa
            hm1 = xlam * salpha + cosines[0][1] * calpha  # XMU(1)
            s1 = -ff2 * xlam + ff1 * xmu
            s2 = ff3 * hm1 + gg1 * xnu
            sb1 = -fb2 * xlam + fb1 * xmu
            sb2 = fb3 * hm1 + gb1 * xnu
            b = [[s1 * qq, s2 * qq, -cc * xnn], [sb1 * qq, sb2 * qq, cc * xmm]]
            for i in range(3):
                for line in range(2):
                    c[i] = c[i] + b[line][i] * (-e[line])
                for k in range(3):
                    for line in range(2):
                        xn[i][k] = xn[i][k] + b[line][i] * b[line][k]
        matinv(xn, c)
        before = [alpha, xomeg, xkap]
        alphar, omegar, xkapr = alphar + c[0], omegar + c[1], xkapr + c[2]
        if xkapr < 0.0:
            xkapr = xkapr + TWOPI
        if alphar < 0.0:
            alphar = alphar + TWOPI
        if omegar < -PI:
            omegar = omegar + TWOPI
        if xkapr > TWOPI:
            xkapr = xkapr - TWOPI
        if alphar > TWOPI:
            alphar = alphar - TWOPI
        if omegar > PI:
            omegar = omegar - TWOPI
        alpha, xomeg, xkap = alphar * RAD, omegar * RAD, xkapr * RAD
    return Left(before, eps, [alpha, xomeg, xkap], c, 0)


FOCAL = 10.4


def film(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Starts, cosines, film of 30 frames: near and far starts, good and bad readings."""
    rng = np.random.default_rng(seed)
    truth = rng.uniform([0.0, -90.0, 0.0], [360.0, 90.0, 360.0], (30, 3))
    noise_mm = rng.choice([0.0, 0.3])
    cosines, seen = appendix_a.random_film(rng, truth, int(rng.integers(1, 6)), noise_mm)
    start = truth + rng.uniform(-1.0, 1.0, truth.shape) * rng.choice([0.0, 5.0, 90.0])
    start[:2], cosines[0], seen[0] = 0.0, (0.0, 1.0, 0.0), 0.0  # exact, and
    cosines[1, 0] = (1.0, 0.0, 0.0)  # abeam: NaN
    return start, cosines, seen


def both(seed: int) -> tuple[Orientation, list[Left]]:
    start, cosines, seen = film(seed)
    frames = zip(start, cosines, seen, strict=True)
    done = orient(start.T.copy(), appendix_a.sight(cosines, seen, FOCAL))
    return done, [solve(*frame, FOCAL) for frame in frames]


@pytest.mark.parametrize("seed", range(14))
def test_bit_for_bit(seed: int) -> None:
    """Angles and residuals of pass 22 and what follows from it, or the pass that was exact."""
    done, wanted = both(seed)
    for f, left in enumerate(wanted):
        assert done.last_pass[f] == left.last_pass
        np.testing.assert_array_equal(done.angles[:, f], left.angles)
        np.testing.assert_array_equal(done.eps[:, :, f].T, left.eps)
        if not left.last_pass:
            np.testing.assert_array_equal(done.next[:, f], left.after)
            np.testing.assert_array_equal(done.correction[:, f], left.correction)


def test_the_films_are_of_every_kind() -> None:
    """Exact, NaN, at rest, still on the way; in a cycle of two or exact later by chance."""
    kinds = set()
    for seed in range(14):
        for left in both(seed)[1]:
            step = np.abs(left.correction).max(initial=0.0)
            if left.last_pass:
                kinds.add("exact")
            elif np.isnan(step):
                kinds.add("NaN")
            elif left.after == left.angles:
                kinds.add("at rest")
            else:
                kinds.add("on the way" if step > 1e-6 else "trembling")
    assert kinds >= {"exact", "NaN", "at rest", "on the way"}
