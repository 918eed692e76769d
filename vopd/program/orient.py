"""The Euler solve: 22 passes of least squares on the collinearity equations (A 274 to A 443).

Arrays carry the landmark axis first and the frame axis last, (L, F).
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from vopd.arrays import Bools, Floats, Ints
from vopd.program.constants import pi, rad, twopi
from vopd.program.matinv import reduce
from vopd.program.tgtcam import Dircos

PASSES = 22
FEW_LANDMARKS, FEW_FRAMES = 8, 32  # sums of more landmarks in fewer frames need no loop
FEW_EMPTY = 1000  # so many empty slots cost less than a call more

_NORMAL = ((0, 1, 2, 6), (1, 3, 4, 7), (2, 4, 5, 8))
"""The rows of XN (3, 3) and C (3,) side by side, of the nine sums over B and -EPS.

XN is symmetric, so that its nine entries are the sums 0 to 5: XN(1,1), XN(1,2), XN(1,3), XN(2,2),
XN(2,3), XN(3,3); C is the sums 6 to 8.
"""


_LOWEST, _HIGHEST = np.array([[0.0], [-pi], [0.0]]), np.array([[twopi], [pi], [twopi]])


class Sight(NamedTuple):
    """The input of the solve: the direction of each landmark, and its image on the film.

    `dircos` (L, F) cosines; `x`, `y` (L, F) mm from the frame's centre, corrected for
    lens distortion; `xmu1` (L, F) XMU of the frame's first landmark; `used` (L, F);
    `cc` (F,) the focal length, mm.
    """

    dircos: Dircos
    x: Floats
    y: Floats
    xmu1: Floats
    used: Bools
    cc: Floats

    def only(self, frames: Bools | Ints) -> Sight:
        """Select some of the frames.

        Args:
            frames: a mask (F,) or indices of frames.
        """
        xlam, xmu, xnu = self.dircos
        return Sight(
            (xlam[:, frames], xmu[:, frames], xnu[:, frames]),
            self.x[:, frames],
            self.y[:, frames],
            self.xmu1[:, frames],
            self.used[:, frames],
            self.cc[frames],
        )


class FilmSight(NamedTuple):
    """The same for frames with any numbers of landmarks, of which all N take part."""

    nj: Ints  # how many landmarks each frame has (F,)
    direction: Floats  # cosines of the landmarks (N, 3) along east, north, up
    point: Floats  # x and y (N, 2), mm from the frame's centre, corrected for lens distortion
    xmu1: Floats  # XMU of the first landmark of each landmark's frame (N,)
    cc: Floats  # the focal length for every frame (F,), mm

    def of(self, frames: Ints) -> Sight:
        """Arrange some frames by landmark and frame.

        Args:
            frames: their indices; `alike` gives such as have like numbers of landmarks.
        """
        slot, used = self.slots(frames)
        xlam, xmu, xnu = self.direction.T
        return Sight(
            (xlam[slot], xmu[slot], xnu[slot]),
            x=self.point[:, 0][slot],
            y=self.point[:, 1][slot],
            xmu1=self.xmu1[slot],
            used=used,
            cc=self.cc[frames],
        )

    def slots(self, frames: Ints) -> tuple[Ints, Bools]:
        """Find the indices of the landmarks (L, F) of frames, and which slots have one."""
        first, nj = (np.cumsum(self.nj) - self.nj)[frames], self.nj[frames]
        slot = np.arange(nj.max(initial=0))[:, None]
        return np.minimum(first + slot, len(self.xmu1) - 1), slot < nj

    def alike(self, frames: Ints, landmarks: int) -> Iterator[Ints]:
        """Group frames that have one number of landmarks, about so many landmarks at a time.

        Frames of the next numbers join those of one number while that leaves few slots empty.

        Args:
            frames: indices of frames.
            landmarks: how many at a time; a frame is never divided.
        """
        frames = frames[np.argsort(self.nj[frames], kind="stable")]
        nj = self.nj[frames]
        before, cuts = np.append(0, np.cumsum(nj)), [0]
        for k in (np.flatnonzero(np.diff(nj)) + 1).tolist():
            if (k - cuts[-1]) * nj[k] - (before[k] - before[cuts[-1]]) > FEW_EMPTY:
                cuts.append(k)
        for some in np.split(frames, cuts[1:]):
            step = max(landmarks // max(int(self.nj[some[-1]]), 1), 1)
            yield from (some[k : k + step] for k in range(0, len(some), step))


class Orientation(NamedTuple):
    """The result of the solve; the frame axis comes last in every array.

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

    def put(self, frames: Ints, part: Orientation, which: Ints) -> None:
        """Replace the results of some frames by those of another solve.

        Args:
            frames: indices of the frames that are replaced.
            part: the other solve.
            which: indices of the frames of `part` that are taken, in the same order.
        """
        for mine, theirs in zip(self, part, strict=True):
            mine[..., frames] = theirs[..., which]


