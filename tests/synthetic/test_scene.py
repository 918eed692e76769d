"""The scene of a synthetic flight: the ground, and the landmarks chosen."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, radians, sin

import numpy as np
import pytest

from tests.approved.texts import refused
from tests.kit import appendix_a
from tests.kit.cards import cut
from tests.kit.jobs import reread
from tests.tolerances import assert_close, within
from vopd.cards.write import write_deck
from vopd.errata import fixes
from vopd.findings import VopdError
from vopd.job import Job, Landmarks, Trajectory
from vopd.program.vopd import run
from vopd.synthetic import LIMITS, Plan, PlanError
from vopd.synthetic import flight as scene
from vopd.synthetic.flight import (
    CameraView,
    RandomPart,
    Truth,
    _geodetic,
    choose_landmarks,
    images,
    in_view,
    make,
    place_landmarks,
    points_km,
    position_ft,
    random_stream,
    seen_ground,
    trajectory,
    truth_csv,
    view,
)

# The synthetic flight: its attitude comes back, its path hangs together, its noise is as asked


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
        Plan(frames=100, noise_in=0.0, seed=5, earth="wgs84"),
    ],
)
def test_readings_of_full_precision_give_the_truth_to_eight_digits(plan: Plan) -> None:
    (job,), truth = make(plan)
    seen = view(job.trajectory, truth.position_ft, truth.camera_deg, plan.earth)
    marks, which, image = choose_landmarks(plan, seen, job.landmarks)
    assert marks == job.landmarks
    assert (marks.number[which] == job.readings.landmark).all()
    sharp = reread(job.readings, landmark_in=np.repeat(image[:, :, None], 3, axis=2))
    results = run(replace(job, readings=sharp), fixes(*["all"] * (plan.earth == "wgs84")))
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
        with refused(PlanError) as error:
            Plan(**{name: value})
        assert error.value.part == name


def test_an_earth_that_there_is_not_is_refused() -> None:
    with refused(PlanError) as error:
        Plan(earth="flat")
    assert isinstance(error.value, PlanError) and error.value.part == "earth"


def test_landmarks_that_cannot_be_had_are_refused() -> None:
    with refused(VopdError):
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


# Which landmarks a synthetic film shows, where they are, and what each job of a stack has


PLANS = [
    Plan(frames=30, seed=1), Plan(frames=25, landmarks=7, seed=2), Plan(frames=20, landmarks=2),
    Plan(frames=40, seed=3, swing_deg=45.0, frame_in=(12.0, 9.0)),
]  # fmt: skip


def fractions(
    plan: Plan, job: Job, truth: Truth, marks: Landmarks
) -> tuple[np.ndarray, np.ndarray]:
    """Where every landmark is in every frame, of its width and height, and the sine of sight."""
    seen = view(job.trajectory, truth.position_ft, truth.camera_deg)
    found, slope = images(plan, seen, points_km(marks))
    return found / np.array(plan.frame_in), slope


@pytest.mark.parametrize("plan", PLANS)
def test_both_sides_of_every_frame_have_half_of_the_landmarks(plan: Plan) -> None:
    """Between .05 and .4 and between .6 and .95 of the width, .04 and .96 of the height."""
    (job,), truth = make(plan)
    marks = place_landmarks(plan, view(job.trajectory, truth.position_ft, truth.camera_deg))
    found, slope = fractions(plan, job, truth, marks)
    x, y = np.moveaxis(found, -1, 0)
    steep = (slope > sin(radians(8.0))) & (y > 0.04) & (y < 0.96)
    for low, high in ((0.05, 0.4), (0.6, 0.95)):
        count = (steep & (x > low) & (x < high)).sum(axis=1)
        assert (count >= ceil(plan.landmarks / 2)).all()
    assert 2 * ceil(plan.landmarks / 2) <= len(marks.number) <= 99
    for one in (marks, job.landmarks):
        assert one.number.tolist() == [*range(1, len(one.number) + 1)]


@pytest.mark.parametrize("plan", PLANS)
def test_the_lowest_number_in_view_and_then_the_farthest_is_read(plan: Plan) -> None:
    """One at a time by distances on the ground, of those in view and not seen too flat."""
    (job,), truth = make(plan)
    found, slope = fractions(plan, job, truth, job.landmarks)
    where = points_km(job.landmarks)
    for frame in range(plan.frames):
        x, y = found[frame].T
        free = (
            (x > 0.03) & (x < 0.97) & (y > 0.04) & (y < 0.96) & (slope[frame] > sin(radians(8.0)))
        )
        chosen = [int(np.flatnonzero(free)[0])]
        while len(chosen) < plan.landmarks:
            nearest = np.linalg.norm(where[:, None] - where[chosen], axis=2).min(axis=1)
            chosen.append(max(np.flatnonzero(free).tolist(), key=lambda k: nearest[k]))
        assert job.readings.landmark[frame].tolist() == [k + 1 for k in sorted(chosen)]


def test_landmarks_that_no_frame_reads_are_left_out_and_the_others_numbered_anew() -> None:
    plan = Plan(frames=30, seed=1)
    (job,), truth = make(plan)
    seen = view(job.trajectory, truth.position_ft, truth.camera_deg)
    marks, which, image = choose_landmarks(plan, seen.only(slice(0, 1)), job.landmarks)
    assert len(marks.number) == plan.landmarks < len(job.landmarks.number)
    assert which.tolist() == [[0, 1, 2, 3]] and marks.number.tolist() == [1, 2, 3, 4]
    kept = job.readings.landmark[0] - 1
    for name in ("longitude_deg", "longitude_min", "latitude_deg", "latitude_min", "altitude_ft"):
        assert (getattr(marks, name) == getattr(job.landmarks, name)[kept]).all()
    shown, _ = images(plan, seen.only(slice(0, 1)), points_km(marks))
    assert (image == shown).all()


@pytest.mark.parametrize(
    ("x", "y", "inside"),
    [(0.2, 0.5, True), (0.1, 0.5, False), (0.101, 0.5, True), (0.3, 0.5, False), (0.299, 0.5, True),
     (0.2, 0.04, False), (0.2, 0.041, True), (0.2, 0.96, False), (0.2, 0.959, True),
     (np.nan, 0.5, False), (0.2, np.nan, False)],
)  # fmt: skip
def test_what_is_in_view_between_two_x(x: float, y: float, inside: bool) -> None:
    assert bool(in_view(np.array([x, y]), (0.1, 0.3))) is inside


def test_what_each_job_of_a_stack_has_of_its_own() -> None:
    """From the first: estimates 3 degrees off and films read anew; a title of 80 columns."""
    jobs, _ = make(Plan(frames=3, jobs=10, seed=7))
    first = jobs[0]
    assert first.title == "1   SYNTHETIC FLIGHT 7" + " " * 58
    assert all(job.title == first.title for job in jobs)
    assert [job.return_group for job in jobs] == [12, 9, 8, 2, 12, 9, 8, 2, 12, 13]
    turned = [(job.camera.initial_deg - first.camera.initial_deg).tolist() for job in jobs]
    off, none = [-3.0, 2.0, 3.0], [0.0, 0.0, 0.0]
    assert turned == [none, none, none, off, none, none, none, off, none, none]
    films = [job.readings.landmark_in.tobytes() for job in jobs]
    numbers = [films.index(one) for one in films]
    assert numbers == [0, 0, 0, 0, 4, 4, 4, 4, 8, 8]
    ignored = [job.ignored.everywhere.tolist() for job in jobs]
    some = [1] + [0] * (len(first.landmarks.number) - 1)
    bare = [0] * len(some)
    assert ignored == [bare, some, bare, bare, bare, some, bare, bare, bare, some]


def test_the_vehicle_is_turned_by_group_3() -> None:
    (job,), truth = make(Plan(frames=5))
    assert job.camera.multiplier.tolist() == [1.0, 1.0, 1.0]
    assert job.camera.offset_deg.tolist() == [0.0, 0.0, -210.0]
    assert (truth.vehicle_deg == truth.camera_deg - np.array([0.0, 0.0, 210.0])).all()


def test_a_flight_that_needs_too_many_landmarks() -> None:
    with pytest.raises(VopdError) as refused:
        make(Plan(frames=400, landmarks=99))
    assert str(refused.value) == (
        "99 landmarks in each of 400 frames need more than 99 landmark numbers: ask for fewer "
        "landmarks or frames, less swing or another camera"
    )


def level(*pitch_deg: float) -> CameraView:
    """A camera 43 km up that looks so far below the horizontal; the sky is in its frames."""
    path = trajectory(Plan(), 90.0)
    where = position_ft(path, np.full(len(pitch_deg), 45.0))
    return view(path, where, np.array([[350.0, pitch, 0.0] for pitch in pitch_deg]))


def landmarks_at(plan: Plan, seen: CameraView, where: np.ndarray) -> Landmarks:
    """Landmarks whose images in the first frame are there, in inches."""
    x, y, z = seen_ground(plan, seen, where[None], np.zeros((1, len(where))))[0].T
    latitude, longitude = np.degrees(np.arctan2(z, np.hypot(x, y))), np.degrees(np.arctan2(y, x))
    zero = np.zeros(len(where))
    geodetic = _geodetic(latitude)
    return Landmarks(np.arange(1, len(where) + 1), longitude, zero, geodetic, zero, zero)


def test_landmarks_that_are_seen_too_flat_are_not_read() -> None:
    """Below 8 degrees at the landmark: of four in view the first, at 6, is left out."""
    plan, seen = Plan(landmarks=3), level(-18.0)
    marks = landmarks_at(plan, seen, np.array([[7.0, 7.5], [3.0, 6.0], [11.0, 6.0], [7.0, 2.0]]))
    shown, slope = images(plan, seen, points_km(marks))
    flat, *steep = np.degrees(np.arcsin(slope[0]))
    assert 5.0 < flat < 7.0 and all(12.0 < one < 40.0 for one in steep) and min(steep) < 15.0
    assert in_view(shown / np.array(plan.frame_in), (0.03, 0.97)).all()
    read, which, image = choose_landmarks(plan, seen, marks)
    assert which.tolist() == [[0, 1, 2]] and (image == shown[:, 1:]).all()
    assert (read.latitude_deg == marks.latitude_deg[1:]).all()


def test_landmarks_are_placed_on_the_ground_and_not_in_the_sky() -> None:
    plan, seen = Plan(), level(-20.0, -22.0, -30.0)
    marks = place_landmarks(plan, seen)
    shown, slope = images(plan, seen, points_km(marks))
    x, y = np.moveaxis(shown / np.array(plan.frame_in), -1, 0)
    steep = (slope > sin(radians(8.0))) & (y > 0.04) & (y < 0.96)
    for low, high in ((0.05, 0.4), (0.6, 0.95)):
        assert ((steep & (x > low) & (x < high)).sum(axis=1) >= 2).all()
    for column in (marks.latitude_deg, marks.latitude_min, marks.longitude_deg, marks.altitude_ft):
        assert np.isfinite(column).all()


def test_the_trajectory_is_asked_for_to_the_end_of_the_clock(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Frame 4, one after the last, is at 40 + 4 / 32 s."""
    asked: list[float] = []

    def spied(plan: Plan, until: float) -> Trajectory:
        asked.append(until)
        return trajectory(plan, until)

    monkeypatch.setattr(scene, "trajectory", spied)
    make(Plan(frames=3))
    assert asked == [40.125]


def test_a_line_of_the_truth() -> None:
    row = np.array([[1.23456789, -2.0, 359.9999999]])
    truth = Truth(np.array([7]), np.array([40.123456]), row, row + 100.0, row * 1000.0)
    assert truth_csv(truth).splitlines()[1] == (
        "7,40.12346,1.234568,-2.000000,0.000000,101.234568,98.000000,460.000000,"
        "1234.5679,-2000.0000,359999.9999"
    )
