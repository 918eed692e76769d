"""How often blunders of a flight are named by leaving out each pick, landmark and frame in turn."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

import vopd
from tests.kit.flight_mistakes import MistakeRow
from tests.kit.simulated_flights import BLUNDERS, Plan, Truth, write_flight
from vopd.flight.adjust.tested import Named, TestedFlight, tested_flight
from vopd.flight.misfits.leave_out import KINDS

SIZE = 5.0  # of noticeable ones
KIND = {"landmark": "landmark", "pick": "pick", "time of a frame": "time"}
"""What is named."""


class BlunderRow(NamedTuple):
    """Flights with one blunder that their projects do not know of; none: `blunder` is empty."""

    blunder: str
    fix_m: float  # standard deviation of the positions

    @property
    def name(self) -> str:
        """What stands in the table."""
        return MistakeRow(self.blunder, self.fix_m).name

    @property
    def plan(self) -> Plan:
        """Those of other mistakes."""
        return MistakeRow("", self.fix_m).plan._replace(flights=100 if self.blunder else 200)


class NamedBlunders(NamedTuple):
    """Shares of flights."""

    named: float  # it is named, or is among what explains the residuals as well
    alone: float  # it is named, and nothing else with it
    other: float  # something else is named besides, or in its place


BLUNDER_ROWS = tuple(
    BlunderRow(blunder, fix_m) for blunder in ("", "landmark", *BLUNDERS) for fix_m in (0.02, 2.0)
)


def blunders_named(row: BlunderRow, seed: int, flights: int) -> NamedBlunders:
    """Test flights with a blunder, and count what is named.

    Args:
        row: the blunder
        seed: of the random numbers
        flights: how many
    """
    rng = np.random.default_rng(seed)
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(flights):
            truth = write_flight(Path(folder), row.plan, rng, row.blunder, SIZE)
            tested = tested_flight(vopd.solve_flight(Path(folder) / "flight.toml"))
            found.append(_found(tested, truth, row.blunder))
    return NamedBlunders(*np.mean(found, axis=0))


def _found(tested: TestedFlight, truth: Truth, blunder: str) -> tuple[float, float, float]:
    right = [_is_it(one, tested, truth, blunder) for one in tested.named]
    alone = [ok and len(one.tests.kind) == 1 for ok, one in zip(right, tested.named, strict=True)]
    return float(any(right)), float(any(alone)), float(not all(right))


def _is_it(one: Named, tested: TestedFlight, truth: Truth, blunder: str) -> bool:
    """Tell whether something named is the blunder."""
    names, picks = tested.flight.landmarks.name, tested.flight.picks
    if blunder == "labels of a frame":
        marks = {names[picks.landmark[k]] for k in one.exchanged}
        frames = {int(picks.frame[k]) for k in one.exchanged}
        return frames == {truth.wrong[0]} and marks == {f"m{k}" for k in truth.wrong[1:]}
    if one.exchanged or not blunder:
        return False
    tests = one.tests
    own = tests.kind == KINDS.index(KIND[blunder])
    if blunder == "landmark":
        own &= tests.landmark == names.index("m0")
    if blunder in ("pick", "time of a frame"):
        own &= tests.frame == truth.wrong[0]
    if blunder == "pick":
        own &= tests.landmark == names.index(f"m{truth.wrong[1]}")
    return bool(own.any())
