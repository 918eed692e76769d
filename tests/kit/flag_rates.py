"""How often each flag is raised without a reason, and how often where there is one."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tests.kit.coverage_count import histories_of
from tests.kit.flag_trials import Trial
from tests.kit.simulated_films import simulate
from vopd.attitude.flags import MEANING
from vopd.attitude.history import History

Array = np.ndarray
OF_GEOMETRY = ("two_landmarks", "weak_geometry", "second_solution", "pitch_near_90")
"""Flags that say how well a frame can be determined, not that something is wrong in it."""


class Rates(NamedTuple):
    """Shares of the frames in which something is wrong, and of the others."""

    wrong: int  # how many frames
    others: int
    found: dict[str, float]  # the share of wrong frames that have the flag
    false: dict[str, float]  # the share of the others
    silent: float  # the share of wrong frames without any flag but those of the geometry
    named: float  # the share of wrong frames whose flag `misfit` names what is wrong
    named_alone: float  # and nothing else


def rates(trial: Trial, landmarks: int, seed: int, jobs: int | None = None) -> Rates:
    """Solve the films of a trial and count their flags.

    Args:
        trial: what is wrong
        landmarks: in a frame
        seed: of the random numbers
        jobs: how many, in the place of the plan's
    """
    rng = np.random.default_rng(seed)
    plan = trial.plan._replace(landmarks=landmarks, jobs=jobs or trial.plan.jobs)
    made = trial.spoil(simulate(plan, seed), rng)
    histories = histories_of(
        made.films, trial.fixes, trial.reading, trial.max_rate_deg_s, made.start_deg
    )
    wrong = trial.which(made.films, histories) if trial.which else made.wrong
    raised = {
        name: np.stack([h.flags.raised[name] for h in histories])
        for name in MEANING
        if all(name in h.flags.raised for h in histories)
    }
    telling = [one for name, one in raised.items() if name not in OF_GEOMETRY]
    named = np.stack([_named(h, mend) for h, mend in zip(histories, made.mend, strict=True)])
    return Rates(
        wrong=int(wrong.sum()),
        others=int((~wrong).sum()),
        found={name: _share(one[wrong]) for name, one in raised.items()},
        false={name: _share(one[~wrong]) for name, one in raised.items()},
        silent=_share(~np.any(telling, axis=0)[wrong]),
        named=_share(named[wrong] > 0),
        named_alone=_share(named[wrong] == 1),
    )


def _share(hits: Array) -> float:
    return float(hits.mean()) if hits.size else np.nan


def _named(history: History, mend: Array) -> Array:
    """How many repairs `misfit` names, where the right one is among them, else 0, (F,)."""
    raised, detail = history.flags.raised["misfit"], history.flags.detail["misfit"]
    count = np.zeros(len(mend), int)
    for k in np.flatnonzero(raised):
        told = [one.split(" (")[0] for one in detail[k].split(" or ")]
        count[k] = len(told) if mend[k] in told else 0
    return count
