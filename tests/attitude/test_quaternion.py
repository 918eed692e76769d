"""Quaternions against scipy's Rotation; places against geometry written apart; columns."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from vopd.attitude.position import place

import vopd
from tests.tolerances import within
from vopd.attitude.input_sigmas import Sigmas
from vopd.attitude.quaternion import angle_between_deg, from_axes, from_yaw_pitch_roll, product
from vopd.attitude.table_columns import FIXED, columns_of, table
from vopd.attitude.uncertainty import ANGLES
from vopd.errata import fixes
from vopd.findings import VopdError
from vopd.program.vopd import run
from vopd.synthetic.plan import Plan
from vopd.synthetic.scene import make

DECKS = Path(__file__).parents[2] / "decks"
anything = st.floats(-720.0, 720.0)
three = st.tuples(anything, anything, anything)


def scalar_first(rotation: Rotation) -> np.ndarray:
    q = np.roll(rotation.as_quat(), 1)
    return -q if q[0] < 0.0 else q


@given(three)
def test_yaw_pitch_roll_as_scipy_has_them(angles: tuple[float, float, float]) -> None:
    mine = from_yaw_pitch_roll(np.array(angles))
    theirs = scalar_first(Rotation.from_euler("ZYX", angles, degrees=True))
    assert mine[0] >= 0.0 and abs(np.linalg.norm(mine) - 1.0) < within("rae element")
    assert min(np.abs(mine - theirs).max(), np.abs(mine + theirs).max()) < within("rae element")


@given(three, three)
def test_product_and_angle_between(one: tuple[float, ...], other: tuple[float, ...]) -> None:
    a, b = (Rotation.from_euler("ZYX", angles, degrees=True) for angles in (one, other))
    p, q = from_yaw_pitch_roll(np.array(one)), from_yaw_pitch_roll(np.array(other))
    both = scalar_first(a * b)
    mine = product(p, q)
    assert min(np.abs(mine - both).max(), np.abs(mine + both).max()) < within("rae element")
    angle = np.degrees((a.inv() * b).magnitude())
    assert abs(float(angle_between_deg(p, q)) - angle) < 1e-6  # an arc sine near a half turn


@given(three)
def test_axes_give_the_quaternion_back(angles: tuple[float, float, float]) -> None:
    """Rows are the body's axes in the outer frame; half turns have a trace of -1."""
    axes = Rotation.from_euler("ZYX", angles, degrees=True).as_matrix().T
    mine, straight = from_axes(axes), from_yaw_pitch_roll(np.array(angles))
    near = min(np.abs(mine - straight).max(), np.abs(mine + straight).max())
    assert near < within("rae element")


def test_half_turns_and_nothing() -> None:
    for axis in np.eye(3):
        half = Rotation.from_rotvec(np.pi * axis).as_matrix().T
        assert np.abs(np.abs(from_axes(half)[1:]) - axis).max() < within("rae element")
    assert np.isnan(from_axes(np.full((2, 3, 3), np.nan))).all()
    assert np.isnan(from_yaw_pitch_roll(np.full((2, 3), np.nan))).all()


# Places


def ecef_km(latitude_deg: float, longitude_deg: float, height_km: float) -> np.ndarray:
    """WGS 84 by its textbook formula."""
    a, f = 6378.137, 1 / 298.257223563
    e2 = f * (2 - f)
    s, c = np.sin(np.radians(latitude_deg)), np.cos(np.radians(latitude_deg))
    n = a / np.sqrt(1 - e2 * s * s)
    t = np.radians(longitude_deg)
    across = (n + height_km) * c
    return np.array([across * np.cos(t), across * np.sin(t), (n * (1 - e2) + height_km) * s])


def test_a_flight_above_its_origin_is_there() -> None:
    """Group 8's latitude and longitude come back on either Earth.

    On that of 1974 up leans by the .1765 degree between geodetic and geocentric
    latitude: 44 km up is 134 m south.
    """
    (job,) = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")
    path = job.trajectory
    above = replace(job, trajectory=replace(path, position_ft=path.position_ft * [0.0, 0.0, 1.0]))
    for names, south_m in (((), 134.4), (("earth",), 0.0)):
        found = place(run(above, fixes(*names)))
        off_m = (path.origin_latitude_deg - found.latitude_deg[0]) * 110_900
        assert abs(off_m - south_m) < 3.0
        assert abs(found.longitude_deg[0] - path.origin_longitude_deg) < 1e-8  # RAD has ten digits


