"""The trajectory of a synthetic flight over New Mexico: past its highest point, by parachute."""

from __future__ import annotations

import numpy as np

from vopd.arrays import Floats, Ints
from vopd.job import Clock, Trajectory, Wind
from vopd.synthetic.plan import Plan, RandomPart, random_stream

ORIGIN_LATITUDE_DEG = 33.083333  # the origin of the report's case 1
ORIGIN_LONGITUDE_DEG = -106.3333
ORIGIN_RADIUS_KFT = 20925.698
GRAVITY_FT_S2 = 32.0
LAST_FRAME = 9_999  # four columns
FRAME_RATE = 32.0  # frames a second
FIRST_TIME_S = 40.0  # flight time of frame 0
MARGIN_S = 1.0  # of the trajectory table, on either side of the film
SHORTEST_S = 47.0  # film that the trajectory table has room for, at least
SLOWING_S = 12.0  # in which the speed over the ground falls to 1/e


def frame_numbers(plan: Plan) -> Ints:
    """Frame numbers in the order of reading (F,): from 1 to 9,999, then from 1 again."""
    return 1 + np.arange(plan.frames, dtype=np.int64) % LAST_FRAME


def clock(plan: Plan) -> Clock:
    """The time table of group 6: two rows, before the first frame and after the last."""
    frame = np.array([0, min(plan.frames, LAST_FRAME) + 1], dtype=np.int64)
    return Clock(frame, FIRST_TIME_S + frame / FRAME_RATE)


def trajectory(plan: Plan, until_s: float) -> Trajectory:
    """The trajectory of group 7, from before the first frame to after `until_s`.

    Numbers are rounded as the cards have them. The vehicle coasts over the top
    and sinks towards its speed v under the parachute, height =
    top - v tau ln cosh((t - t_top) / tau) with tau = v / g; its speed over the
    ground falls to the wind's. Altitudes are those of a sphere.
    """
    random = random_stream(plan, RandomPart.PATH)
    until_s = max(until_s, FIRST_TIME_S + SHORTEST_S)
    t = np.linspace(FIRST_TIME_S - MARGIN_S, until_s + MARGIN_S, plan.trajectory_rows)
    t = np.round(t, 4)
    sink, top = random.uniform(170.0, 205.0), random.uniform(140e3, 149e3)
    tau = sink / GRAVITY_FT_S2
    since_top = (t - FIRST_TIME_S - random.uniform(5.0, 15.0)) / tau
    up = top - sink * tau * np.log(np.cosh(since_top))
    sink_speed = sink * np.tanh(since_top)

    start = random.uniform([-20e3, -20e3], [20e3, 20e3])  # east, north
    launch = random.uniform([-900.0, -500.0], [-500.0, 500.0])
    drift = random.uniform([-40.0, -15.0], [-20.0, 15.0])
    flown = (t - FIRST_TIME_S)[:, None]
    left = np.exp(-flown / SLOWING_S)
    ground = start + drift * flown + (launch - drift) * SLOWING_S * (1.0 - left)
    ground_speed = drift + (launch - drift) * left

    position = np.column_stack([ground, up]).round(2)
    velocity = np.column_stack([ground_speed[:, ::-1], sink_speed]).round(3)
    sea_level = ORIGIN_RADIUS_KFT * 1000.0
    from_centre = np.linalg.norm(position + np.array([0.0, 0.0, sea_level]), axis=1)
    return Trajectory(
        time_s=t,
        position_ft=position,
        velocity_ft_s=velocity + 0.0,  # no minus zero
        altitude_ft=np.round(from_centre - sea_level, 1),
        origin_latitude_deg=ORIGIN_LATITUDE_DEG,
        origin_longitude_deg=ORIGIN_LONGITUDE_DEG,
        origin_radius_kft=ORIGIN_RADIUS_KFT,
    )


def position_ft(path: Trajectory, time_s: Floats) -> Floats:
    """East, north, up of the origin, ft (F, 3), at times (F,), linear between the table's rows."""
    return np.stack([np.interp(time_s, path.time_s, axis) for axis in path.position_ft.T], axis=1)


def wind(plan: Plan) -> Wind:
    """The wind of group 4: from the east, stronger with height, in whole ft/s."""
    altitude = np.arange(70e3, 161e3, 10e3)
    phase = random_stream(plan, RandomPart.WIND).uniform(0.0, 6.0)
    toward_north = 20.0 * np.sin(altitude / 15e3 + phase)
    toward_east = -20.0 - 140.0 * ((altitude - 70e3) / 90e3) ** 2
    velocity = np.column_stack([toward_north, toward_east]).round()
    return Wind(altitude, velocity + 0.0)
