"""The least reading sigma, which jobs are joined, parts of a covariance, and decimals of tables."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit.estimates import ABOUT, POINTS, estimate
from tests.tolerances import assert_close
from vopd.attitude.conventions import conventions
from vopd.attitude.history import History, history, taken_together
from vopd.attitude.reading_sigma import least_sigmas
from vopd.attitude.table import FIXED, INTERVALS
from vopd.estimate import Estimate, StatedSigmas, Units

ANGLES = np.tile([140.0, -60.0, 20.0], (2, 1))


@pytest.mark.parametrize(
    ("spread", "floor", "least", "repeated"),
    [
        (0.3, 0.1, 0.3, True), (0.1, 0.3, 0.3, False), (0.2, 0.2, 0.2, False),
        (0.2000001, 0.2, 0.2000001, True), (np.nan, 0.2, 0.2, False), (0.2, np.nan, 0.2, True),
        (np.nan, np.nan, 1.04e-8, False), (0.0, 0.0, 1.04e-8, False), (2e-8, 0.0, 2e-8, True),
        (0.0, 2e-8, 2e-8, False), (1e-9, 0.0, 1.04e-8, True),
    ],
)  # fmt: skip
def test_the_least_reading_sigma(spread: float, floor: float, least: float, repeated: bool) -> None:
    """The larger of spread and resolution, and at least 1e-9 of the focal length, 10.4; where
    both are alike it is by resolution.
    """
    other = estimate(ANGLES, reading_spread=5.0, reading_floor=6.0)
    one = estimate(ANGLES, reading_spread=spread, reading_floor=floor)
    sigma, by_repeated = least_sigmas([other, one])
    assert_close("ratio", sigma / [6.0, least], [1.0, 1.0])
    assert by_repeated.tolist() == [False, repeated]


def job(**changes: Any) -> Estimate:
    """A job without names, as decks have it."""
    return estimate(ANGLES, landmark_names={}, frame_names=(), **changes)


@pytest.mark.parametrize(
    ("changes", "alike"),
    [
        ({}, True), ({"fiducial_sigma": 0.2}, True), ({"reading_spread": 9.0}, True),
        ({"image": POINTS[:3]}, False), ({"focal_length": 10.5}, False),
        ({"units": Units("ft", "in", 25.4, "mm", 1.0)}, False),
        ({"about": ABOUT._replace(words=replace(ABOUT.words, reading="a point"))}, False),
        ({"about": ABOUT._replace(source="other.toml", job=2)}, True),
        ({"stated": StatedSigmas(focal_length=0.1)}, False),
        ({"stated": StatedSigmas(position=(0.0, 0.0, 1.0))}, False),
        ({"fiducial_sigma": 0.0}, False), ({"slip_effect_deg": np.zeros((2, 9))}, False),
        ({"landmark_names": {7: "church"}}, False), ({"frame_names": ("a", "b")}, False),
        ({"gimbal_deg": np.zeros((2, 3))}, False), ({"grid": "centre"}, False),
    ],
)  # fmt: skip
def test_jobs_that_are_joined_are_of_one_kind(changes: dict[str, Any], alike: bool) -> None:
    """What a whole job has one of, and what is asked of the first of several, is the same."""
    usual = {"landmark_names": {}, "frame_names": (), "fiducial_sigma": 0.1}
    pair = [job(fiducial_sigma=0.1), estimate(ANGLES, **(usual | changes))]
    assert sorted(taken_together(pair)) == ([[0, 1]] if alike else [[0], [1]])


@pytest.mark.parametrize(
    ("name", "value"), [("vertical", "geocentric"), ("to_own_m", np.zeros((2, 2)))]
)
def test_jobs_with_other_positions_are_not_joined(name: str, value: Any) -> None:
    one = job()
    other = replace(one, position=replace(one.position, **{name: value}))
    assert sorted(taken_together([one, other])) == [[0], [1]]


def made(**changes: Any) -> History:
    return history(estimate(ANGLES, **changes))


def test_the_independent_part_of_a_covariance() -> None:
    """The whole less the common part; infinite where the whole is, whatever the common part."""
    whole = np.full((2, 3, 3), 5.0)
    common = np.full((2, 3, 3), 2.0)
    whole[0, 0, 0] = common[0, 0, 0] = np.inf
    whole[0, 1, 2], common[0, 2, 1] = -np.inf, -1.0
    uncertainty = replace(made().uncertainty, covariance_deg2=whole, covariance_common_deg2=common)
    expected = np.full((2, 3, 3), 3.0)
    expected[0, 0, 0], expected[0, 1, 2], expected[0, 2, 1] = np.inf, -np.inf, 6.0
    assert uncertainty.covariance_independent_deg2.tolist() == expected.tolist()


@pytest.mark.parametrize(
    ("sources", "said"),
    [
        (["a.toml"], "a.toml"), (["b.toml", "a.toml"], "b.toml, a.toml"),
        (["b", "a", "b", "c", "a"], "b, a, c"),
    ],
)  # fmt: skip
def test_every_source_of_a_file_is_named_once(sources: list[str], said: str) -> None:
    several = [made(about=ABOUT._replace(source=one)) for one in sources]
    assert conventions(several)["flight"] == said


def test_decimals_of_every_column() -> None:
    """Degrees have 6 decimals but of positions, 8; lengths 4; no decimals are words, counts or
    numbers with an exponent.
    """
    known = [*FIXED, *INTERVALS]
    by_decimals = {
        None: ["{source}", "job", "frame", "status", "landmarks", "last_correction_rad", "flags"],
        1: ["degrees_of_freedom"],
        4: [
            "airspeed_{length}_s", "vehicle_east_{length}", "vehicle_north_{length}",
            "vehicle_up_{length}", "altitude_{length}", "condition",
        ],
        8: ["latitude_deg", "longitude_deg", "residual_rms_{image}", "reading_sigma_{image}"],
        10: [f"quaternion_{one}" for one in "wxyz"],
    }  # fmt: skip
    listed = [name for names in by_decimals.values() for name in names]
    by_decimals[6] = [one.name for one in known if one.name not in listed]
    for decimals, names in by_decimals.items():
        assert [one.name for one in known if one.decimals == decimals] == names
    assert len(by_decimals[6]) == 1 + 9 + 1 + 10
    sixes = {one.unit for one in known if one.decimals == 6 and one.name != "misfit_chance"}
    assert sixes == {"s", "deg"}
