"""Angles relative to the geodetic or the geocentric vertical, against rotations by scipy."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.approved.texts import assert_approved, refused
from tests.kit import estimates, wgs84_film
from tests.kit.command import CASE_1, vopd
from tests.kit.estimates import estimate, position
from tests.kit.jobs import case
from tests.kit.spherical_film import turn
from tests.kit.wgs84_film import camera_matrix
from tests.tolerances import assert_close, within
from vopd.arrays import Floats
from vopd.attitude.conventions import conventions
from vopd.attitude.history import history
from vopd.attitude.vertical import lean_deg, with_vertical
from vopd.errata import fixes
from vopd.estimate import Estimate, Vertical
from vopd.export.ccsds import timed_attitude
from vopd.export.viewers import earth_fixed
from vopd.film import film_estimate
from vopd.findings import VopdError
from vopd.pipeline import run
from vopd.program.vopd import run as solve

NED = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
PLACE = (33.08, -106.33)


def body_in_space(one: Estimate, latitude_deg: Floats) -> list[Floats]:
    """The vehicle's axes as columns, Earth-fixed, if its angles refer to these latitudes' axes."""
    return [
        (NED @ turn(longitude, latitude)).T
        @ Rotation.from_euler("ZYX", angles, degrees=True).as_matrix()
        for angles, longitude, latitude in zip(
            one.vehicle_deg, one.position.longitude_deg, latitude_deg, strict=True
        )
    ]


def camera_in_space(one: Estimate, latitude_deg: Floats) -> list[Floats]:
    """The camera's axes as rows, Earth-fixed, by the meaning of its angles."""
    return [
        wgs84_film.camera_matrix(*angles) @ turn(longitude, latitude)
        for angles, longitude, latitude in zip(
            one.camera_deg, one.position.longitude_deg, latitude_deg, strict=True
        )
    ]


def of_1974() -> Estimate:
    return film_estimate(solve(wgs84_film.film(*PLACE, decimals=3)[0]))


def of_wgs84() -> Estimate:
    return film_estimate(solve(wgs84_film.film(*PLACE, decimals=3)[0], fixes("all")))


def test_the_attitude_in_space_stays_and_the_angles_move() -> None:
    for one, other in ((of_1974(), "geodetic"), (of_wgs84(), "geocentric")):
        here = one.position
        latitudes = [here.geocentric_latitude_deg, here.latitude_deg]
        old, new = latitudes if other == "geodetic" else latitudes[::-1]
        moved = with_vertical(one, other)
        for axes in (body_in_space, camera_in_space):
            assert_close("attitude in space", np.array(axes(moved, new)), np.array(axes(one, old)))
        apart = np.abs(moved.vehicle_deg - one.vehicle_deg)[:, 1]
        assert (apart > 0.1).all()  # the camera looks north, and the verticals lean that way


def test_the_two_verticals_are_those_of_the_latitudes() -> None:
    """The angle between them over case 1, 44 km up, on the ellipsoid of the program's series."""
    one = film_estimate(solve(case(1)))
    down = with_vertical(one, "geodetic").position.north_east_down[0, 2]
    lean = np.degrees(np.arccos(down @ one.position.north_east_down[0, 2]))
    latitude, height_m = one.position.latitude_deg[0], one.position.altitude[0] * 0.3048
    place = wgs84_film.ecef(latitude, -106.4, height_m, 6378388.0, 1 / 297)
    centre = np.degrees(np.arctan2(place[2], np.hypot(place[0], place[1])))
    assert abs(lean - (latitude - centre)) < within("lean of the vertical")


def test_there_and_back_is_where_it_was() -> None:
    one = of_1974()
    back = with_vertical(with_vertical(one, "geodetic"), "geocentric")
    for name in ("camera_deg", "vehicle_deg", "slip_effect_deg"):
        assert_close("angle there and back", getattr(back, name), getattr(one, name))
    assert_close("ratio by steps", back.gain / one.gain, 1.0)
    assert_close("attitude in space", back.direction, one.direction)


def test_its_own_vertical_changes_no_bit() -> None:
    old, new = of_1974(), of_wgs84()
    assert with_vertical(old, None) is old and with_vertical(old, "geocentric") is old
    assert with_vertical(new, "geodetic") is new
    assert (old.position.vertical, new.position.vertical) == (
        Vertical.GEOCENTRIC,
        Vertical.GEODETIC,
    )


