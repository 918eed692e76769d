"""What is said of the Earth of 1974: the limit, the frame, the numbers and their decimals."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest

from tests.kit.jobs import film
from tests.kit.readings import reread
from tests.tolerances import within
from vopd import check as earth_rule
from vopd.cards.write import write_deck
from vopd.check import EarthCost, check_deck, earth_cost
from vopd.job import Job

NONE, INF = np.nan, np.inf
COSTS: dict[tuple[float, ...], tuple[int, str] | None] = {  # degrees by frame: frame and words
    (0.1, 0.0999, 0.0): None,
    (NONE, NONE, NONE): None,
    (INF, 0.05, NONE): None,
    (0.0, 0.1001, 0.05): (2, "0.10 degrees in frame 2: "),
    (0.2, 0.0, 0.3): (3, "0.30 degrees in 2 frames, most of all in frame 3: "),
    (0.456, 0.2, 0.3): (1, "0.46 degrees in 3 frames, most of all in frame 1: "),
    (INF, NONE, 0.2): (3, "0.20 degrees in frame 3: "),
    (1.234, INF, 0.2): (1, "1.23 degrees in 2 frames, most of all in frame 1: "),
}


@pytest.mark.parametrize("angles", COSTS)
def test_the_sentence(angles: tuple[float, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """The frame that costs most is named, with its own shift and distance, at its first card."""
    cost = EarthCost(
        np.array(angles), np.array([11.16, 22.26, 33.36]), np.array([1.114, 2.225, 3.336])
    )
    monkeypatch.setattr(earth_rule, "earth_cost", lambda _: cost)
    deck = write_deck([film_of_thousandths(3)])
    found = check_deck(io.BytesIO(deck.encode()), "a.dat")
    told = [one for one in found if "Earth of 1974" in one.message]
    expected = COSTS[angles]
    if expected is None:
        assert told == []
        return
    frame, words = expected
    shift, km = [("11.2", "1.11"), ("22.3", "2.23"), ("33.4", "3.34")][frame - 1]
    (one,) = told
    assert one.message == (
        f"the spherical Earth of 1974 turns the attitude by {words}it displaces the landmarks by "
        f"{shift} m against the camera, {km} km away; run the deck with --fix earth"
    )
    first = len(deck.splitlines()) - 3 * 27 + 1
    assert (one.card, one.group, one.severity) == (first + 27 * (frame - 1), 0, "warning")
    assert one.columns is None


def film_of_thousandths(frames: int) -> Job:
    """A film of five landmarks, 27 cards a frame, as cards can hold it."""
    job = film(frames)
    readings, camera = job.readings, job.camera
    tables = {
        name: getattr(camera, name).round(4) for name in ("lens_radius_mm", "lens_distortion_um")
    }
    points = {name: getattr(readings, name).round(3) for name in ("landmark_in", "fiducial_in")}
    return replace(job, readings=reread(readings, **points), camera=replace(camera, **tables))


@pytest.mark.parametrize("out", range(5))
def test_only_landmarks_that_take_part_count(out: int) -> None:
    """An ignored landmark may be anywhere; the averages are over the four others."""
    job = film(2)
    asked = np.zeros(5, np.int64)
    asked[0] = 11 + out
    fewer = replace(job, ignored=replace(job.ignored, everywhere=asked))
    marks = replace(job.landmarks, altitude_ft=job.landmarks.altitude_ft.copy())
    marks.altitude_ft[out] += 50000.0
    moved = earth_cost(replace(fewer, landmarks=marks))
    for one, other in zip(earth_cost(fewer), moved, strict=True):
        np.testing.assert_array_equal(one, other)
    km = np.array([np.linalg.norm(at - path) for at in ground_km(job) for path in path_km(job)])
    distances = km.reshape(5, 2)[np.arange(5) != out].mean(axis=0)
    assert np.abs(moved.distance_km / distances - 1.0).max() < within("share of the Earth's cost")


def ground_km(job: Job) -> np.ndarray:
    """Landmarks on a plane at the origin, km east, north, up."""
    m = job.landmarks
    path = job.trajectory
    east = m.longitude_deg + m.longitude_min / 60.0 - path.origin_longitude_deg
    north = m.latitude_deg + m.latitude_min / 60.0 - path.origin_latitude_deg
    across = 111.32 * np.cos(np.radians(path.origin_latitude_deg))
    return np.column_stack([across * east, 110.9 * north, m.altitude_ft * FOOT_KM])


FOOT_KM = 0.3048e-3


def path_km(job: Job) -> np.ndarray:
    return job.trajectory.position_ft[:2] * FOOT_KM
