"""Say whether the three readings of the points of a film are copies of each other."""

from __future__ import annotations

import numpy as np

from vopd.job import Readings

MOST = 0.5  # of the points: if more are copies, the readings were not made three times


def copied_readings_text(readings: Readings) -> str:
    """The warning about readings that are copies; empty where they are not.

    Three readings of a point that agree in all digits happen by chance, but not in most
    points of a film. Where they are copies, their spread does not show how well the
    points were read.

    Args:
        readings: the basic data of a job
    """
    points = np.concatenate([
        readings.fiducial_in.reshape(-1, 3, 2),
        readings.points.landmark_in,
    ])  # fmt: skip
    copied = int((points == points[:, :1]).all(axis=(1, 2)).sum())
    if copied <= MOST * len(points):
        return ""
    return (
        f"all three readings are the same in {copied} of {len(points)} points: their spread says "
        "nothing about how well the points were read"
    )
