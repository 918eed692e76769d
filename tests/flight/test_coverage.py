"""The truth of flights lies inside the stated intervals as often as they say.

A quick version of `python -m tools.coverage`: every cell must allow a share that the full table
asks for, 93 to 97 of 100 inside the 95 % interval, and inside one standard deviation as many as
Student's t has. The limits are those of 999 of 1,000 counts. Files and truth are made by
`tests.kit.simulated_flights`, apart from the package.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import vopd
from tests.kit.coverage import ATTACK, VEHICLE, Share, share
from tests.kit.flight_coverage import FLIGHT_ROWS, flight_counted
from tests.kit.simulated_flights import Errors, Plan, write_flight
from tests.tolerances import within

CONFIDENCE = 0.999
ROW = {row.name: row for row in FLIGHT_ROWS}

CELLS = [
    ("picks .8 px, poor geometry", 4, 8),
    ("all together", 4, 30),
    ("all together, sigma_px stated", 3, 30),
    ("consumer GPS 2, 2, 4 m", 3, 20),  # positions that do not weigh, or a sigma of one axis
    ("consumer GPS, sigma_px not stated", 6, 12),  # positions in the reading sigma
    ("consumer GPS, fisheye", 4, 20),
    ("consumer GPS, one frame", 4, 40),
    ("1-Hz track of 2, 2, 4 m, 30 frames a second", 3, 20),  # each frame a position of its own
    ("1-Hz track of .5, .5, 1 m with a bias of 2, 2, 4 m", 4, 15),  # a bias that averages out
    ("RTK by column", 4, 25),  # one sigma for all rows
    ("landmarks by column, each frame its own", 3, 25),
    ("camera that stands .3 m, landmarks .1 m", 3, 25),  # a place for each frame
    ("refraction of a telephoto lens, 20 to 40 km", 3, 40),
]
EXACT = Errors(pick_px=1e-6)


def allows(found: Share, low: float, high: float) -> None:
    assert found.low <= high and found.high >= low, found


@pytest.mark.parametrize(("name", "landmarks", "flights"), CELLS)
def test_the_truth_is_inside_as_often_as_stated(name: str, landmarks: int, flights: int) -> None:
    row = ROW[name]
    for found in flight_counted(row, landmarks, 7, flights):
        for inside in (
            found.inside_95[..., VEHICLE], found.inside_95[..., ATTACK], found.attitude_95,
            found.mean_95, found.place_95 if row.plan.sigma_px else np.full((1, 1, 1), np.nan),
        ):  # fmt: skip
            allows(share(inside, CONFIDENCE), row.low, row.high)
        if row.high < 1.0:
            allows(found.beyond_68(VEHICLE, CONFIDENCE), -0.013, 0.017)


@pytest.mark.parametrize(
    "plan",
    [
        Plan(EXACT, distortion=(-0.1, 0.02), landmarks=6),
        Plan(EXACT, fisheye=True, focal_px=700.0, distortion=(0.05, -0.01)),
        Plan(EXACT, stands=True),
        Plan(EXACT, fix_hz=1.0, frame_hz=30.0, frames=90),
    ],
)  # fmt: skip
def test_flights_without_errors_are_solved_to_the_truth(plan: Plan, tmp_path: Path) -> None:
    truth = write_flight(tmp_path, plan, np.random.default_rng(4))
    found = vopd.solve_flight(tmp_path / "flight.toml").vehicle_deg
    apart = np.abs((found - truth.angles_deg[:, VEHICLE] + 180.0) % 360.0 - 180.0)
    assert apart.max() < within("simulated flight")


def test_refraction_is_that_of_an_integral_along_the_path(tmp_path: Path) -> None:
    plan = ROW["refraction of a telephoto lens, 20 to 40 km"].plan._replace(errors=EXACT)
    truth = write_flight(tmp_path, plan, np.random.default_rng(4))
    found = vopd.solve_flight(tmp_path / "flight.toml").vehicle_deg
    apart = np.abs((found - truth.angles_deg[:, VEHICLE] + 180.0) % 360.0 - 180.0)
    assert apart[:, :2].max() < within("refraction of 40 km")  # roll by landmarks 5 degrees apart
