"""A film of three frames, the second without an attitude, for the pages that tell of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from tests.kit.histories_by_hand import by_hand
from vopd.attitude.history import History
from vopd.estimate import Units, Words

FILM = Units("ft", "mm", 0.3048, "µm", 1000.0)
WORDS = Words(source="deck", landmark="its number on cards", reading="a film reading")
SAID = {"source": "a.dat", "job": 2, "title": "a title", "words": WORDS, "fixes": ""}
LOST = np.array([[1.0, 2.0, 3.0], [np.nan] * 3, [1.0, 2.0, 3.0]])
FLAGS = {"not_converged": [0, 2], "misfit": [2], "jump": [0, 1, 2]}


def film(**changes: Any) -> History:
    """Three frames, the second without an attitude."""
    given = {"units": FILM, "said": SAID, "vehicle_deg": LOST, "flags": FLAGS}
    return by_hand(3, **(given | changes))


def in_source(name: str, job: int = 1, **changes: Any) -> History:
    """The same in another source."""
    return film(said=SAID | {"source": name, "job": job}, **changes)


def with_sigmas(one: History, **sigmas: Any) -> History:
    """The same with a reading sigma that was given, and others in force."""
    doubt = one.uncertainty
    reading = doubt.reading._replace(sigma=0.12345, source="given", freedom=7.5)
    return replace(
        one,
        uncertainty=replace(doubt, reading=reading, sigmas=doubt.sigmas._replace(**sigmas)),
    )
