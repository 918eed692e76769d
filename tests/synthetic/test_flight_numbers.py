"""The numbers of a synthetic flight: tables, limits, and its camera."""

from __future__ import annotations

from math import cos, hypot, radians, sin, sqrt

import numpy as np
import pytest

from tests.tolerances import assert_close
from vopd.synthetic import Plan, PlanError
from vopd.synthetic.flight import (
    RandomPart,
    _geodetic,
    camera_axes,
    camera_swing,
    clock,
    distorted,
    frame_numbers,
    images,
    landmark_km,
    lens_table,
    local_axes,
    make,
    position_ft,
    random_stream,
    read_film,
    seen_ground,
    trajectory,
    view,
    wind,
)

SEEDS = range(12)


def test_the_usual_plan() -> None:
    assert Plan() == Plan(
        frames=24, landmarks=4, seed=0, noise_in=0.003, jobs=1, trajectory_rows=50, swing_deg=20.0,
        focal_length_mm=10.4, frame_in=(14.47, 10.457),
    )  # fmt: skip


LIMITS = [
    ("frames", 1, 99_999, "1 to 99,999"), ("landmarks", 2, 99, "2 to 99"),
    ("seed", 0, 999_999_999, "0 to 999,999,999"), ("noise_in", 0.0, 1.0, "0 to 1"),
    ("jobs", 1, 999, "1 to 999"), ("trajectory_rows", 2, 9_999, "2 to 9,999"),
    ("swing_deg", 0.0, 45.0, "0 to 45"), ("focal_length_mm", 1.0, 1000.0, "1 to 1,000"),
    ("frame_in", 1.0, 100.0, "1 to 100"),
]  # fmt: skip


@pytest.mark.parametrize(("name", "low", "high", "words"), LIMITS)
def test_the_limits_of_a_plan_from_both_sides(
    name: str, low: float, high: float, words: str
) -> None:
    step = 1 if isinstance(low, int) else 1e-6
    shown = {low - step: None, high + step: None, float("nan"): "nan"}
    for value in (low, high):
        Plan(**{name: (value, value) if name == "frame_in" else value})
    for wrong, text in shown.items():
        for given in [(2.0, wrong), (wrong, 2.0)] if name == "frame_in" else [wrong]:
            with pytest.raises(PlanError) as error:
                Plan(**{name: given})
            problem = f"{text or format(wrong, ',.9g')} is not within {words}"
            assert (error.value.part, error.value.problem) == (name, problem)
            assert str(error.value) == f"{name}: {problem}"


@pytest.mark.parametrize(
    ("frames", "last", "time"), [(1, 2, 40.0625), (24, 25, 40.78125), (9_999, 10_000, 352.5),
                                 (25_000, 10_000, 352.5)]
)  # fmt: skip
def test_the_clock_has_32_frames_a_second(frames: int, last: int, time: float) -> None:
    """Frame 0 is at 40 s; a row before the first frame and one after the last."""
    table = clock(Plan(frames=frames))
    assert (table.frame.tolist(), table.time_s.tolist()) == ([0, last], [40.0, time])
    numbers = frame_numbers(Plan(frames=frames))
    assert len(numbers) == frames and (numbers[0], numbers.max()) == (1, min(frames, 9_999))
    assert (np.diff(numbers[:9_999]) == 1).all()
    assert numbers[9_999:10_001].tolist() == ([1, 2] if frames > 9_999 else [])


@pytest.mark.parametrize("until", [41.0, 86.0, 88.0, 352.5])
@pytest.mark.parametrize("rows", [2, 7, 50])
def test_the_trajectory_reaches_a_second_beyond_the_film(until: float, rows: int) -> None:
    """From 39 s; to 88 s at least, which is 47 s of film and a second more; in equal steps."""
    path = trajectory(Plan(trajectory_rows=rows), until)
    time = path.time_s
    assert (len(time), time[0], time[-1]) == (rows, 39.0, max(until, 87.0) + 1.0)
    assert_close("difference of card times", np.diff(time), (time[-1] - 39.0) / (rows - 1))
    origin = path.origin_latitude_deg, path.origin_longitude_deg, path.origin_radius_kft
    assert origin == (33.083333, -106.3333, 20925.698)


