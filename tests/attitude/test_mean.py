"""Mean attitudes, and rates about them: scipy's rotations, differences, covariances by hand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.stats import f, t

from tests.approved.texts import assert_approved, refused
from tests.kit.estimates import estimate
from tests.kit.histories import by_hand
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.attitude.history import History, history
from vopd.attitude.mean import mean_attitude, mean_table
from vopd.attitude.sigmas import Sigmas
from vopd.findings import VopdError
from vopd.geometry.rotations import from_yaw_pitch_roll

MOUNT = Rotation.from_euler("ZYX", [20.0, -70.0, 5.0], degrees=True)
"""The camera's forward, right, down in the vehicle."""


def wandering(frames: int = 6, size_deg: float = 25.0) -> History:
    """Attitudes some tens of degrees apart, each known to a hundredth of a degree or so."""
    rng = np.random.default_rng(frames)
    away = Rotation.from_rotvec(rng.uniform(-size_deg, size_deg, (frames, 3)), degrees=True)
    vehicle = Rotation.from_euler("ZYX", [350.0, 10.0, 5.0], degrees=True) * away
    made = estimate(angles(vehicle * MOUNT), vehicle_deg=angles(vehicle), noise=0.0, frame_names=[])
    return history(made, sigmas=Sigmas(reading=0.001, landmark=0.1))


def angles(rotation: Rotation) -> Floats:
    """Yaw, pitch, roll of axes in north, east, down."""
    return np.asarray(rotation.as_euler("ZYX", degrees=True))


def rotations(angles_deg: Floats) -> Rotation:
    return Rotation.from_euler("ZYX", angles_deg, degrees=True)


def test_the_turns_about_the_mean_have_the_mean_zero() -> None:
    one = wandering()
    found = one.mean()
    mean = rotations(found.vehicle_deg)
    turns = (mean.inv() * rotations(one.estimate.vehicle_deg)).as_rotvec(degrees=True)
    assert_close("recovered angle", turns.mean(axis=0), np.zeros(3))
    assert_close("recovered angle", found.quaternion, np.roll(mean.as_quat(canonical=True), 1))
    camera = (mean * MOUNT * rotations(found.camera_deg).inv()).magnitude()
    assert_close("recovered angle", np.degrees(camera), 0.0)
    assert found.frames == 6 and found.about is one.about


@pytest.mark.parametrize("size_deg", [1e-3, 25.0])
def test_how_the_mean_moves_with_each_frame(size_deg: float) -> None:
    """The weights that are handed to the covariance of sums, against turns of one frame."""
    one, taken = wandering(4, size_deg), []

    def of_sums(weight: Floats) -> Mapping[str, Floats]:
        taken.append(weight)
        return {"reading": np.eye(3)}

    one = replace(one, sum_errors=of_sums)
    mean, (weight,) = rotations(mean_attitude(one).vehicle_deg), taken
    step = 1e-3
    for frame in range(4):
        for axis in range(3):
            turn = step * np.eye(3)[axis]
            ends = [
                mean.inv() * rotations(mean_attitude(turned(one, frame, way * turn)).vehicle_deg)
                for way in (1.0, -1.0)
            ]
            moved = (ends[0].as_rotvec() - ends[1].as_rotvec()) / (2.0 * step)
            assert_close("mean by a turn", weight[frame, axis], moved)


@pytest.mark.parametrize(("before", "after"), [([0], [3]), ([0, 1], [2, 3]), ([0, 1, 2], [2, 3])])
def test_the_turn_from_frames_to_others_and_how_it_moves_with_each(
    before: list[int], after: list[int]
) -> None:
    """By scipy, and by turns of one frame; a frame may be among both."""
    one, taken = wandering(4), []

    def of_sums(weight: Floats) -> Mapping[str, Floats]:
        taken.append(weight)
        return {"reading": 4.0 * np.eye(3)}

    def turn(of: History) -> Floats:
        first, last = (rotations(mean_attitude(of, some).vehicle_deg) for some in (before, after))
        return np.asarray((first.inv() * last).as_rotvec())

    found = replace(one, sum_errors=of_sums).turn(before, after)
    assert_close("recovered angle", found.turn_deg, np.degrees(turn(one)))
    assert_close("covariance of a mean", found.total, np.full(3, np.degrees(2.0)))
    step, (weight,) = 1e-3, taken
    for frame in range(4):
        for axis in range(3):
            ends = [turn(turned(one, frame, way * step * np.eye(3)[axis])) for way in (1.0, -1.0)]
            assert_close("mean by a turn", weight[frame, axis], (ends[0] - ends[1]) / (2.0 * step))


