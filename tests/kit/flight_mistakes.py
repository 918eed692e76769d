"""How often mistakes in a flight's project are named, by their noticeable sizes."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

import vopd
from tests.kit.simulated_flights import MISTAKES, STEPS, Errors, Plan, Triple, write_flight
from vopd.attitude.table import table
from vopd.flight.misfits.unsolved import picks_outside

SIZES = (1 / 3, 1.0, 3.0)  # of noticeable ones
NAMES = {
    "clock": "clock|offset_s",
    "frame rate": "frame_rate_hz",
    "focal length": "focal length",
    "k1": "k1",
    "heights": "height|level",
    "position": "camera's position",
    "landmark": r"\bm0\b",
    "readout": "readout",
    "u and v exchanged": "u and v",
    "v upward": r'\bv = "up"',
    "labels exchanged": r"\bm0\b.*\bm1\b|\bm1\b.*\bm0\b",
}
"""What stands in a finding that names a mistake."""
MISFIT = "misfit"


class MistakeRow(NamedTuple):
    """Flights with one mistake that their projects do not know of; none: `mistake` is empty."""

    mistake: str
    fix_m: float  # standard deviation of the positions

    @property
    def name(self) -> str:
        """What stands in the table."""
        return f"{self.mistake or 'none'}, positions {self.fix_m:g} m"

    @property
    def sizes(self) -> tuple[float, ...]:
        """How many times the noticeable size; mistakes without a size are what they are."""
        return SIZES if self.mistake in STEPS else (1.0,)

    @property
    def plan(self) -> Plan:
        """Six landmarks in twenty frames of a camera that flies and swings."""
        sigma: Triple = (self.fix_m, self.fix_m, self.fix_m)
        return Plan(
            Errors(1.0, fix_m=(sigma,)), frames=20, landmarks=6, frame_hz=5.0, sigma_px=True,
            ahead=True, speed_m_s=10.0, pitch_deg=(-40.0, -25.0), jitter_deg=0.0, swing_deg=5.0,
            flights=300,
        )  # fmt: skip


class Named(NamedTuple):
    """Shares of flights, and of frames."""

    named: float  # a finding names the mistake
    told: float  # names it, or says that the flight misfits
    other: float  # names another one and not this
    flagged: float  # of frames with the flag `misfit` or `outlier`
    inside: float  # of yaw, pitch and roll inside their 95 % intervals


MISTAKE_ROWS = tuple(
    MistakeRow(mistake, fix_m) for mistake in ("", *MISTAKES) for fix_m in (0.02, 2.0)
)


def mistakes_named(row: MistakeRow, noticed: float, seed: int, flights: int) -> Named:
    """Solve flights with a mistake, and count what is said of it.

    Args:
        row: the mistake
        noticed: its size, in noticeable ones
        seed: of the random numbers
        flights: how many
    """
    rng = np.random.default_rng(seed)
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(flights):
            truth = write_flight(Path(folder), row.plan, rng, row.mistake, noticed)
            found.append(_said(Path(folder) / "flight.toml", truth.angles_deg, row.mistake))
    return Named(*np.mean(found, axis=0))


def _said(project: Path, angles_deg: np.ndarray, mistake: str) -> tuple[float, ...]:
    result = vopd.solve_flight(project)
    outside = picks_outside(result.read)  # which names the landmark of the first
    texts = [str(one) for one in result.findings if one not in outside]
    named = bool(mistake) and any(re.search(NAMES[mistake], text) for text in texts)
    misfit = any(MISFIT in text for text in texts)
    other = any(
        re.search(words, text) for text in texts for name, words in NAMES.items() if name != mistake
    )
    stated = table([result.history()])
    flagged = [bool(re.search("misfit|outlier", flags)) for flags in stated["flags"].tolist()]
    inside = []
    for k, angle in enumerate(("vehicle_yaw", "vehicle_pitch", "vehicle_roll")):
        off = (stated[f"{angle}_deg"] - angles_deg[:, 3 + k] + 180.0) % 360.0 - 180.0
        inside.append(np.abs(off) <= stated[f"half_width_95_{angle}_deg"])
    return (
        float(named), float(named or misfit), float(other and not named),
        float(np.mean(flagged)), float(np.mean(inside)),
    )  # fmt: skip
