"""Attitude histories: of decks, of a synthetic flight, and with numbers of one's own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from tests.kit import spherical_film
from tests.kit.command import DECKS
from tests.kit.estimates import estimate
from tests.kit.jobs import reread, without
from vopd.attitude.history import History, history
from vopd.attitude.sigmas import Sigmas
from vopd.attitude.table import columns_of, table
from vopd.estimate import Units, Words
from vopd.export.tables import TableText, as_text
from vopd.film import film_estimate
from vopd.job import Deck
from vopd.pipeline import read_deck, run
from vopd.synthetic import Plan
from vopd.synthetic.flight import make


def histories(*names: str, sigmas: Sigmas | None = None) -> list[History]:
    """Those of decks by their names below decks/, without the suffix."""
    found = []
    for name in names:
        jobs = read_deck(DECKS / f"{name}.dat")
        found += run(replace(jobs, name=f"{name}.dat")).histories(sigmas)
    return found


def table_text(histories: Sequence[History]) -> TableText:
    """The columns of the attitude table as the CSV has them."""
    return as_text(table(histories), columns_of(histories))


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
    estimate = film_estimate(solved.results, solved.source, solved.number)
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
    counts = {"landmarks": changes["used"].sum(axis=1)} if "used" in changes else {}
    return replace(history, estimate=replace(history.estimate, **changes), **counts)


def about(history: History, **changes: Any) -> History:
    """The same history of another source, job or title."""
    return with_estimate(history, about=history.about._replace(**changes))


# Numbers of one's own


@cache
def base(frames: int) -> History:
    """So many frames, a second apart, with four landmarks each; nothing is flagged."""
    made = history(estimate(np.tile([10.0, -60.0, 20.0], (frames, 1))))
    assert not made.flags.any().any()
    return made


def by_hand(
    frames: int = 3,
    *,
    angles_deg: ArrayLike | None = None,
    half_deg: ArrayLike | None = None,
    eta_deg: ArrayLike | None = None,
    flags: Mapping[str, Sequence[int]] | None = None,
    misfit: Sequence[str] = (),
    outlier: ArrayLike | None = None,
    said: Mapping[str, Any] | None = None,
    **changes: Any,
) -> History:
    """A history with numbers of one's own, and nothing computed anew.

    Args:
        frames: how many
        angles_deg: camera and vehicle yaw, pitch, roll, alpha, beta, eta, (F, 9)
        half_deg: half of their 95 % intervals, (F, 9)
        eta_deg: the interval of eta, (F, 2)
        flags: indices of the frames that have them, by name
        misfit: what explains the misfit of each frame
        outlier: landmarks that are outliers, (F, L)
        said: source, job, title, fixes
        changes: of the estimate
    """
    one = base(frames)
    if angles_deg is not None:
        angles = np.asarray(angles_deg, float)
        names = ("camera_deg", "vehicle_deg", "attack_deg")
        changes |= dict(zip(names, np.split(angles, 3, axis=1), strict=True))
    if outlier is not None:
        changes["outlier"] = np.asarray(outlier)
    one = with_estimate(one, **changes)
    doubt, raised = one.uncertainty, dict(one.flags.raised)
    if half_deg is not None:
        doubt = replace(doubt, half_width_95=np.asarray(half_deg, float))
    if eta_deg is not None:
        doubt = replace(doubt, eta_interval_95_deg=np.asarray(eta_deg, float))
    for name, indices in (flags or {}).items():
        assert name in raised
        raised[name] = np.isin(np.arange(frames), indices)
    detail = one.flags.detail | ({"misfit": list(misfit)} if misfit else {})
    shown = replace(one.flags, raised=raised, detail=detail)
    return about(replace(one, uncertainty=doubt, flags=shown), **(said or {}))


# A film whose frames have flags of every kind


FILM = Units("ft", "mm", 0.3048, "µm", 1000.0)
WORDS = Words(source="deck", landmark="its number on cards", reading="a film reading")
SAID = {"source": "a.dat", "job": 2, "title": "a title", "words": WORDS, "fixes": ""}
LOST = np.array([[1.0, 2.0, 3.0], [np.nan] * 3, [1.0, 2.0, 3.0]])
FLAGS = {"not_converged": [0, 2], "misfit": [2], "jump": [0, 1, 2]}


def flagged_film(**changes: Any) -> History:
    """Three frames, the second without an attitude."""
    given = {"units": FILM, "said": SAID, "vehicle_deg": LOST, "flags": FLAGS}
    return by_hand(3, **(given | changes))


def in_source(name: str, job: int = 1, **changes: Any) -> History:
    """The same in another source."""
    return flagged_film(said=SAID | {"source": name, "job": job}, **changes)


def with_sigmas(one: History, **sigmas: Any) -> History:
    """The same with a reading sigma that was given, and others in force."""
    doubt = one.uncertainty
    reading = replace(doubt.reading, sigma=0.12345, source="given", freedom=7.5)
    return replace(
        one,
        uncertainty=replace(doubt, reading=reading, sigmas=doubt.sigmas._replace(**sigmas)),
    )
