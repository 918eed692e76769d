"""The example that is shipped is the one that the tests know the truth of."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.kit.flight_project import truth_deg, write_project
from vopd.flight.solve_project import solve_flight

HILL = Path(__file__).parents[2] / "examples" / "hill"


def test_the_example_is_near_the_truth_that_its_page_states() -> None:
    angles = solve_flight(str(HILL / "flight.toml")).estimate.camera_deg
    assert np.abs(angles - truth_deg() % 360.0 + [0.0, 360.0, 0.0]).max() < 0.1


def test_the_example_is_the_project_of_the_tests(tmp_path: Path) -> None:
    """All but the last digits, which another machine may round otherwise."""
    write_project(tmp_path, noise_px=0.3)
    assert (tmp_path / "flight.toml").read_text() == (HILL / "flight.toml").read_text()
    for name in ("picks.csv", "landmarks.csv", "track.csv"):
        made, shipped = ((folder / name).read_text().split() for folder in (tmp_path, HILL))
        assert len(made) == len(shipped)
        for one, other in zip(made[1:], shipped[1:], strict=True):
            for a, b in zip(one.split(","), other.split(","), strict=True):
                assert a == b or abs(float(a) - float(b)) < 1e-6