def decimals(values: np.ndarray, places: int) -> bool:
    """Whether no value has more decimals, and some have that many."""
    fine, coarse = np.round(values, places), np.round(values, places - 1)
    return bool((values == fine).all() and (values != coarse).any())


def test_decimals_are_those_of_the_cards() -> None:
    path = trajectory(Plan(seed=5), 100.0)
    assert decimals(path.time_s, 4) and decimals(path.altitude_ft, 1)
    assert decimals(path.position_ft, 2) and decimals(path.velocity_ft_s, 3)
    (job,), _ = make(Plan(seed=5))
    assert decimals(job.camera.lens_radius_mm, 3) and decimals(job.camera.lens_distortion_um, 1)
    assert decimals(job.landmarks.longitude_min, 2) and decimals(job.landmarks.latitude_min, 2)
    for whole in (
        job.landmarks.longitude_deg,
        job.landmarks.latitude_deg,
        job.landmarks.altitude_ft,
        job.camera.initial_deg,
        job.wind.velocity_ft_s,
    ):
        assert (whole == np.round(whole)).all()  # fmt: skip
    assert decimals(job.readings.landmark_in, 3)
    minutes = np.concatenate([job.landmarks.longitude_min, job.landmarks.latitude_min])
    assert (job.landmarks.longitude_deg < 0).all() and (
        (minutes >= -60.0) & (minutes <= 60.0)
    ).all()
    assert (job.landmarks.longitude_min <= 0).all() and (job.landmarks.latitude_min >= 0).all()
    assert ((job.landmarks.altitude_ft >= 3500) & (job.landmarks.altitude_ft <= 6500)).all()
    for tables in (path.velocity_ft_s, job.wind.velocity_ft_s, job.readings.fiducial_in):
        assert not np.signbit(tables[tables == 0.0]).any()


def test_the_wind_is_from_the_east_and_stronger_with_height() -> None:
    """20 ft/s at 70,000 ft and 160 at 160,000, growing with the square; north and south 20."""
    norths = []
    for seed in SEEDS:
        table = wind(Plan(seed=seed))
        assert table.altitude_ft.tolist() == [70e3 + 10e3 * k for k in range(10)]
        north, east = table.velocity_ft_s.T
        expected = [-20.0 - 140.0 * (k / 9.0) ** 2 for k in range(10)]
        assert_close("wind in whole feet", east, expected)
        phase = random_stream(Plan(seed=seed), RandomPart.WIND).uniform(0.0, 6.0)
        waves = [20.0 * sin((70e3 + 10e3 * k) / 15e3 + phase) for k in range(10)]
        assert_close("wind in whole feet", north, waves)
        norths.append(north)
    assert len({tuple(one) for one in norths}) == len(norths)
    zeros = [wind(Plan(seed=seed)).velocity_ft_s for seed in range(200)]
    assert sum((one == 0.0).sum() for one in zeros) > 10
    assert not any(np.signbit(one[one == 0.0]).any() for one in zeros)


def test_the_path_of_a_parachute() -> None:
    """The top 5 to 15 s after the first frame, at 140 to 149 kft; then 170 to 205 ft/s down."""
    for seed in SEEDS:
        path = trajectory(Plan(seed=seed, trajectory_rows=2001), 352.0)
        east, north, up = path.position_ft.T
        top = int(up.argmax())
        assert 44.9 <= path.time_s[top] <= 55.1 and 139e3 <= up[top] <= 149e3
        to_north, to_east, down = path.velocity_ft_s.T
        assert 170.0 <= down[-1] <= 205.0 and -10.0 < down[top] < 10.0
        at = int(np.abs(path.time_s - 40.0).argmin())
        assert -20.5e3 < east[at] < 20.5e3 and -20.5e3 < north[at] < 20.5e3
        assert -910.0 < to_east[at] < -490.0 and -510.0 < to_north[at] < 510.0
        assert -40.0 <= to_east[-1] <= -20.0 and -15.0 <= to_north[-1] <= 15.0
        later = int(np.abs(path.time_s - 52.0).argmin())  # 12 s on, 1/e of what is above the wind
        left = (to_east[later] - to_east[-1]) / (to_east[at] - to_east[-1])
        assert 0.35 < left < 0.39
        # gravity near the top: v changes by 32 ft/s a second where tanh is straight
        near = slice(max(top - 6, 0), top + 7)
        slope = np.polyfit(path.time_s[near], down[near], 1)[0]
        assert 31.0 < slope < 33.0


