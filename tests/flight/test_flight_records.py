"""What a flight's records hold where nothing is given, its landmarks' numbers, and its parts."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import MARK, three_frames, uneven_flight
from vopd.flight.flight import CameraPath, FlightOptions, LandmarkSet, Picks, Refraction
from vopd.flight.solve import FlightBlocks

NONE = np.zeros(0)


def test_what_is_usual() -> None:
    """Documented in docs/flight-project.md: least squares, blunders kept, k = .13 that decays."""
    assert FlightOptions() == FlightOptions("least-squares", False, 0.0, (0.0, 0.0))
    assert Refraction() == Refraction(0.13, True)
    picks = Picks(NONE, NONE, NONE, NONE)
    assert np.isnan(picks.repeatability_px)
    assert (picks.one_sigma_px, picks.least_sigma_px) == (1.0, 0.3)
    path = CameraPath(NONE, NONE)
    assert path.sigma_time_s == 0.0
    for name in ("velocity_m_s", "acceleration_m_s2", "wind_m_s", "lever_arm_m", "gimbal_deg"):
        assert getattr(path, name) is None
    flight = three_frames()
    assert flight.refraction == Refraction() and (flight.about, flight.findings) == ((), ())
    assert LandmarkSet((), NONE, NONE).used == ()


@pytest.mark.parametrize(
    ("names", "numbers"),
    [
        (("7", "3", "12"), [7, 3, 12]),
        (("007", "3"), [7, 3]),
        (("7", "07"), [1, 2]),
        (("7", "b"), [1, 2]),
        (("7", "-3"), [1, 2]),
        (("7", "²"), [1, 2]),
        (("7", "٣"), [1, 2]),
        (("7", ""), [1, 2]),
        (("9" * 17, "1"), [99999999999999999, 1]),
        (("9" * 18, "1"), [1, 2]),
    ],
)  # fmt: skip
def test_names_that_are_whole_numbers_are_numbers(names: Any, numbers: list[int]) -> None:
    assert LandmarkSet(names, NONE, NONE).number.tolist() == numbers


@pytest.mark.parametrize(
    ("angles", "first"),
    [([1.5, 2.5, 3.0], 1.5), ([np.nan, 2.5, 3.0], 2.5), ([np.nan] * 3, np.nan)],
)
def test_the_convergence_is_that_of_the_first_position(angles: Any, first: float) -> None:
    flight = three_frames()
    assert flight.grid is not None
    grid = flight.grid._replace(convergence_deg=np.array(angles))
    found = replace(flight, grid=grid).grid_convergence_deg
    assert found == first or np.isnan([found, first]).all()
    assert np.isnan(replace(flight, grid=None).grid_convergence_deg)


@pytest.mark.parametrize("order", [np.arange(12), np.arange(12)[::-1]])
def test_a_part_has_every_field_of_its_frames(order: Any) -> None:
    """Frames c and b of three, whose picks stand in the file in order or backward."""
    base = three_frames()
    picks = replace(
        base.picks,
        frame=base.picks.frame[order], landmark=base.picks.landmark[order],
        pixel=np.arange(24.0).reshape(12, 2)[order], sigma_px=np.arange(12.0)[order],
    )  # fmt: skip
    flight = replace(base, picks=picks)
    whole = FlightBlocks(flight)
    chosen, rows, part = whole.part(np.array([2, 1]))
    assert chosen.tolist() == [2, 1]
    pick = picks.sigma_px[rows].astype(int)  # its number in the order of frames
    assert sorted(pick[:4]) == [8, 9, 10, 11] and sorted(pick[4:]) == [4, 5, 6, 7]
    assert part.picks.sigma_px.tolist() == pick.tolist()
    assert part.picks.pixel.tolist() == [[2 * k, 2 * k + 1] for k in pick]
    assert part.picks.landmark.tolist() == [k % MARK for k in pick]
    assert part.picks.frame.tolist() == [0] * 4 + [1] * 4
    assert (part.picks.repeatability_px, part.picks.one_sigma_px) == (0.7, 2.0)
    assert part.frame.tolist() == [12, 9] and part.image_name == ("c.jpg", "b.jpg")
    assert part.time_s.tolist() == base.time_s[[2, 1]].tolist()
    assert part.grid is not None and part.grid.crs == "EPSG:32633"
    assert (part.grid.easting.tolist(), part.grid.northing.tolist()) == ([2, 1], [7, 6])
    assert len(part.grid.convergence_deg) == 2
    for name in ("position_m", "velocity_m_s", "acceleration_m_s2", "wind_m_s", "gimbal_deg"):
        ours, all_frames = getattr(part.path, name), getattr(base.path, name)
        assert np.array_equal(ours, all_frames[[2, 1]], equal_nan=True)
    assert np.array_equal(part.path.sigma_m, base.path.sigma_m, equal_nan=True)
    assert part.path.sigma_time_s == 0.01
    numbered = FlightBlocks(replace(flight, image_name=(), grid=None)).part(np.array([1])).flight
    assert numbered.image_name == () and numbered.grid is None
    every = whole.part(np.arange(3))
    assert every.flight is flight and every.picks.tolist() == list(range(12))


def test_blocks_have_all_chosen_frames_and_no_block_without_one() -> None:
    blocks = FlightBlocks(uneven_flight([4, 3, 5, 2, 1]))
    assert sorted(k for part in blocks for k in part.frames.tolist()) == [0, 1, 2, 3, 4]
    chosen = np.array([False, True, False, True, False])
    assert sorted(k for p in blocks.parts(chosen) for k in p.frames.tolist()) == [1, 3]
    assert [*blocks.parts(np.zeros(5, bool))] == []
