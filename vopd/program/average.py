"""Average the readings of frame centres and landmarks (A 84 to A 104)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.job import Readings

_POWERS = 10.0 ** np.arange(11)


def averages(readings: Readings, rounded: bool = True) -> tuple[Floats, Floats]:
    """Average the readings of frame centres and landmarks.

    Four fiducials and three readings are divided and added up as in the listing. There they are
    added in the order of their cards; here each point's readings are in ascending order, so that
    the order of the cards cannot matter.

    Args:
        readings: the film reader's readings of a job.
        rounded: whether to keep eight significant digits, as unit 9 did by FORMAT 87.

    Returns:
        Frame centres (F, 2) and landmarks (N, 2), inches on the film reader.

    Source: TM X-3050, A 84 to A 104, and the card behind A 102, lost in the scan, that writes a
    frame's number, centre and landmarks to unit 9; FORMAT 87, A 471. There a landmark's number is
    that of its third reading (A 102), and a frame's that of its last card; here readings that
    differ are an error of the deck.
    """
    fiducials = np.sort(readings.fiducial_in, axis=2).reshape(-1, 12, 2)
    centre = np.zeros_like(fiducials[:, 0])
    for k in range(12):
        centre = centre + fiducials[:, k] / 12.0
    three = np.sort(readings.points.landmark_in, axis=1)
    landmark = np.zeros_like(three[:, 0])
    for k in range(3):
        landmark = landmark + three[:, k] / 3.0
    if not rounded:
        return centre, landmark
    return eight_digits(centre), eight_digits(landmark)


def eight_digits(values: Floats) -> Floats:
    """Round to eight significant digits, which E13.7 of FORMAT 87 kept in 1974.

    Today's FORMAT for them is 1PE15.7.

    Args:
        values: numbers, (...), in any unit.
    """
    size = np.abs(values)
    ordinary = (size >= 1e-3) & (size < 1e8)
    scale = _POWERS[(7 - np.floor(np.log10(np.where(ordinary, size, 1.0)))).astype(np.intp)]
    scaled = values * scale
    near_tie = np.abs(np.abs(scaled - np.trunc(scaled)) - 0.5) < 1e-5
    rounded: Floats = np.rint(scaled) / scale
    for index in zip(*np.nonzero((~ordinary | near_tie) & (values != 0)), strict=True):
        rounded[index] = float(f"{values[index]:.7e}")
    return rounded
