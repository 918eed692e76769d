"""How often true lens, clock, landmarks and attitudes lie in what `vopd adjust` states of them.

The flights' truths are drawn from what their projects state, apart from the package. Counted are
parameters that the picks hold, and the attitudes of all frames with whatever is held.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

import vopd
from tests.kit.flight_coverage import PLACE_95
from tests.kit.simulated_flights import Errors, LensErrors, Plan, Truth, write_flight
from vopd.attitude.table import table

ATTITUDE = "attitude"
PARAMETERS = {
    "focal": ("focal",), "aspect": ("aspect",), "centre": ("centre_u", "centre_v"), "k1": ("k1",),
    "k2": ("k2",), "p1p2": ("p1", "p2"), "clock": ("clock",), "clock-rate": ("clock-rate",),
    "readout": ("readout",), "track-offset": ("track-offset",), "landmarks": ("landmark",),
    ATTITUDE: (),
}  # fmt: skip
"""Columns, by the names of `vopd adjust --free`, with what their rows begin with."""


class ParameterRow(NamedTuple):
    """Flights with parameters that are drawn from what is stated of them, and freed."""

    name: str
    plan: Plan
    free: tuple[str, ...]


DRONE = Plan(
    Errors(
        1.0, (0.05,), ((0.2, 0.2, 0.4),), clock_s=0.08,
        lens=LensErrors(0.0013, 3.0, 4.0, 0.05, 0.05),
    ),
    flights=1000, frames=40, landmarks=10, frame_hz=4.0, sigma_px=True, speed_m_s=1.5,
    weave_m=3.0,
)  # fmt: skip
WHOLE = DRONE._replace(
    errors=DRONE.errors._replace(
        bias_m=(0.5, 0.5, 1.0), clock_rate_ppm=5e4,
        lens=LensErrors(0.01, 10.0, 10.0, 0.05, 0.05, 0.005, 0.005, 0.003),
    )
)  # fmt: skip
ROLLING = DRONE._replace(
    errors=DRONE.errors._replace(readout_ms=2.0), readout_ms=10.0, frame_hz=10.0, fix_hz=5.0,
    jitter_deg=0.0, swing_deg=8.0,
)  # fmt: skip
FISHEYE = DRONE._replace(
    fisheye=True, focal_px=700.0, distortion=(0.05, -0.01),
    errors=DRONE.errors._replace(lens=LensErrors(0.003, 3.0, 4.0, 0.01, 0.01)),
)  # fmt: skip
STANDS = DRONE._replace(
    stands=True,
    errors=Errors(
        1.0, (0.05,), bias_m=(0.5, 0.5, 1.0), lens=DRONE.errors.lens._replace(focal_rel=0.01)
    ),
)  # fmt: skip
LENS = ("focal", "centre", "k1", "k2")
MOVING = (*LENS, "clock", "landmarks")
ALL = (*MOVING, "aspect", "p1p2", "clock-rate", "track-offset")

PARAMETER_ROWS = (
    ParameterRow("lens, clock, landmarks", DRONE, MOVING),
    ParameterRow("the same, velocities given", DRONE._replace(velocity=True), MOVING),
    ParameterRow("the same, sigma_px not stated", DRONE._replace(sigma_px=False), MOVING),
    ParameterRow("lens whole, clock, its rate, offset", WHOLE, ALL),
    ParameterRow("lens whole, velocities given", WHOLE._replace(velocity=True), ALL),
    ParameterRow("rolling shutter", ROLLING, (*MOVING, "readout")),
    ParameterRow("fisheye, lens and clock", FISHEYE, MOVING),
    ParameterRow("camera that stands, lens", STANDS, (*LENS, "landmarks")),
)  # fmt: skip


def parameters_counted(row: ParameterRow, seed: int, flights: int) -> dict[str, np.ndarray]:
    """Count how often parameters and attitudes lie inside their 95 % intervals, by columns.

    Args:
        row: the configuration
        seed: of the random numbers
        flights: how many

    Returns:
        Values of each flight that are inside, (J, k): 1 or 0, NaN for one that is not held.
    """
    rng = np.random.default_rng(seed)
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(flights):
            truth = write_flight(Path(folder), row.plan, rng)
            found.append(_inside(Path(folder) / "flight.toml", row.free, truth))
    return {name: np.stack([one[name] for one in found]) for name in found[0]}


def _inside(project: Path, free: tuple[str, ...], truth: Truth) -> dict[str, np.ndarray]:
    """Adjust a flight, and compare table and attitudes with the truth; NaN: not held."""
    made = vopd.adjust(project, free)
    found = {}
    for name in free:
        rows = [one for one in made.parameters if one.name.startswith(PARAMETERS[name])]
        near = [
            abs(one.after - truth.value[one.name]) <= PLACE_95 * one.sigma_after for one in rows
        ]
        # landmarks have the value as solved whether they are held or not
        found[name] = np.where([one.held or name == "landmarks" for one in rows], near, np.nan)
    stated = table([made.result.history()])
    inside = []
    for k, angle in enumerate(("vehicle_yaw", "vehicle_pitch", "vehicle_roll"), 3):
        off = (stated[f"{angle}_deg"] - truth.angles_deg[:, k] + 180.0) % 360.0 - 180.0
        inside.append(np.abs(off) <= stated[f"half_width_95_{angle}_deg"])
    return found | {ATTITUDE: np.concatenate(inside).astype(float)}
