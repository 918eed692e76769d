"""What a synthetic flight is asked to be."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

from vopd.findings import VopdError

if TYPE_CHECKING:
    from numpy.random import Generator

LIMITS: dict[str, tuple[float, float]] = {
    "frames": (1, 99_999),  # group 5 counts them in five columns
    "landmarks": (2, 99),  # their numbers have two columns
    "seed": (0, 999_999_999),
    "noise_in": (0.0, 1.0),
    "jobs": (1, 999),
    "trajectory_rows": (2, 9_999),
    "swing_deg": (0.0, 45.0),
    "focal_length_mm": (1.0, 1000.0),
    "frame_in": (1.0, 100.0),
}
"""The least and the largest value of each part of a `Plan`."""


class PlanError(VopdError):
    """A part of a `Plan` that is outside its limits."""

    def __init__(self, part: str, trouble: str) -> None:
        super().__init__(f"{part}: {trouble}")
        self.part = part
        self.trouble = trouble


@dataclass(frozen=True)
class Plan:
    """A synthetic flight: how much of it, and what differs from the usual camera.

    Each part of the flight has its own stream of random numbers, so another noise
    leaves the attitude and the landmarks as they are. Raises `PlanError` for a
    value outside its `LIMITS`.
    """

    frames: int = 24
    landmarks: int = 4  # in each frame
    seed: int = 0
    noise_in: float = 0.003  # standard deviation of one reading, on the reader
    jobs: int = 1
    trajectory_rows: int = 50
    swing_deg: float = 20.0  # the most that yaw goes away from its mean
    focal_length_mm: float = 10.4
    frame_in: tuple[float, float] = (14.47, 10.457)  # a frame of the film on the reader, x y

    def __post_init__(self) -> None:
        for name, (low, high) in LIMITS.items():
            value = getattr(self, name)
            for number in value if isinstance(value, tuple) else (value,):
                if not low <= number <= high:  # nor for what is not a number
                    raise PlanError(name, f"{number:,.9g} is not within {low:,.9g} to {high:,.9g}")


class Part(IntEnum):
    """The parts of a scene that are random, each by itself."""

    PATH = 0
    WIND = 1
    ATTITUDE = 2
    GROUND = 3
    FILM = 4


def stream(plan: Plan, part: Part, which: int = 0) -> Generator:
    """The random numbers of one part of the scene; the film has a stream a reading."""
    import numpy as np

    return np.random.default_rng([plan.seed, part, which])
