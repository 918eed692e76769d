"""The Euler solve: 22 passes of least squares on the collinearity equations (A 274 to A 443).

Arrays carry the landmark axis first and the frame axis last, (L, F).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.program.constants import pi, rad, twopi
from vopd.program.matinv import reduce
from vopd.program.tgtcam import Dircos

PASSES = 22
BLOCK = 3000  # frames solved at a time: fewer calls, and still in the cache

_PAIRS = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2), (0, 3), (1, 3), (2, 3))
_NORMAL = np.array([[0, 1, 2, 6], [1, 3, 4, 7], [2, 4, 5, 8]])
"""Products of columns of [B, -EPS], and where their sums stand in XN and C side by side."""


class Sight(NamedTuple):
    """What the solve is given: where each landmark is, and where it is on the film.

    `dircos` (L, F) cosines; `x`, `y` (L, F) mm from the frame's centre, freed of
    distortion; `xmu1` (L, F) XMU of the frame's first landmark; `used` (L, F);
    `cc` (F,) the focal length, mm.
    """

    dircos: Dircos
    x: Floats
    y: Floats
    xmu1: Floats
    used: Bools
    cc: Floats

    def only(self, frames: Bools | Ints) -> Sight:
        """The same for some of the frames."""
        return Sight(
            Dircos(*(part[:, frames] for part in self.dircos)),
            self.x[:, frames],
            self.y[:, frames],
            self.xmu1[:, frames],
            self.used[:, frames],
            self.cc[frames],
        )

    @staticmethod
    def joined(sights: Sequence[Sight]) -> Sight:
        """Films with the same number of landmarks, one after the other."""
        if len(sights) == 1:
            return sights[0]
        dircos = zip(*(sight.dircos for sight in sights), strict=True)
        return Sight(
            Dircos(*(np.concatenate(parts, axis=1) for parts in dircos)),
            np.concatenate([sight.x for sight in sights], axis=1),
            np.concatenate([sight.y for sight in sights], axis=1),
            np.concatenate([sight.xmu1 for sight in sights], axis=1),
            np.concatenate([sight.used for sight in sights], axis=1),
            np.concatenate([sight.cc for sight in sights]),
        )


class Orientation(NamedTuple):
    """What the solve leaves, frame axis last.

    `angles` (3, F) degrees and `eps` (2, L, F) mm are those of pass 22, after 21
    corrections, or of the earlier pass in which all residuals were exactly
    zero; `next` (3, F) degrees and `correction` (3, F) radians are those of the
    22nd correction. `last_pass` (F,) is where a frame's residuals vanished, 0
    where they did not. `singular` (F,): the normal matrix was, in the last pass.
    """

    angles: Floats
    eps: Floats
    next: Floats
    correction: Floats
    last_pass: Ints
    singular: Bools

    def only(self, frames: slice) -> Orientation:
        """The same for some frames in a row."""
        return Orientation(
            self.angles[:, frames],
            self.eps[..., frames],
            self.next[:, frames],
            self.correction[:, frames],
            self.last_pass[frames],
            self.singular[frames],
        )

    def put(self, frames: Ints, part: Orientation, which: Ints | slice = slice(None)) -> None:
        """Take in the results of some frames: `which` of `part`."""
        for mine, theirs in zip(self, part, strict=True):
            mine[..., frames] = theirs[..., which]


def orient(start: Floats, sight: Sight) -> Orientation:
    """Solve all frames from `start` (3, F) degrees: the camera's yaw, pitch, roll.

    Every frame comes out as it would alone. A frame whose angles are to the
    last bit what they were a pass ago, or two passes ago where an even number
    of passes is left, has reached its result and is not taken further.
    """
    count, frames = sight.used.shape
    done = Orientation(
        angles=start.copy(),
        eps=np.zeros((2, count, frames)),
        next=start.copy(),
        correction=np.zeros((3, frames)),
        last_pass=np.zeros(frames, np.int64),
        singular=np.zeros(frames, bool),
    )
    with np.errstate(all="ignore"):
        for first in range(0, frames, BLOCK):
            block = np.arange(first, min(first + BLOCK, frames))
            _iterate(block, start[:, block], sight.only(block), done)
    return done


def _iterate(going: Ints, start: Floats, sight: Sight, done: Orientation) -> None:
    """Take the frames `going` through the passes, and put those that end into `done`."""
    radians = start / rad
    before = np.full_like(radians, np.inf)
    for iteration in range(1, PASSES + 1):
        eps, b = equations(radians, sight)
        degrees = start if iteration == 1 else radians * rad
        exact = (eps == 0).all(axis=(0, 1))
        correction, singular = _correction(eps, b)
        after = _wrapped(radians + correction)
        ended = exact | _at_rest(after, radians)
        if iteration % 2 == PASSES % 2:
            ended |= _at_rest(after, before)
        if iteration == PASSES:
            ended[:] = True
        if ended.any():
            angles = np.where(exact | (iteration > 1), degrees, after * rad)
            last_pass = np.where(exact, iteration, 0)
            part = Orientation(angles, eps, after * rad, correction, last_pass, singular & ~exact)
            done.put(going[ended], part, np.flatnonzero(ended))
            going, after, sight = going[~ended], after[:, ~ended], sight.only(~ended)
            radians = radians[:, ~ended]
            if not len(going):
                break
        before, radians = radians, after


def _at_rest(after: Floats, before: Floats) -> Bools:
    """Frames whose angles are to the last bit what they were."""
    repeats = (after == before) | (np.isnan(after) & np.isnan(before))
    return np.asarray(repeats.all(axis=0))


def equations(radians: Floats, sight: Sight) -> tuple[Floats, Floats]:
    """Residuals (2, L, F) and partials (2, 3, L, F), zero for what is not used (A 314 to A 403)."""
    (salpha, somega, skappa), (calpha, comega, ckappa) = np.sin(radians), np.cos(radians)
    aac = -calpha * ckappa - salpha * somega * skappa
    bbc = salpha * ckappa - calpha * somega * skappa
    ccc = comega * skappa
    aacp = calpha * skappa - salpha * somega * ckappa
    bbcp = -salpha * skappa - calpha * somega * ckappa
    cccp = comega * ckappa
    ddc, eec, ffc = salpha * comega, calpha * comega, somega

    xlam, xmu, xnu = sight.dircos
    cc = sight.cc
    gc = ddc * xlam + eec * xmu + ffc * xnu
    xmm = (aac * xlam + bbc * xmu + ccc * xnu) / gc
    xnn = (aacp * xlam + bbcp * xmu + cccp * xnu) / gc
    qq = cc / gc
    eps, b = np.empty((2, *gc.shape)), np.empty((2, 3, *gc.shape))
    np.subtract(sight.x, cc * xmm, out=eps[0])
    np.subtract(sight.y, cc * xnn, out=eps[1])

    ff1, ff2, ff3 = aac - ddc * xmm, bbc - eec * xmm, ccc - ffc * xmm
    fb1, fb2, fb3 = aacp - ddc * xnn, bbcp - eec * xnn, cccp - ffc * xnn
    gg1 = xmm * comega + ffc * skappa
    gb1 = xnn * comega + ffc * ckappa
    hm1 = xlam * salpha + sight.xmu1 * calpha  # A 394
    np.multiply(-ff2 * xlam + ff1 * xmu, qq, out=b[0, 0])
    np.multiply(ff3 * hm1 + gg1 * xnu, qq, out=b[0, 1])
    np.multiply(-cc, xnn, out=b[0, 2])
    np.multiply(-fb2 * xlam + fb1 * xmu, qq, out=b[1, 0])
    np.multiply(fb3 * hm1 + gb1 * xnu, qq, out=b[1, 1])
    np.multiply(cc, xmm, out=b[1, 2])
    if not sight.used.all():
        eps, b = np.where(sight.used, eps, 0.0), np.where(sight.used, b, 0.0)
    return eps, b


def _correction(eps: Floats, b: Floats) -> tuple[Floats, Bools]:
    """The correction of the angles (3, F), radians, added up in the listing's order (A 376-421)."""
    _, count, frames = eps.shape
    right = -eps
    terms = np.empty((2 * count, len(_PAIRS), frames))
    for term, (i, k) in enumerate(_PAIRS):
        np.multiply(b[0, i], b[0, k] if k < 3 else right[0], out=terms[0::2, term])
        np.multiply(b[1, i], b[1, k] if k < 3 else right[1], out=terms[1::2, term])
    sums = np.zeros((len(_PAIRS), frames))
    for term in terms:  # one after the other: the order of a sum is part of its result
        sums += term
    solved, _, regular = reduce(sums[_NORMAL], 3)
    return solved[:, 3], ~regular


def _wrapped(radians: Floats) -> Floats:
    """Angles back to their ranges after a correction (A 432 to A 437)."""
    alphar, omegar, xkapr = radians
    alphar, xkapr = (np.where(a < 0, a + twopi, a) for a in (alphar, xkapr))
    omegar = np.where(omegar < -pi, omegar + twopi, omegar)
    alphar, xkapr = (np.where(a > twopi, a - twopi, a) for a in (alphar, xkapr))
    return np.stack([alphar, np.where(omegar > pi, omegar - twopi, omegar), xkapr])
