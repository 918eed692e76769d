"""The truth lies inside the stated intervals as often as they say, by simulated films.

A quick version of `tools/coverage.py`: every cell must allow a share that the full table asks
for, 93 to 97 of 100 inside the 95 % interval and 67 to 70 inside one standard deviation, or by so
much fewer as Student's t has for few degrees of freedom.
The limits are those of 999 of 1,000 counts. Films and truth are made by
`tests.kit.simulated_films`, apart from the package. Each cell stands for a mistake that it
would notice; the mistakes were made one by one to see that.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tests.kit.coverage import (
    ATTACK,
    ETA,
    ROWS,
    VEHICLE,
    Share,
    counted,
    share,
    sigmas_of,
    solved,
)
from tests.kit.flag_trials import TRIALS, Rates, rates
from tests.kit.simulated_films import (
    SPHERE_1974,
    WGS84,
    Earth,
    Errors,
    Plan,
    deck_of,
    jobs_of,
    simulate,
)
from tests.tolerances import assert_close, within
from vopd.pipeline import read_deck

CONFIDENCE = 0.999
ROW = {row.name: row for row in ROWS}
TRIAL = {trial.name: trial for trial in TRIALS}

AT_REST = ("landmarks 100 ft, camera at rest", 3, 24)
CELLS = [
    ("readings", 3, 8),  # each frame's sigma by its own residuals
    ("readings, poor geometry", 4, 6),
    ("identification .05 mm, one frame a job", 2, 40),  # no Student's t
    ("identification .05 mm, sigma given", 3, 6),
    ("fiducials three times noisier", 12, 6),  # no error of the fiducials
    ("velocity 10 ft/s", 3, 6),  # no error of the velocity
    ("velocity 10 ft/s, eta below .2 degree", 4, 8),  # an eta below zero
    ("readings, yaw and roll across 0", 6, 5),
    ("readings, faithful run, truth on the sphere of 1974", 6, 5),
    AT_REST,  # errors counted twice, or taken to be independent from frame to frame
    ("mounting .1 degree", 2, 12),  # no error of the mounting
    ("all together, camera pitch within 2 degrees of -90", 2, 15),
    ("all together, through cards", 12, 15),
]


counted_once = cache(counted)


def allows(found: Share, low: float, high: float) -> None:
    assert found.low <= high and found.high >= low, found


@pytest.mark.parametrize(("name", "landmarks", "jobs"), CELLS)
def test_the_truth_is_inside_as_often_as_stated(name: str, landmarks: int, jobs: int) -> None:
    found = counted_once(ROW[name], landmarks, 7, jobs)
    assert not found.lost
    for angles in (VEHICLE, ATTACK, ETA):
        allows(found.share_95(angles, CONFIDENCE), 0.93, 0.97)
    for angles in (VEHICLE, ATTACK):
        allows(found.beyond_68(angles, CONFIDENCE), -0.013, 0.017)
    allows(share(found.attitude_95, CONFIDENCE), 0.93, 0.97)


@pytest.mark.parametrize(("landmarks", "frames"), [(2, 3), (4, 1)])
def test_the_ellipsoid_of_few_degrees_of_freedom(landmarks: int, frames: int) -> None:
    """With 7.815 in place of 3 F(.95; 3, nu) it holds 77 of 100 with three, 84 with five."""
    row = ROW["identification .05 mm, one frame a job"]
    found = counted(row._replace(plan=row.plan._replace(frames=frames)), landmarks, 5, 240)
    allows(share(found.attitude_95, CONFIDENCE), 0.93, 0.97)


def test_a_mean_over_frames_is_as_uncertain_as_the_common_errors_leave_it() -> None:
    """With the errors of landmarks independent from frame to frame, 2 of 10 would be inside."""
    name, landmarks, jobs = AT_REST
    found = counted_once(ROW[name], landmarks, 7, jobs)
    allows(share(found.mean_95, CONFIDENCE), 0.93, 0.97)


def test_errors_that_are_given_are_not_in_the_reading_sigma() -> None:
    """Landmarks 100 ft off, the same in all frames, would make it nearly twice as large.

    Taken to be independent from frame to frame they would make it right only on average.
    """
    errors = Errors(reading_in=0.003, identification_mm=0.005, landmark_ft=100.0)
    films = simulate(Plan(errors, landmarks=4, jobs=16, frames=20), 6)
    true = sigmas_of(errors, reading=True).reading
    assert true
    ratio = np.array([one.uncertainty.reading.sigma for one in solved(films)]) / true
    assert abs(ratio.mean() - 1.0) < within("estimated reading sigma")
    assert np.abs(ratio - 1.0).max() < within("reading sigma of a short film")


def flagged(name: str, landmarks: int, jobs: int) -> Rates:
    found = rates(TRIAL[name], landmarks, 9, jobs)
    assert found.wrong or name == "nothing"
    return found


@pytest.mark.parametrize("landmarks", [2, 4])
def test_films_without_an_error_are_hardly_ever_flagged(landmarks: int) -> None:
    """Tests at .001: of 360 frames 4 are more than one in a thousand counts has."""
    found = flagged("nothing", landmarks, 6)
    for flag in ("not_converged", "undetermined", "out_of_range", "behind_camera", "jump"):
        assert found.false[flag] == 0.0
    for flag in ("outlier", "misfit"):
        assert found.false[flag] * found.others < 3.5


@pytest.mark.parametrize(
    ("name", "landmarks", "alone"),
    [
        ("a landmark misread by 1 mm", 3, 0.6),
        ("a landmark misread by .1 mm", 6, 0.85),
        ("two labels exchanged", 4, 0.85),
    ],
)
def test_a_wrong_reading_is_noticed_and_named(name: str, landmarks: int, alone: float) -> None:
    """Where one frame in eight is wrong; of three landmarks two repairs may fit as well.

    The test of one landmark against the others takes four, and a single wrong reading.
    """
    found = flagged(name, landmarks, 7)
    assert found.found["misfit"] == 1.0 and found.false["misfit"] * found.others < 3.5
    assert found.named > 0.85 and found.named_alone > alone
    assert found.found["outlier"] == (1.0 if landmarks == 6 else 0.0)


@pytest.mark.parametrize(
    ("name", "flag", "landmarks"),
    [
        ("one landmark read", "undetermined", 3),
        ("two landmarks read", "two_landmarks", 3),
        ("one turn moves the image 20 times less than another", "weak_geometry", 4),
        ("start at the other solution", "behind_camera", 2),
        ("pitch jumps by 5 degrees", "jump", 4),
    ],
)
def test_a_flag_is_raised_where_it_should_be_and_nowhere_else(
    name: str, flag: str, landmarks: int
) -> None:
    """Two in a hundred of either kind are allowed: frames at the limit, by their noise."""
    found = flagged(name, landmarks, 4)
    assert found.found[flag] > 0.98 and not found.false[flag] > 0.02


@pytest.mark.parametrize(("earth", "names"), [(WGS84, ("all",)), (SPHERE_1974, ())])
def test_films_without_errors_are_solved_to_the_truth(earth: Earth, names: tuple[str, ...]) -> None:
    films = simulate(Plan(Errors(), jobs=3, frames=5, earth=earth, decimals=None), 4)
    found = np.stack([one.estimate.vehicle_deg for one in solved(films, names)])
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