def test_what_turns_all_frames_alike_is_no_turn_from_one_to_the_other() -> None:
    one = alike(4)

    def of_sums(weight: Floats) -> Mapping[str, Floats]:
        same = np.asarray(weight).sum(axis=0)
        return {"reading": 0.0 * same, "position": same.T @ same}

    found = replace(one, sum_errors=of_sums).turn([0, 1], [3])
    assert_close("recovered angle", [found.turn_deg, found.total], np.zeros((2, 3)))
    with refused():
        one.turn([0], [1])


def turned(one: History, frame: int, vector: Floats) -> History:
    """One frame's vehicle turned about its own axes."""
    vehicle = rotations(one.estimate.vehicle_deg).as_matrix()
    vehicle[frame] = vehicle[frame] @ Rotation.from_rotvec(vector).as_matrix()
    changed = Rotation.from_matrix(vehicle)
    quaternion = np.roll(changed.as_quat(canonical=True), 1, axis=1)
    own = replace(one.estimate, vehicle_deg=angles(changed), camera_deg=angles(changed * MOUNT))
    return replace(one, estimate=own, quaternion=quaternion)


def alike(frames: int) -> History:
    """Frames of one attitude; landmarks wrong by .1 m in all."""
    made = estimate(np.tile([10.0, -60.0, 20.0], (frames, 1)))
    return history(made, sigmas=Sigmas(reading=0.001, landmark=0.1))


def test_what_is_common_does_not_average_out() -> None:
    one, frames = alike(25), 25
    doubt, found = one.uncertainty, one.mean()
    assert_close("recovered angle", found.vehicle_deg, [10.0, -60.0, 20.0])
    common, own = doubt.covariance_common_deg2[0], doubt.covariance_independent_deg2[0]
    assert_close("covariance of a mean", found.covariance_deg2, common + own / frames)
    for name, share in (("landmark", 1.0), ("reading", 1.0 / frames)):
        expected = np.sqrt(share) * doubt.components[name][0, :6]
        assert_close("covariance of a mean", found.components[name], expected)
    squares = sum(part**2 for part in found.components.values())
    assert_close("covariance of a mean", found.total**2, squares)
    # here the vehicle's angles are those of the camera, and their errors those of its turns
    assert_close("covariance of a mean", found.total[3:], found.total[:3])


def test_an_estimated_reading_sigma_widens_intervals_and_ellipsoid() -> None:
    """By Welch and Satterthwaite, of the share that the readings have in the mean."""
    noisy = history(estimate(np.tile([10.0, -60.0, 20.0], (3, 1)), noise=0.3))
    found, freedom = noisy.mean(), noisy.uncertainty.reading.freedom
    assert found.reading_freedom == freedom and list(found.components) == ["reading"]
    assert_close("covariance of a mean", found.freedom, np.full(6, freedom))
    assert_close("half-width of a mean", found.half_width_95 / found.total, t.ppf(0.975, freedom))
    assert_close("half-width of a mean", found.covariance_factor_95, 3.0 * f.ppf(0.95, 3, freedom))
    # .1 degree of mounting beside .05 of readings: five times the variance for the vehicle
    doubt, size = noisy.uncertainty, np.radians(0.05) ** 2
    mounted = replace(doubt, sigmas=doubt.sigmas._replace(mount_deg=0.1))
    by_sums = replace(
        noisy, uncertainty=mounted, sum_errors=lambda _: {"reading": size * np.eye(3)}
    )
    found = by_sums.mean()
    expected = np.repeat([freedom, 25.0 * freedom], 3)
    assert_close("half-width of a mean", found.freedom, expected)
    ellipsoid = 3.0 * f.ppf(0.95, 3, 25.0 * freedom)
    assert_close("half-width of a mean", found.covariance_factor_95, ellipsoid)
    given = alike(4).mean()
    assert np.isinf(given.freedom).all()
    assert_close("half-width of a mean", given.covariance_factor_95, 7.814727903251179)
    assert_close("half-width of a mean", given.half_width_95 / given.total, 1.959963984540054)


