"""The rotations of random flights against scipy's least squares, a frame at a time.

    python -m tools.flight_agreement [FRAMES]

Lenses of every kind, any latitude, ranges from 20 m to 40 km, any attitude, every
fourth straight up and every fourth straight down. The picks have errors of .0001 pixel:
with larger ones scipy's sum of squares no longer shows a turn of 1e-9 degree.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from tests.kit.random_flights import Sightings, lenses, random_frame
from vopd.flight.solve.rotations import solve_rotations
from vopd.geometry.lenses import project

LOOKS = ("", "", "up", "down")
NOISE_PX = 1e-4


def by_scipy(frame: Sightings) -> np.ndarray:
    """The rotation that makes the residuals least, from the true one on."""

    def residuals(vector: np.ndarray) -> np.ndarray:
        turned = Rotation.from_rotvec(vector).as_matrix() @ frame.rotation
        return (frame.pixel - project(frame.lens, frame.direction @ turned.T).pixel).ravel()

    best = least_squares(
        residuals, np.zeros(3), jac="3-point", xtol=3e-16, ftol=None, gtol=None, x_scale=1e-4
    )
    return np.asarray(Rotation.from_rotvec(best.x).as_matrix() @ frame.rotation)


def main() -> None:
    """Print the largest difference for each lens, and how long both took."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    rng = np.random.default_rng(1)
    for name, lens in lenses().items():
        frames = [
            random_frame(rng, lens, int(rng.integers(2, 9)), NOISE_PX, LOOKS[k % 4])
            for k in range(count)
        ]
        index = np.concatenate([np.full(len(f.pixel), k) for k, f in enumerate(frames)])
        pixel = np.concatenate([f.pixel for f in frames])
        direction = np.concatenate([f.direction for f in frames])
        every = np.ones(len(pixel), bool)
        start = time.process_time()
        found = solve_rotations(lens, count, index, pixel, np.ones(len(pixel)), direction, every)
        middle = time.process_time()
        other = np.array([by_scipy(frame) for frame in frames])
        end = time.process_time()
        apart = Rotation.from_matrix(found.rotation @ other.swapaxes(1, 2)).magnitude()
        print(
            f"{name:8} {count} frames, largest difference {np.degrees(apart).max():.1e} degree; "
            f"{middle - start:.3f} s, scipy {end - middle:.1f} s"
        )


if __name__ == "__main__":
    main()
