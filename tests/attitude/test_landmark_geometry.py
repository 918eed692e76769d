"""Condition and weak axis against rays that are turned, and frames that determine nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.kit import repeated_frame
from tests.kit.estimates import FOCAL, estimate
from tests.kit.jobs import film, reread
from tests.tolerances import within
from vopd.attitude.flags import MAX_CONDITION
from vopd.attitude.geometry import AXES, landmark_geometry
from vopd.attitude.history import History
from vopd.job import Job
from vopd.pipeline import run

NARROW = [[0.1, 0.0], [-0.1, 0.1], [0.0, -0.1]]
LINE = [[5.0, 0.0], [-5.0, 0.0], [2.0, 0.1]]
WIDE = [[3.0, 2.0], [-4.0, 1.0], [1.0, -4.0], [2.0, 2.0]]
NEAR_POLE = [30.0, -89.99, 200.0]


def by_turned_rays(image: np.ndarray) -> tuple[float, np.ndarray]:
    """Condition and weakest axis of differences of images of slightly turned rays."""
    rays = np.column_stack([image, np.full(len(image), FOCAL)])
    columns = []
    for axis in np.eye(3):
        images = []
        for step in (1e-6, -1e-6):
            x, y, z = Rotation.from_rotvec(step * axis).apply(rays).T
            images.append(FOCAL * np.concatenate([x / z, y / z]))
        columns.append((images[0] - images[1]) / 2e-6)
    _, sizes, axes = np.linalg.svd(np.stack(columns, axis=1))
    return float(sizes[0] / sizes[2]), axes[2]


@pytest.mark.parametrize("truth", [[140.0, -80.0, 60.0], NEAR_POLE, [10.0, 3.0, 0.0]], ids=str)
@pytest.mark.parametrize("image", [NARROW, LINE, WIDE], ids=["narrow", "line", "wide"])
def test_condition_by_turning_rays(truth: list[float], image: list[list[float]]) -> None:
    """The same wherever the camera looks, almost straight down too."""
    found = landmark_geometry(estimate(np.array([truth]), np.array(image)))
    condition, axis = by_turned_rays(np.array(image))
    assert abs(found.condition[0] / condition - 1.0) < within("condition by turned rays")
    assert found.weak_axis[0] == np.abs(axis).argmax()
    assert (condition > MAX_CONDITION) == (image is NARROW)
    assert not found.behind.any()


coordinate = st.integers(-5000, 5000).map(lambda micrometres: micrometres / 1000.0)
points = st.lists(st.tuples(coordinate, coordinate), min_size=2, max_size=6, unique=True)


@given(points)
def test_condition_of_any_image(image: list[tuple[float, float]]) -> None:
    """As far as differences of 1e-6 radian can tell."""
    condition, _ = by_turned_rays(np.array(image))
    found = landmark_geometry(estimate([200.0, -60.0, 30.0], np.array(image)))
    if condition < 1e4:
        assert abs(found.condition[0] / condition - 1.0) < within("large condition by turned rays")
    else:
        assert not found.condition[0] < 5e3


@pytest.mark.parametrize(
    ("centre", "axis"),
    [([0.0, 0.0], "optical axis"), ([40.0, 0.0], "image x axis"), ([0.0, -40.0], "image y axis")],
)
def test_landmarks_close_together_leave_the_turn_about_their_direction(
    centre: list[float], axis: str
) -> None:
    """40 mm, four focal lengths, from the centre that is nearer to an image axis."""
    found = landmark_geometry(estimate([140.0, -70.0, 60.0], np.array(centre) + np.array(NARROW)))
    assert AXES[found.weak_axis[0]] == axis and found.condition[0] > MAX_CONDITION


def test_the_limit_is_twenty() -> None:
    """Two landmarks d to either side of the centre: by hand the condition is f/d + d/f."""
    for apart, expected in ((0.522, False), (0.520, True)):
        image = np.array([[-apart, 0.0], [apart, 0.0]])
        condition = float(landmark_geometry(estimate([140.0, -70.0, 60.0], image)).condition[0])
        by_hand = (FOCAL**2 + apart**2) / (FOCAL * apart)
        assert abs(condition / by_hand - 1.0) < within("condition by hand")
        assert (condition > MAX_CONDITION) == expected


@pytest.mark.parametrize(
    ("turned", "used", "behind"),
    [(2, True, True), (0, True, True), (2, False, False), (None, True, False)],
)
def test_a_landmark_behind_the_camera_counts_if_it_takes_part(
    turned: int | None, used: bool, behind: bool
) -> None:
    """Of two frames the second has one landmark on the opposite side."""
    one = estimate(np.tile([140.0, -70.0, 60.0], (2, 1)))
    direction, part = one.direction.copy(), one.used.copy()
    if turned is not None:
        direction[1, turned] *= -1.0
        part[1, turned] = used
    found = landmark_geometry(replace(one, direction=direction, used=part))
    assert found.behind.tolist() == [False, behind]


# What determines nothing


def history_of(job: Job) -> History:
    (one,) = run(job).histories()
    return one


def with_landmarks(job: Job, rows: dict[int, list[int]]) -> Job:
    """The job with only these landmarks in some of its frames."""
    present = job.readings.present.copy()
    for frame, chosen in rows.items():
        present[frame] = np.isin(np.arange(present.shape[1]), chosen)
    landmark = np.where(present, job.readings.landmark, 0)
    return replace(job, readings=reread(job.readings, present=present, landmark=landmark))


def means_nothing(one: History, frame: int) -> bool:
    """Flagged, and without any standard deviation that could be believed."""
    flagged = bool(one.flags.raised["undetermined"][frame])
    return flagged and not np.isfinite(one.uncertainty.total[frame]).any()


def test_frames_of_few_landmarks() -> None:
    """None (a frame that is `exact` without any landmark), one, two, five."""
    one = history_of(with_landmarks(film(4), {0: [], 1: [2], 2: [0, 3]}))
    assert one.status == ["exact", "solved", "solved", "solved"]
    assert [means_nothing(one, k) for k in range(4)] == [True, True, False, False]
    assert one.landmarks.tolist() == [0, 1, 2, 5]
    assert np.isfinite(one.uncertainty.total[2:]).all()


@pytest.mark.parametrize("count", [2, 3, 5])
def test_one_landmark_read_several_times(count: int) -> None:
    """Rounding does not make an attitude of it, in none of 50 frames."""
    rng = np.random.default_rng(1)
    job = repeated_frame.repeated(landmarks=[2] * count, draws=50)
    one = history_of(repeated_frame.misread(job, 1e-4, rng))
    assert all(means_nothing(one, k) for k in range(50))


def test_landmarks_a_hundred_feet_apart_are_weak_and_flagged() -> None:
    """At 40 km: a standard deviation of many degrees about the line of sight."""
    job = repeated_frame.repeated(landmarks=(2, 2), draws=4)
    marks = job.landmarks
    second = marks.number == 14
    pair = replace(
        marks,
        longitude_min=np.where(second, marks.longitude_min[2], marks.longitude_min),
        latitude_min=np.where(second, marks.latitude_min[2] + 0.0165, marks.latitude_min),
        altitude_ft=np.where(second, marks.altitude_ft[2], marks.altitude_ft),
    )
    number = np.tile([13, 14], (4, 1))
    job = replace(job, landmarks=pair, readings=reread(job.readings, landmark=number))
    one = history_of(job)
    assert one.flags.raised["weak_geometry"].all() and not one.flags.raised["undetermined"].any()
    assert (one.geometry.condition > 500.0).all()


def test_the_geometry_of_some_frames_and_of_one_landmark() -> None:
    angles = np.array([[30.0, -60.0, 20.0], [40.0, -70.0, 30.0], [50.0, -80.0, 40.0]])
    every = landmark_geometry(estimate(angles, np.array([NARROW, LINE, WIDE[:3]])))
    some = every.take(slice(1, 3))
    for name in ("condition", "weak_axis", "behind"):
        assert getattr(some, name).tolist() == getattr(every, name)[1:].tolist()
    alone = landmark_geometry(estimate(angles, np.array(WIDE[:1])))
    assert not (alone.condition < 1e12).any()
