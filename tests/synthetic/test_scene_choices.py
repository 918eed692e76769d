"""Which landmarks a synthetic film shows, where they are, and what each job of a stack has."""

from __future__ import annotations

from math import ceil, radians, sin

import numpy as np
import pytest

from vopd import synthetic as scene
from vopd.findings import VopdError
from vopd.job import Job, Landmarks, Trajectory
from vopd.synthetic import (
    CameraView,
    Plan,
    Truth,
    _geodetic,
    choose_landmarks,
    images,
    in_view,
    make,
    place_landmarks,
    points_km,
    position_ft,
    seen_ground,
    trajectory,
    truth_csv,
    view,
)

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
        "7,40.12346,1.234568,-2.000000,360.000000,101.234568,98.000000,460.000000,"
        "1234.5679,-2000.0000,359999.9999"
    )
