"""Results with any numbers in them, for printing."""

from __future__ import annotations

import numpy as np

from tests.kit.jobs import film
from tests.kit.result_arrays import ARRAYS, with_arrays
from vopd.program.vopd import run
from vopd.results import Outcome, Results

PRINTED = {*ARRAYS} - {
    "frame", "outcome", "landmark", "used", "ignored", "start_deg",
    "correction_rad", "last_pass", "singular", "at_centre", "airspeed_ft_s",
    "outside_clock", "outside_trajectory", "outside_wind",
}  # fmt: skip
"""The fields that are real numbers on a page."""


def solved(frames: int) -> Results:
    """A real film of five landmarks a frame."""
    return run(film(frames))


def with_numbers(results: Results, rng: np.random.Generator) -> Results:
    """The same pages with other numbers: of every size, both signs, some that do not fit."""
    new = {}
    for name in sorted(PRINTED):
        shape = getattr(results, name).shape
        size = 10.0 ** rng.uniform(-9.0, 4.0, shape)
        size *= np.where(rng.random(shape) < 0.02, 1e6, 1.0)
        new[name] = size * rng.choice([-1.0, 1.0], shape)
    frames = rng.integers(-999, 9999, results.frame.shape)
    landmark = rng.integers(-9, 99, results.landmark.shape)
    return with_arrays(results, frame=frames, landmark=landmark, **new)


def with_ends(results: Results, rng: np.random.Generator) -> Results:
    """The same with landmarks ignored and frames that end in every way."""
    outcomes = [Outcome.SOLVED, Outcome.DROPPED, Outcome.EXACT, Outcome.EXACT_LATE]
    outcome = rng.choice(outcomes, len(results.frame))
    used = rng.random(results.used.shape) < 0.7
    used[outcome == Outcome.DROPPED] = False
    ignored = ~used & (rng.random(used.shape) < 0.5) & (outcome != Outcome.DROPPED)[:, None]
    residual = np.where(rng.random(results.residual_mm.shape) < 0.5, 0.0, results.residual_mm)
    return with_arrays(results, outcome=outcome, used=used, ignored=ignored, residual_mm=residual)
