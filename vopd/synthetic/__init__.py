"""Synthetic flights whose true attitude is known, as card decks: their parameters."""

from __future__ import annotations

from dataclasses import dataclass

from vopd.findings import VopdError

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
"""The smallest and the largest value of each parameter of a `Plan` that is a number."""

SPHERE_1974 = "1974"
EARTHS = (SPHERE_1974, "wgs84")
"""The Earth of the program of 1974, and the ellipsoid of its fix `earth`."""


class PlanError(VopdError):
    """A parameter of a `Plan` is outside its limits."""

    def __init__(self, part: str, problem: str) -> None:
        super().__init__(f"{part}: {problem}")
        self.part = part
        self.problem = problem


@dataclass(frozen=True)
class Plan:
    """The parameters of a synthetic flight.

    Each part of the flight has its own random numbers, so that other noise leaves
    the attitude and the landmarks as they are.

    Raises:
        PlanError: for a value outside its `LIMITS`.
    """

    frames: int = 24  # number of frames; beyond 9,999 the film is read again
    landmarks: int = 4  # landmarks in each frame
    seed: int = 0  # which flight
    noise_in: float = 0.003  # standard deviation of one reading on the film reader, in
    jobs: int = 1  # number of jobs that are stacked
    trajectory_rows: int = 50  # rows of the trajectory table
    # the most that yaw differs from its mean, degrees; pitch and roll differ less
    swing_deg: float = 20.0
    focal_length_mm: float = 10.4  # focal length, mm
    # size of a frame of the film on the film reader, x and y, in
    frame_in: tuple[float, float] = (14.47, 10.457)
    earth: str = SPHERE_1974  # on which the film was taken, one of `EARTHS`

    def __post_init__(self) -> None:
        for name, (low, high) in LIMITS.items():
            value = getattr(self, name)
            for number in value if isinstance(value, tuple) else (value,):
                if not low <= number <= high:  # nor for what is not a number
                    huge = isinstance(number, int) and abs(number) > 1e300  # for a float
                    said = f"{number:,}" if huge else f"{number:,.9g}"
                    raise PlanError(name, f"{said} is not within {low:,.9g} to {high:,.9g}")
        if self.earth not in EARTHS:
            raise PlanError("earth", f"{self.earth!r} is not one of {', '.join(EARTHS)}")
