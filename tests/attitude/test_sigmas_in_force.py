"""Standard deviations in force: what is given, else what the source states, each in its place."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.kit import estimates
from vopd.attitude.sigmas import Sigmas, SigmasInForce, in_force
from vopd.estimate import Estimate, StatedSigmas

STATED = StatedSigmas((1.0, 2.0, 3.0), (4.0, 5.0, 6.0), 7.0, 8.0, (9.0, 10.0))
NOTHING = {
    "reading": None,
    "centre": 0.0,
    "principal_point": [0.0, 0.0],
    "landmark": [0.0, 0.0, 0.0],
    "position": [0.0, 0.0, 0.0],
    "focal_length": 0.0,
    "time_s": 0.0,
    "velocity": 0.0,
    "wind": 0.0,
    "mount_deg": 0.0,
}
OF_STATED = NOTHING | {
    "principal_point": [9.0, 10.0],
    "landmark": [1.0, 2.0, 3.0],
    "position": [4.0, 5.0, 6.0],
    "focal_length": 7.0,
    "time_s": 8.0,
}
GIVEN = [
    ("reading", 0.5, 0.5),
    ("landmark", 20.0, [20.0, 20.0, 20.0]),
    ("position", 20.0, [20.0, 20.0, 20.0]),
    ("focal_length", 20.0, 20.0),
    ("time_s", 20.0, 20.0),
    ("velocity", 20.0, 20.0),
    ("wind", 20.0, 20.0),
    ("mount_deg", 20.0, 20.0),
]


def one(**changes: Any) -> Estimate:
    return replace(estimates.estimate(np.array([[140.0, -70.0, 60.0]])), **changes)


def values(force: SigmasInForce) -> dict[str, Any]:
    return {
        name: value.tolist() if isinstance(value, np.ndarray) else np.array(value).tolist()
        for name, value in force._asdict().items()
    }


def test_a_source_that_states_nothing_has_none() -> None:
    assert StatedSigmas() == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0, (0.0, 0.0))
    unstated = one(stated=StatedSigmas(), fiducial_sigma=np.nan)
    assert values(in_force(unstated, Sigmas())) == NOTHING


def test_what_is_stated_counts() -> None:
    stated = one(stated=STATED, fiducial_sigma=np.nan)
    assert values(in_force(stated, Sigmas())) == OF_STATED


@pytest.mark.parametrize(("name", "given", "expected"), GIVEN)
@pytest.mark.parametrize(("source", "before"), [(StatedSigmas(), NOTHING), (STATED, OF_STATED)])
def test_what_is_given_counts_before_what_is_stated_and_changes_nothing_else(
    source: StatedSigmas, before: dict[str, Any], name: str, given: float, expected: object
) -> None:
    found = in_force(one(stated=source, fiducial_sigma=np.nan), Sigmas(**{name: given}))
    assert values(found) == before | {name: expected}


def test_the_centre_is_the_mean_of_four_fiducials() -> None:
    film = one(stated=StatedSigmas(), fiducial_sigma=0.06)
    assert values(in_force(film, Sigmas())) == NOTHING | {"centre": 0.03}
    assert values(in_force(film, Sigmas(fiducial=0.1))) == NOTHING | {"centre": 0.05}
    assert values(in_force(film, Sigmas(fiducial=0.0))) == NOTHING
