"""The synthetic flight: its attitude comes back, its path hangs together, its noise is as asked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.kit import appendix_a
from tests.kit.deck_by_columns import cut
from tests.kit.readings import reread
from tests.tolerances import assert_close, within
from vopd.cards.write import write_deck
from vopd.findings import VopdError
from vopd.job import Job
from vopd.program.vopd import run
from vopd.synthetic import (
    LIMITS,
    Plan,
    PlanError,
    RandomPart,
    Truth,
    choose_landmarks,
    make,
    random_stream,
    view,
)

FILM_MM_PER_IN = 0.713816400205
EARTH_FT = 20_925_698.0


def turned(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Differences of angles in degrees, the short way round."""
    return np.asarray((one - other + 180.0) % 360.0 - 180.0)


def left_open(job: Job, truth: Truth, error_in: float) -> np.ndarray:
    """How far each angle (F, 3) can move, in degrees, when film coordinates move by `error_in`.

    To first order: the solution of the listing's normal equations, B' B d = B' e with
    the erratum in B', for the worst signs of e. Cosines are those of the run, the
    partials Appendix A's.
    """
    cosines = run(job).direction
    moved = np.empty_like(truth.camera_deg)
    for f, angles in enumerate(np.radians(truth.camera_deg)):
        as_run, true = (
            appendix_a.partials(angles, cosines[f], job.camera.focal_length_mm, as_run).reshape(
                -1, 3
            )
            for as_run in (True, False)
        )
        gain = np.linalg.solve(as_run.T @ true, as_run.T)
        moved[f] = np.degrees(np.abs(gain).sum(axis=1)) * error_in * FILM_MM_PER_IN
    return moved


@pytest.mark.parametrize(
    ("frames", "landmarks", "seed"), [(200, 2, 1), (200, 3, 2), (100, 4, 3), (50, 9, 4)]
)
def test_a_deck_without_noise_gives_the_truth_back(frames: int, landmarks: int, seed: int) -> None:
    """Readings are in thousandths of an inch, so a landmark may be half of one off in x and y."""
    jobs, truth = make(Plan(frames=frames, landmarks=landmarks, seed=seed, noise_in=0.0))
    results = run(jobs[0])
    open_deg = left_open(jobs[0], truth, error_in=0.0005)
    assert open_deg.max() < 0.1  # or the test would say nothing
    off = turned(results.camera_deg, truth.camera_deg)
    most_deg = (1.0 + within("angle left open")) * open_deg
    assert (np.abs(off) <= most_deg).all()
    assert (np.abs(turned(results.vehicle_deg, truth.vehicle_deg)) <= most_deg).all()
    assert_close("table value", results.time_s, truth.time_s)
    assert_close("vehicle position", results.vehicle_ft, truth.position_ft)


@pytest.mark.parametrize(
    "plan",
    [
        Plan(frames=300, noise_in=0.0),
        Plan(frames=100, noise_in=0.0, seed=9, focal_length_mm=25.0, frame_in=(20.0, 20.0)),
        Plan(frames=100, noise_in=0.0, seed=3, landmarks=8, swing_deg=40.0, trajectory_rows=3),
    ],
)
def test_readings_of_full_precision_give_the_truth_to_eight_digits(plan: Plan) -> None:
    (job,), truth = make(plan)
    seen = view(job.trajectory, truth.position_ft, truth.camera_deg)
    marks, which, image = choose_landmarks(plan, seen, job.landmarks)
    assert marks == job.landmarks
    assert (marks.number[which] == job.readings.landmark).all()
    sharp = reread(job.readings, landmark_in=np.repeat(image[:, :, None], 3, axis=2))
    results = run(replace(job, readings=sharp))
    assert_close("angle from readings", turned(results.camera_deg, truth.camera_deg), 0.0)
    assert_close("film of eight digits", results.residual_mm, 0.0)


def test_the_film_soon_hands_yaw_on_to_the_next_frame() -> None:
    """Yaw passes north, and some frames start where the one before them ended, some do not."""
    (job,), truth = make(Plan(frames=150))
    yaw = truth.camera_deg[:, 0]
    assert ((yaw[:-1] > 350.0) & (yaw[1:] < 10.0)).any()
    handed_on = (yaw[:-1] > 0.1) & (yaw[:-1] < 6.2)
    assert 10 < handed_on.sum() < 140
    start = run(job).start_deg[1:, 0]
    assert (start[handed_on] != job.camera.initial_deg[0]).all()
    assert (start[yaw[:-1] > 7.0] == job.camera.initial_deg[0]).all()


def test_the_path_hangs_together() -> None:
    """Velocities north, east, down are those of the positions; altitude is above the sphere."""
    (job,), _ = make(Plan(frames=2000, trajectory_rows=400))
    path = job.trajectory
    middle = (path.velocity_ft_s[1:] + path.velocity_ft_s[:-1]) / 2.0
    moved = np.diff(path.position_ft, axis=0) / np.diff(path.time_s)[:, None]
    assert_close("demo speed", moved, middle[:, [1, 0, 2]] * [1.0, 1.0, -1.0])
    east, north, up = path.position_ft.T
    above = up + (east**2 + north**2) / (2.0 * (EARTH_FT + up))
    assert_close("demo altitude", path.altitude_ft, above)
    assert 70e3 < up.min() < up.max() < 150e3


