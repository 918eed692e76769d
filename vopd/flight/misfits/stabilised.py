"""Stabilised video: the picture is shifted from frame to frame, and its principal point with it.

The shift of the principal point, two unknowns more in each frame, is tested for all frames
together, beside every error that frames have in common. A turn of the camera does nearly the same;
what tells them apart is how much farther a turn moves the images at the edge of the picture. A
camera that stands elsewhere from frame to frame does nearly the same, too, and shake under a
rolling shutter something like it; both are compared.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc

from vopd.arrays import Floats, Ints
from vopd.attitude.residuals import SIGNIFICANCE
from vopd.findings import size_text
from vopd.flight.misfits.input_errors import (
    ALIKE,
    LEAST_FREEDOM,
    NOTHING_SHOWS,
    SHIFTED,
    even_path,
    input_errors,
    of_sampled,
    residuals_freedom,
)
from vopd.flight.solve.joint import JointSolution, weighed

LEAST_SHIFT_PX = 3.0  # root mean square of the shifts: smaller ones are not named
LEAST_LANDMARKS = 4  # of a frame: with fewer its turn takes nearly all of a shift
LEAST_FRAMES = 10  # with so many landmarks: fewer tell nothing
MOST_FRAMES = 100  # tested, spread over the flight


class Shifts(NamedTuple):
    """Shifts of the picture from frame to frame that the residuals speak for."""

    size_px: float = 0.0  # root mean square, of u and v together
    chance: float = 1.0  # of residuals that speak for so much where the picture stays
    evidence: float = 0.0  # in chi-square, beside cameras that stand elsewhere in each frame
    beside_shake: float = np.inf  # likewise beside turning rates of each frame, rolling shutter
    rest: float = 1.0  # variance of what they leave, in those of the picks

    @property
    def stabilised(self) -> bool:
        """Whether they are larger than chance, lens and places explain."""
        large = self.chance < SIGNIFICANCE and self.size_px > LEAST_SHIFT_PX
        return large and self.evidence > -ALIKE and self.beside_shake > ALIKE


def shifts_text(joint: JointSolution) -> str:
    """Say that the picture of a video is shifted from frame to frame; or nothing.

    Args:
        joint: the solution of a flight of tracked clicks
    """
    found = shifts_of_frames(joint)
    if not found.stabilised:
        return ""
    turn_deg = np.degrees(found.size_px / float(joint.model.flight.lens.focal_px.mean()))
    or_positions = ""
    if found.evidence < ALIKE:
        or_positions = ", or for positions that are as far off from frame to frame ([track])"
    return (
        f"{SHIFTED}, by {size_text(found.size_px)} px rms "
        f"or more (chance below {SIGNIFICANCE:g}), as stabilisation does{or_positions}: the angles "
        f"take a shift for a turn of the camera, {size_text(turn_deg)} degree; give the file that "
        "is not stabilised as [picks] video, and click and track in it; or switch stabilisation "
        "off and fly again"
    )


def shifts_of_frames(joint: JointSolution) -> Shifts:
    """Estimate and test shifts of the picture from frame to frame, to first order.

    Args:
        joint: the solution of a flight
    """
    joint = of_sampled(joint)
    model = joint.model
    frame = model.flight.picks.frame[model.pick]
    count = np.bincount(frame, minlength=model.frames)
    some = np.flatnonzero(count >= LEAST_LANDMARKS)
    if len(some) < LEAST_FRAMES:
        return Shifts()
    if len(some) > MOST_FRAMES:
        some = some[np.linspace(0, len(some) - 1, MOST_FRAMES).round().astype(int)]
    centre, place, turn = (np.zeros((len(frame), 2, k)) for k in (2, 3, 3))
    centre[:, [0, 1], [0, 1]] = model.scale[:, None]
    for rows in model.rows(joint.state):
        place[rows.picks], turn[rows.picks] = rows.by_place, rows.by_turn
    trial = input_errors(joint, even_path(joint))[1]
    common = np.concatenate([centre, trial], axis=2)
    size_px, chance, rest = _changing(joint, some, centre, common)
    others, freedom = [place], residuals_freedom(joint)
    if model.readout is not None:
        others.append(turn * model.readout.part[model.pick][:, None, None])
    evidence = [
        freedom * float(np.log(_changing(joint, some, other, common)[2] / rest)) for other in others
    ]
    return Shifts(size_px, chance, evidence[0], min(evidence[1:], default=np.inf), rest)


@np.errstate(all="ignore")
def _changing(
    joint: JointSolution, some: Ints, by: Floats, common: Floats
) -> tuple[float, float, float]:
    """Test an error that changes from frame to frame, beside errors that all frames share.

    Its size is by moments: the right sides b of its equations have the variance w v + w^2 s^2, w
    their eigenvalues, v the residuals' variance, s the size of u and of v.

    Args:
        joint: the solution of a flight
        some: frames that are tested
        by: changes of the images by a unit of the error, in standard deviations, (P, 2, k)
        common: by those that frames share, (P, 2, K)

    Returns:
        Its size, the chance of so much where it does not change, and the variance that is left.
    """
    model, k = joint.model, by.shape[2]
    frame, least = model.flight.picks.frame[model.pick], model.flight.picks.least_variance
    change = np.zeros((len(frame), 2, k * len(some)))
    for column, one in enumerate(some.tolist()):
        own = np.flatnonzero(frame == one)
        change[own, :, k * column : k * column + k] = by[own]
    power = np.maximum((common**2).sum(axis=(0, 1)), np.finfo(float).tiny)
    stated = joint.stated[1]
    beside = np.concatenate([stated, common / np.sqrt(power)], axis=2)
    square, right = weighed(joint, np.concatenate([beside, change], axis=2))
    known = beside.shape[2]
    prior = np.where(np.arange(known) < stated.shape[2], 1.0, NOTHING_SHOWS)
    square[np.arange(known), np.arange(known)] += prior
    by_others = np.linalg.solve(
        square[:known, :known], np.column_stack([square[:known, known:], right[:known]])
    )
    cost = joint.normal.cost - float(right[:known] @ by_others[:, -1])
    right = right[known:] - square[known:, :known] @ by_others[:, -1]
    square = square[known:, known:] - square[known:, :known] @ by_others[:, :-1]
    size, axes = np.linalg.eigh((square + square.T) / 2.0)
    told = size > NOTHING_SHOWS * float((change**2).sum(axis=(0, 1)).max())
    size, right = size[told], (axes.T @ right)[told]
    freedom = residuals_freedom(joint) - common.shape[2] - len(size)
    if freedom < LEAST_FREEDOM:
        return 0.0, 1.0, 1.0
    gain = float((right**2 / size).sum())
    rest = max((cost - gain) / freedom, least)
    variance = float((right**2 - size * rest).sum() / (size**2).sum())
    chance = float(fdtrc(len(size), freedom, gain / len(size) / rest))
    return float(np.sqrt(2.0 * max(variance, 0.0))), chance, rest
