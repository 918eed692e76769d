"""Keys that [track] and [position] share: standard deviations and the lever arm."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats
from vopd.flight.project import Section
from vopd.flight.track_formats.track_rows import TrackRows


def path_sigma(section: Section, rows: TrackRows | None = None) -> Floats:
    """East, north, up: the project's, else the root mean square of the file's, else NaN."""
    stated = section.sigma("sigma_m", 3)
    if stated is not None:
        return np.array(stated)
    if rows is None or rows.sigma_m is None or not np.isfinite(rows.sigma_m).any():
        return np.full(3, np.nan)
    return np.asarray(np.sqrt(np.nanmean(rows.sigma_m**2, axis=0)))


def lever_arm(section: Section) -> Floats | None:
    """From the antenna to the camera in the body's axes, where it is given."""
    return np.array(section.numbers("lever_arm_m", 3)) if section.has("lever_arm_m") else None
