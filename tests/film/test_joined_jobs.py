"""Estimates that are made for many jobs together are those of each job alone, bit for bit."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import vopd
from tests.kit.command import DECKS
from vopd.errata import Fixes, fixes
from vopd.film import estimates_of_jobs, film_estimate
from vopd.job import Job
from vopd.program.vopd import run
from vopd.results import SolvedJob
from vopd.synthetic import Plan
from vopd.synthetic.flight import make


def different_jobs() -> list[Job]:
    """Jobs with different cameras, origins, tables and numbers of frames and landmarks."""
    jobs: list[Job] = []
    for seed, (frames, landmarks) in enumerate([(3, 4), (1, 4), (2, 2), (5, 4), (1, 2), (4, 3)]):
        (job,), _ = make(Plan(frames=frames, landmarks=landmarks, seed=seed))
        path, camera = job.trajectory, job.camera
        shifted = replace(path, origin_longitude_deg=path.origin_longitude_deg + 0.01 * seed)
        mounted = replace(
            camera,
            multiplier=camera.multiplier * [1.0, -1.0, 1.0],
            focal_length_mm=camera.focal_length_mm + 0.01 * seed,
        )
        jobs.append(replace(job, trajectory=shifted, camera=mounted))
    for name in ("wind_out_of_order", "trajectory_out_of_order", "ignored", "zero_residuals"):
        jobs += vopd.read_deck(DECKS / "regression" / f"{name}.dat")
    return jobs


@pytest.mark.parametrize("chosen", [fixes(), fixes("earth")])
def test_together_is_as_alone(chosen: Fixes) -> None:
    solved = [run(job, chosen) for job in different_jobs()]
    together = estimates_of_jobs([SolvedJob("deck", 1, one) for one in solved])
    assert len(together) == len(solved) >= 10
    for results, (block,) in zip(solved, together, strict=True):
        alone = film_estimate(results, "deck")
        for field in fields(alone):
            same(getattr(block.estimate, field.name), getattr(alone, field.name))


def same(one: Any, other: Any) -> None:
    if isinstance(other, np.ndarray):
        assert one.shape == other.shape
        np.testing.assert_array_equal(one, other)
    elif isinstance(other, tuple):
        for mine, theirs in zip(one, other, strict=True):
            same(mine, theirs)
    elif isinstance(other, float):
        assert one == other or (np.isnan(one) and np.isnan(other))
    else:
        assert one == other