def test_positions_between_the_rows_are_on_straight_lines() -> None:
    path = trajectory(Plan(trajectory_rows=3), 90.0)
    for share in (0.0, 0.25, 1.0):
        time = path.time_s[0] + share * (path.time_s[1] - path.time_s[0])
        expected = (1.0 - share) * path.position_ft[0] + share * path.position_ft[1]
        assert_close("demo position", position_ft(path, np.array([time]))[0], expected)


# The camera


def test_how_the_camera_swings() -> None:
    """Means of 353 to 359, -56 to -48, 275 to 290; 1, .6 and .8 of the swing; in 5 to 9 s."""
    time = 40.0 + np.arange(0.0, 200.0, 0.05)
    for seed in SEEDS:
        for swing in (0.0, 10.0, 20.0):
            mean, camera_deg = camera_swing(Plan(seed=seed, swing_deg=swing), time)
            low, high = np.array([353.0, -56.0, 275.0]), np.array([359.0, -48.0, 290.0])
            assert (mean >= low).all() and (mean <= high).all() and (mean == mean.round()).all()
            away = (camera_deg - mean + 180.0) % 360.0 - 180.0
            most = np.abs(away).max(axis=0)
            bound = swing * np.array([1.0, 0.6, 0.8])
            assert (most <= bound + 0.5).all() and (most >= 0.75 * bound - 0.5).all()
            yaw, pitch, roll = camera_deg.T
            for whole in (yaw, roll):
                assert ((whole >= 0.0) & (whole < 360.0)).all()
            assert ((pitch < -30.0) & (pitch > -75.0)).all()
        crossings = np.sum(np.diff(np.sign(away), axis=0) != 0, axis=0)
        assert (crossings >= 2.0 * 200.0 / 9.0 - 8).all() and (crossings < 200).all()


@pytest.mark.parametrize("angles", [(0.0, 0.0, 0.0), (30.0, -50.0, 20.0), (350.0, -60.0, 280.0)])
def test_the_axes_of_the_camera_by_hand(angles: tuple[float, float, float]) -> None:
    """The optical axis by azimuth and elevation; image x to the left and y up, turned by roll."""
    yaw, pitch, roll = map(radians, angles)
    axis = np.array([cos(pitch) * sin(yaw), cos(pitch) * cos(yaw), sin(pitch)])
    left = np.array([-cos(yaw), sin(yaw), 0.0])
    up = np.cross(axis, -left) * -1.0
    x, y, z = camera_axes(np.array([angles]))[0]
    assert_close("unit rotation", z, axis)
    assert_close("unit rotation", x, cos(roll) * left + sin(roll) * up)
    assert_close("unit rotation", y, cos(roll) * up - sin(roll) * left)
    assert up[2] > 0.0


