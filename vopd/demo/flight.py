"""The vehicle's path: over New Mexico, up to its greatest height and down by parachute."""

from __future__ import annotations

import numpy as np

from vopd.demo.plan import FIRST_TIME_S, FRAME_RATE, PATH, Plan
from vopd.job import Clock, Floats, Trajectory, Wind

ORIGIN_LATITUDE_DEG = 33.083333  # the origin of the report's case 1
ORIGIN_LONGITUDE_DEG = -106.3333
ORIGIN_RADIUS_KFT = 20925.698
GRAVITY_FT_S2 = 32.0
MARGIN_S = 1.0  # of the trajectory table, before the first frame and after the last


def clock(plan: Plan) -> Clock:
    """Group 6: two rows that hold the whole film, at 32 frames a second."""
    frame = np.array([0, max(10, plan.numbers().max())], dtype=np.int64)
    return Clock(frame, FIRST_TIME_S + frame / FRAME_RATE)


def trajectory(plan: Plan, until_s: float) -> Trajectory:
    """Group 7, from before the first frame to after `until_s`, rounded as its cards have it.

    The vehicle coasts over the top and sinks towards its speed under the
    parachute, h = top - v tau ln cosh((t - t_top) / tau) with tau = v / g, and its
    speed over the ground decays towards the wind's.
    """
    random = plan.random(PATH)
    t = np.linspace(FIRST_TIME_S - MARGIN_S, until_s + MARGIN_S, plan.trajectory_rows)
    t = np.round(t, 4)
    sink, top = random.uniform(190.0, 225.0), random.uniform(140e3, 149e3)
    tau = sink / GRAVITY_FT_S2
    since_top = (t - FIRST_TIME_S - random.uniform(5.0, 15.0)) / tau
    up = top - sink * tau * np.log(np.cosh(since_top))
    up_speed = -sink * np.tanh(since_top)

    drift = random.uniform([-40.0, -15.0], [-20.0, 15.0])  # east, north
    launch = random.uniform([-900.0, -500.0], [-500.0, 500.0])
    start = random.uniform([-20e3, -20e3], [20e3, 20e3])
    slowing_s, flown = 12.0, (t - FIRST_TIME_S)[:, None]
    left = np.exp(-flown / slowing_s)
    ground = start + drift * flown + (launch - drift) * slowing_s * (1.0 - left)
    ground_speed = drift + (launch - drift) * left

    position = np.round(np.column_stack([ground, up]), 2)
    from_centre = position + [0.0, 0.0, ORIGIN_RADIUS_KFT * 1000.0]
    return Trajectory(
        time_s=t,
        position_ft=position,
        velocity_ft_s=np.round(np.column_stack([ground_speed[:, ::-1], -up_speed]), 3),
        altitude_ft=np.round(np.linalg.norm(from_centre, axis=1) - ORIGIN_RADIUS_KFT * 1000.0, 1),
        origin_latitude_deg=ORIGIN_LATITUDE_DEG,
        origin_longitude_deg=ORIGIN_LONGITUDE_DEG,
        origin_radius_kft=ORIGIN_RADIUS_KFT,
    )


def position_ft(path: Trajectory, time_s: Floats) -> Floats:
    """East, north, up (F, 3) at any times within the table."""
    return np.stack([np.interp(time_s, path.time_s, axis) for axis in path.position_ft.T], axis=1)


def wind(plan: Plan) -> Wind:
    """Group 4: a wind from the east that grows with height."""
    altitude = np.arange(70e3, 161e3, 10e3)
    random = plan.random(PATH + 100)
    toward_east = -20.0 - 140.0 * ((altitude - 70e3) / 90e3) ** 2
    toward_north = 20.0 * np.sin(altitude / 15e3 + random.uniform(0.0, 6.0))
    return Wind(altitude, np.round(np.column_stack([toward_north, toward_east])))
