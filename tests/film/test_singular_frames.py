"""Landmarks that are one but for rounding: nothing determines the turn about them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit.jobs import case, reread
from vopd.film import film_estimate
from vopd.job import Job
from vopd.program.vopd import run


def one_place(apart_min: float) -> Job:
    """Case 1 with its landmarks read at one place, and so many minutes of longitude apart."""
    job = case(1)
    readings, known = job.readings, job.landmarks
    film = np.broadcast_to(readings.landmark_in[:, :1], readings.landmark_in.shape)
    columns = {
        name: np.full_like(column, column[0])
        for name, column in vars(known).items()
        if name != "number"
    }
    columns["longitude_min"] = columns["longitude_min"] + apart_min * np.arange(len(known.number))
    landmarks = replace(known, **columns)
    return replace(job, readings=reread(readings, landmark_in=film.copy()), landmarks=landmarks)


@pytest.mark.parametrize(
    ("apart_min", "known"),
    [(1e-3, True), (1e-5, True), (1e-6, False), (1e-7, False), (1e-11, False)],
)
def test_what_is_left_by_rounding_determines_no_angle(apart_min: float, known: bool) -> None:
    """1E-3 minute is 1.8 m from 44 km, 1E-7 is .2 mm: a relative size of 1E-17 in P'B.

    The limit is 1E-14, between those of 1E-5 and 1E-6.
    """
    results = run(one_place(apart_min))
    assert results.solved.all()
    gain = film_estimate(results).gain
    assert np.isfinite(gain).all() == known and np.isnan(gain).all() != known