def test_local_axes_by_hand() -> None:
    east, north, up = local_axes(np.array([-106.0]), np.array([33.0]))
    lon, lat = radians(-106.0), radians(33.0)
    assert_close("unit rotation", east[0], [-sin(lon), cos(lon), 0.0])
    assert_close("unit rotation", up[0], [cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    assert_close("unit rotation", north[0],
                 [-sin(lat) * cos(lon), -sin(lat) * sin(lon), cos(lat)])  # fmt: skip


def test_the_ground_that_an_image_shows_has_that_image() -> None:
    """There and back for points at two heights, and nothing where the line misses the Earth."""
    plan = Plan(seed=2)
    path = trajectory(plan, 60.0)
    seen = view(path, position_ft(path, np.array([45.0])), np.array([[350.0, -50.0, 280.0]]))
    where = np.array([[[3.0, 4.0], [9.0, 2.0], [12.0, 9.5]]])
    heights = np.array([[0.0, 5000.0, 100.0]])
    ground = seen_ground(plan, seen, where, heights)
    radius = np.linalg.norm(ground[0], axis=1)
    assert_close("radius, km", radius - radius[0], (heights[0] - heights[0, 0]) / 3280.8336)
    x, y, z = np.moveaxis((ground[0] - seen.position_km[0]) @ seen.axes[0].T, -1, 0)
    back = np.column_stack([x, y]) / z[:, None] * plan.focal_length_mm
    assert_close("film length", back, (where[0] - [7.235, 5.2285]) * 0.713816400205)
    level = view(path, position_ft(path, np.array([45.0])), np.array([[350.0, 0.0, 0.0]]))
    middle = np.array([[[7.235, 5.2285]]])
    assert np.isnan(seen_ground(plan, level, middle, heights[:, :1])).all()
    _, slope = images(plan, seen, ground)
    point = ground[0, 0]
    toward = seen.position_km[0] - point
    sine = toward @ point / np.linalg.norm(toward) / np.linalg.norm(point)
    assert_close("unit rotation", slope[0, 0], sine)


def test_a_point_behind_the_camera_has_no_image_and_the_centre_has_no_distortion() -> None:
    plan = Plan()
    path = trajectory(plan, 60.0)
    seen = view(path, position_ft(path, np.array([45.0])), np.array([[0.0, -50.0, 0.0]]))
    along = seen.axes[0, 2]
    points = seen.position_km[0] + np.array([[10.0], [-10.0]]) * along
    found, _ = images(plan, seen, points)
    assert_close("film length", found[0, 0], [7.235, 5.2285])
    assert np.isnan(found[0, 1]).all()
    assert (distorted(plan, np.zeros((1, 2))) == 0.0).all()


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_the_distortion_of_an_image_is_that_of_the_table(share: float) -> None:
    """A measured radius plus the table's value there is the straight one."""
    plan = Plan()
    radius, distortion = lens_table(plan)
    assert_close("distortion on cards", distortion, 145.0 * (radius / radius[-1]) ** 1.5)
    path = trajectory(plan, 60.0)
    seen = view(path, position_ft(path, np.array([45.0])), np.array([[0.0, -50.0, 0.0]]))
    x, y, z = seen.axes[0]
    straight_mm = share * radius[-2]
    point = seen.position_km[0] + 9.0 * (z + straight_mm / 10.4 * (0.6 * x - 0.8 * y))
    ((found,),), _ = images(plan, seen, point[None])
    off = (found - [7.235, 5.2285]) * 0.713816400205
    assert_close("unit rotation", off / hypot(*off), [0.6, -0.8])
    measured = hypot(*off)
    added = np.interp(measured, radius, distortion) / 1000.0
    assert_close("film length", measured + added, straight_mm)


def test_readings_are_three_of_each_point_and_each_time_has_other_noise() -> None:
    """Fiducials counter-clockwise from the origin; the noise of every film its own."""
    plan = Plan(frames=2, landmarks=2, noise_in=0.01, frame_in=(10.0, 5.0))
    number, index = np.array([1, 2]), np.array([[3, 7], [3, 9]])
    image = np.array([[[1.0, 2.0], [3.0, 4.0]], [[5.0, 1.0], [7.0, 3.0]]])
    one, again, other = (read_film(plan, number, index, image, time) for time in (0, 0, 1))
    assert one == again and one != other
    assert one.frame.tolist() == [1, 2] and one.landmark.tolist() == index.tolist()
    assert one.present.all() and one.present.shape == (2, 2)
    assert one.fiducial_in.shape == (2, 4, 3, 2) and one.landmark_in.shape == (2, 2, 3, 2)
    corners = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 5.0], [0.0, 5.0]])
    expected = np.broadcast_to(corners[:, None], (2, 4, 3, 2))
    assert_close("reading of large noise", one.fiducial_in, expected)
    expected = np.repeat(image[:, :, None], 3, axis=2)
    assert_close("reading of large noise", one.landmark_in, expected)
    assert len(set(one.fiducial_in.ravel())) > 30
    exact = read_film(Plan(noise_in=0.0, frame_in=(10.0, 5.0)), number, index, image + 0.0004, 0)
    assert (exact.landmark_in == image[:, :, None]).all()
    up = read_film(Plan(noise_in=0.0, frame_in=(10.0, 5.0)), number, index, image + 0.0006, 0)
    assert_close("table value", up.landmark_in, np.repeat(image[:, :, None], 3, axis=2) + 0.001)


