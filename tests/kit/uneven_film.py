"""Films whose frames have very different numbers of landmarks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tests.kit import spherical_film
from vopd.job import Job, LandmarkReadings, Readings
from vopd.landmark_layout import LandmarkLayout

TRUTH = np.array([140.0, -80.0, 60.0])


def uneven(count: list[int]) -> Job:
    """A film of frames with these numbers of landmarks, five of them read again and again.

    The angles differ a little from frame to frame, and every reading has an error.
    """
    rng = np.random.default_rng(len(count))
    even = spherical_film.job(TRUTH + rng.uniform(-1.0, 1.0, (len(count), 3)), TRUTH)
    old, layout = even.readings, LandmarkLayout(np.array(count))
    which = old.layout.start[layout.frame]
    which += (np.arange(layout.total) - layout.start[layout.frame]) % 5
    points = old.points.landmark_in[which]
    errors = np.round(rng.normal(0.0, 0.003, points.shape), 3)
    marks = LandmarkReadings(old.points.landmark[which], points + errors)
    readings = Readings(layout, marks, old.frame, old.fiducial_in)
    return replace(even, readings=readings)
