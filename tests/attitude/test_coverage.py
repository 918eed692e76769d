"""The truth lies inside the stated intervals as often as they say, by simulated films.

A quick version of `tools/coverage.py`: every cell must allow a share that the full table asks
for, 93 to 97 of 100 inside the 95 % interval and 67 to 70 inside one standard deviation.
The limits are those of 999 of 1,000 counts, so that a count of 400 frames still tells 95 from
90. Films and truth are made by `tests.kit.simulated_films`, apart from the package.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.kit.coverage_cells import ROWS, counted
from tests.kit.coverage_count import ATTACK, ETA, VEHICLE, Share, share, solved
from tests.kit.film_decks import deck_of, jobs_of
from tests.kit.film_earths import SPHERE_1974, WGS84, Earth
from tests.kit.flag_rates import TRIALS, Rates, rates
from tests.kit.flight_coverage import FLIGHT_ROWS, flight_counted
from tests.kit.simulated_films import Errors, Plan, simulate
from tests.tolerances import assert_close, within
from vopd.cards.reader import read_deck

CONFIDENCE = 0.999
ROW = {row.name: row for row in (*ROWS, *FLIGHT_ROWS)}
TRIAL = {trial.name: trial for trial in TRIALS}

CELLS = [
    ("readings", 4, 10),
    ("readings, poor geometry", 3, 20),
    ("identification .05 mm, one frame a job", 2, 50),
    ("readings, camera pitch within 2 degrees of -90", 2, 8),
    ("readings, yaw and roll across 0", 3, 8),
    ("readings, faithful run, truth on the sphere of 1974", 6, 8),
    ("identification .05 mm", 2, 10),
    ("identification .05 mm, sigma given", 3, 8),
    ("fiducials three times noisier", 12, 8),
    ("velocity 10 ft/s", 3, 8),
    ("landmarks 100 ft", 12, 24),
    ("all together, through cards", 3, 24),
    ("all together, reading sigma given", 4, 24),
]


def allows(found: Share, low: float, high: float) -> None:
    assert found.low <= high and found.high >= low, found


@pytest.mark.parametrize(("name", "landmarks", "jobs"), CELLS)
def test_the_truth_is_inside_as_often_as_stated(name: str, landmarks: int, jobs: int) -> None:
    found = counted(ROW[name], landmarks, 7, jobs)
    assert not found.lost
    for angles in (VEHICLE, ATTACK, ETA):
        allows(found.share_95(angles, CONFIDENCE), 0.93, 0.97)
    for angles in (VEHICLE, ATTACK):
        allows(found.share_68(angles, CONFIDENCE), 0.67, 0.70)


@pytest.mark.parametrize(
    ("name", "landmarks"),
    [("flight, picks .8 px", 2), ("flight, picks 4 px", 3), ("flight, all together", 4)],
)
def test_of_flights_too(name: str, landmarks: int) -> None:
    found = flight_counted(ROW[name], landmarks, 8, 12)
    allows(found.share_95(VEHICLE, CONFIDENCE), 0.93, 0.97)
    allows(found.share_68(VEHICLE, CONFIDENCE), 0.67, 0.70)


def flagged(name: str, landmarks: int, jobs: int = 10) -> Rates:
    return rates(TRIAL[name], landmarks, 9, jobs)


@pytest.mark.parametrize("landmarks", [2, 3, 6])
def test_films_without_a_fault_are_hardly_ever_flagged(landmarks: int) -> None:
    """A test at .001: of 400 frames 4 are more than one in a thousand counts has."""
    found = flagged("nothing", landmarks)
    for flag in ("not_converged", "out_of_range", "behind_camera", "jump"):
        assert found.flag[flag] == 0.0
    for flag in ("outlier", "misfit"):
        assert found.flag[flag] * found.frames <= 4


def test_a_misread_landmark_is_noticed() -> None:
    """By 1 mm, 200 times the noise: of three a misfit, of six an outlier."""
    assert flagged("a landmark misread by 1 mm", 3).flag["misfit"] > 0.95
    assert flagged("a landmark misread by 1 mm", 6).flag["outlier"] > 0.99


def test_exchanged_labels_are_noticed() -> None:
    assert flagged("two labels exchanged", 3).flag["misfit"] > 0.95


def test_a_wrong_solution_is_behind_the_camera() -> None:
    assert flagged("start at the other solution", 2, 4).flag["behind_camera"] > 0.99
    found = flagged("start anywhere, and the solve ends elsewhere", 4, 4)
    assert found.frames > 50 and found.none == 0.0


def test_a_jump_is_noticed() -> None:
    assert flagged("pitch jumps by 5 degrees", 4, 20).flag["jump"] > 0.99


@pytest.mark.parametrize(("earth", "names"), [(WGS84, ("all",)), (SPHERE_1974, ())])
def test_films_without_errors_are_solved_to_the_truth(earth: Earth, names: tuple[str, ...]) -> None:
    films = simulate(Plan(Errors(), jobs=3, frames=5, earth=earth, decimals=None), 4)
    found = np.stack([h.estimate.vehicle_deg for h in solved(films, names)])
    apart = np.abs((found - films.truth_deg[..., VEHICLE] + 180.0) % 360.0 - 180.0)
    assert apart.max() < within("simulated film")


def test_cards_and_arrays_hold_the_same_numbers(tmp_path: Path) -> None:
    films = simulate(ROW["all together"].plan._replace(jobs=3, landmarks=12), 5)
    path = tmp_path / "films.dat"
    path.write_text(deck_of(films), encoding="ascii")
    assert list(read_deck(path)) == jobs_of(films)


def test_the_limits_of_a_share_by_hand() -> None:
    """Wilson's, for 90 of 100; frames that hang together wholly count as one a job."""
    alone = np.array([1.0] * 90 + [0.0] * 10).reshape(100, 1, 1)
    found = share(alone)
    assert found.share == 0.9
    assert_close("limit of a share", [found.low, found.high], [0.8256, 0.9448])
    together = share(np.repeat(alone, 9, axis=1))
    assert 80 < together.effective < 120 and together.share == 0.9