def orient(start: Floats, sight: Sight) -> Orientation:
    """Solve every frame for the camera's angles, each as it would be solved alone.

    A frame whose angles are to the last bit what they were a pass ago, or two passes
    ago if an even number of passes is left, has its result and is not taken further.

    Args:
        start: where to start (3, F): the camera's yaw, pitch, roll, degrees.
        sight: what the solve is given.

    Source: TM X-3050, A 274 to A 443.
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
        _iterate(np.arange(frames), start, sight, done)
    return done


def _iterate(going: Ints, start: Floats, sight: Sight, done: Orientation) -> None:
    """Take the frames `going` through the passes, and put those that end into `done`.

    Frames that have ended are computed with the others, and left out, until they
    are a quarter: to take some out costs more than to take them along.

    A pass is the first lines of the loop, the same 22 times: residuals and partial
    derivatives, the normal equations and MATINV, the corrected angles. The rest of the
    loop only takes frames out.
    """
    radians = start / rad  # A 279 to A 281
    before = np.full_like(radians, np.inf)
    open_ = np.ones(len(going), bool)
    for iteration in range(1, PASSES + 1):  # A 288, A 289, A 292 to A 295, A 441 to A 443
        eps, b = equations(radians, sight)  # A 314 to A 350, A 386 to A 404
        exact = (eps == 0).all(axis=(0, 1))  # A 364 to A 375, V = 0: the frame ends here
        correction, singular = _correction(eps, b)  # A 376 to A 380, A 405 to A 421
        after = wrapped(radians + correction)  # A 429 to A 437

        # Frames that have their result are taken out
        ended = exact | _at_rest(after, radians)
        if iteration % 2 == PASSES % 2:
            ended |= _at_rest(after, before)
        if iteration == PASSES:
            ended[:] = True
        ended &= open_
        if ended.any():
            degrees = start if iteration == 1 else radians * rad  # A 438 to A 440
            # a frame at rest in pass 1 would print its corrected angles in pass 22
            angles = np.where(exact | (iteration > 1), degrees, after * rad)
            last_pass = np.where(exact, iteration, 0)
            part = Orientation(angles, eps, after * rad, correction, last_pass, singular & ~exact)
            done.put(going[ended], part, np.flatnonzero(ended))
            open_ &= ~ended
            left = int(open_.sum())
            if not left:
                return
            if left < 0.75 * len(going):
                going, radians, after = going[open_], radians[:, open_], after[:, open_]
                sight, open_ = sight.only(open_), np.ones(left, bool)
        before, radians = radians, after


def _at_rest(after: Floats, before: Floats) -> Bools:
    """Mark frames whose angles are to the last bit what they were."""
    return np.asarray((after.view(np.int64) == before.view(np.int64)).all(axis=0))


def equations(radians: Floats, sight: Sight) -> tuple[Floats, Floats]:
    """Compute residuals and partial derivatives at some angles, zero for what is not used.

    Args:
        radians: the camera's yaw, pitch, roll (3, F), radians.
        sight: what the solve is given.

    Returns:
        Residuals EPS (2, L, F), mm, and partial derivatives B (2, 3, L, F), mm per radian,
        x and y on the film along the first axis.

    Source: TM X-3050, A 314 to A 350 and A 386 to A 404. EPS = DISTR*(X - XPC) - CC*XMM, in
    which `sight.x` is DISTR*(X - XPC) already; likewise y.
    """
    (salpha, somega, skappa), (calpha, comega, ckappa) = np.sin(radians), np.cos(radians)
    axes = np.empty((3, 3, radians.shape[1]))
    axes[0, 0] = -calpha * ckappa - salpha * somega * skappa  # AAC
    axes[0, 1] = salpha * ckappa - calpha * somega * skappa  # BBC
    axes[0, 2] = comega * skappa  # CCC
    axes[1, 0] = calpha * skappa - salpha * somega * ckappa  # AACP
    axes[1, 1] = -salpha * skappa - calpha * somega * ckappa  # BBCP
    axes[1, 2] = comega * ckappa  # CCCP
    ffc = somega
    axes[2] = salpha * comega, calpha * comega, ffc  # DDC, EEC, FFC

    xlam, xmu, xnu = sight.dircos
    cc = sight.cc
    along = axes[:, 0, None] * xlam  # XMC, XNC, QC
    along += axes[:, 1, None] * xmu
    along += axes[:, 2, None] * xnu
    qc = along[2]
    xmn = along[:2]
    xmn /= qc  # XMM and XNN
    qq = cc / qc
    computed = cc * xmn  # CM and CN: CC*XMM and CC*XNN
    eps, b = np.empty(computed.shape), np.empty((2, 3, *qc.shape))
    np.subtract(sight.x, computed[0], out=eps[0])
    np.subtract(sight.y, computed[1], out=eps[1])

    ff = axes[2, :, None] * xmn[:, None]
    np.subtract(axes[:2, :, None], ff, out=ff)  # FF1 to FF3, and FB1 to FB3
    gg = xmn * comega  # GG1 and GB1
    gg[0] += ffc * skappa
    gg[1] += ffc * ckappa
    hm1 = xlam * salpha + sight.xmu1 * calpha  # A 394
    by_yaw, by_pitch = b[:, 0], b[:, 1]
    np.multiply(ff[:, 0], xmu, out=by_yaw)
    by_yaw -= ff[:, 1] * xlam  # S1 and SB1
    by_yaw *= qq
    np.multiply(ff[:, 2], hm1, out=by_pitch)
    gg *= xnu  # GG1*XNU and GB1*XNU
    by_pitch += gg  # S2 and SB2
    by_pitch *= qq
    np.negative(computed[1], out=b[0, 2])  # B(1,3) and B(2,3), by roll
    b[1, 2] = computed[0]
    if not sight.used.all():
        eps, b = np.where(sight.used, eps, 0.0), np.where(sight.used, b, 0.0)
    return eps, b


def _correction(eps: Floats, b: Floats) -> tuple[Floats, Bools]:
    """Solve for the correction C (3, F), radians, in the order of the listing.

    A singular matrix is marked, and its C taken as MATINV leaves it: VOPD never looks at DETERM.
    """
    _, count, frames = eps.shape
    terms = np.empty((2, 9, count, frames))
    np.multiply(b[:, :1], b, out=terms[:, 0:3])
    np.multiply(b[:, 1:2], b[:, 1:], out=terms[:, 3:5])
    np.multiply(b[:, 2], b[:, 2], out=terms[:, 5])
    np.multiply(b, -eps[:, None], out=terms[:, 6:9])
    sums = sums_in_order(terms)
    normal = [[sums[place] for place in row] for row in _NORMAL]
    _, regular = reduce(normal, 3, inverse=False)
    return np.stack([row[3] for row in normal]), ~regular


def sums_in_order(terms: Floats) -> Floats:
    """Add up terms over landmarks, one after the other, x and y by turns.

    The order of a sum is part of its result.

    Args:
        terms: of x and of y (2, 9, L, F).

    Returns:
        The sums (9, F).
    """
    _, sums, count, frames = terms.shape
    if count > FEW_LANDMARKS and frames < FEW_FRAMES:
        in_order = terms.transpose(1, 3, 2, 0).reshape(sums, frames, 2 * count)
        in_order[..., 0] += 0.0  # no sum is minus zero
        return np.add.accumulate(in_order, axis=2)[..., -1]
    total = np.zeros((sums, frames))
    for landmark in range(count):
        total += terms[0, :, landmark]
        total += terms[1, :, landmark]
    return total


def wrapped(radians: Floats) -> Floats:
    """Bring angles back to their ranges after a correction (A 432 to A 437).

    Args:
        radians: the camera's yaw, pitch, roll (3, F).
    """
    if ((radians >= _LOWEST) & (radians <= _HIGHEST)).all():
        return radians
    alphar, omegar, xkapr = radians
    alphar, xkapr = (np.where(a < 0, a + twopi, a) for a in (alphar, xkapr))
    omegar = np.where(omegar < -pi, omegar + twopi, omegar)
    alphar, xkapr = (np.where(a > twopi, a - twopi, a) for a in (alphar, xkapr))
    return np.stack([alphar, np.where(omegar > pi, omegar - twopi, omegar), xkapr])
