"""An estimate made by hand whose first frame has one landmark only."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.kit.estimates import estimate
from vopd.estimate import Estimate


def one_landmark(*used: int, frames: int = 2) -> Estimate:
    """Frames in the first of which only some landmarks take part, by default the first.

    Args:
        used: indices of these
        frames: how many frames there are; the others have all four landmarks
    """
    return only(used or (0,), frames)


def no_landmark() -> Estimate:
    """Two frames, the first of which has no landmark."""
    return only((), 2)


def only(used: tuple[int, ...], frames: int) -> Estimate:
    """Frames in the first of which only these landmarks take part."""
    one = estimate(np.tile([140.0, -60.0, 20.0], (frames, 1)), noise=0.01)
    takes_part, gain = one.used.copy(), one.gain.copy()
    takes_part[0] = False
    takes_part[0, list(used)] = True
    gain[0] = np.nan
    return replace(one, used=takes_part, gain=gain, body_gain=gain.copy())
