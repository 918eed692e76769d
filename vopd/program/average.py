"""The averages of the film reader's readings (A 84 to A 104), through unit 9 (FORMAT 87)."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.job import Readings

_POWERS = 10.0 ** np.arange(11)


def averages(readings: Readings, rounded: bool = True) -> tuple[Floats, Floats]:
    """Frame centres (F, 2) and landmarks (F, L, 2) in inches, as unit 9 kept them.

    Four fiducials and three readings are averaged as the listing adds them (A 88
    to A 101), each point's readings in ascending order so that their order
    cannot matter; FORMAT E13.7 then leaves eight significant digits, unless they
    are not to be `rounded`.
    """
    fiducials = np.sort(readings.fiducial_in, axis=2).reshape(-1, 12, 2)
    centre = np.zeros_like(fiducials[:, 0])
    for k in range(12):
        centre = centre + fiducials[:, k] / 12.0
    three = np.sort(readings.landmark_in, axis=2)
    landmark = np.zeros_like(three[:, :, 0])
    for k in range(3):
        landmark = landmark + three[:, :, k] / 3.0
    if not rounded:
        return centre, landmark
    return eight_digits(centre), eight_digits(landmark)


def eight_digits(values: Floats) -> Floats:
    """Round to eight significant digits, as FORMAT 1PE15.7 prints and reads a number."""
    size = np.abs(values)
    ordinary = (size >= 1e-3) & (size < 1e8)
    scale = _POWERS[(7 - np.floor(np.log10(np.where(ordinary, size, 1.0)))).astype(np.intp)]
    scaled = values * scale
    near_tie = np.abs(np.abs(scaled - np.trunc(scaled)) - 0.5) < 1e-5
    rounded: Floats = np.rint(scaled) / scale
    for place in zip(*np.nonzero((~ordinary | near_tie) & (values != 0)), strict=True):
        rounded[place] = float(f"{values[place]:.7e}")
    return rounded
