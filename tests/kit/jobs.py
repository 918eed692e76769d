"""Jobs to run, and readings, results and answers of rules with something changed in them."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from tests.kit import spherical_film
from vopd.job import Job, Readings
from vopd.pipeline import read_deck
from vopd.results import LandmarkResults, Results

# Readings


READING_ARRAYS = "frame", "fiducial_in", "landmark", "present", "landmark_in"


def reread(readings: Readings, **arrays: np.ndarray) -> Readings:
    """The readings with other arrays, by frame and landmark as `Readings.of` takes them."""
    every = {name: getattr(readings, name) for name in READING_ARRAYS} | arrays
    return replace(Readings.of(**every), first_card=readings.first_card)


# Jobs: the report's, and small films that can be bent


APPENDIX_H = Path(__file__).parents[2] / "decks" / "appendix_h"


def case(number: int) -> Job:
    """A case of Appendix H."""
    (job,) = read_deck(APPENDIX_H / f"case{number}.dat")
    return job


def film(frames: int = 3) -> Job:
    """Frames 1, 2 ... of 5 landmarks at yaw 140, pitch -80, roll 60, which is group 8's guess."""
    truth = np.tile([140.0, -80.0, 60.0], (frames, 1))
    return spherical_film.job(truth, truth[0])


def without(job: Job, *frames: int) -> Job:
    """The job with frames dropped by group 11."""
    asked = np.zeros((len(frames), 6), np.int64)
    asked[:, 0] = 100
    return replace(
        job, ignored=replace(job.ignored, frame=np.array(frames, np.int64), landmark=asked)
    )


def turned(angles_deg: np.ndarray, start_deg: np.ndarray) -> Job:
    """A film of these camera angles (F, 3), group 8 with this first estimate (3,)."""
    return spherical_film.job(angles_deg, start_deg)


def only(job: Job, *landmarks: int) -> Job:
    """The job with some of its landmarks, by their index in every frame."""
    r, chosen = job.readings, list(landmarks)
    return replace(
        job,
        readings=reread(
            r,
            landmark=r.landmark[:, chosen],
            present=r.present[:, chosen],
            landmark_in=r.landmark_in[:, chosen],
        ),
    )


# Results


BY_LANDMARK = tuple(field.name for field in fields(LandmarkResults))
BY_FRAME = tuple(
    field.name
    for field in fields(Results)
    if field.name not in ("layout", "points", "job", "fixes", "stop")
)
RESULT_ARRAYS = (*BY_FRAME, *BY_LANDMARK)


def with_arrays(results: Results, **values: Any) -> Results:
    """The results with other values, arrays by landmark as (F, L, ...)."""
    marks = {name: values.pop(name) for name in BY_LANDMARK if name in values}
    flat = {name: results.layout.flat(array) for name, array in marks.items()}
    return replace(results, points=replace(results.points, **flat), **values)