def test_the_noise_is_as_asked_and_changes_nothing_else() -> None:
    plans = [Plan(frames=1500, seed=4, noise_in=noise) for noise in (0.0, 0.02)]
    ((clean,), true), ((noisy,), also_true) = map(make, plans)
    for part in ("trajectory", "wind", "clock", "landmarks", "camera"):
        assert getattr(clean, part) == getattr(noisy, part)
    assert (true.camera_deg == also_true.camera_deg).all()
    for name in ("fiducial_in", "landmark_in"):
        off = getattr(noisy.readings, name) - getattr(clean.readings, name)
        assert_close("counted reading noise", off.std(), 0.02)
        assert abs(off.mean()) < 4.0 * 0.02 / np.sqrt(off.size)
        same_point = off[:, :, 0].ravel() * off[:, :, 1].ravel()
        assert abs(same_point.mean()) < 5.0 * 0.02**2 / np.sqrt(same_point.size)


def test_every_part_of_every_flight_has_random_numbers_of_its_own() -> None:
    """So that what changes one part, such as the noise, leaves the others as they are."""
    streams = [
        tuple(random_stream(Plan(seed=seed), part, which).random(3))
        for seed in (0, 1, 2)
        for part in RandomPart
        for which in (0, 1, 2)
    ]
    assert len(set(streams)) == len(streams) == 3 * 5 * 3
    again = random_stream(Plan(seed=1, frames=7), RandomPart.WIND, 2).random(3)
    assert tuple(again) in streams


def test_no_reading_is_minus_zero() -> None:
    """The film reader punched no sign before zeros: two sides of a frame are at zero."""
    (job,), _ = make(Plan(frames=20))
    readings = job.readings.fiducial_in
    assert (readings == 0.0).sum() > 20 and not np.signbit(readings[readings == 0.0]).any()
    assert "-000000" not in write_deck([job])


@pytest.mark.parametrize("frame_in", [(14.47, 10.457), (5.0, 20.0)])
def test_the_lens_table_reaches_beyond_the_corner(frame_in: tuple[float, float]) -> None:
    """Twenty-five radii from 0, by a twentieth beyond it, and 145 µm of distortion at the last."""
    (job,), _ = make(Plan(frames=1, frame_in=frame_in))
    radius, distortion = job.camera.lens_radius_mm, job.camera.lens_distortion_um
    corner_mm = np.hypot(*frame_in) / 2.0 * FILM_MM_PER_IN
    assert (len(radius), radius[0], distortion[0], distortion[-1]) == (25, 0.0, 0.0, 145.0)
    assert radius[-1] == round(1.05 * corner_mm, 3)
    assert (np.diff(radius) > 0.0).all() and (np.diff(distortion) > 0.0).all()


def test_stacked_jobs_read_again_what_their_return_groups_say() -> None:
    jobs, truth = make(Plan(frames=5, jobs=6, seed=2))
    assert [job.return_group for job in jobs] == [12, 9, 8, 2, 12, 13]
    assert [bool(job.ignored.everywhere.any()) for job in jobs] == [0, 1, 0, 0, 0, 1]
    first = jobs[0].camera.initial_deg
    assert [(job.camera.initial_deg == first).all() for job in jobs] == [1, 1, 1, 0, 1, 1]
    assert [job.readings == jobs[0].readings for job in jobs] == [1, 1, 1, 1, 0, 0]
    for job in jobs:
        assert np.abs(turned(run(job).camera_deg, truth.camera_deg)).max() < within(
            "attitude, noisy deck"
        )


def test_a_film_beyond_the_last_frame_number_is_read_again() -> None:
    (job,), truth = make(Plan(frames=10_004, landmarks=2, noise_in=0.0))
    assert job.readings.frame[[0, 9998, 9999, 10_003]].tolist() == [1, 9999, 1, 5]
    for name in ("landmark", "landmark_in"):
        readings = getattr(job.readings, name)
        assert (readings[9999:] == readings[:5]).all()
    assert (truth.camera_deg[9999:] == truth.camera_deg[:5]).all()
    assert job.clock.frame.tolist() == [0, 10_000]


def test_more_frames_are_the_same_flight_further_on() -> None:
    short, long = (make(Plan(frames=frames, seed=3))[1] for frames in (10, 30))
    assert_close("table value", short.camera_deg, long.camera_deg[:10])


@pytest.mark.parametrize("name", LIMITS)
def test_a_plan_keeps_to_its_limits(name: str) -> None:
    low, high = LIMITS[name]
    for wrong in (low - 1, high + 1, float("nan")):
        value = (low, wrong) if name == "frame_in" else wrong
        with pytest.raises(PlanError, match=f"^{name}: .* is not within") as error:
            Plan(**{name: value})
        assert error.value.part == name


def test_landmarks_that_cannot_be_had_are_refused() -> None:
    with pytest.raises(VopdError, match=r"^60 landmarks in each of 800 frames need more"):
        make(Plan(frames=800, landmarks=60))


def test_case_1_is_the_model() -> None:
    """The origin is that of the report's case 1, and the camera's focal length."""
    origin = cut(write_deck(make(Plan())[0])).origin
    assert origin[:4] == [10.4, 33.083333, -106.3333, 20925.698]


def test_the_second_job_leaves_landmark_1_out_in_all_frames() -> None:
    jobs, _ = make(Plan(frames=2, landmarks=4, seed=1, jobs=2))
    assert jobs[0].return_group == 12 and jobs[0].landmarks.number[0] == 1
    others = [0] * (len(jobs[0].landmarks.number) - 1)
    assert jobs[1].ignored.everywhere.tolist() == [1, *others]
