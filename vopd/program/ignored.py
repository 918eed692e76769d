"""Find which frames are dropped and which landmarks are ignored (A 129 to A 161)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Bools, among
from vopd.job import Ignored, Readings

WHOLE_FRAME = 100


def kept(readings: Readings, ignored: Ignored) -> tuple[Bools, Bools]:
    """Find the dropped frames and the landmarks that take part, by groups 11 and 12.

    The program counts requests and not landmarks: a request that would leave fewer
    than two landmarks is refused, and so are all after it in that frame. One of group
    11 that is refused is tried again, and counted again, if group 12 names the same
    landmark.

    Args:
        readings: the film reader's readings of a job.
        ignored: its groups 10 to 12.

    Returns:
        Which frames are dropped (F,), and which landmarks take part (N,).

    Source: TM X-3050, A 129 to A 161.
    """
    dropped = np.zeros(len(readings.frame), bool)
    layout, landmark = readings.layout, readings.points.landmark
    used = np.ones(layout.total, bool)
    requests: dict[int, list[list[int]]] = {}
    # A 129 to A 131, A 144 to A 146: the cards of group 11, IFM and JOUT (NOUT of them), by frame
    for frame, landmarks in zip(ignored.frame.tolist(), ignored.landmark.tolist(), strict=True):
        requests.setdefault(frame, []).append(landmarks)
    # A 76, A 81: an entry below 1 becomes 101, which is no landmark; here it is left out
    everywhere = {n for n in ignored.everywhere.tolist() if n > 0}
    concerned = among(readings.frame, ignored.frame)
    if everywhere:
        concerned |= layout.counted(among(landmark, np.array(list(everywhere)))) > 0
    for k in np.flatnonzero(concerned):
        cards, span = requests.get(int(readings.frame[k]), []), layout.span(k)
        # A 132 to A 136: 100 as the first entry of the frame's first card drops it
        dropped[k] = bool(cards) and cards[0][0] == WHOLE_FRAME
        if not dropped[k]:
            here = {n for card in cards for n in card if n > 0}
            if here or everywhere:
                _ignore(landmark[span].tolist(), used[span], here, everywhere)
    if dropped.any():
        used[dropped[layout.frame]] = False
    return dropped, used


def _ignore(landmark: list[int], used: Bools, here: set[int], everywhere: set[int]) -> None:
    """Take the ignored landmarks of one frame, which all take part, out of `used`.

    Source: TM X-3050, A 138 to A 161: by group 11 A 147 to A 152, by group 12 A 155 to A 160.
    """
    nj, nk = len(landmark), 0
    for index, itgt in enumerate(landmark):
        for asked in (here, everywhere):
            if itgt in asked:
                nk += 1
                if nj - nk >= 2:
                    used[index] = False
                    break
