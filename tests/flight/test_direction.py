"""Direction of a point in a frame: by hand, and its errors by differences of solves."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import t

import vopd
from tests.approved.texts import assert_approved, refused
from tests.kit.clicked_flights import clicked_flight
from tests.kit.flight_project import write_project as write_flight_project
from tests.kit.joint_flights import axes
from tests.tolerances import assert_close
from vopd.arrays import Floats
from vopd.cli.new import write_project
from vopd.findings import VopdError
from vopd.flight.adjust.adjustment import adjust
from vopd.flight.adjust.project import adjusted_project
from vopd.flight.flight import Flight, Shutter
from vopd.flight.project.keys import read_project
from vopd.flight.result import solve_flight_read

HILL = "examples/hill/flight.toml"
AT = (100.0, 900.0)  # near a corner of 1920 by 1080
SIGMA = {"focal": 5.0, "centre_u": 2.0, "centre_v": 2.0, "k1": 0.01}


@cache
def hill(*free: str) -> Flight:
    """Exact positions and landmarks; a lens whose errors are stated, some of them solved for."""
    flight = vopd.solve_flight(HILL).read
    return replace(flight, options=replace(flight.options, parameter_sigma=SIGMA, free=free))


def changed(flight: Flight, name: str, by: float) -> Flight:
    """The same flight with another lens."""
    lens = flight.lens
    focal, centre, k = lens.focal_px.copy(), lens.centre_px.copy(), lens.k.copy()
    if name == "focal":
        focal *= 1.0 + by / focal.mean()
    elif name == "k1":
        k[0] += by
    else:
        centre[int(name == "centre_v")] += by
    return replace(flight, lens=replace(lens, focal_px=focal, centre_px=centre, k=k))


def picked(flight: Flight, pick: int, axis: int, by: float) -> Flight:
    """The same flight with one pick elsewhere."""
    pixel = flight.picks.pixel.copy()
    pixel[pick, axis] += by
    return replace(flight, picks=replace(flight.picks, pixel=pixel))


def shift(flight: Flight, change: Any, step: float, *of: Any) -> Floats:
    """How a change moves the direction, solve by solve: right and up, degrees a unit (2,)."""
    ends = [
        solve_flight_read(change(flight, *of, side * step)).direction(0, *AT)
        for side in (1.0, -1.0)
    ]
    up = ends[0].elevation_deg - ends[1].elevation_deg
    right = (ends[0].azimuth_deg - ends[1].azimuth_deg) * np.cos(np.radians(ends[0].elevation_deg))
    return np.array([right, up]) / (2.0 * step)


def test_the_middle_of_the_lens_is_where_the_camera_looks() -> None:
    result = vopd.solve_flight(HILL)
    u, v = result.flight.lens.centre_px
    for frame in (0, 4):
        found = result.direction(frame, u, v)
        assert_close("flight angle", found.azimuth_deg, result.camera_deg[frame, 0])
        assert_close("flight angle", found.elevation_deg, result.camera_deg[frame, 1])


def test_a_landmark_is_seen_where_it_stands(tmp_path: Path) -> None:
    """Of exact picks through a lens with distortion; by axes of the tests, refraction apart."""
    result = vopd.solve_flight(write_flight_project(tmp_path))
    flight = result.flight
    for pick in (0, 5, len(flight.picks.frame) - 1):
        frame, mark = int(flight.picks.frame[pick]), int(flight.picks.landmark[pick])
        camera = flight.path.position_m[frame]
        east, north, up = axes(camera) @ (flight.landmarks.position_m[mark] - camera)
        found = result.direction(frame, *flight.picks.pixel[pick])
        expected = [np.degrees(np.arctan2(east, north)) % 360.0,
                    np.degrees(np.arctan2(up, np.hypot(east, north)))]  # fmt: skip
        assert_close(
            "direction but for refraction", [found.azimuth_deg, found.elevation_deg], expected
        )


def test_errors_of_the_lens_turn_the_frame_too() -> None:
    flight = hill()
    components = solve_flight_read(flight).direction(0, *AT).components
    by = {name: shift(flight, changed, 0.1 * one, name) * one for name, one in SIGMA.items()}
    centre = np.hypot(by["centre_u"], by["centre_v"])
    for name, expected in (("focal", by["focal"]), ("principal_point", centre),
                           ("distortion", by["k1"])):  # fmt: skip
        ratio = components[name] / np.abs(expected)
        assert_close("direction by differences", ratio, np.ones(2))
    assert set(components) == {"reading", "focal", "principal_point", "distortion", "pick"}


@pytest.mark.parametrize("free", [(), ("focal", "k1")])
def test_errors_of_picks(free: tuple[str, ...]) -> None:
    """Of all frames where parameters of the lens are solved for with them, under no prior."""
    flight = hill(*free)
    flight = replace(flight, options=replace(flight.options, parameter_sigma={}))
    result = solve_flight_read(flight)
    picks = np.flatnonzero((flight.picks.frame == 0) | bool(free))
    moves = [shift(flight, picked, 0.02, pick, axis) for pick in picks.tolist() for axis in (0, 1)]
    reading = result.estimates.reading
    assert reading is not None
    expected = reading.sigma * np.sqrt((np.array(moves) ** 2).sum(axis=0))
    found = result.direction(0, *AT)
    ratio = found.components["reading"] / expected
    assert_close("direction by differences", ratio, np.ones(2))
    # both are known by the residuals alone
    student = found.half_width_95 / found.total
    assert_close("direction by differences", student, np.full(2, t.ppf(0.975, reading.freedom)))
    stated = result.direction(0, *AT, sigma_px=2.0 * reading.sigma)
    assert (stated.half_width_95 / stated.total < 0.99 * student).all()
    assert_close("direction by differences", stated.components["pick"] / found.components["pick"],
                 np.full(2, 2.0))  # fmt: skip


def test_totals_are_of_the_components_and_azimuths_wider_toward_the_zenith() -> None:
    found = solve_flight_read(hill()).direction("1", *AT)
    squares = sum(one**2 for one in found.components.values())
    assert_close("covariance of a mean", np.diag(found.covariance_deg2), squares)
    wider = np.array([np.cos(np.radians(found.elevation_deg)), 1.0])
    assert_close("covariance of a mean", (found.total * wider) ** 2, squares)
    assert (found.half_width_95 > 1.95 * found.total).all()
    assert_approved(str(replace(found, azimuth_deg=359.996, half_width_95=np.array([0.02, 0.01]),
                                elevation_deg=-3.0)))  # fmt: skip


def test_north_is_no_full_turn() -> None:
    found = solve_flight_read(hill()).direction(0, *AT)
    for azimuth_deg, shown in ((359.99999, "0."), (359.4, "359."), (0.0, "0.")):
        north = replace(found, azimuth_deg=azimuth_deg, half_width_95=np.array([0.02, 0.02]))
        assert f"azimuth {shown}" in str(north)


def test_an_adjusted_project_is_as_sure_as_the_solve_that_adjusted_it(tmp_path: Path) -> None:
    """Held at what the picks gave, a lens moves frame and ray together by its covariance."""
    joint = adjust(HILL, ["focal", "k1"])
    write_project(tmp_path / "new", adjusted_project(read_project(HILL), joint, tmp_path / "new"))
    again = vopd.solve_flight(tmp_path / "new").direction(0, *AT)
    found = joint.result.direction(0, *AT)
    assert_close("flight angle", [again.azimuth_deg, again.elevation_deg],
                 [found.azimuth_deg, found.elevation_deg])  # fmt: skip
    assert_close("direction by differences", again.total / found.total, np.ones(2))


def test_a_point_of_a_tracked_flight_is_clicked_and_not_matched() -> None:
    """Clicks are good to .5 px, all but one; matches to .08."""
    made = clicked_flight(np.random.default_rng(2), frames=12, every=6, apart=0, reach=12)
    picks, clicks = made.flight.picks, made.flight.picks.clicks
    assert clicks is not None and (clicks.sigma_px == 0.5).all()
    clicks = replace(clicks, sigma_px=np.where(np.arange(len(clicks.sigma_px)) > 0, 0.5, 2.0))
    result = solve_flight_read(replace(made.flight, picks=replace(picks, clicks=clicks)))
    usual, stated = (result.direction(3, 900.0, 700.0, one) for one in (None, 0.5))
    assert_close("direction by differences", usual.components["pick"] / stated.components["pick"],
                 np.ones(2))  # fmt: skip


WRONG: dict[str, tuple[Any, ...]] = {
    "no frame": (9, 1.0, 1.0), "outside": (0, -3.0, 10.0), "words": (0, "a", 1.0),
    "no sigma": (0, 1.0, 1.0, -1.0), "two points": (0, [1.0, 2.0], [3.0, 4.0]),
}  # fmt: skip


@pytest.mark.parametrize("what", WRONG)
def test_what_has_no_direction(what: str) -> None:
    with refused(VopdError):
        vopd.solve_flight(HILL).direction(*WRONG[what])


@pytest.mark.parametrize("beyond_px", [-3.0, -0.4, 0.4])
def test_no_direction_at_the_end_of_the_lens_s_field(beyond_px: float) -> None:
    """Half a pixel before it the sigma was NaN: k1 = -.3 ends at (2/3) .9^-.5 focal lengths."""
    flight = hill()
    k = np.array([-0.3, *[0.0] * 11])
    lens = replace(
        flight.lens, focal_px=np.full(2, 1250.0), centre_px=np.array([959.5, 539.5]), k=k
    )
    flight = replace(flight, lens=lens)
    end_px = 959.5 + 1250.0 * 2.0 / 3.0 / np.sqrt(0.9)
    result = solve_flight_read(flight)
    if beyond_px < -0.5:
        assert np.isfinite(result.direction(0, end_px + beyond_px, 539.5).total).all()
        return
    with refused(VopdError):
        result.direction(0, end_px + beyond_px, 539.5)


def test_no_direction_without_an_attitude_or_at_a_row_of_another_time() -> None:
    flight = hill()
    landmark = flight.picks.landmark.copy()
    landmark[flight.picks.frame == 0] = 0
    alone = replace(flight.picks, landmark=landmark)
    with refused(VopdError):
        solve_flight_read(replace(flight, picks=alone)).direction(0, *AT)
    rolling = replace(flight, shutter=Shutter(0.016, "down", False))
    with refused(VopdError):
        solve_flight_read(rolling).direction(0, *AT)