def test_places_by_a_flat_step_from_the_origin() -> None:
    """With the ellipsoid: origin, and feet east, north, up of it, by textbook geometry."""
    (job,) = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")
    results = run(job, fixes("earth", "feet-per-km"))
    path = job.trajectory
    phi, theta = np.radians([path.origin_latitude_deg, path.origin_longitude_deg])
    sp, cp, st_, ct = np.sin(phi), np.cos(phi), np.sin(theta), np.cos(theta)
    axes = np.array([[-st_, ct, 0.0], [-sp * ct, -sp * st_, cp], [cp * ct, cp * st_, sp]])
    origin = ecef_km(path.origin_latitude_deg, path.origin_longitude_deg, 0.0)
    camera = origin + results.vehicle_ft[0] / 3280.8336 @ axes
    found = place(results)
    height = np.linalg.norm(camera) - np.linalg.norm(
        ecef_km(found.latitude_deg[0], found.longitude_deg[0], 0.0)
    )
    back = ecef_km(found.latitude_deg[0], found.longitude_deg[0], float(height))
    assert np.linalg.norm(np.cross(back, camera)) / np.linalg.norm(camera) < 0.002  # 2 m
    north, east, down = found.north_east_down[0]
    assert np.abs(np.cross(north, east) - down).max() < within("rae element")
    assert abs(down @ axes[2] + 1.0) < 1e-4 and north[2] > 0.0 and abs(east[2]) < 1e-15


def test_down_is_the_earth_s_centre_in_1974_and_the_normal_with_the_fix() -> None:
    (job,) = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")
    plain, fixed = place(run(job)), place(run(job, fixes("earth")))
    apart = np.degrees(np.arccos(plain.north_east_down[0, 2] @ fixed.north_east_down[0, 2]))
    assert 0.17 < apart < 0.19  # geodetic less geocentric latitude at 33 degrees north
    assert abs(plain.latitude_deg[0] - fixed.latitude_deg[0]) < 0.002


def test_the_demo_s_places() -> None:
    jobs, _ = make(Plan(frames=5, seed=1))
    found = place(run(jobs[0]))
    path = jobs[0].trajectory
    metres = 0.3048 * run(jobs[0]).vehicle_ft
    north = (found.latitude_deg - path.origin_latitude_deg) * 110_900  # a degree at 33 north
    leans = np.radians(0.1765) * metres[:, 2]  # up, as above
    assert np.abs(north - metres[:, 1] + leans).max() < 25.0  # of 2.3 km by a flat step


# Columns


def test_units_are_part_of_the_names() -> None:
    endings = {"deg": "_deg", "s": "_s", "ft": "_ft", "ft/s": "_ft_s", "mm": "_mm", "rad": "_rad"}
    for column in FIXED:
        assert column.unit == "" or column.name.endswith(endings[column.unit]), column
        assert column.meaning


def test_a_row_a_frame_of_all_jobs() -> None:
    made = vopd.run(vopd.read_deck(DECKS / "appendix_h" / "cases_1_2_3.dat")).histories()
    values = table(made)
    assert {len(column) for column in values.values()} == {3}
    assert list(values) == [column.name for column in columns_of(made)]
    yaw = [h.results.vehicle_deg[0, 0] for h in made]
    assert values["vehicle_yaw_deg"].tolist() == yaw
    assert values["job"].tolist() == [1, 2, 3] and values["landmarks"].tolist() == [3, 2, 2]


def test_how_frames_ended() -> None:
    words = {}
    for name in ("ignored", "zero_residuals", "vanished", "wind_out_of_order"):
        run_of = vopd.run(vopd.read_deck(DECKS / "regression" / f"{name}.dat"))
        words[name] = {word for h in run_of.histories() for word in h.status}
    assert words["ignored"] == {"ignored", "solved"}
    assert "exact" in words["zero_residuals"] and "exact" in words["vanished"]
    assert words["wind_out_of_order"] == {"stopped"}


def test_shares_stand_apart_and_only_those_asked_for() -> None:
    jobs = vopd.read_deck(DECKS / "appendix_h" / "case1.dat")
    plain = table(vopd.run(jobs).histories())
    more = table(vopd.run(jobs).histories(Sigmas(focal_mm=0.01)))
    added = {f"sigma_focal_{angle}_deg" for angle in ANGLES}
    assert set(more) - set(plain) == added
    assert {f"sigma_centre_{angle}_deg" for angle in ANGLES} <= set(plain)


@pytest.mark.parametrize("value", [-1.0, float("nan"), float("inf")])
@pytest.mark.parametrize("name", ["reading_mm", "landmark_ft", "position_ft", "focal_mm", "time_s"])
def test_what_is_no_standard_deviation(name: str, value: float) -> None:
    with pytest.raises(VopdError, match=f"{name.split('_')[0]} sigma.*no standard deviation"):
        Sigmas(**{name: value})
