"""Geocentric latitudes, TGTCAM, times, positions, and group 9 (A 119 to A 217)."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.approved.texts import refused
from tests.kit.jobs import film, reread, without
from tests.tolerances import assert_close
from vopd.errata import fixes
from vopd.job import Job, Landmarks
from vopd.program.ftlup import Tables, outside
from vopd.program.geocentric import LANDMARK_FOUR_PHI, ORIGIN_FOUR_PHI, geocentric
from vopd.program.positions import (
    UndefinedLandmark,
    earth_fixed,
    origin_of,
    time_and_position,
)
from vopd.program.tgtcam import tgtcam
from vopd.program.vopd import run, run_jobs
from vopd.results import Results

RAD = 57.29577951


@pytest.mark.parametrize(
    ("phi", "origin", "landmark"),
    [
        # sin 2PHI, sin 4PHI, sin 6PHI are 0, 0, 0 at the equator
        (0.0, 0.0, 0.0),
        # 1, 0, -1 at 45: 45 - .1932398611111 - .00000072222222222 for both
        (45.0, 44.80675941666668, 44.80675941666668),
        # .5, .8660254037844, 1 at 15: 15 - .09661993055555 + .00000072222222222
        #   + .00028220400... (.0003258611111111 * .8660254037844 = .000282204000)
        #   or + .00002822039... (.0000325861111111 * .8660254037844 = .000028220400)
        (15.0, 14.903662995667, 14.903409012067),
        # -.5, .8660254037844, -1 at 105: 105 + .09661993055555 - .00000072222222222 + the same
        (105.0, 105.096901412333, 105.096647428733),
        (-45.0, -44.80675941666668, -44.80675941666668),
    ],
)
def test_series_by_hand(phi: float, origin: float, landmark: float) -> None:
    """The last term has a plus; the landmarks' sin 4PHI is a tenth of the origin's."""
    assert_close("geocentric latitude", geocentric(phi, ORIGIN_FOUR_PHI), origin)
    assert_close("geocentric latitude", geocentric(phi, LANDMARK_FOUR_PHI), landmark)


def test_the_printed_latitudes() -> None:
    """LAT-GOCN of Appendix H for landmarks 66, 67, 28 and 62, and 66 in case 2."""
    geodetic = np.array(
        [32 + 50 / 60, 32 + 49.75 / 60, 33 + 22.5 / 60, 33 + 15.8 / 60, 32.838333333]
    )
    printed = [f"{latitude:.5f}" for latitude in geocentric(geodetic, LANDMARK_FOUR_PHI)]
    assert printed == ["32.65728", "32.65313", "33.19748", "33.08611", "32.66227"]


def test_other_factor_of_sin_6phi() -> None:
    assert_close("geocentric latitude", geocentric(45.0, 0.0, -1e-3), 45 - 0.1932398611111 + 1e-3)


def test_straight_down() -> None:
    """10 km above an origin on the equator at Greenwich; the landmark is the origin."""
    seen = tgtcam(6378.0, 0.0, 0.0, np.array([[0.0], [0.0], [10.0]]), *at(0.0, 0.0, 6378.0))
    assert_close("direction cosine", np.ravel(seen), (0.0, 0.0, -1.0))


def test_east_and_north() -> None:
    """From the Earth's centre side by side: a camera at 0 N 0 E, landmarks at the height r/cos.

    At longitude 1 degree and radius r/cos 1 the landmark stands due east in the
    camera's own horizon; at latitude 1 due north.
    """
    r = 6378.0 / math.cos(1 / RAD)
    here = np.zeros((3, 1))
    for landmark, axis in (((1.0, 0.0, r), 0), ((0.0, 1.0, r), 1)):
        seen = tgtcam(6378.0, 0.0, 0.0, here, *at(*landmark))
        assert_close("direction cosine", np.ravel(seen), np.eye(3)[axis])


def at(longitude: float, latitude: float, radius: float) -> tuple[np.ndarray, ...]:
    """One landmark as (L, F) arrays: degrees, degrees, km."""
    return np.array([[longitude]]), np.array([[latitude]]), np.array([[radius]])


def level(longitude: float, latitude: float) -> Rotation:
    """Earth-centred axes to east, north, up: about Z by 90 + longitude, X by 90 - latitude."""
    about_z = Rotation.from_rotvec([0.0, 0.0, -(np.pi / 2 + longitude)])
    return Rotation.from_rotvec([-(np.pi / 2 - latitude), 0.0, 0.0]) * about_z


def outward(longitude: float, latitude: float, radius: float) -> np.ndarray:
    """An Earth-centred place: up, seen from the axes that stand there."""
    return radius * level(longitude, latitude).inv().apply([0.0, 0.0, 1.0])


LONGITUDE = st.floats(-180.0, 180.0)
LATITUDE = st.floats(-85.0, 85.0)


@given(LONGITUDE, LATITUDE, st.integers(0, 2**32 - 1))
def test_against_rotations(longitude: float, latitude: float, seed: int) -> None:
    """Three frames of two landmarks each, within 200 km of an origin anywhere."""
    rng = np.random.default_rng(seed)
    rz, origin = 6378.165, (longitude / RAD, latitude / RAD)
    xyz = rng.uniform([-80.0, -80.0, 20.0], [80.0, 80.0, 60.0], (3, 3))
    thj = longitude + rng.uniform(-1.0, 1.0, (2, 3))
    phij = latitude + rng.uniform(-1.0, 1.0, (2, 3))
    rj = rz + rng.uniform(-1.0, 4.0, (2, 3))
    seen = tgtcam(rz, origin[1], origin[0], xyz.T, thj, phij, rj)
    for f in range(3):
        camera = outward(*origin, rz) + level(*origin).inv().apply(xyz[f])
        east_of, north_of = (
            math.atan2(camera[1], camera[0]),
            math.asin(camera[2] / math.hypot(*camera)),
        )
        axes = level(east_of, north_of)  # the camera's own vertical, through the Earth's centre
        for j in range(2):
            away = outward(thj[j, f] / RAD, phij[j, f] / RAD, rj[j, f]) - camera
            wanted = axes.apply(away / math.hypot(*away))
            assert_close("direction cosine", [part[j, f] for part in seen], wanted)


# Times, positions and group 9


NAN, NAME = np.nan, (6, "frame numbers")


@pytest.mark.parametrize(
    ("table", "beyond"),
    [
        ([1.0, 2.0, 4.0], [True, False, False, False, True]),
        ([1.0, 4.0], [True, False, False, False, True]),
        ([1, 4], [True, False, False, False, True]),
        ([2.0], [False] * 5),
        ([-9.0, -8.0], [True] * 5),
    ],
)
def test_what_lies_outside_a_table(table: list[float], beyond: list[bool]) -> None:
    """The ends are inside; a table of one entry has no outside. NaN is nowhere."""
    x = np.array([np.nextafter(1.0, 0.0), 1.0, 3.0, 4.0, np.nextafter(4.0, 9.0)])
    tables = Tables.of(NAME, [(np.array(table), np.zeros(len(table)))])
    assert outside(x, np.zeros(5, int), tables).tolist() == beyond
    assert outside(np.array([NAN]), np.zeros(1, int), tables).tolist() == [False]


def test_each_frame_by_the_table_of_its_job() -> None:
    ends = [np.array([0.0, 1.0]), np.array([5.0]), np.array([1.0, 3.0])]
    tables = Tables.of(NAME, [(table, table) for table in ends])
    found = outside(np.array([1.0, 2.0, 9.0, 0.5, 3.0]), np.array([0, 0, 1, 2, 2]), tables)
    assert found.tolist() == [False, True, False, True, False]


def solved(jobs: list[Job]) -> list[Results]:
    return [one for one in run_jobs(jobs) if isinstance(one, Results)]


def clocked(frames: int, last: int, rate: float) -> Job:
    """Frame 1 at 10 s, and `rate` s a frame up to this last one; 1, 2, 3 ft a second until 12 s."""
    job = film(frames)
    times = np.array([10.0, 10.0 + rate * (last - 1)])
    path = replace(
        job.trajectory,
        time_s=np.array([10.0, 12.0]),
        position_ft=np.array([[0.0, 100.0, 200.0], [2.0, 104.0, 206.0]]),
        velocity_ft_s=np.zeros((2, 3)),
        altitude_ft=np.zeros(2),
    )
    clock = replace(job.clock, frame=np.array([1, last]), time_s=times)
    return replace(job, clock=clock, trajectory=path)


def test_time_and_position_of_each_job() -> None:
    """The time by the number of the frame, the position by that time."""
    jobs = [clocked(3, 2, 0.5), clocked(2, 3, 3.0)]
    one, other = solved(jobs)
    time_s = np.concatenate([one.time_s, other.time_s])
    assert time_s.tolist() == [10.0, 10.5, 11.0, 10.0, 13.0]
    after = time_s - 10.0
    expected = np.stack([after, 100.0 + 2.0 * after, 200.0 + 3.0 * after], axis=1)
    np.testing.assert_array_equal(np.concatenate([one.vehicle_ft, other.vehicle_ft]), expected)
    assert [*one.outside_clock, *other.outside_clock] == [False, False, True, False, False]
    beyond = [*one.outside_trajectory, *other.outside_trajectory]
    assert beyond == [False, False, False, False, True]
    for job, results in zip(jobs, (one, other), strict=True):
        alone = time_and_position(job)
        assert (results.time_s.tolist(), results.vehicle_ft.tolist()) == (
            alone[0].tolist(), alone[1].tolist(),
        )  # fmt: skip


def marked(frames: int, numbers: list[int], height_ft: float, *more: tuple[int, float]) -> Job:
    """Landmarks 11 to 15 on 1E, 2E ... 30 min and 21N, 22N ... 15 min, at this height."""
    job = film(frames)
    readings = reread(job.readings, landmark=np.tile(numbers, (frames, 1)))
    known = np.array([11, 12, 13, 14, 15, *(number for number, _ in more)])
    marks = Landmarks(
        number=known,
        longitude_deg=known - 10.0,
        longitude_min=np.full(len(known), 30.0),
        latitude_deg=known + 10.0,
        latitude_min=np.full(len(known), 15.0),
        altitude_ft=np.array([height_ft] * 5 + [height for _, height in more]),
    )
    return replace(job, readings=readings, landmarks=marks)


def ignoring(job: Job, *asked: tuple[int, int]) -> Job:
    """The job without some landmarks: a frame and a number each (group 11)."""
    cards = np.zeros((len(asked), 6), np.int64)
    cards[:, 0] = [number for _, number in asked]
    frames = np.array([frame for frame, _ in asked], dtype=np.int64)
    return replace(job, ignored=replace(job.ignored, frame=frames, landmark=cards))


def test_the_landmarks_of_each_job_are_its_own() -> None:
    """A number given twice counts as it was given last; what takes no part is NaN."""
    one, other = solved([
        ignoring(marked(1, [15, 11, 13, 12, 14], 3280.8336, (13, 6561.6672)), (1, 14)),
        ignoring(marked(2, [11, 11, 12, 99, 15], 0.0), (1, 99), (2, 99)),
    ])  # fmt: skip
    names = (
        "longitude_deg", "latitude_deg", "altitude_ft", "radius_km", "radius_kft",
        "geocentric_latitude_deg",
    )  # fmt: skip
    longitude, latitude, altitude, radius_km, radius_kft, geocentric = (
        np.concatenate([getattr(results, name).ravel() for results in (one, other)])
        for name in names
    )
    used = np.ones(15, bool)
    used[[4, 8, 13]] = False
    number = np.array([15, 11, 13, 12, NAN, 11, 11, 12, NAN, 15, 11, 11, 12, NAN, 15])
    height_km = np.array([1.0, 1.0, 2.0, 1.0, NAN, *[0.0] * 10])
    height_km[~used] = NAN
    np.testing.assert_array_equal(longitude, number - 9.5)
    np.testing.assert_array_equal(latitude, number + 10.25)
    np.testing.assert_array_equal(altitude, height_km * 3280.8336)
    assert_close("radius, km", radius_km[used], 6378.165 + height_km[used])
    assert_close("radius, km", radius_kft[used], (6378.165 + height_km[used]) * 3.2808336)
    for values in (radius_km, radius_kft, geocentric):
        assert np.isnan(values[~used]).all()
    phi = np.radians(number[used] + 10.25)
    series = -0.1932398611111 * np.sin(2 * phi) + 0.0000325861111111 * np.sin(4 * phi)
    series += 7.2222222222e-07 * np.sin(6 * phi)
    assert_close("geocentric latitude", geocentric[used], number[used] + 10.25 + series)


@pytest.mark.parametrize("number", [1, 10, 16, 99])
def test_an_undefined_landmark_of_any_job(number: int) -> None:
    """Below, above and beyond the numbers of group 9; no matter where it takes no part."""
    good, bad = marked(1, [11, 12, 13, 14, 15], 0.0), marked(2, [11, number, 13, 14, 15], 0.0)
    one, other = solved([good, ignoring(bad, (1, number), (2, number))])
    unknown = np.isnan(one.longitude_deg).sum() + np.isnan(other.longitude_deg).sum()
    assert unknown == 2
    for frame, ignored in ((1, 2), (2, 1)):
        solved_one, caught = run_jobs([good, ignoring(bad, (ignored, number))])
        assert solved_one == one and isinstance(caught, UndefinedLandmark)
        assert (caught.frame, caught.landmark) == (frame, number)


def test_group_9_without_a_card() -> None:
    job = marked(1, [14, 12, 13, 11, 15], 0.0)
    marks = Landmarks(*([np.zeros(0, np.int64)] + [np.zeros(0)] * 5))
    empty = replace(job, landmarks=marks)
    with refused(UndefinedLandmark):
        run(empty)
    assert np.isnan(run(without(empty, 1)).longitude_deg).all()


def test_the_origin_of_a_trajectory() -> None:
    job = film(1)
    path = replace(
        job.trajectory, origin_latitude_deg=1.0, origin_longitude_deg=2.0, origin_radius_kft=3.0
    )
    origin = origin_of(replace(job, trajectory=path))
    assert origin.tolist() == [1.0, 2.0, 3.0]


@pytest.mark.parametrize(("names", "six_phi"), [((), 1.0), (("sin-6phi",), -1.0)])
def test_the_series_of_the_origin_s_latitude(names: tuple[str, ...], six_phi: float) -> None:
    """At 15 degrees sin 2, 4, 6PHI are .5, sqrt(3)/2, 1; the camera is at the origin."""
    origin = np.array([15.0, 0.0, 20925.0])
    camera = earth_fixed(origin, fixes(*names), np.zeros((1, 3)))[0]
    latitude = 15.0 - 0.0966199305556 + 0.0003258611111111 * math.sqrt(3.0) / 2.0
    latitude += six_phi * 7.2222222222e-07
    found = math.atan2(camera[2], camera[0]) * 57.29577951
    assert_close("geocentric latitude", found, latitude)
    assert_close("radius, km", float(np.linalg.norm(camera)), 20925000.0 / 3280.8336)