def series(latitude_deg: float, four_phi: float) -> float:
    """The program's series, A 56 and A 195, with the sign of its last term as it ran."""
    phi = radians(latitude_deg)
    first = -0.1932398611111 * sin(2 * phi) + four_phi * sin(4 * phi)
    return latitude_deg + first + 7.2222222222e-07 * sin(6 * phi)


def test_the_camera_and_landmarks_stand_where_the_program_has_them() -> None:
    """The origin by the series of A 56, a landmark by that of A 195, which has one zero more."""
    path = trajectory(Plan(), 60.0)
    at = np.array([[0.0, 0.0, 0.0], [3000.0, 2000.0, 9000.0]])
    seen = view(path, at, np.zeros((2, 3)))
    lat, lon = radians(series(33.083333, 0.0003258611111111)), radians(-106.3333)
    up = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    east = np.array([-sin(lon), cos(lon), 0.0])
    north = np.cross(up, east)
    radius = 20925.698e3 / 3280.8336
    assert_close("position of a program", seen.position_km[0], radius * up)
    moved = 0.0003048006 * (3000.0 * east + 2000.0 * north + 9000.0 * up)
    assert_close("position of a program", seen.position_km[1], radius * up + moved)
    assert_close("unit rotation", seen.axes[0], [-east, up, north])  # straight to the north
    lat, lon = radians(series(34.5, 0.0000325861111111)), radians(-106.25)
    up = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    found = landmark_km(np.array([-106.25]), np.array([34.5]), np.array([5000.0]))
    assert_close("position of a program", found[0], (6378.165 + 5000.0 / 3280.8336) * up)


def test_the_camera_and_landmarks_stand_on_wgs_84() -> None:
    """The origin RZ less 20925.698 thousand feet above the ellipsoid, up along its normal."""
    path = trajectory(Plan(), 60.0)
    seen = view(path, np.array([[0.0, 0.0, 9000.0]]), np.zeros((1, 3)), "wgs84")
    marks = landmark_km(np.array([-106.3333]), np.array([33.083333]), np.array([9000.0]), "wgs84")
    lat, lon, square = (
        radians(33.083333),
        radians(-106.3333),
        (2 - 1 / 298.257223563) / 298.257223563,
    )
    normal, height = 6378.137 / sqrt(1 - square * sin(lat) ** 2), 9000.0 / 3280.8336
    across, along = (normal + height) * cos(lat), (normal * (1 - square) + height) * sin(lat)
    where = np.array([across * cos(lon), across * sin(lon), along])
    assert_close("position of a program", seen.position_km[0], where)
    assert_close("position of a program", marks[0], where)
    up = np.array([cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)])
    assert_close("unit rotation", seen.axes[0, 1], up)


@pytest.mark.parametrize("latitude", [-60.0, 0.0, 33.0, 89.0])
def test_geodetic_latitudes_of_which_the_series_gives_a_geocentric_one(latitude: float) -> None:
    found = float(_geodetic(np.array([latitude]))[0])
    assert_close("geocentric latitude", series(found, 0.0000325861111111), latitude)


def test_the_view_of_some_frames() -> None:
    path = trajectory(Plan(), 60.0)
    seen = view(path, path.position_ft[:5], np.tile([[10.0, -50.0, 5.0]], (5, 1)))
    some = seen.only(slice(1, 3))
    assert (some.position_km == seen.position_km[1:3]).all()
    assert (some.axes == seen.axes[1:3]).all() and len(some.axes) == len(some.position_km) == 2
