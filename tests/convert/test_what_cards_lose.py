"""Every sentence about what cards do not hold of a flight, and no other."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import numpy as np
import pytest

from tests.kit.flight_project import three_frames
from vopd.convert.flight_to_deck import _lost
from vopd.flight.flight import Flight, Refraction
from vopd.geometry.rotations import DOWN, mount_by_angles

HELD = np.arange(12) >= 4
ALWAYS = "altitudes are above the ellipsoid: run the deck with --fix all"
PLAIN = "1 of 3 frames have no attitude and are left out"
SIGMAS = (
    "standard deviations of landmarks, positions and time are not on the cards: give "
    "--landmark-sigma, --position-sigma, --time-sigma"
)


def plain() -> Flight:
    """Of which the cards lose nothing but the first frame."""
    base = three_frames()
    return replace(
        base,
        epoch=None,
        refraction=Refraction(0.0),
        picks=replace(base.picks, sigma_px=np.ones(12)),
        landmarks=replace(base.landmarks, sigma_m=np.full((4, 3), np.nan)),
        path=replace(base.path, sigma_m=np.zeros(3), sigma_time_s=0.0),
    )


def path(**new: Any) -> dict[str, Any]:
    return {"path": replace(plain().path, **new)}


SAID: tuple[tuple[dict[str, Any], str], ...] = (
    ({}, ""),
    ({"epoch": datetime(2026, 5, 1, tzinfo=UTC)},
     "the date of time zero is not on the cards: give --epoch"),
    ({"refraction": Refraction(0.1, False)},
     "refraction is taken off the picks by the flight's own attitude"),
    (path(lever_arm_m=np.array([0.0, 0.0, 0.1])),
     "the lever arm is applied: the cards have the camera's positions"),
    (path(lever_arm_m=np.zeros(3)), ""),
    ({"picks": replace(plain().picks, sigma_px=np.where(np.arange(12) == 5, 1.01, 1.0))},
     "picks of different standard deviations count alike on the cards"),
    ({"picks": replace(plain().picks, sigma_px=np.where(np.arange(12) == 1, 1.5, 1.0))}, ""),
    ({"options": replace(plain().options, loss="huber")}, "the loss huber is not on the cards"),
    ({"options": replace(plain().options, loss="cauchy")}, "the loss cauchy is not on the cards"),
    ({"mount": DOWN}, "the camera's mount is not on the cards: their vehicle is the camera"),
    ({"mount": mount_by_angles([0, 0, 9])}, ""),
    (path(velocity_m_s=None),
     "the velocity is not known: alpha, beta and eta of the cards mean nothing"),
    ({"landmarks": replace(plain().landmarks, sigma_m=np.full((4, 3), 0.01))}, SIGMAS),
    (path(sigma_m=np.array([np.nan, 0.0, 0.5])), SIGMAS),
    (path(sigma_time_s=0.01), SIGMAS),
)  # fmt: skip


@pytest.mark.parametrize("k", range(len(SAID)))
def test_what_cards_lose(k: int) -> None:
    changes, said = SAID[k]
    flight = replace(plain(), **changes)
    given: Any = type("Result", (), {"solved": np.array([False, True, True])})
    held = np.ones(12, bool) if "picks" not in changes else HELD
    expected = [PLAIN, *(["4 picks take no part and are left out"] if not held.all() else [])]
    assert _lost(flight, given, held) == [*expected, *[said] * bool(said), ALWAYS]


def test_nothing_is_lost_of_frames_that_all_have_an_attitude() -> None:
    given: Any = type("Result", (), {"solved": np.ones(3, bool)})
    assert _lost(plain(), given, np.ones(12, bool)) == [ALWAYS]
    assert _lost(plain(), given, np.zeros(12, bool)) == [
        "12 picks take no part and are left out", ALWAYS
    ]  # fmt: skip
