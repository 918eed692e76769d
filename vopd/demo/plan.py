"""What a synthetic flight is asked to be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LAST_FRAME = 9999  # four columns
FRAME_RATE = 32.0  # frames a second
FIRST_TIME_S = 40.0  # flight time of frame 0


@dataclass(frozen=True)
class Plan:
    """A synthetic flight: how much of it, and what differs from the usual camera.

    Frames are numbered from 1; a film of more than 9,999, which is what four
    columns hold, is read again from frame 1. Each part of the flight has its own
    stream of random numbers: another noise leaves attitude and landmarks alone.
    """

    frames: int = 24  # 1 to 99,999
    landmarks: int = 4  # in each frame, 2 to 99
    seed: int = 0
    noise_in: float = 0.003  # standard deviation of one reading, on the reader
    jobs: int = 1
    trajectory_rows: int = 50  # 2 to 9,999
    swing_deg: float = 20.0  # the largest yaw away from the first estimate
    focal_length_mm: float = 10.4
    frame_in: tuple[float, float] = (14.47, 10.457)  # the film's frame on the reader, x y

    def random(self, part: int) -> np.random.Generator:
        """The stream of random numbers of one part of the scene."""
        return np.random.default_rng([self.seed, part])

    def numbers(self) -> np.ndarray:
        """The frame numbers in the order of reading (F,)."""
        return 1 + np.arange(self.frames, dtype=np.int64) % LAST_FRAME


# The parts of a scene
PATH, ATTITUDE, GROUND, FILM = range(4)