def test_derivatives_follow_the_angles() -> None:
    """By small changes of the camera's angles, each expressed anew."""
    one = of_1974()
    moved = with_vertical(one, "geodetic")
    step = 1e-4
    by_old = np.zeros((len(one.frame), 3, 3))
    for k in range(3):
        ends = []
        for sign in (1.0, -1.0):
            camera = one.camera_deg + sign * step * np.eye(3)[k]
            vehicle = one.vehicle_deg + sign * step * one.vehicle_by_camera[:, :, k]
            bent = replace(one, camera_deg=camera, vehicle_deg=vehicle)
            ends.append(with_vertical(bent, "geodetic"))
        by_old[:, :, k] = (ends[0].camera_deg - ends[1].camera_deg) / (2.0 * step)
        vehicle_by_old = (ends[0].vehicle_deg - ends[1].vehicle_deg) / (2.0 * step)
        chained = (moved.vehicle_by_camera @ by_old[:, :, k : k + 1])[..., 0]
        assert_close("derivative by steps", vehicle_by_old, chained)
        attack = (moved.responses.attack_by_camera @ by_old[:, :, k : k + 1])[..., 0]
        assert_close("derivative by steps", attack, one.responses.attack_by_camera[:, :, k])
    assert_close("ratio by steps", (by_old @ one.gain) / moved.gain, 1.0)
    size = np.abs(one.partials).max()
    assert_close("derivative by steps", moved.partials @ by_old / size, one.partials / size)


def test_the_effect_of_the_errata_is_a_turn_of_the_vehicle_that_no_label_changes() -> None:
    """The rotation from the run to the run with all fixes is as large in either axes."""
    one = of_1974()
    moved = with_vertical(one, "geodetic")
    sizes = []
    for each in (one, moved):
        effect = each.slip_effect_deg
        assert effect is not None
        before = Rotation.from_euler("ZYX", each.vehicle_deg, degrees=True)
        after = Rotation.from_euler("ZYX", each.vehicle_deg + effect[:, 3:6], degrees=True)
        sizes.append(np.degrees((before.inv() * after).magnitude()))
    assert_close("angle there and back", sizes[1], sizes[0])
    lean = one.position.latitude_deg - one.position.geocentric_latitude_deg
    assert sizes[0].max() < lean.min() / 3.0  # which is .176 degree


def test_a_pitch_beyond_90_degrees_stays_beyond_it() -> None:
    start = np.array([[15.269995, 218.653492 - 360.0, 105.837006]])
    (one,) = run(case(1), start_deg=start).histories()
    (moved,) = run(case(1), start_deg=start).histories(vertical="geodetic")
    old, new = one.estimate.camera_deg[0], moved.estimate.camera_deg[0]
    assert old[1] < -90.0 and new[1] < -90.0
    plain = with_vertical(film_estimate(solve(case(1))), "geodetic").camera_deg[0]
    found, same = wgs84_film.camera_matrix(*new), wgs84_film.camera_matrix(*plain)
    assert np.abs(found - same).max() < within("axis by printed angles")


def test_a_flight_relative_to_the_geocentric_vertical() -> None:
    """Made by hand above Bern: a level flight north is nose down by the lean of the vertical."""
    level = estimates.estimate(np.zeros((2, 3)))  # its geocentric latitude is .19 degree less
    moved = with_vertical(level, "geocentric")
    for angles in (moved.vehicle_deg, moved.camera_deg):
        short = (angles + 180.0) % 360.0 - 180.0
        assert_close("wrapped angle", short, [[0.0, -0.19, 0.0]] * 2)
    said = conventions([history(moved)])
    assert_approved(said["from frame"])
    assert_approved(said["vertical"])


def test_frames_without_angles_stay_without() -> None:
    angles = np.array([[10.0, -40.0, 5.0], [np.nan] * 3])
    one = estimates.estimate(np.zeros((2, 3)), camera_deg=angles, vehicle_deg=angles)
    moved = with_vertical(one, "geocentric")
    assert np.isnan(moved.vehicle_deg[1]).all() and np.isfinite(moved.vehicle_deg[0]).all()


def test_the_orientation_of_viewers_is_the_same() -> None:
    """CZML's quaternion is Earth-fixed, and so it knows nothing of the vertical."""
    both = [
        earth_fixed(timed_attitude(history(with_vertical(of_1974(), name)), None, print))
        for name in (None, "geodetic")
    ]
    assert_close("attitude in space", both[1], both[0])


def test_only_these_two_are_known() -> None:
    with refused(VopdError):
        run(case(1)).histories(vertical="plumb")
    assert run(case(1)).to_dataframe(vertical="geodetic")["vehicle_pitch_deg"][0] != -38.653492
    done = vopd("attitude", CASE_1, "--vertical", "up")
    assert done.status == 2 and "'up' is not one of 'geodetic', 'geocentric'" in done.stderr


def lines(*options: str) -> list[str]:
    done = vopd("attitude", CASE_1, "--format", "jsonl", *options)
    assert done.status == 0, done.stderr
    return done.stdout.splitlines()


def test_every_file_says_which_vertical() -> None:
    plain, same, other = (
        lines(*o) for o in ((), ("--vertical", "geocentric"), ("--vertical", "geodetic"))
    )
    assert plain == same and plain[1] != other[1]
    said = [json.loads(text[0])["conventions"] for text in (plain, other)]
    assert [one["vertical"].split(";")[0] for one in said] == ["geocentric", "geodetic"]
    for one in said:
        assert_approved(one["vertical"])
    assert_approved(said[0]["from frame"])
    assert_approved(said[1]["from frame"])


