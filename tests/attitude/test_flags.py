"""Each flag raised where it should be, and nowhere else."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation
from vopd.attitude.solution import solution

import vopd
from tests.attitude import draws
from tests.kit import appendix_a, spherical_film
from tests.kit.jobs import film, without
from vopd.attitude.flags import MAX_CONDITION, MEANING
from vopd.attitude.history import History, history
from vopd.attitude.landmark_geometry import AXES, geometry
from vopd.attitude.outliers import outliers
from vopd.attitude.second_solution import second_rms_mm
from vopd.errata import fixes
from vopd.findings import VopdError
from vopd.job import Job
from vopd.program.vopd import run

DECKS = Path(__file__).parents[2] / "decks"
TRUTH = np.array([140.0, -80.0, 60.0])


def flagged(job: Job, rate: float | None = None) -> dict[str, list[int]]:
    """The places of the frames that have each flag, of the flags that are raised."""
    raised = history(run(job), max_rate_deg_s=rate).flags.raised
    return {name: np.flatnonzero(here).tolist() for name, here in raised.items() if here.any()}


def turned(job_of: np.ndarray, start: np.ndarray = TRUTH) -> Job:
    return spherical_film.job(job_of, start)


def only(job: Job, *landmarks: int) -> Job:
    """The job with some of its five landmarks."""
    r, chosen = job.readings, list(landmarks)
    return replace(
        job,
        readings=replace(
            r,
            landmark=r.landmark[:, chosen],
            present=r.present[:, chosen],
            landmark_in=r.landmark_in[:, chosen],
        ),
    )


def test_a_good_film_has_none() -> None:
    assert flagged(turned(np.tile([140.0, -70.0, 60.0], (4, 1)), np.array([140.0, -70, 60]))) == {}


def test_two_landmarks_have_no_redundancy_and_another_side() -> None:
    job = only(turned(np.array([[140.0, -70.0, 60.0]]), np.array([140.0, -70, 60])), 0, 3)
    assert set(flagged(job)) == {"two_landmarks", "second_solution"}


def test_one_landmark_determines_nothing() -> None:
    one = history(run(only(film(1), 2)))
    assert one.flags.raised["undetermined"].all()
    assert np.isnan(one.uncertainty.total).all() and not np.isfinite(one.geometry.condition[0])


def test_one_landmark_read_twice_is_one_landmark() -> None:
    """A turn about the line to it is held by nothing: no deviation, and not a small one."""
    job = only(turned(np.array([[140.0, -70.0, 60.0]]), np.array([140.0, -70, 60])), 2, 2)
    one = history(run(job))
    assert one.flags.raised["undetermined"].all()
    assert np.isnan(one.uncertainty.total).all()


def test_the_camera_that_looks_at_the_sky() -> None:
    """Case 1 from 18, 80, 285 ends with the ground behind it (docs/conventions.md)."""
    (job,) = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")
    results = run(job, start_deg=np.array([[18.0, 80.0, 285.0]]))
    assert abs(results.camera_deg[0, 1] - 70.273) < 1e-3
    assert history(results).flags.raised["behind_camera"].all()
    assert not history(run(job)).flags.raised["behind_camera"].any()


def test_what_does_not_converge() -> None:
    start = np.array([60.0, 5.0, 200.0])
    job = only(turned(np.array([TRUTH]), start), 0, 1)
    one = history(run(job))
    assert one.flags.raised["not_converged"].tolist() == (~one.results.converged).tolist()
    bent = replace(one.results, correction_rad=np.array([[0.0, 1.1e-6, 0.0]]))
    assert history(bent).flags.raised["not_converged"].all()
    bent = replace(one.results, correction_rad=np.array([[0.0, 0.9e-6, 0.0]]))
    assert not history(bent).flags.raised["not_converged"].any()


@pytest.mark.parametrize(
    ("pitch", "detail"),
    [(-84.9, None), (-85.1, "camera_pitch+vehicle_pitch"), (-94.9, "camera_pitch+vehicle_pitch")],
)
def test_pitch_within_five_degrees_of_the_pole(pitch: float, detail: str | None) -> None:
    angles = np.array([[140.0, pitch, 60.0]])
    one = history(run(turned(angles, angles[0])))
    assert one.flags.raised["pitch_near_90"].tolist() == [detail is not None]
    if detail:
        assert f"pitch_near_90:{detail}" in one.flags.text()[0].split(";")


def test_which_pitch_is_named() -> None:
    angles = np.array([[140.0, -87.0, 60.0]])
    job = spherical_film.job(angles, angles[0], (1.0, 0.5, 1.0))
    assert history(run(job)).flags.detail["pitch_near_90"] == ["camera_pitch"]


def spike(at: int, size: float, count: int = 8) -> np.ndarray:
    angles = np.tile([140.0, -70.0, 60.0], (count, 1))
    angles[at:, 0] += 0.0
    angles[at, 0] += size
    return angles


@pytest.mark.parametrize(
    ("at", "expected"), [(3, [3]), (0, [0]), (7, [7])], ids=["amid", "first", "last"]
)
def test_a_frame_that_jumps_out_is_flagged_and_not_its_neighbours(
    at: int, expected: list[int]
) -> None:
    """Frames are a second apart; 8 degrees of yaw at a pitch of -70 are 8 degrees of turn."""
    job = turned(spike(at, 8.0), np.array([140.0, -70.0, 60.0]))
    assert flagged(job, 7.9) == {"jump": expected}
    assert flagged(job, 8.1) == {} and flagged(job) == {}


def test_a_step_flags_both_sides_of_it() -> None:
    angles = np.tile([140.0, -70.0, 60.0], (6, 1))
    angles[3:, 2] += 5.0
    job = turned(angles, np.array([140.0, -70.0, 60.0]))
    assert flagged(job, 4.9) == {"jump": [2, 3]}
    gone = without(job, int(job.readings.frame[2]))  # neighbours are two seconds apart then
    assert flagged(gone, 4.9) == {} and flagged(gone, 2.4) == {"jump": [1, 3]}


def test_a_rate_of_nothing_is_refused() -> None:
    for rate in (0.0, -1.0, float("nan")):
        with pytest.raises(VopdError, match="maximum rate"):
            history(run(film(1)), max_rate_deg_s=rate)


# Weak geometry


def bunch(truth: np.ndarray, offsets_mm: np.ndarray) -> tuple[float, str]:
    """Condition and weak axis of landmarks that stand so on the film."""
    job = turned(truth[None], truth)
    solved = solution(run(only(job, *range(len(offsets_mm)))))
    axes = appendix_a.matrix(truth / appendix_a.RAD)
    rays = np.column_stack([offsets_mm, np.full(len(offsets_mm), 10.4)])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    cosines, used = (rays @ axes)[None], np.ones((1, len(rays)), bool)
    seen = appendix_a.sight(cosines, offsets_mm[None], 10.4)
    b = np.stack([appendix_a.partials(truth / appendix_a.RAD, cosines[0], 10.4, erratum=False)])
    columns = -b.transpose(0, 2, 1, 3).reshape(1, -1, 3)
    bent = replace(
        solved,
        results=replace(solved.results, direction=cosines, used=used),
        sight=seen,
        radians=truth[None] / appendix_a.RAD,
        partials=columns,
        used=used,
    )
    found = geometry(bent)
    return float(found.condition[0]), AXES[found.weak_axis[0]]


def independent_condition(offsets_mm: np.ndarray) -> float:
    """Singular values of differences of images of slightly turned rays."""
    rays = np.column_stack([offsets_mm, np.full(len(offsets_mm), 10.4)])
    columns = []
    for axis in np.eye(3):
        images = []
        for step in (1e-6, -1e-6):
            x, y, z = Rotation.from_rotvec(step * axis).apply(rays).T
            images.append(10.4 * np.concatenate([x / z, y / z]))
        columns.append((images[0] - images[1]) / 2e-6)
    sizes = np.linalg.svd(np.stack(columns, axis=1))[1]
    return float(sizes[0] / sizes[2])


@pytest.mark.parametrize("truth", [TRUTH, np.array([30.0, -89.99, 200.0])], ids=["", "pole"])
@pytest.mark.parametrize(
    ("offsets", "axis"),
    [
        ([[0.1, 0.0], [-0.1, 0.1], [0.0, -0.1]], "optical axis"),  # all near the centre
        ([[5.0, 0.0], [-5.0, 0.0], [2.0, 0.1]], None),
        ([[3.0, 2.0], [-4.0, 1.0], [1.0, -4.0], [2.0, 2.0]], None),
    ],
    ids=["narrow", "line", "wide"],
)
def test_condition_by_turning_rays(
    truth: np.ndarray, offsets: list[list[float]], axis: str | None
) -> None:
    """The same wherever the camera looks, straight down too."""
    found, weak = bunch(truth, np.array(offsets))
    assert abs(found / independent_condition(np.array(offsets)) - 1.0) < 1e-4
    assert axis is None or weak == axis
    assert (found > MAX_CONDITION) == (axis is not None)


# Outliers


@pytest.mark.parametrize("names", [(), ("first-landmark",)], ids=str)
@pytest.mark.parametrize("count", [4, 5])
def test_false_alarms_are_as_rare_as_stated(names: tuple[str, ...], count: int) -> None:
    """One frame in a thousand; of 16,000 frames 16 are expected, 33 would be four sigmas."""
    rng = np.random.default_rng(count)
    job = draws.repeated((30.0, -62.0, 200.0), range(count), draws=16_000)
    found = outliers(solution(run(draws.misread(job, 0.003, rng), fixes(*names))))
    assert 3 <= found.any(axis=1).sum() <= 32
    assert found.sum(axis=1).max() == 1


@pytest.mark.parametrize("which", range(5))
def test_the_landmark_that_is_off_is_named(which: int) -> None:
    """By .05 in where readings have .001; every time."""
    job = draws.repeated((30.0, -62.0, 200.0), draws=200)
    job = draws.misread(job, 0.001, np.random.default_rng(which))
    readings = job.readings.landmark_in.copy()
    readings[:, which, :, 0] += 0.05
    one = history(run(replace(job, readings=replace(job.readings, landmark_in=readings))))
    assert one.flags.misfit[:, which].all() and one.flags.misfit.sum() == 200
    assert f"outlier:{11 + which}" in one.flags.text()[0]


def test_of_three_none_can_be_told() -> None:
    job = only(film(1), 0, 1, 2)
    readings = job.readings.landmark_in.copy()
    readings[:, 1] += 0.5
    assert "outlier" not in flagged(
        replace(job, readings=replace(job.readings, landmark_in=readings))
    )


# The other solution


def best_behind(one: History) -> float:
    """The least root mean square of all minima with the landmarks behind, by scipy."""
    results = one.results
    seen = solution(results).sight
    used = results.used[0]
    measured = np.stack([seen.x[:, 0], seen.y[:, 0]], axis=1)[used]
    cosines = results.direction[0][used]
    best = np.inf
    rng = np.random.default_rng(0)

    def residual(turn: np.ndarray, base: np.ndarray) -> np.ndarray:
        p, q, r = Rotation.from_rotvec(turn).as_matrix() @ base @ cosines.T
        return np.concatenate([measured[:, 0] - 10.4 * p / r, measured[:, 1] - 10.4 * q / r])

    for base in Rotation.random(25, random_state=rng).as_matrix():
        fit = least_squares(residual, np.zeros(3), args=(base,), xtol=1e-14)
        ahead = (Rotation.from_rotvec(fit.x).as_matrix() @ base @ cosines.T)[2]
        if (ahead < 0.0).all():
            best = min(best, float(np.sqrt(np.mean(fit.fun**2))))
    return best


@pytest.mark.parametrize("landmarks", [(0, 3), (0, 1, 2), (0, 1, 3, 4), (0, 1, 2, 3, 4)], ids=len)
@pytest.mark.parametrize("pitch", [-80.0, -70.0])
def test_the_second_solution_is_the_best_on_the_other_side(
    landmarks: tuple[int, ...], pitch: float
) -> None:
    angles = np.array([[140.0, pitch, 60.0]])
    one = history(run(only(turned(angles, angles[0]), *landmarks), fixes("first-landmark")))
    found = float(second_rms_mm(solution(one.results))[0])
    best = best_behind(one)
    assert abs(found - best) < 1e-6 + 1e-4 * best
    assert (len(landmarks) == 2) == (best < 1e-6)


# All of them


def test_every_flag_is_explained() -> None:
    raised = history(run(film(2))).flags.raised
    assert list(raised) == list(MEANING)
    page = (DECKS.parent / "docs" / "uncertainty.md").read_text(encoding="utf-8")
    for name, (meaning, remedy) in MEANING.items():
        assert meaning and remedy and f"| `{name}` | {meaning} | {remedy} |\n" in page


@pytest.mark.parametrize("deck", sorted(DECKS.glob("*/*.dat")), ids=lambda path: path.stem)
def test_any_deck_has_a_history(deck: Path) -> None:
    """Stopped, exact, ignored, asterisks: never a traceback, never a warning."""
    try:
        jobs = vopd.read_deck(deck)
    except VopdError:
        return
    for one in vopd.run(jobs).histories(vopd.Sigmas(None, 30.0, 60.0, 0.01, 0.1), 10.0):
        frames = len(one.results.frame)
        assert len(one.flags.text()) == len(one.status) == frames
        assert one.uncertainty.total.shape == (frames, 9)
