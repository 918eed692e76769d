"""The numbers of a synthetic flight: its tables, their decimals and bounds, the plan's limits."""

from __future__ import annotations

from math import sin

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.synthetic import Plan, PlanError
from vopd.synthetic.flight import (
    RandomPart,
    clock,
    frame_numbers,
    make,
    position_ft,
    random_stream,
    trajectory,
    wind,
)

SEEDS = range(12)


def test_the_usual_plan() -> None:
    assert Plan() == Plan(
        frames=24, landmarks=4, seed=0, noise_in=0.003, jobs=1, trajectory_rows=50, swing_deg=20.0,
        focal_length_mm=10.4, frame_in=(14.47, 10.457),
    )  # fmt: skip


LIMITS = [
    ("frames", 1, 99_999, "1 to 99,999"), ("landmarks", 2, 99, "2 to 99"),
    ("seed", 0, 999_999_999, "0 to 999,999,999"), ("noise_in", 0.0, 1.0, "0 to 1"),
    ("jobs", 1, 999, "1 to 999"), ("trajectory_rows", 2, 9_999, "2 to 9,999"),
    ("swing_deg", 0.0, 45.0, "0 to 45"), ("focal_length_mm", 1.0, 1000.0, "1 to 1,000"),
    ("frame_in", 1.0, 100.0, "1 to 100"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "low", "high", "words"), LIMITS)
def test_the_limits_of_a_plan_from_both_sides(
    name: str, low: float, high: float, words: str
) -> None:
    step = 1 if isinstance(low, int) else 1e-6
    shown = {low - step: None, high + step: None, float("nan"): "nan"}
    for value in (low, high):
        Plan(**{name: (value, value) if name == "frame_in" else value})
    for wrong, text in shown.items():
        for given in [(2.0, wrong), (wrong, 2.0)] if name == "frame_in" else [wrong]:
            with pytest.raises(PlanError) as error:
                Plan(**{name: given})
            problem = f"{text or format(wrong, ',.9g')} is not within {words}"
            assert (error.value.part, error.value.problem) == (name, problem)
            assert str(error.value) == f"{name}: {problem}"


@pytest.mark.parametrize(
    ("frames", "last", "time"), [(1, 2, 40.0625), (24, 25, 40.78125), (9_999, 10_000, 352.5),
                                 (25_000, 10_000, 352.5)]
)  # fmt: skip
def test_the_clock_has_32_frames_a_second(frames: int, last: int, time: float) -> None:
    """Frame 0 is at 40 s; a row before the first frame and one after the last."""
    table = clock(Plan(frames=frames))
    assert (table.frame.tolist(), table.time_s.tolist()) == ([0, last], [40.0, time])
    numbers = frame_numbers(Plan(frames=frames))
    assert len(numbers) == frames and (numbers[0], numbers.max()) == (1, min(frames, 9_999))
    assert (np.diff(numbers[:9_999]) == 1).all()
    assert numbers[9_999:10_001].tolist() == ([1, 2] if frames > 9_999 else [])


@pytest.mark.parametrize("until", [41.0, 86.0, 88.0, 352.5])
@pytest.mark.parametrize("rows", [2, 7, 50])
def test_the_trajectory_reaches_a_second_beyond_the_film(until: float, rows: int) -> None:
    """From 39 s; to 88 s at least, which is 47 s of film and a second more; in equal steps."""
    path = trajectory(Plan(trajectory_rows=rows), until)
    time = path.time_s
    assert (len(time), time[0], time[-1]) == (rows, 39.0, max(until, 87.0) + 1.0)
    assert_close("difference of card times", np.diff(time), (time[-1] - 39.0) / (rows - 1))
    origin = path.origin_latitude_deg, path.origin_longitude_deg, path.origin_radius_kft
    assert origin == (33.083333, -106.3333, 20925.698)


def decimals(values: np.ndarray, places: int) -> bool:
    """Whether no value has more decimals, and some have that many."""
    fine, coarse = np.round(values, places), np.round(values, places - 1)
    return bool((values == fine).all() and (values != coarse).any())


