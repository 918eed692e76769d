"""Attitude histories of decks, of a synthetic flight, and with something changed in them."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from tests.kit import spherical_film
from tests.kit.command import DECKS
from tests.kit.jobs import without
from tests.kit.readings import reread
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.cards.read import read_deck
from vopd.film import film_estimate
from vopd.job import Deck
from vopd.pipeline import run
from vopd.synthetic import Plan
from vopd.synthetic.flight import make


def histories(*names: str, sigmas: Sigmas | None = None) -> list[History]:
    """Those of decks by their names below decks/, without the suffix."""
    found = []
    for name in names:
        jobs = read_deck(DECKS / f"{name}.dat")
        found += run(replace(jobs, name=f"{name}.dat")).histories(sigmas)
    return found


@cache
def flight(frames: int = 30) -> tuple[History, ...]:
    """A flight with frame 8 ignored, and landmark 3 of frame 5 misread by far.

    It is over the Earth of 1974, and so that Earth is no error of its angles.
    """
    job = make(Plan(frames=frames, landmarks=6, seed=2))[0][0]
    readings = job.readings.landmark_in.copy()
    readings[4, 2] += 0.1
    ignored = replace(
        job.ignored, frame=job.readings.frame[7:8], landmark=np.array([[100, 0, 0, 0, 0, 0]])
    )
    job = replace(job, readings=reread(job.readings, landmark_in=readings), ignored=ignored)
    (solved,) = run(Deck((job,), "flight.dat")).jobs
    estimate = film_estimate(solved.results, solved.deck, solved.number)
    return (history(replace(estimate, slip_effect_deg=None)),)


def turning(rate_deg: float = 4.0, count: int = 20) -> History:
    """Yaw through north, so many degrees a frame; frames 9 to 11 ignored."""
    angles = np.tile([340.0, -75.0, 60.0], (count, 1))
    angles[:, 0] = (340.0 + rate_deg * np.arange(count)) % 360.0
    job = without(spherical_film.job(angles, angles[0]), 9, 10, 11)
    (one,) = run(Deck((job,), "turning.dat"), start_deg=angles).histories()
    return one


def with_estimate(history: History, **changes: Any) -> History:
    """The same history with some of its estimate changed, and nothing computed anew."""
    return replace(history, estimate=replace(history.estimate, **changes))


def about(history: History, **changes: Any) -> History:
    """The same history of another source, job or title."""
    return with_estimate(history, about=history.about._replace(**changes))