def test_the_covariance_of_frames_that_were_solved_together() -> None:
    """By the covariance of all turns, which knows more than common and independent."""
    one = alike(3)
    rng = np.random.default_rng(3)
    parts = {name: rng.normal(size=(9, 12)) * 1e-4 for name in ("reading", "position")}

    def of_sums(weight: Floats) -> Mapping[str, Floats]:
        flat = weight.reshape(9, -1)
        return {name: flat.T @ own @ own.T @ flat for name, own in parts.items()}

    doubt = replace(one.uncertainty, sigmas=one.uncertainty.sigmas._replace(mount_deg=0.02))
    one = replace(one, sum_errors=of_sums, uncertainty=doubt)
    third = np.tile(np.eye(3) / 3.0, (3, 1))
    expected = {name: third.T @ own @ own.T @ third for name, own in parts.items()}
    whole = np.degrees(np.degrees(sum(expected.values()))) + 0.02**2 * np.eye(3)
    found = one.mean()
    assert_close("covariance of a mean", found.covariance_deg2, whole)
    assert set(found.components) == {"reading", "position", "mount"}
    # roll turns about forward, and pitch and yaw by sin and cos of roll, yaw more by 1 / cos pitch
    right, down = np.radians(20.0), np.radians(60.0)
    by_turns = np.array(
        [
            [0.0, np.sin(right) / np.cos(down), np.cos(right) / np.cos(down)],
            [0.0, np.cos(right), -np.sin(right)],
            [1.0, -np.sin(right) * np.tan(down), -np.cos(right) * np.tan(down)],
        ]
    )
    squares = np.diag(by_turns @ whole @ by_turns.T)
    assert_close("covariance of a mean", found.total[3:] ** 2, squares)
    some = one.mean([0, 2])
    weight = np.concatenate([np.eye(3), np.zeros((3, 3)), np.eye(3)]) / 2.0
    expected = {name: weight.T @ own @ own.T @ weight for name, own in parts.items()}
    whole = np.degrees(np.degrees(sum(expected.values()))) + 0.02**2 * np.eye(3)
    assert some.frames == 2
    assert_close("covariance of a mean", some.covariance_deg2, whole)
    # some frames of a history know it as well
    assert_close("covariance of a mean", one.take(np.array([2, 0])).mean().covariance_deg2, whole)


def test_frames_are_chosen_by_index_or_mark() -> None:
    one = wandering()
    marks = np.array([True, False, True, True, False, False])
    kept = marks.copy()
    assert one.mean(marks) == one.mean(np.flatnonzero(marks)) == one.take(marks).mean()
    assert one.mean((0, -4, -3)) == one.mean(marks) and one.mean(3) == one.mean(slice(3, 4))
    lost = one.estimate.vehicle_deg.copy()
    lost[0] = np.nan
    without = replace(one, estimate=replace(one.estimate, vehicle_deg=lost))
    assert without.mean(marks) == one.mean([2, 3])
    assert np.array_equal(marks, kept)


def test_a_mean_of_nothing_or_of_attitudes_too_far_apart_is_refused() -> None:
    one = by_hand(3)
    with refused(VopdError):
        one.mean(np.zeros(3, bool))
    other: tuple[Any, ...] = (730, [0, -4], [True], [0.0, 1.0], "all", iter([0]), [[0], [1, 2]])
    for frames in other:
        with pytest.raises(VopdError):
            one.mean(frames)
    with refused(VopdError):
        one.mean(730)
    apart = by_hand(3, angles_deg=[[yaw, 0.0, 0.0] * 3 for yaw in (0.0, 120.0, 240.0)])
    apart = replace(apart, quaternion=from_yaw_pitch_roll(apart.estimate.vehicle_deg))
    with refused(VopdError):
        apart.mean()


SPIN_DEG_S = np.array([5.0, -2.0, 1.0])


def spinning(parts: Mapping[str, Floats], deg_s: Floats = SPIN_DEG_S) -> History:
    """Four frames at 0, 1, 3 and 4 s of a vehicle that turns steadily about its own axes.

    Args:
        parts: by component, what the turns of all frames are of unknowns of one standard
            deviation, (12, ...), radians
        deg_s: about forward, right and down
    """
    time_s = np.array([0.0, 1.0, 3.0, 4.0])
    turns = Rotation.from_rotvec(time_s[:, None] * deg_s, degrees=True)
    vehicle = rotations(np.array([350.0, 10.0, 5.0])) * turns
    camera = angles(vehicle * MOUNT)
    made = estimate(camera, vehicle_deg=angles(vehicle), time_s=time_s, frame_names=[])

    def of_sums(weight: Floats) -> Mapping[str, Floats]:
        flat = weight.reshape(12, -1)
        return {name: flat.T @ own @ own.T @ flat for name, own in parts.items()}

    return replace(history(made, sigmas=Sigmas(reading=0.001)), sum_errors=of_sums)


def test_a_steady_rate_comes_back() -> None:
    """Its vector is the same about the axes of each frame, and so about those of the mean."""
    found = spinning({"reading": np.eye(12)}).rate()
    assert_close("recovered angle", found.rate_deg_s, SPIN_DEG_S)
    assert_close("recovered angle", found.residual_deg, 0.0)
    assert (found.frames, found.time_s) == (4, 2.0)
    two = spinning({"reading": np.eye(12)}).rate([0, 3])
    assert_close("recovered angle", two.rate_deg_s, SPIN_DEG_S)
    assert (two.frames, two.time_s) == (2, 2.0)
    off = spinning({"reading": 1e-4 * np.eye(12)}).rate([0, 1, 3])
    assert_approved(str(replace(off, residual_deg=0.25)))