@pytest.mark.usefixtures("no_figures")
def test_the_report_takes_it(tmp_path: Path) -> None:
    pages = []
    for vertical in ("geocentric", "geodetic"):
        done = vopd("report", CASE_1, "-o", tmp_path / "one.html", "--vertical", vertical)
        assert done.status == 0, done.stderr
        pages.append((tmp_path / "one.html").read_text())
    assert ["-38.653" in page for page in pages] == [True, False]


@pytest.mark.usefixtures("not_laid_out")
def test_the_figures_take_it(tmp_path: Path) -> None:
    made = []
    for vertical in ("geocentric", "geodetic"):
        out = tmp_path / "one.svg"
        done = vopd("plot", CASE_1, "--figure", "attitude", "-o", out, "--vertical", vertical)
        assert done.status == 0, done.stderr
        made.append(out.read_text())
    assert made[0] != made[1]


# What stays in space when angles are expressed by the other vertical, for any attitude


CAMERA = np.array([[30.0, -60.0, 20.0], [200.0, 110.0, 15.0], [10.0, -170.0, 340.0]])
VEHICLE = np.array([[10.0, 120.0, 40.0], [300.0, -100.0, 200.0], [77.0, 12.0, 3.0]])


def made() -> Estimate:
    effect = np.random.default_rng(3).normal(0.0, 0.05, (3, 9))
    return estimate(CAMERA, vehicle_deg=VEHICLE, slip_effect_deg=effect)


def enu(one: Estimate) -> Floats:
    """East, north, up as rows, Earth-fixed."""
    north, east, down = np.moveaxis(one.position.north_east_down, 1, 0)
    return np.stack([east, north, -down], axis=1)


def in_space(one: Estimate, more: Floats | float = 0.0) -> tuple[Floats, Floats]:
    """The camera's axes as rows and the vehicle's as columns, Earth-fixed."""
    effect = np.zeros((3, 9)) + more
    camera = [camera_matrix(*angles) for angles in one.camera_deg + effect[:, :3]]
    vehicle = Rotation.from_euler("ZYX", one.vehicle_deg + effect[:, 3:6], degrees=True)
    ned = one.position.north_east_down.swapaxes(1, 2)
    return np.array(camera) @ enu(one), ned @ vehicle.as_matrix()


@pytest.mark.parametrize("there", [False, True])
def test_directions_and_attitudes_in_space_stay(there: bool) -> None:
    """And a pitch beyond 90 degrees, of camera and vehicle, stays beyond it."""
    old = made()
    new = with_vertical(old, "geocentric")
    if there:
        new = with_vertical(new, "geodetic")
    assert_close("attitude in space", new.direction @ enu(new), old.direction @ enu(old))
    for ours, theirs in zip(in_space(new), in_space(old), strict=True):
        assert_close("attitude in space", ours, theirs)
    for name in ("camera_deg", "vehicle_deg"):
        before, after = getattr(old, name), getattr(new, name)
        assert (np.cos(np.radians(before[:, 1])) * np.cos(np.radians(after[:, 1])) > 0.0).all()
        assert ((after[:, 1] >= -180.0) & (after[:, 1] <= 180.0)).all()
        assert ((after[:, ::2] >= 0.0) & (after[:, ::2] < 360.0)).all()
    for name in ("residual", "image", "attack_deg", "time_s", "used", "relative_sigma"):
        assert getattr(new, name) is getattr(old, name)


def test_what_the_errata_change_is_the_same_turn_in_space() -> None:
    old = made()
    new = with_vertical(old, "geocentric")
    assert old.slip_effect_deg is not None and new.slip_effect_deg is not None
    for ours, theirs in zip(
        in_space(new, new.slip_effect_deg), in_space(old, old.slip_effect_deg), strict=True
    ):
        assert_close("attitude in space", ours, theirs)
    assert np.array_equal(new.slip_effect_deg[:, 6:], old.slip_effect_deg[:, 6:])
    assert ((new.slip_effect_deg >= -180.0) & (new.slip_effect_deg <= 180.0)).all()


def test_the_lean_has_no_sign() -> None:
    place = replace(
        position(2),
        latitude_deg=np.array([40.0, -40.0]),
        geocentric_latitude_deg=np.array([39.8, -39.8]),
    )
    assert_close("table value", lean_deg(place), [0.2, 0.2])


def test_an_angle_that_passes_north_changes_by_little() -> None:
    """A yaw of 359.99 and one of 0.01 are .02 apart."""
    old = replace(made(), camera_deg=np.array([[359.999, -60.0, 0.001]] * 3))
    new = with_vertical(old, "geocentric")
    assert new.slip_effect_deg is not None
    assert not new.slip_effect_deg[:, :3].round().any()
