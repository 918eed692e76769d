"""The landmark that does not fit the others: false alarms as rare as stated, misreadings found."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit import repeated_frame as draws
from tests.kit.jobs import film, only, reread
from vopd.attitude.history import history
from vopd.attitude.long_history import frame_landmarks
from vopd.attitude.residuals import outliers
from vopd.errata import fixes
from vopd.film import film_estimate
from vopd.program.vopd import run


@pytest.mark.parametrize(("names", "count"), [((), 4), (("first-landmark",), 5)])
def test_false_alarms_are_as_rare_as_stated(names: tuple[str, ...], count: int) -> None:
    """One frame in a thousand; of 16,000 frames 16 are expected, 33 would be four sigmas."""
    rng = np.random.default_rng(count)
    job = draws.repeated((30.0, -62.0, 200.0), range(count), draws=16_000)
    found = outliers(film_estimate(run(draws.misread(job, 0.003, rng), fixes(*names))))
    assert 3 <= found.any(axis=1).sum() <= 32
    assert found.sum(axis=1).max() == 1


@pytest.mark.parametrize("which", range(5))
def test_the_landmark_that_is_off_is_named(which: int) -> None:
    """By .05 in where readings have .001; every time."""
    job = draws.repeated((30.0, -62.0, 200.0), draws=200)
    job = draws.misread(job, 0.001, np.random.default_rng(which))
    readings = job.readings.landmark_in.copy()
    readings[:, which, :, 0] += 0.05
    misread = replace(job, readings=reread(job.readings, landmark_in=readings))
    one = history(film_estimate(run(misread)))
    marked = frame_landmarks(one).outlier.reshape(200, 5)
    assert marked[:, which].all() and marked.sum() == 200
    assert f"outlier:{11 + which}" in one.flags.text()[0]


def test_of_three_none_can_be_told() -> None:
    job = only(film(1), 0, 1, 2)
    readings = job.readings.landmark_in.copy()
    readings[:, 1] += 0.5
    bent = replace(job, readings=reread(job.readings, landmark_in=readings))
    assert not outliers(film_estimate(run(bent))).any()