def test_a_frame_without_a_time_has_no_part_in_a_rate() -> None:
    one = spinning({"reading": np.eye(12)})
    untimed = replace(one, estimate=replace(one.estimate, time_s=np.array([0.0, 1.0, np.nan, 4.0])))
    for found in (untimed.rate(), untimed.rate([0, 2, 1, 3])):
        assert (found.frames, found.time_s) == (3, 5.0 / 3.0)
        assert_close("recovered angle", found.rate_deg_s, SPIN_DEG_S)


def test_errors_of_a_rate_by_hand() -> None:
    """Of a vehicle that stands: times from the mean -2, -1, 1, 2 s, whose squares add to 10.

    An own error s of each frame is s / sqrt(10) of the rate; one that all share is none; one that
    grows by g a second is g.
    """
    own, grows = 1e-4 * np.eye(12), 1e-5 * np.kron([[0.0], [1.0], [3.0], [4.0]], np.eye(3))
    shared = 1e-2 * np.tile(np.eye(3), (4, 1))
    parts = {"reading": own, "landmark": shared, "time": grows}
    found = spinning(parts, np.zeros(3)).rate()
    expected = np.degrees([1e-4 / np.sqrt(10.0), 0.0, 1e-5])
    for size, (name, sigma) in zip(expected, found.components.items(), strict=True):
        assert_close("recovered angle", sigma, np.full(3, size)), name
    assert_close("covariance of a mean", found.total**2, np.full(3, (expected**2).sum()))
    assert_close("covariance of a mean", found.covariance_deg2_s2, np.diag(found.total**2))
    assert_close("half-width of a mean", found.half_width_95 / found.total, 1.959963984540054)
    assert_close("half-width of a mean", found.covariance_factor_95, 7.814727903251179)


def test_how_a_rate_moves_with_each_frame() -> None:
    """The weights that are handed to the covariance of sums, against turns of one frame."""
    one, taken = spinning({}, 4.0 * SPIN_DEG_S), []

    def of_sums(weight: Floats) -> Mapping[str, Floats]:
        taken.append(weight)
        return {"reading": np.eye(3)}

    one, step = replace(one, sum_errors=of_sums), 1e-3
    one.rate()
    weight = taken[0]
    for frame in range(4):
        for axis in range(3):
            turn = step * np.eye(3)[axis]
            ends = [turned(one, frame, way * turn).rate().rate_deg_s for way in (1.0, -1.0)]
            moved = np.radians(ends[0] - ends[1]) / (2.0 * step)
            assert_close("mean by a turn", weight[frame, axis], moved)


def test_a_rate_that_nothing_tells_is_refused() -> None:
    """Of one frame, of frames of one moment, of frames that each have errors of their own."""
    one = spinning({"reading": np.eye(12)})
    same = replace(one, estimate=replace(one.estimate, time_s=np.full(4, 2.0)))
    for wrong in (lambda: one.rate([2]), same.rate, wandering().rate):
        with refused(VopdError):
            wrong()


def test_the_table_of_means_has_the_columns_of_the_history_that_a_mean_has() -> None:
    one, other = wandering(), by_hand(3, flags={"jump": [2]})
    means = [one.mean(), other.mean()]
    columns, values = mean_table([one, other], means)
    assert [column.name for column in columns] == list(values)
    assert values["frames"].tolist() == [6, 3]
    assert values["flagged"].tolist() == [one.flags.any().sum(), 1]
    for k, mean in enumerate(means):
        assert values["vehicle_pitch_deg"][k] == mean.vehicle_deg[1]
        assert values["sigma_camera_roll_deg"][k] == mean.total[2]
        assert values["half_width_95_vehicle_yaw_deg"][k] == mean.half_width_95[3]
        assert values["covariance_right_down_deg2"][k] in mean.covariance_deg2[[1, 2], [2, 1]]
        assert np.array_equal(values["covariance_deg2"][k], mean.covariance_deg2)
        assert values["quaternion_x"][k] == mean.quaternion[1]
    assert np.isnan(values["sigma_landmark_vehicle_yaw_deg"]).tolist() == [False, True]
    assert np.isnan(values["degrees_of_freedom"]).tolist()[0]  # the reading sigma was given
    left_out = ("alpha", "eta", "time", "latitude", "flags", "landmarks", "status", "common")
    assert not [name for name in values for one in left_out if name.startswith(one)]
    assert not [name for name in values if "alpha" in name or "common" in name]