def test_decimals_are_those_of_the_cards() -> None:
    path = trajectory(Plan(seed=5), 100.0)
    assert decimals(path.time_s, 4) and decimals(path.altitude_ft, 1)
    assert decimals(path.position_ft, 2) and decimals(path.velocity_ft_s, 3)
    (job,), _ = make(Plan(seed=5))
    assert decimals(job.camera.lens_radius_mm, 3) and decimals(job.camera.lens_distortion_um, 1)
    assert decimals(job.landmarks.longitude_min, 2) and decimals(job.landmarks.latitude_min, 2)
    for whole in (
        job.landmarks.longitude_deg,
        job.landmarks.latitude_deg,
        job.landmarks.altitude_ft,
        job.camera.initial_deg,
        job.wind.velocity_ft_s,
    ):
        assert (whole == np.round(whole)).all()  # fmt: skip
    assert decimals(job.readings.landmark_in, 3)
    minutes = np.concatenate([job.landmarks.longitude_min, job.landmarks.latitude_min])
    assert (job.landmarks.longitude_deg < 0).all() and (
        (minutes >= -60.0) & (minutes <= 60.0)
    ).all()
    assert (job.landmarks.longitude_min <= 0).all() and (job.landmarks.latitude_min >= 0).all()
    assert ((job.landmarks.altitude_ft >= 3500) & (job.landmarks.altitude_ft <= 6500)).all()
    for tables in (path.velocity_ft_s, job.wind.velocity_ft_s, job.readings.fiducial_in):
        assert not np.signbit(tables[tables == 0.0]).any()


def test_the_wind_is_from_the_east_and_stronger_with_height() -> None:
    """20 ft/s at 70,000 ft and 160 at 160,000, growing with the square; north and south 20."""
    norths = []
    for seed in SEEDS:
        table = wind(Plan(seed=seed))
        assert table.altitude_ft.tolist() == [70e3 + 10e3 * k for k in range(10)]
        north, east = table.velocity_ft_s.T
        expected = [-20.0 - 140.0 * (k / 9.0) ** 2 for k in range(10)]
        assert_close("wind in whole feet", east, expected)
        phase = random_stream(Plan(seed=seed), RandomPart.WIND).uniform(0.0, 6.0)
        waves = [20.0 * sin((70e3 + 10e3 * k) / 15e3 + phase) for k in range(10)]
        assert_close("wind in whole feet", north, waves)
        norths.append(north)
    assert len({tuple(one) for one in norths}) == len(norths)
    zeros = [wind(Plan(seed=seed)).velocity_ft_s for seed in range(200)]
    assert sum((one == 0.0).sum() for one in zeros) > 10
    assert not any(np.signbit(one[one == 0.0]).any() for one in zeros)


def test_the_path_of_a_parachute() -> None:
    """The top 5 to 15 s after the first frame, at 140 to 149 kft; then 170 to 205 ft/s down."""
    for seed in SEEDS:
        path = trajectory(Plan(seed=seed, trajectory_rows=2001), 352.0)
        east, north, up = path.position_ft.T
        top = int(up.argmax())
        assert 44.9 <= path.time_s[top] <= 55.1 and 139e3 <= up[top] <= 149e3
        to_north, to_east, down = path.velocity_ft_s.T
        assert 170.0 <= down[-1] <= 205.0 and -10.0 < down[top] < 10.0
        at = int(np.abs(path.time_s - 40.0).argmin())
        assert -20.5e3 < east[at] < 20.5e3 and -20.5e3 < north[at] < 20.5e3
        assert -910.0 < to_east[at] < -490.0 and -510.0 < to_north[at] < 510.0
        assert -40.0 <= to_east[-1] <= -20.0 and -15.0 <= to_north[-1] <= 15.0
        later = int(np.abs(path.time_s - 52.0).argmin())  # 12 s on, 1/e of what is above the wind
        left = (to_east[later] - to_east[-1]) / (to_east[at] - to_east[-1])
        assert 0.35 < left < 0.39
        # gravity near the top: v changes by 32 ft/s a second where tanh is straight
        near = slice(max(top - 6, 0), top + 7)
        slope = np.polyfit(path.time_s[near], down[near], 1)[0]
        assert 31.0 < slope < 33.0


def test_positions_between_the_rows_are_on_straight_lines() -> None:
    path = trajectory(Plan(trajectory_rows=3), 90.0)
    for share in (0.0, 0.25, 1.0):
        time = path.time_s[0] + share * (path.time_s[1] - path.time_s[0])
        expected = (1.0 - share) * path.position_ft[0] + share * path.position_ft[1]
        assert_close("demo position", position_ft(path, np.array([time]))[0], expected)
