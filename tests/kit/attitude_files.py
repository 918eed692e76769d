"""Decks and what their listings print, for the tests that read attitude files back."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tests.kit.command import DECKS, ROOT, vopd

CASES = ("case1", "case2", "case3", "case4")
NAMES = (*CASES, "flight")
CASES_123 = DECKS / "appendix_h" / "cases_1_2_3.dat"
EPOCH = "1974-08-27T17:30:00Z"
PRINTED = (
    *("time_s", "camera_yaw_deg", "camera_pitch_deg", "camera_roll_deg", "xp", "yp"),
    *("vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg"),
    *("alpha_deg", "beta_deg", "eta_deg"),
)
ANGLES = [name for name in PRINTED if name.endswith("_deg")]
VEHICLE = ["vehicle_yaw_deg", "vehicle_pitch_deg", "vehicle_roll_deg"]

Row = dict[str, float]
Array = NDArray[np.float64]


@cache
def deck_text(name: str) -> str:
    """A sample case of Appendix H, or a synthetic flight of 40 frames."""
    if name in CASES:
        return (DECKS / "appendix_h" / f"{name}.dat").read_text()
    return vopd("demo", "--frames", "40", "--landmarks", "5", "--seed", "3").stdout


@cache
def printed(name: str) -> list[Row]:
    """What the listing has of every frame: group 6, and the vehicle's X, Y, Z.

    The cases' listings are those that the report shows; the flight's is made.
    """
    if name in CASES:
        listing = (ROOT / "golden_outputs" / "appendix_h" / f"{name}.lst").read_text()
    else:
        listing = vopd("run", "-", stdin=deck_text(name)).stdout
    lines = listing.splitlines()
    rows = []
    for k, line in enumerate(lines):
        if line.startswith("0VEHICLE"):
            feet = [float(part) for part in re.findall(r"-?\d*\.\d\d", lines[k + 1])[:3]]
        elif line.startswith("0 FRAME"):
            numbers = re.findall(r"-?\d*\.\d{3}", lines[k + 1])
            row = dict(zip(PRINTED, map(float, numbers), strict=True))
            place = dict(zip(("east", "north", "up"), feet, strict=True))
            rows.append(row | place | {"frame": int(lines[k + 1].split()[0])})
    assert len(rows) == {"flight": 40, "case4": 2}.get(name, 1)
    return rows


def write(folder: Path, name: str, file: str, *options: str) -> Path:
    """The attitude file of that deck."""
    deck = folder / f"{name}.dat"
    deck.write_text(deck_text(name))
    done = vopd("attitude", deck, "-o", folder / file, *options)
    assert done.status == 0, done.stderr
    return folder / file


def column(rows: Sequence[Row], names: Sequence[str]) -> Array:
    return np.array([[row[name] for name in names] for row in rows], dtype=np.float64)


def apart_deg(one: ArrayLike, other: ArrayLike) -> Array:
    """The difference of angles the short way around."""
    return (np.asarray(one) - np.asarray(other) + 180.0) % 360.0 - 180.0


def body_axes(angles_deg: Array) -> Array:
    """Forward, right, down axis as rows (F, 3, 3) in north, east, down; the textbook's matrix."""
    (sy, sp, sr), (cy, cp, cr) = np.sin(np.radians(angles_deg.T)), np.cos(np.radians(angles_deg.T))
    forward = [cp * cy, cp * sy, -sp]
    right = [sr * sp * cy - cr * sy, sr * sp * sy + cr * cy, sr * cp]
    down = [cr * sp * cy + sr * sy, cr * sp * sy - sr * cy, cr * cp]
    return np.moveaxis(np.array([forward, right, down]), -1, 0)
